"""Static equilibrium under gravity and loads: how a run starts.

The same implicit step finds it, with a scheme that forgets velocities: with beta = 1 and no other
parameter a step of length tau solves (M / tau^2 + K) (q1 - q0) = f - K q0 + B F(q1), a step of
pseudo-transient continuation (Kelley and Keyes 1998). Its mass holds what is not yet held, a
journal in the air of its clearance, and is gone where the motion ends. Surfaces do not slide
meanwhile, so that there is no friction.
"""

from __future__ import annotations

from ..kernels.compiled import compiled, inlined
from ..kernels.functions import modulus
from ..parts.housing import masses
from ..schemes.family import Scheme
from ..step.excitation import falling, resting
from ..step.fitting import unfitted
from ..step.step import try_step

HELD, NOT_HELD, NOT_FOUND = 0, 1, 2
_ITERATIONS = 200
_FIRST = 10.0  # radians of the lowest mode that a step takes
_GROWTH, _LONGEST = 3.0, 1e6
_FAST = 0.1  # of one change to the next: what is slower takes longer steps
_SMALL = 1e-16  # a change that is rounding, of the largest displacement
_FALLS = 12  # steps that fail
_STEADY = 1e-9  # a change that no longer shrinks and is below this is rounding too
# A step's rounding is that of a fall through its length: the last ones are short.
_POLISH, _POLISHES = 1.0, 24


@compiled
def release(structure, motion, loads):
    """Fill motion.q and motion.v with what the machine is released with, its housings at rest on
    their springs."""
    n = structure.M.shape[0]
    r = structure.releases[0]
    for i in range(n):
        along, tilt = structure.one_body[0, i], structure.one_body[1, i]
        motion.q[i] = along * complex(r.x, r.y) + tilt * complex(r.tilt_x, r.tilt_y)
        motion.v[i] = along * complex(r.vx, r.vy) + tilt * complex(r.rate_x, r.rate_y)
    g = falling(structure, loads)
    for h in range(len(structure.housings)):
        housing = structure.housings[h]
        m_x, m_y = masses(housing)
        motion.q[n + h] = complex(m_x * g.real / housing.kx, m_y * g.imag / housing.ky)


@compiled
def _take(motion, trial):
    for i in range(len(motion.q)):
        motion.q[i] = trial.q[i]
    for j in range(len(motion.force)):
        motion.force[j] = trial.force[j]


@inlined
def find_equilibrium(structure, omega, motion, trial, memory, work, problem):
    """Fill motion.q with the displacements at rest at the speed omega [rad/s] under memory.loads,
    starting from those that are there; returns HELD or why not."""
    scheme = Scheme(0.0, 0.0, 1.0, 0.0)
    spin, fit = resting(omega), unfitted()
    lowest = structure.numbers[0].lowest_omega
    radians = _FIRST
    before = 0.0
    falls = 0
    status = NOT_FOUND
    for _ in range(_ITERATIONS):
        tau = radians / lowest
        done, _ = try_step(
            structure, scheme, fit, spin, tau, memory.loads, motion, trial, work, problem
        )
        if done != 0:
            # past the bound again and again: nothing holds it
            falls += 1
            if falls > _FALLS:
                status = NOT_HELD if done == 2 else NOT_FOUND
                break
            radians /= _GROWTH
            continue
        change = 0.0
        size = 0.0
        for i in range(len(motion.q)):
            change = max(change, modulus(trial.q[i] - motion.q[i]))
            size = max(size, modulus(trial.q[i]))
        _take(motion, trial)
        if change <= _SMALL * size or (change <= _STEADY * size and change >= 0.5 * before):
            status = HELD
            break
        if before > 0.0 and change > _FAST * before:
            radians = min(_GROWTH * radians, _LONGEST)
        before = change
    if status == HELD:
        for _ in range(_POLISHES):
            tau = _POLISH / lowest
            done, _ = try_step(
                structure, scheme, fit, spin, tau, memory.loads, motion, trial, work, problem
            )
            if done != 0:
                break
            _take(motion, trial)
    work.key[0] = -1.0
    return status
