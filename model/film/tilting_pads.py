"""Pads that tilt: how far each does, so that the moments about its pivot balance.

A pad that turns by an angle about its pivot, in the direction e from the bearing's centre, moves
its own centre by -i e s, s = R times the angle: its tilt [m]. So its film is that of a pad that
stands, of a journal at d + i e s that moves with v + i e s'. With the force F of film and wall on
the journal, and the friction f of the wall, which acts at the pad's surface, near the pivot,

    J / R^2 s'' = G,    G = Re(conj(i e) F) + f

J: moment of inertia of the pad about its pivot. A pad without inertia has G = 0: a film's load is
the gradient of a convex function of the velocities, so that G never grows with s', and one s'
balances it. Where there is no pressure on either side of the pivot any would: the pad stays.

A pivot of stiffness k that gives outwards, by u, moves the pad's centre by e u, and so the journal
in its film back by as much: k u = -Re(conj(e) F), without mass.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..contact.rubbing import Friction, contact_tangent, friction
from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from .bearing_film import PAD, pad_of, pad_slopes
from .rough_contact import sliding_of, touch

ITERATIONS = 80
CONVERGED = 1e-7  # of the search's scale: the error left is of second order in it
_NOTHING = 1e-12  # of a film's force
_ROUNDING = 8.0 * 2.0**-53  # of where a journal is in a bearing
REACH = 0.2  # of a clearance, that a step of Newton's method tilts a pad


class _Share(NamedTuple):
    """`parts.law.Weights` without a law's states."""

    displacement: float
    velocity: float


class Balance(NamedTuple):
    """What holds a pad: force on the journal [N]; moment: G [N]; p_d, q_d, p_v, q_v: of the force,
    by the journal's displacement and velocity; g_d, g_v: of G, which changes by Re(conj(g) z);
    force_by_tilt, force_by_rate, by_tilt, by_rate: of force and G by s and s'."""

    force: complex
    moment: float
    p_d: complex
    q_d: complex
    p_v: complex
    q_v: complex
    g_d: complex
    g_v: complex
    force_by_tilt: complex
    force_by_rate: complex
    by_tilt: float
    by_rate: float


class Search(NamedTuple):
    """How a pad moves with an unknown y, and what G has to be: tilt + by_tilt y [m], rate +
    by_rate y [m/s], G = inertia (y - free); scale: a y that counts; reach: of a step, at first;
    none: a G that is as good as 0 [N]."""

    tilt: float
    by_tilt: float
    rate: float
    by_rate: float
    inertia: float
    free: float
    scale: float
    reach: float
    none: float


@jit
def row_of(bearing, i):
    """Return the place of a pad's row of `PAD` in the tables."""
    return bearing.table + 1 + len(PAD) * i


@jit
def across_of(bearing, tables, i):
    """Return the direction i e across a pad's pivot."""
    at = row_of(bearing, i)
    return complex(-tables[at + PAD.pivot_y], tables[at + PAD.pivot_x])


@jit
def put(bearing, tables, i, tilt, rate):
    """Tilt a pad: by how much [m], at what rate [m/s]."""
    at = row_of(bearing, i)
    tables[at + PAD.tilt] = tilt
    tables[at + PAD.rate] = rate


@jit
def put_pivot(bearing, tables, i, give, giving):
    """Move a pad outwards with its pivot: by how much [m], at what rate [m/s]."""
    at = row_of(bearing, i)
    tables[at + PAD.give] = give
    tables[at + PAD.giving] = giving


@jit_not_inlined
def pad_balance(bearing, tables, kinematics, i):
    """Return the `Balance` of a pad as it was put last."""
    pad, work = pad_of(bearing, tables, kinematics, i)
    across = across_of(bearing, tables, i)
    back = across.conjugate()
    force, p_d, q_d, p_v, q_v = pad_slopes(bearing, pad, work, kinematics.speed)
    rubs, rubs_by_d, rubs_by_v, by_sliding, slid = 0.0, 0.0j, 0.0j, 0.0, 0.0j
    at = touch(bearing, pad)
    if at.penetration > 0.0 and at.normal > 0.0:
        mu, slope = friction(bearing, sliding_of(bearing, pad, at, kinematics))
        rubs = mu * at.normal
        force -= complex(at.normal, rubs) * at.direction
        rubbing = Friction(mu, slope, mu, 0.0)
        p, q = contact_tangent(at, rubbing, 1.0, _Share(1.0, 0.0))
        rubs_by_d = _rubs(at, p, q) - 1j * at.direction * (at.curvature * at.normal)
        p_d += p
        q_d += q
        p, q = contact_tangent(at, rubbing, 1.0, _Share(0.0, 1.0))
        rubs_by_v = _rubs(at, p, q)
        p_v += p
        q_v += q
        by_sliding = slope * at.normal
        slid = 1j * at.direction * by_sliding
    g_d = across * p_d.conjugate() + back * q_d + rubs_by_d
    g_v = across * p_v.conjugate() + back * q_v + rubs_by_v
    return Balance(
        *(force, (back * force).real + rubs, p_d, q_d, p_v, q_v, g_d, g_v),
        *(p_d * across + q_d * back, p_v * across + q_v * back + slid),
        (g_d.conjugate() * across).real,
        (g_v.conjugate() * across).real + (back * slid).real - by_sliding,
    )


@jit
def _rubs(at, p, q):
    """Return the change of a wall's friction, -Im(conj(e) dF), of dF = p z + q conj(z), as g: that
    is Re(conj(g) z)."""
    e = at.direction
    return -1j * e * p.conjugate() + 1j * e.conjugate() * q


@jit
def ahead_of(y, left, slope, low, high, reach, scale):
    """Return the next y of a search for where what is left, which falls with y, is 0: by Newton's
    method, in steps of `reach` at most, between the bounds known; those, and the next reach."""
    if left > 0.0:
        low = y
    else:
        high = y
    step = reach if left > 0.0 else -reach
    if slope < 0.0 and abs(left) < -slope * reach:
        step = -left / slope
    else:
        reach *= 2.0
    ahead = y + step
    if abs(step) > CONVERGED * scale and not low < ahead < high:
        ahead = 0.5 * (low + high)
    return ahead, low, high, reach


@jit_not_inlined
def find(bearing, tables, kinematics, i, search):
    """Return y of a `Search`, how G - inertia (y - free) changes by it, and the `Balance` there;
    the pad is put there. By Newton's method, kept between values on both sides of the result."""
    y, reach = 0.0, search.reach
    low, high = -math.inf, math.inf
    for _ in range(ITERATIONS):
        put(
            *(bearing, tables, i, search.tilt + search.by_tilt * y),
            search.rate + search.by_rate * y,
        )
        at = pad_balance(bearing, tables, kinematics, i)
        left = at.moment - search.inertia * (y - search.free)
        slope = search.by_tilt * at.by_tilt + search.by_rate * at.by_rate - search.inertia
        if abs(left) <= search.none:
            return y, slope, at
        ahead, low, high, reach = ahead_of(y, left, slope, low, high, reach, search.scale)
        moved = ahead - y
        y = ahead
        if abs(moved) <= CONVERGED * search.scale:
            break
    moved_by = search.by_tilt * at.force_by_tilt + search.by_rate * at.force_by_rate
    put(
        *(bearing, tables, i, search.tilt + search.by_tilt * y),
        search.rate + search.by_rate * y,
    )
    return y, slope, _moved(at, moved * moved_by)


@jit
def _moved(at, change):
    """Return a `Balance` with its force changed."""
    return Balance(
        *(at.force + change, 0.0, at.p_d, at.q_d, at.p_v, at.q_v, at.g_d, at.g_v),
        *(at.force_by_tilt, at.force_by_rate, at.by_tilt, at.by_rate),
    )


@jit
def speed_of(bearing, kinematics):
    """Return a velocity of the size of those in the film [m/s]."""
    return bearing.clearance * abs(kinematics.speed) + modulus(kinematics.velocity)


@jit
def none_of(bearing, speed):
    """Return a force that is nothing beside that of a film whose surfaces move so fast, or is what
    rounding makes of a wall's [N]."""
    slender = bearing.journal_radius / bearing.clearance
    film = bearing.viscosity * speed * bearing.length * slender * slender * slender
    return _NOTHING * film + _ROUNDING * bearing.k * bearing.clearance


@jit
def free_of_inertia(bearing, kinematics, tilt, b):
    """Return the `Search` for the rate of a pad without inertia at the tilt + b rate [m]."""
    scale = speed_of(bearing, kinematics)
    reach = scale
    if b > 0.0:
        reach = min(reach, REACH * bearing.clearance / b)
    return Search(tilt, b, 0.0, 1.0, 0.0, 0.0, scale, reach, none_of(bearing, scale))


@jit
def with_inertia(bearing, kinematics, tilt, free, b, mass):
    """Return the `Search` for the rate of a pad of J / R^2 = mass [kg] at the end of a step of
    weight b > 0 [s], its tilt and its rate known before it."""
    scale = speed_of(bearing, kinematics) + abs(free)
    reach = min(scale, REACH * bearing.clearance / b)
    return Search(tilt, b, 0.0, 1.0, mass / b, free, scale, reach, none_of(bearing, scale))


@jit
def at_rest(bearing, tables, kinematics, i):
    """Return the `Search` for where a pad rests, from where the journal stands before its pivot on:
    a pad that is tilted so far that nothing presses on it would stay."""
    across = across_of(bearing, tables, i)
    tilt = -(across.conjugate() * kinematics.displacement).real
    none = none_of(bearing, speed_of(bearing, kinematics))
    c = bearing.clearance
    return Search(tilt, 1.0, 0.0, 0.0, 0.0, 0.0, c, REACH * c, none)


@jit
def following(at, search, slope, by_d, by_v):
    """Return the pair p, q of a pad's force for `Weights` of displacement and velocity, while the
    pad follows as its `Search` says."""
    p, q = by_d * at.p_d + by_v * at.p_v, by_d * at.q_d + by_v * at.q_v
    if slope < 0.0:
        g = by_d * at.g_d + by_v * at.g_v
        share = search.by_tilt * at.force_by_tilt + search.by_rate * at.force_by_rate
        share *= 0.5 / slope
        p -= share * g.conjugate()
        q -= share * g
    return p, q


@jit
def vibrating(at, mass, frequency):
    """Return p_d, q_d, p_v, q_v of a pad at rest that follows the journal at a frequency [rad/s]:
    its tilt is what G + frequency^2 mass tilt = 0 makes it; mass: J / R^2 [kg]."""
    by = (at.p_d, at.q_d, at.p_v, at.q_v)
    real = at.by_tilt + frequency * frequency * mass
    of_moment = (at.g_d, at.g_v, real, at.by_rate)
    return without(by, at.force_by_tilt, at.force_by_rate, of_moment, frequency)


@jit
def on_pivot(by, outwards, stiffness, frequency):
    """Return p_d, q_d, p_v, q_v of a pad, `by`, whose pivot gives outwards, a spring in series with
    its film: stiffness [N/m]."""
    p_d, q_d, p_v, q_v = by
    back = outwards.conjugate()
    by_give, by_giving = p_d * outwards + q_d * back, p_v * outwards + q_v * back
    g_d, g_v = outwards * p_d.conjugate() + back * q_d, outwards * p_v.conjugate() + back * q_v
    real, rate = (back * by_give).real - stiffness, (back * by_giving).real
    return without(by, by_give, by_giving, (g_d, g_v, real, rate), frequency)


@jit
def without(by, by_s, by_x, balance, frequency):
    """Return p_d, q_d, p_v, q_v, `by`, of a force without an unknown s that a balance gives, as
    all vibrate at a frequency [rad/s]: by_s, by_x: of the force by s and s'; balance: g_d, g_v,
    real, rate, of g_d z + g_v z' + real s + rate s' = 0."""
    p_d, q_d, p_v, q_v = by
    g_d, g_v, real, rate = balance
    square = frequency * frequency
    size = real * real + square * rate * rate
    if size == 0.0:  # nothing but squeezing holds it
        share = 0.5 / rate if rate < 0.0 else 0.0
        f, g = by_x * share, g_v
        return p_d, q_d, p_v - f * g.conjugate(), q_v - f * g
    # (f_s + i w f_x) conj(g_d + i w g_v) / (real + i w rate), where i is that of time
    u, w = 0.5 * real / size, -0.5 * rate / size
    p_in = by_s * g_d.conjugate() - square * (by_x * g_v.conjugate())
    q_in = by_s * g_d - square * (by_x * g_v)
    p_out = by_s * g_v.conjugate() + by_x * g_d.conjugate()
    q_out = by_s * g_v + by_x * g_d
    return (
        p_d - (u * p_in - square * w * p_out),
        q_d - (u * q_in - square * w * q_out),
        p_v - (w * p_in + u * p_out),
        q_v - (w * q_in + u * q_out),
    )
