"""A journal in the clearance of its housing: penalty contact with damping and friction (`contact`),
which smooths friction at small sliding speeds, or lets the journal stick.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

from ..contact.rubbing import rubbing_force, rubbing_tangent, stretched, stretching
from ..contact.wall import ContactQuantities, compression, contact_angle, length, opening
from ..kernels.compiled import called, compiled
from ..protocol.law import Law
from ..protocol.part import GROUND, Element, Interface, Part, Shape
from ..quantities import SPEED, Output


@compiled
def contact_force(part, d, d_dot, spin):
    """Contact of one bearing, `part` a record of `ContactQuantities`.

    d [m], d_dot [m/s], spin [rad/s]. Returns the complex force on the journal [N], the normal
    force n [N], the penetration delta [m], its rate [m/s] and the sliding speed v_t [m/s].
    """
    surface = part.journal_radius * spin
    force, n, _, _, delta, rate, v_t = rubbing_force(part, d, d_dot, surface, 0.0)
    return force, n, delta, rate, v_t


@compiled
def _tangent(part, tables, d, d_dot, speed, spin, by_d, by_v, by_own, free, own):
    """See `protocol.law`."""
    surface = part.journal_radius * spin
    force, p, q, _ = rubbing_tangent(part, d, d_dot, surface, by_d, by_v, 0.0, 0.0)
    return force, p, q


@compiled
def _force(part, tables, d, d_dot, speed, spin, own):
    """See `protocol.law`."""
    return contact_force(part, d, d_dot, spin)[0]


@compiled
def _energy(part, tables, d, own):
    """See `protocol.law`."""
    return (compression(part, d),)


@compiled
def _dissipate(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`: contact damping, friction."""
    surface = part.journal_radius * spin
    _, _, rubbing, damping, _, rate, sliding = rubbing_force(part, d, d_dot, surface, 0.0)
    out[0] = damping * rate
    out[1] = rubbing * sliding
    return part.journal_radius * rubbing


@compiled
def observe_contact(d, normal, rubbing, out):
    """Fill out in the order of `OUTPUTS`."""
    out[0] = contact_angle(d)
    out[1] = normal
    out[2] = rubbing
    out[3] = d.real
    out[4] = d.imag
    out[5] = 1.0 if normal > 0.0 else 0.0


@compiled
def _observe(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`."""
    surface = part.journal_radius * spin
    _, normal, rubbing, _, _, _, _ = rubbing_force(part, d, d_dot, surface, 0.0)
    observe_contact(d, normal, rubbing, out)


OUTPUTS = (
    Output("psi", "rad", "contact angle, 0 to the right, 3 pi / 2 at the bottom", True, 1.0),
    Output("fn", "N", "normal contact force", True, 10.0),
    Output("ft", "N", "friction force that brakes the rotor", nominal=1.0, reached_by=SPEED),
    Output("x", "m", "journal relative to the housing, to the right", nominal=1e-4),
    Output("y", "m", "journal relative to the housing, upwards", nominal=1e-4),
    Output("contact", "1", "whether journal and housing touch", kind="Boolean"),
)
STORES = (Output("compression", "J", "elastic energy of the contacts", nominal=1e-6),)
LOSSES = (
    Output("contact", "J", "dissipated by the contacts' damping", nominal=0.1),
    Output("friction", "J", "dissipated by friction", nominal=100.0),
)
CLEARANCE_CONTACT = Law(
    name="clearance_contact",
    kind=ContactQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    opening=opening,
    length=length,
    observe=_observe,
    outputs=OUTPUTS,
    stores=STORES,
    losses=LOSSES,
    has_wall=True,
)


@called
def _sticking_tangent(part, tables, d, d_dot, speed, spin, by_d, by_v, by_own, free, own):
    """See `protocol.law`."""
    surface = part.journal_radius * spin
    force, p, q, z = rubbing_tangent(part, d, d_dot, surface, by_d, by_v, by_own, free[0])
    own[0] = z
    return force, p, q


@called
def _sticking_force(part, tables, d, d_dot, speed, spin, own):
    """See `protocol.law`."""
    return rubbing_force(part, d, d_dot, part.journal_radius * spin, own[0])[0]


@called
def _sticking_rates(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`."""
    rubbing = rubbing_force(part, d, d_dot, part.journal_radius * spin, own[0])[2]
    out[0] = stretching(part, rubbing, own[0])


@compiled
def _sticking_energy(part, tables, d, own):
    """See `protocol.law`."""
    return (compression(part, d) + stretched(part, own[0]),)


@called
def _sticking_dissipate(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`: contact damping, friction less what its spring takes."""
    surface = part.journal_radius * spin
    _, _, rubbing, damping, _, rate, sliding = rubbing_force(part, d, d_dot, surface, own[0])
    out[0] = damping * rate
    out[1] = rubbing * sliding - part.k_t * own[0] * stretching(part, rubbing, own[0])
    return part.journal_radius * rubbing


@called
def _sticking_observe(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`."""
    surface = part.journal_radius * spin
    _, normal, rubbing, _, _, _, _ = rubbing_force(part, d, d_dot, surface, own[0])
    observe_contact(d, normal, rubbing, out)


STICKING_CONTACT = replace(
    CLEARANCE_CONTACT,
    name="sticking_contact",
    force=_sticking_force,
    tangent=_sticking_tangent,
    energy=_sticking_energy,
    dissipate=_sticking_dissipate,
    observe=_sticking_observe,
    rates=_sticking_rates,
    states=(0.0,),
)


def contact_law(part: ContactQuantities) -> Law:
    """The law of a contact whose wall does not turn."""
    return STICKING_CONTACT if part.k_t > 0 else CLEARANCE_CONTACT


@dataclass(frozen=True, kw_only=True)
class ClearanceContact(ContactQuantities, Part):
    """A clearance contact between a node (from 1) and the housing of that name, or a stator that
    does not move."""

    KIND: ClassVar[str] = "contact"
    TEXT: ClassVar[str] = "a journal in the clearance of a housing or of a fixed stator"
    LAWS: ClassVar[tuple[Law, ...]] = (CLEARANCE_CONTACT, STICKING_CONTACT)

    node: int
    housing: str = GROUND

    @property
    def law(self) -> Law:
        """The one of `LAWS` that it has."""
        return contact_law(self)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """One interface."""
        yield Interface(self.node, self.law, self, self.housing)

    def outline(self) -> Iterator[Shape]:
        """A stator about the journal, on springs where it is a housing."""
        role = "stator" if self.housing == GROUND else "housing"
        yield Shape(0.0, 0.0, self.journal_radius, self.journal_radius, role)
