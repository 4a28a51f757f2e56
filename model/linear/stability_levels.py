"""Stability by API 617 and 684: level 1, the least logarithmic decrement of the forward modes over
a cross-coupled stiffness, and level 2, what each seal and the cross coupling do to it.

The cross coupling q that a stage brings follows from Alford's formula as API 617 changed it (7th
edition, part 1, 2.6.5; API 684, 2nd edition, chapter 3), in SI units

    q = B P / (Omega D H) (rho_d / rho_s),    B = 3,

with the power P [W], the speed Omega [rad/s], the impeller's diameter D and its discharge's width H
[m], and the densities at discharge and suction. It acts as F_x = -q y, F_y = q x. Level 1 puts the
sum QA of all stages at one node, midway between the bearings or, of an overhung rotor, at its
stage, and asks for a level 2 where the rotor becomes unstable at Q0 < 2 QA, or where its
logarithmic decrement with QA is below 0.1, and at Q0 < 10 QA where critical speed ratio and average
gas density lie in region B of the standard's plot. Level 2 asks for 0.1. The standard means the
first forward mode; both levels judge by the least of all forward ones and give both: see
`first_forward`.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..arguments import check_positive, mapped, number, numbers
from ..machine.rotor import Rotor
from ..parts.base import BodyElement
from ..parts.linear_bearing import LinearBearing, Seal
from .critical_map import first_rigid_critical
from .first_forward import SPAN, Pair, first_forward
from .linear_machine import LinearError
from .static import check_node
from .undamped import UndampedMachine, without_seals

LEAST_LOG_DEC = 0.1
LEAST_RATIO = 2.0
_CLEAR_RATIO = 10.0  # of Q0 / QA, from which on the gas density does not matter
ALFORD = 3.0
_POINTS = 41
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
    """The least logarithmic decrement of the forward modes over the cross coupling at one node.

    speed [rad/s]; node: from 1; anticipated: QA [N/m], 0 where none was given; stiffness, log_dec,
    frequency: shape (s,) [N/m], [1], [rad/s], of the mode of the least one; first_log_dec,
    first_frequency: alike, of the first forward mode; threshold: Q0, where the rotor becomes
    unstable [N/m], None where it does not; log_dec_alone, log_dec_anticipated: without and with QA;
    first_alone, first_anticipated: alike, of the first forward mode;
    sensitivity: of the logarithmic decrement to the cross coupling, at none [m/N], NaN where that
    is minus infinity, as it is of a motion that grows without oscillating;
    critical_speed_ratio: the speed over the first undamped critical speed on rigid supports [1].
    """

    speed: float
    node: int
    anticipated: float
    stiffness: np.ndarray
    log_dec: np.ndarray
    frequency: np.ndarray
    first_log_dec: np.ndarray
    first_frequency: np.ndarray
    threshold: float | None
    log_dec_alone: float
    log_dec_anticipated: float
    first_alone: float
    first_anticipated: float
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
        """Whether level 1 asks for a level 2, whatever the gas density."""
        return self.ratio < LEAST_RATIO or self.log_dec_anticipated < LEAST_LOG_DEC

    @property
    def depends_on_density(self) -> bool:
        """Whether level 1 asks for a level 2 where the average gas density lies in region B."""
        return not self.is_level_2_required and self.ratio < _CLEAR_RATIO


class StabilityCase(NamedTuple):
    """The forward modes with what `name` says on the rotor: log_dec, logarithmic decrement [1], and
    damped frequency [rad/s] of the one that has the least; first_log_dec, first_frequency: alike,
    of the first forward mode."""

    name: str
    log_dec: float
    frequency: float
    first_log_dec: float
    first_frequency: float


@dataclass(frozen=True)
class StabilityLevel2:
    """The forward modes at a speed [rad/s] with what acts on the rotor added: its cases, the last
    one with all."""

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
    anticipated: float | Mapping[int, float] = 0.0,
    stiffness: Sequence[float] | np.ndarray | None = None,
    seals: bool = False,
    contacts: str | None = None,
) -> StabilityLevel1:
    """Return the forward modes over the cross-coupled stiffness.

    speed: maximum continuous speed [rad/s], above 0; node: of the cross coupling (from 1), by
    default that in the middle between the bearings, or, where all stages (without stages, all
    bodies on the shaft) stand beyond the bearings, that of the largest; anticipated: QA, the cross
    coupling that is expected [N/m], or what each stage has of it by its node; stiffness: of the
    cross coupling [N/m], by default from 0 to the larger of 10 QA and 1.2 Q0; seals: whether the
    machine's seals act, which API 617 leaves out of level 1; contacts: `open` or `pinned`, by
    default open where the machine is held without them. Raises `LinearError` if the speed, the node
    or a stiffness cannot be, or the machine has no forward mode.
    """
    stages = anticipated if isinstance(anticipated, Mapping) else {}
    if isinstance(anticipated, Mapping):
        expected = _sum("anticipated", anticipated)
    else:
        expected = _coupling("anticipated", anticipated)
    check_positive("speed", speed, "rad/s", LinearError)
    bare = rotor if seals else without_seals(rotor)
    at = _stage_node(rotor, stages, contacts) if node is None else node
    _check_nodes(rotor, (at, *stages))
    mode = first_forward(bare, speed, {at: 1.0}, expected, contacts)
    threshold = mode.threshold
    if stiffness is None:
        end = max(SPAN * expected, 1.2 * (threshold or 0.0)) or mode.scale
        stiffness = np.linspace(0.0, end, _POINTS)
    values = np.array(numbers("stiffness", stiffness))
    if not np.isfinite(values).all():
        raise LinearError("stiffness: all cross-coupled stiffnesses must be finite")
    seen = [_case(f"{q:g} N/m", mode.coupled(float(q))) for q in values]
    step = _STEP * (expected or threshold or mode.scale)
    alone, little, with_qa = (_case("", mode.coupled(q)) for q in (0.0, step, expected))
    slope = (little.log_dec - alone.log_dec) / step
    return StabilityLevel1(
        speed=speed,
        node=at,
        anticipated=expected,
        stiffness=values,
        log_dec=np.array([case.log_dec for case in seen]),
        frequency=np.array([case.frequency for case in seen]),
        first_log_dec=np.array([case.first_log_dec for case in seen]),
        first_frequency=np.array([case.first_frequency for case in seen]),
        threshold=threshold,
        log_dec_alone=alone.log_dec,
        log_dec_anticipated=with_qa.log_dec,
        first_alone=alone.first_log_dec,
        first_anticipated=with_qa.first_log_dec,
        sensitivity=slope if math.isfinite(alone.log_dec) else math.nan,
        critical_speed_ratio=speed / first_rigid_critical(rotor, contacts),
    )


def level_2(
    rotor: Rotor,
    speed: float,
    *,
    cross_couplings: Mapping[int, float] | None = None,
    contacts: str | None = None,
) -> StabilityLevel2:
    """Return the forward modes of the rotor on its bearings, with each of its seals, with all of
    them, with the cross coupling of its stages, and with all together.

    cross_couplings: stiffness [N/m] by node (from 1), each at its own; speed, contacts: see
    `level_1`, whose modes these are. Raises `LinearError`.
    """
    bare = without_seals(rotor)
    seals = {where: part for where, part in rotor.named_parts() if isinstance(part, Seal)}
    given = mapped("cross_couplings", cross_couplings)
    total = _sum("cross_couplings", given)
    check_positive("speed", speed, "rad/s", LinearError)
    _check_nodes(rotor, given)
    variants: list[tuple[str, tuple[LinearBearing, ...], float]] = [("rotor and bearings", (), 0.0)]
    variants += [(f"with {name}", (seal,), 0.0) for name, seal in seals.items()]
    if len(seals) > 1:
        variants.append(("with all seals", tuple(seals.values()), 0.0))
    if given:
        variants.append(("with the cross coupling", (), total))
    if given and seals:
        variants.append(("with all", tuple(seals.values()), total))
    shares = {node: q / total for node, q in given.items() if total}
    shares = shares or {_stage_node(rotor, {}, contacts): 1.0}
    mode = first_forward(bare, speed, shares, total, contacts)
    cases = (_case(name, mode.with_parts(parts, q)) for name, parts, q in variants)
    return StabilityLevel2(speed, tuple(cases))


def log_dec(root: complex) -> float:
    """Return the logarithmic decrement of an eigenvalue [1/s]; -infinity of a real growing one."""
    return -2 * math.pi * root.real / root.imag if root.imag else -math.inf


def _case(name: str, pair: Pair) -> StabilityCase:
    least, first = pair.least, pair.first
    return StabilityCase(name, log_dec(least), least.imag, log_dec(first), first.imag)


def _check_nodes(rotor: Rotor, nodes: Iterable[int]) -> None:
    for node in nodes:
        check_node(rotor, node)


def _stage_node(rotor: Rotor, stages: Mapping[int, float], contacts: str | None) -> int:
    """Return the node (from 1) where the cross coupling of all stages is put: see `level_1`."""
    z = rotor.nodes
    bearings = UndampedMachine(rotor, contacts, rigid_pedestals=False).bearings
    held = [z[part.node - 1] for part in bearings.values()]  # type: ignore[attr-defined]
    _check_nodes(rotor, stages)
    on_shaft = dict(stages) or _bodies(rotor)
    if on_shaft and not any(min(held) <= z[node - 1] <= max(held) for node in on_shaft):
        return max(on_shaft, key=lambda node: on_shaft[node])
    middle = (min(held) + max(held)) / 2
    return 1 + min(range(len(z)), key=lambda i: abs(z[i] - middle))


def _bodies(rotor: Rotor) -> dict[int, float]:
    """Return the mass [kg] of the bodies on each node (from 1)."""
    result: dict[int, float] = {}
    for _, body in rotor.elements_of_kind(BodyElement):
        result[body.node] = result.get(body.node, 0.0) + body.mass
    return result


def _sum(name: str, stages: Mapping[int, float]) -> float:
    """Return the sum of an argument's cross couplings by node [N/m]."""
    return sum(_coupling(f"{name}: {node}", q) for node, q in stages.items())


def _coupling(name: str, value: float) -> float:
    """Return a cross coupling [N/m]; `InputError` for no number, `LinearError` for one below 0."""
    result = number(name, value)
    if not 0 <= result < math.inf:
        raise LinearError(f"{name} = {result:g} N/m: must be >= 0 and finite")
    return result
