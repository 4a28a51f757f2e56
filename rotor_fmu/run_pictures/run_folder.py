"""The pictures that a run leaves in its folder."""

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure

from .. import vibration
from ..display import current, shown_speed, speed_with_unit
from ..plotting.colors import BLUE, GREY, ORANGE
from ..plotting.figure_style import entitle, legend_below, new_figure, new_panels, save
from ..plotting.thinning import extremes
from ..runs.measuring_points import display_name
from ..runs.peaks import is_constant, peak_index, start_up
from ..runs.recording import Recording
from ..runs.run_down import Run
from ..runs.summary import last_contact
from .signal_plots import FINE, orbit
from .view import View, angle_axis, speed_axis

_STRETCHES = 1500  # of a curve over time, whose extremes are drawn
_REPEATS = 12  # turns after which motions of 2, 3, 4 or 6 turns do
_NOTHING = 1e-100  # of a spectrum, whose scale has no zero
_DIRECTIONS = (("x", BLUE, "horizontal"), ("y", ORANGE, "vertical"))


def distance_from_start(run: Run, place: str, axis: str, caption: str) -> Figure:
    """Draw the largest distance of a place from its start in a revolution against speed, the
    start-up apart; axis: `x` or `y`."""
    figure, axes = new_figure()
    draw_distance(axes, run, place, axis, "this run")
    distance_axes(axes, run, place, axis)
    legend_below(figure)
    entitle(axes, caption)
    return figure


def draw_distance(
    axes: Axes,
    run: Run,
    place: str,
    axis: str,
    label: str,
    color: str = BLUE,
    width: float = 1.4,
    has_start: bool = True,
) -> None:
    """Draw the largest distance from the start over the speed, its peak marked and named;
    has_start: whether the start-up is named."""
    d = current()
    values = run.columns[f"{place}.{axis}_amp"] * d.small
    w = run.columns["w"]
    n, end = w * d.speed, start_up(run.t, w)
    early, late = run.t <= end, run.t >= end
    start = f"start-up, the first {end:.3g} s" if has_start else None
    at = peak_index(run.t, w, run.columns[f"{place}.{axis}_amp"])
    if at is not None:
        label += f": {values[at]:.4g} {d.small_unit} at {shown_speed(w[at])} {d.speed_unit}"
        axes.plot(n[at], values[at], "o", color=color, ms=4)
    axes.plot(n[early], values[early], color=GREY, lw=0.6, label=start)
    axes.plot(n[late], values[late], color=color, lw=width, label=label)


def distance_axes(axes: Axes, run: Run, place: str, axis: str) -> None:
    """Label the axes of the largest distance from the start over the speed of a run."""
    speed_axis(axes, run.columns["w"] * current().speed)
    axes.set_ylim(bottom=0)
    direction = "horizontal" if axis == "x" else "vertical"
    moved = f"Largest {direction} distance of {display_name(place)}"
    axes.set_ylabel(f"{moved}\nfrom its start, in a turn [{current().small_unit}]")


def journal_angle(recording: Recording, caption: str) -> Figure:
    """Draw the position of the journal of `last_contact` in its bearing against speed: the share
    of the time, and a point for each turn; if the steps are too long for that, a point for each
    step."""
    figure, axes = new_figure()
    part = str(last_contact(recording.columns))
    z = recording.columns[f"{part}.x"] + 1j * recording.columns[f"{part}.y"]
    n = recording.w * current().speed
    per_turn = vibration.rows_per_turn(recording.phi)
    if per_turn >= FINE and not is_constant(recording.w):
        shown = vibration.time_share(recording.t, recording.w, z)
        angles = np.degrees(shown.angle)
        speed, share = shown.speed * current().speed, 100 * shown.share.T
        scale = PowerNorm(0.4, 0, 25)
        image = axes.pcolormesh(speed, angles, share, cmap="Blues", norm=scale, rasterized=True)
        bar = figure.colorbar(image, ax=axes, extend="max")
        bar.set_label(f"share of the time within {angles[1]:.0f}° [%]")
        with suppress(vibration.TooFewTurns):  # a part of a turn has no mark
            section = vibration.poincare(recording.t, recording.phi, z)
            at = np.interp(section.t, recording.t, n)
            mark = f"once a turn, the shaft's mark at 0° ({len(at)} points)"
            angle = np.degrees(np.angle(section.points)) % 360
            axes.plot(at, angle, ".", color=ORANGE, ms=1.6, mew=0, label=mark)
    else:
        psi = np.degrees(recording.columns[f"{part}.psi"])
        label = _every_step(recording, per_turn)
        axes.plot(n, psi, ".", color=BLUE, ms=2.2, mew=0, rasterized=True, label=label)
    legend_below(figure, markerscale=4)
    speed_axis(axes, n)
    angle_axis(axes, f" of {display_name(part)}")
    entitle(axes, caption)
    return figure


def _every_step(recording: Recording, per_turn: float) -> str:
    """Return the label of points that are the solver's steps, and what in them is due to these."""
    steps = np.diff(recording.t)
    usual = float(np.median(steps))
    shortest, longest = (1e3 * float(f(steps)) for f in (np.min, np.max))
    if longest > 1.01 * shortest:
        return f"every step of the solver, {shortest:.2g} to {longest:.2g} ms"
    return (
        f"every step of the solver, {1e3 * usual:.3g} ms, {per_turn:.0f} a turn; "
        f"islands at {1 / usual:.4g} Hz over 4, 5, ... are due to the steps"
    )


def motion(recording: Recording, place: str, caption: str) -> Figure:
    """Draw both displacements of a place over time, as their extremes where they are too dense."""
    figure, both = new_panels(6.4, 4.0, 2, share_x=True)
    for axes, (axis, color, direction) in zip(both, _DIRECTIONS, strict=True):
        values = recording.columns[f"{place}.{axis}"] * current().small
        rows = extremes(values, _STRETCHES)
        axes.plot(recording.t[rows], values[rows], color=color, lw=0.8)
        axes.set_ylabel(f"{display_name(place)},\n{direction} [{current().small_unit}]")
    both[1].set_xlabel("Time [s]")
    entitle(both[0], caption)
    return figure


def spectra(recording: Recording, place: str, caption: str) -> Figure:
    """Draw spectra of both displacements of a place in the second half of a run at one speed."""
    figure, axes = new_figure()
    late = vibration.second_half(recording.t, recording.phi, turns=_REPEATS)
    d, speed = current(), float(np.abs(recording.w[late]).mean())
    highest = 0.0
    for axis, color, direction in _DIRECTIONS:
        values = recording.columns[f"{place}.{axis}"][late] * d.amplitude
        hz, lines = vibration.spectrum(recording.t[late], values)
        f = hz * vibration.TURN * d.speed
        highest = max(highest, float(lines.max()))
        axes.semilogy(f, np.maximum(lines, _NOTHING), color=color, lw=0.9, label=direction)
    if speed > 0:
        once = speed * d.speed
        label = f"1x, {shown_speed(speed)} {d.frequency_unit}"
        axes.axvline(once, color=GREY, lw=0.8, ls="--", label=label)
        axes.set_xlim(0, min(6 * once, f[-1]))
    highest = highest or 1.0  # of a place that does not move
    axes.set_ylim(highest * 1e-5, highest * 2)
    axes.legend(frameon=False, loc="upper right")
    axes.set_xlabel(d.frequency_label)
    axes.set_ylabel(f"Displacement of {display_name(place)} [{d.amplitude_unit}]")
    entitle(axes, caption)
    return figure


def step_length(recording: Recording, caption: str) -> Figure:
    """Draw the length of the solver's steps against speed."""
    figure, axes = _each_step(recording, 1e3 * recording.columns["solver.h_last"], caption)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("Step length [ms]")
    return figure


def error_indicator(recording: Recording, caption: str) -> Figure:
    """Draw the relative error of the solver's steps against speed."""
    figure, axes = _each_step(recording, recording.columns["solver.error_last"], caption)
    axes.set(yscale="log", ylabel="Relative error indicator [1]")
    return figure


def _each_step(recording: Recording, values: np.ndarray, caption: str) -> tuple[Figure, Axes]:
    figure, axes = new_figure()
    n = recording.w[1:] * current().speed
    axes.plot(n, values[1:], ".", color=BLUE, ms=1.5, mew=0, rasterized=True)
    speed_axis(axes, n)
    entitle(axes, caption)
    return figure, axes


def write_run_pictures(
    run: Run,
    recording: Recording,
    figures: Mapping[str, Any],
    name: str,
    is_adaptive: bool,
    out: Path,
    kind: str = "run_down",
) -> list[Path]:
    """Write the pictures of a run into the folder `out` and return their paths: against its speed,
    or against time and frequency where it has one speed.

    figures: its `summary`; name: of the run, in the titles; kind: of the run, in the files' names.
    """
    if len(recording.t) < 3 or not len(run.t):  # of an FMU that ended in its first step
        return []
    place, end = figures["place"], float(recording.t[-1])
    pictures: dict[str, Figure] = {}
    if is_constant(run.columns["w"]):
        if place is not None:
            title = f"{name} at {speed_with_unit(run.columns['w'][-1])}"
            pictures["time"] = motion(recording, place, f"{title}: motion over time")
            pictures["spectrum"] = spectra(recording, place, f"{title}: spectrum")
            view = View(recording, place, time=end, heading=title)
            pictures["orbit"] = orbit(view, "orbit at the end")
    else:
        if place is not None:
            for axis, _, text in _DIRECTIONS:
                caption = f"{name}: {text} distance from its start over speed"
                pictures[axis] = distance_from_start(run, place, axis, caption)
            at_s, at_hz = figures["x_peak_s"], figures["x_peak_hz"]
            where = "end of the run"
            if at_s is not None:
                at = shown_speed(at_hz * vibration.TURN)
                where = f"horizontal peak, {at} {current().speed_unit}"
            view = View(recording, place, time=end if at_s is None else at_s, heading=name)
            pictures["orbit"] = orbit(view, f"orbit at the {where}")
        if last_contact(recording.columns):
            caption = f"{name}: where the journal lies in its bearing"
            pictures["psi"] = journal_angle(recording, caption)
    if is_adaptive:
        pictures["error"] = error_indicator(recording, f"{name}: error indicator of every step")
        pictures["h"] = step_length(recording, f"{name}: length of every step")
    return [save(figure, out / f"{kind}_{key}.png") for key, figure in pictures.items()]
