"""Balancing of a machine by runs in time: as it is, with a trial unbalance in each correction
plane, and with the correction unbalances (ISO 21940-12); what unbalance is left, by ISO 21940-11
and API 617."""

import math
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from .api.machine import Machine
from .api.simulate import simulate
from .display import current, speed_with_unit
from .errors import InputError, RunFailed, check_positive, listed, numbers
from .linear.answers import modes
from .linear.displayed import Displayed, of_machine
from .linear.linear_plots import titled
from .linear.linear_tables import Table
from .model.linear.residual_unbalance import balance_quality_grade, tolerance_planes
from .model.linear.static import check_node
from .model.linear.supports import walls
from .model.linear.unbalance_placement import residual_unbalance
from .model.machine.rotor import Rotor
from .model.parts.port import Sensor
from .model.parts.unbalance import Unbalance
from .model.quantities import STANDARD_GRAVITY
from .model.settings.table import IN_STAGES
from .model.structure.assembly import assemble
from .model.structure.structure import total_mass
from .plotting.figure_style import BLUE, GREEN, GREY, ORANGE, annotate, entitle, new_figure
from .run_status import FAILED, on_numbers
from .vibration.influence_coefficients import correction, enough_measurements, once_per_turn

_SETTLED = 16.0  # time constants of the slowest mode until the motion is steady: 1e-7 of it is left
_LEAST_TURNS, _MOST_TURNS = 60, 4000
_MEASURED = 32  # turns at the end of a run, over which the vibration is measured
_ROWS = 64  # a turn
# Steps a turn at least: what is balanced rests, and in longer ones its sag would pass for 1x, all
# rows having the same angle.
_STEPS = 12
_TRIAL = 0.1  # of the rotor's weight, the force of all trial unbalances together
_TOLERANCE = 1e-5
_STEADY = 0.01  # of the initial vibration: what another one within a run may differ by
_UNSTEADY = "the vibration was not steady: another motion than that of the unbalance is in it"
_GROWS = 1e-9  # of its frequency: what grows less is a mode without damping

# Of how many runs are done, and of what the next one is.
ReportRun = Callable[[int, str], None]


class Vibration(NamedTuple):
    """Once-per-revolution vibration of a node (from 1) along an axis at a speed [rad/s], complex
    amplitudes 0-p [m] whose angles are measured from the shaft's mark: initial, expected after the
    correction, and in the run with it."""

    node: int
    axis: str
    speed: float
    initial: complex
    expected: complex
    corrected: complex


class CorrectionPlane(NamedTuple):
    """A correction plane: its node (from 1), the trial unbalance and the correction unbalance,
    complex [kg.m]."""

    node: int
    trial: complex
    unbalance: complex


class ResidualUnbalance(NamedTuple):
    """The unbalance of the rotor, taken as rigid, in the plane of a bearing, complex [kg.m]: its
    node (from 1), the mass that it bears [kg], initial and with the correction; the most that API
    617 permits [kg.m]; the balance quality grade that is met [mm/s], infinite where none is."""

    node: int
    mass: float
    initial: complex
    corrected: complex
    permitted: float
    grade: float


@dataclass(frozen=True)
class Balancing(Displayed):
    """A machine balanced by influence coefficients, m measurements and p planes.

    planes: with their unbalances; vibrations: at the measuring points; residuals: unbalances in the
    planes of the two outermost bearings, none where there are fewer; service_speed: for which they
    are permitted, the machine's maximum continuous or rated speed, or the highest of balancing;
    influence: coefficients, complex of shape (m, p) [m/(kg.m)]; rank: their numerical rank;
    touches: whether a contact closed during a run, so that the coefficients are not those of a
    linear machine; settles: whether the runs were long enough for the slowest mode; messages: what
    the runs say of their numbers, each once.
    """

    planes: tuple[CorrectionPlane, ...]
    vibrations: tuple[Vibration, ...]
    residuals: tuple[ResidualUnbalance, ...]
    service_speed: float
    influence: np.ndarray
    rank: int
    touches: bool
    settles: bool
    messages: tuple[str, ...]

    @property
    def residual(self) -> float:
        """The vibration in the run with the correction, as a share of the initial one [1], by their
        root mean squares."""
        before = np.array([v.initial for v in self.vibrations])
        after = np.array([v.corrected for v in self.vibrations])
        return float(np.linalg.norm(after) / np.linalg.norm(before))

    def table(self) -> Table:
        """Return a table with a row for each plane, for each bearing's plane, and for each
        measurement."""
        heads = (
            *("", "trial", "[deg]", "correction", "[deg]"),
            *("initial", "[deg]", "left", "expected", "API 617", "ISO 21940-11"),
        )
        d, unit = current(), current().amplitude_words
        planes = [
            (
                f"plane at node {p.node} [{d.unbalance_unit}]",
                *_polar(p.trial, d.unbalance),
                *_polar(p.unbalance, d.unbalance),
                *6 * ("",),
            )
            for p in self.planes
        ]
        left_in_planes = [
            (
                f"unbalance at bearing, node {r.node} [{d.unbalance_unit}]",
                *4 * ("",),
                *_polar(r.initial, d.unbalance),
                *(abs(r.corrected) * d.unbalance, "", r.permitted * d.unbalance),
                f"G {r.grade:g}" if math.isfinite(r.grade) else "none",
            )
            for r in self.residuals
        ]
        measured = [
            (
                f"node {v.node} {v.axis}, {speed_with_unit(v.speed)} [{unit}]",
                *4 * ("",),
                *_polar(v.initial, d.amplitude),
                abs(v.corrected) * d.amplitude,
                abs(v.expected) * d.amplitude,
                *2 * ("",),
            )
            for v in self.vibrations
        ]
        left = f"{100 * self.residual:.3g} % of the vibration is left"
        title = f"Balancing by influence coefficients: {left}"
        if self.residuals:
            title += f"; unbalances permitted at {speed_with_unit(self.service_speed)}"
        if self.rank < len(self.planes):
            title += (
                f"; the influence coefficients of {len(self.planes)} planes have rank {self.rank}: "
                "these are the smallest unbalances that do it"
            )
        if self.touches:
            title += "; a contact closed during a run: the coefficients are not a linear machine's"
        if not self.settles:
            title += f"; {_MOST_TURNS} turns are too few for the slowest mode to settle"
        title = "; ".join([title, *self.messages])
        return Table(title, heads, [*planes, *left_in_planes, *measured])

    def figure(self) -> Figure:
        """Draw the vibration before and after, in the complex plane."""
        figure, axes = new_figure(5.4, 5.2)
        d = current()
        axes.axhline(0, color=GREY, lw=0.8)
        axes.axvline(0, color=GREY, lw=0.8)
        for kind, label, color, mark in (
            ("initial", "initial", ORANGE, "o"),
            ("expected", "expected", GREEN, "x"),
            ("corrected", "with the correction", BLUE, "s"),
        ):
            values = np.array([getattr(v, kind) for v in self.vibrations]) * d.amplitude
            axes.plot(values.real, values.imag, mark, color=color, ms=6, mfc="none", label=label)
        for v in self.vibrations:
            at = v.initial * d.amplitude
            annotate(axes, f"{v.node}{v.axis}", (at.real, at.imag), (5, 4))
        axes.set_aspect("equal", adjustable="datalim")
        axes.margins(0.15)
        axes.set_xlabel(f"In phase with the mark [{d.amplitude_words}]")
        axes.set_ylabel(f"A quarter of a turn ahead of it [{d.amplitude_words}]")
        axes.legend(frameon=False, fontsize=8)
        entitle(axes, titled(self.machine_name, "1x vibration, its angle from the mark"))
        return figure


def _polar(value: complex, factor: float) -> tuple[float, float]:
    return abs(value) * factor, math.degrees(np.angle(value)) + 0.0  # no -0


def balance(
    rotor: Rotor,
    speeds: Sequence[float],
    planes: Sequence[int],
    *,
    measured: Sequence[int] | None = None,
    trial: float | None = None,
    report: ReportRun = lambda done, what: None,
) -> Balancing:
    """Balance a machine by influence coefficients, from runs in time.

    speeds: of balancing [rad/s], above 0; planes: nodes (from 1) of the correction planes;
    measured: nodes (from 1) at which x and y are measured, by default those of the planes; trial:
    unbalance of each plane [kg.m], by default all together pull with a tenth of the rotor's weight
    at the lowest balancing speed; report: called before each run. Raises `InputError` if a speed, a
    node or the trial unbalance cannot be, or the machine is unstable at a speed, `RunFailed` if a
    run stops before its end.
    """
    speeds, planes = numbers("speeds", speeds), listed("planes", planes, "nodes")
    nodes = planes if measured is None else listed("measured", measured, "nodes")
    planes, nodes = ([int(check_node(rotor, n)) for n in given] for given in (planes, nodes))
    for name, given in (("planes", planes), ("measured", nodes)):
        if len(set(given)) < len(given) or not given:
            raise InputError(f"{name}: {given}: must be different nodes, at least one")
    if len(set(speeds)) < len(speeds) or not speeds:
        raise InputError(f"speeds: {speeds} rad/s: must be different ones, at least one")
    enough_measurements(2 * len(nodes) * len(speeds), len(planes))
    for speed in speeds:
        check_positive("balancing speed", speed, "rad/s")
    if trial is None:
        pull = _TRIAL * total_mass(assemble(rotor)) * STANDARD_GRAVITY
        trial = pull / (len(planes) * min(speeds) ** 2)
    check_positive("trial unbalance", trial, "kg.m")
    if not assemble(rotor).unbalance.any():
        raise InputError("the machine has no unbalance: there is nothing to balance")
    own = rotor.operation
    service_speed = own.maximum_continuous_speed or own.rated_speed or max(speeds)
    bench, u = _Bench(rotor, speeds, nodes, report), complex(trial)
    initial = bench.vibration("as it is", {})
    trials = np.array([bench.vibration(f"trial unbalance at node {n}", {n: u}) for n in planes])
    found = correction(initial, trials, [u] * len(planes))
    corrections = dict(zip(planes, found.unbalances.tolist(), strict=True))
    corrected = bench.vibration("corrected", corrections)
    places = [(n, axis, s) for s in speeds for n in nodes for axis in "xy"]
    steady = bench.change < _STEADY * np.abs(initial).max()
    rows = zip(places, initial, found.expected, corrected, strict=True)
    result = Balancing(
        planes=tuple(CorrectionPlane(n, u, w) for n, w in corrections.items()),
        vibrations=tuple(Vibration(*row, *map(complex, seen)) for row, *seen in rows),
        residuals=_residuals(rotor, _with(rotor, corrections), service_speed),
        service_speed=service_speed,
        influence=found.influence,
        rank=found.rank,
        touches=bench.touches,
        settles=bench.settles,
        messages=(*bench.messages, *(() if steady else (_UNSTEADY,))),
    )
    return of_machine(result, rotor)


def _with(rotor: Rotor, unbalances: dict[int, complex]) -> Rotor:
    """Return the machine with further unbalances [kg.m] by node."""
    added = [Unbalance(n, abs(u), float(np.angle(u))) for n, u in unbalances.items()]
    return replace(rotor, parts=(*rotor.parts, *added))


def _residuals(before: Rotor, after: Rotor, speed: float) -> tuple[ResidualUnbalance, ...]:
    """Return what is left in the bearings' planes, at a service speed [rad/s]."""
    planes = zip(tolerance_planes(before), tolerance_planes(after), strict=True)
    return tuple(
        ResidualUnbalance(
            *(plane.node, plane.mass, initial.unbalance, plane.unbalance),
            permitted=residual_unbalance(plane.mass, speed),
            grade=balance_quality_grade(abs(plane.unbalance), plane.mass, speed),
        )
        for initial, plane in planes
    )


class _Bench:
    """A machine that is run at the balancing speeds and measured."""

    def __init__(
        self, rotor: Rotor, speeds: list[float], nodes: list[int], report: ReportRun
    ) -> None:
        self._speeds, self._nodes, self._report = speeds, nodes, report
        settling = [_settling(rotor, speed) for speed in speeds]
        self.settles = max(settling) <= _MOST_TURNS
        self._turns = [
            math.ceil(min(max(turns, _LEAST_TURNS), _MOST_TURNS)) + _MEASURED for turns in settling
        ]
        sensors = [Sensor(node, name=f"measured_{node}") for node in nodes]
        self._rotor = replace(rotor, parts=(*rotor.parts, *sensors))
        self._touching = [f"{name}.contact" for name in walls(rotor)]
        self._done, self.touches, self.messages = 0, False, dict[str, None]()
        self.change = 0.0  # between the halves of what was measured, at most [m]

    def vibration(self, what: str, unbalances: dict[int, complex]) -> np.ndarray:
        """Return the vibration with further unbalances [kg.m] by node, of each speed and node
        in x and y; what: they are, in words."""
        rotor = _with(self._rotor, unbalances)
        result = []
        for speed, turns in zip(self._speeds, self._turns, strict=True):
            self._report(self._done, f"{what}, {turns} turns at {speed_with_unit(speed)}")
            result.append(self._at(rotor, speed, turns))
            self._done += 1
        return np.concatenate(result)

    def _at(self, rotor: Rotor, speed: float, turns: int) -> np.ndarray:
        turn = 2 * math.pi / speed
        names = [f"measured_{node}.{axis}" for node in self._nodes for axis in "xy"]
        with warnings.catch_warnings(action="ignore"):
            result = simulate(
                Machine(rotor, ""),
                speed=speed,
                stop=turns * turn,
                tolerance=_TOLERANCE,
                parameters={"solver.method": IN_STAGES},  # many times fewer steps than others
                record=[*names, *self._touching],
                per_turn=_ROWS,
                step=turn / _STEPS,
            )
        self.messages |= dict.fromkeys(on_numbers(result.messages, result.codes))
        if result.status.startswith(FAILED):
            why = "; ".join([result.status, *self.messages])
            raise RunFailed(f"the run at {speed:g} rad/s {why}")
        phi = result["phi"]
        within = (phi > phi[-1] - 2 * math.pi * _MEASURED).nonzero()[0]
        self.touches |= any(bool((result[name][within] > 0.5).any()) for name in self._touching)
        halves = np.array_split(within, 2)
        first, last = (
            np.array([once_per_turn(phi[half], result[name][half]) for name in names])
            for half in halves
        )
        self.change = max(self.change, float(np.abs(last - first).max()))
        return (first + last) / 2


def _settling(rotor: Rotor, speed: float) -> float:
    """Return in how many turns a machine settles at a speed [rad/s], infinite without damping."""
    roots = modes(rotor, speed).eigenvalues
    growth = float(roots.real.max(initial=-math.inf))
    if growth > _GROWS * np.abs(roots).max(initial=0.0):
        raise InputError(
            f"balancing speed = {speed:g} rad/s: the machine is unstable there and does not settle "
            f"(a mode grows by {growth:.3g} 1/s)"
        )
    return _SETTLED / -growth * speed / (2 * math.pi) if growth < 0 else math.inf
