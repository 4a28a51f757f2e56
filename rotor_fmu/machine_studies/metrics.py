"""The metrics of a run: what can be kept of it, with its column, and what suits which run.

A quantity is an output by its name, or PART.r, the distance of PART.x and PART.y from zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..errors import InputError
from ..studies.study import Column
from .monitor import LEAST_TURNS
from .run_excitation import COUPLED, LEVELS, Excitation

Options = Mapping[str, Any]


class Kind(NamedTuple):
    """A way to make a cell of a window: what it needs beside the quantity, what it may have with
    its default, whether only at constant speed in whole turns, and what it is, to be filled in
    with the options; whether nothing less than the solver's own steps will do."""

    needed: tuple[str, ...]
    optional: Mapping[str, Any]
    in_turns: bool
    text: str
    is_fine: bool = False


KINDS: Mapping[str, Kind] = {
    "peak": Kind((), {"after": 0.0}, False, "largest absolute value"),
    "rms": Kind((), {"after": 0.0}, False, "root of the mean square over time"),
    "mean": Kind((), {"after": 0.0}, False, "mean over time"),
    "last": Kind((), {}, False, "value at the end"),
    "value": Kind(("speed",), {}, False, "value when the speed first passes {speed:g} rad/s,"),
    "amplitude": Kind(("bins",), {}, False, "largest absolute value in each bin of the speed"),
    "poincare": Kind((), {}, True, "value once a turn, at the keyphasor's mark"),
    "order": Kind(("order",), {}, True, "amplitude of order {order:g} of the speed,"),
    "passing": Kind(
        ("order", "speed"),
        {},
        False,
        "amplitude of order {order:g} where {speed:g} rad/s is first passed,",
        is_fine=True,
    ),
    "spectrum": Kind(("orders",), {}, True, "full spectrum, negative orders backward,"),
    "contact": Kind((), {"after": 0.0}, False, "time in contact", is_fine=True),
    "dissipated": Kind((), {}, False, "work of friction at a contact", is_fine=True),
    "whirl": Kind((), {}, False, "mean rate at which PART.x, PART.y turn about zero", is_fine=True),
    "lyapunov": Kind((), {}, True, "largest Lyapunov exponent"),
    "jump": Kind(("way",), {"least": 0.2}, False, "speed of the largest jump {way} of the mean"),
}
# Kinds whose quantity is a part, with the outputs that they look at.
_OF_PARTS = {
    "contact": ("contact",),
    "dissipated": ("ft", "x", "y"),
    "whirl": ("x", "y"),
    "spectrum": ("x", "y"),
}
# Units of kinds that are not in those of their quantity.
_UNITS = {
    "contact": "s",
    "dissipated": "J",
    "whirl": "rad/s",
    "jump": "rad/s",
    "spectrum": "m",
    "lyapunov": "1/s",
}
# Kinds over whole turns that make something of each speed held.
_AT_LEVELS = ("order", "poincare", "lyapunov")
LARGEST = "largest"  # what a Lyapunov exponent is of: the whole machine
WAYS = ("up", "down")
# Orders are passed in turns resampled at 64 angles at least.
_MOST_PASSED = 32


@dataclass(frozen=True)
class Metric:
    """A cell of a row: the column's name, one of `KINDS`, of what, and the kind's options.

    scale: what `dissipated` needs, the journal's radius [m].
    """

    name: str
    kind: str
    of: str
    options: tuple[tuple[str, Any], ...] = ()
    scale: float = 0.0

    @property
    def needs(self) -> tuple[str, ...]:
        """The outputs that must be sampled."""
        also = ("w",) if self.kind in ("value", "amplitude") else ()
        also = ("phi",) if self.kind in ("dissipated", "passing") else also
        if self.kind == "lyapunov":
            return ()
        if self.kind in _OF_PARTS:
            return (*(f"{self.of}.{output}" for output in _OF_PARTS[self.kind]), *also)
        if self.of.endswith(".r"):
            part = self.of.removesuffix(".r")
            return (f"{part}.x", f"{part}.y", *also)
        return (self.of, *also)


def column(metric: Metric, unit: str, drive: Excitation, is_varied: bool) -> Column:
    """Return the column of a metric; unit: the quantity's; is_varied: whether the held speeds
    differ from run to run."""
    options = dict(metric.options)
    text = KINDS[metric.kind].text.format(**options)
    text += "" if metric.kind == "lyapunov" else f" of {metric.of}"
    unit = _UNITS.get(metric.kind, unit)
    if metric.kind == "jump":
        return Column(metric.name, unit, text)
    if metric.kind == "amplitude":
        middles = bin_middles(options["bins"])
        return Column(metric.name, unit, text, f"{metric.name} speed", middles, "rad/s")
    if metric.kind == "poincare":
        return Column(metric.name, unit, text, "turn")
    if metric.kind == "spectrum":
        orders = tuple(spectrum_orders(options["orders"], int(drive.numbers["turns"])).tolist())
        return Column(metric.name, unit, text, f"{metric.name} order", orders)
    if drive.kind == "steps":
        held = () if is_varied else tuple(drive.speeds.tolist())
        return Column(metric.name, unit, text, "held speed", held, "rad/s")
    return Column(metric.name, unit, text)


def edges_of(bins: Mapping[str, Any]) -> np.ndarray:
    """Return the edges of bins."""
    return np.linspace(bins["from"], bins["to"], int(bins["count"]) + 1)


def bin_middles(bins: Mapping[str, Any]) -> tuple[float, ...]:
    """Return the middles of bins."""
    edges = edges_of(bins)
    return tuple((0.5 * (edges[1:] + edges[:-1])).tolist())


def spectrum_orders(highest: float, turns: int) -> np.ndarray:
    """Return the orders of a full spectrum over so many turns, from -highest to highest."""
    most = round(highest * turns)
    return np.arange(-most, most + 1) / turns


def check(metric: Metric, how: Excitation) -> None:
    """Raise `InputError` for a metric that does not suit the excitation of the run."""
    kind, options = KINDS[metric.kind], dict(metric.options)
    where, n = f"keep {metric.name}", how.numbers
    if how.kind == COUPLED and kind.is_fine:
        raise InputError(
            f"{where}: {metric.kind} looks at the solver's own steps, which no FMU shows"
        )
    held = LEVELS if metric.kind in _AT_LEVELS else ("constant",)
    if kind.in_turns and (how.kind not in held or n["measure"]):
        raise InputError(f"{where}: {metric.kind} needs runs at constant speed in whole turns")
    if metric.kind == "lyapunov" and metric.of != LARGEST:
        raise InputError(f"{where}: lyapunov = {metric.of!r}: must be {LARGEST!r}")
    if metric.kind == "lyapunov" and n["turns"] < LEAST_TURNS:
        raise InputError(f"{where}: lyapunov needs run.turns >= {LEAST_TURNS}, not {n['turns']:g}")
    if metric.kind == "jump" and how.kind != "steps":
        raise InputError(f"{where}: jump needs runs in steps of the speed")
    if metric.kind in ("value", "amplitude", "passing") and how.kind in LEVELS:
        raise InputError(f"{where}: {metric.kind} needs runs whose speed varies continuously")
    if options.get("after", 0.0) < 0:
        raise InputError(f"{where}: after = {options['after']:g} s: must be >= 0")
    if metric.kind == "passing":
        order = options["order"]
        if not 0 < order < _MOST_PASSED or not _is_whole(2 * order):
            raise InputError(
                f"{where}: order = {order:g}: must be a multiple of 0.5 from 0.5 to "
                f"{_MOST_PASSED - 0.5:g}"
            )
    if metric.kind == "order":
        order, turns, per_turn = options["order"], n["turns"], n["per_turn"]
        if not 0 < order < per_turn / 2:
            raise InputError(
                f"{where}: order = {order:g}: must be > 0 and below half of run.per_turn = "
                f"{per_turn:g}"
            )
        if not _is_whole(order * turns):
            raise InputError(
                f"{where}: order = {order:g}: must make whole periods in run.turns = {turns:g}"
            )
    if metric.kind == "spectrum" and not 0 < options["orders"] < n["per_turn"] / 2:
        raise InputError(
            f"{where}: orders = {options['orders']:g}: must be > 0 and below half of run.per_turn "
            f"= {n['per_turn']:g}"
        )


def _is_whole(number: float) -> bool:
    return abs(number - round(number)) < 1e-9
