"""Static equilibrium under gravity and loads, in which a run starts.

It is found by the same implicit step with a scheme without velocities: with beta = 1 and no other
parameter a step of length tau solves (M / tau^2 + K) (q1 - q0) = f - K q0 + B F(q1), a step of
pseudo-transient continuation (Kelley and Keyes 1998). The mass term restrains what is not yet
supported, a journal that does not touch its wall, and vanishes where the motion ends. Surfaces do
not slide meanwhile, so that there is no friction.
"""

import math

from ..kernels.functions import angle, copy, direction, modulus
from ..kernels.jit import jit, jit_inlined, jit_not_inlined
from ..parts.housing import masses
from ..parts.law import Weights
from ..schemes.family import Scheme
from ..step.excitation import free_fall_acceleration, static_spin
from ..step.fitting import unfitted
from ..step.interface_problem import TOWARDS_REST
from ..step.laws import at_rest, law_tangent_called, relative
from ..step.step import try_step
from ..step.step_status import DONE, NOT_FINITE

AT_EQUILIBRIUM, NOT_SUPPORTED, NOT_CONVERGED_AT_REST, UNFINISHED_AT_REST = range(4)
UNSTABLE, OUT_OF_BOUNDS, MOVED = range(4, 7)
_ITERATIONS = 200
_FIRST = 10.0  # first pseudo-time step, in radians of the lowest mode
_GROWTH, _LONGEST = 3.0, 1e6
_AGAIN = 1.5  # growth of the longest step with each step after a failed one
_FAST = 0.1  # ratio of two changes above which the steps become longer
_SMALL = 1e-16  # share of the largest displacement below which a change is rounding
_FAILURES = 12  # failed steps at most
# A change that no longer shrinks is rounding as well if it is below the first share; in steps
# longer than the third the second applies, for a very stiff shaft, whose rounding the last steps
# remove.
_STEADY, _STIFF, _LONG = 1e-9, 1e-6, 200.0
_FALL = 8.0 * 2.0**-53  # rounding, as a share of the free fall through a step
# Share of the interfaces' forces that may be left where no longer step is solved: as a film begins
# to bear, its force grows with the square root of the way.
_BALANCED = 1e-6
_MIDDLE = 1e-12  # share of the smallest clearance: closer to the middle it is rounding
# Rounding of the stiffest element's force, compared with the force of the softest mode; the largest
# relative error of an equilibrium by rounding.
_EPSILON, _WORST = 2.0**-53, 1e-4
# The rounding of a step is proportional to the free fall in it: the last steps are short.
_POLISH, _POLISHES = 1.0, 24
# Departure from an unstable equilibrium: how often; the push, as a share of a clearance, and the
# share of it that tilts; the first step [rad], the growth of the steps and their number; the share
# of the push below which the machine has come back, and that of the largest force below which it
# has arrived.
_DEPARTURES, _PUSH, _TILTED, _DOWNHILL, _LONGER, _STEPS = 5, 1e-3, 0.3, 0.3, 1.2, 5000
_BACK, _ARRIVED = 0.1, 1e-3
_ROUND = 1e-9  # share of a wall's stiffness below which a stiffness is rounding


@jit
def release(structure, motion, loads):
    """Fill motion.q and motion.v with the initial motion of the machine's release, its housings in
    equilibrium on their springs."""
    n = structure.M.shape[0]
    r = structure.releases[0]
    for i in range(n):
        along, tilt = structure.one_body[0, i], structure.one_body[1, i]
        motion.q[i] = along * complex(r.x, r.y) + tilt * complex(r.tilt_x, r.tilt_y)
        motion.v[i] = along * complex(r.vx, r.vy) + tilt * complex(r.rate_x, r.rate_y)
    g = free_fall_acceleration(structure, loads)
    for k in range(len(structure.housings)):
        housing = structure.housings[k]
        m_x, m_y = masses(housing)
        motion.q[n + k] = complex(m_x * g.real / housing.kx, m_y * g.imag / housing.ky)


@jit
def _copy_state(motion, trial):
    copy(trial.q, motion.q)
    copy(trial.force, motion.force)
    copy(trial.internal_state, motion.internal_state)


@jit_not_inlined
def _step(structure, spin, tau, loads, motion, trial, work, problem, limit):
    """Take a step of length tau [s] without velocity, to `trial`; limit: see `solve_interfaces`.
    Return its status and number of iterations."""
    scheme = Scheme(0.0, 0.0, 1.0, 0.0)
    return try_step(
        structure, scheme, unfitted(), spin, tau, loads, motion, trial, work, problem, limit
    )


@jit
def is_out_of_bounds(structure, motion):
    """Return whether a deflection is larger than that of any machine."""
    bound = structure.numbers[0].bound
    for i in range(len(structure.deflections)):
        if modulus(motion.q[structure.deflections[i, 0]]) > bound:
            return True
    return False


@jit_not_inlined
def _steepest_instability(structure, omega, motion, problem):
    """Return how strongly a journal in contact is driven away along its wall, for the worst one,
    and the direction, to the right if possible [1]; 0 if none is: only the wear of a bore causes
    that."""
    steepest, escape = 0.0, 0.0j
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
            steepest, escape = driven, along if along.real >= 0.0 else -along
    return steepest, escape


@jit_inlined
def _move_off_unstable_equilibrium(
    structure, motion, trial, memory, work, problem, spin, steepest, escape
):
    """Perturb an unstable equilibrium and follow pseudo-time steps until a stable one is reached;
    return AT_EQUILIBRIUM if the machine comes back to where it was, UNSTABLE if it does not arrive,
    and MOVED if it reaches another equilibrium.

    In steps so short that inertia outweighs the instability, implicit steps without velocity never
    gain potential energy, and keep their direction; a longer one that turns back is repeated.
    """
    deflections = structure.deflections
    start, step = motion.v_dot, motion.jerk  # unused until the run begins
    widest = 0.0
    for i in range(len(deflections)):
        widest = max(widest, abs(structure.one_body[1, deflections[i, 0]]))
    copy(motion.q, start)
    push = _PUSH * structure.numbers[0].clearance
    for i in range(len(structure.static_load)):
        shape = structure.one_body[0, i] + _TILTED / widest * structure.one_body[1, i]
        motion.q[i] += push * shape * escape
    shortest = _DOWNHILL / steepest
    tau = shortest
    status = UNSTABLE
    fastest = 0.0
    for _ in range(_STEPS):
        step_status, _ = _step(structure, spin, tau, memory.loads, motion, trial, work, problem, 0)
        if step_status == NOT_FINITE:
            break
        change = distance = progress = 0.0
        for i in range(len(deflections)):
            dof = deflections[i, 0]
            moved = trial.q[dof] - motion.q[dof]
            change = max(change, modulus(moved))
            distance = max(distance, modulus(trial.q[dof] - start[dof]))
            progress += (step[dof].conjugate() * moved).real
        if tau > shortest and (step_status != DONE or progress < 0.0):
            tau = max(shortest, 0.25 * tau)
            continue
        for i in range(len(motion.q)):
            step[i] = trial.q[i] - motion.q[i]
        _copy_state(motion, trial)
        if distance < _BACK * push:
            status = AT_EQUILIBRIUM
            break
        acceleration = change / (tau * tau)
        fastest = max(fastest, acceleration)
        if distance > 10.0 * push and acceleration < _ARRIVED * fastest:
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
    """Fill motion.q with the static displacements at the speed omega [rad/s] under memory.loads,
    starting from the present ones; return AT_EQUILIBRIUM or why there is none. In a worn bore with
    an unstable equilibrium below the load, the stable one beside it is taken."""
    spin = static_spin(omega)
    status = NOT_CONVERGED_AT_REST
    for _ in range(_DEPARTURES):
        status = _converge(structure, spin, motion, trial, memory, work, problem)
        if status != AT_EQUILIBRIUM:
            break
        # Short steps lead away from a hump, but in a direction that rounding chose.
        steepest, escape = _steepest_instability(structure, omega, motion, problem)
        if steepest != 0.0:
            status = _move_off_unstable_equilibrium(
                structure, motion, trial, memory, work, problem, spin, steepest, escape
            )
        if status == AT_EQUILIBRIUM:
            status = _polish(structure, spin, motion, trial, memory, work, problem)
        if status != MOVED:
            break
    work.key[0] = -1.0
    return UNSTABLE if status == MOVED else status


@jit_not_inlined
def _converge(structure, spin, motion, trial, memory, work, problem):
    """Find an equilibrium, whether it is stable or not: by steps of which none is expensive, and,
    if these lead nowhere, again from the start by steps that try everything."""
    start, states = motion.v_dot, motion.internal_rate_carried  # unused until the run begins
    copy(motion.q, start)
    copy(motion.internal_state, states)
    status, iterations = _search(
        structure, spin, motion, trial, memory, work, problem, TOWARDS_REST, 0
    )
    if status != AT_EQUILIBRIUM:
        copy(start, motion.q)
        copy(states, motion.internal_state)
        motion.force[:] = 0.0
        status, _ = _search(structure, spin, motion, trial, memory, work, problem, 0, iterations)
    start[:] = 0.0
    states[:] = 0.0
    return status


@jit_not_inlined
def _search(structure, spin, motion, trial, memory, work, problem, limit, iterations):
    """Take steps towards rest; limit: see `solve_interfaces`; `iterations` went before. Return the
    status, and the number of iterations now."""
    lowest = structure.numbers[0].lowest_omega
    stiffest = mass = 0.0
    for i in range(len(structure.static_load)):
        stiffest = max(stiffest, structure.K[i, 0])
        mass += structure.one_body[0, i] * structure.mass_sum[i]
    of_stiffness = _EPSILON * len(structure.static_load) * stiffest / (mass * lowest * lowest)
    of_stiffness = min(of_stiffness, _WORST)
    radians, longest = _FIRST, _LONGEST
    before, unbalanced = 0.0, math.inf
    failures = 0
    status = NOT_CONVERGED_AT_REST
    for _ in range(_ITERATIONS):
        if iterations > memory.record[0].max_iterations:
            status = UNFINISHED_AT_REST
            break
        tau = radians / lowest
        step_status, taken = _step(
            structure, spin, tau, memory.loads, motion, trial, work, problem, limit
        )
        iterations += taken
        if step_status != DONE:
            # past the bound again and again: nothing holds it
            failures += 1
            if failures > _FAILURES:
                if unbalanced <= _BALANCED:
                    status = AT_EQUILIBRIUM
                elif step_status == NOT_FINITE:
                    status = NOT_SUPPORTED
                break
            radians /= _GROWTH
            if limit == TOWARDS_REST:
                longest = radians
            continue
        if longest < _LONGEST:
            longest *= _AGAIN
        change = 0.0
        size = 0.0
        for i in range(len(motion.q)):
            change = max(change, modulus(trial.q[i] - motion.q[i]))
            size = max(size, modulus(trial.q[i]))
        _copy_state(motion, trial)
        fall = 0.0
        for j in range(len(problem.w_free)):
            fall = max(fall, tau * tau * modulus(problem.w_free[j]))
        rounding = max(_STEADY if radians < _LONG else _STIFF, of_stiffness) * size
        rounding = max(rounding, _FALL * fall)
        unbalanced = change / fall if fall > 0.0 else math.inf
        is_steady = change <= rounding or size <= _MIDDLE * structure.numbers[0].clearance
        if change <= _SMALL * size or (is_steady and change >= 0.5 * before):
            status = AT_EQUILIBRIUM
            break
        if before > 0.0 and change > _FAST * before:
            radians = min(_GROWTH * radians, longest)
        before = change
    return status, iterations


@jit_inlined
def _polish(structure, spin, motion, trial, memory, work, problem):
    """Remove an equilibrium's rounding errors by short steps; return AT_EQUILIBRIUM, or MOVED if
    they lead away from it."""
    lowest = structure.numbers[0].lowest_omega
    result = motion.v_dot  # unused until the run begins
    copy(motion.q, result)
    for _ in range(_POLISHES):
        tau = _POLISH / lowest
        step_status, _ = _step(structure, spin, tau, memory.loads, motion, trial, work, problem, 0)
        if step_status != DONE:
            break
        _copy_state(motion, trial)
    drift = 0.0
    for i in range(len(motion.q)):
        drift = max(drift, modulus(motion.q[i] - result[i]))
        result[i] = 0.0
    return MOVED if drift > _PUSH * structure.numbers[0].clearance else AT_EQUILIBRIUM
