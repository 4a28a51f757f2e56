"""A journal at a wall: where it touches, how deep it penetrates, and the force that follows.

d = u + i v [m] is the journal's displacement relative to the housing, e = d / |d| the direction of
contact, psi = arg d the contact angle (paper A, eqs 2 to 5, with its misprints mended):

    delta = |d| - s;    n = max(0, k delta^m + c min(1, delta / delta_c) delta')  while delta > 0

with the exponent m = 1, or 1.5 for Hertz' contact. The damping grows with the penetration. If it
acted at once, the force would jump at touch, and a step that ends in the jump would have no
solution.

In a worn housing the clearance depends on the direction, s(psi) = clearance + wear
cos(psi / 2 - wear_angle / 2)^(2 wear_power), and the force acts along g = grad delta, no longer e,
so that it has the potential k delta^(m + 1) / (m + 1).
"""

import math
from dataclasses import MISSING, dataclass, fields
from typing import Any, NamedTuple

from ..kernels.functions import angle, direction, modulus, power, scaled
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import ANGLE, NOT_NEGATIVE, Rule, quantity

_EXPONENT = Rule(1.0, False, "must be from 1 to 3", most=3.0)
_POWER = Rule(1.0, False, "must be >= 1 and finite")


@dataclass(frozen=True, kw_only=True)
class ContactQuantities:
    """The quantities of a clearance contact: journal_radius, radial clearance [m]; contact
    stiffness k [N/m^exponent], contact damping c [N.s/m] that reaches its full value at the
    penetration delta_c [m]; coefficient of friction mu [1], smoothed below the sliding speed v_s
    [m/s], and at rest larger by mu_rise [1], which falls off over v_stribeck [m/s]; depth [m],
    direction [rad] and narrowness [1] of the wear; tangential stiffness k_t [N/m] and damping c_t
    [N.s/m] of a journal that sticks."""

    journal_radius: float = quantity("m", "radius of the journal")
    clearance: float = quantity("m", "radial clearance", is_tunable=True)
    mu: float = quantity("1", "coefficient of friction", NOT_NEGATIVE, is_tunable=True)
    k: float = quantity("N/m^exponent", "contact stiffness", is_parameter=True)
    c: float = quantity("N.s/m", "contact damping", NOT_NEGATIVE, 100.0, is_parameter=True)
    delta_c: float = quantity(
        "m", "penetration from which the contact damping acts in full", default=2e-7
    )
    v_s: float = quantity("m/s", "sliding speed below which friction is smoothed", default=1e-3)
    exponent: float = quantity(
        "1", "exponent of the penetration: 1 linear, 10/9 roller, 1.5 Hertz", _EXPONENT, 1.0
    )
    mu_rise: float = quantity(
        "1", "excess of the coefficient of friction at rest", NOT_NEGATIVE, 0.0
    )
    v_stribeck: float = quantity(
        "m/s", "sliding speed over which the excess falls off", default=0.01
    )
    wear: float = quantity("m", "depth of the wear", NOT_NEGATIVE, 0.0)
    wear_angle: float = quantity("rad", "direction of the wear", ANGLE, 1.5 * math.pi)
    wear_power: float = quantity("1", "narrowness of the worn arc: 1 is widest", _POWER, 1.0)
    k_t: float = quantity(
        "N/m",
        "tangential stiffness of a sticking contact; 0: no sticking, the journal creeps below v_s",
        NOT_NEGATIVE,
        0.0,
    )
    c_t: float = quantity("N.s/m", "tangential damping of a sticking contact", default=100.0)


def contact_quantity(name: str, default: Any = MISSING, rule: Rule | None = None) -> Any:
    """Return a quantity of a clearance contact for another data class, with another default value
    or another rule."""
    known = {f.name: f.metadata["quantity"] for f in fields(ContactQuantities)}[name]
    return quantity(
        *(known.unit, known.text, rule or known.rule, default),
        is_parameter=known.is_parameter,
        is_tunable=known.is_tunable,
    )


@jit
def _clearance_at(part, d):
    """Return the clearance in the direction of d, and two derivatives by the angle [m]."""
    if part.wear == 0.0:
        return part.clearance, 0.0, 0.0
    return _worn_at(part, d)


@jit_not_inlined
def _worn_at(part, d):
    """Return the same as `_clearance_at` for a worn housing."""
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


@jit
def elastic(part, delta):
    """Return the elastic force of a penetration [N] and its derivative [N/m]."""
    if part.exponent == 1.0:
        return part.k * delta, part.k
    slope = part.k * power(delta, part.exponent - 1.0)
    return slope * delta, slope * part.exponent


@jit
def pressed(part, delta, rate):
    """Return the normal force of a penetration [m] that grows at a rate [m/s], its elastic part
    [N], and its derivatives by both [N/m], [N.s/m]."""
    n_k, stiffness = elastic(part, delta)
    share = min(1.0, delta / part.delta_c)
    damping = part.c * share
    n = n_k + damping * rate
    if share < 1.0:
        stiffness += part.c / part.delta_c * rate
    return max(0.0, n), n_k, stiffness, damping


class Touch(NamedTuple):
    """Contact of a journal with its wall, in the frame along e: penetration delta [m] and its rate
    [m/s]; normal force n [N], 0 without contact, its elastic part, its derivatives by delta,
    `stiffness` [N/m], and by the rate, `damping` [N.s/m]; direction: e; velocity: d' along e and i
    e [m/s]; gradient: of delta, along e and i e [1]; its second derivatives, `skew` along e and i
    e, `curvature` along i e twice [1/m]."""

    penetration: float
    rate: float
    normal: float
    elastic: float
    stiffness: float
    damping: float
    direction: complex
    velocity: complex
    gradient: complex
    skew: float
    curvature: float


@jit
def touch(part, kinematics):
    """Return the `Touch` of a journal; everything but the penetration is 0 without contact."""
    d = kinematics.displacement
    r = modulus(d)
    s, s_1, s_2 = _clearance_at(part, d)
    delta = r - s
    if delta <= 0.0:
        return Touch(delta, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0j, 0.0j, 0.0j, 0.0, 0.0)
    e = scaled(1.0 / r, d)
    velocity = e.conjugate() * kinematics.velocity
    gradient = complex(1.0, -s_1 / r)
    rate = velocity.real + gradient.imag * velocity.imag
    n, n_k, stiffness, damping = pressed(part, delta, rate)
    skew, curvature = s_1 / (r * r), 1.0 / r - s_2 / (r * r)
    return Touch(
        *(delta, rate, n, n_k, stiffness, damping), *(e, velocity, gradient, skew, curvature)
    )


@jit
def contact_angle(d):
    """Return psi in [0, 2 pi) [rad] of the journal's relative displacement d."""
    psi = angle(d)
    if psi < 0.0:
        psi += 2.0 * math.pi
    return psi if psi < 2.0 * math.pi else 0.0


@jit
def gap(part, d):
    """Return the distance of a journal from its wall [m]: `Law.gap` of a contact."""
    return _clearance_at(part, d)[0] - modulus(d)


@jit
def length(part):
    """Return the clearance [m]: `Law.length` of a contact."""
    return part.clearance


@jit_not_inlined
def compression(part, d):
    """Return the elastic energy of a contact [J]."""
    delta = -gap(part, d)
    if delta <= 0.0:
        return 0.0
    return elastic(part, delta)[0] * delta / (part.exponent + 1.0)
