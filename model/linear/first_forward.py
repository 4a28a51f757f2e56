"""The modes that stability by API 617 is about, at both levels: the first forward one, and of all
forward ones that of the least logarithmic decrement, which the verdict is about.

The standard asks for the first forward mode. What that is where modes are nearly planar, as on
bearings that differ in x and y, their sense of whirl does not say: a little cross coupling turns
it. And a rotor is not stable because one of its modes is. So:

1. The first forward mode of the rotor on its bearings alone is the lowest mode that does not whirl
   backward and is not heavily damped. Where that and its neighbour are nearly planar, it is the one
   of both that cross coupling makes grow first.
2. It is followed by its eigenvalue while seals and cross coupling are added.
3. The verdict is about the least logarithmic decrement of it, of the modes up to twice the speed
   that do not clearly whirl backward, and of all of the lowest modes that grow, of those that
   something holds. What grows without oscillating, as with a negative stiffness, is unstable
   whatever these are.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache, lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..machine.rotor import Rotor
from ..parts.linear_bearing import Coefficients, LinearBearing
from ..quantities import quantities
from ..structure.assembly import assemble
from ..structure.structure import total_mass
from .linear_machine import LinearMachine, shared_machine
from .modes import BACKWARD, FORWARD, Modes, modes_of, modes_up_to
from .system_at_speed import Linear, LinearError

SPAN = 10.0  # of the cross coupling that is expected: as far as a growing mode is looked for
_COUNT = 12  # modes looked at, at least: those that are heavily damped are among the lowest
_HEAVY = 0.5  # damping ratio from which a mode is not the first forward one while there are others
_HIGHEST = 2.0  # of the speed: modes above are not driven by what turns more slowly than the rotor
_HALVINGS = 6
_IN_DOUBT = 0.5  # of forwardness: what whirls less clearly, a little cross coupling may turn
_LITTLE = 1e-6  # of the rotor's mass times its frequency squared
_LITTLE_SHARE = 1e-3  # of parts, whose cross coupling may be a small part of what they are
_ROUNDING = 1e-9  # of an eigenvalue, beside its residual: a real part that says nothing


class Pair(NamedTuple):
    """Eigenvalues [1/s] of the first forward mode, and of the mode of the least logarithmic
    decrement: a real one where a motion grows without oscillating."""

    first: complex
    least: complex


class _Followed:
    """An eigenvalue [1/s] over an amount of what is added, followed from amount to amount.

    modes: all modes with an amount; known: eigenvalues by their amounts.
    """

    def __init__(self, modes: Callable[[float], Modes], known: dict[float, complex]) -> None:
        self.modes, self.known = cache(modes), known

    def __call__(self, amount: float) -> complex:
        if amount not in self.known:
            known = [k for k in self.known if k > 0 or len(self.known) == 1]
            self.known[amount] = self._onward(min(known, key=lambda k: abs(k - amount)), amount)
        return self.known[amount]

    def _onward(self, start: float, end: float, depth: int = 0) -> complex:
        """Go on by steps that leave no doubt which eigenvalue it is."""
        expected, found = self.known[start], self.modes(end).eigenvalues
        if len(found) == 0:
            raise LinearError(
                f"no oscillating mode is left when {end:.0%} of the coupling is applied"
            )
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
    """The first forward mode of a rotor on its bearings at a speed, and that of the least
    logarithmic decrement, alone and with what is added.

    Cross coupling acts about the equilibrium without it: it is none of a part that would carry.
    scale: the rotor's mass times the mode's natural frequency squared [N/m]; threshold: cross
    coupling from which the rotor is unstable [N/m], None where there is none up to ten times the
    one that is expected and ten times `scale`.
    """

    def __init__(
        self,
        machine: LinearMachine,
        rotor: Rotor,
        speed: float,
        shares: Sequence[tuple[int, float]],
        expected: float,
    ) -> None:
        """Find the mode; machine: of the rotor; shares: of cross coupling [1], each with its node
        (from 1); expected: as much of it [N/m], or 0. Raises `LinearError` where no mode can be
        it."""
        self._rotor, self._speed, self._shares = rotor, speed, shares
        self._machine, alone = machine, machine.at(speed)
        first = modes_up_to(machine, alone, _HIGHEST * abs(speed), _COUNT)
        self._count = max(_COUNT, len(first.eigenvalues))
        at = _place(first)
        self._is_double = bool(first.is_degenerate[at])
        self.scale = total_mass(assemble(rotor)) * float(first.natural[at]) ** 2
        of_coupling = partial(self._modes, machine, alone)
        self._coupled = _Followed(of_coupling, {0.0: complex(first.eigenvalues[at])})
        if self._is_double:
            self._coupled.split(_LITTLE * self.scale)
        driven, self.threshold = self._threshold(expected)
        if self.threshold and _is_other_of_pair(first, at, driven(0.0)):
            self._coupled = driven

    def coupled(self, q: float) -> Pair:
        """Return the two modes with a cross coupling [N/m]."""
        return _pair(self._coupled, q)

    def with_parts(self, parts: Sequence[LinearBearing], q: float = 0.0) -> Pair:
        """Return the two modes with further bearings and seals, and a cross coupling [N/m]."""
        if not parts:
            return self.coupled(q)

        def find(share: float) -> Modes:
            added = tuple(_times(part, share) for part in parts)
            rotor = replace(self._rotor, parts=(*self._rotor.parts, *added))
            machine = LinearMachine(rotor, self._machine.contacts)
            return self._modes(machine, machine.at(self._speed), share * q)

        followed = _Followed(find, {0.0: self._coupled(0.0)})
        if self._is_double:
            followed.split(_LITTLE_SHARE)
        return _pair(followed, 1.0)

    def _modes(self, machine: LinearMachine, linear: Linear, q: float) -> Modes:
        added = machine.cross_coupling({node: q * share for node, share in self._shares})
        return modes_of(machine, linear._replace(own_K=linear.own_K + added), self._count)

    def _threshold(self, expected: float) -> tuple[_Followed, float | None]:
        """Return the first mode that grows over the cross coupling, and from where on."""
        if self.coupled(0.0).least.real >= 0:
            return self._coupled, 0.0
        high = expected or 1e-3 * self.scale
        limit = max(SPAN * expected, 10 * self.scale)
        low = 0.0
        while not self.coupled(high).least.real > 0:
            if high >= limit:
                return self._coupled, None
            low, high = high, 1.5 * high
        at = float(brentq(lambda q: -self.coupled(q).least.real, low, high, rtol=1e-10))
        if self.coupled(high).least.imag == 0.0:
            return self._coupled, at
        driven = _Followed(self._coupled.modes, {high: self.coupled(high).least})
        for smaller in sorted((k for k in self._coupled.known if k < high), reverse=True):
            driven(smaller)
        return driven, at


def first_forward(
    rotor: Rotor, speed: float, shares: Mapping[int, float], expected: float, contacts: str | None
) -> FirstForward:
    """Return a rotor's first forward mode; both levels of a check ask for the same one."""
    machine = shared_machine(rotor, contacts)
    return _first_forward(machine, rotor, float(speed), tuple(shares.items()), expected)


_first_forward = lru_cache(maxsize=2)(FirstForward)


def _is_other_of_pair(found: Modes, place: int, root: complex) -> bool:
    """Whether an eigenvalue is that of the mode beside the one at a place, where both are so nearly
    planar that their sense of whirl is in doubt."""
    doubtful = np.abs(found.forwardness) < _IN_DOUBT
    others = np.flatnonzero(doubtful & (np.arange(len(doubtful)) != place))
    if not doubtful[place] or not len(others):
        return False
    near = others[np.argmin(np.abs(found.damped[others] - found.damped[place]))]
    return int(np.argmin(np.abs(found.eigenvalues - root))) == near


def _pair(followed: _Followed, amount: float) -> Pair:
    """Return the first forward mode, which is followed, and that of the least decrement."""
    first, found = followed(amount), followed.modes(amount)
    roots = found.eigenvalues
    grows = roots.real > (_ROUNDING + found.residuals) * np.abs(roots)
    is_low = roots.imag <= _HIGHEST * abs(found.speed)
    counts = grows | (is_low & (found.forwardness > -_IN_DOUBT))
    if len(found.growing):
        return Pair(first, complex(found.growing[0]))
    return Pair(first, max((first, *roots[counts].tolist()), key=lambda r: r.real / r.imag))


def _place(found: Modes) -> int:
    """Return the place of the mode of the rotor alone, before cross coupling is tried: without
    gyroscopic moments both circles of a mode are one, and neither is backward."""
    is_backward = found.forwardness <= -_IN_DOUBT  # as a whole, though some nodes whirl forward
    places = [i for i, word in enumerate(found.whirl) if word != BACKWARD and not is_backward[i]]
    if not places:
        raise LinearError(
            f"all of the {len(found.whirl)} lowest modes at {found.speed:g} rad/s whirl backward"
        )
    return next((i for i in places if found.damping_ratio[i] < _HEAVY), places[0])


def _times(part: LinearBearing, share: float) -> LinearBearing:
    """Return a bearing with its coefficients and its added mass times a share."""
    scaled: dict[str, Any] = {}
    for name in (*quantities(Coefficients), "added_mass"):
        value = getattr(part, name)
        is_table = isinstance(value, tuple)
        scaled[name] = tuple(share * v for v in value) if is_table else share * value
    return replace(part, **scaled)
