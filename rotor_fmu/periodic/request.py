"""Periodic answers about a machine, for Python: `rf.response(...)`."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..display import current
from ..errors import InputError, nearest
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
from .result import ResponseResult, check_names


def constant_loads(rotor: Rotor, loads: Mapping[str, float]) -> np.ndarray | None:
    """Complex forces on the ports of loads by their names, `disc[2].fy` [N]; `InputError` for a
    name that is none."""
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
            near = nearest(name, known)
            raise InputError(f"loads: {name!r} is no force on a port; the nearest is {near}")
        if not math.isfinite(value):
            raise InputError(f"loads: {name} = {value}: must be finite")
        place, factor = known[name]
        total[place] += factor * value
    return total


def answer(
    machine: Rotor | Path | str,
    *,
    tell: ReportPoint = lambda _, __: None,
    journal: EventLog | None = None,
    **options: Any,
) -> ResponseResult:
    """Periodic motions of a machine over its speed, or over another parameter.

    speed: FROM and TO [rad/s], or, with `over`, the one speed; over: a name of `machine.parameters`
    with FROM and TO; parameters: other values of the machine's; loads: constant forces on ports,
    such as `disc[2].fy` [N]; period: revolutions in a period; harmonics: at most, share: what the
    highest may be of the motion; stability: whether Floquet multipliers are computed; step: the
    longest along the curve, in clearances and shares of the range; seeds: values of the parameter
    where runs in time look for further branches; whirl: of the machine without its unbalance, the
    whirl by itself (dry whirl, oil whirl), whose frequency is unknown; start: a motion, of `at` or
    `points`, from which alone branches are followed; branches: whether those that begin at period
    doublings and branch points are followed too; tell: hears of every point; journal: of what an
    earlier call came to, and of what this one does. Raises `InputError` for what cannot be.
    """
    return found(question(machine, **options), tell, journal)


class Question(NamedTuple):
    """A machine, with its parameters as they were asked for, and what is asked of it."""

    rotor: Rotor
    task: Task


def found(
    asked: Question, tell: ReportPoint = lambda _, __: None, journal: EventLog | None = None
) -> ResponseResult:
    """The answer to a question; see `answer`."""
    return ResponseResult(response(asked.rotor, asked.task, tell, journal))


def question(
    machine: Rotor | Path | str,
    *,
    speed: float | tuple[float, float],
    over: tuple[str, float, float] | None = None,
    parameters: Mapping[str, float] | None = None,
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
) -> Question:
    """The question of `answer`, with its options, checked before anything is computed. Raises
    `InputError` for what cannot be."""
    rotor = rotor_of(machine)
    if parameters:
        check_names(rotor, parameters)
        rotor = rotor.with_values({n: float(v) for n, v in parameters.items()})
    for of, count, most in (("period", period, 16), ("harmonics", harmonics, 500)):
        if not (isinstance(count, (int, np.integer)) and 1 <= count <= most):
            raise InputError(f"{of} = {count}: must be an integer from 1 to {most}")
    if not 0 < share < 1:
        raise InputError(f"share = {share:g}: must be above 0 and below 1")
    if not 1e-4 <= step <= 10:
        raise InputError(f"step = {step:g}: must be from 0.0001 to 10")
    held, ends = 0.0, speed
    name = SPEED
    if over is not None:
        if len(over) != 3:
            raise InputError(f"over = {over}: must be a name, FROM and TO")
        name = over[0]
        if not isinstance(speed, (int, float, np.number)):
            raise InputError("speed: must be one speed where another parameter is varied")
        check_names(rotor, {name: 0.0})
        held, ends = float(speed), (float(over[1]), float(over[2]))
    if not isinstance(ends, (tuple, list, np.ndarray)) or len(ends) != 2:
        raise InputError(f"speed = {speed}: must be FROM and TO")
    low, high = (float(end) for end in ends)
    known = {str(n): of.unit for n, of, _ in rotor.parameters()} | {SPEED: "rad/s"}
    factor, unit = current().of_si(known[name])

    def shown(value: float) -> str:
        """A value of what is varied, in the unit that is shown."""
        return f"{factor * value:.5g}"

    for seed in seeds:
        if not low <= seed <= high:
            raise InputError(
                f"seed = {shown(seed)}: must be from {shown(low)} to {shown(high)} {unit}"
            )
    task = Task(
        low,
        high,
        name,
        held,
        period,
        constant_loads(rotor, loads or {}),
        Accuracy(share, min(3, harmonics), harmonics * period, stability),
        ContinuationSteps(longest=step),
        tuple(float(s) for s in seeds),
        whirl,
        None if start is None else start.orbit,
        branches,
    )
    check(rotor, task)
    return Question(rotor, task)
