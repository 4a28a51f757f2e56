"""Values of variables from texts `NAME=VALUE`, as commands and Python take them."""

import math
from collections.abc import Iterable, Mapping, Sequence
from functools import partial

from ..errors import NO_OTHERS, InputError, known_name
from ..fmi.interface import interface, parameter_variable
from ..fmi.solver_parameters import AS_PRESET, OTHER_NAMES, PREFIX, REDUCTION, chosen_at_build
from ..fmi.variables import Variable
from ..model.machine.no_parameters import why_no_parameter
from ..model.machine.rotor import Rotor
from ..model.near_names import suggestion
from ..model.quantities import EXPONENT, check_size
from ..model.settings import SettingsError
from ..units import number

_TRUTHS = {"true": True, "false": False, "1": True, "0": False}


def named_texts(option: str, texts: Sequence[str]) -> dict[str, str]:
    """Return the values, as given, by name from the `NAME=VALUE` texts of an option.

    Raises `InputError` for another form, and for a repeated name.
    """
    values: dict[str, str] = {}
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not (name and equals):
            raise InputError(f"{option} {text}: must be NAME=VALUE")
        if name in values:
            raise InputError(f"{option} {name}: is given twice")
        values[name] = value
    return values


def parse_settings(
    rotor: Rotor, table: Sequence[Variable], settings: Sequence[str]
) -> dict[str, float]:
    """Return the values by name from `NAME=VALUE` texts; choices may be given by number or by name.

    Raises `InputError` for an unknown or repeated name, and for an impossible value.
    """
    known = {v.name: v for v in table if not v.is_observed}
    values = {}
    for name, value in named_texts("--set", settings).items():
        observed = next((v for v in table if v.is_observed and v.name == name), None)
        if observed is not None:
            raise InputError(f"--set {name}: is an output, which the model computes")
        variable = known[known_parameter("--set", name, rotor, known, OTHER_NAMES)]
        values[name] = value_of(f"--set {name}", variable, value)
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
    for name in named_texts("--set", settings):
        if name in others:
            raise InputError(f"--set {name}: is neither a parameter of the solver nor a choice")
    values = parse_settings(rotor, table, settings)
    if REDUCTION.name in values:
        raise InputError(f"--set {REDUCTION.name}: is chosen by --reduction")
    try:
        chosen_at_build(table, 0, None, values)
    except SettingsError as error:
        raise InputError(f"--set {error}") from error
    return values


def machine_values(where: str, rotor: Rotor, given: Mapping[str, object]) -> dict[str, float]:
    """Return values of the machine's own numbers by name. Raises `InputError`, which begins with
    `where`."""
    values: dict[str, float] = {}
    for n, v in exponents_first(given):
        numbers = as_set(rotor, values).numbers()
        known = {name: parameter_variable(*of) for name, of in numbers.items()}
        values[n] = value_of(f"{where} {n}", known[known_parameter(where, n, rotor, known)], v)
    return values


def exponents_first(given: Mapping[str, object]) -> list[tuple[str, object]]:
    """Return given values with those first that decide on the units of others; see `as_set`."""
    return sorted(given.items(), key=lambda each: not str(each[0]).endswith(EXPONENT))


def as_set(rotor: Rotor, values: Mapping[str, float]) -> Rotor:
    """Return the machine whose numbers have the units that they have with some values, as those of
    a wall with its exponent; itself where it cannot be, which is said elsewhere."""
    try:
        return rotor.with_values(values)
    except InputError:
        return rotor


def known_parameter(
    where: str,
    name: str,
    rotor: Rotor,
    known: Iterable[str] | None = None,
    others: Mapping[str, str] = NO_OTHERS,
) -> str:
    """Return a name that is among `known`, by default the machine's own numbers; `InputError`,
    which begins with `where` and says of what the machine's file fixes that it does; others: see
    `known_name`."""
    numbers = rotor.numbers()
    known = [*(numbers if known is None else known)]
    own = [*(numbers if numbers.keys() <= {*known} else rotor.parameters())]
    return known_name(where, name, known, others, partial(why_no_parameter, rotor, known=own))


def value_of(where: str, variable: Variable, given: object) -> float:
    """Return a variable's value from a number, with or without a unit, the name or number of a
    choice, or a truth; given: a text, or what a file has. Raises `InputError`, which begins with
    `where`."""
    text = f"{given:.12g}" if isinstance(given, float) else str(given)
    if variable.kind == "Boolean":
        if text.lower() not in _TRUTHS:
            raise InputError(f"{where} = {text}: must be true or false")
        return _TRUTHS[text.lower()]
    if variable.choices:
        if text in variable.choices:
            return variable.choices.index(text)
        if text.isdecimal() and int(text) < len(variable.choices):
            return int(text)
        listed = ", ".join(f"{i} {name}" for i, name in enumerate(variable.choices))
        hint = suggestion(text, variable.choices)
        raise InputError(f"{where} = {text}: must be one of {listed}{hint}")
    value = number(where, given, variable.unit or "1")
    low = -math.inf if variable.low is None else variable.low
    high = math.inf if variable.high is None else variable.high
    is_whole = variable.kind == "Integer"
    if not low <= value <= high or (is_whole and value % 1):
        unit = f" {variable.unit}".removesuffix(" 1")
        limit = f">= {low:g}" if high == math.inf else f"from {low:g} to {high:g}"
        kind = "an integer" if is_whole else "a finite number"
        raise InputError(f"{where} = {text}: must be {kind} {limit}{unit}")
    check_size(f"{where} = {text}", value)
    return value
