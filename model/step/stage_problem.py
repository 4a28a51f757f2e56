"""The forces of all interfaces at all stages of a step at once, by Newton's method.

    d = d_free + D F(d, v, z),   v = v_free + V F(d, v, z),   z = z_0 + h A z'(d, v, z)

d, v: relative displacements and velocities of the interfaces at the stages; D, V: influence of the
forces at all stages; z: internal states of the laws, with the weights A of `schemes.radau`.
Unknowns are the forces that act, and the rates of the states. The matrix is factorized anew only
where a contact opens or closes, and where the iteration has become slow.
"""

import math

from ..kernels.functions import modulus
from ..kernels.jit import jit
from ..kernels.lu import solve_dense
from ..schemes.radau import A_INVERSE, STAGES, A, C
from .laws import law_force, law_gap, law_rates, relative
from .stage_tangents import LEAST, kinematics_of_stage, linearize, list_unknowns

SLIDING, FREE = 0, 1
# Starting points of Newton's method, one after another: sliding on at the same depth, or without
# forces. A step in which none converges is repeated with half its length.
ATTEMPTS = (SLIDING, FREE)
ITERATIONS = 10
# Estimated error, as a share of the required accuracy, at which the iteration ends; ratio of two
# corrections above which it counts as slow, and above which it is damped, since it would cycle
# where sliding reverses.
CERTAIN, SLOW, CYCLING = 0.3, 0.1, 0.7
LEAST_DAMPING = 0.25


@jit
def _may_act(structure, old, stages):
    """Return whether any interface may act in the step."""
    if len(old.internal_state) > 0:
        return True
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        if interface.has_wall == 0 or old.force[j] != 0.0:
            return True
        for i in range(STAGES):
            if law_gap(structure.laws, interface, stages.d_free[i, j]) < 0.0:
                return True
    return False


@jit
def _has_prediction(structure, old):
    """Return whether Newton's method can start elsewhere than without forces."""
    for j in range(len(structure.interfaces)):
        if structure.interfaces[j].has_wall == 0 or old.force[j] != 0.0:
            return True
    return False


@jit
def _start(structure, h, place, old, stages):
    """Set Newton's starting point."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        d0, v0 = relative(interface, old.q), relative(interface, old.v)
        a0, jerk = relative(interface, old.v_dot), relative(interface, old.jerk)
        has_prediction = interface.has_wall == 0 or old.force[j] != 0.0
        for i in range(STAGES):
            t = C[i] * h
            d = stages.d_free[i, j]
            if place == SLIDING and has_prediction:
                d = d0 + t * (v0 + t * (0.5 * a0 + t * (1.0 / 6.0) * jerk))
                if interface.has_wall == 1:
                    d = d * (modulus(d0) / modulus(d))
            stages.d[i, j] = d
        for i in range(STAGES):
            v = stages.v_free[i, j]
            if place == SLIDING and has_prediction:
                v = v0
                for k in range(STAGES):
                    change = stages.d[k, j] - d0 - (C[k] * h) * v0
                    v += A_INVERSE[i, k] * (1.0 / h) * change
            stages.v_relative[i, j] = v
    for i in range(STAGES):
        for s in range(len(old.internal_state)):
            rate = old.internal_rate[s]
            stages.internal_rate[i, s] = rate
            stages.internal_state[i, s] = old.internal_state[s] + C[i] * h * rate


@jit
def _call_laws(structure, stages):
    """Fill in the forces and rates of the laws at the present motion; return whether the set of
    acting interfaces has changed since the last call."""
    has_changed = False
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        first, count = interface.internal_state, interface.states
        for i in range(STAGES):
            moving = kinematics_of_stage(stages, i, j)
            states = stages.internal_state[i, first:]
            force = law_force(structure.laws, interface, moving, states)
            stages.law_force[i, j] = force
            acts = 1 if force != 0.0 or interface.has_wall == 0 else 0
            has_changed = has_changed or acts != stages.acts[i, j]
            stages.acts[i, j] = acts
            for s in range(count):
                stages.law_state[i, first + s] = states[s]
            if count > 0:
                rates = stages.law_rate[i, first:]
                law_rates(structure.laws, interface, moving, states, rates)
    return has_changed


@jit
def _right_hand_side(structure, old, stages, i, j, output):
    """Return a force (its x, its y) or a rate at the free motion, linearized."""
    tangent, interface = stages.tangent[i, j, output], structure.interfaces[j]
    first = interface.internal_state
    if output < 2:
        force = stages.law_force[i, j]
        value = force.real if output == 0 else force.imag
    else:
        value = stages.law_rate[i, first + output - 2]
    d = stages.d_free[i, j] - stages.d[i, j]
    v = stages.v_free[i, j] - stages.v_relative[i, j]
    value += tangent[0] * d.real + tangent[1] * d.imag + tangent[2] * v.real + tangent[3] * v.imag
    for s in range(interface.states):
        change = old.internal_state[first + s] - stages.internal_state[i, first + s]
        value += tangent[4 + s] * change
    return value


@jit
def _newton_step(structure, h, accuracy, damping, old, stages, forces, count):
    """Solve the linearized problem and apply the share `damping` of the correction; return the
    largest correction of a displacement or a state, relative to its tolerance [1]."""
    m, size = len(structure.interfaces), len(stages.law_rate[0])
    solution, unknowns = stages.solution, stages.unknowns
    for row in range(forces):
        i, j, axis = unknowns[row, 1], unknowns[row, 2], unknowns[row, 3]
        solution[row] = _right_hand_side(structure, old, stages, i, j, axis)
    for j in range(m):
        first = structure.interfaces[j].internal_state
        for s in range(structure.interfaces[j].states):
            for i in range(STAGES):
                at = forces + i * size + first + s
                solution[at] = _right_hand_side(structure, old, stages, i, j, 2 + s)
    solve_dense(stages.jacobian, stages.pivots, count, solution)
    moved_d, moved_v = stages.moved_d, stages.moved_v
    for row in range(len(moved_d)):
        moved_d[row] = moved_v[row] = 0.0
    for k in range(forces):
        force, by_d, by_v = solution[k], stages.by_d[unknowns[k, 0]], stages.by_v[unknowns[k, 0]]
        for row in range(len(moved_d)):
            moved_d[row] += by_d[row] * force
            moved_v[row] += by_v[row] * force
    largest = 0.0
    for i in range(STAGES):
        for j in range(m):
            interface = structure.interfaces[j]
            row = 2 * (i * m + j)
            d = stages.d_free[i, j] + complex(moved_d[row], moved_d[row + 1])
            change = modulus(d - stages.d[i, j])
            is_open = stages.acts[i, j] == 0 and law_gap(structure.laws, interface, d) >= 0.0
            if not is_open:
                largest = max(largest, change / (accuracy * interface.length))
            if not change < math.inf:
                return math.inf
            v = stages.v_free[i, j] + complex(moved_v[row], moved_v[row + 1])
            stages.d[i, j] += damping * (d - stages.d[i, j])
            stages.v_relative[i, j] += damping * (v - stages.v_relative[i, j])
            stages.force[i, j] = 0.0
            first = interface.internal_state
            for s in range(interface.states):
                z = old.internal_state[first + s]
                for k in range(STAGES):
                    z += h * A[i, k] * solution[forces + k * size + first + s]
                change = abs(z - stages.internal_state[i, first + s])
                moved = abs(z) + abs(z - old.internal_state[first + s])
                if change > 0.0:
                    largest = max(largest, change / (accuracy * (moved + LEAST)))
                stages.internal_state[i, first + s] += damping * (
                    z - stages.internal_state[i, first + s]
                )
                stages.internal_rate[i, first + s] = solution[forces + i * size + first + s]
    for k in range(forces):
        i, j, force = unknowns[k, 1], unknowns[k, 2], solution[k]
        stages.force[i, j] += complex(force, 0.0) if unknowns[k, 3] == 0 else complex(0.0, force)
    return largest


@jit
def _iterate(structure, h, accuracy, old, stages):
    """Return whether Newton's method converges from its starting point, and the iterations."""
    for i in range(STAGES):
        for j in range(len(structure.interfaces)):
            stages.acts[i, j] = -1
    is_new, before, damping, forces, count = True, math.inf, 1.0, 0, 0
    for iteration in range(ITERATIONS):
        has_changed = _call_laws(structure, stages)
        is_new = is_new or has_changed
        if is_new:
            forces, count = list_unknowns(structure, stages)
            if count > 0 and not linearize(structure, h, stages, forces, count):
                return False, iteration + 1
        is_new = False
        correction = _newton_step(structure, h, accuracy, damping, old, stages, forces, count)
        if not correction < math.inf:
            return False, iteration + 1
        if damping == 1.0 and _is_close(correction, before, has_changed):
            return True, iteration + 1
        is_new = damping < 1.0 or correction > SLOW * before
        is_slower = correction >= CYCLING * before
        damping = max(LEAST_DAMPING, 0.5 * damping) if is_slower else min(1.0, 2.0 * damping)
        before = correction
    return False, ITERATIONS


@jit
def _is_close(correction, before, has_changed):
    """Return whether the error after a correction is within the accuracy: the sum of the
    corrections that would follow if they fell as before, and much stricter while the set of acting
    interfaces changes."""
    if has_changed or correction <= CERTAIN * CERTAIN:
        return correction <= 1.0
    return correction * correction <= CERTAIN * (before - correction)


@jit
def solve_stages(structure, h, accuracy, old, stages):
    """Solve for the forces and the states' rates at the stages; return (converged, iterations).

    accuracy: of the displacements, in lengths of their interfaces [1].
    """
    for i in range(STAGES):
        for j in range(len(structure.interfaces)):
            stages.force[i, j] = 0.0
    if not _may_act(structure, old, stages):
        return True, 0
    total = 0
    for place in ATTEMPTS:
        if place == FREE and not _has_prediction(structure, old):
            break
        _start(structure, h, place, old, stages)
        is_converged, iterations = _iterate(structure, h, accuracy, old, stages)
        total += iterations
        if is_converged:
            return True, total
    return False, total
