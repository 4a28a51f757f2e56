"""Pictures of a run, drawn from what was recorded at the solver's own steps; the paper's figures 3
to 6 and 9 to 15 among them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure

from ..display import current, shown_speed, speed_with_unit
from ..plotting.figure_style import BLUE, GREY, ORANGE, new_figure, save
from .plot_data import (
    TURN,
    contact_of,
    envelope,
    is_constant,
    late_turns,
    once_a_turn,
    peak_index,
    place_of,
    rows_a_turn,
    spectrum,
    time_share,
)
from .recording import Recording
from .run_down import Run
from .summary import PEAKS_AFTER
from .summary_sentences import spoken

_PSI_TICKS = (
    [0, 90, 180, 270, 360],
    ["0 (right)", "90 (top)", "180 (left)", "270 (bottom)", "360"],
)
# Rows a turn below which a curve between them would be drawn, not computed.
_FINE = 24
_MOST_POINTS = 4000  # of a curve, above which its envelope is drawn
_TURNS = 5  # of an orbit


def _titled(axes: Axes, caption: str) -> None:
    axes.set_title(caption, loc="left", fontsize=10)


_NEAR = 0.4  # of the highest speed


def _speed_axis(axes: Axes, hz: np.ndarray) -> None:
    axes.set_xlabel(current().speed_label)
    # rounding leaves something of a shaft that stands
    tens = np.round(hz / 10, 9) if len(hz) else np.array([6.0])
    ends = float(tens.min()), float(tens.max())
    # to standstill, unless the run stays far from it
    if min(ends) < _NEAR * max(ends) or ends[0] == ends[1]:
        ends = min(ends[0], 0.0), max(ends[1], 0.0)
    low = 10 * math.floor(ends[0])
    axes.set_xlim(low, 10 * math.ceil(ends[1]) or (low == 0) * 10)


def amplitude(
    run: Run,
    axis: str,
    caption: str,
    compared: tuple[Run, str] | None = None,
    label: str = "this run",
    place: str | None = None,
) -> Figure:
    """Draw the largest displacement of a place, by default the one that moves most, over a
    revolution against speed, the start-up apart.

    axis: `x` or `y`; compared: another run and what it is, thinner behind.
    """
    figure, axes = new_figure()
    place, d = place or place_of(run.columns), current()
    curves = [(run, label, BLUE, 1.4)]
    if compared is not None:
        curves.insert(0, (*compared, ORANGE, 0.8))
    for shown, text, color, width in curves:
        values = shown.columns[f"{place}.{axis}_amp"] * d.amplitude
        n = shown.columns["w"] * d.speed
        early, late = shown.t <= PEAKS_AFTER, shown.t >= PEAKS_AFTER
        at = peak_index(shown.t, shown.columns["w"], values, PEAKS_AFTER)
        if at is not None:
            text += f": {values[at]:.4g} {d.amplitude_unit} at {n[at]:.4g} {d.speed_unit}"
            axes.plot(n[at], values[at], "o", color=color, ms=4)
        start = f"start-up, the first {PEAKS_AFTER:g} s" if shown is run else None
        axes.plot(n[early], values[early], color=GREY, lw=0.6, label=start)
        axes.plot(n[late], values[late], color=color, lw=width, label=text)
    figure.legend(loc="outside lower center", frameon=False, fontsize=8, ncols=len(curves) + 1)
    _speed_axis(axes, run.columns["w"] * d.speed)
    axes.set_ylim(bottom=0)
    direction = "Horizontal" if axis == "x" else "Vertical"
    axes.set_ylabel(f"{direction} amplitude of {spoken(str(place))} [{d.amplitude_unit}]")
    _titled(axes, caption)
    return figure


def contact_angle(recording: Recording, caption: str) -> Figure:
    """Draw the position of the journal in its bearing against speed: the share of the time, and a
    point for each turn; if the steps are too long for that, a point for each step."""
    figure, axes = new_figure()
    part = contact_of(recording.columns)
    hz = recording.columns["w"] * current().speed
    per_turn = rows_a_turn(recording)
    if per_turn >= _FINE and not is_constant(hz):
        shown = time_share(recording, str(part))
        image = axes.pcolormesh(
            shown.hz * TURN * current().speed,
            np.degrees(shown.angle),
            100 * shown.share.T,
            cmap="Blues",
            norm=PowerNorm(0.4, 0, 25),
            rasterized=True,
        )
        width = math.degrees(shown.angle[1])
        bar = figure.colorbar(image, ax=axes, extend="max")
        bar.set_label(f"share of the time within {width:.0f}° [%]")
        t, z = once_a_turn(recording, str(part))
        at = np.interp(t, recording.t, hz)
        mark = f"once a turn, the shaft's mark at 0° ({len(t)} points)"
        axes.plot(at, np.degrees(np.angle(z)) % 360, ".", color=ORANGE, ms=1.6, mew=0, label=mark)
    else:
        psi = np.degrees(recording.columns[f"{part}.psi"])
        label = _every_step(recording, per_turn)
        axes.plot(hz, psi, ".", color=BLUE, ms=2.2, mew=0, rasterized=True, label=label)
    figure.legend(loc="outside lower center", frameon=False, fontsize=8, markerscale=4)
    _speed_axis(axes, hz)
    axes.set_yticks(*_PSI_TICKS)
    axes.set_ylim(0, 360)
    axes.set_ylabel(f"Contact angle ψ of {spoken(str(part))} [deg]")
    _titled(axes, caption)
    return figure


def _every_step(recording: Recording, per_turn: float) -> str:
    """Return the caption for points that are the solver's steps, and for what in them is due to the
    steps."""
    usual = float(np.median(np.diff(recording.t)))
    shortest, longest = (1e3 * float(f(np.diff(recording.t))) for f in (np.min, np.max))
    if longest > 1.01 * shortest:
        return f"every step of the solver, {shortest:.2g} to {longest:.2g} ms"
    rate = 1 / usual
    return (
        f"every step of the solver, {1e3 * usual:.3g} ms, {per_turn:.0f} a turn; "
        f"islands at {rate:.4g} Hz over 4, 5, ... are the steps'"
    )


def orbit(recording: Recording, at_s: float, caption: str, place: str | None = None) -> Figure:
    """Draw the path of a place over the turns about a time [s], with a point for each
    turn."""
    figure, axes = new_figure(5.4, 5.0)
    place = place or str(place_of(recording.columns))
    c = recording.columns
    middle = float(np.interp(at_s, recording.t, c["phi"]))
    near = np.abs(c["phi"] - middle) <= _TURNS * TURN / 2
    x, y = (c[f"{place}.{axis}"][near] * current().small for axis in "xy")
    per_turn = rows_a_turn(recording, near)
    corners = "" if per_turn >= _FINE else f", {per_turn:.0f} steps a turn: the corners are theirs"
    marker = "" if per_turn >= _FINE else "."
    axes.plot(x, y, "-", color=BLUE, lw=0.8, label=f"{_TURNS} turns{corners}", marker=marker, ms=3)
    if per_turn >= _FINE and math.isfinite(per_turn):
        t, z = once_a_turn(recording, place)
        z = z[np.isin(np.searchsorted(recording.t, t), np.flatnonzero(near))] * current().small
        axes.plot(z.real, z.imag, "o", color=ORANGE, ms=4, label="once a turn, the mark at 0°")
    rest = float(c[f"{place}.y"][0]) * current().small
    axes.plot(0, rest, "+", color=GREY, ms=10, mew=1.5, label="rest")
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.08)
    figure.legend(loc="outside lower center", frameon=False, fontsize=8, ncols=3)
    axes.set_xlabel(f"Horizontal displacement of {spoken(place)} [{current().small_unit}]")
    axes.set_ylabel(f"Vertical displacement [{current().small_unit}]")
    _titled(axes, caption)
    return figure


def motion(recording: Recording, caption: str, place: str | None = None) -> Figure:
    """Draw both displacements of a place over time: as curves, or where they are too dense the
    range that each turn fills."""
    figure, first = new_figure()
    first.remove()
    place = place or str(place_of(recording.columns))
    turns = int(np.ptp(recording.columns["phi"]) / TURN)
    both = figure.subplots(2, sharex=True)
    for axes, axis, color, name in zip(
        both, "xy", (BLUE, ORANGE), ("horizontal", "vertical"), strict=True
    ):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(color="#dddddd", linewidth=0.6)
        axes.set_axisbelow(True)
        values = recording.columns[f"{place}.{axis}"] * current().small
        what = name
        if len(values) <= _MOST_POINTS or turns < _FINE:
            axes.plot(recording.t, values, color=color, lw=0.8)
        else:
            t, low, high = envelope(recording.t, values, min(turns, 600))
            axes.fill_between(t, low, high, color=color, alpha=0.6, lw=0, step="mid")
            what += ",\nrange of a turn"
        axes.set_ylabel(f"{spoken(place)}, {what} [{current().small_unit}]")
    both[1].set_xlabel("Time [s]")
    _titled(both[0], caption)
    return figure


def spectra(recording: Recording, caption: str, place: str | None = None) -> Figure:
    """Draw the spectra of both displacements of a place over the second half of a run at one
    speed."""
    figure, axes = new_figure()
    place = place or str(place_of(recording.columns))
    late = late_turns(recording)
    d, speed = current(), float(np.abs(recording.columns["w"][late]).mean())
    highest = 1e-3
    for axis, color, name in (("x", BLUE, "horizontal"), ("y", ORANGE, "vertical")):
        values = recording.columns[f"{place}.{axis}"][late] * d.amplitude
        f, lines = spectrum(recording.t[late], values)
        f = f * TURN * d.speed
        highest = max(highest, float(lines.max()))
        axes.semilogy(f, np.maximum(lines, 1e-12), color=color, lw=0.9, label=name)
    if speed > 0:
        once = speed * d.speed
        axes.axvline(once, color=GREY, lw=0.8, ls="--", label=f"1x, {once:.4g} {d.frequency_unit}")
        axes.set_xlim(0, min(6 * once, f[-1]))
    axes.set_ylim(highest * 1e-5, highest * 2)
    axes.legend(frameon=False, loc="upper right")
    axes.set_xlabel(d.frequency_label)
    axes.set_ylabel(f"Displacement of {spoken(place)} [{d.amplitude_unit}]")
    _titled(axes, caption)
    return figure


def step_length(recording: Recording, caption: str) -> Figure:
    """Draw the length of the solver's steps against speed."""
    figure, axes = new_figure()
    hz = recording.columns["w"][1:] * current().speed
    lengths = recording.columns["solver.h_last"][1:] * 1e3
    axes.plot(hz, lengths, ".", color=BLUE, ms=1.5, mew=0, rasterized=True)
    _speed_axis(axes, hz)
    axes.set_ylim(bottom=0)
    axes.set_ylabel("Step length [ms]")
    _titled(axes, caption)
    return figure


def error_indicator(recording: Recording, caption: str) -> Figure:
    """Draw the relative error of the solver's steps against speed."""
    figure, axes = new_figure()
    hz = recording.columns["w"][1:] * current().speed
    errors = recording.columns["solver.error"][1:]
    axes.semilogy(hz, errors, ".", color=BLUE, ms=1.5, mew=0, rasterized=True)
    _speed_axis(axes, hz)
    axes.set_ylabel("Relative error indicator [1]")
    _titled(axes, caption)
    return figure


def write_run_pictures(
    run: Run,
    recording: Recording,
    figures: Mapping[str, Any],
    name: str,
    is_adaptive: bool,
    out: Path,
    kind: str = "run_down",
) -> list[Path]:
    """Return the pictures of a run in the folder `out`: against its speed, or against time and
    frequency where it has one speed; figures: its `summary`; name: of the run, in the titles; kind:
    of the run, in the files' names."""
    if len(recording.t) < 3:
        return []
    pictures = {}
    end = float(recording.t[-1])
    place = figures["place"]
    has_place = place is not None
    if is_constant(run.columns["w"]):
        speed = speed_with_unit(run.hz[-1] * TURN)
        if has_place:
            pictures["time"] = motion(recording, f"{name} at {speed}: motion over time", place)
            pictures["spectrum"] = spectra(recording, f"{name} at {speed}: spectrum", place)
            pictures["orbit"] = orbit(recording, end, f"{name} at {speed}: orbit at the end", place)
    else:
        if has_place:
            for axis, text in (("x", "horizontal"), ("y", "vertical")):
                pictures[axis] = amplitude(
                    run, axis, f"{name}: {text} amplitude over speed", place=place
                )
            at_s, at_hz = figures["x_peak_s"], figures["x_peak_hz"]
            where = "end of the run"
            if at_s is not None:
                where = f"horizontal peak, {shown_speed(at_hz * TURN)} {current().speed_unit}"
            at_s = end if at_s is None else at_s
            pictures["orbit"] = orbit(recording, at_s, f"{name}: orbit at the {where}", place)
        if contact_of(recording.columns):
            caption = f"{name}: where the journal lies in its bearing"
            pictures["psi"] = contact_angle(recording, caption)
    if is_adaptive:
        pictures["error"] = error_indicator(recording, f"{name}: error indicator of every step")
        pictures["h"] = step_length(recording, f"{name}: length of every step")
    return [save(figure, out / f"{kind}_{key}.png") for key, figure in pictures.items()]
