"""Bifurcation diagrams of a study: Poincare sections over what is varied, over the curve of the
periodic motions by harmonic balance, stable ones full, unstable ones dashed.

Where the motion repeats itself every turn, the sections lie on the stable curve; where they spread,
it is unstable, or there is none.
"""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..display import Shown, current, range_with_unit, speed_with_unit
from ..errors import InputError, RunFailed
from ..run_status import FAILED
from ..studies.design import Axis
from ..studies.study import Study
from .machine_runs import RUN, MachineRuns, machine_of
from .metric import Metric
from .run_kinds import STEPS

if TYPE_CHECKING:
    import xarray
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..periodic.request import ReportPoint
    from ..periodic.result import ResponseResult

_MOST_PANELS = 4
_SPEED = f"{RUN}speed"
Say = Callable[[str], object]
# Shows how much of a range, so long, a response covers; how its values are shown.
ShowProgress = Callable[[float, Shown], "AbstractContextManager[ReportPoint]"]


class Panel(NamedTuple):
    """A diagram: points over the parameter, of rising and of falling values where a run goes both
    ways; the values of what else is varied, as they are shown; the motions, or None; the parameter
    of the runs that failed."""

    parameter: np.ndarray
    section: np.ndarray
    falls: np.ndarray
    others: Sequence[str]
    response: "ResponseResult | None"
    failed: np.ndarray


def diagrams(
    study: Study, data: "xarray.Dataset", say: Say, progress: ShowProgress
) -> "dict[str, Figure]":
    """Return the diagram of every Poincare section that a study keeps, by its column.

    say: is given each computation, and whatever cannot be drawn; progress: shows how far one is.
    Raises `InputError` for a study that keeps none and `RunFailed` where every run failed.
    """
    runs, sections = sections_of(study)
    has_failed = np.char.startswith(data.status.values.astype(str), FAILED)
    if has_failed.all():
        raise RunFailed("--diagram: every run failed")
    axis = None if runs.how.kind.name == STEPS.name else _across(study.design.axes)
    lost, data = data.isel(run=has_failed), data.isel(run=~has_failed)
    panels = _panels(study, data, lost, runs, axis, say, progress)
    shown = {column.name: current().of_si(column.unit) for column in runs.columns}
    return {m.name: _figure(m, shown[m.name], axis, panels[m.name]) for m in sections}


def sections_of(study: Study) -> tuple[MachineRuns, list[Metric]]:
    """Return the runs of a study and the Poincare sections that it keeps; `InputError` for none."""
    runs = study.model
    if isinstance(runs, MachineRuns) and runs.how.kind.holds_speeds:
        sections = [metric for metric in runs.metrics if metric.kind.name == "poincare"]
        if sections:
            return runs, sections
    raise InputError("--diagram: the study keeps no poincare of runs at constant speed")


def _across(axes: tuple[Axis, ...]) -> Axis:
    """Return what the diagram goes over: the speed, or else what has the most values."""
    of_speed = [axis for axis in axes if axis.targets == (_SPEED,)]
    return of_speed[0] if of_speed else max(axes, key=lambda axis: len(axis.values) or 1e9)


def _panels(
    study: Study,
    data: "xarray.Dataset",
    lost: "xarray.Dataset",
    runs: MachineRuns,
    axis: Axis | None,
    say: Say,
    progress: ShowProgress,
) -> dict[str, list[Panel]]:
    """Return the panels of each section: one a combination of what else is varied; lost: the runs
    that failed."""
    rest = [a for a in study.design.axes if a is not axis]
    points, of_lost = (
        np.array([of[a.name].values for a in rest]).reshape(len(rest), of.sizes["run"]).T
        for of in (data, lost)
    )
    groups = np.unique(points, axis=0)
    if len(groups) > _MOST_PANELS:
        names = ", ".join(a.name for a in rest)
        say(f"{len(groups)} combinations of {names}: {_MOST_PANELS} drawn")
        groups = groups[np.linspace(0, len(groups) - 1, _MOST_PANELS).astype(int)]
    result: dict[str, list[Panel]] = {}
    for group in groups:
        rows = np.flatnonzero((points == group).all(axis=1))
        others = dict(zip((a.name for a in rest), group.tolist(), strict=True))
        settings = {t: others[a.name] for a in rest for t in a.targets}
        response = None
        across = None if axis is None else data[axis.name].values[rows]
        failed = [] if axis is None else lost[axis.name].values[(of_lost == group).all(axis=1)]
        for metric in (m for m in runs.metrics if m.kind.name == "poincare"):
            values = data[metric.name].values[rows]
            over, section, falls = _points(values, across, runs, settings)
            if response is None:
                response = _response(runs, axis, settings, over, say, progress)
            texts = [_text(a, others[a.name]) for a in rest]
            panel = Panel(over, section, falls, texts, response, np.array(failed))
            result.setdefault(metric.name, []).append(panel)
    return result


def _points(
    values: np.ndarray, across: np.ndarray | None, runs: MachineRuns, settings: Mapping[str, float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points of some runs, shape (runs, section): parameter, section, whether it falls;
    across: the parameter of each run, None where each has speeds of its own."""
    if across is not None:
        over = np.repeat(across, values.shape[1])
        return over, values.ravel(), np.zeros(len(over), bool)
    own = {n.removeprefix(RUN): v for n, v in settings.items() if n.startswith(RUN)}
    speeds = runs.how.changed(own).speeds
    falls = np.diff(speeds, prepend=2 * speeds[0] - speeds[:2][-1]) < 0
    each = values.shape[1] // len(speeds)
    return np.repeat(speeds, each), values[0], np.repeat(falls, each)


def _response(
    runs: MachineRuns,
    axis: Axis | None,
    settings: Mapping[str, float],
    over: np.ndarray,
    say: Say,
    progress: ShowProgress,
) -> "ResponseResult | None":
    """Return the periodic motions over the range of a diagram, None where there can be none; raises
    `KeyboardInterrupt` where they are stopped."""
    from ..periodic.request import compute_response, response_request

    rotor = machine_of(runs.toml, False).rotor
    names, given = rotor.numbers(), runs.own_numbers(settings)
    low, high = float(over.min()), float(over.max())
    request = partial(response_request, rotor, parameters=given, branches=True)
    of = current().of_si("rad/s" if axis is None else axis.unit)
    try:
        if axis is None or axis.targets == (_SPEED,):
            say(f"periodic motions {range_with_unit(low, high)}")
            asked = request(speed=(low, high))
        elif len(axis.targets) > 1 or axis.targets[0] not in names:
            raise InputError(f"{axis.name}: sets more than one quantity, or none of the machine")
        else:
            speed = settings.get(_SPEED, runs.how.numbers["speed"])
            ends = f"{of.factor * low:.6g} to {of.text(high, digits=6)}"
            say(f"periodic motions over {axis.name} from {ends} at {speed_with_unit(speed)}")
            asked = request(speed=speed, over=(axis.targets[0], low, high))
        with progress(high - low, of) as report_point:
            result = compute_response(asked, report_point)
    except InputError as error:
        say(f"without periodic motions: {error}")
        return None
    if result.is_stopped:
        raise KeyboardInterrupt
    return result


def _text(axis: Axis, value: float) -> str:
    factor, unit = current().of_si(axis.unit)
    return f"{axis.name} = {factor * value:.6g}{'' if unit in ('', '1') else f' {unit}'}"


def _figure(metric: Metric, shown: Shown, axis: Axis | None, panels: list[Panel]) -> "Figure":
    from ..plotting.figure_style import new_panels

    figure, axes = new_panels(7.2, 0.8 + 3.2 * len(panels), len(panels), 1, share_x=True)
    name, unit = ("speed", "rad/s") if axis is None else (axis.name.removeprefix(RUN), axis.unit)
    for panel, ax in zip(panels, axes, strict=True):
        _draw(metric, shown, unit, panel, ax)
    axes[-1].set_xlabel(f"{name} [{current().of_si(unit).unit}]")
    return figure


def _draw(metric: Metric, shown: Shown, unit: str, panel: Panel, ax: "Axes") -> None:
    """Draw a panel; shown: how its section is shown; unit: the SI unit of its parameter."""
    from ..plotting.colors import BLUE, GREY, ORANGE, PURPLE

    across = current().of_si(unit).factor
    for falls, color, text in ((False, BLUE, "rising"), (True, ORANGE, "falling")):
        mine = panel.falls == falls
        if mine.any():
            label = text if panel.falls.any() else "once a turn"
            points = panel.parameter[mine] * across, panel.section[mine] * shown.factor
            mark = "x" if falls else "."
            ax.plot(*points, mark, color=color, ms=3, mew=0.6, zorder=2, label=label)
    if len(panel.failed):
        foot = ax.get_xaxis_transform()
        at = panel.failed * across, np.full(len(panel.failed), 0.02)
        ax.plot(*at, "|", color=PURPLE, label="failed runs", transform=foot)
    place, _, side = metric.of.rpartition(".")
    response = panel.response
    if response is not None and place in response.probes and side in "xy":
        lines = response.section(place, side)
        for is_stable, text in ((True, "periodic, stable"), (False, "periodic, unstable")):
            dashes, width = ("-", 2.2) if is_stable else ((0, (4, 2)), 1.2)
            alike = [line for line in lines if line.is_stable == is_stable]
            for line in alike:
                over, value = line.parameter * across, line.value * shown.factor
                named = text if line is alike[0] else None
                ax.plot(over, value, color=GREY, ls=dashes, lw=width, zorder=1, label=named)
    ax.legend(frameon=False, fontsize=8)
    ax.set_title(", ".join(panel.others), fontsize=9)
    ax.set_ylabel(f"{metric.of} at the mark [{shown.unit}]")
