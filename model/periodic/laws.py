"""The force laws along an orbit: forces, tangents, rates and gaps at its samples.

This is the only place from which the package calls the laws; the tangents are those of the kernels.
"""

import itertools
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .. import backend
from ..linear.real_matrices import in_plane
from ..parts import LAWS
from ..parts.law_probe import BY_D, BY_V
from ..step.laws_along_motion import Samples, block_of, call_laws, fill, find_gaps
from ..structure.structure import Structure, sizes_of_laws, starts_of
from . import entry_points

_BLOCKS = 4  # blocks, one for each number of samples that is asked for
_STEP = 1e-6  # of a central difference, as a share of the variable's scale


class Forces(NamedTuple):
    """Forces of m interfaces with s internal states at n samples, x and y in turn, shape (n, 2 m)
    [N], and rates of the states, shape (n, s)."""

    force: np.ndarray
    rates: np.ndarray


class ForcesAndTangents(NamedTuple):
    """Forces of m interfaces with s internal states at n samples, x and y in turn, shape (n, 2 m)
    [N]; their derivatives with respect to displacements and velocities, shape (n, m, 2, 2) each,
    and to the states, shape (n, 2 m, s); rates of the states, shape (n, s), with their derivatives
    with respect to displacements and velocities, shape (n, s, 2 m) each, and to the states, shape
    (n, s, s)."""

    force: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray
    by_states: np.ndarray
    rates: np.ndarray
    rates_by_d: np.ndarray
    rates_by_v: np.ndarray
    rates_by_states: np.ndarray


def waits_for_compiler() -> bool:
    """Return whether the laws must be compiled before their first call in this process."""
    return backend.waits_for_compiler(call_laws)


class _SampleBlock(NamedTuple):
    """A block for a number of samples: its arrays, and the functions that fill them."""

    samples: Samples
    call_laws: Callable[..., object]
    find_gaps: Callable[[], object]


class LawsAlongMotion:
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
        walls = [self._part(j) for j in range(self.count) if self.has_wall[j]]
        self._damped = [part for part in walls if part.c > 0]
        # of each corner of a force its interface
        owners = np.flatnonzero(self.has_wall)
        is_damped = np.array([part.c > 0 for part in walls], bool)
        self.corner_owner = np.concatenate([owners, owners[is_damped]])
        self._sampled: dict[int, _SampleBlock] = {}

    def journal_radius(self, j: int) -> float:
        """Return the radius of the journal in wall j [m]."""
        return float(self._part(j).journal_radius)

    def state_scales(self, frequency: float) -> np.ndarray:
        """Return sizes of the internal states in a motion as large as the length of each interface,
        at a frequency [rad/s], shape (s,)."""
        result = np.empty(self.states)
        for j in range(self.count):
            states = np.flatnonzero(self.owner == j)
            length = self.length[j]
            sizes = {"m": length, "m/s": length * frequency, "rad/s": frequency}
            units = LAWS[self._interfaces[j].law].state_units(self._part(j)) if len(states) else ()
            for state, unit in zip(states, itertools.cycle(units), strict=False):
                result[state] = sizes[unit]
        return result

    def wall_force(self, j: int, r: float) -> float:
        """Return the inward force of wall j on a journal on a circle of radius r about its centre
        [N]."""
        d = np.zeros((1, 2 * self.count))
        d[0, 2 * j] = r
        force, _ = self.forces(d, 0 * d, np.tile(self.starts, (1, 1)), 0.0)
        return -float(force[0, 2 * j])

    def _part(self, j: int):
        interface = self._interfaces[j]
        return self._laws[interface.law][interface.row]

    def block_of_steps(self, **sizes: int) -> tuple[np.ndarray, entry_points.OrbitData]:
        """Return a block for steps of three points, and its arrays."""
        sizes |= {"interfaces": self.count, "samples": 3, "states": self.states}
        block = entry_points.LAYOUT.new(sizes | sizes_of_laws(self._laws))
        run: entry_points.OrbitData = entry_points.LAYOUT.view_in_python(block)
        fill(run.machine, self._laws, self._interfaces)
        return block, run

    def _at(self, n: int) -> _SampleBlock:
        if n not in self._sampled:
            block, run = block_of(self._laws, self._interfaces, n)
            calls = (backend.bound(function, block) for function in (call_laws, find_gaps))
            while len(self._sampled) >= _BLOCKS:
                self._sampled.pop(next(iter(self._sampled)))
            self._sampled[n] = _SampleBlock(run.samples, *calls)
        return self._sampled[n]

    def gaps(self, d: np.ndarray) -> np.ndarray:
        """Return the distances from the onset of the forces [m], shape (n, m); d: x and y in turn,
        shape (n, 2 m)."""
        at = self._at(len(d))
        at.samples.d[...] = _complex(d)
        at.find_gaps()
        return at.samples.gap.T.copy()

    def corner_gaps(self, d: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return how far wall forces are from their corners [m], shape (n, corners); d, v: x and y
        in turn, shape (n, 2 m) [m], [m/s].

        The first corner of each wall is the onset of its force. The second is where its damping
        acts in full, or, where the journal leaves faster than the elastic force can push, where
        that is used up: the force ends while the gap is still closed.
        """
        gap = self.gaps(d)
        result = gap[:, self.corner_owner]
        if not self._damped:
            return result
        owners = self.corner_owner[-len(self._damped) :]
        moved = _STEP * self.length / np.maximum(np.abs(v[:, ::2] + 1j * v[:, 1::2]).max(0), 1e-300)
        way = np.repeat(moved, 2) * v
        rate = (self.gaps(d - way) - self.gaps(d + way)) / (2 * moved)
        for i, (j, part) in enumerate(zip(owners, self._damped, strict=True), -len(owners)):
            delta = -gap[:, j]
            slope = part.k * np.maximum(delta, part.delta_c) ** (part.exponent - 1.0)
            left = delta + part.c * rate[:, j] / slope
            result[:, i] = -np.minimum(delta - part.delta_c, left)
        return result

    def forces(self, d: np.ndarray, v: np.ndarray, states: np.ndarray, speed: float) -> Forces:
        """Return forces and rates; d, v: shape (n, 2 m) [m], [m/s]; states: shape (n, s)."""
        force, _, rates = self._call(d, v, states, speed)
        return Forces(force, rates)

    def tangents(
        self, d: np.ndarray, v: np.ndarray, states: np.ndarray, scale: np.ndarray, speed: float
    ) -> ForcesAndTangents:
        """Return forces, rates and all their tangents; d, v: shape (n, 2 m) [m], [m/s]; states:
        shape (n, s), of sizes `scale`."""
        force, by_v, rates = self._call(d, v, states, speed, BY_V)
        force, by_d, _ = self._call(d, v, states, speed)
        m, s, n = self.count, self.states, len(d)
        by_states = np.zeros((n, 2 * m, s))
        rates_by = [np.zeros((n, s, 2 * m)), np.zeros((n, s, 2 * m)), np.zeros((n, s, s))]
        for place in range(int(self.place.max(initial=-1)) + 1):
            columns = np.flatnonzero(self.place == place)
            step = np.zeros(s)
            step[columns] = _STEP * scale[columns]
            of_force, of_rates = self._difference(d, v, states, speed, state_step=step)
            for c in columns:
                j = int(2 * self.owner[c])
                by_states[:, j : j + 2, c] = of_force[:, j : j + 2] / (2 * step[c])
                rows = np.flatnonzero(self.owner == self.owner[c])
                rates_by[2][:, rows, c] = of_rates[:, rows] / (2 * step[c])
        for axis in range(2 if s else 0):
            # displacements on the scale of the interface, velocities on that of its motion
            frequency = max(float(np.abs(v).max()) / max(float(np.abs(d).max()), 1e-300), 1.0)
            for i, size in enumerate((self.length, self.length * frequency)):
                step = np.zeros(2 * m)
                step[axis::2] = _STEP * size
                pair = (step, 0 * step) if i == 0 else (0 * step, step)
                _, of_rates = self._difference(d, v, states, speed, *pair)
                for row in range(s):
                    j = int(2 * self.owner[row] + axis)
                    rates_by[i][:, row, j] = of_rates[:, row] / (2 * step[j])
        return ForcesAndTangents(force, by_d, by_v, by_states, rates, *rates_by)

    def _difference(self, d, v, states, speed, d_step=0.0, v_step=0.0, state_step=0.0):
        above = self.forces(d + d_step, v + v_step, states + state_step, speed)
        below = self.forces(d - d_step, v - v_step, states - state_step, speed)
        return above[0] - below[0], above[1] - below[1]

    def _call(self, d, v, states, speed, weights=BY_D):
        at = self._at(len(d))
        samples = at.samples
        samples.d[...], samples.v[...] = _complex(d), _complex(v)
        samples.states[...] = samples.solved[...] = states
        at.call_laws(*weights, float(speed))
        p, q = samples.p[0], samples.q[0]
        tangent = np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])
        return in_plane(samples.force.T), tangent.transpose(3, 2, 0, 1), samples.rates.copy()


def _complex(d: np.ndarray) -> np.ndarray:
    return (d[:, ::2] + 1j * d[:, 1::2]).T
