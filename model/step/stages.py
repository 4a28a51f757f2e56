"""A step of Radau IIA: the motion at its three stages, solved for at once.

The linear part of all stages decouples into three complex systems of the size of the shaft
(`schemes.radau`), each a band matrix, and is eliminated exactly; what remains are the forces of the
interfaces at the stages (`stage_problem`).

Speed and rate differ between the stages of a rotor that speeds up. The matrices are those of the
middle of the step; the differences of the gyroscopic and circulatory terms are small forces,
evaluated at the predicted motion.
"""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.band import add_product
from ..kernels.functions import scaled
from ..kernels.jit import jit
from ..parts.housing import masses
from ..schemes.radau import (
    A_SQUARED,
    END_SLOPE,
    OF_STAGES,
    OF_START,
    OF_TIME,
    STAGES,
    TO_STAGES,
    A,
    C,
    of_parts,
)
from .bows import add_bows
from .excitation import add_applied, circulation, free_fall_acceleration, spin_of
from .laws import first_invalid_law, relative, sides
from .stage_matrices import condense, factorize_systems, solve_systems
from .stage_problem import solve_stages
from .step import add_internal, by_axis, is_finite_within
from .step_status import DONE, FILM_INVALID, NOT_CONVERGED, NOT_FINITE


class Stages(NamedTuple):
    """Work arrays of a step in stages. Only the factorized matrices outlive the step; they are
    valid for `key` = (h, speed, rate), and its last entry is 1 if the interfaces are condensed.

    omega, alpha, theta, drive, torque, loads: rotation, torque on a free rotor, torque that the
    motion needs, and loads at the stages; ledger: at the end of the step. q, v, v_dot: motion at
    the stages; force: of the interfaces; internal_state, internal_rate: of the laws; powers: flows
    of the ledger [W]. modal: accelerations of the three systems, as parts once they are solved for
    (`schemes.radau`); columns: those by a force at an interface. d_free, v_free: relative motion of
    the interfaces without their forces; d, v_relative: with them; by_d, by_v: influence of the
    forces at all stages, a row each, on d and v; moved_d, moved_v: response to the present forces.
    acts: which interfaces act; law_force, law_state, law_rate: results of the laws; tangent:
    derivatives of forces and rates with respect to displacement, velocity, and states. jacobian,
    solution, pivots: of Newton's method; unknowns: indices of the unknowns, of a force with its
    stage, interface and axis. housing: accelerations by forces on the housings, in x and in y;
    housing_d, housing_v: displacements and velocities. The rest is scratch of single calls.
    """

    key: Annotated[np.ndarray, float, "4"]
    omega: Annotated[np.ndarray, float, "3"]
    alpha: Annotated[np.ndarray, float, "3"]
    theta: Annotated[np.ndarray, float, "3"]
    drive: Annotated[np.ndarray, float, "3"]
    torque: Annotated[np.ndarray, float, "3"]
    ledger: Annotated[np.ndarray, float, "flows"]
    loads: Annotated[np.ndarray, complex, "3", "loads"]
    q: Annotated[np.ndarray, complex, "3", "size"]
    v: Annotated[np.ndarray, complex, "3", "size"]
    v_dot: Annotated[np.ndarray, complex, "3", "size"]
    force: Annotated[np.ndarray, complex, "3", "interfaces"]
    internal_state: Annotated[np.ndarray, float, "3", "internal_states"]
    internal_rate: Annotated[np.ndarray, float, "3", "internal_states"]
    powers: Annotated[np.ndarray, float, "3", "flows"]
    factors: Annotated[np.ndarray, complex, "n", "width", "3"]
    columns: Annotated[np.ndarray, complex, "interfaces", "n", "3"]
    modal: Annotated[np.ndarray, complex, "n", "3"]
    scratch: Annotated[np.ndarray, complex, "4", "n"]
    housing: Annotated[np.ndarray, float, "2", "housings", "3", "3"]
    housing_d: Annotated[np.ndarray, float, "2", "housings", "3", "3"]
    housing_v: Annotated[np.ndarray, float, "2", "housings", "3", "3"]
    d_free: Annotated[np.ndarray, complex, "3", "interfaces"]
    v_free: Annotated[np.ndarray, complex, "3", "interfaces"]
    d: Annotated[np.ndarray, complex, "3", "interfaces"]
    v_relative: Annotated[np.ndarray, complex, "3", "interfaces"]
    by_d: Annotated[np.ndarray, float, "6 * interfaces", "6 * interfaces"]
    by_v: Annotated[np.ndarray, float, "6 * interfaces", "6 * interfaces"]
    moved_d: Annotated[np.ndarray, float, "6 * interfaces"]
    moved_v: Annotated[np.ndarray, float, "6 * interfaces"]
    acts: Annotated[np.ndarray, np.int64, "3", "interfaces"]
    law_force: Annotated[np.ndarray, complex, "3", "interfaces"]
    law_state: Annotated[np.ndarray, float, "3", "internal_states"]
    law_rate: Annotated[np.ndarray, float, "3", "internal_states"]
    tangent: Annotated[np.ndarray, float, "3", "interfaces", "2 + most_states", "4 + most_states"]
    jacobian: Annotated[
        np.ndarray,
        float,
        "6 * interfaces + 3 * internal_states",
        "6 * interfaces + 3 * internal_states",
    ]
    solution: Annotated[np.ndarray, float, "6 * interfaces + 3 * internal_states"]
    pivots: Annotated[np.ndarray, np.int64, "6 * interfaces + 3 * internal_states"]
    unknowns: Annotated[np.ndarray, np.int64, "6 * interfaces + 3 * internal_states", "4"]
    trial_state: Annotated[np.ndarray, float, "most_states"]
    trial_rate: Annotated[np.ndarray, float, "most_states"]
    force_by_states: Annotated[np.ndarray, complex, "most_states"]
    rates_by_d: Annotated[np.ndarray, complex, "most_states"]
    rates_by_v: Annotated[np.ndarray, complex, "most_states"]
    rates_by_states: Annotated[np.ndarray, float, "most_states", "most_states"]


@jit
def spin_of_stage(stages, i):
    """Return the `Spin` of stage i."""
    return spin_of(stages.omega[i], stages.alpha[i], stages.theta[i])


@jit
def _add_differences(structure, spin, at, ahead, old, scratch, out):
    """Add to out the differences of the gyroscopic and circulatory terms at a stage, `ahead` [s]
    from the start, from those in the middle of the step, at the motion extrapolated from the
    start."""
    faster, rate = at.omega - spin.omega, 0.5 * (at.alpha - spin.alpha)
    kappa = circulation(structure, at.omega) - circulation(structure, spin.omega)
    if faster == 0.0 and rate == 0.0 and kappa == 0.0:
        return
    n = len(out)
    half = 0.5 * ahead * ahead
    for i in range(n):
        q = old.q[i] + ahead * old.v[i] + half * old.v_dot[i]
        v = old.v[i] + ahead * old.v_dot[i] + half * old.jerk[i]
        scratch[i] = 1j * (faster * v + rate * q)
    add_product(structure.G, scratch, out)
    if kappa != 0.0:
        for i in range(n):
            scratch[i] = 1j * kappa * (old.q[i] + ahead * old.v[i] + half * old.v_dot[i])
        add_product(structure.K_shaft, scratch, out)


@jit
def _free_response(structure, spin, h, old, stages):
    """Fill in the accelerations of the three systems and of the housings without the interfaces'
    forces."""
    n = len(structure.static_load)
    at_start, by_time, scratch = stages.scratch[0], stages.scratch[1], stages.scratch[2]
    at_start[:] = 0.0
    by_time[:] = 0.0
    add_internal(structure, spin, -1.0, 1.0, old.q, old.v, scratch, at_start)
    add_internal(structure, spin, -1.0, 0.0, old.v, old.v, scratch, by_time)
    right, modal = stages.scratch[3], stages.modal
    for i in range(n):
        for s in range(STAGES):
            modal[i, s] = scaled(OF_START[s], at_start[i]) + scaled(h * OF_TIME[s], by_time[i])
    for k in range(STAGES):
        ahead = C[k] * h
        right[:] = 0.0
        at = spin_of_stage(stages, k)
        add_applied(structure, at, stages.loads[k], right)
        add_bows(structure, at, ahead, old, right)
        _add_differences(structure, spin, at, ahead, old, scratch, right)
        for i in range(n):
            for s in range(STAGES):
                modal[i, s] += scaled(OF_STAGES[s, k], right[i])
    for i in range(n):
        even, odd = modal[i, 1], modal[i, 2]
        modal[i, 1] = complex(even.real - odd.imag, even.imag + odd.real)
        modal[i, 2] = complex(even.real + odd.imag, even.imag - odd.real)
    solve_systems(stages.factors, modal)
    for i in range(STAGES):
        for j in range(len(structure.housings) + 1):
            stages.v_dot[i, n + j] = 0.0
    for k in range(STAGES):
        g = free_fall_acceleration(structure, stages.loads[k])
        for j in range(len(structure.housings)):
            housing = structure.housings[j]
            q = old.q[n + j] + (C[k] * h) * old.v[n + j]
            force = by_axis(*masses(housing), g) - by_axis(housing.kx, housing.ky, q)
            force -= by_axis(housing.cx, housing.cy, old.v[n + j])
            _push_housing(stages, n, j, k, force)


@jit
def _push_housing(stages, n, j, k, force):
    """Add the accelerations by a force on a housing at stage k [N]."""
    for i in range(STAGES):
        stages.v_dot[i, n + j] += by_axis(
            stages.housing[0, j, i, k], stages.housing[1, j, i, k], force
        )


@jit
def _fill_free(structure, h, old, stages):
    """Fill in the relative motion of the interfaces without their forces; return whether it is
    finite."""
    n = len(structure.static_load)
    is_finite = True
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        d, v = relative(interface, old.q), relative(interface, old.v)
        for i in range(STAGES):
            stages.d_free[i, j] = d + scaled(C[i] * h, v)
            stages.v_free[i, j] = v
        for k in range(STAGES):
            w = 0.0j
            if interface.dof < n:
                parts = stages.modal[interface.dof]
                w += of_parts(TO_STAGES[k], parts[0], parts[1], parts[2])
            else:
                w += stages.v_dot[k, interface.dof]
            if interface.end < n + len(structure.housings):
                w -= stages.v_dot[k, interface.end]
            for i in range(STAGES):
                stages.d_free[i, j] += scaled(h * h * A_SQUARED[i, k], w)
                stages.v_free[i, j] += scaled(h * A[i, k], w)
        for i in range(STAGES):
            is_finite = is_finite and is_finite_within(stages.d_free[i, j], 1e150)
    return is_finite


@jit
def _fill_motion(structure, h, old, stages):
    """Fill in the motion at the stages under the interface forces."""
    n = len(structure.static_load)
    size = len(old.q)
    modal = stages.modal
    for j in range(len(structure.interfaces)):
        first = even = odd = 0.0j
        for k in range(STAGES):
            force = stages.force[k, j]
            first += scaled(OF_STAGES[0, k], force)
            even += scaled(OF_STAGES[1, k], force)
            odd += scaled(OF_STAGES[2, k], force)
            for place, sign in sides(structure.interfaces[j]):
                if force != 0.0 and n <= place < n + len(structure.housings):
                    _push_housing(stages, n, place - n, k, scaled(sign, force))
        if first != 0.0 or even != 0.0 or odd != 0.0:
            columns = stages.columns[j]
            for i in range(n):
                p, s, t = columns[i, 0], columns[i, 1], columns[i, 2]
                modal[i, 0] += first * p
                modal[i, 1] += even * s + odd * t
                modal[i, 2] += even * t - odd * s
    for i in range(n):
        for k in range(STAGES):
            stages.v_dot[k, i] = of_parts(TO_STAGES[k], modal[i, 0], modal[i, 1], modal[i, 2])
    for k in range(STAGES):
        for i in range(size):
            by_q = by_v = 0.0j
            for stage in range(STAGES):
                by_q += scaled(A_SQUARED[k, stage], stages.v_dot[stage, i])
                by_v += scaled(A[k, stage], stages.v_dot[stage, i])
            stages.q[k, i] = old.q[i] + scaled(C[k] * h, old.v[i]) + scaled(h * h, by_q)
            stages.v[k, i] = old.v[i] + scaled(h, by_v)


@jit
def _accept_last_stage(h, stages, new):
    """Copy the last stage to the new state."""
    last = STAGES - 1
    for i in range(len(new.q)):
        new.q[i] = stages.q[last, i]
        new.v[i] = stages.v[last, i]
        new.a[i] = new.v_dot[i] = stages.v_dot[last, i]
        slope = 0.0j
        for k in range(STAGES):
            slope += scaled(END_SLOPE[k], stages.v_dot[k, i])
        new.jerk[i] = scaled(1.0 / h, slope)
    for j in range(len(new.force)):
        new.force[j] = stages.force[last, j]
    for i in range(len(new.internal_state)):
        new.internal_state[i] = stages.internal_state[last, i]
        new.internal_rate[i] = stages.internal_rate[last, i]
        new.internal_rate_carried[i] = stages.internal_rate[last, i]


@jit
def try_stages(structure, spin, h, accuracy, old, new, stages):
    """Take one step of length h [s] from `old` to `new`; `spin` is that of its middle, those of the
    stages and their loads are in `stages`; accuracy: of the interfaces' displacements [1].

    Return the status, see `step`, and the Newton iterations. `old` is never changed.
    """
    key = stages.key
    if key[0] != h or key[1] != spin.omega or key[2] != spin.alpha:
        factorize_systems(structure, spin, h, stages)
    _free_response(structure, spin, h, old, stages)
    if not _fill_free(structure, h, old, stages):
        return NOT_FINITE, 0
    if key[3] == 0.0:
        condense(structure, h, stages)
    is_converged, iterations = solve_stages(structure, h, accuracy, old, stages)
    if not is_converged:
        return NOT_CONVERGED, iterations
    _fill_motion(structure, h, old, stages)
    for i in range(len(structure.deflections)):
        dof = structure.deflections[i, 0]
        for k in range(STAGES):
            if not is_finite_within(stages.q[k, dof], structure.numbers[0].bound):
                return NOT_FINITE, iterations
    _accept_last_stage(h, stages, new)
    if first_invalid_law(structure, new.q, new.internal_state) >= 0:
        return FILM_INVALID, iterations
    return DONE, iterations
