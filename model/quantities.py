"""Quantities: unit, rule and description of a number, declared where the number is.

A data class declares its numbers by `quantity(...)`; everything else (the reader of TOML files,
checks, the kernels' records, the FMU's variables, documents) is made from that declaration.
"""

import math
from collections import namedtuple
from collections.abc import Iterable, Mapping
from dataclasses import MISSING, dataclass, field, fields, replace
from typing import Any

from .errors import InputError


class QuantityError(InputError):
    """An impossible value; the message names the quantity, its value and what is allowed."""


@dataclass(frozen=True)
class Rule:
    """The values that a number may have: at least `least`, or above it if `is_strict`; at most
    `most`, or below it if `is_below`; and the words that say so."""

    least: float
    is_strict: bool
    words: str
    most: float = math.inf
    is_below: bool = False

    def allows(self, value: float) -> bool:
        """Return whether a number may have this value."""
        is_enough = value > self.least if self.is_strict else value >= self.least
        return is_enough and (value < self.most if self.is_below else value <= self.most)


def between(
    least: float, most: float, unit: str = "", *, is_strict: bool = False, is_below: bool = False
) -> Rule:
    """Return the rule of an interval, with its words; is_strict, is_below: the lower, the upper end
    is excluded."""
    low = f"{'>' if is_strict else 'at least'} {least:g}{unit if least else ''}"
    high = f"{'below' if is_below else 'at most'} {most:g}{unit}"
    return Rule(least, is_strict, f"must be {low} and {high}", most, is_below)


POSITIVE = Rule(0.0, True, "must be > 0 and finite")
NOT_NEGATIVE = Rule(0.0, False, "must be >= 0 and finite")
ANY = Rule(-math.inf, False, "must be a finite number")
# Beyond it, an angle in a turn is rounding.
ANGLE = Rule(-1e9, False, "must be finite and at most 1e+09 rad in size", 1e9)
NOTHING, SPEED, ALL = "nothing", "speed", "all"
LARGEST = 1e30  # in size: beyond it, products of such numbers overflow
SMALLEST = 1 / LARGEST  # of what must be above 0
EXPONENT = "exponent"  # the quantity on which the unit of another one may depend
GRAVITY = 9.81  # of a machine, unless its definition states another one [m/s2]
STANDARD_GRAVITY = 9.80665  # makes units of force of units of mass [m/s2]


@dataclass(frozen=True)
class Quantity:
    """A number that a user gives: unit ("1" if it has none; see `unit_of`), description, allowed
    values, whether it is a parameter of the FMU, whether it is a Boolean, and whether a list of
    numbers, a column of a table, may take its place, and whether a parameter may change during a
    run."""

    unit: str
    text: str
    rule: Rule = POSITIVE
    is_parameter: bool = False
    is_switch: bool = False
    may_be_list: bool = False
    is_tunable: bool = False


@dataclass(frozen=True)
class Output:
    """A number that a model computes: its name within its part, unit, description.

    kind: Real, Integer or Boolean; is_output: whether it is among the few that every run records;
    nominal: its usual magnitude [unit], of a Real; reached_by: the inputs that change it at once,
    with the motion unchanged: `NOTHING`, the machine's `SPEED`, one of its own part by its name
    there, such as `fx`, or the speed and every load, `ALL`; is_of_now: whether it follows from the
    present motion alone, without its history.
    """

    name: str
    unit: str
    text: str
    is_output: bool = False
    nominal: float | None = None
    kind: str = "Real"
    reached_by: str = NOTHING
    is_of_now: bool = True


def quantity(
    unit: str,
    text: str,
    rule: Rule = POSITIVE,
    default: Any = MISSING,
    *,
    is_parameter: bool = False,
    may_be_list: bool = False,
    is_tunable: bool = False,
) -> Any:
    """Return a field of a data class that is a `Quantity`."""
    is_parameter = is_parameter or is_tunable
    declared = Quantity(
        unit, text, rule, is_parameter, may_be_list=may_be_list, is_tunable=is_tunable
    )
    return field(default=default, metadata={"quantity": declared})


def switch(text: str, default: Any = MISSING, *, is_parameter: bool = False) -> Any:
    """Return a field of a data class that is true or false."""
    declared = Quantity("1", text, ANY, is_parameter, is_switch=True)
    return field(default=default, metadata={"quantity": declared})


def remembered(*outputs: Output) -> tuple[Output, ...]:
    """Return outputs that depend on the history of the motion too."""
    return tuple(replace(output, is_of_now=False) for output in outputs)


def places(entries: Iterable[Output | str], first: int = 0, width: int = 1) -> Any:
    """Return a named tuple of the index of each entry, by its name: kernels fill arrays by it, as
    in `out[places(OUTPUTS).x]`. first: the first index; width: the number of indices of an
    entry."""
    names = [entry if isinstance(entry, str) else entry.name for entry in entries]
    kind = namedtuple("Places", names)  # type: ignore[misc]
    return kind(*range(first, first + width * len(names), width))


def quantities(kind: Any) -> Mapping[str, Quantity]:
    """Return the quantities of a data class by their names, in their order; of an instance, with
    the units that they have there."""
    declared = {f.name: f.metadata["quantity"] for f in fields(kind) if "quantity" in f.metadata}
    if isinstance(kind, type) or not hasattr(kind, EXPONENT):
        return declared
    for name, of in declared.items():
        if (unit := unit_of(of.unit, getattr(kind, EXPONENT))) != of.unit:
            declared[name] = replace(of, unit=unit)
    return declared


def unit_of(unit: str, exponent: Any) -> str:
    """Return a declared unit, such as N/m^exponent, for an exponent; 1 for one that is no
    number."""
    is_power = isinstance(exponent, (int, float)) and exponent != 1
    return unit.replace(f"^{EXPONENT}", f"^{exponent}" if is_power else "")


def check(shown: str, declared: Quantity, value: Any) -> None:
    """Raise `QuantityError` unless `value` is allowed for the quantity, which the message calls
    `shown`."""
    if declared.is_switch:
        if not isinstance(value, bool):
            raise QuantityError(f"{shown} = {value!r}: must be true or false")
        return
    if declared.may_be_list and isinstance(value, (tuple, list)):
        for i, item in enumerate(value, 1):
            check(f"{shown}[{i}]", replace(declared, may_be_list=False), item)
        return
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        kinds = "a number or a list of numbers" if declared.may_be_list else "a number"
        raise QuantityError(f"{shown} = {value!r}: must be {kinds}")
    is_finite = isinstance(value, int) or math.isfinite(value)
    if is_finite:
        check_size(shown, value)
    unit = "" if declared.unit == "1" else f" {declared.unit}"
    if not is_finite or not declared.rule.allows(value):
        raise QuantityError(f"{shown} = {value:g}{unit}: {declared.rule.words}")
    if declared.rule is POSITIVE and value < SMALLEST:
        raise QuantityError(f"{shown} = {value:g}{unit}: must be at least {SMALLEST:g}{unit}")


def check_size(shown: str, value: float) -> None:
    """Raise `QuantityError`, in which a number is called `shown`, if it is larger than
    `LARGEST`."""
    if abs(value) > LARGEST:
        raise QuantityError(f"{shown}: must not exceed {LARGEST:g} in size")


def check_all(where: str, item: Any) -> None:
    """Check every quantity of an instance of a data class, which messages call `where`."""
    for name, declared in quantities(item).items():
        check(f"{where}.{name}", declared, getattr(item, name))
