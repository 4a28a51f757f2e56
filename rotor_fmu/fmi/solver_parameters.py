"""The solver's parameters of the FMU, `solver.*`: how its Integers and Reals stand for settings.

A host that sets every start value must change nothing: so a start value that is no setting of any
run means "as the preset".
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import NamedTuple

from ..model.settings import (
    DEFAULT_PRESET,
    INDICATORS,
    METHODS,
    MODES,
    NORMS,
    PRESETS,
    Settings,
    SettingsError,
    choose,
    without_effect,
)
from .variables import Variable

AS_PRESET = "as the preset"
_PREFIX = "solver."
_BIG = 1e9
_MOST_MODES = 10_000

Value = str | float | bool


class _Choice(NamedTuple):
    """An Integer that counts the values of a setting, from 1; 0 leaves it to the preset."""

    name: str
    setting: str
    values: Mapping[str, Value]
    text: str


class _Number(NamedTuple):
    """A Real that its start value leaves to the preset."""

    name: str
    unit: str
    start: float
    low: float
    high: float
    text: str


def _names(values: Iterable[str]) -> dict[str, Value]:
    return {name: name for name in values}


_PRESET = Variable(
    f"{_PREFIX}preset",
    "Integer",
    "parameter",
    "named set of settings: " + ", ".join(f"{i} {name}" for i, name in enumerate(PRESETS)),
    start=list(PRESETS).index(DEFAULT_PRESET),
    low=0,
    high=len(PRESETS) - 1,
    choices=tuple(PRESETS),
)
_TABLE = (
    _Choice("method", "method", _names(METHODS), "integrator"),
    # 1 leaves no implicit equation, so that it is free to mean "as the preset"
    _Number("alpha_f", "1", 1.0, -1.0, 1.0, "alpha_f of hht and generalized-alpha"),
    _Number("alpha_m", "1", 1.0, -1.0, 1.0, "alpha_m of wbz and generalized-alpha"),
    _Number("rho", "1", -1.0, -1.0, 1.0, "spectral radius at infinity of chung-hulbert"),
    _Choice("adaptive", "mode", _names(MODES), "step length"),
    _Choice(
        "fitted", "fitted", {"no": False, "yes": True}, "whether fitted to the pace of the motion"
    ),
    _Number("tolerance", "1", 0.0, 0.0, 1.0, "relative tolerance of the controlled mode"),
    _Number("h", "s", 0.0, 0.0, 1.0, "step length, the first one where it varies"),
    _Number("h_min", "s", 0.0, 0.0, 1.0, "shortest step where it varies"),
    _Number("h_max", "s", 0.0, 0.0, 1.0, "longest step where it varies"),
    _Number("eps_min", "1", 0.0, 0.0, _BIG, "adaptive mode: error below which the step grows"),
    _Number("eps_max", "1", 0.0, 0.0, _BIG, "adaptive mode: error above which it is repeated"),
    _Choice("indicator", "indicator", _names(INDICATORS), "error indicator of the adaptive mode"),
    _Choice("norm", "norm", _names(NORMS), "what its error is relative to"),
    _Number("atol", "m", 0.0, 0.0, 1.0, "absolute part of the mixed norm"),
    _Number("rtol", "1", 0.0, 0.0, 1.0, "relative part of the mixed norm"),
)
_REDUCTION = Variable(
    f"{_PREFIX}reduction",
    "Integer",
    "parameter",
    "Craig-Bampton modes kept of the shaft beside the deflections of bearings, discs and coupling; "
    "0: all of the shaft; chosen when an FMU is built",
    start=0,
    low=0,
    high=_MOST_MODES,
)


def solver_parameters() -> list[Variable]:
    """The FMU's variables that choose the integration."""
    return [_PRESET, *(_variable(row) for row in _TABLE), _REDUCTION]


def _variable(row: _Choice | _Number) -> Variable:
    name = f"{_PREFIX}{row.name}"
    choices: tuple[str, ...] = ()
    if isinstance(row, _Number):
        text = f"{row.text}; {row.start:g}: {AS_PRESET}"
        start, low, high = row.start, row.low, row.high
        kind, unit = "Real", row.unit
    else:
        choices = (AS_PRESET, *row.values)
        text = f"{row.text}: " + ", ".join(f"{i} {choice}" for i, choice in enumerate(choices))
        start, low, high = 0, 0, len(row.values)
        kind, unit = "Integer", "1"
    return Variable(
        name,
        kind,
        "parameter",
        text,
        unit,
        start,
        low,
        high,
        choices=choices,
        is_unset_at_start=True,
    )


def is_solvers(name: str) -> bool:
    """Whether a parameter of this name is one of the solver's."""
    return name.startswith(_PREFIX)


def settings_of(
    values: Mapping[str, float],
    tolerance: float | None = None,
    warn: Callable[[str], None] = lambda message: None,
) -> Settings:
    """The settings that values of the solver's parameters, by name, stand for.

    tolerance: the experiment's [1], which a value of the FMU's own overrides. A value that changes
    nothing in the mode chosen goes to `warn`. Raises `SettingsError` for an impossible value, by
    the parameter's name.
    """
    changes: dict[str, Value] = {}
    limited: dict[str, tuple[float, float]] = {}
    for row in _TABLE:
        value = values[f"{_PREFIX}{row.name}"]
        if isinstance(row, _Number):
            if value != row.start:
                changes[row.name] = value
                limited[row.name] = value, row.high
        elif value != 0:
            changes[row.setting] = list(row.values.values())[int(value) - 1]
    own = dict(changes)
    if tolerance is not None:
        changes.setdefault("tolerance", tolerance)
    preset = list(PRESETS)[int(values[_PRESET.name])]
    reduction = int(values[_REDUCTION.name])
    try:
        settings = choose(preset, **changes, reduction=reduction)
    except SettingsError as error:
        raise SettingsError(f"{_PREFIX}{error}") from error
    for name, (value, high) in limited.items():
        if value > high:
            raise SettingsError(f"{_PREFIX}{name} = {value:g}: must be at most {high:g}")
    for sentence in without_effect(settings, own):
        warn(f"{_PREFIX}{sentence}")
    return settings
