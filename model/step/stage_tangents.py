"""Newton's matrix for the interfaces at all stages of a step: its unknowns, the laws' derivatives,
its rows. See `stage_problem`."""

from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..kernels.lu import factorize_dense
from ..parts.law import Kinematics, StateSlopes
from ..schemes.radau import STAGES, A
from .laws import law_force, law_linearize, law_rates

# Step of the finite differences, as a share of a state and its change, and its least value; of a
# displacement, as a share of the interface's length.
_SHARE, LEAST = 1e-7, 1e-10


@jit
def kinematics_of_stage(stages, i, j):
    """Return the `Kinematics` of an interface at a stage."""
    speed, angle = stages.omega[i], stages.theta[i]
    return Kinematics(stages.d[i, j], stages.v_relative[i, j], speed, speed, angle)


@jit_not_inlined
def _fill_tangent(structure, h, stages, i, j):
    """Fill in the derivatives of force and rates at a stage with respect to displacement, velocity
    and states."""
    interface = structure.interfaces[j]
    first, count = interface.internal_state, interface.states
    tangent, moving = stages.tangent[i, j], kinematics_of_stage(stages, i, j)
    states, spare = stages.internal_state[i, first:], stages.trial_state
    slopes = StateSlopes(
        *(stages.trial_rate, stages.force_by_states, stages.rates_by_d, stages.rates_by_v),
        stages.rates_by_states,
    )
    stages.rates_by_states[:count, :count] = 0.0
    _, p_d, q_d, p_v, q_v = law_linearize(structure.laws, interface, moving, states, spare, slopes)
    for column, p, q in ((0, p_d, q_d), (2, p_v, q_v)):
        tangent[0, column], tangent[1, column] = (p + q).real, (p + q).imag
        tangent[0, column + 1], tangent[1, column + 1] = (q - p).imag, (p - q).real
    if interface.vibrating > 0:
        _store_slopes(tangent, slopes, count)
    elif count > 0:
        _fill_differences(structure, h, stages, i, j)


@jit
def _store_slopes(tangent, slopes, count):
    """Store the derivatives of force and rates by states, and those of the rates by motion."""
    for s in range(count):
        force, by_d, by_v = slopes.force[s], slopes.by_d[s], slopes.by_v[s]
        tangent[0, 4 + s], tangent[1, 4 + s] = force.real, force.imag
        tangent[2 + s, 0], tangent[2 + s, 1] = by_d.real, by_d.imag
        tangent[2 + s, 2], tangent[2 + s, 3] = by_v.real, by_v.imag
        for k in range(count):
            tangent[2 + s, 4 + k] = slopes.by_states[s, k]


@jit
def _fill_differences(structure, h, stages, i, j):
    """Fill in the same as differences, for a law that does not have them."""
    interface = structure.interfaces[j]
    first, count = interface.internal_state, interface.states
    tangent, moving = stages.tangent[i, j], kinematics_of_stage(stages, i, j)
    states, spare = stages.internal_state[i, first:], stages.trial_state
    d_step = _SHARE * interface.length
    v_step = d_step * (1.0 / h) + _SHARE * modulus(moving.velocity)
    for column in range(4 + count):
        d, v = moving.displacement, moving.velocity
        for s in range(count):
            spare[s] = states[s]
        if column < 4:
            step = d_step if column < 2 else v_step
            offset = complex(step, 0.0) if column % 2 == 0 else complex(0.0, step)
            if column < 2:
                d += offset
            else:
                v += offset
        else:
            s = column - 4
            change = abs(states[s]) + h * abs(stages.law_rate[i, first + s])
            step = _SHARE * change + LEAST
            spare[s] += step
        shifted = Kinematics(d, v, moving.speed, moving.sliding_speed, moving.angle)
        rates = stages.trial_rate
        law_rates(structure.laws, interface, shifted, spare, rates)
        for s in range(count):
            tangent[2 + s, column] = (rates[s] - stages.law_rate[i, first + s]) / step
        if column >= 4:
            force = law_force(structure.laws, interface, shifted, spare)
            change_of_force = (force - stages.law_force[i, j]) * (1.0 / step)
            tangent[0, column] = change_of_force.real
            tangent[1, column] = change_of_force.imag


@jit
def list_unknowns(structure, stages):
    """List the forces that act and all rates; return the number of forces, and of both."""
    m, size = len(structure.interfaces), len(stages.law_rate[0])
    count = 0
    for i in range(STAGES):
        for j in range(m):
            if stages.acts[i, j] == 1:
                for axis in range(2):
                    unknown = stages.unknowns[count]
                    unknown[0] = 2 * (i * m + j) + axis
                    unknown[1], unknown[2], unknown[3] = i, j, axis
                    count += 1
    forces = count
    for i in range(STAGES):
        for s in range(size):
            stages.unknowns[count, 0] = 6 * m + i * size + s
            count += 1
    return forces, count


@jit
def linearize(structure, h, stages, forces, count):
    """Fill in and factorize the matrix of the unknowns; return False if it is singular."""
    m, size = len(structure.interfaces), len(stages.law_rate[0])
    for j in range(m):
        for i in range(STAGES):
            if stages.acts[i, j] == 1 or structure.interfaces[j].states > 0:
                _fill_tangent(structure, h, stages, i, j)
    jacobian = stages.jacobian
    row = 0
    for i in range(STAGES):
        for j in range(m):
            if stages.acts[i, j] == 1:
                for axis in range(2):
                    _fill_row(structure, h, stages, row, i, j, axis, forces, count)
                    row += 1
    for i in range(STAGES):
        for j in range(m):
            for s in range(structure.interfaces[j].states):
                _fill_row(
                    structure,
                    h,
                    stages,
                    forces + i * size + structure.interfaces[j].internal_state + s,
                    i,
                    j,
                    2 + s,
                    forces,
                    count,
                )
    for k in range(count):
        jacobian[k, k] += 1.0
    return factorize_dense(jacobian, stages.pivots, count)


@jit
def _fill_row(structure, h, stages, row, i, j, output, forces, count):
    """Fill in the negative derivatives of a force or a rate with respect to all unknowns."""
    m, size = len(structure.interfaces), len(stages.law_rate[0])
    tangent, matrix_row, at = stages.tangent[i, j, output], stages.jacobian[row], 2 * (i * m + j)
    for k in range(forces):
        d, v = stages.by_d[stages.unknowns[k, 0]], stages.by_v[stages.unknowns[k, 0]]
        matrix_row[k] = -(
            tangent[0] * d[at]
            + tangent[1] * d[at + 1]
            + tangent[2] * v[at]
            + tangent[3] * v[at + 1]
        )
    for k in range(forces, count):
        matrix_row[k] = 0.0
    first = structure.interfaces[j].internal_state
    for s in range(structure.interfaces[j].states):
        for k in range(STAGES):
            matrix_row[forces + k * size + first + s] = -tangent[4 + s] * h * A[i, k]
