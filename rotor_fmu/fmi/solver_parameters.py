"""The FMU's variables that choose the integration, `solver.*`, and how they stand for settings.

A host that sets every start value must change nothing: so a start value that is no setting of any
run means "as the preset".
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..model.message_templates import Message
from ..model.settings import DEFAULT_PRESET, PRESETS, Settings, SettingsError, settings_of_given
from ..model.settings.table import BY_NAME, MOST_MODES, NAMES, SETTINGS, Choice, Number
from .variables import Variable

AS_PRESET = "as the preset"
PREFIX = "solver."
_PRESET = Variable(
    f"{PREFIX}preset",
    "Enumeration",
    "parameter",
    "named set of settings: " + ", ".join(f"{i} {name}" for i, name in enumerate(PRESETS)),
    start=list(PRESETS).index(DEFAULT_PRESET),
    low=0,
    high=len(PRESETS) - 1,
    choices=tuple(PRESETS),
)
REDUCTION = Variable(
    f"{PREFIX}reduction",
    "Integer",
    "parameter",
    "Craig-Bampton modes of the shaft besides the deflections of bearings, discs and coupling; "
    "0: all of the shaft; chosen when an FMU is built",
    start=0,
    low=0,
    high=MOST_MODES,
)


def _variable(setting: Choice | Number) -> Variable:
    name = f"{PREFIX}{setting.variable or setting.name}"
    choices: tuple[str, ...] = ()
    if isinstance(setting, Number):
        text = f"{setting.text}; {setting.unset:g}: {AS_PRESET}"
        kind, unit, start = "Real", setting.unit, setting.unset
        low, high = min(setting.rule.least, start), max(setting.rule.most, start)
        if setting.is_whole:
            kind, start, low, high = "Integer", int(start), int(low), int(high)
    else:
        choices = (AS_PRESET, *setting.values)
        text = f"{setting.text}: " + ", ".join(f"{i} {name}" for i, name in enumerate(choices))
        kind, unit, start = "Enumeration", "1", 0
        low, high = 0, len(setting.values)
    given = name, kind, "parameter", text, unit, start, low, high
    return Variable(*given, choices=choices, is_unset_at_start=True)


# In the order in which the resolver takes them, the preset first (`settings.resolver.resolve`).
GIVEN = (_PRESET, *(_variable(setting) for setting in SETTINGS))
# By what settings are called, without and with the prefix: `solver.mode` is `solver.adaptive`.
OTHER_NAMES = {
    of + name: v.name
    for name, v in zip(("preset", *NAMES), GIVEN, strict=True)
    for of in ("", PREFIX)
}
_H = GIVEN[1 + NAMES.index("h")]
_TEXTS = {_H.name: BY_NAME["h"].text}  # where no value leaves it to the preset
REALTIME = "realtime"
_UNSET = {v.name: v.start for v in GIVEN}  # the value that leaves it to the preset
NO_STARTS: Mapping[str, float] = {}


def solver_parameters() -> list[Variable]:
    """Return the FMU's variables that choose the integration."""
    return [*GIVEN, REDUCTION]


def chosen_at_build(
    table: Sequence[Variable], reduction: int, step: float | None, starts: Mapping[str, float]
) -> tuple[Variable, ...]:
    """Return an FMU's variables with what is chosen when it is built: the modes kept of the shaft,
    the step length [s] of an FMU for real time, which begins with the preset `realtime`, and start
    values of other solver parameters. Raises `SettingsError` for an impossible value."""
    if reduction != int(reduction) or not 0 <= reduction <= MOST_MODES:
        allowed = f"must be an integer from 0 to {MOST_MODES}"
        raise SettingsError(f"{REDUCTION.name} = {reduction}: {allowed}")
    fixed: dict[str, float] = {REDUCTION.name: reduction}
    if step is not None:
        fixed |= {_PRESET.name: list(PRESETS).index(REALTIME), _H.name: step}
    for name in starts:
        if name in fixed:
            raise SettingsError(f"{name}: is chosen with the step for real time")
    chosen = []
    for v in table:
        changes: dict[str, Any] = {}
        if v.name in fixed:
            text = _TEXTS.get(v.name, v.text)
            changes = {"start": fixed[v.name], "is_unset_at_start": False, "text": text}
        elif v.name in starts:
            changes = {"start": starts[v.name] if v.kind == "Real" else int(starts[v.name])}
        chosen.append(replace(v, **changes))
    if starts:
        settings_of({v.name: float(v.start or 0.0) for v in chosen if v.name.startswith(PREFIX)})
    return tuple(chosen)


def meaning(variable: Variable) -> tuple[float, float]:
    """Return, for one of `GIVEN`, the value that leaves it to the preset, NaN if there is none, and
    the number to subtract from any other."""
    if not variable.is_unset_at_start:
        return math.nan, 0.0
    return float(_UNSET[variable.name] or 0.0), 1.0 if variable.choices else 0.0


def settings_of(
    values: Mapping[str, float], warn: Callable[[Message], None] = lambda message: None
) -> Settings:
    """Return the settings that values of the solver's parameters, by name, stand for.

    A value that changes nothing in the mode chosen goes to `warn`. Raises `SettingsError` for an
    impossible value, by the parameter's name.
    """
    given = np.full(len(GIVEN), np.nan)
    for at, variable in enumerate(GIVEN):
        unset, shift = meaning(variable)
        if values[variable.name] != unset:
            given[at] = values[variable.name] - shift
    try:
        settings, said = settings_of_given(given, int(values[REDUCTION.name]))
    except SettingsError as error:
        raise SettingsError(f"{PREFIX}{error}") from error
    for sentence in said:
        warn(Message(f"{PREFIX}{sentence}", sentence.code))
    return settings
