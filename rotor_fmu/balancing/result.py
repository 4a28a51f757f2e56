"""A machine balanced by influence coefficients, as a table and in the complex plane; what unbalance
is left, by ISO 21940-11 and API 617."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ..display import current, speed_with_unit
from ..linear.displayed import Displayed
from ..linear.linear_tables import degrees_of
from ..plotting.colors import BLUE, GREEN, GREY, ORANGE
from ..plotting.figure_style import entitle, new_panels
from ..plotting.labels import write_labels
from ..tables import Table

_COLUMNS = 3  # of pictures beside each other
_LINEAR = 0.1  # of the initial vibration: what a linear machine's differs by from the expected one


class Vibration(NamedTuple):
    """Once-per-revolution vibration of a node (from 1) along an axis at a speed [rad/s], complex
    amplitudes 0-p [m] whose angles are measured from the shaft's mark, x towards y as those of
    unbalances: initial, expected after the correction, and corrected, in the run with it."""

    node: int
    axis: str
    speed: float
    initial: complex
    expected: complex
    corrected: complex

    def lead(self, value: complex) -> complex:
        """Return one of them with the angle by which it leads the mark, in the sense of rotation:
        a lag is negative."""
        return value.conjugate() if self.speed < 0 else value


class CorrectionPlane(NamedTuple):
    """A correction plane: its node (from 1), trial and correction unbalance, complex [kg.m]."""

    node: int
    trial: complex
    unbalance: complex


class ResidualUnbalance(NamedTuple):
    """The unbalance of the rotor, taken as rigid, in the plane of a bearing, complex [kg.m]: its
    node (from 1), the mass that it bears [kg], initial and corrected; permitted: the most by API
    617 [kg.m]; the balance quality grade that is met [mm/s], infinite where none is."""

    node: int
    mass: float
    initial: complex
    corrected: complex
    permitted: float
    grade: float


@dataclass(frozen=True, repr=False)
class Balancing(Displayed):
    """A machine balanced by influence coefficients, m measurements and p planes.

    planes: with their unbalances; vibrations: at the measuring points; residuals: unbalances in the
    planes of the two outermost bearings, none where there are fewer; service_speed: for which they
    are permitted, the machine's maximum continuous or rated speed, or the fastest of balancing;
    influence: coefficients, complex of shape (m, p) [m/(kg.m)]; rank: their numerical rank;
    touches: whether a contact closed during a run, so that the coefficients are not those of a
    linear machine; settles: whether the runs were long enough for the slowest mode; messages: what
    the runs say of their numbers, each once.
    """

    planes: tuple[CorrectionPlane, ...]
    vibrations: tuple[Vibration, ...]
    residuals: tuple[ResidualUnbalance, ...]
    service_speed: float
    influence: np.ndarray
    rank: int
    touches: bool
    settles: bool
    messages: tuple[str, ...]

    @property
    def residual(self) -> float:
        """The vibration in the run with the correction, as a share of the initial one [1], by their
        root mean squares."""
        return self._share([v.corrected for v in self.vibrations])

    @property
    def departure(self) -> float:
        """How far the vibration with the correction is from the expected one, as a share of the
        initial one [1], by their root mean squares: small where the machine is linear."""
        return self._share([v.corrected - v.expected for v in self.vibrations])

    def _share(self, values: list[complex]) -> float:
        before = np.array([v.initial for v in self.vibrations])
        return float(np.linalg.norm(values) / np.linalg.norm(before))

    def table(self) -> Table:
        """Return a table with a row for each plane, each bearing's plane, each measurement."""
        heads = (
            *("", "trial", "[deg]", "correction", "[deg]"),
            *("initial", "[deg]", "left", "expected", "API 617", "ISO 21940-11"),
        )
        d, unit = current(), current().amplitude_words
        planes = [
            (
                f"plane at node {p.node} [{d.unbalance_unit}]",
                *_polar(p.trial, d.unbalance),
                *_polar(p.unbalance, d.unbalance),
                *6 * ("",),
            )
            for p in self.planes
        ]
        left_in_planes = [
            (
                f"unbalance at bearing, node {r.node} [{d.unbalance_unit}]",
                *4 * ("",),
                *_polar(r.initial, d.unbalance),
                *(abs(r.corrected) * d.unbalance, "", r.permitted * d.unbalance),
                f"G {r.grade:g}" if math.isfinite(r.grade) else "none",
            )
            for r in self.residuals
        ]
        measured = [
            (
                f"node {v.node} {v.axis}, {speed_with_unit(v.speed)} [{unit}]",
                *4 * ("",),
                *_polar(v.lead(v.initial), d.amplitude),
                abs(v.corrected) * d.amplitude,
                abs(v.expected) * d.amplitude,
                *2 * ("",),
            )
            for v in self.vibrations
        ]
        left = f"{100 * self.residual:.3g} % of the vibration is left"
        title = f"Balancing by influence coefficients: {left}"
        if self.residuals:
            title += f"; unbalances permitted at {speed_with_unit(self.service_speed)}"
        if any(v.speed < 0 for v in self.vibrations):
            title += (
                "; angles from the mark, of unbalances from x towards y, of vibrations in the "
                "sense of rotation"
            )
        if self.rank < len(self.planes):
            title += (
                f"; the influence coefficients of {len(self.planes)} planes have rank {self.rank}: "
                "these are the smallest unbalances that do it"
            )
        if self.touches:
            title += "; a contact closed during a run: the coefficients are not a linear machine's"
        if self.departure > _LINEAR:
            title += (
                f"; with the correction it is {100 * self.departure:.3g} % of the initial one off "
                "the expected: the machine is not linear in these unbalances; try a smaller --trial"
                " or a second balancing"
            )
        title = "; ".join([title, *self.messages])
        return Table(title, heads, [*planes, *left_in_planes, *measured])

    def figure(self) -> Figure:
        """Draw the vibration before and after, in the complex plane, at each speed for itself."""
        speeds = list(dict.fromkeys(v.speed for v in self.vibrations))
        columns = min(len(speeds), _COLUMNS)
        rows = math.ceil(len(speeds) / columns)
        figure, panels = new_panels(5.4 * columns, 5.2 * rows, rows, columns)
        for spare in panels[len(speeds) :]:
            spare.remove()
        measured = [[v for v in self.vibrations if v.speed == speed] for speed in speeds]
        for axes, speed, seen in zip(panels, speeds, measured, strict=False):
            self._draw(axes, seen)
            if len(speeds) > 1:
                entitle(axes, f"at {speed_with_unit(speed)}", 9)
        entitle(figure, self.titled("1x vibration, its angle from the mark"))
        for axes, seen in zip(panels, measured, strict=False):
            places = [v.lead(v.initial) * current().amplitude for v in seen]
            named = zip(places, seen, strict=True)
            write_labels(axes, [(p.real, p.imag, f"{v.node}{v.axis}", True) for p, v in named])
        return figure

    def _draw(self, axes: Axes, vibrations: list[Vibration]) -> None:
        d = current()
        axes.axhline(0, color=GREY, lw=0.8)
        axes.axvline(0, color=GREY, lw=0.8)
        for kind, label, color, mark in (
            ("initial", "initial", ORANGE, "o"),
            ("expected", "expected", GREEN, "x"),
            ("corrected", "with the correction", BLUE, "s"),
        ):
            values = np.array([v.lead(getattr(v, kind)) for v in vibrations]) * d.amplitude
            axes.plot(values.real, values.imag, mark, color=color, ms=6, mfc="none", label=label)
        axes.set_aspect("equal", adjustable="datalim")
        axes.margins(0.15)
        axes.set_xlabel(f"In phase with the mark [{d.amplitude_unit}]")
        axes.set_ylabel(f"A quarter of a turn ahead of it [{d.amplitude_unit}]")
        axes.legend(frameon=False, fontsize=8)


def _polar(value: complex, factor: float) -> tuple[float, float]:
    return abs(value) * factor, degrees_of(value)
