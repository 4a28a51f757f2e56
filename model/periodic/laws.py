"""The force laws along an orbit: forces, tangents, rates and gaps at its samples.

This is the only place from which the package calls the laws; the tangents are those of the kernels.
"""

import itertools
from collections.abc import Callable
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from .. import backend
from ..contact.wall import ContactQuantities
from ..laws_at_rest.tangents import matrices
from ..linear.real_matrices import in_plane
from ..parts import LAWS
from ..parts.law import BY_D, never_breaks
from ..step.laws_along_motion import (
    Samples,
    block_of,
    call_laws,
    fill,
    find_gaps,
    find_invalid,
    linearize_laws,
    vibrate_laws,
)
from ..structure.structure import Structure, sizes_of_laws, starts_of
from . import entry_points

_CALLED = call_laws, linearize_laws, find_gaps, find_invalid, vibrate_laws
_BLOCKS = 16  # that are kept, one for each number of samples lately asked for: corners add some
_TURNED = 1e-5  # about the middle of a wall, for how its clearance rises there [rad]
# of a central difference, as a share of the variable's scale: the friction of a race that rolls at
# hundreds of revolutions a second turns within some 1e-5 of its speed
_DIFFERENCE = 1e-7
_LEAST_STEP = 1e-9  # of one beside a corner


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
    return backend.waits_for_compiler(linearize_laws)


class _SampleBlock(NamedTuple):
    """A block for a number of samples: its arrays, and the functions that fill them."""

    samples: Samples
    call_laws: Callable[..., object]
    linearize_laws: Callable[[float], object]
    find_gaps: Callable[[], object]
    find_invalid: Callable[[], object]
    vibrate_laws: Callable[[float, float, float], object]


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
        walls: list[int] = np.flatnonzero(interfaces.has_wall).tolist()
        # a law of another kind may have a wall too, with quantities of its own
        self.rubbing = [
            j for j in walls if issubclass(LAWS[interfaces.law[j]].kind, ContactQuantities)
        ]
        self._walls = np.array(walls, int)
        self._damped = np.array([j for j in self.rubbing if self._part(j).c > 0], int)
        each = ((p.k, p.c, p.delta_c, p.exponent) for p in map(self._part, self._damped))
        self._damping = np.array([*each], float).reshape(-1, 4).T
        # walls whose force has a tangent like a root: at its onset it rises without bound
        self.is_root_like = np.array(
            [j in self.rubbing and self._part(j).exponent > 1.0 for j in range(self.count)], bool
        )
        # of each corner of a force its interface
        self.corner_owner = np.append(self._walls, self._damped)
        self._at = lru_cache(_BLOCKS)(self._block_of)
        # of these, such as pads that tilt, force, rates and all derivatives are solved for at once
        self.has_moving_films = any(i.states and LAWS[i.law].linearize for i in interfaces)
        # laws of whose states differences are taken, each by itself
        self._alone = {
            j: self if self.count == 1 else LawsAlongMotion(structure, index)
            for j, index in enumerate(np.arange(len(structure.interfaces))[which, None])
            if interfaces.states[j] and LAWS[interfaces.law[j]].linearize is None
        }

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

    @property
    def has_damping(self) -> bool:
        """Whether corners of the forces depend on velocities."""
        return len(self._damped) > 0

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

    def _block_of(self, n: int) -> _SampleBlock:
        block, run = block_of(self._laws, self._interfaces, n)
        return _SampleBlock(run.samples, *(backend.bound(each, block) for each in _CALLED))

    def gaps(self, d: np.ndarray) -> np.ndarray:
        """Return the distances from the onset of the forces [m], shape (n, m); d: x and y in turn,
        shape (n, 2 m)."""
        at = self._at(len(d))
        at.samples.d[...] = _complex(d)
        at.find_gaps()
        return at.samples.gap.T.copy()

    @property
    def may_break(self) -> bool:
        """Whether there is a law that may be invalid, such as of an oil film."""
        return any(LAWS[i.law].breaks is not never_breaks for i in self._interfaces)

    def are_invalid(self, d: np.ndarray, states: np.ndarray) -> np.ndarray:
        """Return whether the laws are invalid, such as of an oil film thinner than its roughness,
        shape (n, m); d: x and y in turn, shape (n, 2 m) [m]; states: shape (n, s)."""
        at = self._at(len(d))
        at.samples.d[...], at.samples.states[...] = _complex(d), states
        at.find_invalid()
        return at.samples.is_invalid.T.copy()

    def at_rest(self, d: np.ndarray, speed: float) -> tuple[np.ndarray, ...]:
        """Return forces at rest, shape (n, 2 m) [N], their derivatives with respect to d, shape
        (n, m, 2, 2), and the states, shape (n, s): of films' pads and rings in equilibrium, of
        other laws those at their start; d: x and y in turn, shape (n, 2 m) [m]."""
        at = self._filled(d, 0.0 * d, np.tile(self.starts, (len(d), 1)))
        at.vibrate_laws(speed, speed, 0.0)
        of_films = [LAWS[self._interfaces[j].law].linearize is not None for j in self.owner]
        states = np.where(of_films, at.samples.solved, self.starts)
        by_d, _ = matrices(at.samples.p, at.samples.q).swapaxes(1, 2)
        return in_plane(at.samples.force.T), by_d, states

    def corner_gaps(self, d: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Return how far wall forces are from their corners [m], shape (n, corners); d, v: x and y
        in turn, shape (n, 2 m) [m], [m/s].

        The first corner of each wall is the onset of its force. The second is where its damping
        acts in full, or, where the journal leaves faster than the elastic force can push, where
        that is used up: the force ends while the gap is still closed.
        """
        if not self.has_damping:
            return self.gaps(d)[:, self._walls]
        z, w = (of[:, ::2] + 1j * of[:, 1::2] for of in (d, v))
        # of a wall that is no circle the clearance changes as the journal moves along it
        turned = np.exp(1j * _TURNED * np.array([0.0, 1.0, -1.0]))
        gap, ahead, behind = self.gaps(in_plane(np.concatenate(turned[:, None, None] * z))).reshape(
            3, len(d), self.count
        )
        velocity = w * np.exp(-1j * np.angle(z))
        rises = (ahead - behind) / (2.0 * _TURNED * np.maximum(np.abs(z), 1e-300))
        rate = (velocity.real - rises * velocity.imag)[:, self._damped]
        delta, (k, c, delta_c, exponent) = -gap[:, self._damped], self._damping
        slope = k * np.maximum(delta, delta_c) ** (exponent - 1.0)
        ends = np.minimum(delta - delta_c, delta + c * rate / slope)
        return np.hstack([gap[:, self._walls], -ends])

    def forces(self, d: np.ndarray, v: np.ndarray, states: np.ndarray, speed: float) -> Forces:
        """Return forces and rates; d, v: shape (n, 2 m) [m], [m/s]; states: shape (n, s)."""
        at = self._filled(d, v, states)
        if self.has_moving_films:
            at.linearize_laws(float(speed))
        else:
            at.call_laws(*BY_D, float(speed))
        return Forces(in_plane(at.samples.force.T), at.samples.rates.copy())

    def tangents(
        self, d: np.ndarray, v: np.ndarray, states: np.ndarray, scale: np.ndarray, speed: float
    ) -> ForcesAndTangents:
        """Return forces, rates and all their tangents; d, v: shape (n, 2 m) [m], [m/s]; states:
        shape (n, s), of sizes `scale`."""
        at = self._filled(d, v, states)
        at.linearize_laws(float(speed))
        m, s, n, samples = self.count, self.states, len(d), at.samples
        by_d, by_v = matrices(samples.p, samples.q).swapaxes(1, 2)
        result = ForcesAndTangents(
            in_plane(samples.force.T),
            by_d,
            by_v,
            np.zeros((n, 2 * m, s)),
            samples.rates.copy(),
            *(np.zeros((n, s, 2 * m)), np.zeros((n, s, 2 * m))),
            np.zeros((n, s, s)),
        )
        # displacements on the scale of the interface, velocities on that of its motion
        moved, fast = (float(np.abs(u).max(initial=0.0)) for u in (d, v))
        frequency = fast / max(moved, 1e-300) or abs(speed)
        for j in map(int, np.flatnonzero(self._interfaces.states)):
            ends, first = slice(2 * j, 2 * j + 2), self._interfaces[j].internal_state
            own = slice(first, first + self._interfaces[j].states)
            if j in self._alone:
                motion = np.hstack([d[:, ends], v[:, ends], states[:, own]])
                of_force, *of_rates = self._alone[j].differences(
                    motion, frequency, scale[own], speed
                )
            else:
                of_force = _parts(samples.force_by_states[:, own]).transpose(0, 2, 1)
                of_rates = [_parts(by[:, own]) for by in (samples.rates_by_d, samples.rates_by_v)]
                of_rates.append(samples.rates_by_states[:, own, own])
            result.by_states[:, ends, own] = of_force
            result.rates_by_d[:, own, ends], result.rates_by_v[:, own, ends] = of_rates[:2]
            result.rates_by_states[:, own, own] = of_rates[2]
        return result

    def differences(
        self, motion: np.ndarray, frequency: float, scale: np.ndarray, speed: float
    ) -> tuple[np.ndarray, ...]:
        """Return the derivatives of a single law's force by its s states, of sizes `scale`, shape
        (n, 2, s), and of their rates by displacement, velocity and states, from central
        differences; motion: these three, shape (n, 4 + s), of a frequency [rad/s]."""
        length, force, rates = self.length[0], [], []
        steps = _DIFFERENCE * np.tile([1.0, 1.0, frequency, frequency], (len(motion), 1)) * length
        steps = np.hstack([steps, _DIFFERENCE * np.tile(scale, (len(motion), 1))])
        # not across the corner in which a contact begins
        apart = 0.5 * np.abs(self.gaps(motion[:, :2]))
        steps[:, :2] = np.clip(apart, _LEAST_STEP * length, steps[:, :2])
        for i in range(motion.shape[1]):
            step = np.where(np.arange(motion.shape[1]) == i, steps, 0.0)
            above, below = (
                self.forces(x[:, :2], x[:, 2:4], x[:, 4:], speed)
                for x in (motion + step, motion - step)
            )
            twice = 2 * steps[:, i, None]
            force.append((above.force - below.force) / twice)
            rates.append((above.rates - below.rates) / twice)
        by_d, by_v, by_states = np.split(np.stack(rates, axis=-1), [2, 4], axis=-1)
        return np.stack(force[4:], axis=-1), by_d, by_v, by_states

    def _filled(self, d: np.ndarray, v: np.ndarray, states: np.ndarray) -> _SampleBlock:
        """Return the block of a motion, which it holds."""
        at = self._at(len(d))
        at.samples.d[...], at.samples.v[...] = _complex(d), _complex(v)
        at.samples.states[...] = at.samples.solved[...] = states
        return at


def _parts(z: np.ndarray) -> np.ndarray:
    """Return real and imaginary parts, along a last axis more."""
    return np.stack([z.real, z.imag], axis=-1)


def _complex(d: np.ndarray) -> np.ndarray:
    return (d[:, ::2] + 1j * d[:, 1::2]).T
