"""Whirls that grow by themselves: roots of the machine with its contacts open, or closed and
slipping.

Far behind its wall a journal that whirls with its contact closed and slipping meets a force that
depends on its displacement linearly, F = -k (1 + i mu) d, the limit of a large circle: normal force
and, across it, friction, which feeds a backward whirl (Black 1968). A root with a positive real
part there is dry whip. A smaller circle meets a softer wall; how it comes to touch is not asked. A
wall with a state of its own, a race that turns, is taken along instead of slipping for long, and is
left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..kernels.band import to_dense
from ..structure.assembly import Structure
from ..structure.reduction import reduced

MOST_DOFS = 60  # of the shaft; a longer one is reduced first
_MODES = 12
_GROWING = 1e-5  # least Re lambda / |lambda| of what is called growing: below it is rounding
_SLOW = 1e-3  # of the machine's lowest frequency: a root below it is a motion as a rigid body


class Tangents(NamedTuple):
    """dF = p z + q conj(z) of m interfaces: by displacement [N/m], by velocity [N.s/m], complex of
    shape (m,). Of interfaces with a wall: where they are closed and slip."""

    p_d: np.ndarray
    q_d: np.ndarray
    p_v: np.ndarray
    q_v: np.ndarray


@dataclass(frozen=True)
class Whirl:
    """A growing whirl: root lambda, imaginary part > 0 [1/s]; is_backward: against the rotation,
    seen at the closed contacts (or the whole shaft); closed: which interfaces with a wall are
    closed; speed [rad/s]."""

    root: complex
    is_backward: bool
    closed: tuple[int, ...]
    speed: float

    @property
    def hz(self) -> float:
        """Frequency [Hz]."""
        return self.root.imag / (2 * np.pi)


def growing_whirls(
    structure: Structure, tangents: Tangents, speeds: Sequence[float]
) -> tuple[Whirl, ...]:
    """The growing whirls with all contacts open, each alone closed, and all closed, at these speeds
    of rotation [rad/s]; the fastest growing first."""
    machine = _Machine(coarse(structure), tangents)
    has_wall, states = structure.interfaces.has_wall, structure.interfaces.states
    walls = np.flatnonzero((has_wall == 1) & (states == 0)).tolist()
    cases = {(), *((j,) for j in walls), tuple(walls)}
    found = [w for speed in speeds for case in sorted(cases) for w in machine.growing(speed, case)]
    return tuple(sorted(found, key=lambda w: -w.root.real))


def coarse(structure: Structure) -> Structure:
    """The machine as whirls are looked for in it: a long shaft reduced."""
    return reduced(structure, _MODES) if len(structure.weight) > MOST_DOFS else structure


def growth_at_rest(structure: Structure, tangents: Tangents) -> complex | None:
    """Root of the growth with the least damping ratio where nothing turns and all contacts are open
    [1/s], its imaginary part >= 0; None where nothing grows. tangents: at rest."""
    machine = _Machine(coarse(structure), tangents)
    roots = machine.roots(0.0, ())
    grows = (roots.imag >= 0.0) & (np.abs(roots) > _SLOW * structure.numbers[0].lowest_omega)
    grows &= roots.real > _GROWING * np.abs(roots)

    def growth(root: complex) -> tuple[float, float]:
        # of those that do not oscillate, which differ in rounding alone, the fastest
        return round(root.real / abs(root), 9), root.real

    return complex(max(roots[grows], key=growth)) if grows.any() else None


class _Machine:
    """x' = A x in real coordinates, x = (q, v / scale), q the x of all dofs and housings, then
    their y; matrices are multiplied by M^-1 from the left."""

    def __init__(self, structure: Structure, tangents: Tangents) -> None:
        n, housings = len(structure.weight), structure.housings
        self._half = half = n + len(housings)
        numbers = structure.numbers[0]
        self._scale = numbers.lowest_omega
        self._numbers = numbers
        mass = np.zeros((half, half))
        mass[:n, :n] = to_dense(structure.M)
        mass[range(n, half), range(n, half)] = housings.mass
        inverse = np.linalg.inv(mass)

        def plane(band: np.ndarray, own: np.ndarray | float = 0.0) -> np.ndarray:
            matrix = np.zeros((half, half))
            matrix[:n, :n] = to_dense(band)
            matrix[range(n, half), range(n, half)] = own
            return inverse @ matrix

        turned = np.array([[0.0, 1.0], [-1.0, 0.0]])  # -i z in (x, y)
        self._C = _planes(plane(structure.C, housings.cx), plane(structure.C, housings.cy))
        self._K = _planes(plane(structure.K, housings.kx), plane(structure.K, housings.ky))
        self._G = np.kron(turned, plane(structure.G))
        self._circulation = np.kron(turned, plane(structure.K_shaft))
        pick = np.zeros((len(structure.interfaces), half + 1))  # ground is last
        rows = np.arange(len(pick))
        pick[rows, structure.interfaces.dof] = 1.0
        pick[rows, structure.interfaces.end] = -1.0
        self._pick = pick[:, :-1]
        self._push = inverse @ self._pick.T
        self._by_d = _matrices(tangents.p_d, tangents.q_d)
        self._by_v = _matrices(tangents.p_v, tangents.q_v)
        self._always = np.flatnonzero(structure.interfaces.has_wall == 0).tolist()

    def roots(self, speed: float, closed: tuple[int, ...]) -> np.ndarray:
        """All eigenvalues at one speed [rad/s] with these walls touched [1/s]."""
        return self._scale * np.linalg.eigvals(self._matrix(speed, closed))

    def growing(self, speed: float, closed: tuple[int, ...]) -> list[Whirl]:
        """The growing whirls at one speed [rad/s] with these walls touched."""
        A = self._matrix(speed, closed)
        scale = self._scale
        roots = scale * np.linalg.eigvals(A)
        if not self._which(roots).any():
            return []
        values, vectors = np.linalg.eig(A)
        roots = scale * values
        return [
            Whirl(complex(roots[i]), self._is_backward(vectors[:, i], closed, speed), closed, speed)
            for i in np.flatnonzero(self._which(roots))
        ]

    def _which(self, roots: np.ndarray) -> np.ndarray:
        is_whirl = roots.imag > _SLOW * self._scale
        return is_whirl & (roots.real > _GROWING * np.abs(roots))

    def _matrix(self, speed: float, closed: tuple[int, ...]) -> np.ndarray:
        kappa = self._numbers.kappa_v * speed + self._numbers.kappa_h * np.sign(speed)
        K = self._K + kappa * self._circulation
        C = self._C + speed * self._G
        for j in (*self._always, *closed):
            at = np.outer(self._push[:, j], self._pick[j])
            K = K - np.kron(self._by_d[j], at)
            C = C - np.kron(self._by_v[j], at)
        size = len(K)
        A = np.zeros((2 * size, 2 * size))
        A[range(size), range(size, 2 * size)] = 1.0
        A[size:, :size] = -K / self._scale**2
        A[size:, size:] = -C / self._scale
        return A

    def _is_backward(self, vector: np.ndarray, closed: tuple[int, ...], speed: float) -> bool:
        x, y = vector[: self._half], vector[self._half : 2 * self._half]
        if closed:
            pick = self._pick[list(closed)]
            x, y = pick @ x, pick @ y
        forward, backward = (np.sum(np.abs(x + sign * 1j * y) ** 2) for sign in (1, -1))
        return bool((backward > forward) == (speed >= 0))


def _planes(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    none = np.zeros_like(x)
    return np.block([[x, none], [none, y]])


def _matrices(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """p z + q conj(z) as matrices of (x, y), shape (m, 2, 2)."""
    return np.moveaxis(np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]]), 2, 0)
