"""Steps of Radau IIA through a period: the machine's modes, with the forces of its interfaces at
the three points of each step solved for by Newton's method."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..kernels.jit import interpreted, jit
from ..step.interface_problem import solve_columns
from .condensed import Condensed
from .floquet import Lengths
from .laws import along

_TOLERANCE, _ITERATIONS = 1e-12, 30  # of forces, as a share of the largest; in a step
_LEAST_SHARE = 0.01  # of a correction after which the forces are better


class StepWork(NamedTuple):
    """Scratch of a step: relative displacements and velocities of the m interfaces at its points,
    what `laws.along` fills in, Newton's matrix, residual and the places of its columns, tangents;
    forces of a step, their last correction, what is seen without and with them, the state at its
    end."""

    d: np.ndarray
    v: np.ndarray
    own: np.ndarray
    force: np.ndarray
    p: np.ndarray
    q: np.ndarray
    rates: np.ndarray
    matrix: np.ndarray
    lack: np.ndarray
    places: np.ndarray
    tangent: np.ndarray
    phi: np.ndarray
    change: np.ndarray
    free: np.ndarray
    here: np.ndarray
    after: np.ndarray


@jit
def _linearize(laws, interfaces, B, mean, speed, y, work):
    """Fill work.lack with the forces at the points less those in the modes and less work.phi, and
    work.tangent, shape (3, b, 2 b), with their derivatives by y."""
    m, b = B.shape[0] // 2, B.shape[1]
    for i in range(3):
        for j in range(m):
            d, v = 0.0j, 0.0j
            for c in range(b):
                to = complex(B[2 * j, c], B[2 * j + 1, c])
                d += to * y[i, c]
                v += to * y[i, b + c]
            work.d[j, i], work.v[j, i] = d, v
    along(
        laws,
        interfaces,
        work.d,
        work.v,
        speed,
        work.own,
        work.own,
        work.force,
        work.p,
        work.q,
        work.rates,
    )
    for i in range(3):
        for a in range(b):
            force = -work.phi[i * b + a]
            for o in range(2 * b):
                force -= mean[a, o] * y[i, o]
                work.tangent[i, a, o] = -mean[a, o]
            for j in range(m):
                x_a, y_a = B[2 * j, a], B[2 * j + 1, a]
                force += x_a * work.force[j, i].real + y_a * work.force[j, i].imag
                for o in range(2 * b):
                    c, which = o % b, o // b
                    to = complex(B[2 * j, c], B[2 * j + 1, c])
                    by = work.p[which, j, i] * to + work.q[which, j, i] * to.conjugate()
                    work.tangent[i, a, o] += x_a * by.real + y_a * by.imag
            work.lack[i * b + a] = force


@jit
def _run(laws, interfaces, B, mean, speed, steps, by_loads, state, y, unsolved, work):
    """Fill y at the points of all steps, where a motion nearby is at first, the state at their end
    from that at their begin, and which steps were not solved."""
    b = B.shape[1]
    n, c = len(state), 3 * b
    phi, free, here, after = work.phi, work.free, work.here, work.after
    largest = 0.0
    seen, among, other = steps.seen, steps.among, steps.other
    for i in range(len(steps.which)):
        k = steps.which[i]
        for p in range(6 * b):
            total = by_loads[i, p // (2 * b), p % (2 * b)]
            for j in range(n):
                total += seen[k, p, j] * state[j]
            free[p] = total
        is_solved, share, before = False, 1.0, math.inf
        for p in range(c):
            phi[p] = 0.0
        for iteration in range(_ITERATIONS):
            is_first = iteration == 0  # along the motion nearby, where there are no forces yet
            for p in range(6 * b):
                total = y[i, p // (2 * b), p % (2 * b)] if is_first else free[p]
                for j in range(c):
                    total += among[k, p, j] * phi[j]
                here[p // (2 * b), p % (2 * b)] = total
            _linearize(laws, interfaces, B, mean, speed, here, work)
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
                        total -= work.tangent[p // b, p % b, o] * among[k, at, j]
                    work.matrix[p, j] = total
            if not solve_columns(work.matrix, work.places, work.lack):
                break
            for p in range(c):
                work.change[p] = work.lack[p]
                phi[p] += work.change[p]
        unsolved[i] = not is_solved
        for j in range(n):
            total = steps.along[k, j] * state[j] + steps.across[k, j] * state[other[j]]
            for p in range(c):
                total += steps.forced[k, j, p] * phi[p]
            after[j] = total
        for j in range(n):
            state[j] = after[j]
        for p in range(6 * b):
            y[i, p // (2 * b), p % (2 * b)] = here[p // (2 * b), p % (2 * b)]


def run(
    machine: Condensed,
    speed: float,
    mean: np.ndarray,
    steps: Lengths,
    by_loads: np.ndarray,
    begin: np.ndarray,
    near: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What is seen at the points of all steps, shape (steps, 3, 2 b), from real amplitudes at the
    begin on, those at the end, and which steps were not solved, shape (steps,); near: what is seen
    of a motion nearby."""
    b, m = machine.b, machine.laws.count
    laws, interfaces = machine.laws.records
    of_points, of_forces = np.zeros((4, m, 3), complex), np.zeros((3, 3 * b))
    work = StepWork(
        d=of_points[0],
        v=of_points[1],
        own=np.zeros((3, 0)),
        force=of_points[2],
        p=np.zeros((2, m, 3), complex),
        q=np.zeros((2, m, 3), complex),
        rates=np.zeros((3, 0)),
        matrix=np.zeros((3 * b, 3 * b)),
        lack=of_forces[0],
        places=np.arange(3 * b),
        tangent=np.zeros((3, b, 2 * b)),
        phi=of_forces[1],
        change=of_forces[2],
        free=np.zeros(6 * b),
        here=np.zeros((3, 2 * b)),
        after=np.zeros(len(begin)),
    )
    y, state = np.array(near, float), np.array(begin, float)
    kernel = _run if machine.laws.is_fast else interpreted(_run)
    B = np.ascontiguousarray(machine.B)
    unsolved = np.zeros(len(y), bool)
    arrays = steps, by_loads, state, y, unsolved, work
    kernel(laws, interfaces, B, np.ascontiguousarray(mean), float(speed), *arrays)
    return y, state, unsolved
