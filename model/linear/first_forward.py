"""The mode whose logarithmic decrement stability by API 617 is about, at both levels.

The standard asks for the first forward mode. What that is where modes are nearly planar, as on
bearings that differ in x and y, their sense of whirl does not say: a little cross coupling turns
it. And a machine is not stable because one of its modes is. So:

1. Of the rotor on its bearings alone it is the lowest mode that does not whirl backward. Where
   cross coupling, raised at one node, makes another mode grow before that one, it is the other.
2. It is followed by its eigenvalue while seals and cross coupling are added.
3. Where another of the lowest modes grows, and this one does not, the one that grows is it: already
   of the rotor alone.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

from ..machine.rotor import Rotor
from ..parts.linear_bearing import Coefficients, LinearBearing
from ..quantities import quantities
from ..structure.assembly import assemble
from .machine import LinearError
from .modes import BACKWARD, FORWARD, Modes, modes

SPAN = 10.0  # of the cross coupling that is expected: as far as a growing mode is looked for
_COUNT = 8
_HALVINGS = 6
_LITTLE = 1e-6  # of the rotor's mass times its frequency squared
_LITTLE_SHARE = 1e-3  # of parts, whose cross coupling may be a small part of what they are
_ROUNDING = 1e-9  # of an eigenvalue, beside its residual: a real part that says nothing


def cross_coupling(node: int, q: float) -> LinearBearing:
    """Return a cross-coupled stiffness [N/m] at a node (from 1)."""
    return LinearBearing(node=node, kxx=0.0, kyy=0.0, kxy=q, kyx=-q, cxx=0.0, cyy=0.0)


class _Followed:
    """An eigenvalue [1/s] over an amount of what is added, followed from amount to amount.

    find: the modes with an amount; known: eigenvalues by their amounts.
    """

    def __init__(self, find: Callable[[float], Modes], known: dict[float, complex]) -> None:
        self._find, self.known = find, known
        self._modes: dict[float, Modes] = {}

    def modes(self, amount: float) -> Modes:
        """Return all modes with an amount."""
        if amount not in self._modes:
            self._modes[amount] = self._find(amount)
        return self._modes[amount]

    def __call__(self, amount: float) -> complex:
        """Return the eigenvalue with an amount."""
        if amount not in self.known:
            known = [k for k in self.known if k > 0 or len(self.known) == 1]
            self.known[amount] = self._onward(min(known, key=lambda k: abs(k - amount)), amount)
        return self.known[amount]

    def _onward(self, start: float, end: float, depth: int = 0) -> complex:
        """Go on by steps that leave no doubt which eigenvalue it is."""
        expected, found = self.known[start], self.modes(end).eigenvalues
        if len(found) == 0:
            raise LinearError(f"no mode oscillates with {end:g} of what is added")
        away = np.sort(np.abs(found - expected))
        if depth < _HALVINGS and len(away) > 1 and 3 * away[0] > away[1]:
            middle = (start + end) / 2
            self.known[middle] = self._onward(start, middle, depth + 1)
            return self._onward(middle, end, depth + 1)
        return complex(found[np.argmin(np.abs(found - expected))])

    def split(self, little: float) -> None:
        """Tell the forward mode from the backward one of the same eigenvalue, by a little."""
        found = self.modes(little)
        forward = [i for i, word in enumerate(found.whirl) if word == FORWARD]
        roots = found.eigenvalues[forward or slice(None)]
        both = self.known[0.0]
        self.known[little] = complex(roots[np.argmin(np.abs(roots - both))])


class FirstForward:
    """The first forward mode of a rotor on its bearings at a speed, and with what is added to it.

    Attributes
    ----------
    scale : float
        The rotor's mass times the mode's natural frequency squared [N/m].
    threshold : float or None
        Cross coupling at the node from which the rotor is unstable [N/m], None where there is none
        up to ten times the one that is expected and ten times `scale`.
    """

    def __init__(
        self, rotor: Rotor, speed: float, node: int, expected: float, contacts: str | None
    ) -> None:
        """Find the mode; node: from 1, of the cross coupling; expected: as much of it [N/m], or 0.
        Raises `LinearError` where no mode can be it."""
        self._rotor, self._speed, self._node = rotor, speed, node
        first = modes(rotor, speed, count=_COUNT, contacts=contacts)
        self._contacts = first.contacts
        at = _place(first)
        root = complex(first.eigenvalues[at])
        self._is_double = bool(first.is_degenerate[at])
        self.scale = float(assemble(rotor).mass_sum[::2].sum()) * float(first.natural[at]) ** 2
        self._coupled = _Followed(self._with_coupling, {0.0: root})
        if self._is_double:
            self._coupled.split(_LITTLE * self.scale)
        self.threshold = self._threshold(expected)

    def coupled(self, q: float) -> complex:
        """Return the eigenvalue [1/s] with a cross coupling [N/m] at the node."""
        return _or_growing(self._coupled(q), self._coupled.modes(q))

    def with_parts(self, parts: Sequence[LinearBearing]) -> complex:
        """Return the eigenvalue [1/s] with further bearings and seals."""
        followed = _Followed(lambda share: self._modes(parts, share), {0.0: self._coupled(0.0)})
        if self._is_double and parts:
            followed.split(_LITTLE_SHARE)
        return _or_growing(followed(1.0 if parts else 0.0), followed.modes(1.0))

    def _with_coupling(self, q: float) -> Modes:
        return self._modes([cross_coupling(self._node, q)])

    def _modes(self, parts: Sequence[LinearBearing], share: float = 1.0) -> Modes:
        added = tuple(_times(part, share) for part in parts)
        rotor = replace(self._rotor, parts=(*self._rotor.parts, *added))
        return modes(rotor, self._speed, count=_COUNT, contacts=self._contacts)

    def _threshold(self, expected: float) -> float | None:
        if self._coupled(0.0).real >= 0:
            return 0.0
        high = expected or 1e-3 * self.scale
        limit = max(SPAN * expected, 10 * self.scale)
        low = 0.0
        while self._coupled(high).real < 0 and not self._follow_growing(high):
            if high >= limit:
                return None
            low, high = high, 1.5 * high
        return float(brentq(lambda q: -self._coupled(q).real, low, high, rtol=1e-10))

    def _follow_growing(self, q: float) -> bool:
        """Whether another mode grows because of the cross coupling q, which is followed then."""
        growing = _or_growing(self._coupled(q), self._coupled.modes(q))
        if not growing.real > 0:
            return False
        before, self._coupled = self._coupled, _Followed(self._with_coupling, {q: growing})
        for smaller in sorted((k for k in before.known if k < q), reverse=True):
            self._coupled(smaller)
        return True


def _or_growing(root: complex, found: Modes) -> complex:
    """Return the eigenvalue, or, where it does not grow and others do, that of the least
    logarithmic decrement."""
    growing = _growing(found)
    return root if root.real > 0 or growing is None else complex(found.eigenvalues[growing])


def _growing(found: Modes) -> int | None:
    """Return the place of the mode of the least logarithmic decrement, if that is below 0."""
    roots = found.eigenvalues
    rates = np.where(
        roots.real > (_ROUNDING + found.residuals) * np.abs(roots), roots.real / roots.imag, 0.0
    )
    return int(np.argmax(rates)) if rates.any() else None


def _place(found: Modes) -> int:
    """Return the place of the mode of the rotor alone, before cross coupling is tried: without
    gyroscopic moments both circles of a mode are one, and neither is backward."""
    growing = _growing(found)
    if growing is not None:
        return growing
    places = [i for i, word in enumerate(found.whirl) if word != BACKWARD]
    if not places:
        raise LinearError(
            f"all of the {len(found.whirl)} lowest modes at {found.speed:g} rad/s whirl backward"
        )
    return places[0]


def _times(part: LinearBearing, share: float) -> LinearBearing:
    """Return a bearing with its coefficients times a share."""
    scaled: dict[str, Any] = {}
    for name in quantities(Coefficients):
        value = getattr(part, name)
        is_table = isinstance(value, tuple)
        scaled[name] = tuple(share * v for v in value) if is_table else share * value
    return replace(part, **scaled)
