"""The false state: a journal that bounces between the walls of its clearance for the integrator.

A step sees the contact force at its two ends only, so a journal that crosses its clearance in a
step or two moves as no journal can: the wall's force does not act for as long as the touch lasts
but for a step. Such a motion is a cycle of p steps, after each of which the journal is at one wall,
at the other, or free: its word. Along one axis all but the walls is linear, and a force F_n of
period p is answered by

    d_n = mean + sum_m H_(n-m) F_m,    H_n: inverse discrete Fourier transform of H(z), z^p = 1
    H(z) = b^T (M m(z) / (h^2 s(z)) + C d(z) / (h s(z)) + K)^-1 b,    H(1) = 0
    K_s (mean - d_rest) = mean force + load,    K_s = 1 / (b^T K^-1 b)

with the scheme's polynomials m, d, s (`Scheme.characteristic`); b: journal less housing. With
F_n = -(k (d_n -+ s) + c d_n') at the walls a word is a linear system of at most p + 1 equations. It
is a motion of the integrator if the journal is where the word says and the walls push (inequalities
that tell also which slow loads it bears), and it lasts if the product of its steps' matrices has no
eigenvalue above 1.

For the word RRLL between hard walls only z = i counts, and the inequalities say that the phase of
-1 / H(i) is below 45 degrees: `quarter_phase`.
"""

from __future__ import annotations

import cmath
import itertools
import math
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from .assembly import Structure
from .band import to_dense
from .equilibrium import static_equilibrium
from .schemes import Scheme

RIGHT, FREE, LEFT = 1, 0, -1
X, Y = 0, 1
LONGEST = 6  # steps of the cycles that are looked for
_LETTERS = {RIGHT: "R", FREE: ".", LEFT: "L"}
_ROUNDING = 1e-9
_SOFTNESS = 1e-13  # of the stiffness's diagonal, that a free rotor has a static shape


@dataclass(frozen=True)
class Axis:
    """One direction of bouncing: the machine along it as one journal sees it, without spin.

    M, C, K: shape (n + bearings,) squared, the other journals held as they rest; at, wall: indices
    of journal and housing; clearance [m], k [N/m], c [N.s/m]: of the contact; rest: of the journal
    relative to its housing [m]; along, across: static load on the journal in the direction of
    bouncing and at right angles to it [N].
    """

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    at: int
    wall: int
    clearance: float
    k: float
    c: float
    rest: float
    along: float
    across: float

    @cached_property
    def pick(self) -> np.ndarray:
        """b, shape (n + bearings,): journal less housing."""
        b = np.zeros(len(self.M))
        b[self.at], b[self.wall] = 1.0, -1.0
        return b

    @cached_property
    def static(self) -> tuple[np.ndarray, float]:
        """Static shape for a journal that is 1 m off its rest, shape (n + bearings,) [1], and the
        stiffness K_s [N/m]."""
        shape = _solve(self.K + _SOFTNESS * np.diag(np.diagonal(self.K)), self.pick)
        compliance = self.pick @ shape
        return shape / compliance, 1.0 / compliance


@dataclass(frozen=True)
class Cycle:
    """A motion of the integrator that repeats itself after p steps, under the static load.

    word: where the journal is after each step, of `R` (in the positive direction), `L` and `.`;
    force: of the walls on the journal, shape (p,) [N]; displacement: of the journal relative to its
    housing, shape (p,) [m]; load: least and largest load in the direction of bouncing under which
    it remains [N]; radius: spectral radius of a step, on average [1]; power: what the dampers take
    and the integrator makes [W]; state: displacements, velocities and accelerations after the first
    step, relative to the rest, shape (3, n + bearings) [m, m/s, m/s2].
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


def axis_of(structure: Structure, bearing: int, direction: int) -> Axis:
    """The machine along x (`X`) or y (`Y`) as the journal of `bearing`, from 0, sees it.

    The other journals rest: held by the contact's stiffness in y, by their weight over their
    clearance in x. Raises `EquilibriumError`.
    """
    contacts = structure.contacts
    n, nb = structure.M.shape[1], len(contacts)
    M, C, K = (np.zeros((n + nb, n + nb)) for _ in range(3))
    for whole, band in ((M, structure.M), (C, structure.C), (K, structure.K)):
        whole[:n, :n] = to_dense(band)
    q = static_equilibrium(structure)
    rest = (q[contacts.dof] - q[n:]).imag
    weights = contacts.k * np.maximum(np.abs(rest) - contacts.clearance, 0.0)
    for j, contact in enumerate(contacts):
        wall = n + j
        M[wall, wall] = contact.mass
        C[wall, wall] = (contact.cx, contact.cy)[direction]
        K[wall, wall] = (contact.kx, contact.ky)[direction]
        if j != bearing:
            held = weights[j] / contact.clearance if direction == X else contact.k
            pair = np.ix_((contact.dof, wall), (contact.dof, wall))
            K[pair] += held * np.array([[1.0, -1.0], [-1.0, 1.0]])
    own = contacts[bearing]
    load = math.copysign(weights[bearing], rest[bearing])
    rest_along, along, across = (0.0, 0.0, load) if direction == X else (rest[bearing], load, 0.0)
    return Axis(
        M, C, K, own.dof, n + bearing, own.clearance, own.k, own.c, rest_along, along, across
    )


def unbalance_loads(structure: Structure, omega: float) -> np.ndarray:
    """Amplitudes of the loads that the unbalance puts on the bearings at a steady speed [N].

    Linear, the journals tied to their housings by the contact's stiffness; omega [rad/s]; shape
    (bearings, 2), in x and y.
    """
    contacts = structure.contacts
    n, nb = structure.M.shape[1], len(contacts)
    size = n + nb
    M, C, K, G = (to_dense(b) for b in (structure.M, structure.C, structure.K, structure.G))
    dynamic = np.zeros((2 * size, 2 * size), dtype=complex)
    for axis, at in ((X, 0), (Y, size)):
        block = dynamic[at : at + size, at : at + size]
        block[:n, :n] = K + 1j * omega * C - omega**2 * M
        for j, contact in enumerate(contacts):
            wall = n + j
            stiffness, damping = ((contact.kx, contact.cx), (contact.ky, contact.cy))[axis]
            block[wall, wall] = stiffness + 1j * omega * damping - omega**2 * contact.mass
            pair = np.ix_((contact.dof, wall), (contact.dof, wall))
            block[pair] += contact.k * np.array([[1.0, -1.0], [-1.0, 1.0]])
    # (C - i Omega G) v in x and y
    dynamic[:n, size : size + n] += 1j * omega * omega * G
    dynamic[size : size + n, :n] -= 1j * omega * omega * G
    force = np.zeros(2 * size, dtype=complex)
    pull = omega**2 * structure.unbalance
    np.add.at(force, structure.unbalance_dof, pull)
    np.add.at(force, structure.unbalance_dof + size, -1j * pull)
    q = _solve(dynamic, force).reshape(2, size)
    return np.abs(contacts.k * (q[:, contacts.dof] - q[:, n:])).T


def _solve(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    # deflections and slopes of short elements differ by many decades
    scale = 1.0 / np.sqrt(np.abs(np.diagonal(matrix)))
    return scale * np.linalg.solve(scale[:, None] * matrix * scale, scale * right)


def response(axis: Axis, scheme: Scheme, h: float, z: complex) -> np.ndarray:
    """What a contact force z^n [N] at the ends of steps of length h [s] leaves there.

    Displacements, velocities and accelerations, shape (3, n + bearings) [m/N, ...]. Raises
    `numpy.linalg.LinAlgError` at a pole.
    """
    m, d, s = (np.polyval(c[::-1], z - 1.0) for c in scheme.characteristic())
    solved = _solve(m / h**2 * axis.M + d / h * axis.C + s * axis.K, axis.pick)
    by_acceleration = (z - 1.0) ** 2 * (1.0 + (1.0 - scheme.alpha_f) * (z - 1.0))
    return np.array([s * solved, d / h * solved, by_acceleration / h**2 * solved])


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
    found = []
    seen = set()
    for word in itertools.product((RIGHT, FREE, LEFT), repeat=p):
        if word in seen or RIGHT not in word or LEFT not in word:
            continue
        turned = [word[i:] + word[:i] for i in range(p)]
        seen.update(turned)
        if word not in turned[1:]:
            found.append(word)
    return tuple(found)


def cycles(axis: Axis, scheme: Scheme, h: float, longest: int = LONGEST) -> list[Cycle]:
    """All cycles of at most `longest` steps of length h [s] that are motions of the integrator
    under the static load, the one that bears most first."""
    found = []
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
                found.append(cycle)
    return sorted(found, key=lambda cycle: -cycle.bears(axis))


def _cycle(axis, scheme, h, word, answers) -> Cycle | None:
    p = len(word)
    later = np.subtract.outer(np.arange(p), np.arange(p)) % p
    by_force, rate_by_force = (np.fft.ifft(answers[:, i] @ axis.pick).real[later] for i in range(2))
    shape, stiffness = axis.static
    side = np.array(word)
    on = np.flatnonzero(side)
    # unknowns: the forces of the walls and the mean; two right-hand sides: what is there without a
    # load, and by each newton of it
    size = len(on)
    matrix = np.zeros((size + 1, size + 1))
    matrix[:size, :size] = np.eye(size)
    matrix[:size, :size] += (axis.k * by_force + axis.c * rate_by_force)[np.ix_(on, on)]
    matrix[:size, size] = axis.k
    matrix[size, :size] = -1.0 / p
    matrix[size, size] = stiffness
    right = np.zeros((size + 1, 2))
    right[:size, 0] = axis.k * side[on] * axis.clearance
    right[size] = stiffness * axis.rest, 1.0
    try:
        solved = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return None
    force = np.zeros((p, 2))
    force[on] = solved[:size]
    displacement = by_force @ force + solved[size]
    wall = np.array([axis.clearance, 0.0])
    free = displacement[side == FREE]
    must_be_positive = np.concatenate(
        [
            axis.k * (side[on, None] * displacement[on] - wall),
            -side[on, None] * force[on],
            axis.k * (wall - free),
            axis.k * (wall + free),
        ]
    )
    constant, slope = must_be_positive.T
    with np.errstate(divide="ignore", invalid="ignore"):
        limits = -constant / slope
    low, high = limits[slope > 0].max(initial=-np.inf), limits[slope < 0].min(initial=np.inf)
    if not low < axis.along < high or (constant[slope == 0] <= 0.0).any():
        return None
    loaded = np.array([1.0, axis.along])
    force, displacement, mean = force @ loaded, displacement @ loaded, solved[size] @ loaded
    spectrum = np.fft.fft(force)[:, None, None] * answers
    state = np.fft.ifft(spectrum, axis=0).real
    velocity = state[:, 1]
    loss = np.einsum("ni,ij,nj->n", velocity, axis.C, velocity).mean()
    loss += (axis.c * (velocity[on] @ axis.pick) ** 2).sum() / p
    state[:, 0] += (mean - axis.rest) * shape
    return Cycle(
        word="".join(_LETTERS[letter] for letter in word),
        force=force,
        displacement=displacement,
        load=(float(low), float(high)),
        radius=_radius(axis, scheme, h, word),
        power=float(loss),
        state=state[0],
    )


def _radius(axis, scheme, h, word) -> float:
    """Spectral radius of the product of a word's steps, to the power 1 / p."""
    am, af, beta, gamma = scheme
    size = len(axis.M)
    wall = np.outer(axis.pick, axis.pick)
    zero, one = np.zeros((size, size)), np.eye(size)
    scale = 1.0 / np.sqrt(np.diagonal(axis.M))[:, None]
    product = np.eye(3 * size)
    # the state is (q, h v, h^2 a)
    for before, after in zip((word[-1], *word[:-1]), word, strict=True):
        K0, K1 = (h**2 * (axis.K + abs(at) * axis.k * wall) for at in (before, after))
        C0, C1 = (h * (axis.C + abs(at) * axis.c * wall) for at in (before, after))
        left = np.block(
            [
                [one, zero, -beta * one],
                [zero, one, -gamma * one],
                [scale * ((1 - af) * K1), scale * ((1 - af) * C1), scale * ((1 - am) * axis.M)],
            ]
        )
        right = np.block(
            [
                [one, one, (0.5 - beta) * one],
                [zero, one, (1.0 - gamma) * one],
                [scale * (-af * K0), scale * (-af * C0), scale * (-am * axis.M)],
            ]
        )
        product = np.linalg.solve(left, right) @ product
    return float(np.abs(np.linalg.eigvals(product)).max() ** (1.0 / len(word)))
