"""A touchdown bearing: a clearance contact whose inner race turns, driven by friction.

The journal slides past the race, which turns with w, at

    v_t = (tangential velocity of the journal) + R spin - (R + clearance) w

and the friction force T that brakes the journal drives the race against its drag:

    J w' = (R + clearance) T - drag w / sqrt(w^2 + w_s^2) - damping w

Its own states are w and the elongation of the spring by which the journal may stick to the race
(`contact.rubbing`). Over a step w = free + b w' is one equation in w. Its left side less its right
rises with w (friction falls with it, drag rises), and the largest friction gives bounds of its
root: Newton, kept between them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from ..contact.rubbing import contact_tangent, rub, rubbing_force, stretched, stretching
from ..contact.wall import ContactQuantities, compression, length, opening, touch
from ..kernels.compiled import called, compiled
from ..protocol.law import Law
from ..quantities import NOT_NEGATIVE, SPEED, Output, quantity
from .clearance_contact import LOSSES, OUTPUTS, STORES, ClearanceContact, observe_contact

_ITERATIONS = 100
_ROUNDING = 1e-14


@dataclass(frozen=True, kw_only=True)
class RaceQuantities:
    """What a race is: moment of inertia [kg.m2]; constant drag [N.m], which is smoothed below the
    speed race_w_s [rad/s], and viscous drag [N.m.s/rad]."""

    race_inertia: float = quantity("kg.m2", "moment of inertia of the race", is_parameter=True)
    race_drag: float = quantity(
        "N.m", "constant drag of the race", NOT_NEGATIVE, 0.0, is_parameter=True
    )
    race_damping: float = quantity(
        "N.m.s/rad", "viscous drag of the race", NOT_NEGATIVE, 0.0, is_parameter=True
    )
    race_w_s: float = quantity("rad/s", "race speed below which its drag is smoothed", default=0.1)


@dataclass(frozen=True, kw_only=True)
class TouchdownQuantities(ContactQuantities, RaceQuantities):
    """A clearance contact's, behind those of the race: numba takes a record that begins as another
    does for one of that kind."""


@compiled
def _drag(part, w):
    """Torque that brakes the race at the speed w [rad/s], and its derivative."""
    root = math.sqrt(w * w + part.race_w_s * part.race_w_s)
    smooth = part.race_w_s / root
    torque = part.race_drag * w / root + part.race_damping * w
    return torque, part.race_drag * smooth * smooth / root + part.race_damping


@compiled
def _radius(part):
    """Of the race's inner surface [m]."""
    return part.journal_radius + part.clearance


@compiled
def _race_speed(part, pressure, sliding, b, free, guess, free_z):
    """The race's speed at the end of a step [rad/s]; pressure: normal force [N], sliding: speed
    past a race at rest [m/s]; b: weight of the rate [s]; free_z: see `contact.rubbing` [m]."""
    per = b / part.race_inertia
    if per == 0.0:
        return free
    radius = _radius(part)
    largest = per * (radius * pressure * (part.mu + part.mu_rise) + part.race_drag)
    held = 1.0 / (1.0 + per * part.race_damping)
    low, high = (free - largest) * held, (free + largest) * held
    w = min(high, max(low, guess))
    for _ in range(_ITERATIONS):
        mu_t, slope, _, _ = rub(part, pressure, sliding - radius * w, b, free_z)
        drag, drag_slope = _drag(part, w)
        excess = w - free - per * (radius * mu_t * pressure - drag)
        if excess > 0.0:
            high = w
        else:
            low = w
        steepness = 1.0 + per * (radius * radius * slope * pressure + drag_slope)
        if abs(excess) <= _ROUNDING * (abs(free) + largest):
            break
        w = w - excess / steepness if steepness > 0.0 else low
        if not low < w < high:
            w = 0.5 * (low + high)
    return w


@called
def _force(part, tables, d, d_dot, speed, spin, own):
    """See `protocol.law`."""
    surface = part.journal_radius * spin - _radius(part) * own[0]
    return rubbing_force(part, d, d_dot, surface, own[1])[0]


@called
def _tangent(part, tables, d, d_dot, speed, spin, by_d, by_v, by_own, free, own):
    """See `protocol.law`."""
    delta, _, n, _, n_a, c, e, local, gradient, h, h_b = touch(part, d, d_dot)
    if delta <= 0.0 or n <= 0.0:
        own[0] = _race_speed(part, 0.0, 0.0, by_own, free[0], own[0], free[1])
        own[1] = rub(part, 0.0, 0.0, by_own, free[1])[3]
        return 0.0j, 0.0j, 0.0j
    steep = math.sqrt(1.0 + gradient.imag * gradient.imag)
    normal = gradient * (1.0 / steep)
    pressure = n * steep
    sliding = (normal.conjugate() * local).imag + part.journal_radius * spin
    w = _race_speed(part, pressure, sliding, by_own, free[0], own[0], free[1])
    radius = _radius(part)
    mu_t, slope, by_n, z = rub(part, pressure, sliding - radius * w, by_own, free[1])
    own[0], own[1] = w, z
    # the race follows a change dT of the friction by dw = b / J R dT / (1 + b / J drag')
    per = by_own / part.race_inertia
    follows = radius * per / (1.0 + per * _drag(part, w)[1])
    give = 1.0 / max(1e-3, 1.0 + pressure * slope * radius * follows)
    p, q = contact_tangent(
        e, local, n, n_a, c, gradient, h, h_b, mu_t, slope, by_n, give, by_d, by_v
    )
    return -complex(pressure, mu_t * pressure) * normal * e, p, q


@called
def _rates(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`."""
    surface = part.journal_radius * spin - _radius(part) * own[0]
    rubbing = rubbing_force(part, d, d_dot, surface, own[1])[2]
    out[0] = (_radius(part) * rubbing - _drag(part, own[0])[0]) / part.race_inertia
    out[1] = stretching(part, rubbing, own[1])


@compiled
def _energy(part, tables, d, own):
    """See `protocol.law`: contact, race."""
    elastic = compression(part, d) + stretched(part, own[1])
    return elastic, 0.5 * part.race_inertia * own[0] * own[0]


@called
def _dissipate(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`: contact damping, friction, drag."""
    surface = part.journal_radius * spin - _radius(part) * own[0]
    _, _, rubbing, damping, _, rate, sliding = rubbing_force(part, d, d_dot, surface, own[1])
    out[0] = damping * rate
    out[1] = rubbing * sliding - part.k_t * own[1] * stretching(part, rubbing, own[1])
    out[2] = _drag(part, own[0])[0] * own[0]
    return part.journal_radius * rubbing


@called
def _observe(part, tables, d, d_dot, speed, spin, own, out):
    """See `protocol.law`."""
    surface = part.journal_radius * spin - _radius(part) * own[0]
    _, normal, rubbing, _, _, _, sliding = rubbing_force(part, d, d_dot, surface, own[1])
    observe_contact(d, normal, rubbing, out)
    out[6] = own[0]
    out[7] = sliding


TOUCHDOWN_BEARING = Law(
    name="touchdown_bearing",
    kind=TouchdownQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    opening=opening,
    length=length,
    rates=_rates,
    observe=_observe,
    outputs=(
        *OUTPUTS,
        Output("race", "rad/s", "speed of the race", True, 100.0),
        Output("sliding", "m/s", "sliding speed while in contact", nominal=1.0, reached_by=SPEED),
    ),
    stores=(*STORES, Output("races", "J", "kinetic energy of the races", nominal=1.0)),
    losses=(*LOSSES, Output("drag", "J", "dissipated by the races' drag", nominal=1.0)),
    states=(0.0, 0.0),
    has_wall=True,
    turns=True,
)


@dataclass(frozen=True, kw_only=True)
class TouchdownBearing(TouchdownQuantities, ClearanceContact):
    """A touchdown (auxiliary, backup) bearing; its race stands still at the start."""

    KIND: ClassVar[str] = "touchdown_bearing"
    TEXT: ClassVar[str] = "a journal in the clearance of a race that friction turns"
    LAWS: ClassVar[tuple[Law, ...]] = (TOUCHDOWN_BEARING,)

    @property
    def law(self) -> Law:
        """That of a race."""
        return TOUCHDOWN_BEARING
