"""The equilibrium of a journal in an oil film under a load."""

import math
from typing import Any

import numpy as np

from ..parts import LAWS
from ..parts.law import BY_D
from ..parts.law_probe import LawProbe
from ..step.laws_along_motion import single_law
from .potential_rest import rest_in_potential
from .tangents import LawsAtRest

_ITERATIONS, _CHANGE = 200, 1e-12  # of the clearance
_NEAR = 1e-6  # of the clearance: a step no shorter than the last is of rounding then
_SHARE = 0.1  # of the clearance, that a step of Newton's method moves the journal
_LEFT = 1e-6  # of a load, that a film may bear more or less
_CLOSE = 1e-5  # of the clearance: how far a rest is from where it was looked for


class FilmAtRest(LawProbe):
    """The film of a part at a prescribed motion of its journal, at a speed [rad/s]; the solver
    library lets it rest, if there is one: `interpreted`, each of its pads takes milliseconds.

    part: the part; where: its name, for messages.
    """

    def __init__(self, part: Any, speed: float, where: str) -> None:
        super().__init__(part, speed, where)
        self._part = part
        one = single_law(self._law, self._record, self._tables, len(self._states))
        self._laws = LawsAtRest(*one)
        laws = self._laws.machine.laws
        self._record, self._tables = laws[LAWS.index(self._law)][0], laws[-1]
        self._follows = True  # the library knows every law so

    def _vibrating(self, d: complex, frequency: float) -> tuple[complex, np.ndarray, np.ndarray]:
        place, states = np.array([d], complex), self._states
        rest = self._laws.tangents(
            *(place, self.speed, frequency), sliding=self._sliding, states=states
        )
        self._states = self._laws.states.copy()
        return complex(rest.force[0]), rest.by_d[0], rest.by_v[0]

    def equilibrium(self, load: complex, start: complex | None = None) -> complex | None:
        """Return the equilibrium of the journal under a load [N], by Newton's method from `start`
        on [m], or, on pads that tilt, by `rest_in_potential`; None if none is found."""
        c = self._part.clearance
        if self.speed == 0.0 and not self.is_centred(load):  # it rests on its wall, if there is one
            if load == 0.0:
                return 0j
            if self._part.k == 0.0:
                return None
            start = c * load / abs(load)
        turned = -1j if self.speed > 0 else 1j if self.speed < 0 else 0.0
        ahead = load / abs(load) if load != 0.0 else 0j
        d = 0.3 * c * ahead * (1.0 - turned) if start is None else start
        found = self._by_newton(load, d)
        if not self._has_potential or self._balances(load, found):
            return found
        at_rest = rest_in_potential(self.force, load, c)
        return at_rest if at_rest is None else self._near(load, at_rest)

    @property
    def _has_potential(self) -> bool:
        """Whether the force at rest has a potential: that of pads that tilt, each of which bears
        along its pivot."""
        return getattr(self._part, "tilting", False)

    def _balances(self, load: complex, d: complex | None) -> bool:
        """Return whether the film bears a load [N] at a displacement: short steps to and fro are
        not yet a balance."""
        return d is not None and (load == 0.0 or abs(self.force(d) + load) <= _LEFT * abs(load))

    def _near(self, load: complex, d: complex) -> complex:
        """Return the equilibrium close to a displacement if Newton's method finds one, or else the
        displacement: the journal may be free to move across the load there."""
        found = self._by_newton(load, d)
        if found is None or abs(found - d) > _CLOSE * self._part.clearance:
            return d
        return found if self._balances(load, found) else d

    def _by_newton(self, load: complex, d: complex) -> complex | None:
        """Return the equilibrium by Newton's method from a displacement on, or None."""
        c = self._part.clearance
        before = math.inf
        for _ in range(_ITERATIONS):
            left = self.force(d) + load
            try:
                change = np.linalg.solve(self.tangent(d, 0j, BY_D), [-left.real, -left.imag])
            except np.linalg.LinAlgError:
                return None
            step = complex(*change)
            size = abs(step)
            if not math.isfinite(size):
                return None
            step *= min(1.0, _SHARE * c / size) if size > 0.0 else 1.0
            d += step
            if size <= _CHANGE * c or before <= size <= _NEAR * c:
                return d
            before = size
        return None

    def is_centred(self, load: complex) -> bool:
        """Return whether a spring centres the journal under a load [N]."""
        stiffness = self._law.stiffness
        return stiffness is not None and stiffness(self._part) > 0.0

    def is_invalid(self, d: complex) -> bool:
        """Return whether the film is thinner than its roughness, without a contact behind it."""
        self._settle_at(d, 0j)
        return bool(self._laws.is_invalid[0])
