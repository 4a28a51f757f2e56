"""The request for a response of a machine, and its computation: `rf.response`, `rotor-fmu response`
and studies."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from ..display import current
from ..errors import InputError, check_integer, mapped, meant, number, numbers, shown_value, switch
from ..fmi.interface import ports
from ..linear.displayed import rotor_of
from ..model.machine.rotor import Rotor
from ..model.parts.base import BASE
from ..model.periodic.arclength import ContinuationSteps
from ..model.periodic.branch import Solution
from ..model.periodic.checkpoint import EventLog
from ..model.periodic.continuation import ReportPoint
from ..model.periodic.harmonic_count import Accuracy
from ..model.periodic.problem import SPEED, Task, check
from ..model.periodic.response import response
from ..runs.settings_text import known_parameter, machine_values
from .result import ResponseResult


def constant_loads(rotor: Rotor, loads: Mapping[str, float]) -> np.ndarray | None:
    """Return the complex forces on the ports of loads by their names, `disc[2].fy` [N]. Raises
    `InputError` for an unknown name."""
    if not loads:
        return None
    known = {
        f"{name}.f{axis}": (i, factor)
        for i, (name, port) in enumerate(ports(rotor))
        if port.node != BASE
        for axis, factor in (("x", 1.0), ("y", 1j))
    }
    total = np.zeros(len(ports(rotor)), complex)
    for name, value in loads.items():
        if name not in known:
            raise InputError(f"loads: {name!r} is not a force on a port; {meant(name, known)}")
        if not math.isfinite(number(f"loads: {name}", value)):
            raise InputError(f"loads: {name} = {value}: must be finite")
        place, factor = known[name]
        total[place] += factor * value
    return total


class ResponseRequest(NamedTuple):
    """A machine, with the parameters given for it, and the task to be solved."""

    rotor: Rotor
    task: Task

    def ends(self) -> list[Rotor]:
        """Return the machines with the ends of a quantity that is varied; none where the speed
        is."""
        task = self.task
        values = () if task.name == SPEED else (task.low, task.high)
        return [self.rotor.with_values({task.name: value}) for value in values]


def compute_response(
    request: ResponseRequest,
    report_point: ReportPoint = lambda _, __: None,
    log: EventLog | None = None,
) -> ResponseResult:
    """Compute a response; report_point: is called with every point; log: of what an earlier call
    computed, to which this one adds."""
    return ResponseResult(response(request.rotor, request.task, report_point, log))


def response_request(
    machine: Rotor | Path | str,
    *,
    speed: float | tuple[float, float],
    over: tuple[str, float, float] | None = None,
    parameters: Mapping[str, float | str] | None = None,
    loads: Mapping[str, float] | None = None,
    period: int = 1,
    harmonics: int = 60,
    share: float = 1e-4,
    stability: bool = True,
    step: float = 0.1,
    seeds: Sequence[float] = (),
    whirl: bool = False,
    start: Solution | None = None,
    branches: bool = False,
) -> ResponseRequest:
    """Return the request of a response, checked; for the options see `rotor_fmu.response`. Raises
    `InputError`."""
    rotor = rotor_of(machine)
    given = machine_values("parameters:", rotor, mapped("parameters", parameters))
    rotor = rotor.with_values(given)
    check_integer("period", period, 1, 16)
    check_integer("harmonics", harmonics, 1, 500)
    if not 0 < number("share", share) < 1:
        raise InputError(f"share = {share:g}: must be above 0 and below 1")
    if not 1e-4 <= number("step", step) <= 10:
        raise InputError(f"step = {step:g}: must be from 0.0001 to 10")
    held, ends = 0.0, cast("Any", speed)
    name = SPEED
    if over is not None:
        if not isinstance(over, (tuple, list)) or len(over) != 3:
            raise InputError(f"{shown_value('over', over)}: must be a name, FROM and TO")
        name = over[0]
        if np.ndim(speed):
            raise InputError("speed: must be one speed where another parameter is varied")
        known_parameter("over:", name, rotor)
        if name in given:
            raise InputError(f"{name}: is varied; it cannot be given one value too")
        held, ends = number("speed", speed), numbers("over", over[1:])
    is_list = isinstance(ends, (tuple, list)) or getattr(ends, "ndim", 0) == 1
    if not is_list or len(ends) != 2:
        raise InputError(f"speed = {speed}: must be FROM and TO")
    low, high = numbers("speed", ends)
    if start is not None and not hasattr(start, "orbit"):
        said = shown_value("start", start)
        raise InputError(f"{said}: must be a motion of `at` or `points` of an earlier result")
    si_unit = "rad/s" if name == SPEED else rotor.numbers()[name].quantity.unit
    shown = current().of_si(si_unit).text
    searched = tuple(numbers("seeds", seeds))
    for seed in searched:
        if not low <= seed <= high:
            raise InputError(f"seed = {shown(seed)}: must be from {shown(low)} to {shown(high)}")
    task = Task(
        low,
        high,
        name,
        held,
        period,
        constant_loads(rotor, mapped("loads", loads)),
        Accuracy(share, min(3, harmonics), harmonics * period, switch("stability", stability)),
        ContinuationSteps(longest=step),
        searched,
        switch("whirl", whirl),
        None if start is None else start.orbit,
        switch("branches", branches),
    )
    check(rotor, task)
    return ResponseRequest(rotor, task)
