"""Viscosity of an oil film as a function of speed or temperature: its quantities.

A list over the temperature becomes one over the speed by a heat balance (`laws_at_rest.oil`).
"""

from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

from ..quantities import ANY, NOT_NEGATIVE, QuantityError, Rule, quantity
from .speed_table import check_ascending, check_column

_SHARE = Rule(0.0, False, "must be from 0 to 1", most=1.0)


@dataclass(frozen=True, kw_only=True)
class HeatQuantities:
    """Abscissae of a list of viscosities: speed [rad/s], or temperature [degC], with the heat
    balance: temperature at the inlet [degC], density [kg/m3], which the Reynolds number needs too,
    and specific heat [J/(kg.K)] of the lubricant, the share of the film's power that it carries
    away [1], and the load of the balance [N]."""

    speed: tuple[float, ...] = quantity(
        *("rad/s", "speeds of the viscosity's list, ascending; with a temperature: of its balance"),
        *(NOT_NEGATIVE, ()),
        may_be_list=True,
    )
    temperature: tuple[float, ...] = quantity(
        *("degC", "temperatures of the viscosity's list, ascending", ANY, ()), may_be_list=True
    )
    inlet_temperature: float = quantity(
        *("degC", "temperature at which the lubricant enters the film", ANY, 40.0)
    )
    density: float = quantity("kg/m3", "density of the lubricant", default=860.0)
    specific_heat: float = quantity("J/(kg.K)", "specific heat of the lubricant", default=2000.0)
    heat_share: float = quantity(
        "1", "share of the film's power that the lubricant carries away; 1: adiabatic", _SHARE, 1.0
    )
    static_load: float = quantity(
        *("N", "load, along gravity, under which the heat balance is made", NOT_NEGATIVE, 0.0)
    )


KEPT = ("speed", "density")  # of `HeatQuantities`: they do not need a heat balance


def check_viscosity(where: str, part: Any) -> None:
    """Raise `QuantityError` for a list of viscosities without all that it needs."""
    for name, unit in (("speed", "rad/s"), ("temperature", "degC")):
        values = getattr(part, name)
        if not isinstance(values, tuple):
            raise QuantityError(f"{where}.{name} = {values!r}: must be a list of numbers")
        check_ascending(f"{where}.{name}", unit, values)
    if not isinstance(part.viscosity, tuple):
        for name in ("speed", "temperature"):
            if getattr(part, name):
                raise QuantityError(f"{where}.{name}: needs {where}.viscosity, a list over it")
        _refuse_balance(where, part)
        return
    over = "temperature" if part.temperature else "speed"
    points = getattr(part, over)
    if not points:
        raise QuantityError(f"{where}.viscosity: a list needs {where}.speed or {where}.temperature")
    check_column(f"{where}.viscosity", part.viscosity, f"{where}.{over}", len(points))
    for name in {over, "speed"}:
        if len(getattr(part, name)) < 2:
            raise QuantityError(
                f"{where}.{name}: {len(getattr(part, name))} given, at least 2 are needed"
            )
    if part.temperature:
        _check_balance(where, part)
    else:
        _refuse_balance(where, part)


def _refuse_balance(where: str, part: Any) -> None:
    """Raise `QuantityError` for a quantity of a heat balance that is not made."""
    for field in fields(HeatQuantities):
        if field.name not in KEPT and getattr(part, field.name) != field.default:
            raise QuantityError(
                f"{where}.{field.name}: needs {where}.temperature, for the heat balance"
            )


def _check_balance(where: str, part: Any) -> None:
    low, high = part.temperature[0], part.temperature[-1]
    for before, after in pairwise(part.viscosity):
        if after >= before:
            raise QuantityError(
                f"{where}.viscosity = {after:g} Pa.s: must be below {before:g} Pa.s, as the "
                "temperature is higher"
            )
    if not low <= part.inlet_temperature <= high:
        raise QuantityError(
            f"{where}.inlet_temperature = {part.inlet_temperature:g} degC: must be within "
            f"{where}.temperature, {low:g} to {high:g} degC"
        )
    if part.static_load == 0.0:
        raise QuantityError(f"{where}.static_load = 0 N: must be > 0: the heat balance needs it")
