"""A touchdown bearing: a clearance contact whose inner race turns, driven by friction.

The journal slides past the race, which turns with w, at

    v_t = (tangential velocity of the journal) + R spin - (R + clearance) w

and the friction force T that brakes the journal drives the race against its drag:

    J w' = (R + clearance) T - drag w / sqrt(w^2 + w_s^2) - damping w

Its states are w and the elongation of the spring by which the journal may stick to the race
(`contact.rubbing`). Over a step w = free + b w' is one equation in w. Its residual rises with w
(friction falls with it, drag rises), and the largest friction bounds its root: Newton's method,
kept between the bounds.
"""

import math
from dataclasses import dataclass, replace
from typing import ClassVar

from ..contact.rubbing import contact_tangent, rub, rubbing, stretched, stretching
from ..contact.wall import ContactQuantities, compression, touch
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import NOT_NEGATIVE, SPEED, Output, places, quantity
from .clearance_contact import CLEARANCE_CONTACT, STORES, ClearanceContact, observe_contact
from .clearance_contact import LOSSES as CONTACT_LOSSES
from .clearance_contact import OUTPUTS as CONTACT_OUTPUTS
from .law import Law

_ITERATIONS = 100
_ROUNDING = 1e-14


@dataclass(frozen=True, kw_only=True)
class RaceQuantities:
    """The quantities of a race: moment of inertia [kg.m2]; constant drag [N.m], which is smoothed
    below the speed race_w_s [rad/s], and viscous drag [N.m.s/rad]."""

    race_inertia: float = quantity("kg.m2", "moment of inertia of the race", is_parameter=True)
    race_drag: float = quantity(
        "N.m", "constant drag of the race", NOT_NEGATIVE, 0.0, is_parameter=True
    )
    race_damping: float = quantity(
        "N.m.s/rad", "viscous drag of the race", NOT_NEGATIVE, 0.0, is_tunable=True
    )
    race_w_s: float = quantity("rad/s", "race speed below which its drag is smoothed", default=0.1)


@dataclass(frozen=True, kw_only=True)
class TouchdownQuantities(ContactQuantities, RaceQuantities):
    """The quantities of the race, then those of a clearance contact: numba accepts a record that
    begins like another as one of that type."""


@jit
def _drag(part, w):
    """Return the torque that brakes the race at the speed w [rad/s], and its derivative."""
    root = math.sqrt(w * w + part.race_w_s * part.race_w_s)
    smooth = part.race_w_s / root
    torque = part.race_drag * w / root + part.race_damping * w
    return torque, part.race_drag * smooth * smooth / root + part.race_damping


@jit
def _radius(part):
    """Return the radius of the race's inner surface [m]."""
    return part.journal_radius + part.clearance


@jit
def _race_speed(part, pressure, sliding, b, free, guess, free_z):
    """Return the race's speed at the end of a step [rad/s]; pressure: normal force [N], sliding:
    speed past a race at rest [m/s]; b: weight of the rate [s]; free_z: see `contact.rubbing`
    [m]."""
    per = b / part.race_inertia
    if per == 0.0:
        return free
    radius = _radius(part)
    largest = per * (radius * pressure * (part.mu + part.mu_rise) + part.race_drag)
    factor = 1.0 / (1.0 + per * part.race_damping)
    low, high = (free - largest) * factor, (free + largest) * factor
    w = min(high, max(low, guess))
    for _ in range(_ITERATIONS):
        rubs = rub(part, pressure, sliding - radius * w, b, free_z)
        drag, drag_slope = _drag(part, w)
        excess = w - free - per * (radius * rubs.coefficient * pressure - drag)
        if excess > 0.0:
            high = w
        else:
            low = w
        steepness = 1.0 + per * (radius * radius * rubs.by_sliding * pressure + drag_slope)
        if abs(excess) <= _ROUNDING * (abs(free) + largest):
            return w - excess / max(1.0, steepness)  # differences see what the guess is off by
        w = w - excess / steepness if steepness > 0.0 else low
        if not low < w < high:
            w = 0.5 * (low + high)
    return w


OUTPUTS = (
    *CONTACT_OUTPUTS,
    Output("race", "rad/s", "speed of the race", True, 100.0),
    Output("sliding", "m/s", "sliding speed while in contact", nominal=1.0, reached_by=SPEED),
)
LOSSES = (*CONTACT_LOSSES, Output("drag", "J", "dissipated by the races' drag", nominal=1.0))
_OUT, _LOSS = places(OUTPUTS), places(LOSSES)
_STATE = places(("race", "elongation"))


@jit
def _rubbing(part, kinematics, internal_state):
    """Return the `Rubbing` of the journal on the race."""
    surface = (
        part.journal_radius * kinematics.sliding_speed - _radius(part) * internal_state[_STATE.race]
    )
    return rubbing(part, kinematics, surface, internal_state[_STATE.elongation])


@jit_not_inlined
def _force(part, tables, kinematics, internal_state):
    return _rubbing(part, kinematics, internal_state).force


@jit_not_inlined
def _tangent(part, tables, kinematics, weights, free, internal_state):
    at, b = touch(part, kinematics), weights.rate
    free_w, free_z, guess = free[_STATE.race], free[_STATE.elongation], internal_state[_STATE.race]
    if at.penetration <= 0.0 or at.normal <= 0.0:
        internal_state[_STATE.race] = _race_speed(part, 0.0, 0.0, b, free_w, guess, free_z)
        internal_state[_STATE.elongation] = rub(part, 0.0, 0.0, b, free_z).elongation
        return 0.0j, 0.0j, 0.0j
    steep = math.sqrt(1.0 + at.gradient.imag * at.gradient.imag)
    normal = at.gradient * (1.0 / steep)
    pressure = at.normal * steep
    surface = part.journal_radius * kinematics.sliding_speed
    sliding = (normal.conjugate() * at.velocity).imag + surface
    w = _race_speed(part, pressure, sliding, b, free_w, guess, free_z)
    radius = _radius(part)
    rubs = rub(part, pressure, sliding - radius * w, b, free_z)
    internal_state[_STATE.race], internal_state[_STATE.elongation] = w, rubs.elongation
    # the race follows a change dT of the friction by dw = b / J R dT / (1 + b / J drag')
    per = b / part.race_inertia
    follows = radius * per / (1.0 + per * _drag(part, w)[1])
    friction_share = 1.0 / max(1e-3, 1.0 + pressure * rubs.by_sliding * radius * follows)
    p, q = contact_tangent(at, rubs, friction_share, weights)
    return -complex(pressure, rubs.coefficient * pressure) * normal * at.direction, p, q


@jit_not_inlined
def _rates(part, tables, kinematics, internal_state, out):
    friction = _rubbing(part, kinematics, internal_state).friction
    drag = _drag(part, internal_state[_STATE.race])[0]
    out[_STATE.race] = (_radius(part) * friction - drag) / part.race_inertia
    out[_STATE.elongation] = stretching(part, friction, internal_state[_STATE.elongation])


@jit
def _energy(part, tables, displacement, internal_state):
    elastic = compression(part, displacement) + stretched(part, internal_state[_STATE.elongation])
    w = internal_state[_STATE.race]
    return elastic, 0.5 * part.race_inertia * w * w


@jit_not_inlined
def _dissipate(part, tables, kinematics, internal_state, out):
    contact = _rubbing(part, kinematics, internal_state)
    w, z = internal_state[_STATE.race], internal_state[_STATE.elongation]
    spring = part.k_t * z * stretching(part, contact.friction, z)
    out[_LOSS.contact] = contact.damping * contact.rate
    out[_LOSS.friction] = contact.friction * contact.sliding - spring
    out[_LOSS.drag] = _drag(part, w)[0] * w
    return part.journal_radius * contact.friction


@jit_not_inlined
def _observe(part, tables, kinematics, internal_state, out):
    contact = _rubbing(part, kinematics, internal_state)
    observe_contact(kinematics.displacement, contact, out)
    out[_OUT.race] = internal_state[_STATE.race]
    out[_OUT.sliding] = contact.sliding


TOUCHDOWN_BEARING = replace(
    CLEARANCE_CONTACT,
    name="touchdown_bearing",
    kind=TouchdownQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    rates=_rates,
    observe=_observe,
    outputs=OUTPUTS,
    stores=(*STORES, Output("races", "J", "kinetic energy of the races", nominal=1.0)),
    losses=LOSSES,
    states=tuple(0.0 for _ in _STATE),
    state_units=lambda part: ("rad/s", "m"),
    turns=True,
)


@dataclass(frozen=True, kw_only=True)
class TouchdownBearing(TouchdownQuantities, ClearanceContact):
    """A touchdown (auxiliary, backup) bearing; its race is at rest at the start."""

    KIND: ClassVar[str] = "touchdown_bearing"
    TEXT: ClassVar[str] = "a journal in the clearance of a race that is turned by friction"
    LAWS: ClassVar[tuple[Law, ...]] = (TOUCHDOWN_BEARING,)

    @property
    def law(self) -> Law:
        """The law of a contact with a race."""
        return TOUCHDOWN_BEARING
