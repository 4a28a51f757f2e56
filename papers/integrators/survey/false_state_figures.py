"""Pictures of the false state: what it is, who has it, how a run gets into it."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.figure import Figure
from rotor_fmu.model.machine.toml import rig

from papers.dense_machine import clearance_contacts
from papers.integrators.members import (
    Scheme,
    chung_hulbert,
    generalized_alpha,
    hht,
    newmark,
    wbz,
)
from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure

from ..false_state import bouncing, one_axis
from ..false_state import cycles as false_state
from ..false_state.planting import plant
from . import bounces
from .findings import Findings, title_of
from .planted import lasting_cycles
from .rotor import RUN_DOWN_RATE, perturbed
from .survey_plots import SHOWN

_H = 2.5e-4  # at which the integrators are compared [s]


def _axis() -> one_axis.Axis:
    return one_axis.axis_of(rig(), 0, one_axis.X)


def phase_limit(member: Callable[[float], Scheme], low: float, high: float) -> float:
    """Parameter of a one-parameter family, between low (phase above) and high (below), at which the
    phase is 45 degrees."""
    axis = _axis()
    for _ in range(40):
        middle = 0.5 * (low + high)
        is_above = false_state.quarter_phase(axis, member(middle), _H) > math.pi / 4
        low, high = (middle, high) if is_above else (low, middle)
    return low


def free_growth() -> float:
    """Growth of an error in a step of the cycle R.L of Newmark's method [1]."""
    result = false_state.cycles(_axis(), newmark(), _H)
    return next(cycle.radius for cycle in result if cycle.word == "R.L")


def orbits() -> Figure:
    """Position of a journal in the false state, step by step: predicted and simulated."""
    figure = Figure(figsize=(7.2, 4.2), dpi=150, layout="constrained")
    panels = figure.subplots(2, 1, sharex=True)
    h, count, speed = 5e-4, 24, 120.0
    cases = ((hht(math.sqrt(2) - 1), "RRLL", "HHT √2 - 1"), (hht(0.05), "RRL", "HHT 0.05"))
    for axes, (scheme, word, title) in zip(panels, cases, strict=True):
        entry = next(
            e for e in lasting_cycles(scheme, h) if e[1:3] == (0, one_axis.X) and e[4].word == word
        )
        _, bearing, direction, axis, cycle = entry
        simulation = perturbed(scheme, h, 0.0, speed)
        plant(simulation, bearing, direction, cycle)
        contact = clearance_contacts(simulation.structure)[bearing]
        seen = []
        for n in range(count):
            q = simulation.motion.q
            seen.append(q[contact.dof] - q[contact.end])
            simulation.advance((n + 1) * h, speed + RUN_DOWN_RATE * n * h)
        shrunk = math.cos(cycle.tilt(axis.across))
        predicted = np.resize(cycle.displacement, count) * shrunk * 1e6
        time = np.arange(count) * h * 1e3
        axes.axhspan(axis.clearance * 1e6, 75, color="#dddddd")
        axes.axhspan(-75, -axis.clearance * 1e6, color="#dddddd")
        axes.plot(time, np.real(seen) * 1e6, "-", color=GREY, lw=0.8)
        axes.plot(time, predicted, "o", mfc="none", mec=ORANGE, ms=9, mew=1.6, label="predicted")
        axes.plot(time, np.real(seen) * 1e6, ".", color=BLUE, ms=6, label="simulated")
        axes.set_ylim(-68, 68)
        axes.set_ylabel("Journal $x$ [µm]")
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_title(f"{title}: {word}", loc="left", fontsize=9)
    panels[0].legend(frameon=False, ncols=2, loc="upper right", fontsize=8, bbox_to_anchor=(1, 1.2))
    panels[1].set_xlabel("Time [ms], one point a step of 0.5 ms; grey: the walls of the clearance")
    figure.suptitle(
        "In the false state the journal is at a wall after every step",
        x=0.01,
        ha="left",
        fontsize=10,
    )
    return figure


def power(findings: Findings) -> Figure:
    """Energy that the integrator makes in the false state against the prediction."""
    figure, axes = new_figure(5.6, 4.6)
    rows = [row for row in findings.of("planted") if row.get("trapped", 0.0) > 0.99]
    predicted, seen = (np.array([row[n] for row in rows]) for n in ("power_predicted", "power"))
    limits = [0.5 * predicted.min(), 2.0 * predicted.max()]
    axes.loglog(limits, limits, color=GREY, lw=1, zorder=1)
    axes.loglog(predicted, seen, ".", color=BLUE, ms=4, mew=0, alpha=0.5)
    axes.text(
        0.97,
        0.06,
        "below: gone over to\nanother cycle",
        transform=axes.transAxes,
        ha="right",
        fontsize=8,
    )
    axes.set_xlabel("Predicted: what the dampers take in a cycle [W]")
    axes.set_ylabel("Seen: growth of energy.residual [W]")
    axes.set_title(
        "The false state runs on energy that the integrator makes", loc="left", fontsize=10
    )
    return figure


LOAD_BINS = (0.0, 0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, math.inf)


def survival(findings: Findings) -> list[tuple[float, float, int, float]]:
    """Planted cycles by the ratio of the load that they bear to the unbalance's: least and largest
    ratio, number, share that lasts."""
    rows = findings.of("planted", status="ok")
    result = []
    for low, high in pairwise(LOAD_BINS):
        inside = [row for row in rows if low <= row["bears"] / row["load"] < high]
        if inside:
            lasting = sum(row["trapped"] > 0.99 for row in inside)
            result.append((low, high, len(inside), lasting / len(inside)))
    return result


def lasting(findings: Findings) -> Figure:
    """Whether a planted cycle lasts, against the load that it bears."""
    figure, axes = new_figure(6.0, 3.8)
    bins = survival(findings)
    labels = [
        f"< {high:g}" if low == 0 else f"> {low:g}" if math.isinf(high) else f"{low:g} to {high:g}"
        for low, high, _, _ in bins
    ]
    axes.bar(labels, [100 * share for *_, share in bins], color=BLUE, width=0.75)
    for i, (_, _, count, share) in enumerate(bins):
        axes.text(i, 100 * share + 1, f"{count}", ha="center", fontsize=7, color="#555555")
    axes.set_ylim(0, 108)
    axes.set_xlabel("Load that the cycle bears / load of the unbalance [1]")
    axes.set_ylabel("Planted cycles that last [%]")
    axes.tick_params(axis="x", labelsize=8)
    axes.set_title(
        "A cycle lasts where it bears more than the unbalance pulls (number planted above)",
        loc="left",
        fontsize=9,
    )
    return figure


def phases() -> Figure:
    """Phase of the dynamic stiffness at four steps a period against the spectral radius."""
    figure, axes = new_figure(6.4, 4.2)
    axis, h = _axis(), _H
    families: tuple[tuple[str, str, Sequence[Scheme]], ...] = (
        ("Chung-Hulbert, 0 to 1", BLUE, [chung_hulbert(r) for r in np.linspace(0, 1, 81)]),
        ("HHT, alpha_f from 0 to 0.5", GREEN, [hht(a) for a in np.linspace(0, 0.5, 61)]),
        ("WBZ, alpha_m from -1 to 0", ORANGE, [wbz(a) for a in np.linspace(-1, 0, 61)]),
    )
    for label, color, members in families:
        rho = [s.rho_infinity for s in members]
        phase = [math.degrees(false_state.quarter_phase(axis, s, h)) for s in members]
        axes.plot(rho, phase, color=color, lw=1.6, label=label)
    for name, scheme, color, offset in (
        ("√2 - 1", hht(math.sqrt(2) - 1), GREEN, (5, 5)),
        ("0.2", chung_hulbert(0.2), BLUE, (-4, -13)),
        ("0.1 / 0.08", generalized_alpha(0.1, 0.08), GREY, (-6, 7)),
    ):
        at = scheme.rho_infinity, math.degrees(false_state.quarter_phase(axis, scheme, h))
        axes.plot(*at, "o", color=color, ms=5, zorder=3)
        axes.annotate(
            name,
            at,
            xytext=offset,
            textcoords="offset points",
            fontsize=8,
            ha="left" if offset[0] > 0 else "right",
        )
    axes.axhline(45, color=GREY, lw=1, ls="--")
    axes.text(0.99, 46.5, "above: no false state between hard walls", fontsize=8, ha="right")
    axes.set_xlim(0, 1.02)
    axes.set_ylim(0, None)
    axes.set_xlabel("Spectral radius at infinity [1]")
    axes.set_ylabel("Phase of -1 / H(i) [deg]")
    axes.legend(frameon=False, fontsize=8, loc="upper right", bbox_to_anchor=(1, 0.98))
    axes.set_title(
        f"Strong damping at infinity turns the force by 45°, HHT cannot (h = {h * 1e3:g} ms)",
        loc="left",
        fontsize=10,
    )
    return figure


def impacts(findings: Findings) -> Figure:
    """Share of impacts that end in the false state, against their speed."""
    figure, axes = new_figure(6.4, 4.0)
    h = findings.nearest_step("bounce", 2.5e-4)
    for label, (color, marker) in SHOWN.items():
        rows = findings.of("bounce", scheme=label, h=h)
        points = sorted((float(row["case"].split()[0]), 100 * row["trapped"]) for row in rows)
        axes.plot(
            *zip(*points, strict=True),
            color=color,
            marker=marker,
            ms=4,
            lw=1.3,
            label=title_of(label),
        )
    axes.axvline(findings.impact_speed(), color="#333333", lw=1, ls="--")
    axes.text(findings.impact_speed() * 1.05, 3, "fastest in the\nconverged run", fontsize=8)
    axes.set_xscale("log")
    axes.set_xticks(bounces.SPEEDS, [f"{speed:g}" for speed in bounces.SPEEDS])
    axes.set_xticks([], minor=True)
    axes.set_xlabel("Speed of the journal at the impact [m/s]")
    axes.set_ylabel("Impacts that end in the false state [%]")
    axes.legend(frameon=False, fontsize=8)
    axes.set_title(
        f"One impact is enough (h = {h * 1e3:g} ms, {bouncing.INSTANTS} instants each)",
        loc="left",
        fontsize=10,
    )
    return figure
