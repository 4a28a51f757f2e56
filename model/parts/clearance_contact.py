"""A journal in the clearance of its housing: penalty contact with damping and Coulomb friction.

d = u + i v [m] is the journal's displacement relative to the housing, e = d / |d| the direction of
contact, psi = arg d the contact angle (paper A, eqs 2 to 5, with its misprints mended):

    delta = |d| - s;    n = max(0, k delta^m + c min(1, delta / delta_c) delta')  while delta > 0
    v_t = Im(conj(e) d') + R spin;    mu_t = mu(v_t) v_t / sqrt(v_t^2 + v_s^2)
    force on the journal  F = -(1 + i mu_t) n e;    the housing gets -F

with the exponent m = 1, or 1.5 for Hertz' contact, and Stribeck's friction,
mu(v) = mu + mu_rise exp(-(v / v_stribeck)^2). The damping grows with the penetration: were it there
at once, the force would jump at touch, and a step that ends in the jump would have no solution.

In a worn housing the clearance depends on the direction, s(psi) = clearance + wear
cos(psi / 2 - wear_angle / 2)^(2 wear_power), and the force acts along g = grad delta, no longer e:
F = -(1 + i mu_t) n g, which without friction has the potential k delta^(m + 1) / (m + 1).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..kernels.compiled import called, compiled
from ..kernels.functions import angle, direction, exponential, modulus, power
from ..protocol.law import Law
from ..protocol.part import GROUND, Element, Interface, Part, Shape
from ..quantities import ANY, NOT_NEGATIVE, SPEED, Output, Rule, quantity

_EXPONENT = Rule(1.0, False, "must be from 1 to 3", most=3.0)
_POWER = Rule(1.0, False, "must be >= 1 and finite")


@dataclass(frozen=True, kw_only=True)
class ContactQuantities:
    """What a clearance contact is: journal_radius, radial clearance [m]; contact stiffness k
    [N/m^exponent], contact damping c [N.s/m] that is fully there at the penetration delta_c [m];
    coefficient of friction mu [1], smoothed below the sliding speed v_s [m/s], and at rest larger
    by mu_rise [1], which falls off over v_stribeck [m/s]; depth [m], direction [rad] and
    narrowness [1] of the wear."""

    journal_radius: float = quantity("m", "radius of the journal")
    clearance: float = quantity("m", "radial clearance", is_parameter=True)
    mu: float = quantity("1", "coefficient of friction", NOT_NEGATIVE, is_parameter=True)
    k: float = quantity("N/m", "contact stiffness", is_parameter=True)
    c: float = quantity("N.s/m", "contact damping", NOT_NEGATIVE, 100.0, is_parameter=True)
    delta_c: float = quantity("m", "penetration at which its damping is whole", default=2e-7)
    v_s: float = quantity("m/s", "sliding speed below which friction is smoothed", default=1e-3)
    exponent: float = quantity(
        "1",
        "exponent of the penetration: 1 linear, 10/9 a roller, 1.5 Hertz; k in N/m^exponent",
        _EXPONENT,
        1.0,
    )
    mu_rise: float = quantity("1", "excess of the friction at rest", NOT_NEGATIVE, 0.0)
    v_stribeck: float = quantity("m/s", "sliding speed over which it falls off", default=0.01)
    wear: float = quantity("m", "depth of the wear", NOT_NEGATIVE, 0.0)
    wear_angle: float = quantity("rad", "direction of the wear", ANY, 1.5 * math.pi)
    wear_power: float = quantity("1", "narrowness of the wear: 1 wide", _POWER, 1.0)


@compiled
def _clearance_at(part, d):
    """Clearance in the direction of d, and its first and second derivative by the angle [m]."""
    if part.wear == 0.0:
        return part.clearance, 0.0, 0.0
    return _worn_at(part, d)


@called
def _worn_at(part, d):
    """`_clearance_at` of a worn housing."""
    turned = direction(0.5 * (angle(d) - part.wear_angle))
    c, s = turned.real, turned.imag
    p = part.wear_power
    square = c * c
    share = power(square, p - 1.0)
    depth = part.wear * share * square
    # s = wear (c^2)^p: s' = -p wear (c^2)^(p-1) c s, and once more
    first = -p * part.wear * share * c * s
    second = 0.5 * p * part.wear * share * ((2.0 * p - 1.0) * s * s - square)
    return part.clearance + depth, first, second


@compiled
def elastic(part, delta):
    """Elastic force of a penetration [N], its derivative [N/m]."""
    if part.exponent == 1.0:
        return part.k * delta, part.k
    slope = part.k * power(delta, part.exponent - 1.0)
    return slope * delta, slope * part.exponent


@compiled
def friction(part, v_t):
    """mu_t, the signed coefficient of friction at a sliding speed [m/s], and its derivative."""
    root = math.sqrt(v_t * v_t + part.v_s * part.v_s)
    s_t = v_t / root
    mu = part.mu
    by_v = part.v_s * part.v_s / (root * root * root)
    if part.mu_rise == 0.0:
        return mu * s_t, mu * by_v
    x = v_t / part.v_stribeck
    rise = part.mu_rise * exponential(-x * x)
    mu += rise
    return mu * s_t, mu * by_v - 2.0 * x / part.v_stribeck * rise * s_t


@compiled
def touch(part, d, d_dot):
    """Where the journal touches, in the frame along e.

    Returns penetration delta and its rate [m], [m/s]; n [N], 0 without contact, its elastic part,
    its derivative by delta and by the rate; e; d_dot along e and i e; the gradient of delta [1] and
    the second derivatives h along e and i e, h_b along i e twice [1/m].
    """
    r = modulus(d)
    s, s_1, s_2 = _clearance_at(part, d)
    delta = r - s
    if delta <= 0.0:
        return delta, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0j, 0.0j, 0.0j, 0.0, 0.0
    e = d * (1.0 / r)
    local = e.conjugate() * d_dot
    gradient = complex(1.0, -s_1 / r)
    rate = local.real + gradient.imag * local.imag
    n_k, n_a = elastic(part, delta)
    share = min(1.0, delta / part.delta_c)
    c = part.c * share
    n = n_k + c * rate
    if share < 1.0:
        n_a += part.c / part.delta_c * rate
    h, h_b = s_1 / (r * r), 1.0 / r - s_2 / (r * r)
    return delta, rate, max(0.0, n), n_k, n_a, c, e, local, gradient, h, h_b


@compiled
def _outward(gradient):
    """How steep the clearance is where it is touched [1], and its unit normal in the frame along
    e."""
    if gradient.imag == 0.0:  # round
        return 1.0, complex(1.0, 0.0)
    steep = modulus(gradient)
    return steep, gradient * (1.0 / steep)


@compiled
def rubbing_force(part, d, d_dot, surface):
    """Contact with a surface past which the journal's own moves with the speed `surface` [m/s] if
    its centre rests.

    Returns the complex force on the journal [N], the normal force, the friction force, the
    damping's share in n [N], the penetration [m], its rate and the sliding speed [m/s].
    """
    delta, rate, n, n_k, _, _, e, local, gradient, _, _ = touch(part, d, d_dot)
    if delta <= 0.0:
        return 0.0j, 0.0, 0.0, 0.0, delta, 0.0, 0.0
    steep, normal = _outward(gradient)
    v_t = (normal.conjugate() * local).imag + surface
    if n <= 0.0:
        return 0.0j, 0.0, 0.0, -n_k, delta, rate, v_t
    mu_t, _ = friction(part, v_t)
    pressure = n * steep
    force = -complex(pressure, mu_t * pressure) * normal * e
    return force, pressure, mu_t * pressure, n - n_k, delta, rate, v_t


@compiled
def contact_force(part, d, d_dot, spin):
    """Contact of one bearing, `part` a record of `ContactQuantities`.

    d [m], d_dot [m/s], spin [rad/s]. Returns the complex force on the journal [N], the normal
    force n [N], the penetration delta [m], its rate [m/s] and the sliding speed v_t [m/s].
    """
    surface = part.journal_radius * spin
    force, n, _, _, delta, rate, v_t = rubbing_force(part, d, d_dot, surface)
    return force, n, delta, rate, v_t


@called
def _column(z, z_v, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, give):
    """dF in the frame along e by a displacement z and a velocity z_v."""
    steep, normal = _outward(gradient)
    d_gradient = complex(h * z.imag, h * z.real + h_b * z.imag)
    d_rate = (d_gradient.conjugate() * local + gradient.conjugate() * z_v).real
    d_n = n_a * (gradient.conjugate() * z).real + c * d_rate
    d_steep = (normal.conjugate() * d_gradient).real
    d_normal = (d_gradient - normal * d_steep) * (1.0 / steep)
    d_sliding = (d_normal.conjugate() * local + normal.conjugate() * z_v).imag
    pressure = n * steep
    d_pressure = d_n * steep + n * d_steep
    d_friction = give * (mu_t * d_pressure + pressure * by_v * d_sliding)
    along = d_n * gradient + n * d_gradient
    return -(along + 1j * (d_friction * normal + mu_t * pressure * d_normal))


@compiled
def contact_tangent(e, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, give, by_d, by_v_dot):
    """The pair p, q of a contact that `touch` describes, with friction mu_t and its derivative;
    give: what the surface that is rubbed leaves of a change of the friction force [1]."""
    if gradient.imag != 0.0:
        by_a = _column(
            by_d + 0j, by_v_dot + 0j, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, give
        )
        by_b = _column(
            1j * by_d, 1j * by_v_dot, local, n, n_a, c, gradient, h, h_b, mu_t, by_v, give
        )
        return 0.5 * (by_a - 1j * by_b), 0.5 * (by_a + 1j * by_b) * e * e
    # round: n by a displacement along e and along i e
    w_n = local.real
    n_b = c * local.imag * h_b
    given = give * mu_t
    slope = give * n * by_v
    t_aa = by_d * -n_a + by_v_dot * -c
    t_ab = by_d * (mu_t * n * h_b - n_b)
    t_ba = by_d * (-given * n_a) + by_v_dot * (-given * c)
    t_bb = by_d * (-given * n_b + slope * w_n * h_b - n * h_b) + by_v_dot * -slope
    # rotated back: e (T (conj(e) z)), a real 2x2 matrix written as p z + q conj(z)
    p = 0.5 * complex(t_aa + t_bb, t_ba - t_ab)
    q = 0.5 * complex(t_aa - t_bb, t_ba + t_ab)
    return p, q * e * e


@compiled
def _tangent(part, tables, d, d_dot, speed, spin, by_d, by_v, by_own, free, own):
    """See `protocol.law`."""
    delta, _, n, _, n_a, c, e, local, gradient, h, h_b = touch(part, d, d_dot)
    if delta <= 0.0 or n <= 0.0:
        return 0.0j, 0.0j, 0.0j
    steep, normal = _outward(gradient)
    v_t = (normal.conjugate() * local).imag + part.journal_radius * spin
    mu_t, slope = friction(part, v_t)
    p, q = contact_tangent(e, local, n, n_a, c, gradient, h, h_b, mu_t, slope, 1.0, by_d, by_v)
    return -complex(n * steep, mu_t * n * steep) * normal * e, p, q


@compiled
def contact_angle(d):
    """psi in [0, 2 pi) [rad] of the journal's relative displacement d."""
    psi = angle(d)
    if psi < 0.0:
        psi += 2.0 * math.pi
    return psi if psi < 2.0 * math.pi else 0.0


@compiled
def _force(part, tables, d, d_dot, speed, spin, own):
    """See `protocol.law`."""
    return contact_force(part, d, d_dot, spin)[0]


@compiled
def opening(part, d):
    """See `protocol.law`."""
    return _clearance_at(part, d)[0] - modulus(d)


@compiled
def length(part):
    """See `protocol.law`."""
    return part.clearance


@compiled
def compression(part, d):
    """Elastic energy of a contact [J]."""
    delta = -opening(part, d)
    if delta <= 0.0:
        return 0.0
    return elastic(part, delta)[0] * delta / (part.exponent + 1.0)


@compiled
def _energy(part, tables, d, own):
    """See `protocol.law`."""
    return (compression(part, d),)


@compiled
def _dissipate(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`: contact damping, friction."""
    surface = part.journal_radius * spin
    _, _, rubbing, damping, _, rate, sliding = rubbing_force(part, d, d_dot, surface)
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
    _, normal, rubbing, _, _, _, _ = rubbing_force(part, d, d_dot, surface)
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
        yield Interface(self.node, self.LAW, self, self.housing)

    def outline(self) -> Iterator[Shape]:
        """A stator about the journal, on springs where it is a housing."""
        role = "stator" if self.housing == GROUND else "housing"
        yield Shape(0.0, 0.0, self.journal_radius, self.journal_radius, role)
