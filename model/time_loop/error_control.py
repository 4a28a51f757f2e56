"""Error-controlled step lengths: the local error in the norm of the masses, and a PI controller.

The error of a step is taken per unit of time, in cycles of the motion, so that the error of a run
is proportional to the tolerance (Hairer, Norsett and Wanner, Solving Ordinary Differential
Equations I, sec. II.4; PI control: Gustafsson 1991).
"""

import math
from typing import NamedTuple

from ..kernels.functions import copy, fifth_root, scaled
from ..kernels.jit import jit
from ..step.laws import law_gap, relative

# Error of one radian as a share of the motion's size times the tolerance; revolutions over which
# the size is remembered; share of the clearance (or of a small length) below which there is no
# motion.
SHARE, TURNS, FLOOR = 0.7, 2.0, 1e-4
# Frequencies above so many times that of the slowest motion count as that: errors of a fast motion
# add up for as long as the slow one lasts.
FASTEST = 2.5
FIRST = 0.05  # revolutions over which the size at the start is remembered
SAFETY = 0.8
# Limits of the ratio of two step lengths; slow growth costs little and softens the next impact.
GROWTH, SHRINKAGE = 1.25, 0.2
# Steps of constant length: turns over which errors are remembered, the largest expected error of a
# longer step, and the factor by which it is longer.
STEADY_TURNS, STEADY_ERROR, STEADY_GROWTH = 4.0, 0.6, 4.0
CUT = 0.9  # a step below this share of the proposed length was cut, and does not reduce it
# The growth of a step in stages, whose error is of a higher order.
STAGE_GROWTH = 2.0
SMALLEST = 1e-8  # errors below it count as this one
# Share of a step before which a contact's opening or closing is worth ending a repeated step at.
LATE = 0.9


class Measures(NamedTuple):
    """Mean squares over the masses in a step: of the change of the accelerations, of their
    deviation from a whirl with the motion's characteristic frequency [m2/s4], and in the middle of
    the step of the acceleration [m2/s4] and the velocity [m2/s2]."""

    change: float
    beside_whirl: float
    acceleration: float
    velocity: float


NOTHING = Measures(0.0, 0.0, 0.0, 0.0)


@jit
def _product(x, y):
    """Return the real part of x conj(y)."""
    return x.real * y.real + x.imag * y.imag


@jit
def measure(weights, turned, old, new):
    """Return the `Measures` of a step; turned: factor e^(i p h) by which a whirl with the motion's
    characteristic frequency turns in it."""
    change, beside, acceleration, velocity = 0.0, 0.0, 0.0, 0.0
    for j in range(len(weights)):
        i, k, weight = weights[j].i, weights[j].k, weights[j].weight
        change += weight * _product(new.a[i] - old.a[i], new.a[k] - old.a[k])
        beside += weight * _product(new.a[i] - turned * old.a[i], new.a[k] - turned * old.a[k])
        acceleration += weight * _product(new.a[i] + old.a[i], new.a[k] + old.a[k])
        velocity += weight * _product(new.v[i] + old.v[i], new.v[k] + old.v[k])
    return Measures(change, beside, 0.25 * acceleration, 0.25 * velocity)


@jit
def update_size(structure, omega, h, new, memory):
    """Update the size of the motion over the last revolutions, after a step of length h [s].

    The size is the root mean square, over the masses, of the amplitude about the mean position: for
    a swing with the speed of rotation, or with that of the slowest motion if this is faster, it is
    that of displacement and velocity over that speed. It decays by exp(-1) in `TURNS` turns of that
    speed after the motion has ceased; at first sooner, the memory being no longer than the run,
    since a journal pressed on its wall starts with the accelerations of a large swing into a far
    smaller motion. Sizes below `FLOOR` count as `FLOOR`.
    """
    r = memory.record[0]
    numbers = structure.numbers[0]
    fastest = max(numbers.slowest, abs(omega))
    turns = h * fastest / (2.0 * math.pi)
    r.turns_remembered = min(TURNS, r.turns_remembered + turns)
    share = min(1.0, turns / r.turns_remembered)
    center = memory.center
    for i in range(len(center)):
        center[i] += scaled(share, new.q[i] - center[i])
    apart, velocity = 0.0, 0.0
    weights = structure.weights
    for j in range(len(weights)):
        i, k, weight = weights[j].i, weights[j].k, weights[j].weight
        apart += weight * _product(new.q[i] - center[i], new.q[k] - center[k])
        velocity += weight * _product(new.v[i], new.v[k])
    seen = math.sqrt(0.5 * (apart + velocity / (fastest * fastest)))
    floor = FLOOR * min(numbers.clearance, numbers.small)
    r.motion_size = max(floor, seen, (1.0 - share) * r.motion_size)


@jit
def first_size(structure, omega, motion, memory):
    """Initialize the size of the motion: that of a swing with the speed of rotation, or with that
    of the slowest motion, that has the accelerations of the start."""
    fastest = max(structure.numbers[0].slowest, abs(omega))
    copy(motion.q, memory.center)
    # the start taken as both ends of a step
    start = measure(structure.weights, 1.0 + 0.0j, motion, motion)
    r = memory.record[0]
    r.motion_size = math.sqrt(start.acceleration) / (fastest * fastest)
    r.turns_remembered = FIRST
    update_size(structure, omega, 0.0, motion, memory)


@jit
def local_error(structure, control, size, frequency, h, measures):
    """Return the error of a step of length h [s] relative to the tolerated one [1]; size: of the
    motion [m], frequency: of the motion [rad/s].

    Displacements are mass-weighted (root mean square), so that neither the turning point of one
    node nor a light journal rattling in its clearance dominates. Tolerated is a share of the
    motion's size in each of the `radians_of` the motion.

    At the turning point of a swing along a line the accelerations do not change for a moment; there
    the deviation from a whirl with this frequency is used.
    """
    change = math.sqrt(max(measures.change, measures.beside_whirl))
    tolerated = tolerated_error(structure, control, size, frequency, h)
    return abs(control.error_constant) * h * h * change / tolerated


@jit
def tolerated_error(structure, control, size, frequency, h):
    """Return the tolerated error of displacements in a step of length h [s], in [m]; size,
    frequency: see `local_error`."""
    return SHARE * radians_of(structure, frequency, h) * control.tolerance * size


@jit
def radians_of(structure, frequency, h):
    """Return the length of a step [rad] of the motion; its frequency counts as at least that of the
    slowest one and at most `FASTEST` times that."""
    slowest = structure.numbers[0].slowest
    return h * max(slowest, min(abs(frequency), FASTEST * slowest))


@jit
def whirl_error(structure, control, h, new):
    """Return the error of a step of length h [s] that ends in contact and may be too long to
    resolve a growing whirl there [1]: while the whirl's amplitude is below the tolerance, no other
    error shows that it is not resolved."""
    for j in range(len(structure.interfaces)):
        if structure.interfaces[j].has_wall == 1 and new.force[j] != 0.0:
            ratio = h / control.h_in_contact
            return ratio * ratio
    return 0.0


@jit
def next_length(proposed, h, error, error_before):
    """Return the proposed length of the next step [s] after one of length h [s] with these last
    errors [1]; a communication point may have cut h shorter than proposed, which does not count
    against it.

    The factor is SAFETY error^-0.35 trend^0.2, of gains for an error per unit of time of order 2.
    """
    error = max(error, SMALLEST)
    trend = max(error_before, SMALLEST) / error
    fifth = fifth_root(error)
    twentieth = math.sqrt(math.sqrt(fifth))
    factor = SAFETY * fifth_root(trend) / (fifth * twentieth * twentieth * twentieth)
    shortest = SHRINKAGE * h if h > CUT * proposed else proposed
    return min(GROWTH * proposed, max(shortest, factor * h))


@jit
def next_stage_length(proposed, h, error, error_before):
    """Return the proposed length after a step in stages, as `next_length`: SAFETY error^-0.175
    trend^0.1, of gains for an error per unit of time of order 4."""
    error = max(error, SMALLEST)
    trend = max(error_before, SMALLEST) / error
    fifth = fifth_root(error)
    fortieth = math.sqrt(math.sqrt(math.sqrt(fifth)))
    factor = SAFETY * math.sqrt(fifth_root(trend)) * fortieth / fifth
    shortest = SHRINKAGE * h if h > CUT * proposed else proposed
    return min(STAGE_GROWTH * proposed, max(shortest, factor * h))


@jit
def steady_length(structure, control, omega, proposed, h, error, memory):
    """Return the proposed next step of a machine that is unstable with its contacts open [s].

    Steps that lengthen and shorten with a beat of the motion feed it or damp it as a slow growth
    does. So they stay constant, and lengthen only if the errors of many turns allow it.
    """
    r = memory.record[0]
    fastest = max(structure.numbers[0].slowest, abs(omega))
    share = min(1.0, h * fastest / (2.0 * math.pi * STEADY_TURNS))
    r.error_peak = max(error, (1.0 - share) * r.error_peak)
    growth = math.sqrt(STEADY_ERROR / max(r.error_peak, SMALLEST))
    if control.stages > 0:
        growth = math.sqrt(growth)
    growth = min(STEADY_GROWTH, growth)
    if growth < GROWTH or h < CUT * proposed:
        return proposed
    r.error_peak *= growth * growth * (1.0 if control.stages == 0 else growth * growth)
    return max(control.h_min, min(control.h_in_the_open, control.h_max, growth * proposed))


@jit
def repeated_length(structure, control, h, error, old, new):
    """Return the length with which a step with too large an error is repeated [s].

    It follows from the error, or extends, if this is longer, to where a contact opens or closes:
    the two parts of such a step are smooth, and only their joint is not.
    """
    joint = 1.0
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        before = law_gap(structure.laws, interface, relative(interface, old.q))
        after = law_gap(structure.laws, interface, relative(interface, new.q))
        if before * after < 0.0:
            joint = min(joint, before / (before - after))
    falls = math.sqrt(error)
    if control.stages > 0 and joint == 1.0:
        falls = math.sqrt(falls)
    share = max(SHRINKAGE, SAFETY / falls)
    return h * (joint if share < joint < LATE else share)
