"""Pictures of a survey, one a finding."""

from collections.abc import Callable, Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, to_hex
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure

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
    """Error of the run-down's amplitudes against step length, a panel a scheme among the others."""
    figure = Figure(figsize=(9.0, 5.6), dpi=150, layout="constrained")
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    steps = findings.steps("rotor")
    curves = {label: _errors(findings, label, steps) for label in SHOWN}
    for axes, (label, (color, _)) in zip(panels.flat, SHOWN.items(), strict=True):
        for h, value, _ in curves.values():
            axes.plot(h, value, color="#dddddd", lw=1.2)
        h, value, is_safe = curves[label]
        axes.plot(h, value, color=color, lw=1.8)
        fill = [color if safe else "white" for safe in is_safe]
        axes.scatter(h, value, c=fill, edgecolors=color, s=34, lw=1.4, zorder=3)
        axes.set_title(title_of(label), loc="left", fontsize=10, color=color)
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_yscale("log")
        _step_axis(axes, steps)
        axes.set_yticks([0.3, 1, 3, 10, 30], ["0.3", "1", "3", "10", "30"])
        axes.set_yticks([], minor=True)
        axes.grid(color="#eeeeee", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.label_outer()
    for axes in panels[:, 0]:
        axes.set_ylabel("Error of the amplitudes [%]")
    figure.suptitle(
        "Run-down: median error of twelve runs (open: some of them in the false state; grey: the "
        "other schemes)",
        x=0.01,
        ha="left",
        fontsize=10,
    )
    return figure


def _errors(
    findings: Findings, label: str, steps: Sequence[float]
) -> tuple[list[float], list[float], list[bool]]:
    """Steps [ms] of a scheme with their median errors [%], and whether no run is in the false
    state."""
    result = []
    for step in steps:
        middle = median(findings.of("rotor", scheme=label, h=step), "error")
        if middle is not None:
            result.append((1e3 * step, 100 * middle, not findings.trapped_share(label, step)))
    h, value, is_safe = zip(*result, strict=True)
    return list(h), list(value), list(is_safe)


def false_states(findings: Findings) -> Figure:
    """Share of the run-downs in the false state, and what the map of one impact predicts."""
    figure = Figure(figsize=(9.4, 6.0), dpi=150, layout="constrained")
    panels = figure.subplots(1, 2, sharey=True)
    schemes, steps = findings.schemes("bounce"), findings.steps("rotor")
    speed = findings.impact_speed()
    contents: tuple[tuple[str, Callable[[str, float], float | None]], ...] = (
        ("seen: of twelve run-downs", findings.trapped_share),
        (
            f"predicted: of single impacts at {speed:.2g} m/s",
            lambda label, h: findings.bounce_share(label, h, speed),
        ),
    )
    shades = ["#f2f2f2", *(to_hex(c) for c in colormaps["cividis_r"](np.linspace(0.1, 1.0, 4)))]
    colors = ListedColormap(shades)
    norm = BoundaryNorm([-0.5, 1e-9, 0.25, 0.5, 0.75, 1.0], colors.N)
    for axes, (title, share) in zip(panels, contents, strict=True):
        values = np.array(
            [[np.nan if (s := share(x, h)) is None else s for h in steps] for x in schemes]
        )
        axes.pcolormesh(values, cmap=colors, norm=norm, edgecolor="white", lw=1.0)
        for i, j in np.argwhere(np.isnan(values)):
            axes.plot(j + 0.5, i + 0.5, "x", color="black", ms=7, mew=1.3)
        axes.set_xticks(np.arange(len(steps)) + 0.5, [f"{h * 1e3:.2g}" for h in steps], fontsize=9)
        axes.set_yticks(np.arange(len(schemes)) + 0.5, [title_of(x) for x in schemes], fontsize=9)
        axes.set_xlabel(_STEP_LABEL)
        axes.set_title(title, loc="left", fontsize=10)
        axes.tick_params(length=0)
        axes.spines[:].set_visible(False)
    panels[0].invert_yaxis()
    said = ("none", "below 1/4", "below 1/2", "below 3/4", "3/4 and more")
    patches = [Patch(color=shade, label=text) for shade, text in zip(shades, said, strict=True)]
    figure.legend(
        handles=patches,
        title="Share in the false state (x: diverged)",
        loc="outside lower center",
        ncols=5,
        frameon=False,
    )
    figure.suptitle(
        "The false state: seen in the run-down, predicted from one impact",
        x=0.01,
        ha="left",
        fontsize=11,
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
