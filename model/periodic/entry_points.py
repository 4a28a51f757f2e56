"""The compiled function of periodic motions, of a block alone: steps of Radau IIA through a period.
It returns DONE."""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.block import Group, Layout
from ..kernels.jit import jit
from ..parts.law import Weights
from ..step.interface_problem import solve_columns
from ..step.laws_along_motion import GROUPS, SIZES, Interfaces, Samples, fill_in_laws
from ..step.step_status import DONE

_TOLERANCE, _ITERATIONS = 1e-12, 30  # of forces, as a share of the largest; in a step
_LEAST_SHARE = 0.01  # of a correction after which the forces are better


class Lengths(NamedTuple):
    """What n modes, by real amplitudes, and c forces do over steps of l lengths: which length a
    step has; of each length what the amplitudes become by themselves, `along` and across their
    pairs, shape (l, n), and of the forces at its three points, `forced`, shape (l, n, 3 c); what is
    seen at the points of the amplitudes, `seen`, shape (l, 3 outputs, n), and of the forces,
    `among`, shape (l, 3 outputs, 3 c); the other amplitude of each pair."""

    which: Annotated[np.ndarray, np.int64, "steps"]
    along: Annotated[np.ndarray, float, "lengths", "modes"]
    across: Annotated[np.ndarray, float, "lengths", "modes"]
    forced: Annotated[np.ndarray, float, "lengths", "modes", "3 * b"]
    seen: Annotated[np.ndarray, float, "lengths", "6 * b", "modes"]
    among: Annotated[np.ndarray, float, "lengths", "6 * b", "3 * b"]
    other: Annotated[np.ndarray, np.int64, "modes"]


class Period(NamedTuple):
    """The interfaces' coordinates: displacements of them, shape (2 m, b), and the mean tangents
    that are in the modes; of all steps, what the loads do at their points, what is seen there, and
    whether it was not solved; amplitudes of the modes."""

    B: Annotated[np.ndarray, float, "2 * interfaces", "b"]
    mean: Annotated[np.ndarray, float, "b", "2 * b"]
    by_loads: Annotated[np.ndarray, float, "steps", "3", "2 * b"]
    y: Annotated[np.ndarray, float, "steps", "3", "2 * b"]
    unsolved: Annotated[np.ndarray, bool, "steps"]
    state: Annotated[np.ndarray, float, "modes"]


class StepWork(NamedTuple):
    """Scratch of a step: Newton's matrix, residual and the places of its columns, tangents; forces
    of a step, their last correction, what is seen without and with them, the state at its end."""

    matrix: Annotated[np.ndarray, float, "3 * b", "3 * b"]
    lack: Annotated[np.ndarray, float, "3 * b"]
    places: Annotated[np.ndarray, np.int64, "3 * b"]
    tangent: Annotated[np.ndarray, float, "3", "b", "2 * b"]
    phi: Annotated[np.ndarray, float, "3 * b"]
    change: Annotated[np.ndarray, float, "3 * b"]
    free: Annotated[np.ndarray, float, "6 * b"]
    here: Annotated[np.ndarray, float, "3", "2 * b"]
    after: Annotated[np.ndarray, float, "modes"]


class OrbitData(NamedTuple):
    """All arrays of a block; the samples are the points of a step."""

    machine: Interfaces
    samples: Samples
    lengths: Lengths
    period: Period
    work: StepWork


LAYOUT = Layout(
    OrbitData,
    [
        *GROUPS,
        Group("lengths", Lengths, {}),
        Group("period", Period, {}),
        Group("work", StepWork, {}),
    ],
    (*SIZES, "steps", "lengths", "modes", "b"),
)
_view = LAYOUT.view


@jit
def _linearize(run, speed, y):
    """Fill work.lack with the forces at the points less those in the modes and less work.phi, and
    work.tangent with their derivatives by y."""
    B, mean, work, at = run.period.B, run.period.mean, run.work, run.samples
    m, b = B.shape[0] // 2, B.shape[1]
    for i in range(3):
        for j in range(m):
            d, v = 0.0j, 0.0j
            for c in range(b):
                to = complex(B[2 * j, c], B[2 * j + 1, c])
                d += to * y[i, c]
                v += to * y[i, b + c]
            at.d[j, i], at.v[j, i] = d, v
    fill_in_laws(run.machine, at, 0, Weights(1.0, 0.0, 0.0), speed)
    fill_in_laws(run.machine, at, 1, Weights(0.0, 1.0, 0.0), speed)
    for i in range(3):
        for a in range(b):
            force = -work.phi[i * b + a]
            for o in range(2 * b):
                force -= mean[a, o] * y[i, o]
                work.tangent[i, a, o] = -mean[a, o]
            for j in range(m):
                x_a, y_a = B[2 * j, a], B[2 * j + 1, a]
                force += x_a * at.force[j, i].real + y_a * at.force[j, i].imag
                for o in range(2 * b):
                    c, which = o % b, o // b
                    to = complex(B[2 * j, c], B[2 * j + 1, c])
                    by = at.p[which, j, i] * to + at.q[which, j, i] * to.conjugate()
                    work.tangent[i, a, o] += x_a * by.real + y_a * by.imag
            work.lack[i * b + a] = force


@jit
def step_through(block, speed):
    """Fill period.y at the points of all steps, where a motion nearby is at first, the state at
    their end from that at their begin, and which steps were not solved."""
    run = _view(block)
    steps, period, work = run.lengths, run.period, run.work
    state, y, b = period.state, period.y, period.B.shape[1]
    n, c = len(state), 3 * b
    phi, free, here, after = work.phi, work.free, work.here, work.after
    largest = 0.0
    for i in range(len(steps.which)):
        k = steps.which[i]
        for p in range(6 * b):
            total = period.by_loads[i, p // (2 * b), p % (2 * b)]
            for j in range(n):
                total += steps.seen[k, p, j] * state[j]
            free[p] = total
        is_solved, share, before = False, 1.0, math.inf
        for p in range(c):
            phi[p] = 0.0
        for iteration in range(_ITERATIONS):
            is_first = iteration == 0  # along the motion nearby, where there are no forces yet
            for p in range(6 * b):
                total = y[i, p // (2 * b), p % (2 * b)] if is_first else free[p]
                for j in range(c):
                    total += steps.among[k, p, j] * phi[j]
                here[p // (2 * b), p % (2 * b)] = total
            _linearize(run, speed, here)
            for p in range(c if is_first else 0):
                for o in range(2 * b):
                    moved = free[p // b * 2 * b + o] - here[p // b, o]
                    work.lack[p] += work.tangent[p // b, p % b, o] * moved
            lack = 0.0
            for p in range(c):
                lack = max(lack, abs(work.lack[p]))
                largest = max(largest, abs(phi[p]))
            if not is_first and lack <= _TOLERANCE * largest:
                is_solved = True
                break
            if lack >= before and share > _LEAST_SHARE:  # half the way back
                share *= 0.5
                for p in range(c):
                    phi[p] -= share * work.change[p]
                continue
            share, before = 1.0, math.inf if is_first else lack
            for p in range(c):
                for j in range(c):
                    total = 1.0 if p == j else 0.0
                    for o in range(2 * b):
                        at = p // b * 2 * b + o
                        total -= work.tangent[p // b, p % b, o] * steps.among[k, at, j]
                    work.matrix[p, j] = total
            if not solve_columns(work.matrix, work.places, work.lack):
                break
            for p in range(c):
                work.change[p] = work.lack[p]
                phi[p] += work.change[p]
        period.unsolved[i] = not is_solved
        for j in range(n):
            total = steps.along[k, j] * state[j] + steps.across[k, j] * state[steps.other[j]]
            for p in range(c):
                total += steps.forced[k, j, p] * phi[p]
            after[j] = total
        for j in range(n):
            state[j] = after[j]
        for p in range(6 * b):
            y[i, p // (2 * b), p % (2 * b)] = here[p // (2 * b), p % (2 * b)]
    return DONE
