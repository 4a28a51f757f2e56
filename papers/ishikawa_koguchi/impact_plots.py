"""Pictures of paper B's experiments: its figures 3 to 7 and 10 to 12, and some beside them."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure

from .impact.bars import BarsRun
from .impact.ratchet import RatchetRun

PURPLE, SKY = "#cc79a7", "#56b4e9"
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY, "#000000")
_DASHES = ("-", (0, (5, 1.6)), (0, (1.2, 1.2)), (0, (6, 1.5, 1.2, 1.5)))


def panels(rows: int, width: float, height: float, **options: Any) -> tuple[Figure, list]:
    """A figure with several pairs of axes one below another, in the look of `new_figure`."""
    figure = Figure(figsize=(width, height), dpi=150, layout="constrained")
    FigureCanvasAgg(figure)
    axes = list(np.ravel(figure.subplots(rows, 1, **options)))
    for one in axes:
        one.spines[["top", "right"]].set_visible(False)
        one.grid(color="#dddddd", linewidth=0.6)
        one.set_axisbelow(True)
    return figure, axes


def tip_velocity(runs: Sequence[tuple[float, BarsRun]], caption: str) -> Figure:
    """Velocity of the left bar's end at each increment length dt [s], with the wave solution."""
    figure, axes = panels(len(runs), 6.4, 1.0 + 2.1 * len(runs), sharex=True, sharey=True)
    # one scale, so that the panels can be compared
    largest = max(float(np.nanmax(np.abs(result.tip_velocity))) for _, result in runs)
    largest = min(max(2.0, 1.4 * largest), 50.0)
    axes[0].set_ylim(-largest, largest)
    for one, (dt, result) in zip(axes, runs, strict=True):
        bars = result.bars
        t = np.array([0, bars.t_impact, bars.t_impact, bars.t_release, bars.t_release, 0.04])
        wave = bars.speed * np.array([1.0, 1.0, 0.0, 0.0, -1.0, -1.0])
        one.plot(1e3 * t, wave, color=GREY, lw=3.5, label="wave solution", solid_capstyle="butt")
        mark = {"marker": ".", "ms": 5} if len(result.t) < 200 else {}
        text = f"$\\Delta t$ = {dt:g} s"
        if result.is_complete:
            text += f": RMS error {result.rms_error():.3g} m/s"
        one.plot(1e3 * result.t, result.tip_velocity, color=BLUE, lw=1.0, label=text, **mark)
        one.set_ylabel("Tip velocity [m/s]")
        one.legend(frameon=False, loc="upper right", fontsize=8.5, ncols=2)
    axes[-1].set_xlabel("Time [ms]")
    axes[-1].set_xlim(0, 1e3 * max(result.t[-1] for _, result in runs))
    axes[0].set_title(caption, loc="left", fontsize=10)
    return figure


def _curves(axes: Axes, curves: Mapping[str, tuple[np.ndarray, np.ndarray]]) -> None:
    for k, (label, (x, y)) in enumerate(curves.items()):
        dash = _DASHES[k % len(_DASHES)]
        axes.plot(x, y, color=COLOURS[k % len(COLOURS)], ls=dash, lw=1.5, label=label)


def bars_energy(runs: Mapping[str, BarsRun], dt: float) -> Figure:
    """Energy of both bars over time, relative to the start: all of it, and near one."""
    figure, axes = panels(2, 6.8, 6.0, sharex=True)
    curves = {name: (1e3 * r.t, r.run.energy / r.run.energy[0]) for name, r in runs.items()}
    for one in axes:
        _curves(one, curves)
    largest = float(np.nanmax([np.nanmax(y) for _, y in curves.values()]))
    if largest > 2:
        axes[0].set_yscale("log")
        axes[0].set_ylim(0.8, 1.3 * min(largest, 1e6))
        axes[0].set_yticks([tick for tick in (1, 2, 5, 10, 20, 50) if tick <= largest])
        axes[0].yaxis.set_major_formatter("{x:g}")
        axes[0].minorticks_off()
    axes[1].set_ylim(0.96, 1.04)
    axes[1].set_xlabel("Time [ms]")
    figure.supylabel("Energy of both bars over that at the start [1]", fontsize=10)
    caption = f"What the integrators make of the energy, $\\Delta t$ = {dt:g} s"
    axes[0].set_title(caption, loc="left", fontsize=10)
    axes[0].legend(frameon=False, fontsize=8.5)
    return figure


def bars_momentum(runs: Mapping[str, BarsRun], dt: float) -> Figure:
    """Momentum of the left bar over time, and how far it is from the wave solution's."""
    figure, axes = panels(2, 6.8, 6.0, sharex=True)
    bars = next(iter(runs.values())).bars
    whole = bars.energy / bars.speed
    wave = 1e3 * np.array([0.0, bars.t_impact, bars.t_release, 0.04]), [1, 1, -1, -1]
    axes[0].plot(*wave, color=GREY, lw=3.5, label="wave solution")
    seen = {name: (1e3 * r.t, r.run.seen[:, 1] / whole) for name, r in runs.items()}
    _curves(axes[0], seen)
    _curves(axes[1], {name: (t, p - np.interp(t, *wave)) for name, (t, p) in seen.items()})
    # the curves that hide each other above, not the one that leaves them
    apart = sorted(float(np.nanmax(np.abs(p - np.interp(t, *wave)))) for t, p in seen.values())
    axes[1].set_ylim(-2 * apart[len(apart) // 2], 2 * apart[len(apart) // 2])
    axes[0].set_ylabel("Momentum of the left bar\nover that at the start [1]")
    axes[1].set_ylabel("The same less\nthe wave solution's [1]")
    axes[1].set_xlabel("Time [ms]")
    axes[0].set_title(f"Momentum handed over, $\\Delta t$ = {dt:g} s", loc="left", fontsize=10)
    axes[0].legend(frameon=False, fontsize=8.5)
    return figure


def wheel_speeds(runs: Mapping[str, RatchetRun], caption: str) -> Figure:
    """Angular velocity of the ratchet wheel (paper B, Figure 10)."""
    figure, axes = new_figure(6.8, 4.4)
    ratchet = next(iter(runs.values())).ratchet
    t0 = ratchet.t_locking
    axes.plot(
        [0, 1e3 * t0],
        [0, t0 * ratchet.acceleration],
        color=GREY,
        lw=4,
        label="rigid pawl, closed form",
    )
    for k, (name, result) in enumerate(runs.items()):
        style: dict[str, Any] = {"color": COLOURS[k], "ls": _DASHES[k % 4], "lw": 1.6}
        label = name if result.run.is_done else f"{name}: stalls at {1e3 * result.t[-1]:.3g} ms"
        axes.plot(1e3 * result.t, result.wheel_speed, label=label, **style)
        if not result.run.is_done:
            axes.plot(1e3 * result.t[-1], result.wheel_speed[-1], "X", color=COLOURS[k], ms=9)
    axes.set_xlabel("Time [ms]")
    axes.set_ylabel("Angular velocity of the wheel [rad/s]")
    axes.set_title(caption, loc="left", fontsize=10)
    axes.legend(frameon=False, fontsize=8.5)
    return figure


def stall(name: str, result: RatchetRun, others: Mapping[str, RatchetRun], caption: str) -> Figure:
    """Where the increments of a run go (beside paper B, Figure 11): its pawl, those of others, and
    the time that each has reached."""
    runs = {name: result, **others}
    figure, axes = panels(len(runs) + 1, 6.8, 2.6 + 1.5 * len(runs))
    last = max(2 * result.t[-1], 1e-4) if not result.run.is_done else result.t[-1]
    for k, (label, run) in enumerate(runs.items()):
        inside = run.t <= last
        style: dict[str, Any] = {"color": (ORANGE, *COLOURS[2:])[k], "ls": _DASHES[k % 4]}
        mark = {"marker": ".", "ms": 3} if k == 0 else {}
        axes[k].plot(
            1e3 * run.t[inside], run.pawl_speed[inside], lw=1.2, label=label, **style, **mark
        )
        axes[k].sharex(axes[0])
        axes[k].sharey(axes[0])
        axes[k].set_ylabel("Pawl [rad/s]")
        axes[-1].plot(1e3 * run.t, lw=1.6, label=label, **style)
        for one in (axes[k], axes[-1]):
            one.legend(frameon=False, fontsize=8.5, loc="lower right")
    axes[-2].set_xlabel("Time [ms]")
    axes[-1].set_xlabel("Increments used")
    axes[-1].set_ylabel("Time reached [ms]")
    axes[-1].set_yscale("log")
    axes[0].set_title(caption, loc="left", fontsize=10)
    return figure


def shaking(runs: Mapping[str, RatchetRun], caption: str) -> Figure:
    """Angular velocity of the pawl while it slides (paper B, Figure 12)."""
    figure, axes = panels(2, 6.8, 5.6)
    ratchet = next(iter(runs.values())).ratchet
    t0 = ratchet.t_locking
    windows = ((0.0, 0.97 * t0), (0.5 * t0, 0.55 * t0))
    for one, (first, last) in zip(axes, windows, strict=True):
        for k, (name, result) in enumerate(runs.items()):
            inside = (result.t >= first) & (result.t <= last)
            label = f"{name}: {result.fast_content:.2g} rad/s RMS about the moving mean"
            front = {"zorder": 2 + k, "lw": 1.0 if k == 0 else 1.8}
            mark = {"marker": ".", "ms": 4} if one is axes[1] and k == 0 else {}
            colour = (BLUE, ORANGE)[k % 2]
            one.plot(
                1e3 * result.t[inside],
                result.pawl_speed[inside],
                color=colour,
                label=label,
                **front,
                **mark,
            )
        one.set_ylabel("Pawl [rad/s]")
        one.set_xlim(1e3 * first, 1e3 * last)
    low, high = axes[0].get_ylim()
    axes[0].set_ylim(low, high + 0.35 * (high - low))
    axes[0].legend(frameon=False, fontsize=8.5, loc="upper left")
    axes[0].set_title(caption, loc="left", fontsize=10)
    axes[1].set_xlabel("Time [ms]")
    return figure
