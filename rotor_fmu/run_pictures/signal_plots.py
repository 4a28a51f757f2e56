"""Pictures of recorded signals, one function a kind, for `rotor-fmu plot`."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import PowerNorm
from matplotlib.figure import Figure

from .. import vibration
from ..display import current, shown_speed
from ..plotting.colors import BLACK, BLUE, COLORS, DASHED, GREEN, GREY, ORANGE, PURPLE
from ..plotting.figure_style import (
    annotate,
    broken_at_turns,
    empty_figure,
    legend_below,
    new_figure,
)
from ..plotting.labels import write_labels
from ..runs.measuring_points import ContactSignals, moves_most
from .view import View, angle_axis, broken_at_reversals, displacement_axes, two_over_speed, widened

# Of the largest line of a spectrum, and of a cascade: smaller ones do not widen its axis.
_SEEN, _BRIGHT = 0.01, 0.1
_ORBIT_TURNS, _BLOCK_TURNS = 4, 16
# Radii of an orbit beyond which the place of rest, drawn, would leave a dot of it; what is farther
# from it still is a place that stands.
_FAR, _STANDS = 10, 1e5
FINE = 24  # rows a turn, below which a curve between them is drawn, not computed


def _speed(omega: Any) -> Any:
    return omega * current().speed


def bode(view: View) -> Figure:
    """Draw the 1x amplitude and phase of x and y over speed, with 2x and 0.5x."""
    figure, (above, below) = two_over_speed()
    track = vibration.order_track(*view.signal)
    n = _speed(track.speed)
    for vector, color, label, style in (
        (track.x(), BLUE, "1x of x", (0, ())),
        (track.y(), ORANGE, "1x of y", DASHED),
    ):
        length = broken_at_reversals(n, np.abs(vector) * view.shown.amplitude)
        above.plot(n, length, color=color, lw=1.5, ls=style, label=label)
        phase = broken_at_reversals(n, np.angle(vector))
        below.plot(*broken_at_turns(n, phase), color=color, lw=1.2, ls=style)
    for order, color, dashes in ((2.0, GREEN, (0, (1, 1))), (0.5, PURPLE, (0, (5, 1, 1, 1)))):
        label = f"{order:g}x, major axis"
        length = broken_at_reversals(n, track.major(order) * view.shown.amplitude)
        above.plot(n, length, color=color, lw=1.1, ls=dashes, label=label)
    above.legend(frameon=False, fontsize=8)
    above.set_ylim(bottom=0)
    above.set_ylabel(f"Amplitude [{view.shown.amplitude_unit}]")
    below.set_ylabel("Phase to the mark [deg]")
    below.set_yticks([-180, -90, 0, 90, 180])
    below.set_ylim(-190, 190)
    below.set_xlim(widened(below.get_xlim()))
    view.title(above, f"Bode plot of {view.place.label}")
    return figure


def polar(view: View) -> Figure:
    """Draw the 1x vector of x over speed, from the keyphasor mark; lag clockwise."""
    figure = empty_figure(5.8, 5.4)
    axes = figure.add_subplot(projection="polar")
    track = vibration.order_track(*view.signal, (1.0,))
    speeds, curves = [], []
    for vector, color, label, style in (
        (track.x(), BLUE, "1x of x", "-"),
        (track.y(), ORANGE, "1x of y", DASHED),
    ):
        radius = broken_at_reversals(track.speed, np.abs(vector) * view.shown.amplitude)
        curves += axes.plot(np.angle(vector), radius, color=color, lw=1.2, ls=style, label=label)
        speeds += _speeds_along(axes, vector * view.shown.amplitude, track.speed, color)
    axes.legend(frameon=False, fontsize=8, loc="lower left", bbox_to_anchor=(-0.12, -0.08))
    axes.grid(color="#dddddd", linewidth=0.6)
    axes.tick_params(labelsize=8)
    units = f"radius [{view.shown.amplitude_unit}], speeds in {current().speed_unit}"
    view.title(axes, f"polar plot of {view.place.label}\n{units}")
    write_labels(axes, speeds, curves=curves)
    return figure


def _speeds_along(
    axes: Axes, vector: np.ndarray, speed: np.ndarray, color: str
) -> list[tuple[float, float, str, bool]]:
    """Draw points of a curve where it has gone a share of its length; return labels with their
    speeds."""
    labels = []
    length = np.concatenate([[0.0], np.cumsum(np.abs(np.diff(vector)))])
    for share in (0.1, 0.3, 0.5, 0.7, 0.9):
        i = int(np.searchsorted(length, share * length[-1]))
        where = (float(np.angle(vector[i])), float(np.abs(vector[i])))
        axes.plot(*where, "o", color=color, ms=3)
        labels.append((*where, shown_speed(speed[i]), True))
    return labels


def orbit(view: View, caption: str = "") -> Figure:
    """Draw the orbit at a speed or a time as it was recorded, with the keyphasor marks, where it
    was at rest, or released, and the clearance; caption: by default what it is."""
    figure, axes = new_figure(5.4, 5.2)
    place, shown = view.place, view.turns(_ORBIT_TURNS)
    small = current().small
    z = place.z[shown.rows] * small
    per_turn = vibration.rows_per_turn(view.run.phi[shown.rows])
    name, marker = f"{shown.turns} turns at {shown_speed(shown.speed)} {current().speed_unit}", ""
    if not shown.turns:
        name = "at standstill"
    elif per_turn < FINE:
        name, marker = f"{name}, its corners the steps, {per_turn:.0f} a turn", "."
    axes.plot(z.real, z.imag, color=BLUE, lw=1.0, marker=marker, ms=3, label=name)
    if shown.turns and per_turn >= FINE:
        section = vibration.poincare(*view.signal)
        is_shown = (section.t >= shown.begin) & (section.t < shown.end)
        marks = section.points[is_shown] * small
        axes.plot(marks.real, marks.imag, "o", color=ORANGE, ms=5, label="keyphasor mark")
        ahead = z[max(1, round(per_turn / FINE))]
        arrow = {"arrowstyle": "-|>", "color": ORANGE, "lw": 1.4}
        axes.annotate("", (ahead.real, ahead.imag), (z[0].real, z[0].imag), arrowprops=arrow)
    rest, begin = place.z[0] * small, "release" if view.run.is_released else "rest"
    away, radius = abs(rest - z.mean()), np.abs(z - z.mean()).max()
    if _FAR * radius < away < _STANDS * radius and place.clearance is None:
        begin, rest = f"{begin}: {away:.3g} {current().small_unit} away", np.complex128(np.nan)
    axes.plot(rest.real, rest.imag, "+", color=GREY, ms=10, mew=1.5, label=begin)
    displacement_axes(axes, place)
    legend_below(figure, 2)
    view.title(axes, caption or f"orbit of {place.label}")
    return figure


def spectrum(view: View) -> Figure:
    """Draw the full spectrum at a speed."""
    figure, axes = new_figure()
    result = vibration.full_spectrum(*view.signal, view.speed)
    frequency = _speed(result.frequency)
    amplitude = result.amplitude * view.shown.amplitude
    axes.vlines(frequency, 0, amplitude, color=BLUE, lw=1.2)
    for i in _lines(amplitude):
        top = frequency[i], amplitude[i]
        annotate(axes, f"{result.order[i]:+.3g}x", top, (0, 3), ha="center")
    axes.axvline(0, color=GREY, lw=0.8)
    axes.set_ylim(bottom=0)
    reach = _reach(frequency, amplitude, _SEEN, abs(_speed(result.speed)))
    axes.set_xlim(-reach, reach)
    axes.set_xlabel(f"Whirl frequency [{current().frequency_unit}], backward < 0 < forward")
    axes.set_ylabel(f"Amplitude [{view.shown.amplitude_unit}]")
    at = f"{shown_speed(result.speed)} {current().speed_unit}"
    view.title(axes, f"full spectrum of {view.place.label} at {at}")
    return figure


def _reach(frequency: np.ndarray, amplitude: np.ndarray, share: float, once: float) -> float:
    """Return the frequency up to which spectra are shown: as far as there is something to see, on
    either side, and beyond 3x of a speed; share: of the largest line, which smaller ones lack."""
    seen = np.abs(frequency[amplitude > share * np.nanmax(amplitude, initial=0.0)])
    return min(1.1 * max(3 * once, float(seen.max(initial=0.0))), float(np.abs(frequency).max()))


def _lines(amplitude: np.ndarray) -> list[int]:
    """Return the largest lines of a spectrum, without what the window puts beside each."""
    inner = amplitude[1:-1]
    tops = 1 + np.flatnonzero((inner > amplitude[:-2]) & (inner >= amplitude[2:]))
    tops = tops[amplitude[tops] > 0.02 * np.nanmax(amplitude, initial=0)]
    return tops[np.argsort(-amplitude[tops])][:5].tolist()


def cascade(view: View) -> Figure:
    """Draw full spectra over speed, or over time where the speed does not go one way."""
    figure, axes = new_figure(6.8, 5.0)
    signal = vibration.synchronous(*view.signal, turns=_BLOCK_TURNS + 1)  # two blocks of them
    result = vibration.cascade_of(signal, turns=_BLOCK_TURNS)
    down = _speed(result.speed) if result.is_one_way else result.t
    across = _speed(result.frequency)
    amplitude = np.nan_to_num(result.amplitude) * view.shown.amplitude
    # small lines are seen beside large ones on the root's scale
    norm = PowerNorm(0.4, 0, max(float(amplitude.max(initial=0)), 1e-9))
    look: dict[str, Any] = {"cmap": "cividis", "norm": norm, "shading": "gouraud"}
    for number in np.unique(result.passage):
        # nothing is drawn over a rest or a reversal
        rows = np.flatnonzero(result.passage == number)
        if len(rows) > 1:
            x_y = across[rows], np.broadcast_to(down[rows, None], across[rows].shape)
            axes.pcolormesh(*x_y, amplitude[rows], rasterized=True, **look)
    once = np.abs(_speed(result.speed))
    limit = _reach(across, amplitude, _BRIGHT, float(once.max()))
    fastest = int(np.argmax(once))
    is_top = down[fastest] == down.max()
    for order in (-2, -1, 1, 2):
        axes.plot(order * once, down, color="white", lw=0.6, ls=(0, (3, 4)))
        x, y = order * float(once[fastest]), float(down[fastest])
        if abs(x) < limit:
            color = BLACK if is_top else "white"
            above = {"ha": "center", "va": "bottom", "annotation_clip": False}
            annotate(axes, f"{order:+d}x", (x, y), (0, 2), color=color, **above)
    axes.set_xlim(-limit, limit)
    axes.grid(visible=False)
    shades = ScalarMappable(norm, look["cmap"])
    figure.colorbar(shades, ax=axes, label=f"Amplitude [{view.shown.amplitude_unit}]")
    axes.set_xlabel(f"Whirl frequency [{current().frequency_unit}], backward < 0 < forward")
    axes.set_ylabel(current().speed_label if result.is_one_way else "Time [s]")
    kind = "cascade" if result.is_one_way else "waterfall"
    view.title(axes, f"{kind} of the full spectrum of {view.place.label}", pad=16)
    return figure


def poincare(view: View) -> Figure:
    """Draw the points of the Poincare section, coloured by the speed, with the clearance."""
    figure, axes = new_figure(6.0, 5.2)
    result = vibration.poincare(*view.signal)
    _coloured_by_speed(figure, axes, result.points, result.speed)
    displacement_axes(axes, view.place)
    view.title(axes, f"{view.place.label} once a turn, at the mark")
    return figure


def centerline(view: View) -> Figure:
    """Draw the shaft's mean place, coloured by the speed, in the clearance: by default of the place
    in one that moves most."""
    within = [place for place in view.run.places if place.clearance is not None]
    if view.name is None and within:
        view = replace(view, name=moves_most(within).name)
    figure, axes = new_figure(6.0, 5.2)
    signal = vibration.synchronous(*view.signal)
    turns = min(_BLOCK_TURNS, signal.longest)
    result = vibration.displacement_of(signal, turns=turns)
    _coloured_by_speed(figure, axes, result.mean, result.speed)
    displacement_axes(axes, view.place)
    view.title(axes, f"shaft centerline of {view.place.label}, means of {turns} turns")
    return figure


def _coloured_by_speed(figure: Figure, axes: Axes, z: np.ndarray, speed: np.ndarray) -> None:
    x_y = z * current().small
    shown = axes.scatter(x_y.real, x_y.imag, c=_speed(speed), s=6, cmap="cividis", lw=0)
    shown.set_clim(widened(shown.get_clim()))
    figure.colorbar(shown, ax=axes, label=current().speed_label)


def whirl(view: View) -> Figure:
    """Draw the sense and the order of the whirl."""
    figure, (above, below) = two_over_speed()
    signal = vibration.synchronous(*view.signal, turns=3)
    result = vibration.whirl_of(signal, turns=_BLOCK_TURNS)
    n = _speed(result.speed)
    above.axhline(0, color=GREY, lw=0.8)
    above.plot(n, result.sense, ".", color=BLUE, ms=3, mew=0)
    above.set_ylim(-1.08, 1.08)
    above.set_yticks([-1, 0, 1], ["backward", "line", "forward"])
    above.set_ylabel("Sense of whirl [1]")
    below.plot(n, result.order, ".", color=ORANGE, ms=3, mew=0)
    below.axhline(0, color=GREY, lw=0.8)
    below.set_ylabel("Whirl over rotation [1]")
    turns = min(_BLOCK_TURNS, signal.longest)
    view.title(above, f"whirl of {view.place.label}, over {turns} turns each")
    return figure


def contact_angle(view: View) -> Figure:
    """Draw the contact angle over speed."""
    figure, axes = new_figure()
    contact = view.run.contact(view.name, with_angle=True)
    touches = contact.fn > 0
    n = _speed(view.run.w[touches])
    axes.plot(n, np.degrees(contact.psi[touches]), ".", color=GREY, ms=1.2, mew=0, rasterized=True)
    result = vibration.contact(view.run.t, view.run.phi, contact.psi, contact.fn)
    at, low = _speed(result.speed), np.degrees(result.low)
    high = low + np.degrees(result.width)
    for bottom, top in ((low, np.minimum(high, 360)), (np.zeros_like(low), high - 360)):
        there = top > bottom
        axes.vlines(at[there], bottom[there], top[there], color=BLUE, alpha=0.2)
    axes.plot(at, np.degrees(result.angle), ".", color=BLUE, ms=3, mew=0)
    axes.plot([], [], ".", color=GREY, label="every recorded step that touches")
    axes.plot([], [], "|", color=BLUE, alpha=0.4, ms=12, label="range of a turn")
    axes.plot([], [], ".", color=BLUE, label="mean of a turn that does not go all round")
    legend_below(figure)
    angle_axis(axes, "")
    axes.set_xlabel(current().speed_label)
    if not touches.any():
        speeds = _speed(view.run.w)
        axes.update_datalim([(speeds.min(), 0.0), (speeds.max(), 0.0)])
        axes.autoscale_view(scaley=False)
    view.title(axes, f"where {contact.label} touches{_nowhere(contact)}")
    return figure


def contact_force(view: View) -> Figure:
    """Draw the normal force of a contact and the share of the time that it touches, over speed."""
    figure, (above, below) = two_over_speed()
    contact = view.run.contact(view.name)
    result = vibration.contact(view.run.t, view.run.phi, contact.psi, contact.fn, contact.peak)
    n, d = _speed(result.speed), current()
    largest = broken_at_reversals(n, result.peak * d.force)
    mean = broken_at_reversals(n, result.mean * d.force)
    above.plot(n, largest, color=BLUE, lw=1.0, label="largest of the turn")
    above.plot(n, mean, color=ORANGE, lw=1.2, ls=DASHED, label="mean of the turn")
    above.legend(frameon=False, fontsize=8)
    above.set_ylim(bottom=0)
    above.set_ylabel(f"Normal force [{d.force_unit}]")
    below.plot(n, broken_at_reversals(n, 100 * result.share), color=GREEN, lw=1.0)
    below.set(ylim=(0, 105), ylabel="Touches [% of the turn]")
    view.title(above, f"contact force of {contact.label}{_nowhere(contact)}")
    return figure


def _nowhere(contact: ContactSignals) -> str:
    return "" if (contact.peak > 0).any() else ": nowhere in this run"


def energy(view: View) -> Figure:
    """Draw the power of every sink over speed, and the energy since the start."""
    run = view.run
    run.check_losses()
    figure, (above, below) = two_over_speed((1, 1))
    sinks = run.sinks
    _, speed, powers = vibration.power_by_sink(run.t, run.phi, sinks)
    for i, (name, energy) in enumerate(sinks.items()):
        color, style = COLORS[i % len(COLORS)], ("-", DASHED, (0, (1, 1)))[i % 3]
        total = energy[-1]
        label = f"{total:.3g} J" if abs(total) < 1e3 else f"{total / 1e3:.4g} kJ"
        power = broken_at_reversals(speed, powers[name])
        above.plot(_speed(speed), power, color=color, ls=style, lw=1.2, label=f"{name}: {label}")
        below.plot(_speed(run.w), energy, color=color, ls=style, lw=1.2)
    above.legend(frameon=False, fontsize=8)
    above.set_ylabel("Power [W], mean of a turn")
    below.set_ylabel("Energy since the start [J]")
    view.title(above, "energy dissipated by sink")
    return figure


KINDS: dict[str, Callable[[View], Figure]] = {
    "bode": bode,
    "polar": polar,
    "orbit": orbit,
    "cascade": cascade,
    "poincare": poincare,
    "contact-angle": contact_angle,
    "contact-force": contact_force,
    "energy": energy,
    "spectrum": spectrum,
    "whirl": whirl,
    "centerline": centerline,
}
