"""Pictures of bearings by themselves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from ..display import current, speed_with_unit
from ..model.linear.damper_curves import DamperCurves
from ..model.linear.floating_ring_curves import RingCurves
from ..model.linear.journal_bearing_curves import ANGLES, BearingCurves
from ..model.linear.rolling_bearing_curves import RollingCurves
from ..plotting.figure_style import BLUE, ORANGE, PlainFigure
from .bearing_tables import bearing_table, ring_table, rolling_table
from .linear_plots import COLORS, PURPLE, new_figure, style


def bearing_figure(result: BearingCurves) -> Figure:
    """Draw the journal's locus in its clearance, the pressure around it, and stiffness and damping
    over the speed; of pads that tilt also how far they do and what they bear."""
    tilts = result.tilts.shape[1] > 0
    figure, grid = new_figure(8.4, 10.9 if tilts else 7.4, 3 if tilts else 2, 2)
    locus, around, stiffness, damping, *of_pads = grid.ravel()
    x, y = result.x / result.clearance, result.y / result.clearance
    locus.plot(x, y, "-", color=BLUE, lw=1.4)
    d, (varied, unit, what) = current(), _varied(result)
    for i, color in ((0, BLUE), (len(x) - 1, ORANGE)):
        label = f"{varied[i]:.4g} {unit}"
        locus.plot(x[i], y[i], "o", color=color, label=label)
        around.plot(np.degrees(ANGLES), result.around[i] * d.pressure, color=color, label=label)
        if i == 0 or tilts:
            _pads(locus, result, i, color if tilts else "black")
        if len(x) == 1:
            break
    locus.set_aspect("equal")
    locus.set_xlabel("x over the clearance [1]")
    locus.set_ylabel("y over the clearance [1]")
    locus.set_title("Journal at rest in its clearance", loc="left", fontsize=9)
    around.set_xlabel("Angle from the right, anticlockwise [deg]")
    around.set_xticks(range(0, 361, 90))
    around.set_ylabel(f"Pressure [{d.pressure_unit}]")
    around.set_title("Film in the middle of its length", loc="left", fontsize=9)
    around.legend(frameon=False, fontsize=8)
    mark = "o-" if len(x) < 3 else "-"
    threshold = result.threshold_load if what == "Load" else result.threshold
    threshold = None if threshold is None else threshold * (d.force if what == "Load" else d.speed)
    _coefficients((stiffness, damping), varied, result.K, result.C, mark)
    if tilts:
        _pads_over(of_pads, varied, result, mark)
        for first, last, pivot, *_ in result.pads:
            spans = np.degrees([first, last]) % 360.0
            turned = spans if spans[0] < spans[1] else [spans[0], 360.0, 0.0, spans[1]]
            for begin, end in zip(turned[::2], turned[1::2], strict=True):
                around.axvspan(begin, end, color="0.92", lw=0)
            around.axvline(np.degrees(pivot) % 360.0, color="0.6", lw=0.8, ls="--")
    for axes in (stiffness, damping, *of_pads):
        axes.set_xlabel(f"{what} [{unit}]")
        if threshold is not None:
            axes.axvline(threshold, color=PURPLE, lw=1.2, ls=":")
    figure.suptitle(bearing_table(result).title, fontsize=10, x=0.01, ha="left")
    return figure


def _pads(axes: Axes, result: BearingCurves, i: int, color: str) -> None:
    """Draw how far the journal may go: where it would touch each pad as that stands in row i, and
    the pads' pivots."""
    moved = np.zeros((len(result.pads), 2))
    moved[: result.tilts.shape[1]] = result.tilts[i] / result.clearance
    for n, ((first, last, pivot, clearance, x, y), (tilt, give)) in enumerate(
        zip(result.pads, moved, strict=True), 1
    ):
        theta = np.linspace(first, last, max(2, round(np.degrees(last - first))))
        centre = complex(x, y) + (1j * tilt - give) * np.exp(1j * pivot)

        def touch(
            theta: np.ndarray, clearance: float = clearance, centre: complex = centre
        ) -> np.ndarray:
            e = np.exp(1j * theta)
            return (clearance - (centre * e.conj()).real) * e

        surface = touch(theta)
        axes.plot(surface.real, surface.imag, color=color, lw=1.2)
        if result.tilts.shape[1]:
            at = touch(np.array([pivot]))[0]
            axes.plot(at.real, at.imag, "^", ms=4, color=color)
            if i == 0:
                axes.annotate(f"{n}", (1.18 * at.real, 1.18 * at.imag), fontsize=8, ha="center")


def _pads_over(panels: Sequence[Axes], over: np.ndarray, result: BearingCurves, mark: str) -> None:
    """Draw how far each pad is tilted, and what it bears."""
    angles = 1e3 * result.tilts[:, :, 0] / result.journal_radius
    d = current()
    loads, names = result.pad_loads * d.force, ("Tilt [mrad]", f"Load of a pad [{d.force_unit}]")
    for axes, values, name in zip(panels, (angles, loads), names, strict=True):
        for n, color in zip(range(values.shape[1]), COLORS, strict=False):
            label = f"pad {n + 1}"
            axes.plot(over, values[:, n], _mark(mark, n), ms=4, color=color, lw=1.4, label=label)
        axes.set_ylabel(name)
        axes.legend(frameon=False, fontsize=8, ncols=2)


def _varied(result: BearingCurves | RingCurves | RollingCurves) -> tuple[np.ndarray, str, str]:
    """Return what varies, the speed or the load, in the unit that is shown, its unit and name."""
    d = current()
    if len(result.speeds) > 1 and result.speeds[0] == result.speeds[-1]:
        return np.hypot(*result.load.T) * d.force, d.force_unit, "Load"
    return result.speeds * d.speed, d.speed_unit, "Speed"


def _mark(mark: str, i: int) -> str:
    """Return how a line is drawn, every other one dashed: those of the same values are seen."""
    return mark.replace("-", "--") if i % 2 else mark


def _coefficients(
    panels: Sequence[Axes], over: np.ndarray, K: np.ndarray, C: np.ndarray, mark: str
) -> None:
    """Draw stiffness and damping, shape (n, 2, 2)."""
    d = current()
    of_both = ((K * d.stiffness, "k", d.stiffness_unit), (C * d.damping, "c", d.damping_unit))
    for axes, (of, letter, unit) in zip(panels, of_both, strict=True):
        for (i, j), color in zip(((0, 0), (0, 1), (1, 0), (1, 1)), COLORS, strict=False):
            label = f"{letter}{'xy'[i]}{'xy'[j]}"
            axes.plot(over, of[:, i, j], _mark(mark, i), ms=4, color=color, lw=1.4, label=label)
        axes.set_ylabel(f"{'Stiffness' if letter == 'k' else 'Damping'} [{unit}]")
        axes.legend(frameon=False, fontsize=8, ncols=2)


def damper_figure(result: DamperCurves) -> Figure:
    """Draw the ring at rest in its clearance, and stiffness, damping and largest pressure over the
    orbit."""
    figure, grid = new_figure(8.4, 7.4, 2, 2)
    place, pressure, stiffness, damping = grid.ravel()
    circle = np.exp(1j * ANGLES)
    place.plot(circle.real, circle.imag, color="black", lw=1.2)
    place.plot(result.x / result.clearance, result.y / result.clearance, "o", color=BLUE)
    place.set_aspect("equal")
    place.set_xlabel("x over the clearance [1]")
    place.set_ylabel("y over the clearance [1]")
    d = current()
    load = f"{np.hypot(*result.load) * d.force:.4g} {d.force_unit}"
    place.set_title(f"Ring at rest under {load}", loc="left", fontsize=9)
    for axes, values, name in (
        (pressure, result.pressure * d.pressure, f"Largest pressure [{d.pressure_unit}]"),
        (stiffness, result.stiffness * d.stiffness, f"Stiffness [{d.stiffness_unit}]"),
        (damping, result.damping * d.damping, f"Damping of the film [{d.damping_unit}]"),
    ):
        axes.semilogy(result.orbit, values, "-", color=BLUE, lw=1.4)
        axes.set_xlabel("Orbit over the clearance [1]")
        axes.set_ylabel(name)
        axes.set_xlim(0.0, 1.0)
        axes.yaxis.set_major_formatter("{x:g}")
    if result.spring > 0.0:
        stiffness.lines[0].set_label("film")
        spring = result.spring * d.stiffness
        stiffness.axhline(spring, color=ORANGE, lw=1.2, ls="--", label="spring")
        stiffness.legend(frameon=False, fontsize=8)
    title = f"{result.bearing}: centred circular orbits at {speed_with_unit(result.frequency)}"
    figure.suptitle(title, fontsize=10, x=0.01, ha="left")
    return figure


def ring_figure(result: RingCurves) -> Figure:
    """Draw journal and ring at rest, the ring's speed over the rotor's, and stiffness and damping
    over the speed or load."""
    figure, grid = new_figure(8.4, 7.4, 2, 2)
    locus, ratio, *panels = grid.ravel()
    d, (varied, unit, what) = current(), _varied(result)
    mark = "o-" if len(varied) < 3 else "-"
    for x, y, label, color in (
        (result.x, result.y, "journal", BLUE),
        (result.ring_x, result.ring_y, "ring", ORANGE),
    ):
        locus.plot(x * d.small, y * d.small, mark, ms=4, color=color, lw=1.4, label=label)
        locus.plot(x[0] * d.small, y[0] * d.small, "o", color=color)
    circle = result.outer_clearance * d.small * np.exp(1j * ANGLES)
    locus.plot(circle.real, circle.imag, color="black", lw=1.2, label="outer clearance")
    locus.set_aspect("equal")
    locus.set_xlabel(f"x [{d.small_word}]")
    locus.set_ylabel(f"y [{d.small_word}]")
    begin = f"at rest; dots at {varied[0]:.4g} {unit}"
    locus.set_title(f"Journal and ring {begin}", loc="left", fontsize=9)
    inside = {"loc": "upper center", "bbox_to_anchor": (0.5, 0.92)}
    locus.legend(frameon=False, fontsize=8, **inside)
    ratio.plot(varied, result.ratio, mark, ms=4, color=BLUE, lw=1.4)
    ratio.set_ylabel("Speed of the ring over the rotor's [1]")
    ratio.set_ylim(bottom=0.0)
    _coefficients(panels, varied, result.K, result.C, mark)
    for axes in (ratio, *panels):
        axes.set_xlabel(f"{what} [{unit}]")
    figure.suptitle(ring_table(result).title, fontsize=10, x=0.01, ha="left")
    return figure


def rolling_figure(result: RollingCurves) -> Figure:
    """Draw what each element carries under the last load, the stiffness as they pass, and, of
    several loads or speeds, stiffness and damping over them."""
    varied, unit, what = _varied(result)
    last = len(varied) - 1
    rows = 2 if last else 1
    figure = PlainFigure(figsize=(8.4, 0.3 + 3.55 * rows), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    around = figure.add_subplot(rows, 2, 1, projection="polar")
    passing, *over = (figure.add_subplot(rows, 2, place) for place in range(2, 2 * rows + 1))
    for axes in (passing, *over):
        style(axes)
    share = 1.4 * np.pi / len(result.angles)
    d = current()
    around.bar(result.angles, result.elements[last] * d.force, share, color=BLUE)
    loads = np.hypot(*result.load.T) * d.force
    title = f"Load of each element [{d.force_unit}], under {loads[last]:.4g} {d.force_unit}"
    around.set_title(title, loc="left", fontsize=9)
    around.tick_params(labelsize=8)
    turned = np.linspace(0.0, 1.0, result.K_passing.shape[1] + 1)
    for i, line in ((last, "-"), (0, "--"))[: 2 if last else 1]:
        for axis, color in ((0, BLUE), (1, ORANGE)):
            values = result.K_passing[i, :, axis, axis] * d.stiffness
            label = f"k{'xy'[axis]}{'xy'[axis]} under {loads[i]:.4g} {d.force_unit}"
            values = np.append(values, values[0])
            passing.plot(turned, values, line, color=color, lw=1.4, label=label)
    passing.set_title("As the elements pass", loc="left", fontsize=9)
    passing.set_xlabel("Cage's angle over that between two elements [1]")
    passing.set_ylabel(f"Stiffness [{d.stiffness_unit}]")
    passing.margins(y=0.25)
    passing.legend(frameon=False, fontsize=8, ncols=2, loc="upper left")
    if over:
        _coefficients(over, varied, result.K, result.C, "o-" if last < 3 else "-")
    for axes in over:
        axes.set_xlabel(f"{what} [{unit}]")
    figure.suptitle(rolling_table(result).title, fontsize=10, x=0.01, ha="left")
    return figure
