"""Pictures of a survey, one a finding."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..figures import BLUE, GREEN, GREY, ORANGE, new_figure
from .findings import Findings, median, title_of

_PURPLE, _SKY = "#cc79a7", "#56b4e9"
# Schemes that the curves show; the tables have them all.
SHOWN = {
    "newmark": (GREY, "o"),
    "generalized-alpha=0.1,0.08": (ORANGE, "s"),
    "hht=0.1": (_SKY, "v"),
    "moderate-dissipation": (GREEN, "^"),
    "chung-hulbert=0.5": (_PURPLE, "D"),
    "chung-hulbert=0.2": (BLUE, "o"),
}
_STEP_LABEL = "Step length $h$ [ms]"


def _step_axis(axes: Axes, steps: Sequence[float]) -> None:
    axes.set_xscale("log")
    ticks = [h * 1e3 for h in steps]
    axes.set_xticks(ticks[::2], [f"{t:.2g}" for t in ticks[::2]])
    axes.set_xticks([], minor=True)
    axes.set_xlabel(_STEP_LABEL)


def error(findings: Findings) -> Figure:
    """Error of the run-down's amplitudes against step length."""
    figure, axes = new_figure(7.0, 4.4)
    steps = findings.steps("rotor")
    for label, (color, marker) in SHOWN.items():
        h, value, is_safe = [], [], []
        for step in steps:
            rows = findings.of("rotor", scheme=label, h=step)
            middle = median(rows, "error")
            if middle is not None:
                h.append(step * 1e3)
                value.append(middle * 100)
                is_safe.append(not findings.trapped_share(label, step))
        axes.plot(h, value, color=color, lw=1.3, label=title_of(label))
        fill = [color if safe else "white" for safe in is_safe]
        axes.scatter(h, value, c=fill, edgecolors=color, marker=marker, s=28, zorder=3)
    axes.set_yscale("log")
    _step_axis(axes, steps)
    axes.set_ylabel("Error of the amplitudes [%]")
    axes.legend(frameon=False, fontsize=8, loc="upper left", ncols=2)
    axes.set_title(
        "Run-down: median error of twelve runs; open: some in the false state",
        loc="left",
        fontsize=10,
    )
    return figure


def false_states(findings: Findings) -> Figure:
    """Share of the run-downs in the false state, and what the map of one impact predicts."""
    figure = Figure(figsize=(8.6, 5.4), dpi=150, layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    schemes, steps = findings.schemes("bounce"), findings.steps("rotor")
    speed = findings.impact_speed()
    contents: tuple[tuple[str, Callable[[str, float], float | None]], ...] = (
        ("seen: share of twelve run-downs", findings.trapped_share),
        (
            f"predicted: share of single impacts at {speed:.2g} m/s",
            lambda label, h: findings.bounce_share(label, h, speed),
        ),
    )
    for axes, (title, share) in zip(panels, contents, strict=True):
        values = np.array(
            [[np.nan if (s := share(x, h)) is None else s for h in steps] for x in schemes]
        )
        image = axes.imshow(values, cmap="cividis", vmin=0, vmax=1, aspect="auto")
        for i, j in np.ndindex(values.shape):
            text = "x" if np.isnan(values[i, j]) else f"{values[i, j]:.1f}".lstrip("0")
            if values[i, j] != 0:
                shade = "black" if values[i, j] > 0.6 or text == "x" else "white"
                text = "1" if text == "1.0" else text
                axes.text(j, i, text, ha="center", va="center", fontsize=6, color=shade)
        axes.set_xticks(range(len(steps)), [f"{h * 1e3:.2g}" for h in steps], fontsize=7)
        axes.set_yticks(range(len(schemes)), [title_of(x) for x in schemes], fontsize=8)
        axes.set_xlabel(_STEP_LABEL)
        axes.set_title(title, loc="left", fontsize=9)
    figure.colorbar(image, ax=panels, shrink=0.7, label="share in the false state [1]")
    figure.suptitle(
        "The false state: seen in the run-down, predicted from one impact (x: diverged)",
        x=0.01,
        ha="left",
        fontsize=10,
    )
    return figure


def bars(findings: Findings) -> Figure:
    """Error of the bars' tip velocity, with and without average-time impact, at 5e-5 s."""
    figure, axes, h = _by_impact(findings, "bars", 5e-5, "error")
    ticks = (0.15, 0.2, 0.3, 0.5, 1, 2, 5)
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("RMS error of the tip velocity / speed [1]")
    axes.set_title(
        f"Bars, h = {h * 1e3:g} ms: a restitution near 1, or average time (x: stalled)",
        loc="left",
        fontsize=10,
    )
    return figure


def ratchet(findings: Findings) -> Figure:
    """High-frequency content of the pawl at 1e-5 s."""
    figure, axes, h = _by_impact(findings, "ratchet", 1e-5, "fast")
    axes.set_xlabel("High-frequency content of the pawl's speed [rad/s]")
    axes.set_title(
        f"Ratchet, h = {h * 1e3:g} ms: average time fails (x: stalled or diverged)",
        loc="left",
        fontsize=10,
    )
    return figure


def _by_impact(
    findings: Findings, experiment: str, h: float, column: str
) -> tuple[Figure, Axes, float]:
    """A column for all schemes at the step nearest to h [s], by the treatment of the impact."""
    figure, axes = new_figure(6.8, 5.0)
    schemes = findings.schemes(experiment)
    h = findings.nearest_step(experiment, h)
    for impact, color, marker, aside in (
        ("no", ORANGE, "o", 0.985),
        ("average-time", BLUE, "s", 0.955),
    ):
        shown: list[tuple[float | None, int]] = []
        ended: list[tuple[float | None, int]] = []
        for i, scheme in enumerate(schemes):
            for row in findings.of(experiment, scheme=scheme, h=h, case=impact):
                is_whole = row["status"] == "ok" and column in row
                (shown if is_whole else ended).append((row.get(column), i))
        label = f"impact = {impact}"
        axes.plot(*np.array(shown).reshape(-1, 2).T, marker, color=color, ms=5, label=label)
        axes.plot(
            [aside] * len(ended),
            [i for _, i in ended],
            "x",
            color=color,
            ms=5,
            mew=1.5,
            transform=axes.get_yaxis_transform(),
        )
    axes.set_xscale("log")
    low, high = axes.get_xlim()
    axes.set_xlim(low, high * (high / low) ** 0.08)
    axes.set_yticks(range(len(schemes)), [title_of(s) for s in schemes], fontsize=8)
    axes.invert_yaxis()
    axes.legend(frameon=False, fontsize=8, ncols=2, loc="upper right", bbox_to_anchor=(1, -0.1))
    return figure, axes, h
