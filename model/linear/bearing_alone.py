"""A journal bearing or a squeeze film damper alone: where it rests under a load, and the mass that
it carries without whirling."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..contact.film import pad_count, pad_of, solved
from ..contact.film_zone import vectors, zone_bound
from ..kernels.jit import interpreted
from ..machine.rotor import Rotor
from ..parts.journal_bearing import JournalBearing
from ..parts.law import Weights
from ..parts.squeeze_film_damper import SqueezeFilmDamper
from .law_alone import LawAlone
from .linearized import LinearError

_BY_D = Weights(1.0, 0.0, 0.0)
_ITERATIONS, _CHANGE = 200, 1e-12
_SHARE = 0.1  # of the clearance, that a step of Newton's method moves the journal
_HALVINGS, _FEW_HALVINGS = 30, 16


class BearingAlone(LawAlone):
    """A journal bearing or a damper whose journal is moved by hand at a speed [rad/s].

    part: the bearing; where: its name, for messages.
    """

    def __init__(
        self,
        part: JournalBearing | SqueezeFilmDamper,
        speed: float,
        where: str = "journal_bearing",
    ) -> None:
        super().__init__(part, speed, where)
        self.part = part

    def pressure(self, d: complex, angles: np.ndarray) -> np.ndarray:
        """Return the pressure in the middle of the length at angles from 0 to 2 pi, with the
        journal at rest at a displacement [Pa]."""
        record, tables = self._record, self._tables
        self._settle_at(d, 0j)
        moving, result = self._moving(d, 0j), np.zeros_like(angles)
        for i in range(interpreted(pad_count)(record, tables)):
            pad, work = interpreted(pad_of)(record, tables, moving, i)
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
                    P = np.maximum(P, 0.0) if pad.film.is_full else P
                    theta = np.linspace(zone.first, zone.last, len(P))
                for whole in (-2 * math.pi, 0.0, 2 * math.pi):
                    at = np.interp(angles + whole, theta, P, left=0.0, right=0.0)
                    result += pad.pressure * at
        return result

    def tilts(self, d: complex) -> np.ndarray:
        """Return how far each pad that tilts does, where the journal rests at a displacement [m];
        none of pads that stand."""
        if not isinstance(self.part, JournalBearing):
            return np.zeros(0)
        self._settle_at(d, 0j)
        return self._states[:: 2 if self.part.pad_inertia > 0.0 else 1].copy()

    def rest(self, load: complex, start: complex | None = None) -> complex:
        """Return where the journal rests under a load [N], looked for from `start` on [m]; raises
        `LinearError` with the load and what the film, or a damper's spring, carries."""
        d = self._rest(load, start)
        if d is None or self.is_broken(d):
            raise self.no_equilibrium(load)
        return d

    def no_equilibrium(self, load: complex) -> LinearError:
        """Return the error of a load [N] that is not carried: with the load and what is."""
        is_damper = isinstance(self.part, SqueezeFilmDamper)
        at, what = ("", "spring") if is_damper else (f" at {self.speed:g} rad/s", "film")
        return LinearError(
            f"{self.where}: no equilibrium{at}: its load is "
            f"{abs(load):.4g} N, and its {what} carries {self._capacity(load):.4g} N in that "
            f"direction when the film is as thin as its roughness, {self.part.roughness:g} m"
        )

    def _rest(self, load: complex, start: complex | None = None) -> complex | None:
        c, stiffness = self.part.clearance, self._law.stiffness
        is_held = stiffness is not None and stiffness(self.part) > 0.0
        if self.speed == 0.0 and not is_held:  # on its wall, if there is one
            if load == 0.0:
                return 0j
            if self.part.k == 0.0:
                return None
            start = c * load / abs(load)
        turned = -1j if self.speed > 0 else 1j if self.speed < 0 else 0.0
        ahead = load / abs(load) if load != 0.0 else 0j
        d = 0.3 * c * ahead * (1.0 - turned) if start is None else start
        for _ in range(_ITERATIONS):
            left = self.force(d) + load
            try:
                change = np.linalg.solve(self.tangent(d, 0j, _BY_D), [-left.real, -left.imag])
            except np.linalg.LinAlgError:
                return None
            step = complex(*change)
            size = abs(step)
            if not math.isfinite(size):
                return None
            step *= min(1.0, _SHARE * c / size) if size > 0.0 else 1.0
            d += step
            if size <= _CHANGE * c:
                return d
        return None

    def is_broken(self, d: complex) -> bool:
        """Return whether the film is thinner than its roughness, without a contact behind it."""
        self._settle_at(d, 0j)
        breaks = interpreted(self._law.breaks)
        return bool(breaks(self._record, self._tables, complex(d), self._states))

    def _capacity(self, load: complex) -> float:
        """Return the largest share of a load that the film, or a damper's spring, carries [N]."""
        if isinstance(self.part, SqueezeFilmDamper):
            return self.part.stiffness * (self.part.clearance - self.part.roughness)
        low, high = 0.0, 1.0
        start = None
        follows = self._law.vibrate is not None  # each force takes a while then
        for _ in range(_FEW_HALVINGS if follows else _HALVINGS):
            middle = 0.5 * (low + high)
            d = self._rest(middle * load, start)
            is_carried = d is not None and not self.is_broken(d)
            low, high = (middle, high) if is_carried else (low, middle)
            start = d if follows and is_carried else start
        return low * abs(load)


def critical_mass(K: np.ndarray, C: np.ndarray) -> tuple[float, float]:
    """Return the mass above which a rigid rotor on a bearing whirls [kg], infinite if none does,
    and at what frequency [rad/s]; K [N/m], C [N.s/m] of shape (2, 2).

    Lund and Thomsen (1978); the mass hangs on one bearing.
    """
    of_both = K[0, 0] * C[1, 1] + K[1, 1] * C[0, 0] - K[0, 1] * C[1, 0] - K[1, 0] * C[0, 1]
    stiffness = of_both / np.trace(C)
    square = (stiffness - K[0, 0]) * (stiffness - K[1, 1]) - K[0, 1] * K[1, 0]
    square /= np.linalg.det(C)
    if square <= 0.0:
        return math.inf, 0.0
    return float(stiffness / square), math.sqrt(square)


def check_films(
    rotor: Rotor, interfaces: Sequence[str], speed: float, d: np.ndarray, force: np.ndarray
) -> None:
    """Raise `LinearError` for a film that is thinner than its roughness, with its load and what it
    carries; d, force: of the interfaces of these names [m], [N]."""
    parts = dict(rotor.named_parts())
    for name, at, on in zip(interfaces, d, force, strict=True):
        part = parts.get(name)
        if isinstance(part, JournalBearing | SqueezeFilmDamper):
            alone = BearingAlone(part, speed, name)
            if alone.is_broken(complex(at)):
                raise alone.no_equilibrium(-complex(on))
