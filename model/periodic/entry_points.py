"""The compiled entry point of periodic motions: Radau IIA steps through a period, of a block alone.
It returns DONE."""

import math
from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.block import Layout
from ..kernels.jit import jit
from ..step.interface_problem import solve_columns
from ..step.laws_along_motion import Interfaces, Samples, fill_linearized
from ..step.step_status import DONE

_TOLERANCE, _ITERATIONS = 1e-12, 30  # of forces, as a share of the largest; in a step
_LEAST_DAMPING = 0.01  # of a correction after which the forces are better


class Propagators(NamedTuple):
    """Effect of steps of l different lengths on n modes, as real amplitudes, and of c interface
    forces: the index of each step's length; per length the state at the end by the state at the
    begin, `diagonal` and `cross` (from the partner of a complex pair), shape (l, n), and by the
    forces at the three points, shape (l, n, 3 c); the outputs at the points by the state, shape (l,
    3 outputs, n), and by the forces, shape (l, 3 outputs, 3 c); the partner of each amplitude in
    its pair."""

    length_of_step: Annotated[np.ndarray, np.int64, "steps"]
    diagonal: Annotated[np.ndarray, float, "lengths", "modes"]
    cross: Annotated[np.ndarray, float, "lengths", "modes"]
    state_by_force: Annotated[np.ndarray, float, "lengths", "modes", "3 * b"]
    output_by_state: Annotated[np.ndarray, float, "lengths", "6 * b", "modes"]
    output_by_force: Annotated[np.ndarray, float, "lengths", "6 * b", "3 * b"]
    partner: Annotated[np.ndarray, np.int64, "modes"]


class Period(NamedTuple):
    """The displacements of the m interfaces by the coordinates b, shape (2 m, b); the mean tangents
    that the modes contain; for all steps the response to the loads alone at their points, the
    displacements and velocities y there, and whether the step was not solved; amplitudes of the
    modes."""

    B: Annotated[np.ndarray, float, "2 * interfaces", "b"]
    mean_tangent: Annotated[np.ndarray, float, "b", "2 * b"]
    load_response: Annotated[np.ndarray, float, "steps", "3", "2 * b"]
    y: Annotated[np.ndarray, float, "steps", "3", "2 * b"]
    unsolved: Annotated[np.ndarray, bool, "steps"]
    state: Annotated[np.ndarray, float, "modes"]


class StepWork(NamedTuple):
    """Work arrays of a step: matrix, residual and column order of Newton's method, tangents; the
    forces at the points, their last correction, y without the forces, y of the present iterate, and
    the state at the end."""

    matrix: Annotated[np.ndarray, float, "3 * b", "3 * b"]
    residual: Annotated[np.ndarray, float, "3 * b"]
    columns: Annotated[np.ndarray, np.int64, "3 * b"]
    tangent: Annotated[np.ndarray, float, "3", "b", "2 * b"]
    force: Annotated[np.ndarray, float, "3 * b"]
    correction: Annotated[np.ndarray, float, "3 * b"]
    without_forces: Annotated[np.ndarray, float, "6 * b"]
    trial: Annotated[np.ndarray, float, "3", "2 * b"]
    next_state: Annotated[np.ndarray, float, "modes"]


class OrbitData(NamedTuple):
    """All arrays of a block; the samples are the points of a step."""

    machine: Interfaces
    samples: Samples
    propagators: Propagators
    period: Period
    work: StepWork


LAYOUT = Layout(OrbitData)
_view = LAYOUT.view


@jit
def _linearize(run, speed, y):
    """Fill work.residual with the forces of the laws at the points less those in the modes and less
    work.force, and work.tangent with their derivatives with respect to y."""
    B, mean_tangent, work, samples = run.period.B, run.period.mean_tangent, run.work, run.samples
    m, b = B.shape[0] // 2, B.shape[1]
    for i in range(3):
        for j in range(m):
            d, v = 0.0j, 0.0j
            for c in range(b):
                to = complex(B[2 * j, c], B[2 * j + 1, c])
                d += to * y[i, c]
                v += to * y[i, b + c]
            samples.d[j, i], samples.v[j, i] = d, v
    fill_linearized(run.machine, samples, speed)
    for i in range(3):
        for a in range(b):
            force = -work.force[i * b + a]
            for o in range(2 * b):
                force -= mean_tangent[a, o] * y[i, o]
                work.tangent[i, a, o] = -mean_tangent[a, o]
            for j in range(m):
                x_a, y_a = B[2 * j, a], B[2 * j + 1, a]
                force += x_a * samples.force[j, i].real + y_a * samples.force[j, i].imag
                for o in range(2 * b):
                    c, which = o % b, o // b
                    to = complex(B[2 * j, c], B[2 * j + 1, c])
                    by = samples.p[which, j, i] * to + samples.q[which, j, i] * to.conjugate()
                    work.tangent[i, a, o] += x_a * by.real + y_a * by.imag
            work.residual[i * b + a] = force


@jit
def _evaluate(run, speed, i, k, is_first):
    """Fill work.trial with y at the points of step i for the present forces, or along the nearby
    motion if is_first, and linearize there; return the largest residual."""
    steps, period, work = run.propagators, run.period, run.work
    b = period.B.shape[1]
    c = 3 * b
    for p in range(6 * b):
        point, o = p // (2 * b), p % (2 * b)
        total = period.y[i, point, o] if is_first else work.without_forces[p]
        for j in range(c):
            total += steps.output_by_force[k, p, j] * work.force[j]
        work.trial[point, o] = total
    _linearize(run, speed, work.trial)
    for p in range(c if is_first else 0):
        for o in range(2 * b):
            difference = work.without_forces[p // b * 2 * b + o] - work.trial[p // b, o]
            work.residual[p] += work.tangent[p // b, p % b, o] * difference
    residual = 0.0
    for p in range(c):
        residual = max(residual, abs(work.residual[p]))
    return residual


@jit
def _newton_correction(run, k):
    """Fill work.correction and add it to the forces; return False if the matrix is singular."""
    steps, work = run.propagators, run.work
    b = run.period.B.shape[1]
    c = 3 * b
    for p in range(c):
        for j in range(c):
            total = 1.0 if p == j else 0.0
            for o in range(2 * b):
                at = p // b * 2 * b + o
                total -= work.tangent[p // b, p % b, o] * steps.output_by_force[k, at, j]
            work.matrix[p, j] = total
    if not solve_columns(work.matrix, work.columns, work.residual):
        return False
    for p in range(c):
        work.correction[p] = work.residual[p]
        work.force[p] += work.correction[p]
    return True


@jit
def _solve_forces(run, speed, i, k, largest_force):
    """Solve for the forces of step i, with the propagators k, by damped Newton iteration; return
    whether it converged, and the largest force so far."""
    force, c = run.work.force, 3 * run.period.B.shape[1]
    damping, before = 1.0, math.inf
    for p in range(c):
        force[p] = 0.0
    for iteration in range(_ITERATIONS):
        is_first = iteration == 0  # along the nearby motion, where there are no forces yet
        residual = _evaluate(run, speed, i, k, is_first)
        for p in range(c):
            largest_force = max(largest_force, abs(force[p]))
        if not is_first and residual <= _TOLERANCE * largest_force:
            return True, largest_force
        if residual >= before and damping > _LEAST_DAMPING:  # half the way back
            damping *= 0.5
            for p in range(c):
                force[p] -= damping * run.work.correction[p]
            continue
        damping, before = 1.0, math.inf if is_first else residual
        if not _newton_correction(run, k):
            break
    return False, largest_force


@jit
def step_through(block, speed):
    """Integrate a period: fill period.y at the points of all steps (on entry a nearby motion),
    period.state with the state at the end (on entry at the begin), and period.unsolved."""
    run = _view(block)
    steps, period, work = run.propagators, run.period, run.work
    state, b = period.state, period.B.shape[1]
    n = len(state)
    largest_force = 0.0
    for i in range(len(steps.length_of_step)):
        k = steps.length_of_step[i]
        for p in range(6 * b):
            total = period.load_response[i, p // (2 * b), p % (2 * b)]
            for j in range(n):
                total += steps.output_by_state[k, p, j] * state[j]
            work.without_forces[p] = total
        is_solved, largest_force = _solve_forces(run, speed, i, k, largest_force)
        period.unsolved[i] = not is_solved
        for j in range(n):
            total = steps.diagonal[k, j] * state[j] + steps.cross[k, j] * state[steps.partner[j]]
            for p in range(3 * b):
                total += steps.state_by_force[k, j, p] * work.force[p]
            work.next_state[j] = total
        for j in range(n):
            state[j] = work.next_state[j]
        for p in range(6 * b):
            period.y[i, p // (2 * b), p % (2 * b)] = work.trial[p // (2 * b), p % (2 * b)]
    return DONE
