"""Modes of the linearized machine at a speed: eigenvalues nearest to rest, and their shapes.

With lambda = -zeta omega_n + i omega_d the motion is Re(shape exp(lambda t)). What is solved is the
inverse at a real shift sigma, whose largest eigenvalues 1 / (lambda - sigma) are the lowest modes:
these come out exact to rounding where the machine itself is stiff by ten decades.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs, splu

from ..machine.rotor import Rotor
from .machine import Linear, LinearError, LinearMachine
from .spectrum import Spectrum

FORWARD, BACKWARD, PLANAR, MIXED = "forward", "backward", "planar", "mixed"
_DENSE = 220  # states up to which all eigenvalues cost less than a few
_SHIFT = 0.3  # of the lowest elastic frequency
_DEGENERATE = 1e-7  # relative distance of two eigenvalues that are one
_PLANAR = 1e-3  # forwardness below which an orbit is a line
# Share of the imaginary part below which an eigenvalue is real: two real ones that are equal come
# out apart by the root of rounding.
_REAL = 1e-5
DEFAULT_COUNT = 8


@dataclass(frozen=True)
class Modes(Spectrum):
    """The lowest modes of a machine at a speed [rad/s], by natural frequency; m modes, n nodes.

    contacts: `open` or `pinned`; z: positions of the nodes [m], shape (n,); eigenvalues [1/s],
    complex of shape (m,); x, y: shapes, complex of shape (m, n), the largest semi-axis 1; slope_x,
    slope_y [1/m], alike; housing_x, housing_y: shape (m, housings); is_degenerate: shape (m,),
    whether a mode shares its eigenvalue, so that it may whirl either way; decays: eigenvalues of
    what does not oscillate [1/s], slowest first.
    """

    speed: float
    contacts: str
    z: np.ndarray
    eigenvalues: np.ndarray
    x: np.ndarray
    y: np.ndarray
    slope_x: np.ndarray
    slope_y: np.ndarray
    housing_x: np.ndarray
    housing_y: np.ndarray
    is_degenerate: np.ndarray
    decays: np.ndarray

    @property
    def forwardness(self) -> np.ndarray:
        """1 of a circle with the spin, -1 against it, 0 of a line: (|f|^2 - |b|^2) / (|f|^2 +
        |b|^2), summed over the nodes, with f, b the parts that turn with and against the spin."""
        forward, backward = (np.sum(np.abs(p) ** 2, axis=1) for p in self._parts())
        sense = -1.0 if self.speed < 0 else 1.0
        return sense * (forward - backward) / (forward + backward)

    @property
    def whirl(self) -> tuple[str, ...]:
        """`forward`, `backward`, `planar`, or `mixed` where some nodes whirl forward, others
        backward."""
        forward, backward = (np.abs(p) ** 2 for p in self._parts())
        each = (forward - backward) / (forward + backward).max(axis=1, keepdims=True)
        return tuple(
            PLANAR if degenerate else _word(nodes, whole)
            for nodes, whole, degenerate in zip(
                each, self.forwardness, self.is_degenerate, strict=True
            )
        )

    def _parts(self) -> tuple[np.ndarray, np.ndarray]:
        return (self.x + 1j * self.y) / 2, (self.x - 1j * self.y).conj() / 2


def _word(nodes: np.ndarray, whole: float) -> str:
    if nodes.max() > _PLANAR and nodes.min() < -_PLANAR:
        return MIXED
    if abs(whole) < _PLANAR:
        return PLANAR
    return FORWARD if whole > 0 else BACKWARD


def modes(
    rotor: Rotor,
    speed: float = 0.0,
    *,
    count: int = DEFAULT_COUNT,
    contacts: str | None = None,
) -> Modes:
    """The `count` lowest modes at a speed [rad/s], fewer where there are fewer.

    contacts: `open` or `pinned`; None: open where the machine is held without them. Raises
    `LinearError`.
    """
    return machine_modes(LinearMachine(rotor, contacts), speed, count)


def machine_modes(machine: LinearMachine, speed: float, count: int) -> Modes:
    """`modes` of a machine that is linear already."""
    check_speed(speed)
    if count < 1:
        raise LinearError(f"count = {count}: must be at least 1")
    linear = machine.at(speed)
    values, vectors = _eigen(linear, machine.structure.numbers[0].lowest_omega, count)
    oscillates = values.imag > _REAL * np.abs(values)
    is_real = np.abs(values.imag) <= _REAL * np.abs(values)
    decays = np.sort(values[is_real].real)[::-1]
    found = np.flatnonzero(oscillates)
    found = found[np.argsort(np.abs(values[found]))][:count]
    values, shapes = values[found], vectors[:, found]
    degenerate = _untangle(values, shapes, machine)
    return _as_modes(machine, speed, values, shapes, degenerate, decays)


def check_speed(speed: float) -> None:
    """Raise `LinearError` unless the speed is a finite number."""
    if not math.isfinite(speed):
        raise LinearError(f"speed = {speed}: must be finite")


def _eigen(linear: Linear, scale: float, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Eigenvalues [1/s] and the displacements of their vectors; at least `count` that oscillate
    where there are so many. scale: a frequency of the machine [rad/s]."""
    # in units of time of 1 / scale, so that displacements and velocities are alike
    M, D, K = scale**2 * linear.M, scale * linear.D, linear.K
    size = M.shape[0]
    sigma = _SHIFT
    factors = splu((sigma**2 * M + sigma * D + K).tocsc())

    def inverse(state: np.ndarray) -> np.ndarray:
        q, v = state[:size], state[size:]
        moved = factors.solve(-(M @ v) - D @ q - sigma * (M @ q))
        return np.concatenate([moved, q + sigma * moved])

    wanted = 2 * count + 4
    while True:
        if 2 * size <= _DENSE or wanted + 2 >= 2 * size // 3:
            inverted, vectors = scipy.linalg.eig(inverse(np.eye(2 * size)))
        else:
            operator = LinearOperator((2 * size, 2 * size), matvec=inverse, dtype=float)
            start = np.random.default_rng(1).standard_normal(2 * size)
            try:
                inverted, vectors = eigs(operator, k=wanted, v0=start, which="LM")
            except ArpackNoConvergence as error:
                raise LinearError("the modes did not converge; ask for fewer or more") from error
        values = scale * (sigma + 1 / inverted)
        is_complete = len(values) == 2 * size
        if is_complete or np.sum(values.imag > _REAL * np.abs(values)) >= count:
            return values, vectors[:size]
        wanted *= 2


def _untangle(values: np.ndarray, shapes: np.ndarray, machine: LinearMachine) -> np.ndarray:
    """Make the two shapes of an eigenvalue that is there twice a forward and a backward circle, if
    they can be; returns which modes share their eigenvalue."""
    degenerate = np.zeros(len(values), dtype=bool)
    for i in range(len(values) - 1):
        if degenerate[i] or abs(values[i + 1] - values[i]) > _DEGENERATE * abs(values[i]):
            continue
        pair = shapes[:, i : i + 2]
        degenerate[i : i + 2] = True
        whole = machine.expand @ pair
        x, y = whole[::2], whole[1::2]
        circles = []
        for sense in (-1, 1):
            # backward: y = i x, the null space of y - i x; forward: of y + i x
            _, sizes, mixed = np.linalg.svd(y + 1j * sense * x, full_matrices=False)
            if sizes[1] < 1e-3 * sizes[0]:
                circles.append(pair @ mixed[1].conj())
        if len(circles) == 2:
            shapes[:, i : i + 2] = np.column_stack(circles)
    return degenerate


def _as_modes(
    machine: LinearMachine,
    speed: float,
    values: np.ndarray,
    shapes: np.ndarray,
    degenerate: np.ndarray,
    decays: np.ndarray,
) -> Modes:
    whole = (machine.expand @ shapes).T
    x, y = whole[:, ::2], whole[:, 1::2]
    nodes = len(machine.nodes)
    n = 2 * nodes
    forward, backward = np.abs(x + 1j * y) / 2, np.abs(x - 1j * y) / 2
    axis = (forward + backward)[:, :n:2]
    at = np.argmax(axis, axis=1)
    each = np.arange(len(values))
    # phase: x at the largest orbit real, or y where there is no x
    lead = np.where(np.abs(x[each, 2 * at]) >= np.abs(y[each, 2 * at]), x[each, 2 * at], 0)
    lead = np.where(lead == 0, y[each, 2 * at], lead)
    factor = (np.abs(lead) / (lead * axis[each, at]))[:, None]
    x, y = x * factor, y * factor
    return Modes(
        speed=speed,
        contacts=machine.contacts,
        z=machine.nodes,
        eigenvalues=values,
        x=x[:, :n:2],
        y=y[:, :n:2],
        slope_x=x[:, 1:n:2],
        slope_y=y[:, 1:n:2],
        housing_x=x[:, n:-1],
        housing_y=y[:, n:-1],
        is_degenerate=degenerate,
        decays=decays,
    )
