"""A bearing with films, or a squeeze film damper, alone: where it rests under a load, and the mass
that it carries without whirling."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..film.bearing_film import bearing_of, pad_count, pad_of
from ..film.solved_zone import solved
from ..film.tilting_pads import pad_balance
from ..film.zone_pressure import vectors, zone_bound
from ..kernels.kernel import interpreted
from ..laws_at_rest.film_at_rest import FilmAtRest
from ..laws_at_rest.tangents import LawsAtRest
from ..machine.rotor import Rotor
from ..parts.base import MountElement, Part
from ..parts.film_law import bearing_at
from ..parts.floating_ring_bearing import FloatingRingBearing
from ..parts.journal_bearing import JournalBearing
from ..parts.law import BY_D, Weights
from ..parts.squeeze_film_damper import SqueezeFilmDamper
from ..parts.tilting_pads import states_of_pad
from .system_at_speed import LinearError

_HALVINGS = 30
_TURNS, _MOST_TURN = 8, 0.3  # steps of Newton's method, and their size [rad]
_CLOSE = 1e-5  # of a displacement: what it makes of a load is not seen in a message


class _LoadedFilm(FilmAtRest, ABC):
    """A film whose journal rests under a load, or an error that says what it carries."""

    def rest(self, load: complex, start: complex | None = None) -> complex:
        """Return where the journal rests under a load [N], looked for from `start` on [m]; raises
        `LinearError` with the load where none is found or a film is thinner than its roughness."""
        d = self.equilibrium(load, start)
        if d is None or self.is_invalid(d):
            raise self.no_equilibrium(load)
        return d

    @abstractmethod
    def no_equilibrium(self, load: complex) -> LinearError:
        """Return the error of a load [N] that is not carried."""


class RingAlone(_LoadedFilm):
    """A floating ring bearing whose journal is moved by hand at a speed [rad/s].

    part: the bearing; where: its name, for messages; gravity: on the ring, x + i y [m/s2].
    """

    def __init__(
        self, part: FloatingRingBearing, speed: float, where: str, gravity: complex = 0j
    ) -> None:
        super().__init__(part, speed, where)
        interpreted(self._law.weigh)(self._record, self._tables, gravity)

    def no_equilibrium(self, load: complex) -> LinearError:
        """Return the error of a load [N] that is not carried."""
        return LinearError(
            f"{self.where}: no equilibrium at {self.speed:g} rad/s: its load is {abs(load):.4g} N, "
            f"and one of its films would be thinner than its roughness, {self._part.roughness:g} m"
        )


class Cage(NamedTuple):
    """What centres a damper's ring beside its film: stiffness [N/m] and damping [N.s/m] in x and
    y, shape (2,)."""

    stiffness: np.ndarray
    damping: np.ndarray


NO_CAGE = Cage(np.zeros(2), np.zeros(2))


def cage_of(rotor: Rotor, part: Part) -> Cage:
    """Return the springs of the housing that is a damper's ring, none of another part."""
    for _, mount in rotor.elements_of_kind(MountElement):
        if isinstance(part, SqueezeFilmDamper) and mount.name == part.ring:
            of = mount.source
            return Cage(np.array([of.kx, of.ky]), np.array([of.cx, of.cy]))
    return NO_CAGE


class BearingAlone(_LoadedFilm):
    """A journal bearing or a damper whose journal is moved by hand at a speed [rad/s].

    part: the bearing; where: its name, for messages; cage: beside its film, on a fixed housing.
    """

    def __init__(
        self,
        part: JournalBearing | SqueezeFilmDamper,
        speed: float,
        where: str = "journal_bearing",
        cage: Cage = NO_CAGE,
    ) -> None:
        super().__init__(part, speed, where)
        self.part, self.cage = part, cage
        is_journal = isinstance(part, JournalBearing)
        record, tables = self._record, self._tables
        self._bearing = (
            interpreted(bearing_at)(record, tables, self.speed)
            if is_journal
            else interpreted(bearing_of)(record)
        )

    def force(self, d: complex, v: complex = 0j) -> complex:
        """Return the force on the journal or ring [N], its cage's included."""
        (kx, ky), (cx, cy) = self.cage
        of_cage = complex(kx * d.real + cx * v.real, ky * d.imag + cy * v.imag)
        return super().force(d, v) - of_cage

    def tangent(self, d: complex, v: complex, weights: Weights) -> np.ndarray:
        """Return the force's derivative for `Weights`, shape (2, 2)."""
        of_cage = weights.displacement * self.cage.stiffness + weights.velocity * self.cage.damping
        return super().tangent(d, v, weights) - np.diag(of_cage)

    def coefficients(self, d: complex) -> tuple[np.ndarray, np.ndarray]:
        """Return K [N/m] and C [N.s/m] at rest at a displacement, with the cage's, shape (2, 2)."""
        K, C = super().coefficients(d)
        return K + np.diag(self.cage.stiffness), C + np.diag(self.cage.damping)

    def is_centred(self, load: complex) -> bool:
        """Whether a spring, or a cage within the clearance, centres the ring under a load [N]."""
        most = abs(load) / self.part.clearance
        return super().is_centred(load) or bool((self.cage.stiffness > most).all())

    @property
    def viscosity(self) -> float:
        """Viscosity of the lubricant at the speed [Pa.s]."""
        return float(self._bearing.viscosity)

    def pressure(self, d: complex, angles: np.ndarray) -> np.ndarray:
        """Return the pressure in the middle of the length at angles from 0 to 2 pi, with the
        journal at rest at a displacement [Pa]."""
        bearing, tables = self._bearing, self._tables
        self._settle_at(d, 0j)
        moving, result = self._moving(d, 0j), np.zeros_like(angles)
        for i in range(interpreted(pad_count)(bearing, tables)):
            pad, work = interpreted(pad_of)(bearing, tables, moving, i)
            if pad.film.S == 0.0:
                continue
            for turn in (-1, 0, 1, 2):
                acts, bound = interpreted(zone_bound)(pad.film, np.angle(pad.film.S), turn)
                if not acts:
                    continue
                if self.part.short:
                    theta = np.linspace(bound.low[1], bound.high[0], 101)
                    share = (self.part.length / self.part.journal_radius) ** 2 / 8
                    turned = np.exp(-1j * theta)
                    h = np.maximum(1.0 - (turned * pad.film.D).real, pad.film.floor)
                    P = share * (turned * pad.film.S).real / h**3
                else:
                    zone, _ = interpreted(solved)(pad.film, bound, work)
                    P = interpreted(vectors)(pad.film, work).P
                    P = np.maximum(P, -pad.film.ambient) if pad.film.is_full else P
                    theta = np.linspace(zone.first, zone.last, len(P))
                of_zone = np.full_like(angles, np.nan)  # an angle may lie at both its ends
                for whole in (-2 * math.pi, 0.0, 2 * math.pi):
                    at = np.interp(angles + whole, theta, P, left=np.nan, right=np.nan)
                    of_zone = np.where(np.isnan(of_zone), at, of_zone)
                result += pad.pressure * np.nan_to_num(of_zone)
        return result

    def tilts(self, d: complex) -> np.ndarray:
        """Return how far each pad that tilts does, where the journal rests at a displacement [m],
        the imaginary part being how far its pivot gives, if it does; none of pads that stand."""
        assert isinstance(self.part, JournalBearing)
        self._settle_at(d, 0j)
        stride = interpreted(states_of_pad)(self.part)
        tilts = self._states[::stride].copy()
        gives = self.part.pivot_stiffness > 0.0
        return tilts + 1j * self._states[stride - 1 :: stride] if gives else tilts

    def pad_loads(self, d: complex) -> np.ndarray:
        """Return what each pad bears where the journal rests at a displacement [N]."""
        self._settle_at(d, 0j)
        moving, tables = self._moving(d, 0j), self._tables
        count = interpreted(pad_count)(self._bearing, tables)
        balance = interpreted(pad_balance)
        return np.array(
            [abs(balance(self._bearing, tables, moving, i).force) for i in range(count)]
        )

    def root_of_mass(self, d: complex) -> Callable[[float], complex]:
        """Return what gives for a mass [kg] the fastest growing root [1/s] of the journal with that
        mass, about its rest at a displacement [m], on pads that follow it."""
        self._settle_at(d, 0j)
        place, which = np.array([d], complex), np.array([True])
        at, of = self._laws.linearized(place, self.speed, self._states, which)
        force = np.hstack([at.by_d[0], at.by_v[0], of.force])
        rates = np.hstack([of.by_d, of.by_v, of.by_states])
        velocity = np.eye(2, force.shape[1], 2)

        def root(mass: float) -> complex:
            roots = np.linalg.eigvals(np.vstack([velocity, force / mass, rates]))
            return complex(roots[roots.real.argmax()])

        return root

    def no_equilibrium(self, load: complex) -> LinearError:
        """Return the error of a load [N] that is not carried: with the load and what is."""
        is_damper = isinstance(self.part, SqueezeFilmDamper)
        if self.speed == 0.0 and load == 0.0 and not is_damper:
            return LinearError(
                f"{self.where}: no equilibrium at 0 rad/s: at standstill its film carries nothing, "
                "and what else holds the machine lets its journal down to where the film is "
                f"thinner than its roughness, {self.part.roughness:g} m; give a speed above 0"
            )
        at, what = ("", "spring") if is_damper else (f" at {self.speed:g} rad/s", "film")
        what = "cage" if self.cage.stiffness.any() else what
        return LinearError(
            f"{self.where}: no equilibrium{at}: its load is "
            f"{abs(load):.4g} N, and its {what} carries {self._capacity(load):.4g} N in that "
            f"direction when the film is as thin as its roughness, {self.part.roughness:g} m"
        )

    def _capacity(self, load: complex) -> float:
        """Return the largest share of a load that the film, or a damper's springs, carry [N]."""
        if isinstance(self.part, SqueezeFilmDamper):
            ahead = np.array([load.real, load.imag]) / abs(load) if load else np.array([0.0, 1.0])
            stiffness = self.part.stiffness + float(self.cage.stiffness @ ahead**2)
            return stiffness * (self.part.clearance - self.part.roughness)
        if self._law.vibrate is not None:  # each force takes a while then
            return self._carried_at_roughness(load) if self.speed != 0.0 else 0.0
        low, high = 0.0, 1.0
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            d = self.equilibrium(middle * load)
            is_carried = d is not None and not self.is_invalid(d)
            low, high = (middle, high) if is_carried else (low, middle)
        return low * abs(load)

    def _carried_at_roughness(self, load: complex) -> float:
        """Return the film's force against the direction of a load where the journal has moved so
        far that the film is as thin as its roughness [N]."""
        ahead = load / abs(load)
        d = 0.5 * self.part.clearance * ahead
        low, high = 0.0, math.inf
        fall, before = 1.0, None  # of the film by the displacement; the last of both
        for _ in range(_HALVINGS):
            d = self._turned(d, ahead)
            size = abs(d)
            left = self.outputs(d)["film"] - self.part.roughness
            low, high = (size, high) if left > 0.0 else (low, size)
            if before is not None and (before[1] - left) * (size - before[0]) > 0.0:
                fall = (before[1] - left) / (size - before[0])
            before = size, left
            longer = size + left / fall
            if not low < longer < high:
                longer = 0.5 * (low + high)
            if abs(longer - size) <= _CLOSE * size:
                break
            d *= longer / size
        return max(0.0, -(self.force(d) * ahead.conjugate()).real)

    def _turned(self, d: complex, ahead: complex) -> complex:
        """Return a displacement [m] turned to where the film's force has a direction."""
        for _ in range(_TURNS):
            across = (self.force(d) * ahead.conjugate()).imag
            x, y = self.tangent(d, 0j, BY_D) @ [(1j * d).real, (1j * d).imag]
            slope = (complex(x, y) * ahead.conjugate()).imag
            turn = -across / slope if slope != 0.0 else 0.0
            turn = min(max(turn, -_MOST_TURN), _MOST_TURN)
            if abs(turn) <= _CLOSE:
                break
            d *= complex(math.cos(turn), math.sin(turn))
        return d


def critical_mass(K: np.ndarray, C: np.ndarray) -> tuple[float, float]:
    """Return the mass above which a rigid rotor on a bearing is unstable [kg], infinite if none is,
    0 if each is, and at what frequency it whirls there [rad/s]; K [N/m], C [N.s/m], shape (2, 2).

    Lund and Thomsen (1978); the mass hangs on one bearing. Each mass is unstable where even none
    at all would leave the equilibrium, det(K + s C) = 0 having a root that does not decay.
    """
    of_both = K[0, 0] * C[1, 1] + K[1, 1] * C[0, 0] - K[0, 1] * C[1, 0] - K[1, 0] * C[0, 1]
    of_none = [np.linalg.det(C), of_both, np.linalg.det(K)]
    if min(*of_none, np.trace(C)) <= 0.0:
        return 0.0, float(np.abs(np.roots(of_none).imag).max(initial=0.0))
    stiffness = of_both / np.trace(C)
    square = (stiffness - K[0, 0]) * (stiffness - K[1, 1]) - K[0, 1] * K[1, 0]
    square /= np.linalg.det(C)
    if square <= 0.0:
        return math.inf, 0.0
    return float(stiffness / square), math.sqrt(square)


def check_films(
    rotor: Rotor,
    interfaces: Sequence[str],
    speed: float,
    d: np.ndarray,
    force: np.ndarray,
    laws: LawsAtRest,
) -> None:
    """Raise `LinearError` for a film that is thinner than its roughness, with its load and what it
    carries; d, force: of the interfaces of these names [m], [N]; laws: theirs, settled there."""
    parts = dict(rotor.named_parts())
    for j, (name, at, on) in enumerate(zip(interfaces, d, force, strict=True)):
        part = parts.get(name)
        if isinstance(part, JournalBearing | SqueezeFilmDamper):
            if laws.is_invalid[j]:
                alone = BearingAlone(part, speed, name, cage_of(rotor, part))
                kx, ky = alone.cage.stiffness
                of_cage = complex(kx * at.real, ky * at.imag)
                raise alone.no_equilibrium(of_cage - complex(on))
        elif isinstance(part, FloatingRingBearing) and laws.is_invalid[j]:
            raise RingAlone(part, speed, name).no_equilibrium(-complex(on))
