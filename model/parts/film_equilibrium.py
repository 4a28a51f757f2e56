"""The equilibrium of a journal in an oil film under a load."""

import math
from typing import Any

import numpy as np

from ..kernels.kernel import interpreted
from .law_probe import BY_D, LawProbe

_ITERATIONS, _CHANGE = 200, 1e-12  # of the clearance
_NEAR = 1e-6  # of the clearance: a step no shorter than the last is of rounding then
_SHARE = 0.1  # of the clearance, that a step of Newton's method moves the journal


class FilmProbe(LawProbe):
    """The film of a part at a prescribed motion of its journal, at a speed [rad/s].

    part: the part; where: its name, for messages.
    """

    def __init__(self, part: Any, speed: float, where: str) -> None:
        super().__init__(part, speed, where)
        self._part = part

    def equilibrium(self, load: complex, start: complex | None = None) -> complex | None:
        """Return the equilibrium of the journal under a load [N], by Newton's method from `start`
        on [m]; None if none is found."""
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
        breaks = interpreted(self._law.breaks)
        return bool(breaks(self._record, self._tables, complex(d), self._states))
