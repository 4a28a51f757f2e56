"""Values of variables from texts `NAME=VALUE`, as commands and Python take them."""

import math
from collections.abc import Sequence

from ..errors import InputError, known_name
from ..fmi.interface import interface
from ..fmi.solver_parameters import AS_PRESET, OTHER_NAMES, PREFIX, REDUCTION, chosen_at_build
from ..fmi.variables import Variable
from ..model.machine.rotor import Rotor
from ..model.near_names import suggestion
from ..model.settings import SettingsError
from ..units import in_si, split


def parse_settings(table: Sequence[Variable], settings: Sequence[str]) -> dict[str, float]:
    """Return the values by name from `NAME=VALUE` texts; choices may be given by number or by name.

    Raises `InputError` for an unknown or repeated name, and for an impossible value.
    """
    known = {v.name: v for v in table if not v.is_observed}
    values = {}
    for text in settings:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise InputError(f"--set {text}: must be NAME=VALUE")
        observed = next((v for v in table if v.is_observed and v.name == name), None)
        if observed is not None:
            raise InputError(f"--set {name}: is an output, which the model computes")
        variable = known[known_name("--set", name, known, OTHER_NAMES)]
        if name in values:
            raise InputError(f"--set {name}: is given twice")
        values[name] = _parse_value(variable, value)
        if variable.is_unset_at_start and values[name] == variable.start:
            raise InputError(
                f"--set {name} = {value}: means {AS_PRESET} and changes nothing; leave it out"
            )
    return values


def parse_starts(rotor: Rotor, is_free: bool, settings: Sequence[str]) -> dict[str, float]:
    """Return the start values of the solver's parameters, and of the FMU's other choices, from
    `NAME=VALUE` texts.

    Raises `InputError` for another parameter, and for settings that cannot be together.
    """
    if not settings:
        return {}
    every = interface(rotor, is_free)
    table = [v for v in every if v.choices or v.name.startswith(PREFIX)]
    others = {v.name for v in every} - {v.name for v in table}
    for name in (text.partition("=")[0].strip() for text in settings):
        if name in others:
            raise InputError(f"--set {name}: is neither a parameter of the solver nor a choice")
    values = parse_settings(table, settings)
    if REDUCTION.name in values:
        raise InputError(f"--set {REDUCTION.name}: is chosen by --reduction")
    try:
        chosen_at_build(table, 0, None, values)
    except SettingsError as error:
        raise InputError(f"--set {error}") from error
    return values


def _parse_value(variable: Variable, text: str) -> float:
    if variable.kind == "Boolean":
        allowed = {"true": True, "false": False, "1": True, "0": False}
        if text.lower() not in allowed:
            raise InputError(f"--set {variable.name} = {text}: must be true or false")
        return allowed[text.lower()]
    if variable.choices:
        if text in variable.choices:
            return variable.choices.index(text)
        if text.isdecimal() and int(text) < len(variable.choices):
            return int(text)
        listed = ", ".join(f"{i} {name}" for i, name in enumerate(variable.choices))
        hint = suggestion(text, variable.choices)
        raise InputError(f"--set {variable.name} = {text}: must be one of {listed}{hint}")
    parts = split(text)
    if parts and parts[1]:
        value = in_si(f"--set {variable.name} =", text, variable.unit)
        text = f"{value:g}"
    else:
        try:
            value = float(text)
        except ValueError:
            raise InputError(f"--set {variable.name} = {text}: must be a number") from None
    low = float("-inf") if variable.low is None else variable.low
    high = float("inf") if variable.high is None else variable.high
    is_whole = variable.kind == "Integer"
    if not low <= value <= high or math.isinf(value) or (is_whole and value % 1):
        unit = "" if variable.unit == "1" else f" {variable.unit}"
        limit = f" from {low:g} to {high:g}{unit}" if variable.high is not None else f" >= {low:g}"
        number = "an integer" if is_whole else "a finite number"
        bound = "finite" if variable.low is None else f"{number}{limit}"
        raise InputError(f"--set {variable.name} = {text}{unit}: must be {bound}")
    return value
