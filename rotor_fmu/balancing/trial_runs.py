"""Balancing of a machine by runs in time: as it is, with a trial unbalance in each correction
plane, and with the correction unbalances (ISO 21940-12)."""

import math
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..api.machine import Machine
from ..api.simulate import plan
from ..display import speed_with_unit
from ..errors import InputError, RunFailed, check_positive, listed, numbers
from ..linear.answers import modes
from ..linear.displayed import of_machine
from ..model.linear.modes import DEFAULT_COUNT, LEAST_GROWTH, count_up_to
from ..model.linear.residual_unbalance import balance_quality_grade, tolerance_planes
from ..model.linear.static import check_node
from ..model.linear.subsynchronous import subsynchronous_whirl
from ..model.linear.supports import touching
from ..model.linear.unbalance import steady_whirl
from ..model.linear.unbalance_placement import residual_unbalance
from ..model.machine.rotor import Rotor
from ..model.parts.port import Sensor
from ..model.parts.unbalance import Unbalance
from ..model.quantities import STANDARD_GRAVITY, check_size
from ..model.settings.table import IN_STAGES
from ..model.structure.assembly import assemble
from ..model.structure.structure import total_mass
from ..model.time_loop.recorder import Record
from ..run_status import has_failed, on_numbers
from ..runs.progress import steps
from ..runs.run_down import RECORDER_ROWS, run_recorded
from ..vibration.influence_coefficients import correction, enough_measurements, once_per_turn
from .result import Balancing, CorrectionPlane, ResidualUnbalance, Vibration

_SETTLED = 16.0  # time constants of the slowest mode until the motion is steady: 1e-7 of it is left
_LEAST_TURNS, _MOST_TURNS = 60, 4000
_MEASURED = 32  # turns at the end of a run, over which the vibration is measured
_ROWS = 64  # a turn
_TRIAL = 0.1  # of the rotor's weight, the force of all trial unbalances together
_TOLERANCE = 1e-5
_STEADY = 0.01  # of the initial vibration: what another one within a run may differ by
_UNSTEADY = "the vibration was not steady: another motion than that of the unbalance is in it"

# Of the share of a run that is done, and of what gives its steps and what limits them, in words.
ReportShare = Callable[[float, Callable[[], str]], None]
# Of how many runs are done, and of what the next one is; returns what is told how far that one is.
ReportRun = Callable[[int, str], ReportShare | None]


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

    speeds: of balancing [rad/s], of either sense of rotation; planes: nodes (from 1) of the
    correction planes; measured: nodes (from 1) at which x and y are measured, by default those of
    the planes; trial: unbalance of each plane [kg.m], by default all together pull with a tenth of
    the rotor's weight at the slowest balancing speed; report: called before each run, returns what
    is called during it. Raises `InputError` if a speed, a node or the trial unbalance cannot be, or
    the machine is unstable at a speed, `RunFailed` if a run stops before its end.
    """
    speeds, planes = numbers("speeds", speeds), listed("planes", planes, "nodes")
    nodes = planes if measured is None else listed("measured", measured, "nodes")
    planes, nodes = ([int(check_node(rotor, n)) for n in given] for given in (planes, nodes))
    for name, given in (("planes", planes), ("measured", nodes)):
        if len(set(given)) < len(given) or not given:
            raise InputError(f"{name}: {given}: must be different nodes, at least one")
    if len(set(speeds)) < len(speeds) or not speeds:
        given_speeds = ", ".join(f"{speed:g}" for speed in speeds)
        raise InputError(f"speeds: {given_speeds} rad/s: must be different ones, at least one")
    enough_measurements(2 * len(nodes) * len(speeds), len(planes))
    for speed in speeds:
        if speed**2 == 0.0 or not math.isfinite(speed):  # by which it is divided
            raise InputError(f"balancing speed = {speed:g} rad/s: must be finite and not 0")
    if trial is None:
        pull = _TRIAL * total_mass(assemble(rotor)) * STANDARD_GRAVITY
        trial = pull / (len(planes) * min(map(abs, speeds)) ** 2)
    check_positive("trial unbalance", trial, "kg.m")
    check_size(f"trial unbalance = {trial:g} kg.m", trial)
    if not steady_whirl(rotor).is_driven:  # those that cancel each other are none
        raise InputError("the machine has no unbalance: there is nothing to balance")
    service_speed = rotor.operation.service_speed or max(map(abs, speeds))
    bench, u = _Bench(rotor, speeds, nodes, report), complex(trial)
    initial = bench.vibration("as it is", {})
    trials = np.array([bench.vibration(f"trial unbalance at node {n}", {n: u}) for n in planes])
    found = correction(initial, trials, [u] * len(planes))
    corrections = dict(zip(planes, found.unbalances.tolist(), strict=True))
    corrected = bench.vibration("corrected", corrections)
    places = [(n, axis, s) for s in speeds for n in nodes for axis in "xy"]
    messages = list(bench.messages)
    if bench.change >= _STEADY * np.abs(initial).max():
        messages.append(_UNSTEADY)
    if not bench.settles:
        messages.append(f"{_MOST_TURNS} turns are too few for the slowest mode to settle")
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
        messages=tuple(messages),
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
            grade=balance_quality_grade(abs(plane.unbalance), plane.graded_mass, speed),
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
        self._touching = [
            f"{name}.{'fn_peak' if element.law.has_wall else 'contact'}"
            for name, element in touching(rotor).items()
        ]
        self._done, self.touches, self.messages = 0, False, dict[str, None]()
        self.change = 0.0  # between the halves of what was measured, at most [m]

    def vibration(self, what: str, unbalances: dict[int, complex]) -> np.ndarray:
        """Return the vibration with further unbalances [kg.m] by node, of each speed and node
        in x and y; what: they are, in words."""
        rotor = _with(self._rotor, unbalances)
        result = []
        for speed, turns in zip(self._speeds, self._turns, strict=True):
            words = f"{what}, {turns} turns at {speed_with_unit(speed)}"
            result.append(self._at(rotor, speed, turns, self._report(self._done, words)))
            self._done += 1
        return np.concatenate(result)

    def _at(self, rotor: Rotor, speed: float, turns: int, share: ReportShare | None) -> np.ndarray:
        turn = 2 * math.pi / abs(speed)
        names = [f"measured_{node}.{axis}" for node in self._nodes for axis in "xy"]
        record = Record((*names, *self._touching), 2 * math.pi / _ROWS, RECORDER_ROWS)
        many = {"solver.method": IN_STAGES}  # many times fewer steps than others
        with warnings.catch_warnings(action="ignore"):
            job = plan(Machine(rotor, ""), speed, None, turns * turn, None, _TOLERANCE, many, turn)

        def progress(t: float, observe: Callable[[], Mapping[str, float]]) -> None:
            if share:
                share(t / job.stop, lambda: steps(observe(), job.step, job.settings))

        run, result = run_recorded(job, record, progress, is_silent=True)
        self.messages |= dict.fromkeys(on_numbers(run.messages, (m.code for m in run.messages)))
        if has_failed(run.status):
            why = "; ".join([run.status, *self.messages])
            raise RunFailed(f"the run at {speed:g} rad/s {why}")
        phi, columns = result.phi, result.columns
        within = (np.abs(phi - phi[-1]) < 2 * math.pi * _MEASURED).nonzero()[0]
        self.touches |= any(bool((columns[name][within] > 0.0).any()) for name in self._touching)
        halves = np.array_split(within, 2)
        first, last = (
            np.array([once_per_turn(phi[half], columns[name][half]) for name in names])
            for half in halves
        )
        self.change = max(self.change, float(np.abs(last - first).max()))
        return (first + last) / 2


def _settling(rotor: Rotor, speed: float) -> float:
    """Return in how many turns a machine settles at a speed [rad/s], infinite without damping."""
    count = count_up_to(rotor, speed, DEFAULT_COUNT)
    found, in_pads = modes(rotor, speed, count=count), subsynchronous_whirl(rotor, speed)
    of_pads = [in_pads.growth] if in_pads else []
    roots = [*found.eigenvalues.real, *found.decays, *of_pads, *([] if found.is_held else [0.0])]
    growth = float(np.max(roots, initial=-math.inf))
    if found.growth > LEAST_GROWTH or (in_pads and in_pads.is_growing):
        raise InputError(
            f"balancing speed = {speed:g} rad/s: the machine is unstable there and does not settle "
            f"(a motion grows by {growth:.3g} 1/s)"
        )
    return _SETTLED / -growth * abs(speed) / (2 * math.pi) if growth < 0 else math.inf
