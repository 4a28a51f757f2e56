"""The false state: a journal that bounces between the walls of its clearance for the integrator.

A step sees the contact force at its two ends only, so a journal that crosses its clearance in a
step or two moves as no journal can: the wall's force does not act for as long as the touch lasts
but for a step. Such a motion is a cycle of p steps, after each of which the journal is at one wall,
at the other, or free: its word. Along one axis all but the walls is linear, and a force F_n of
period p is answered by

    d_n = mean + sum_m H_(n-m) F_m,    H_n: inverse discrete Fourier transform of H(z), z^p = 1
    H(z) = b^T (M m(z) / (h^2 s(z)) + C d(z) / (h s(z)) + K)^-1 b,    H(1) = 0
    K_s (mean - d_rest) = mean force + load (all of it),    K_s = 1 / (b^T K^-1 b)

with the scheme's polynomials m, d, s (`Scheme.characteristic`); b: journal less housing. With
F_n = -(k (d_n -+ s) + c d_n') at the walls a word is a linear system of at most p + 1 equations. It
is a motion of the integrator if the journal is where the word says and the walls push (inequalities
that tell also which slow loads it bears), and it lasts if the product of its steps' matrices has no
eigenvalue above 1.

For the word RRLL between hard walls only z = i counts, and the inequalities say that the phase of
-1 / H(i) is below 45 degrees: `quarter_phase`.
"""

import cmath
import itertools
import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from papers.integrators.members import Scheme

from .one_axis import Axis, response, step_matrices

RIGHT, FREE, LEFT = 1, 0, -1
LONGEST = 6  # steps of the cycles that are looked for
_LETTERS = {RIGHT: "R", FREE: ".", LEFT: "L"}
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Cycle:
    """A motion of the integrator that repeats itself after p steps, under the static load.

    word: where the journal is after each step, of `R` (in the positive direction), `L` and `.`;
    force: of the walls on the journal, shape (p,) [N]; displacement: of the journal relative to its
    housing, shape (p,) [m]; load: least and largest load in the direction of bouncing under which
    it remains [N]; radius: spectral radius of a step, on average [1]; power: what the dampers take
    and the integrator makes [W]; state: displacements, velocities and accelerations after the first
    step, relative to the rest, shape (3, n + housings) [m, m/s, m/s2].
    """

    word: str
    force: np.ndarray
    displacement: np.ndarray
    load: tuple[float, float]
    radius: float
    power: float
    state: np.ndarray

    @property
    def is_stable(self) -> bool:
        """Whether no small disturbance grows."""
        return self.radius <= 1.0 + _ROUNDING

    def tilt(self, across: float) -> float:
        """Angle by which a load [N] at right angles turns the normals of the walls [rad].

        sin 2a = 2 P / mean |F|, since all forces shrink by cos a with the chord on which the
        journal bounces; NaN where the cycle cannot carry the load.
        """
        turned = 2.0 * abs(across) / np.abs(self.force).mean()
        return 0.5 * math.asin(turned) if turned <= 1.0 else math.nan

    def bears(self, axis: Axis) -> float:
        """Amplitude of a slow load in any direction, beside the static one, that the cycle bears
        [N]; below 0 if it does not even bear that."""

        def reserve(amplitude: float) -> float:
            tilt = self.tilt(abs(axis.across) + amplitude)
            if math.isnan(tilt):
                return -1.0
            low, high = (math.cos(tilt) * limit for limit in self.load)
            return min(axis.along - low, high - axis.along) - amplitude

        if reserve(0.0) < 0.0:
            return -1.0
        low, high = 0.0, float(np.abs(self.force).mean())
        for _ in range(40):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if reserve(middle) >= 0.0 else (low, middle)
        return low


def quarter_phase(axis: Axis, scheme: Scheme, h: float) -> float:
    """Phase of the dynamic stiffness at four steps a period, against that of a mass [rad].

    Below pi / 4 the cycle RRLL exists between hard walls; h [s].
    """
    compliance = axis.pick @ response(axis, scheme, h, 1j)[0]
    return abs(cmath.phase(-1.0 / compliance))


@cache
def words(p: int) -> tuple[tuple[int, ...], ...]:
    """All words of p letters that touch both walls, one of those that are the same in turn, and
    none that repeats a shorter one."""
    result = []
    seen = set()
    for word in itertools.product((RIGHT, FREE, LEFT), repeat=p):
        if word in seen or RIGHT not in word or LEFT not in word:
            continue
        turned = [word[i:] + word[:i] for i in range(p)]
        seen.update(turned)
        if word not in turned[1:]:
            result.append(word)
    return tuple(result)


def cycles(axis: Axis, scheme: Scheme, h: float, longest: int = LONGEST) -> list[Cycle]:
    """All cycles of at most `longest` steps of length h [s] that are motions of the integrator
    under the static load, the one that bears most first."""
    result = []
    for p in range(2, longest + 1):
        roots = np.exp(2j * np.pi * np.arange(1, p) / p)
        try:
            answers = np.array([response(axis, scheme, h, z) for z in roots])
        except np.linalg.LinAlgError:
            continue
        answers = np.concatenate([np.zeros((1, *answers.shape[1:])), answers])
        for word in words(p):
            cycle = _cycle(axis, scheme, h, word, answers)
            if cycle is not None:
                result.append(cycle)
    return sorted(result, key=lambda cycle: -cycle.bears(axis))


def _cycle(axis, scheme, h, word, answers) -> Cycle | None:
    """The cycle of a word, if it is a motion; answers: `response` for each z, zero for z = 1."""
    side = np.array(word)
    solved = _solve_word(axis, side, answers)
    if solved is None:
        return None
    low, high = _load_range(axis, side, *solved[:2])
    if not low < axis.along < high:
        return None
    force, displacement, mean = (pair @ np.array([1.0, axis.along]) for pair in solved)
    state = np.fft.ifft(np.fft.fft(force)[:, None, None] * answers, axis=0).real
    velocity = state[:, 1]
    at_wall = velocity[side != FREE] @ axis.pick
    loss = np.einsum("ni,ij,nj->", velocity, axis.C, velocity) + axis.c * at_wall @ at_wall
    shape, _ = axis.static
    state[:, 0] += (mean - axis.rest) * shape
    return Cycle(
        word="".join(_LETTERS[letter] for letter in word),
        force=force,
        displacement=displacement,
        load=(low, high),
        radius=_radius(axis, scheme, h, word),
        power=float(loss) / len(word),
        state=state[0],
    )


def _solve_word(axis, side, answers) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Forces and displacements, shape (p, 2), and their mean, shape (2,), if the word were true:
    without a load, and by each newton of it."""
    p = len(side)
    later = np.subtract.outer(np.arange(p), np.arange(p)) % p
    d_by_force, v_by_force = (np.fft.ifft(answers[:, i] @ axis.pick).real[later] for i in range(2))
    _, stiffness = axis.static
    on = np.flatnonzero(side)
    n = len(on)
    # unknowns: the forces of the walls, the mean displacement
    matrix = np.zeros((n + 1, n + 1))
    matrix[:n, :n] = np.eye(n) + (axis.k * d_by_force + axis.c * v_by_force)[np.ix_(on, on)]
    matrix[:n, n] = axis.k
    matrix[n, :n] = -1.0 / p
    matrix[n, n] = stiffness
    right = np.zeros((n + 1, 2))
    right[:n, 0] = axis.k * side[on] * axis.clearance
    right[n] = stiffness * axis.rest, 1.0
    try:
        solved = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return None
    force = np.zeros((p, 2))
    force[on] = solved[:n]
    return force, d_by_force @ force + solved[n], solved[n]


def _load_range(axis, side, force, displacement) -> tuple[float, float]:
    """Loads [N] between which the journal is where the word says and the walls push."""
    s = np.array([axis.clearance, 0.0])
    on, free = side != FREE, side == FREE
    must_be_positive = [
        axis.k * (side[on, None] * displacement[on] - s),
        -side[on, None] * force[on],
        axis.k * (s - displacement[free]),
        axis.k * (s + displacement[free]),
    ]
    constant, slope = np.concatenate(must_be_positive).T
    if (constant[slope == 0.0] <= 0.0).any():
        return math.inf, -math.inf
    rising, falling = slope > 0.0, slope < 0.0
    low = (-constant[rising] / slope[rising]).max(initial=-math.inf)
    high = (-constant[falling] / slope[falling]).min(initial=math.inf)
    return float(low), float(high)


def _radius(axis, scheme, h, word) -> float:
    """Spectral radius of the product of a word's steps, to the power 1 / p."""
    product = np.eye(3 * len(axis.M))
    for before, after in zip((word[-1], *word[:-1]), word, strict=True):
        product = step_matrices(axis, scheme, h, before != FREE, after != FREE)[0] @ product
    return float(np.abs(np.linalg.eigvals(product)).max() ** (1.0 / len(word)))
