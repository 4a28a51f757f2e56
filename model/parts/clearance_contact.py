"""A journal in the clearance of its housing: penalty contact with damping and friction (`contact`),
which is smoothed at small sliding speeds, or lets the journal stick."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import ClassVar

from ..contact.rubbing import rubbing, rubbing_tangent, stretched, stretching
from ..contact.wall import ContactQuantities, compression, contact_angle, gap, length
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import SPEED, Output, places
from .base import GROUND, Element, InterfaceElement, Part, Shape
from .law import Law

OUTPUTS = (
    Output("psi", "rad", "contact angle, 0 to the right, 3 pi / 2 at the bottom", True, 1.0),
    Output("fn", "N", "normal contact force", True, 10.0),
    Output("ft", "N", "friction force opposing positive rotation", nominal=1.0, reached_by=SPEED),
    Output("x", "m", "journal relative to the housing, to the right", nominal=1e-4),
    Output("y", "m", "journal relative to the housing, upwards", nominal=1e-4),
    Output("contact", "1", "whether journal and housing touch", kind="Boolean"),
)
STORES = (Output("compression", "J", "elastic energy of the contacts", nominal=1e-6),)
LOSSES = (
    Output("contact", "J", "dissipated by the contacts' damping", nominal=0.1),
    Output("friction", "J", "dissipated by friction", nominal=100.0),
)
_OUT, _LOSS = places(OUTPUTS), places(LOSSES)


@jit
def contact_force(part, kinematics):
    """Return the `Rubbing` of a contact whose journal does not stick, `part` a record of
    `ContactQuantities`."""
    return rubbing(part, kinematics, part.journal_radius * kinematics.sliding_speed, 0.0)


@jit
def _tangent(part, tables, kinematics, weights, free, internal_state):
    surface = part.journal_radius * kinematics.sliding_speed
    force, p, q, _ = rubbing_tangent(part, kinematics, weights, surface, 0.0, 0.0)
    return force, p, q


@jit
def _force(part, tables, kinematics, internal_state):
    return contact_force(part, kinematics).force


@jit
def _energy(part, tables, displacement, internal_state):
    return (compression(part, displacement),)


@jit
def _dissipate(part, tables, kinematics, internal_state, out):
    contact = contact_force(part, kinematics)
    out[_LOSS.contact] = contact.damping * contact.rate
    out[_LOSS.friction] = contact.friction * contact.sliding
    return part.journal_radius * contact.friction


@jit
def observe_contact(displacement, contact, out):
    """Fill in `OUTPUTS` of a contact, a `Rubbing`."""
    out[_OUT.psi] = contact_angle(displacement)
    out[_OUT.fn] = contact.normal
    out[_OUT.ft] = contact.friction
    out[_OUT.x] = displacement.real
    out[_OUT.y] = displacement.imag
    out[_OUT.contact] = 1.0 if contact.normal > 0.0 else 0.0


@jit
def _observe(part, tables, kinematics, internal_state, out):
    observe_contact(kinematics.displacement, contact_force(part, kinematics), out)


CLEARANCE_CONTACT = Law(
    name="clearance_contact",
    kind=ContactQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    gap=gap,
    length=length,
    observe=_observe,
    outputs=OUTPUTS,
    stores=STORES,
    losses=LOSSES,
    has_wall=True,
)


@jit_not_inlined
def _sticking_tangent(part, tables, kinematics, weights, free, internal_state):
    surface = part.journal_radius * kinematics.sliding_speed
    force, p, q, z = rubbing_tangent(part, kinematics, weights, surface, weights.rate, free[0])
    internal_state[0] = z
    return force, p, q


@jit
def _sticking(part, kinematics, internal_state):
    """Return the `Rubbing` of a contact whose journal may stick."""
    return rubbing(
        part, kinematics, part.journal_radius * kinematics.sliding_speed, internal_state[0]
    )


@jit_not_inlined
def _sticking_force(part, tables, kinematics, internal_state):
    return _sticking(part, kinematics, internal_state).force


@jit_not_inlined
def _sticking_rates(part, tables, kinematics, internal_state, out):
    out[0] = stretching(
        part, _sticking(part, kinematics, internal_state).friction, internal_state[0]
    )


@jit
def _sticking_energy(part, tables, displacement, internal_state):
    return (compression(part, displacement) + stretched(part, internal_state[0]),)


@jit_not_inlined
def _sticking_dissipate(part, tables, kinematics, internal_state, out):
    contact = _sticking(part, kinematics, internal_state)
    spring = part.k_t * internal_state[0] * stretching(part, contact.friction, internal_state[0])
    out[_LOSS.contact] = contact.damping * contact.rate
    out[_LOSS.friction] = contact.friction * contact.sliding - spring
    return part.journal_radius * contact.friction


@jit_not_inlined
def _sticking_observe(part, tables, kinematics, internal_state, out):
    observe_contact(kinematics.displacement, _sticking(part, kinematics, internal_state), out)


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
    """Return the law of a contact whose wall does not turn."""
    return STICKING_CONTACT if part.k_t > 0 else CLEARANCE_CONTACT


@dataclass(frozen=True, kw_only=True)
class ClearanceContact(ContactQuantities, Part):
    """A clearance contact between a node (from 1) and a housing, or a fixed stator."""

    KIND: ClassVar[str] = "contact"
    TEXT: ClassVar[str] = "a journal in the clearance of a housing or of a fixed stator"
    LAWS: ClassVar[tuple[Law, ...]] = (CLEARANCE_CONTACT, STICKING_CONTACT)

    node: int
    housing: str = GROUND

    @property
    def law(self) -> Law:
        """The law of this contact, one of `LAWS`."""
        return contact_law(self)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one interface."""
        yield InterfaceElement(self.node, self.law, self, self.housing)

    def outline(self) -> Iterator[Shape]:
        """Yield a stator about the journal, on springs if it is a housing."""
        role = "stator" if self.housing == GROUND else "housing"
        yield Shape(0.0, 0.0, self.journal_radius, self.journal_radius, role)
