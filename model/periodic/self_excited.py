"""Starting points of self-excited whirl: backward rolling along a wall, and unstable modes of the
rest position.

A journal of radius R that rolls without sliding whirls backward with omega = R |Omega| / r on a
circle of radius r; of such circles along one wall, those are tried that the linear part nearly
balances. Past a threshold, of oil films or of rotating damping, a mode about the rest position
grows: whirls of several sizes in this mode are tried, a circle about the centre that nearly fills
the clearance, and a small whirl where the mode begins to grow.
"""

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from ..linear.modes import LEAST_GROWTH
from . import newton
from .balance import HarmonicBalance, Orbit
from .floquet import Frequencies, modal_basis, tangents_by_y
from .newton import Equations, NotConverged

_RADII = 1.0 + np.geomspace(1e-3, 1e7, 150)  # in clearances
_MOST_GUESSES = 8
_ROLLING = 1e-6  # precision of the radius at which a rolling whirl's radial forces are balanced
_LOWERED = (0.0, 0.1, 0.3, 0.6, 0.9)  # in clearances, where rest is looked for
_CLEAR = 0.2  # clearances, that a motion may come nearer to pads that bear nothing
_IDLE = 1e-9  # of the largest force by a state: one of a pad that bears nothing
_EDGE = 1e-6  # of a state's size: as near to where a pad just bears nothing is rounding
_SIZES = (0.7, 0.5, 0.9, 0.3, 0.1)  # of whirls, in clearances
# Sizes of a circle in clearances: a film pushes back strongly there, a wall not yet. From either of
# them Newton's method may go astray, by its last digits.
_CIRCLES = 0.98, 1.0
_LOOKED_AT = 33  # values in a range, for where modes about rest begin to grow
_PRECISION = 1e-12  # of a range, of where one does


class _RestEquations(Equations):
    """The equations of a machine at rest, without its unbalance, in the mean displacements of the
    interfaces and the laws' internal states."""

    def __init__(self, problem: HarmonicBalance, value: float) -> None:
        self.machine, self.speed = problem.machine_at(value), problem.speed_at(value)
        self.scale = np.append(np.full(problem.b, problem.length_scale), problem.state_scale)
        self.b, self._own_scale = problem.b, problem.state_scale
        parts = self.machine.dynamic_stiffness(self.speed, self.speed, 0, 0)
        self.S, self.force = parts.S[0].real, parts.force[0].real
        sizes = np.maximum(np.abs(self.S).max(axis=1, initial=0.0), 1e-300) * problem.length_scale
        self.sizes = np.append(sizes, problem.state_scale * abs(self.speed))

    def tangents(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return forces and rates, and their derivatives with respect to displacements, velocities
        and states."""
        y = x * self.scale
        d = (self.machine.B @ y[: self.b])[None]
        laws = self.machine.laws.tangents(d, 0 * d, y[None, self.b :], self._own_scale, self.speed)
        forces = np.append(laws.force[0] @ self.machine.B, laws.rates[0])
        return forces, tangents_by_y(self.machine, laws)[0]

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        forces, by = self.tangents(x)
        b = self.b
        residual = -forces
        residual[:b] += self.S @ (x[:b] * self.scale[:b]) - self.force
        jacobian = -np.hstack([by[:, :b], by[:, 2 * b :]])
        jacobian[:b, :b] += self.S
        return residual / self.sizes, jacobian * self.scale / self.sizes[:, None]

    def solved(self, value: float) -> np.ndarray | None:
        """Return the unknowns at rest, among them those that contacts carry, or None where none are
        found."""
        largest = max(np.abs(self.force).max(initial=0.0), 1e-300)
        with_films = _RestOnFilms(self)
        for lowered in _LOWERED:
            d = lowered * self.force / largest
            with suppress(NotConverged):
                if self.machine.laws.has_moving_films:
                    d = newton.solve(with_films, d, value)
                return newton.solve(self, np.append(d, with_films.states(d)), value)
        return None


class _RestOnFilms(Equations):
    """The `_RestEquations` in the displacements alone, films' pads and rings in equilibrium with
    these: a pad that bears nothing has none other to go to from where it does not bear."""

    def __init__(self, of: _RestEquations) -> None:
        self._of, self._B, self._scale = of, of.machine.B, of.scale[: of.b]

    def _at(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        d = self._B @ (x * self._scale)
        return self._of.machine.laws.at_rest(d[None], self._of.speed)

    def states(self, x: np.ndarray) -> np.ndarray:
        """Return the unknown states; pads that bear nothing, which may be where they like, are
        tilted as far back as where the journal may be near by, so that its motion presses none."""
        of, d = self._of, self._B @ (x * self._scale)
        laws, scale = of.machine.laws, of.scale[of.b :]
        angles = np.linspace(0.0, 2 * np.pi, 8, endpoint=False)
        circle = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        around = _CLEAR * (circle[:, None] * laws.length[:, None]).reshape(len(angles), -1)
        near = laws.at_rest(np.vstack([d, d + around]), of.speed)[-1]
        back = near[:1] - _EDGE * scale  # where a pad that is just at its edge bears nothing
        at = laws.tangents(d[None], 0 * d[None], back, scale, of.speed)
        acts = np.abs(at.by_states * scale).max(axis=(0, 1), initial=0.0)
        return np.where(acts > _IDLE * acts.max(initial=0.0), near[0], near.min(axis=0)) / scale

    def linearized(self, x: np.ndarray, value: float) -> tuple[np.ndarray, np.ndarray]:
        of, (force, by_d, _) = self._of, self._at(x)
        sizes = of.sizes[: of.b]
        residual = of.S @ (x * self._scale) - of.force - force[0] @ self._B
        jacobian = of.S - of.machine.tangents_in_b(by_d)[0]
        return residual / sizes, jacobian * self._scale / sizes[:, None]


def rest_position(problem: HarmonicBalance, value: float) -> Orbit | None:
    """Return where the machine without unbalance rests, on its contacts too, as an orbit, or None
    where no such position is found."""
    rest, orbit = _RestEquations(problem, value), problem.split(np.zeros(problem.size), value)
    x = rest.solved(value)
    if x is None:
        return None
    orbit.b[0], orbit.states[0] = np.split(x * rest.scale, [rest.b])
    return orbit


class _ModesAtRest(NamedTuple):
    """The modes that whirl about rest: where it is, shape (b + s,) [m]; their roots [1/s], and
    their shapes in these unknowns, of the displacements and states, shape (m, b + s), the largest
    displacement a clearance."""

    at_rest: np.ndarray
    roots: np.ndarray
    shapes: np.ndarray

    @property
    def growth(self) -> np.ndarray:
        """By how much each grows beyond rounding [1/s]; negative where it does not."""
        return self.roots.real - LEAST_GROWTH * np.abs(self.roots)


def _modes_at_rest(problem: HarmonicBalance, value: float) -> _ModesAtRest | None:
    """Return the modes about rest, or None where no rest is found."""
    rest = _RestEquations(problem, value)
    x, b = rest.solved(value), rest.b
    if x is None:
        return None
    _, mean = rest.tangents(x)
    modes = modal_basis(rest.machine, Frequencies(rest.speed, abs(rest.speed), np.inf), mean)
    whirls = np.flatnonzero(modes.roots.imag > 0)
    shapes = np.vstack([modes.V[:b], modes.V[2 * b :]])[:, whirls].T
    largest = np.abs(shapes[:, :b]).max(axis=1, keepdims=True, initial=0.0)
    shapes = shapes * (problem.length_scale / np.maximum(largest, 1e-300))
    return _ModesAtRest(x * rest.scale, modes.roots[whirls], shapes)


def _whirl(
    problem: HarmonicBalance, value: float, at_rest: np.ndarray, shape: np.ndarray, omega: float
) -> Orbit:
    """Return a whirl of a shape and a frequency [rad/s] about a place."""
    series = np.zeros((2 * problem.H + 1, len(shape)))
    series[0], series[1], series[2] = at_rest, shape.real, -shape.imag
    own = series[:, : problem.b], series[:, problem.b :]
    return Orbit(*own, omega, 1, problem.speed_at(value), value)


def growing_whirls(problem: HarmonicBalance, value: float) -> Iterator[Orbit]:
    """Yield guesses of whirls in the modes that grow from rest."""
    modes = _modes_at_rest(problem, value)
    if modes is None:
        return
    b = problem.b
    for i in np.flatnonzero(modes.growth > 0):
        for size in _SIZES:
            # the larger a whirl, the more of the load it carries itself
            at = np.append((1.0 - size) * modes.at_rest[:b], modes.at_rest[b:])
            yield _whirl(problem, value, at, size * modes.shapes[i], float(modes.roots[i].imag))
        circle = _forward_circle(problem, value, modes.shapes[i])
        if circle is not None:
            centre = np.append(np.zeros(b), modes.at_rest[b:])
            for size in _CIRCLES:
                yield _whirl(problem, value, centre, size * circle, float(modes.roots[i].imag))


def _forward_circle(problem: HarmonicBalance, value: float, shape: np.ndarray) -> np.ndarray | None:
    """Return the forward part of a mode's shape, its largest displacement a clearance, or None
    where its backward part is larger. The load makes the mode about rest an ellipse, while the
    whirl that it grows into carries the load itself and is nearly a circle."""
    across = math.copysign(1.0, problem.speed_at(value)) * 1j
    x, y = shape[: problem.b : 2], shape[1 : problem.b : 2]
    forward, backward = 0.5 * (x + across * y), 0.5 * (x - across * y)
    largest = np.abs(forward).max(initial=0.0)
    if largest <= np.abs(backward).max(initial=0.0):
        return None
    forward *= problem.length_scale / largest
    displacements = np.column_stack([forward, -across * forward]).ravel()
    return np.append(displacements, shape[problem.b :])


def _growing(growth: np.ndarray | None) -> int:
    """Return how many modes grow, -1 where there is no rest."""
    return -1 if growth is None else int(np.count_nonzero(growth > 0))


def _may_pass_and_return(growths: Sequence[np.ndarray | None]) -> Iterator[tuple[int, int, float]]:
    """Yield each piece between values and mode, the piece by its begin, in which the growth may
    come to 0 and back, with its sign at both ends: where lines from the neighbouring pieces meet
    beyond 0, as far as a growth that bends one way may come."""
    for i, near in enumerate(zip(growths, growths[1:], growths[2:], growths[3:], strict=False), 1):
        known = [growth for growth in near if growth is not None]
        if len(known) < len(near) or len({len(growth) for growth in known}) > 1:
            continue
        for mode, sign in enumerate(np.sign(known[1])):
            before, first, last, after = (sign * float(growth[mode]) for growth in known)
            falls, rises = before - first, after - last  # towards the piece from either side
            if last > 0.0 and falls > 0.0 and rises > 0.0:
                share = (first - last + rises) / (falls + rises)
                if 0.0 < share < 1.0 and first < share * falls:
                    yield i, mode, float(sign)


def beginning_whirls(
    problem: HarmonicBalance, low: float, high: float
) -> Iterator[tuple[Orbit, Orbit]]:
    """Yield where in a range a mode about rest begins or ceases to grow: the machine at rest, and a
    small whirl in this mode."""

    def growth_at(value: float) -> np.ndarray | None:
        modes = _modes_at_rest(problem, value)
        return None if modes is None else modes.growth[np.argsort(modes.roots.imag)]

    def count_at(value: float) -> int:
        return _growing(growth_at(value))

    values = np.linspace(low, high, _LOOKED_AT)
    growths = [growth_at(value) for value in values]
    places = [(float(value), _growing(each)) for value, each in zip(values, growths, strict=True)]
    for i, mode, sign in _may_pass_and_return(growths):

        def away(value: float, mode: int = mode, sign: float = sign) -> float:
            growth = growth_at(value)
            return math.inf if growth is None or len(growth) <= mode else sign * float(growth[mode])

        ends = float(values[i]), float(values[i + 1])
        found = minimize_scalar(away, bounds=ends, method="bounded")
        places.append((float(found.x), count_at(float(found.x))))
    places.sort()
    pieces = list(pairwise(places))[::-1]  # the next one last
    while pieces:
        (below, few), (above, many) = pieces.pop()
        if few == many or min(few, many) < 0:
            continue
        middle = 0.5 * (below + above)
        if above - below > _PRECISION * (high - low):
            between = middle, count_at(middle)  # several modes may begin to grow in a piece
            pieces += [(between, (above, many)), ((below, few), between)]
            continue
        modes = _modes_at_rest(problem, above)
        if modes is None:
            continue
        for mode in np.argsort(np.abs(modes.growth))[: abs(many - few)]:
            at, omega = modes.at_rest, float(modes.roots[mode].imag)
            still, small = (size * modes.shapes[mode] for size in (0.0, _SIZES[-1]))
            yield _whirl(problem, above, at, still, omega), _whirl(problem, above, at, small, omega)


def rolling_whirls(problem: HarmonicBalance, value: float) -> Iterator[Orbit]:
    """Yield guesses of whirls that roll along the walls, the best balanced first: among them those
    whose radial forces are balanced."""
    laws = problem.machine_at(value).laws
    tried: list[tuple[float, Orbit]] = []
    for j in laws.rubbing:
        whirl = partial(_rolling_whirl, problem, value, j)
        radii = _RADII * laws.length[j]
        along = [whirl(r) for r in radii]
        changes = np.flatnonzero(np.diff(np.sign([lacking for lacking, _ in along])))
        tried += along
        for i in changes:
            ends = radii[i : i + 2]
            tried.append(whirl(brentq(lambda r, of=whirl: of(r)[0], *ends, rtol=_ROLLING)))
    for _, orbit in sorted(tried, key=lambda pair: abs(pair[0]))[:_MOST_GUESSES]:
        yield orbit


def _rolling_whirl(problem: HarmonicBalance, value: float, j: int, r: float) -> tuple[float, Orbit]:
    """Return a whirl of a radius [m] that rolls along wall j, and the radial force that it lacks,
    as a share of the forces."""
    machine, speed = problem.machine_at(value), problem.speed_at(value)
    omega = machine.laws.journal_radius(j) * abs(speed) / r
    d = np.zeros(2 * machine.laws.count, complex)
    # x + i y = r exp(-i omega t), or, at a negative speed, r exp(i omega t)
    d[2 * j : 2 * j + 2] = r, 1j * math.copysign(r, speed)
    b = np.zeros((2 * problem.H + 1, problem.b))
    b[1], b[2] = machine.b_of_displacements(d.real), machine.b_of_displacements(-d.imag)
    own = np.zeros((2 * problem.H + 1, problem.s))
    own[0] = machine.laws.starts
    S = machine.dynamic_stiffness(float(omega), speed, 1, 0).S[1]
    pull = (S @ (b[1] - 1j * b[2])) @ np.conj(machine.b_of_displacements(d))
    inward = -(machine.laws.wall_force(j, r) * r)
    size = abs(pull.real) + abs(inward)
    # half of |d|^2 = 2 r^2 is that of x and of y
    share = (0.5 * pull.real - inward) / max(size, 1e-300)
    return float(share), Orbit(b, own, float(omega), 1, speed, value)
