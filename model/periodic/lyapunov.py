"""The largest Lyapunov exponent of a motion in time: the mean rate at which neighbouring motions
diverge.

The machine linearized along the motion, by the laws' tangents, propagates a difference from turn to
turn, as along an orbit (`floquet`). The exponent is the mean of the growth per turn, weighted by

    w(s) = exp(-1 / (s (1 - s))),    0 < s < 1

which suppresses the transient at the start and converges faster than a plain mean where the motion
is regular (Das, Saiki, Sander, Yorke 2017). The difference begins as that which grows most in the
first turns: where the motion repeats itself within them it grows alike from then on, though it
turns as it grows, as that of a complex multiplier does, and others that decay more slowly than few
turns last show nothing.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..linear.real_matrices import in_plane
from ..machine.rotor import Rotor
from ..one_thread import on_one_thread
from ..simulation import Simulation
from .floquet import (
    Frequencies,
    MotionPath,
    modes_along,
    state_scales_along,
    tangents_along,
    transition_matrix,
)
from .force_corners import hermite
from .linear_structure import CondensedMachine
from .problem import check_parts

LEAST_TURNS = 4
_REPEATS = 12  # turns after which motions of 2, 3, 4 or 6 turns repeat themselves
_RESOLVED = 8.0  # samples a period of the fastest motion that is looked at


class InterfaceSamples(NamedTuple):
    """Motion of all m interfaces with s internal states at n instants: t [s], shape (n,); complex
    relative displacements d [m] and velocities v [m/s], shape (n, m); internal states, shape (n,
    s)."""

    t: np.ndarray
    d: np.ndarray
    v: np.ndarray
    states: np.ndarray


def sample(run: Simulation) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Return the motion of a run's interfaces at the present time: a row of `InterfaceSamples`."""
    # plain: a field of a record array takes longer than all else here
    motion, interfaces = run.motion, np.asarray(run.structure.interfaces)
    node, housing = interfaces["dof"], interfaces["end"]
    d, v = (z[node] - z[housing] for z in (motion.q, motion.v))
    return run.time, d, v, motion.internal_state.copy()


@on_one_thread
def largest_exponent(rotor: Rotor, samples: InterfaceSamples, speed: float, per_turn: int) -> float:
    """Return the largest Lyapunov exponent [1/s] of a motion at a constant speed [rad/s], sampled
    at equal intervals, `per_turn` times a turn, over whole turns.

    Raises `ValueError` for fewer than `LEAST_TURNS` turns, and `PeriodicError` for a machine with
    parts that have no tangents.
    """
    turns = (len(samples.t) - 1) // per_turn
    if turns < LEAST_TURNS:
        raise ValueError(f"turns = {turns}: must be >= {LEAST_TURNS}")
    check_parts(rotor)
    machine = CondensedMachine(rotor)
    path = _path(machine, samples, speed)
    cuts = [samples.t[k * per_turn : (k + 1) * per_turn + 1] for k in range(turns)]
    parts = tangents_along(machine, path, cuts)
    modes, mean = modes_along(machine, path, parts)
    first = [transition_matrix(modes, mean, part) for part in parts[:_REPEATS]]
    state = _leading(first)
    growth = np.empty(turns)
    for k, part in enumerate(parts):
        turn = first[k] if k < len(first) else transition_matrix(modes, mean, part)
        state = turn @ state
        size = float(np.linalg.norm(state))
        growth[k] = np.log(size) / part.h.sum()
        state /= size
    s = (np.arange(turns) + 0.5) / turns
    return float(np.average(growth, weights=np.exp(-1.0 / (s * (1.0 - s)))))


def _leading(turns: Sequence[np.ndarray]) -> np.ndarray:
    """Return what grows most, or decays least, over turns as a whole, of norm 1."""
    product = np.eye(len(turns[0]), dtype=complex)
    for turn in turns:
        product = turn @ product
        product /= np.linalg.norm(product)
    values, vectors = np.linalg.eig(product)
    result: np.ndarray = vectors[:, np.argmax(np.abs(values))]
    return result


def _path(machine: CondensedMachine, samples: InterfaceSamples, speed: float) -> MotionPath:
    """Return the path through the samples: displacements by cubic Hermite interpolation, internal
    states by linear interpolation."""
    t, step = samples.t, samples.t[1] - samples.t[0]
    places = machine.state_places
    d, v = (in_plane(z[:, machine.is_nonlinear]) for z in (samples.d, samples.v))
    states = samples.states[:, places]

    def at(times: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        i = np.clip(np.searchsorted(t, times, "right") - 1, 0, len(t) - 2)
        h = (t[i + 1] - t[i])[:, None]
        x = ((times - t[i])[:, None]) / h
        where, slope = hermite(d[i], d[i + 1], h * v[i], h * v[i + 1])(x)
        return where, slope / h, states[i] + x * (states[i + 1] - states[i])

    state_scale = state_scales_along(machine, states, abs(speed))
    highest = 2 * np.pi / (_RESOLVED * step)
    return MotionPath(at, Frequencies(speed, abs(speed), max(highest, abs(speed))), state_scale)
