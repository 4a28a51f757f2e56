"""Stability by API 617 and 684: level 1, the logarithmic decrement of the first forward mode over a
cross-coupled stiffness, and level 2, what each seal and the cross coupling do to it.

The cross coupling q that a stage brings follows from Alford's formula as API 617 changed it (7th
edition, part 1, 2.6.5; API 684, 2nd edition, chapter 3), in SI units

    q = B P / (Omega D H) (rho_d / rho_s),    B = 3,

with the power P [W], the speed Omega [rad/s], the impeller's diameter D and its discharge's width H
[m], and the densities at discharge and suction. It acts as F_x = -q y, F_y = q x. Level 1 puts the
sum QA of all stages at one node and asks for a level 2 where the rotor becomes unstable at
Q0 < 2 QA, or where its logarithmic decrement with QA is below 0.1. Level 2 asks for 0.1.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from ..machine.rotor import Rotor
from ..parts.base import Part
from ..parts.linear_bearing import LinearBearing, Seal
from ..structure.assembly import assemble
from .critical_map import first_rigid_critical
from .machine import LinearError
from .modes import BACKWARD, FORWARD, Modes, modes
from .undamped import UndampedMachine

LEAST_LOG_DEC = 0.1
LEAST_RATIO = 2.0
ALFORD = 3.0
_SPAN = 10.0  # of QA: as far as level 1 looks for Q0
_POINTS = 41
_COUNT = 8
_HALVINGS = 6
_LITTLE = 1e-6  # of the rotor's mass times its frequency squared
_STEP = 1e-4  # of QA or of Q0, for the sensitivity


class Stage(NamedTuple):
    """An impeller: node (from 1), power [W], diameter [m], width of the discharge [m], density at
    the discharge over that at the suction [1]."""

    node: int
    power: float
    diameter: float
    width: float
    density_ratio: float

    def cross_coupling(self, speed: float) -> float:
        """Return the cross-coupled stiffness [N/m] at a speed [rad/s]."""
        return ALFORD * self.power / (speed * self.diameter * self.width) * self.density_ratio


@dataclass(frozen=True)
class StabilityLevel1:
    """The logarithmic decrement of the first forward mode over the cross coupling at one node.

    speed [rad/s]; node: from 1; anticipated: QA [N/m], 0 where none was given; stiffness, log_dec,
    frequency: shape (s,) [N/m], [1], [rad/s]; threshold: Q0, where the mode becomes unstable
    [N/m], None where it does not; log_dec_alone, log_dec_anticipated: without and with QA;
    sensitivity: of the logarithmic decrement to the cross coupling, at none [m/N];
    critical_speed_ratio: the speed over the first undamped critical speed on rigid bearings [1].
    """

    speed: float
    node: int
    anticipated: float
    stiffness: np.ndarray
    log_dec: np.ndarray
    frequency: np.ndarray
    threshold: float | None
    log_dec_alone: float
    log_dec_anticipated: float
    sensitivity: float
    critical_speed_ratio: float

    @property
    def ratio(self) -> float:
        """Q0 / QA, infinite where one of them is not there [1]."""
        if self.threshold is None or self.anticipated == 0.0:
            return math.inf
        return self.threshold / self.anticipated

    @property
    def is_level_2_required(self) -> bool:
        """Whether level 1 asks for a level 2."""
        return self.ratio < LEAST_RATIO or self.log_dec_anticipated < LEAST_LOG_DEC


class StabilityCase(NamedTuple):
    """What is on the rotor, and its first forward mode: logarithmic decrement [1] and damped
    frequency [rad/s]."""

    name: str
    log_dec: float
    frequency: float


@dataclass(frozen=True)
class StabilityLevel2:
    """The first forward mode at a speed [rad/s] with what acts on the rotor added: its cases, the
    last one with all."""

    speed: float
    cases: tuple[StabilityCase, ...]

    @property
    def is_met(self) -> bool:
        """Whether the logarithmic decrement with all is at least 0.1."""
        return self.cases[-1].log_dec >= LEAST_LOG_DEC


def level_1(
    rotor: Rotor,
    speed: float,
    *,
    node: int | None = None,
    anticipated: float = 0.0,
    stiffness: Sequence[float] | np.ndarray | None = None,
    seals: bool = False,
    contacts: str | None = None,
) -> StabilityLevel1:
    """Return the first forward mode over the cross-coupled stiffness.

    Parameters
    ----------
    rotor : Rotor
        The machine.
    speed : float
        Maximum continuous speed [rad/s], above 0.
    node : int, optional
        Node (from 1) of the cross coupling. By default that in the middle between the bearings.
    anticipated : float
        QA, the cross coupling that is expected [N/m].
    stiffness : sequence of float, optional
        Cross-coupled stiffnesses [N/m]. By default from 0 to the larger of 10 QA and 1.2 Q0.
    seals : bool
        Whether the machine's seals act; API 617 leaves them out of level 1.
    contacts : str, optional
        `open` or `pinned`. By default open where the machine is held without them.

    Returns
    -------
    StabilityLevel1
        The curve, Q0 and the sensitivity.

    Raises
    ------
    LinearError
        If the speed, the node or a stiffness cannot be, or the machine has no forward mode.
    """
    _check(speed, anticipated)
    bare = rotor if seals else without_seals(rotor)
    at = middle_node(rotor, speed, contacts) if node is None else node
    if not 1 <= at <= len(rotor.nodes):
        raise LinearError(f"node = {at}: must be from 1 to {len(rotor.nodes)}")
    follow = _FirstForward(bare, speed, at, contacts)
    threshold = follow.threshold(anticipated)
    if stiffness is None:
        end = max(_SPAN * anticipated, 1.2 * (threshold or 0.0)) or follow.scale
        stiffness = np.linspace(0.0, end, _POINTS)
    values = np.array(stiffness, dtype=float)
    if not np.isfinite(values).all():
        raise LinearError("stiffness: all cross-coupled stiffnesses must be finite")
    seen = [follow(float(q)) for q in values]
    step = _STEP * (anticipated or threshold or follow.scale)
    rise = (follow(step).log_dec - follow(0.0).log_dec) / step
    return StabilityLevel1(
        speed=speed,
        node=at,
        anticipated=anticipated,
        stiffness=values,
        log_dec=np.array([case.log_dec for case in seen]),
        frequency=np.array([case.frequency for case in seen]),
        threshold=threshold,
        log_dec_alone=follow(0.0).log_dec,
        log_dec_anticipated=follow(anticipated).log_dec,
        sensitivity=rise,
        critical_speed_ratio=speed / first_rigid_critical(rotor, contacts),
    )


def level_2(
    rotor: Rotor,
    speed: float,
    *,
    cross_couplings: Mapping[int, float] | None = None,
    contacts: str | None = None,
) -> StabilityLevel2:
    """Return the first forward mode of the rotor on its bearings, with each of its seals, with all
    of them, with the cross coupling of its stages, and with all together.

    cross_couplings: stiffness [N/m] by node (from 1); speed, contacts: see `level_1`. Raises
    `LinearError`.
    """
    _check(speed, 0.0)
    bare = without_seals(rotor)
    seals = {where: part for where, part in rotor.named_parts() if isinstance(part, Seal)}
    coupled = tuple(_coupling(node, q) for node, q in (cross_couplings or {}).items())
    for node in cross_couplings or {}:
        if not 1 <= node <= len(rotor.nodes):
            raise LinearError(f"node = {node}: must be from 1 to {len(rotor.nodes)}")
    variants: list[tuple[str, tuple[Part, ...]]] = [("rotor and bearings", ())]
    variants += [(f"with {name}", (seal,)) for name, seal in seals.items()]
    if len(seals) > 1:
        variants.append(("with all seals", tuple(seals.values())))
    if coupled:
        variants.append(("with the cross coupling", coupled))
    if coupled and seals:
        variants.append(("with all", (*seals.values(), *coupled)))
    cases = [
        StabilityCase(
            name, *_first_forward(replace(bare, parts=bare.parts + more), speed, contacts)
        )
        for name, more in variants
    ]
    return StabilityLevel2(speed, tuple(cases))


def without_seals(rotor: Rotor) -> Rotor:
    """Return the machine without its seals."""
    return replace(rotor, parts=tuple(p for p in rotor.parts if not isinstance(p, Seal)))


def middle_node(rotor: Rotor, speed: float, contacts: str | None = None) -> int:
    """Return the node (from 1) nearest to the middle between the outer bearings."""
    bearings = UndampedMachine(rotor, contacts, rigid_pedestals=False).bearings
    z = [rotor.nodes[part.node - 1] for part in bearings.values()]  # type: ignore[attr-defined]
    middle = (min(z) + max(z)) / 2
    return 1 + min(range(len(rotor.nodes)), key=lambda i: abs(rotor.nodes[i] - middle))


def _check(speed: float, anticipated: float) -> None:
    if not (math.isfinite(speed) and speed > 0):
        raise LinearError(f"speed = {speed:g} rad/s: must be > 0 and finite")
    if not (math.isfinite(anticipated) and anticipated >= 0):
        raise LinearError(f"anticipated cross coupling = {anticipated:g} N/m: must be >= 0")


def _coupling(node: int, q: float) -> LinearBearing:
    return LinearBearing(node=node, kxx=0.0, kyy=0.0, kxy=q, kyx=-q, cxx=0.0, cyy=0.0)


def _first_forward(rotor: Rotor, speed: float, contacts: str | None) -> tuple[float, float]:
    result = modes(rotor, speed, count=_COUNT, contacts=contacts)
    at = _forward_place(result)
    return float(result.log_dec[at]), float(result.damped[at])


def _forward_place(result: Modes) -> int:
    """Return the place of the lowest mode that does not whirl backward: without gyroscopic moments
    both circles of a mode are one."""
    places = [i for i, word in enumerate(result.whirl) if word != BACKWARD]
    if not places:
        raise LinearError(
            f"all of the {len(result.whirl)} lowest modes at {result.speed:g} rad/s whirl backward"
        )
    return places[0]


class _FirstForward:
    """The first forward mode over the cross coupling at a node: the mode that is the lowest forward
    one without it, followed by its eigenvalue, since cross coupling changes a mode's whirl.

    On bearings that differ in x and y the modes are nearly planar without cross coupling, and their
    sense says little: where it makes another mode grow first, that mode is the one followed.
    """

    def __init__(self, rotor: Rotor, speed: float, node: int, contacts: str | None) -> None:
        self._rotor, self._speed, self._node = rotor, speed, node
        first = modes(rotor, speed, count=_COUNT, contacts=contacts)
        self._contacts = first.contacts
        self._growing_alone = int((first.eigenvalues.real > 0).sum())
        at = _forward_place(first)
        self._known = {0.0: complex(first.eigenvalues[at])}
        mass = float(sum(_masses(rotor)))
        self.scale = mass * float(first.natural[at]) ** 2
        if first.is_degenerate[at]:
            self._split(complex(first.eigenvalues[at]))

    def _split(self, both: complex) -> None:
        """Tell the forward mode from the backward one, which have the same eigenvalue, by a little
        cross coupling."""
        little = _LITTLE * self.scale
        found = modes(self._with(little), self._speed, count=_COUNT, contacts=self._contacts)
        forward = [i for i, word in enumerate(found.whirl) if word == FORWARD]
        roots = found.eigenvalues[forward or slice(None)]
        self._known[little] = complex(roots[np.argmin(np.abs(roots - both))])

    def _with(self, q: float) -> Rotor:
        return replace(self._rotor, parts=(*self._rotor.parts, _coupling(self._node, q)))

    def _roots(self, q: float) -> np.ndarray:
        rotor = self._with(q)
        return modes(rotor, self._speed, count=_COUNT, contacts=self._contacts).eigenvalues

    def __call__(self, q: float) -> StabilityCase:
        """Return the mode with the cross coupling q [N/m]."""
        if q not in self._known:
            # from the nearest one that is known, by steps that leave no doubt which it is
            known = [k for k in self._known if k > 0 or len(self._known) == 1]
            self._known[q] = self._onward(min(known, key=lambda k: abs(k - q)), q)
        root = self._known[q]
        return StabilityCase(f"{q:g} N/m", -2 * math.pi * root.real / root.imag, root.imag)

    def _onward(self, start: float, end: float, depth: int = 0) -> complex:
        expected = self._known[start]
        found = self._roots(end)
        away = np.sort(np.abs(found - expected))
        if len(found) == 0:
            raise LinearError(f"no mode oscillates with a cross coupling of {end:g} N/m")
        if depth < _HALVINGS and len(away) > 1 and 3 * away[0] > away[1]:
            middle = (start + end) / 2
            self._known[middle] = self._onward(start, middle, depth + 1)
            return self._onward(middle, end, depth + 1)
        return complex(found[np.argmin(np.abs(found - expected))])

    def threshold(self, anticipated: float) -> float | None:
        """Return the cross coupling from which the mode grows [N/m]; None where it does not up to
        10 QA, or, without QA, up to the rotor's mass times the frequency squared."""
        if self(0.0).log_dec <= 0:
            return 0.0
        high = anticipated or 1e-3 * self.scale
        limit = max(_SPAN * anticipated, 10 * self.scale)
        low = 0.0
        while self(high).log_dec > 0 and not self._follow_growing(high):
            if high >= limit:
                return None
            low, high = high, 1.5 * high
        return float(brentq(lambda q: self(q).log_dec, low, high, rtol=1e-10))

    def _follow_growing(self, q: float) -> bool:
        """Whether another mode grows because of the cross coupling q, which is followed then."""
        roots = self._roots(q)
        if int((roots.real > 0).sum()) <= self._growing_alone:
            return False
        before, self._known = self._known, {q: complex(roots[np.argmax(roots.real)])}
        for smaller in sorted((k for k in before if k < q), reverse=True):
            self(smaller)
        return True


def _masses(rotor: Rotor) -> np.ndarray:
    return assemble(rotor).mass_sum[::2]
