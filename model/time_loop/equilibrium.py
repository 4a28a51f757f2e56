"""Static equilibrium under gravity and loads: how a run starts.

The same implicit step finds it, with a scheme that forgets velocities: with beta = 1 and no other
parameter a step of length tau solves (M / tau^2 + K) (q1 - q0) = f - K q0 + B F(q1), a step of
pseudo-transient continuation (Kelley and Keyes 1998). Its mass holds what is not yet held, a
journal in the air of its clearance, and is gone where the motion ends. Surfaces do not slide
meanwhile, so that there is no friction.
"""

from __future__ import annotations

import math

from ..kernels.functions import angle, direction, modulus
from ..kernels.jit import jit, jit_inlined, jit_not_inlined
from ..parts.housing import masses
from ..parts.law import Weights
from ..schemes.family import Scheme
from ..step.excitation import free_fall_acceleration, static_spin
from ..step.fitting import unfitted
from ..step.laws import at_rest, law_tangent_called, relative
from ..step.step import try_step
from ..step.step_status import DONE, NOT_FINITE

HELD, NOT_HELD, NOT_CONVERGED_AT_REST, UNSTABLE, BEYOND, MOVED = 0, 1, 2, 3, 4, 5
_ITERATIONS = 200
_FIRST = 10.0  # radians of the lowest mode that a step takes
_GROWTH, _LONGEST = 3.0, 1e6
_FAST = 0.1  # of one change to the next: what is slower takes longer steps
_SMALL = 1e-16  # a change that is rounding, of the largest displacement
_FALLS = 12  # steps that fail
# A change that no longer shrinks and is below this is rounding too; in long steps that of a shaft
# that is stiff by many decades, which the last steps leave behind.
_STEADY, _STIFF, _LONG = 1e-9, 1e-6, 200.0
_FALL = 8.0 * 2.0**-53  # of the free fall through a step: rounding
_MIDDLE = 1e-12  # of the smallest clearance: a rest so close to the middle is rounding, of preloads
# Of the stiffest element's force, against that of the softest mode; what rounding may take from a
# rest before it is none.
_EPSILON, _WORST = 2.0**-53, 1e-4
# A step's rounding is that of a fall through its length: the last ones are short.
_POLISH, _POLISHES = 1.0, 24
# Off a hump: how often; the push, of a clearance, and the share of it that tilts; the first step,
# in radians, how much longer the next one is, how many there are; what is back, of the push, and
# what has arrived, of the largest force.
_HUMPS, _PUSH, _TILTED, _DOWNHILL, _LONGER, _STEPS = 5, 1e-3, 0.3, 0.3, 1.2, 5000
_BACK, _ARRIVED = 0.1, 1e-3
_ROUND = 1e-9  # of a wall's stiffness: below it is rounding


@jit
def release(structure, motion, loads):
    """Fill motion.q and motion.v with what the machine is released with, its housings at rest on
    their springs."""
    n = structure.M.shape[0]
    r = structure.releases[0]
    for i in range(n):
        along, tilt = structure.one_body[0, i], structure.one_body[1, i]
        motion.q[i] = along * complex(r.x, r.y) + tilt * complex(r.tilt_x, r.tilt_y)
        motion.v[i] = along * complex(r.vx, r.vy) + tilt * complex(r.rate_x, r.rate_y)
    g = free_fall_acceleration(structure, loads)
    for h in range(len(structure.housings)):
        housing = structure.housings[h]
        m_x, m_y = masses(housing)
        motion.q[n + h] = complex(m_x * g.real / housing.kx, m_y * g.imag / housing.ky)


@jit
def _take(motion, trial):
    for i in range(len(motion.q)):
        motion.q[i] = trial.q[i]
    for j in range(len(motion.force)):
        motion.force[j] = trial.force[j]
    for i in range(len(motion.internal_state)):
        motion.internal_state[i] = trial.internal_state[i]


@jit_not_inlined
def _step(structure, spin, tau, loads, motion, trial, work, problem):
    """Take a step of length tau [s] without velocity, to `trial`; returns its status and how many
    iterations it took."""
    scheme = Scheme(0.0, 0.0, 1.0, 0.0)
    return try_step(
        structure, scheme, unfitted(), spin, tau, loads, motion, trial, work, problem, 0
    )


@jit
def is_beyond(structure, motion):
    """Return whether a deflection is larger than any machine's."""
    bound = structure.numbers[0].bound
    for i in range(len(structure.deflections)):
        if modulus(motion.q[structure.deflections[i, 0]]) > bound:
            return True
    return False


@jit_not_inlined
def _hump(structure, omega, motion, problem):
    """Return the largest rate at which a journal that touches its wall would be driven away along
    it [1/s], and the direction, to the right if possible [1]; 0 if there is none: only the wear of
    a bore does that."""
    steepest, where = 0.0, 0.0j
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.has_wall == 0 or motion.force[j] == 0.0:
            continue
        d = relative(interface, motion.q)
        internal_state = motion.internal_state[interface.internal_state :]
        _force, p, q = law_tangent_called(
            structure.laws,
            interface,
            at_rest(d, omega),
            Weights(1.0, 0.0, 0.0),
            internal_state,
            problem.internal_state[interface.internal_state :],
        )
        # the largest of the symmetric part of p z + q conj(z)
        driven = p.real + modulus(q)
        if driven <= _ROUND * modulus(p):
            continue
        lightest = structure.M[interface.dof, 0]
        wall = interface.end - structure.M.shape[0]
        if wall < len(structure.housings):
            lightest = min(lightest, min(masses(structure.housings[wall])))
        if driven > steepest * steepest * lightest:
            steepest = math.sqrt(driven / lightest)
            along = direction(0.5 * angle(q))
            steepest, where = driven, along if along.real >= 0.0 else -along
    return steepest, where


@jit_inlined
def _leave(structure, motion, trial, memory, work, problem, spin, steepest, where):
    """Push a machine off the hump that it lies on and let it go downhill; returns HELD if it comes
    back, to where it lay, UNSTABLE if it gets nowhere, and MOVED if it lies beside the hump.

    In steps so short that inertia outweighs the hump, implicit steps without velocity never gain
    potential energy, and go on as they began; a longer one that turns back is made anew.
    """
    deflections = structure.deflections
    start, step = motion.v_dot, motion.jerk  # nobody's until the run begins
    widest = 0.0
    for i in range(len(deflections)):
        widest = max(widest, abs(structure.one_body[1, deflections[i, 0]]))
    for i in range(len(motion.q)):
        start[i] = motion.q[i]
    push = _PUSH * structure.numbers[0].clearance
    for i in range(len(structure.weight)):
        shape = structure.one_body[0, i] + _TILTED / widest * structure.one_body[1, i]
        motion.q[i] += push * shape * where
    shortest = _DOWNHILL / steepest
    tau = shortest
    status = UNSTABLE
    fastest = 0.0
    for _ in range(_STEPS):
        done, _ = _step(structure, spin, tau, memory.loads, motion, trial, work, problem)
        if done == NOT_FINITE:
            break
        change = away = onward = 0.0
        for i in range(len(deflections)):
            dof = deflections[i, 0]
            moved = trial.q[dof] - motion.q[dof]
            change = max(change, modulus(moved))
            away = max(away, modulus(trial.q[dof] - start[dof]))
            onward += (step[dof].conjugate() * moved).real
        if tau > shortest and (done != DONE or onward < 0.0):
            tau = max(shortest, 0.25 * tau)
            continue
        for i in range(len(motion.q)):
            step[i] = trial.q[i] - motion.q[i]
        _take(motion, trial)
        if away < _BACK * push:
            status = HELD
            break
        acceleration = change / (tau * tau)
        fastest = max(fastest, acceleration)
        if away > 10.0 * push and acceleration < _ARRIVED * fastest:
            status = MOVED
            break
        tau *= _LONGER
    for i in range(len(motion.q)):
        if status != MOVED:
            motion.q[i] = start[i]
        start[i] = 0.0
        step[i] = 0.0
    return status


@jit_inlined
def find_equilibrium(structure, omega, motion, trial, memory, work, problem):
    """Fill motion.q with the displacements at rest at the speed omega [rad/s] under memory.loads,
    starting from those that are there; returns HELD or why not. Of a bore worn so that the rest
    below the load is a hump, that beside it is taken."""
    spin = static_spin(omega)
    status = NOT_CONVERGED_AT_REST
    for _ in range(_HUMPS):
        status = _settle(structure, spin, motion, trial, memory, work, problem)
        if status != HELD:
            break
        # Short steps lead away from a hump, but in a direction that rounding chose.
        steepest, where = _hump(structure, omega, motion, problem)
        if steepest != 0.0:
            status = _leave(structure, motion, trial, memory, work, problem, spin, steepest, where)
        if status == HELD:
            status = _polish(structure, spin, motion, trial, memory, work, problem)
        if status != MOVED:
            break
    work.key[0] = -1.0
    return UNSTABLE if status == MOVED else status


@jit_inlined
def _settle(structure, spin, motion, trial, memory, work, problem):
    """Find an equilibrium, whether it is stable or not."""
    lowest = structure.numbers[0].lowest_omega
    stiffest = mass = 0.0
    for i in range(len(structure.weight)):
        stiffest = max(stiffest, structure.K[i, 0])
        mass += structure.one_body[0, i] * structure.mass_sum[i]
    of_stiffness = _EPSILON * len(structure.weight) * stiffest / (mass * lowest * lowest)
    of_stiffness = min(of_stiffness, _WORST)
    radians = _FIRST
    before = 0.0
    falls = 0
    taken = 0
    status = NOT_CONVERGED_AT_REST
    for _ in range(_ITERATIONS):
        if taken > memory.record[0].max_iterations:
            break
        tau = radians / lowest
        done, iterations = _step(structure, spin, tau, memory.loads, motion, trial, work, problem)
        taken += iterations
        if done != DONE:
            # past the bound again and again: nothing holds it
            falls += 1
            if falls > _FALLS:
                status = NOT_HELD if done == NOT_FINITE else NOT_CONVERGED_AT_REST
                break
            radians /= _GROWTH
            continue
        change = 0.0
        size = 0.0
        for i in range(len(motion.q)):
            change = max(change, modulus(trial.q[i] - motion.q[i]))
            size = max(size, modulus(trial.q[i]))
        _take(motion, trial)
        rounding = max(_STEADY if radians < _LONG else _STIFF, of_stiffness) * size
        for j in range(len(problem.w_free)):
            rounding = max(rounding, _FALL * tau * tau * modulus(problem.w_free[j]))
        is_steady = change <= rounding or size <= _MIDDLE * structure.numbers[0].clearance
        if change <= _SMALL * size or (is_steady and change >= 0.5 * before):
            status = HELD
            break
        if before > 0.0 and change > _FAST * before:
            radians = min(_GROWTH * radians, _LONGEST)
        before = change
    return status


@jit_inlined
def _polish(structure, spin, motion, trial, memory, work, problem):
    """Take an equilibrium's rounding away by short steps; returns HELD, or MOVED where they lead
    away from it."""
    lowest = structure.numbers[0].lowest_omega
    result = motion.v_dot  # nobody's until the run begins
    for i in range(len(motion.q)):
        result[i] = motion.q[i]
    for _ in range(_POLISHES):
        tau = _POLISH / lowest
        done, _ = _step(structure, spin, tau, memory.loads, motion, trial, work, problem)
        if done != DONE:
            break
        _take(motion, trial)
    drift = 0.0
    for i in range(len(motion.q)):
        drift = max(drift, modulus(motion.q[i] - result[i]))
        result[i] = 0.0
    return MOVED if drift > _PUSH * structure.numbers[0].clearance else HELD
