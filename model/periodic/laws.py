"""The force laws along an orbit: forces, tangents, rates and openings at its samples.

The one place from where this package calls the laws; the tangents are the kernels' own.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..backend import Backend, selected_backend
from ..kernels.jit import IS_COMPILED, has_to_compile, interpreted, jit, jit_not_inlined
from ..parts import LAWS
from ..parts.law import Kinematics, Weights
from ..parts.linear_bearing import LINEAR_BEARING
from ..step.laws import law_gap, law_rates, law_tangent
from ..structure.structure import Structure, starts_of

_STEP = 1e-6  # of a central difference, as a share of the variable's scale


def is_linear(structure: Structure) -> np.ndarray:
    """Of each interface, whether its law is linear in displacement and velocity."""
    linear = LAWS.index(LINEAR_BEARING)
    return np.asarray(structure.interfaces.law == linear)


class Forces(NamedTuple):
    """What m interfaces with s own states do at n samples: forces of x and y, shape (n, 2 m) [N],
    and rates of the states, shape (n, s)."""

    force: np.ndarray
    rates: np.ndarray


class Along(NamedTuple):
    """What m interfaces with s own states do at n samples: forces F of x and y, shape (n, 2 m) [N];
    their derivatives by displacements, by velocities, shape (n, m, 2, 2) each, and by own states,
    shape (n, 2 m, s); rates of the states, shape (n, s), with their derivatives by displacements
    and velocities, shape (n, s, 2 m) each, and by states, shape (n, s, s)."""

    force: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray
    by_rate: np.ndarray
    rates: np.ndarray
    rates_by_d: np.ndarray
    rates_by_v: np.ndarray
    rates_by_own: np.ndarray


@jit_not_inlined
def along(laws, interfaces, d, v, speed, own, scratch, force, p, q, rates):
    """Forces, tangents p z + q conj(z) by displacement and by velocity, and rates."""
    for j in range(len(interfaces)):
        interface = interfaces[j]
        at = interface.internal_state
        for t in range(d.shape[1]):
            for i in range(2):
                result = law_tangent(
                    laws,
                    interface,
                    Kinematics(d[j, t], v[j, t], speed, speed, 0.0),
                    Weights(1.0 - i, 1.0 * i, 0.0),
                    own[t, at:],
                    scratch[t, at:],
                )
                force[j, t], p[i, j, t], q[i, j, t] = result
            motion = Kinematics(d[j, t], v[j, t], speed, speed, 0.0)
            law_rates(laws, interface, motion, own[t, at:], rates[t, at:])


@jit
def _openings(laws, interfaces, d, opening):
    for j in range(len(interfaces)):
        for t in range(d.shape[1]):
            opening[j, t] = law_gap(laws, interfaces[j], d[j, t])


def waits_for_compiler() -> bool:
    """Return whether the first laws that are called in this process are compiled first."""
    return _is_fast() and has_to_compile(along)


def _is_fast() -> bool:
    return IS_COMPILED and selected_backend() is not Backend.PYTHON


class LawsAlong:
    """The laws of some interfaces of a structure, called at many samples at once."""

    def __init__(self, structure: Structure, which: np.ndarray) -> None:
        self._laws = structure.laws
        interfaces = structure.interfaces[which].copy()
        interfaces.internal_state = np.cumsum(interfaces.states) - interfaces.states
        self._interfaces = interfaces.view(np.recarray)
        self.count = len(interfaces)
        self.states = int(interfaces.states.sum())
        self.owner = np.repeat(np.arange(self.count), interfaces.states)
        self.place = np.arange(self.states) - interfaces.internal_state[self.owner]
        self.starts = starts_of(interfaces)
        self.length = np.array([i.length for i in interfaces], float)
        self.has_wall = np.asarray(interfaces.has_wall == 1)
        self.levels = self._corner_levels()
        self.is_fast = is_fast = _is_fast()
        self._along = along if is_fast else interpreted(along)
        self._openings = _openings if is_fast else interpreted(_openings)

    def radius(self, j: int) -> float:
        """Of the journal at a wall [m]."""
        return float(self._part(j).journal_radius)

    def normal(self, j: int, r: float) -> float:
        """Force of a wall on a journal on a circle of this radius about its middle [N], inward."""
        d = np.zeros((1, 2 * self.count))
        d[0, 2 * j] = r
        force, _ = self.forces(d, 0 * d, np.tile(self.starts, (1, 1)), 0.0)
        return -float(force[0, 2 * j])

    def _part(self, j: int):
        interface = self._interfaces[j]
        return self._laws[interface.law][interface.row]

    def _corner_levels(self) -> tuple[np.ndarray, np.ndarray]:
        """Interfaces, and gaps of theirs at which a wall's force has a corner [m], shape (n,) each:
        where it begins, and where its damping is in full."""
        corners: list[tuple[int, float]] = []
        for j in np.flatnonzero(self.has_wall).tolist():
            part = self._part(j)
            corners += [(j, 0.0), (j, -part.delta_c)] if part.c > 0 else [(j, 0.0)]
        owners, levels = zip(*corners, strict=True) if corners else ((), ())
        return np.array(owners, int), np.array(levels, float)

    @property
    def records(self) -> tuple:
        """What kernels take of the laws: their tables, and the interfaces."""
        return self._laws, self._interfaces

    def openings(self, d: np.ndarray) -> np.ndarray:
        """Distances from where the forces begin [m], shape (n, m); d: x, y in turn, (n, 2 m)."""
        out = np.zeros((self.count, len(d)))
        self._openings(self._laws, self._interfaces, _complex(d), out)
        return out.T

    def forces(self, d: np.ndarray, v: np.ndarray, own: np.ndarray, speed: float) -> Forces:
        """Forces and rates; d, v: shape (n, 2 m) [m], [m/s]; own: shape (n, s)."""
        force, _, _, rates = self._call(d, v, own, speed)
        return Forces(_plane(force), rates)

    def tangents(
        self, d: np.ndarray, v: np.ndarray, own: np.ndarray, scale: np.ndarray, speed: float
    ) -> Along:
        """All of `Along`; d, v: shape (n, 2 m) [m], [m/s]; own: shape (n, s), with sizes
        `scale`."""
        force, p, q, rates = self._call(d, v, own, speed)
        m, s, n = self.count, self.states, len(d)
        both = np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])
        by_d, by_v = both.transpose(2, 4, 3, 0, 1)
        by_rate = np.zeros((n, 2 * m, s))
        rates_by = [np.zeros((n, s, 2 * m)), np.zeros((n, s, 2 * m)), np.zeros((n, s, s))]
        for place in range(int(self.place.max(initial=-1)) + 1):
            columns = np.flatnonzero(self.place == place)
            step = np.zeros(s)
            step[columns] = _STEP * scale[columns]
            of_force, of_rates = self._difference(d, v, own, speed, own_step=step)
            for c in columns:
                j = int(2 * self.owner[c])
                by_rate[:, j : j + 2, c] = of_force[:, j : j + 2] / (2 * step[c])
                rows = np.flatnonzero(self.owner == self.owner[c])
                rates_by[2][:, rows, c] = of_rates[:, rows] / (2 * step[c])
        for axis in range(2 if s else 0):
            # displacements on the scale of the interface, velocities on that of its motion
            pace = max(float(np.abs(v).max()) / max(float(np.abs(d).max()), 1e-300), 1.0)
            for i, size in enumerate((self.length, self.length * pace)):
                step = np.zeros(2 * m)
                step[axis::2] = _STEP * size
                pair = (step, 0 * step) if i == 0 else (0 * step, step)
                _, of_rates = self._difference(d, v, own, speed, *pair)
                for row in range(s):
                    j = int(2 * self.owner[row] + axis)
                    rates_by[i][:, row, j] = of_rates[:, row] / (2 * step[j])
        return Along(_plane(force), by_d, by_v, by_rate, rates, *rates_by)

    def _difference(self, d, v, own, speed, d_step=0.0, v_step=0.0, own_step=0.0):
        above = self.forces(d + d_step, v + v_step, own + own_step, speed)
        below = self.forces(d - d_step, v - v_step, own - own_step, speed)
        return above[0] - below[0], above[1] - below[1]

    def _call(self, d, v, own, speed):
        n, m = len(d), self.count
        force, rates = np.zeros((m, n), complex), np.zeros((n, self.states))
        p, q = np.zeros((2, m, n), complex), np.zeros((2, m, n), complex)
        states = np.ascontiguousarray(own, float)
        self._along(
            self._laws,
            self._interfaces,
            _complex(d),
            _complex(v),
            float(speed),
            states,
            states.copy(),
            force,
            p,
            q,
            rates,
        )
        return force, p, q, rates


def _complex(d: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray((d[:, ::2] + 1j * d[:, 1::2]).T)


def _plane(z: np.ndarray) -> np.ndarray:
    out = np.empty((z.shape[1], 2 * len(z)))
    out[:, ::2], out[:, 1::2] = z.T.real, z.T.imag
    return out
