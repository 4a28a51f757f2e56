"""A journal in the clearance of its housing: penalty contact with damping and Coulomb friction.

d = u + i v [m] is the journal's displacement relative to the housing, e = d / |d| the direction of
contact, psi = arg d the contact angle (paper A, eqs 2 to 5, with its misprints mended):

    delta = |d| - s;    n = max(0, k delta + c min(1, delta / delta_c) delta')  while delta > 0
    v_t = Im(conj(e) d') + R spin;    s_t = v_t / sqrt(v_t^2 + v_s^2)
    force on the journal  F = -(n + i mu n s_t) e;    the housing gets -F

The damping grows with the penetration: were it there at once, the force would jump at touch, and a
step that ends in the jump would have no solution.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..kernels.compiled import compiled
from ..protocol.law import Law
from ..protocol.part import GROUND, Element, Interface, Part, Shape
from ..quantities import NOT_NEGATIVE, Output, quantity


@dataclass(frozen=True, kw_only=True)
class ContactQuantities:
    """What a clearance contact is: journal_radius, radial clearance [m]; contact stiffness k [N/m],
    contact damping c [N.s/m] that is fully there at the penetration delta_c [m]; coefficient of
    friction mu [1], smoothed below the sliding speed v_s [m/s]."""

    journal_radius: float = quantity("m", "radius of the journal")
    clearance: float = quantity("m", "radial clearance", is_parameter=True)
    mu: float = quantity("1", "coefficient of friction", NOT_NEGATIVE, is_parameter=True)
    k: float = quantity("N/m", "contact stiffness", is_parameter=True)
    c: float = quantity("N.s/m", "contact damping", NOT_NEGATIVE, 100.0, is_parameter=True)
    delta_c: float = quantity("m", "penetration at which its damping is whole", default=2e-7)
    v_s: float = quantity("m/s", "sliding speed below which friction is smoothed", default=1e-3)


@compiled
def contact_force(part, d, d_dot, spin):
    """Contact of one bearing, `part` a record of `ContactQuantities`.

    d [m], d_dot [m/s], spin [rad/s]. Returns the complex force on the journal [N], the normal
    force n [N], the penetration delta [m], its rate [m/s] and the sliding speed v_t [m/s].
    """
    r = math.sqrt(d.real * d.real + d.imag * d.imag)
    delta = r - part.clearance
    if delta <= 0.0:
        return 0.0j, 0.0, delta, 0.0, 0.0
    e = d * (1.0 / r)
    local = e.conjugate() * d_dot
    n = part.k * delta + part.c * min(1.0, delta / part.delta_c) * local.real
    v_t = local.imag + part.journal_radius * spin
    if n <= 0.0:
        return 0.0j, 0.0, delta, local.real, v_t
    s_t = v_t / math.sqrt(v_t * v_t + part.v_s**2)
    return -complex(n, part.mu * n * s_t) * e, n, delta, local.real, v_t


@compiled
def _tangent(part, tables, d, d_dot, speed, spin, by_d, by_v, by_own, free, own):
    """See `protocol.law`."""
    r = math.sqrt(d.real * d.real + d.imag * d.imag)
    delta = r - part.clearance
    if delta <= 0.0:
        return 0.0j, 0.0j, 0.0j
    e = d * (1.0 / r)
    local = e.conjugate() * d_dot
    w_n = local.real
    k = part.k
    share = min(1.0, delta / part.delta_c)
    c = part.c * share
    n = k * delta + c * w_n
    if n <= 0.0:
        return 0.0j, 0.0j, 0.0j
    v_s = part.v_s
    mu = part.mu
    v_t = local.imag + part.journal_radius * spin
    root = math.sqrt(v_t * v_t + v_s * v_s)
    s_t = v_t / root
    slope = v_s * v_s / (root * root * root)
    # n by a displacement along e and along i e, in the frame of the contact
    n_a = k + (part.c / part.delta_c * w_n if share < 1.0 else 0.0)
    n_b = c * local.imag / r
    t_aa = by_d * -n_a + by_v * -c
    t_ab = by_d * (mu * n * s_t / r - n_b)
    t_ba = by_d * (-mu * s_t * n_a) + by_v * (-mu * s_t * c)
    t_bb = by_d * (-mu * s_t * n_b + mu * n * slope * w_n / r - n / r) + by_v * (-mu * n * slope)
    # rotated back: e (T (conj(e) z)), a real 2x2 matrix written as p z + q conj(z)
    p = 0.5 * complex(t_aa + t_bb, t_ba - t_ab)
    q = 0.5 * complex(t_aa - t_bb, t_ba + t_ab)
    return -complex(n, mu * n * s_t) * e, p, q * e * e


@compiled
def contact_angle(d):
    """psi in [0, 2 pi) [rad] of the journal's relative displacement d."""
    psi = math.atan2(d.imag, d.real)
    if psi < 0.0:
        psi += 2.0 * math.pi
    return psi if psi < 2.0 * math.pi else 0.0


@compiled
def _force(part, tables, d, d_dot, speed, spin, own):
    """See `protocol.law`."""
    return contact_force(part, d, d_dot, spin)[0]


@compiled
def _opening(part, d):
    """See `protocol.law`."""
    return part.clearance - math.sqrt(d.real * d.real + d.imag * d.imag)


@compiled
def _length(part):
    """See `protocol.law`."""
    return part.clearance


@compiled
def _energy(part, tables, d, own):
    """See `protocol.law`."""
    delta = abs(d) - part.clearance
    return (0.5 * part.k * delta * delta if delta > 0.0 else 0.0,)


@compiled
def _dissipate(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`: contact damping, friction."""
    force, normal, delta, rate, sliding = contact_force(part, d, d_dot, spin)
    out[0] = 0.0
    out[1] = 0.0
    if delta <= 0.0:
        return 0.0
    tangential = -(force * d.conjugate()).imag / abs(d)
    out[0] = (normal - part.k * delta) * rate
    out[1] = tangential * sliding
    return part.journal_radius * tangential


@compiled
def _observe(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`, in the order of `OUTPUTS`."""
    force, normal, _, _, _ = contact_force(part, d, d_dot, spin)
    out[0] = contact_angle(d)
    out[1] = normal
    out[2] = 0.0 if normal == 0.0 else -(force * d.conjugate()).imag / abs(d)
    out[3] = d.real
    out[4] = d.imag
    out[5] = 1.0 if normal > 0.0 else 0.0


OUTPUTS = (
    Output("psi", "rad", "contact angle, 0 to the right, 3 pi / 2 at the bottom", True, 1.0),
    Output("fn", "N", "normal contact force", True, 10.0),
    Output("ft", "N", "friction force that brakes the rotor", nominal=1.0),
    Output("x", "m", "journal relative to the housing, to the right", nominal=1e-4),
    Output("y", "m", "journal relative to the housing, upwards", nominal=1e-4),
    Output("contact", "1", "whether journal and housing touch", True, kind="Boolean"),
)
CLEARANCE_CONTACT = Law(
    name="clearance_contact",
    kind=ContactQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    opening=_opening,
    length=_length,
    observe=_observe,
    outputs=OUTPUTS,
    stores=(Output("compression", "J", "elastic energy of the contacts", nominal=1e-6),),
    losses=(
        Output("contact", "J", "dissipated by the contacts' damping", nominal=0.1),
        Output("friction", "J", "dissipated by friction", nominal=100.0),
    ),
    has_wall=True,
)


@dataclass(frozen=True, kw_only=True)
class ClearanceContact(ContactQuantities, Part):
    """A clearance contact between a node (from 1) and the housing of that name, or a stator that
    does not move."""

    KIND: ClassVar[str] = "contact"
    TEXT: ClassVar[str] = "a journal in the clearance of a housing or of a fixed stator"

    LAW: ClassVar[Law] = CLEARANCE_CONTACT

    node: int
    housing: str = GROUND

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """One interface."""
        yield Interface(self.node, CLEARANCE_CONTACT, self, self.housing)

    def outline(self) -> Iterator[Shape]:
        """A stator about the journal."""
        yield Shape(0.0, 0.0, self.journal_radius, self.journal_radius, "housing")
