"""Campbell diagram: the modes over the speed, each followed by its shape; critical speeds; the
speed at which the machine loses its stability."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from ..arguments import numbers
from ..machine.rotor import Rotor
from .amplification import CRITICALLY_DAMPED
from .following import Following
from .linear_machine import LinearError, LinearMachine, shared_machine
from .modes import (
    DEFAULT_COUNT,
    LEAST_GROWTH,
    Modes,
    Spectrum,
    check_count,
    machine_modes,
    modes_of,
    modes_up_to,
)

_MORE = 6  # modes looked at beyond those asked for, since they change places
_UNLIKE = 0.3  # shapes less alike than this are not of the same mode
_OF_ITSELF = 0.01  # weight of a shape's own likeness beside that of the space it is any one of
_PRECISION = 1e-12  # of a speed at which a mode meets a harmonic
_MET = 1e-6  # of a harmonic: a frequency further from it has jumped past, to another mode's
_LOST = complex(np.nan, np.nan)  # a frequency of 0 would be one


@dataclass(frozen=True)
class CriticalSpeed:
    """Where the frequency of a mode that answers with a peak, damping ratio below 1 / sqrt(2), is
    `harmonic` times the speed [rad/s]; mode: its place in the diagram, from 0; whirl: `forward`,
    `backward`, `planar` or `mixed`; log_dec: its logarithmic decrement there [1]; where
    `harmonic` is 1 the shaft's hysteresis is the mean of that of slower and of faster whirls."""

    mode: int
    speed: float
    whirl: str
    log_dec: float
    harmonic: float = 1.0

    @property
    def is_critically_damped(self) -> bool:
        """Whether its amplification factor is below 2.5, so that API 684 asks nothing of it."""
        return self.log_dec >= CRITICALLY_DAMPED


@dataclass(frozen=True)
class Campbell(Spectrum):
    """Modes over s speeds [rad/s], each followed by its shape; m modes, first those of the first
    speed in their order, then those that are among the lowest ones only at a higher speed. Where a
    mode is so damped that it does not oscillate it is NaN; it goes on where it does again.

    eigenvalues: complex of shape (s, m) [1/s]; whirl: s times m words; harmonics: multiples of the
    speed that excite; critical: where a mode meets it, by ascending speed; threshold: slowest speed
    above which some mode grows, with pads that tilt following each at its own frequency [rad/s],
    None where none does; turns: speeds at which the machine becomes unstable or stable again, from
    the slowest on [rad/s]; contacts: `open` or `pinned`.
    """

    speeds: np.ndarray
    contacts: str
    eigenvalues: np.ndarray
    whirl: tuple[tuple[str, ...], ...]
    harmonics: tuple[float, ...]
    critical: tuple[CriticalSpeed, ...]
    threshold: float | None
    turns: tuple[float, ...]


def campbell(
    rotor: Rotor,
    speeds: Sequence[float] | np.ndarray,
    *,
    count: int = DEFAULT_COUNT,
    contacts: str | None = None,
    harmonic: float | Sequence[float] = 1.0,
) -> Campbell:
    """Return the Campbell diagram of the modes that are among the `count` lowest at any of
    ascending speeds [rad/s], at least 2.

    harmonic: multiple of the speed that excites, for critical speeds, or several; contacts: `open`
    or `pinned`; None: open where the machine is held without them. Raises `LinearError`.
    """
    at = np.array(numbers("speeds", speeds))
    check_count(count)
    if len(at) < 2 or not (np.diff(at) > 0).all():
        raise LinearError("speeds: must be at least 2, ascending")
    harmonics = tuple(numbers("harmonic", harmonic if np.ndim(harmonic) else [harmonic]))
    if not harmonics:
        raise LinearError("harmonic = []: at least one must be given")
    for order in harmonics:
        if not (np.isfinite(order) and order > 0):
            raise LinearError(f"harmonic = {order:g}: must be > 0")
    follow = _Follower(shared_machine(rotor, contacts), count + _MORE)
    seen, places = _lines(follow, at, count)
    critical = [
        result
        for order in harmonics
        for i in range(len(at) - 1)
        for result in _critical(follow, seen[i : i + 2], places[i : i + 2], order)
    ]
    followed = list(zip(seen, places, strict=True))
    threshold, turns = _threshold(follow, seen)
    values = [[m.eigenvalues[p] if p >= 0 else _LOST for p in of] for m, of in followed]
    return Campbell(
        speeds=at,
        contacts=seen[0].contacts,
        eigenvalues=np.array(values),
        whirl=tuple(
            tuple(words[p] if p >= 0 else "" for p in of)
            for words, of in ((m.whirl, of) for m, of in followed)
        ),
        harmonics=harmonics,
        critical=tuple(sorted(critical, key=lambda c: c.speed)),
        threshold=threshold,
        turns=turns,
    )


class _Follower:
    """Follows modes of a machine from speed to speed by their shapes."""

    def __init__(self, machine: LinearMachine, count: int) -> None:
        self._machine, self._count = machine, count
        self._at = cache(lambda speed: machine_modes(machine, speed, count))
        mass, _, _ = machine.rotor_matrices()
        # of every dof but ground's; those that a pin makes one unknown share its mass
        moving = (machine.expand / machine.expand.sum(axis=0)).tocsr()[:-2]
        self._mass = (moving @ mass @ moving.T).tocsr()
        self.onward = Following(
            lambda modes: modes.damped,
            self.likeness,
            lambda a, b: self.at((a.speed + b.speed) / 2),
            _UNLIKE,
        ).onward

    def at(self, speed: float) -> Modes:
        return self._at(float(speed))

    def growth(self, modes: Modes) -> float:
        """Return the largest share of growth at a speed (`Modes.growth`) that is more than
        rounding, negative where nothing grows [1], of all modes up to the speed; pads that tilt
        follow each whirl."""
        tilt = modes.speed != 0.0 and bool(self._machine.laws.follows.any())
        top = abs(modes.speed)
        if tilt or modes.natural.max(initial=0.0) < top:
            linear = self._machine.at(modes.speed)
            own = modes_up_to(self._machine, linear, top, self._count, pads_whirl=tilt)
            modes = replace(own, decays=modes.decays)
        return modes.growth - LEAST_GROWTH

    def with_rotation(self, modes: Modes, place: int) -> tuple[Modes, int]:
        """Return the modes with the shaft's hysteresis as it is in the one at a place, which turns
        with the rotation, and the place of that one."""
        linear = self._machine.at(modes.speed)
        if linear.strain.kappa_h == 0.0:
            return modes, place
        turning = linear._replace(strain=linear.strain.with_rotation)
        result = modes_of(self._machine, turning, self._count)
        return result, int(self.likeness(modes, result)[place].argmax())

    def likeness(self, a: Modes, b: Modes) -> np.ndarray:
        """Return the modal assurance criterion, weighted by mass, of all shapes of a with all of b;
        of modes that share an eigenvalue, whose shapes may be any of a space, of the space. Among
        those the criterion itself, with a small weight, decides."""
        one, other = self._unit(a), self._unit(b)
        alike = np.abs(one.conj().T @ (self._mass @ other)) ** 2
        within = np.maximum(self._within(one, other, b), self._within(other, one, a).T)
        return np.where(within > alike, (1 - _OF_ITSELF) * within + _OF_ITSELF * alike, alike)

    def _unit(self, modes: Modes) -> np.ndarray:
        """Return the shapes by all dofs and housings, of a modal mass of 1, shape (dofs, m)."""
        of_nodes = np.stack([modes.x, modes.y, modes.slope_x, modes.slope_y], -1)
        of_housings = np.stack([modes.housing_x, modes.housing_y], -1)
        count = len(modes.eigenvalues)
        result = np.hstack([part.reshape(count, -1) for part in (of_nodes, of_housings)]).T
        return result / np.sqrt(np.sum(result.conj() * (self._mass @ result), axis=0).real)

    def _within(self, shapes: np.ndarray, of: np.ndarray, modes: Modes) -> np.ndarray:
        """Return how much of shapes lies in the space of each mode's eigenvalue, where others share
        it; else 0. Shape (shapes, modes)."""
        result = np.zeros((shapes.shape[1], of.shape[1]))
        for mode, same in enumerate(modes.sharing):
            if same.sum() > 1:
                onto = self._mass @ of[:, same]
                along = shapes.conj().T @ onto
                part = along @ np.linalg.pinv(of[:, same].conj().T @ onto, hermitian=True)
                result[:, mode] = np.sum(part * along.conj(), axis=1).real
        return result


def _lines(follow: _Follower, at: np.ndarray, count: int) -> tuple[list[Modes], np.ndarray]:
    """Return the modes at each speed, and the places in them of each line, shape (speeds, lines),
    -1 where it is not there."""
    seen: list[Modes] = []
    places = np.full((len(at), 0), -1)
    for i, speed in enumerate(at):
        seen.append(follow.at(speed))
        if i > 0:
            onward = follow.onward(seen[i - 1], seen[i], places[i - 1])
            places[i] = _found_again(follow, seen, places[:i], onward)
        lowest = np.arange(min(count, len(seen[i].eigenvalues)))
        lowest = lowest[seen[i].is_sound[lowest]]
        begun = np.setdiff1d(lowest, places[i])
        if len(begun):
            places = _with_begun(follow, seen, places, begun)
    return seen, places


def _with_begun(
    follow: _Follower, seen: Sequence[Modes], places: np.ndarray, begun: np.ndarray
) -> np.ndarray:
    """Return the places with those of lines that are new in the last of `seen`, followed backward
    to where they were above the lowest modes before, or did not oscillate."""
    last, known = len(seen) - 1, places.shape[1]
    result = np.hstack([places, np.full((len(places), len(begun)), -1)])
    result[last, known:] = begun
    for i in range(last - 1, -1, -1):
        back = follow.onward(seen[i + 1], seen[i], result[i + 1])[known:]
        result[i, known:] = np.where(np.isin(back, result[i, :known]), -1, back)
        there = follow.onward(seen[i], seen[i + 1], result[i])[known:]
        result[i, known:][there != result[i + 1, known:]] = -1
        if (result[i, known:] < 0).all():
            break
    return result


def _found_again(
    follow: _Follower, seen: Sequence[Modes], places: np.ndarray, onward: np.ndarray
) -> np.ndarray:
    """Return the places in the last of `seen` with those of modes that did not oscillate for a
    while: the free shape most like the one that such a mode had, once it is there again."""
    result = onward.copy()
    last = seen[-1]
    for mode in np.flatnonzero(onward < 0):
        before = max(i for i, of in enumerate(places) if of[mode] >= 0)
        alike = follow.likeness(seen[before], last)[places[before][mode]]
        alike[result[result >= 0]] = 0.0
        if alike.max(initial=0.0) > _UNLIKE:
            result[mode] = int(np.argmax(alike))
    return result


def _critical(
    follow: _Follower, seen: Sequence[Modes], places: np.ndarray, harmonic: float
) -> list[CriticalSpeed]:
    """Return the critical speeds between two speeds of the diagram."""
    a, b = seen
    if a.speed < 0.0 < b.speed:  # the harmonic of |speed| turns round at rest
        rest = follow.at(0.0)
        lines = follow.onward(a, rest, places[0])
        return [
            *_critical(follow, (a, rest), np.array([places[0], lines]), harmonic),
            *_critical(follow, (rest, b), np.array([lines, places[1]]), harmonic),
        ]
    result = []
    # a line that was found again did not oscillate in between
    is_onward = follow.onward(a, b, places[0]) == places[1]
    for mode in np.flatnonzero((places[0] >= 0) & (places[1] >= 0) & is_onward):
        before = _excess(a, places[0][mode], harmonic)
        after = _excess(b, places[1][mode], harmonic)
        if before != 0.0 and before * after <= 0:
            there, at = _meeting(follow, a, places[0], int(mode), b.speed, harmonic)
            if at >= 0 and harmonic == 1.0:
                there, at = follow.with_rotation(there, at)
            if at >= 0 and there.has_peak[at]:
                log_dec = float(there.log_dec[at])
                whirl = there.whirl[at]
                result.append(CriticalSpeed(int(mode), there.speed, whirl, log_dec, harmonic))
    return result


def _excess(modes: Modes, place: int, harmonic: float) -> float:
    """Return the excess of a mode's frequency over the harmonic [rad/s]."""
    return float(modes.damped[place]) - harmonic * abs(modes.speed)


def _meeting(
    follow: _Follower, a: Modes, places: np.ndarray, mode: int, end: float, harmonic: float
) -> tuple[Modes, int]:
    """Return the modes where that with the place places[mode] in `a` has its frequency in the
    harmonic, before the speed `end`, and its place there, -1 where it jumps past."""
    followed = [(a, places)]

    def seen_at(speed: float) -> tuple[Modes, int]:
        """From the nearest speed at which the mode is known: there the shapes are most alike."""
        near, lines = min(followed, key=lambda seen: abs(seen[0].speed - speed))
        there = follow.at(speed)
        onward = follow.onward(near, there, lines)
        if onward[mode] >= 0:
            followed.append((there, onward))
        return there, int(onward[mode])

    def excess(speed: float) -> float:
        there, at = seen_at(speed)
        return _excess(there, at, harmonic) if at >= 0 else before

    before = _excess(a, places[mode], harmonic)
    precision = _PRECISION * max(abs(a.speed), abs(end))
    there, at = seen_at(brentq(excess, a.speed, end, xtol=precision, rtol=1e-13))
    is_met = at >= 0 and abs(_excess(there, at, harmonic)) <= _MET * harmonic * abs(there.speed)
    return there, at if is_met else -1


def _threshold(follow: _Follower, seen: Sequence[Modes]) -> tuple[float | None, tuple[float, ...]]:
    """Return the slowest speed at which some mode grows [rad/s], and where this changes with the
    speed; of speeds of either sense of rotation those above 0."""
    ahead = [m for m in seen if m.speed >= 0.0]
    outward = ahead if len(ahead) > 1 else seen[::-1]
    grow = [follow.growth(m) > 0.0 for m in outward]
    turns = tuple(
        brentq(lambda s: follow.growth(follow.at(s)), a.speed, b.speed, rtol=1e-12)
        for (a, before), (b, behind) in pairwise(zip(outward, grow, strict=True))
        if before != behind
    )
    return float(outward[0].speed) if grow[0] else next(iter(turns), None), turns
