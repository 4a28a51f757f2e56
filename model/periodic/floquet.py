"""Stability of a periodic motion: Floquet multipliers of the machine linearized along it.

The linearized machine is integrated by Radau IIA with three points a step (order 5, stiffly
accurate) in the modes of the machine with mean interface tangents; only the deviations dT of the
tangents from their means couple the modes. Steps end where a contact opens or closes:

    u' = Lambda u + W f,    y = V u + R f,    f = dT(t) y

y: displacements and velocities of the interfaces, and internal states; R: static flexibility of the
modes left out.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
import scipy.linalg

from .balance import Orbit
from .entry_points import Propagators
from .force_corners import crossings
from .fourier import basis
from .laws import ForcesAndTangents
from .linear_structure import CondensedMachine
from .mesh import POINTS, mean_weights

_SAMPLED = np.array([*POINTS[:2], 1.0 - 1e-7])  # where in a step the tangents are looked at
_LEAST, _MOST = 96, 1024  # steps a turn
_LEAST_STATE = 1e-5  # of a state's size in a motion as large as its interface's length
_KEPT = 200.0  # modes up to so many times the highest frequency of the orbit are kept,
_KEPT_ANYHOW = 2  # and so many of a motion that is slower than all modes


class Multipliers(NamedTuple):
    """Floquet multipliers, the largest first, and their eigenvectors as displacements and
    velocities of all coordinates, one a column."""

    values: np.ndarray
    shapes: np.ndarray


class ModalBasis(NamedTuple):
    """Eigenvalues of the machine with mean tangents [1/s], modal forces W, outputs V of the modes,
    static outputs R of the modes left out, and displacements and velocities of all coordinates in
    the modes."""

    roots: np.ndarray
    W: np.ndarray
    V: np.ndarray
    R: np.ndarray
    shapes: np.ndarray


class Frequencies(NamedTuple):
    """Speed of the rotor, frequency of the motion, and the highest frequency it contains
    [rad/s]."""

    speed: float
    frequency: float
    highest: float


class MotionPath(NamedTuple):
    """A motion along which the machine is linearized.

    at: gives for times [s], shape (n,), the displacements [m] and velocities [m/s] of the m
    nonlinear interfaces, x and y in turn, shape (n, 2 m) each, and the internal states, shape (n,
    s), whose sizes are `state_scale`.
    """

    at: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]]
    frequencies: Frequencies
    state_scale: np.ndarray


def orbit_path(machine: CondensedMachine, orbit: Orbit) -> MotionPath:
    """Return the path of an orbit."""
    d, frequency = orbit.b @ machine.B.T, abs(orbit.omega)

    def at(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        value, slope = basis(orbit.H, frequency * times)
        return value @ d, orbit.omega * slope @ d, value @ orbit.states

    highest = frequency * max(orbit.H, orbit.turns)
    scale = state_scales_along(machine, orbit.states, frequency)
    return MotionPath(at, Frequencies(orbit.speed, frequency, highest), scale)


def state_scales_along(
    machine: CondensedMachine, states: np.ndarray, frequency: float
) -> np.ndarray:
    """Return the sizes of internal states along a motion of a frequency [rad/s], shape (s,);
    states: values or coefficients, shape (n, s)."""
    least = _LEAST_STATE * machine.laws.state_scales(frequency)
    return np.maximum(np.abs(states).max(axis=0, initial=0.0), least)


def multipliers(machine: CondensedMachine, orbit: Orbit, steps: int = 0) -> Multipliers:
    """Return the Floquet multipliers of an orbit; steps: number of time steps in a period, 0:
    chosen from its harmonics."""
    path = orbit_path(machine, orbit)
    period = 2 * math.pi / path.frequencies.frequency
    steps = steps or min(_MOST, max(_LEAST * orbit.turns, 4 * orbit.H))
    if machine.laws.count == 0:
        modes = modal_basis(machine, path.frequencies, np.zeros((0, 0)))
        return Multipliers(*_sorted(np.exp(modes.roots * period), modes.shapes))
    (part,) = tangents_along(machine, path, [np.linspace(0.0, period, steps + 1)])
    modes, mean = modes_along(machine, path, [part])
    values, vectors = np.linalg.eig(transition_matrix(modes, mean, part))
    return Multipliers(*_sorted(values, modes.shapes @ vectors))


class PathSegment(NamedTuple):
    """A segment of a path in steps of lengths h [s], shape (n,), with the tangents at the points of
    each, shape (n, 3, inputs, outputs)."""

    h: np.ndarray
    tangent: np.ndarray


def tangents_along(
    machine: CondensedMachine, path: MotionPath, cuts: Sequence[np.ndarray]
) -> list[PathSegment]:
    """Return the tangents along segments of a path, each between times [s]; steps end at these
    times and where a contact opens or closes. States are left out that stay what they are, or act
    on nothing, such as the elongation of a spring that a part does without, or the tilt of a pad
    that bears nothing: a difference in one neither grows nor decays."""
    parts = [_tangents_between(machine, path, times) for times in cuts]
    b = machine.b
    moves = np.any([part.tangent[:, :, b:].any(axis=(0, 1, 3)) for part in parts], axis=0)
    acts = np.any([part.tangent[..., 2 * b :].any(axis=(0, 1, 2)) for part in parts], axis=0)
    if (moves & acts).all():
        return parts
    rows, columns = (np.append(np.full(n, True), moves & acts) for n in (b, 2 * b))
    return [part._replace(tangent=part.tangent[:, :, rows][..., columns]) for part in parts]


def _tangents_between(
    machine: CondensedMachine, path: MotionPath, times: np.ndarray
) -> PathSegment:
    ends = _step_ends(machine, path, times)
    h = np.diff(ends)
    # at its last point a step takes its side of a contact that opens or closes there
    d, v, states = path.at((ends[:-1, None] + h[:, None] * _SAMPLED).ravel())
    laws = machine.laws.tangents(d, v, states, path.state_scale, path.frequencies.speed)
    tangent = tangents_by_y(machine, laws)
    return PathSegment(h, tangent.reshape(len(h), 3, *tangent.shape[1:]))


def modes_along(
    machine: CondensedMachine, path: MotionPath, parts: Sequence[PathSegment]
) -> tuple[ModalBasis, np.ndarray]:
    """Return the modal basis with the mean tangents of segments of a path, and these tangents."""
    length = sum(float(part.h.sum()) for part in parts)
    each = [np.einsum("t,i,tiao->ao", part.h, mean_weights(), part.tangent) for part in parts]
    mean = with_weak_springs(machine, path.frequencies, sum(each) / length)
    return modal_basis(machine, path.frequencies, mean), mean


def _sorted(values: np.ndarray, shapes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = np.argsort(-np.abs(values), kind="stable")
    return values[order], shapes[:, order]


def _step_ends(machine: CondensedMachine, path: MotionPath, times: np.ndarray) -> np.ndarray:
    """Return the ends of the steps: the given evenly spaced times, and the times at which a force
    has a corner."""
    laws, h = machine.laws, times[1] - times[0]
    if not len(laws.corner_owner):
        return times

    def gaps(at: np.ndarray) -> np.ndarray:
        return laws.corner_gaps(*path.at(at)[:2])

    beyond = np.concatenate([[times[0] - h], times, [times[-1] + h]])
    cell, share, _ = crossings(laws, gaps(beyond), lambda c, x: gaps(times[c] + h * x))
    return np.unique(np.concatenate([times, times[cell] + h * share]))


def tangents_by_y(machine: CondensedMachine, along: ForcesAndTangents) -> np.ndarray:
    """Return the derivatives with respect to y of the forces on b and of the rates of the states at
    n samples, shape (n, b + s, 2 b + s)."""
    n, s, b, B = len(along.force), machine.laws.states, machine.b, machine.B
    out = np.zeros((n, b + s, 2 * b + s))
    out[:, :b, :b] = machine.tangents_in_b(along.by_d)
    out[:, :b, b : 2 * b] = machine.tangents_in_b(along.by_v)
    out[:, :b, 2 * b :] = B.T @ along.by_states
    out[:, b:, :b] = along.rates_by_d @ B
    out[:, b:, b : 2 * b] = along.rates_by_v @ B
    out[:, b:, 2 * b :] = along.rates_by_states
    return out


def with_weak_springs(
    machine: CondensedMachine, frequencies: Frequencies, mean: np.ndarray
) -> np.ndarray:
    """Return mean tangents with a weak spring at every contact that is almost always open, so that
    no rigid-body mode is left."""
    own = np.diag(machine.matrices(frequencies.speed).M)[: machine.b] * frequencies.frequency**2
    diagonal = np.arange(machine.b)
    lacks = np.abs(mean[diagonal, diagonal]) < 0.1 * own
    with_weak_springs = mean.copy()
    with_weak_springs[diagonal[lacks], diagonal[lacks]] -= own[lacks]
    return with_weak_springs


def modal_basis(
    machine: CondensedMachine, frequencies: Frequencies, mean: np.ndarray
) -> ModalBasis:
    """Return the modal basis of the machine linearized with mean tangents."""
    M, D, K = machine.matrices(frequencies.speed)
    N, b = machine.size, machine.b
    s = max(0, len(mean) - b)  # states
    K, D = K.copy(), D.copy()
    if len(mean):
        K[:b, :b] -= mean[:b, :b]
        D[:b, :b] -= mean[:b, b : 2 * b]
    # of the symmetric part of K, mass-normalized
    squares, shapes = scipy.linalg.eigh(0.5 * (K + K.T), M)
    most = _KEPT * frequencies.highest
    # of an overdamped mode, as in a film, the slower root is its stiffness over its damping
    slow = squares < most * np.maximum(most, ((D @ shapes) * shapes).sum(axis=0))
    slow[:_KEPT_ANYHOW] = True
    P, rest = shapes[:, slow], shapes[:, ~slow]
    n = P.shape[1]
    frequency = frequencies.frequency
    A = np.zeros((2 * n + s, 2 * n + s))
    A[:n, n : 2 * n] = frequency * np.eye(n)  # velocities over pace
    A[n : 2 * n, :n] = -(P.T @ K @ P) / frequency
    A[n : 2 * n, n : 2 * n] = -(P.T @ D @ P)
    inputs = np.zeros((2 * n + s, b + s))
    inputs[n : 2 * n, :b] = P[:b].T / frequency
    inputs[2 * n :, b:] = np.eye(s)
    outputs = np.zeros((2 * b + s, 2 * n + s))
    outputs[:b, :n], outputs[b : 2 * b, n : 2 * n] = P[:b], frequency * P[:b]
    outputs[2 * b :, 2 * n :] = np.eye(s)
    if len(mean):
        A[n : 2 * n, 2 * n :] = P[:b].T @ mean[:b, 2 * b :] / frequency
        A[2 * n :] += mean[b:] @ outputs
    roots, vectors = np.linalg.eig(A)
    W = np.linalg.solve(vectors, inputs.astype(complex))
    R = np.zeros((2 * b + s, b + s))
    if rest.shape[1]:
        R[:b, :b] = rest[:b] @ np.linalg.solve(rest.T @ K @ rest, rest[:b].T)
    whole = np.zeros((2 * N, 2 * n + s))
    whole[:N, :n], whole[N:, n : 2 * n] = P, frequency * P
    return ModalBasis(roots, W, outputs @ vectors, R, whole @ vectors)


def _collocation(roots: np.ndarray, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return for Radau IIA steps of lengths h [s], shape (l,), the growth of each mode at the three
    points, shape (l, 3, modes), and the weights of the forces at the points, shape (l, 3, 3, modes)
    [s].

    Both follow from (1 - z a)^-1, z = h root, by its adjugate 1 - z (tr a - a) + z^2 adj a.
    """
    powers = np.array([POINTS**p for p in range(3)])
    integrals = np.array([POINTS ** (p + 1) / (p + 1) for p in range(3)])
    a = integrals.T @ np.linalg.inv(powers).T
    trace, det, one = np.trace(a), np.linalg.det(a), np.eye(3)
    adjugate = det * np.linalg.inv(a)
    z = h[:, None] * roots
    per = 1.0 / (1.0 - z * (trace - z * (np.trace(adjugate) - z * det)))
    powers = np.stack([per, z * per, z * z * per], axis=1)  # shape (l, 3, modes)
    grown = np.array([one, a - trace * one, adjugate]).sum(axis=2).T @ powers
    weight = np.array([a, a @ a - trace * a, det * one]).reshape(3, 9).T @ powers
    return grown, (h[:, None, None] * weight).reshape(len(h), 3, 3, len(roots))


def propagators(modes: ModalBasis, h: np.ndarray) -> Propagators:
    """Return the propagators of steps of lengths h [s]. A complex pair of modes is represented by
    the real and imaginary part of its amplitude, since complex arithmetic takes four times as
    long."""
    (outputs, n), c = modes.V.shape, modes.W.shape[1]
    each, which = np.unique(np.round(h / h.max(), 12), return_inverse=True)
    count, is_first = len(each), modes.roots.imag > 0
    is_second = np.roll(is_first, 1)
    of = np.flatnonzero(~is_second)  # one of each pair, whose other is its conjugate
    grown, weight = _collocation(modes.roots[of], each * h.max())
    V, W = modes.V[:, of], modes.W[of]
    twice = np.where(is_first[of], 2.0, 1.0)
    last = weight[:, 2].transpose(0, 2, 1)
    forced = (last[..., None] * W[:, None]).reshape(count, len(of), 3 * c)
    seen = (twice * V * grown[:, :, None, :]).reshape(count, 3 * outputs, len(of))
    of_force = (twice[:, None, None] * V.T[:, :, None] * W[:, None, :]).reshape(len(of), -1)
    weight = weight.reshape(-1, len(of))
    among = weight.real @ of_force.real - weight.imag @ of_force.imag
    among = among.reshape(count, 3, 3, outputs, c)
    among[:, np.arange(3), np.arange(3)] += modes.R
    place = np.cumsum(~is_second) - 1
    free, forced = grown[:, 2].take(place, 1), forced.take(place, 1)
    seen = seen.take(place, 2)
    return Propagators(
        which,
        # g (a + i b): -Im g b in the row of a, Im g a in that of b
        free.real.copy(),
        np.where(is_second, free.imag, -free.imag),
        np.where(is_second[:, None], forced.imag, forced.real),
        np.where(is_second, -seen.imag, seen.real),
        among.transpose(0, 1, 3, 2, 4).reshape(count, 3 * outputs, 3 * c),
        np.arange(n) + is_first - is_second,
    )


def transition_matrix(modes: ModalBasis, mean: np.ndarray, part: PathSegment) -> np.ndarray:
    """Return the matrix that takes the modes' amplitudes from the begin to the end of a segment;
    mean: the tangents that the modes contain."""
    T, inverse = real_amplitudes(modes.roots)
    return T @ real_transition_matrix(propagators(modes, part.h), part.tangent - mean) @ inverse


def real_transition_matrix(steps: Propagators, change: np.ndarray) -> np.ndarray:
    """Return the matrix that takes real amplitudes over all steps, shape (n, n), with the interface
    forces `change` y at the points, shape (steps, 3, c, outputs)."""
    count, _, c, outputs = change.shape
    n = steps.diagonal.shape[1]
    among = steps.output_by_force.reshape(-1, 3, outputs, 3 * c)[steps.length_of_step]
    left = np.eye(3 * c) - (change @ among).reshape(count, 3 * c, 3 * c)
    seen = steps.output_by_state.reshape(-1, 3, outputs, n)[steps.length_of_step]
    forces = np.linalg.inv(left) @ (change @ seen).reshape(count, 3 * c, n)
    step = steps.state_by_force[steps.length_of_step] @ forces
    own = np.arange(n)
    step[:, own, own] += steps.diagonal[steps.length_of_step]
    step[:, own, steps.partner] += steps.cross[steps.length_of_step]
    while len(step) > 1:  # the product, of neighbours first
        odd = step[len(step) - len(step) % 2 :]
        step = np.concatenate([step[1::2] @ step[: len(step) - len(odd) : 2], odd])
    return step[0]


def real_amplitudes(roots: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the matrix from real to complex amplitudes, and its inverse; the two members of a
    complex pair are adjacent, the one with positive imaginary part first."""
    n = len(roots)
    T, inverse = np.eye(n, dtype=complex), np.eye(n, dtype=complex)
    for m in np.flatnonzero(roots.imag > 0):
        pair = slice(m, m + 2)
        T[pair, pair] = [[1, 1j], [1, -1j]]
        inverse[pair, pair] = [[0.5, 0.5], [-0.5j, 0.5j]]
    return T, inverse
