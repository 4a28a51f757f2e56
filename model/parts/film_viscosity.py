"""Viscosity of an oil film as a function of speed or temperature.

With temperature the film has one temperature at each speed, that of its heat balance,

    T = inlet + share P / (density c Q)

with the power P and the side flow Q of the journal in equilibrium under the static load. share = 1
is the adiabatic balance: all heat leaves with the lubricant. The result is a table over the speed
alone, and a run uses the viscosity of its speed at once, wherever its journal is.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import cache, lru_cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..quantities import ANY, NOT_NEGATIVE, QuantityError, Rule, quantity
from .film_equilibrium import FilmProbe
from .speed_table import check_ascending, check_column, interpolant

_SHARE = Rule(0.0, False, "must be from 0 to 1", most=1.0)
_CLOSE = 1e-6  # K, of a film's temperature
_STEEP = 1e3  # K, that a balance changes as the temperature does by one


@dataclass(frozen=True, kw_only=True)
class HeatQuantities:
    """Abscissae of a list of viscosities: speed [rad/s], or temperature [degC], with the heat
    balance: temperature at the inlet [degC], density [kg/m3] and specific heat [J/(kg.K)] of the
    lubricant, the share of the film's power that it carries away [1], and the load of the balance
    [N]."""

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
        *("N", "load, downwards, under which the heat balance is made", NOT_NEGATIVE, 0.0)
    )


class Oil(NamedTuple):
    """The lubricant of a film over n speeds [rad/s]: temperature [degC] and viscosity [Pa.s]."""

    speed: tuple[float, ...]
    temperature: tuple[float, ...]
    viscosity: tuple[float, ...]


def check_viscosity(where: str, part: Any) -> None:
    """Raise `QuantityError` for a list of viscosities without abscissae, or whose heat balance
    leaves the list."""
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
        if field.name != "speed" and getattr(part, field.name) != field.default:
            raise QuantityError(f"{where}.{field.name}: needs {where}.temperature, for its balance")


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
    try:
        oil_of(part)
    except QuantityError as error:
        raise QuantityError(f"{where}: {error}") from None


def viscosity_over_temperature(part: Any) -> Callable[[float], float]:
    """Return the viscosity [Pa.s] over the temperature [degC]; its logarithm is interpolated."""
    logarithm = interpolant(part.temperature, np.log(part.viscosity))
    return lambda temperature: math.exp(float(logarithm(temperature)))


def oil_of(part: Any) -> Oil | None:
    """Return the lubricant of a bearing over the speeds of its table; None if it is constant.

    Raises `QuantityError` if its heat balance leaves the table.
    """
    if not isinstance(part.viscosity, tuple):
        return None
    if not part.temperature:
        return Oil(part.speed, (), part.viscosity)
    own = {f.name for f in fields(part)} & {"node", "housing", "name"}
    none = {"node": 1, "housing": "", "name": ""}
    return _balanced(replace(part, **{name: none[name] for name in own}))


@lru_cache(maxsize=32)
def _balanced(part: Any) -> Oil:
    viscosity = viscosity_over_temperature(part)
    temperatures = tuple(_temperature(part, speed, viscosity) for speed in part.speed)
    return Oil(part.speed, temperatures, tuple(map(viscosity, temperatures)))


def _temperature(part: Any, speed: float, viscosity: Callable[[float], float]) -> float:
    """Return the temperature of the film at a speed [degC]."""
    if speed == 0.0 or part.heat_share == 0.0:
        return float(part.inlet_temperature)
    places: list[complex] = []

    @cache
    def film_temperature(temperature: float) -> float | None:
        """Return the film temperature for the viscosity at another temperature; None if the film
        does not carry its load."""
        constant = {"viscosity": viscosity(temperature), "speed": (), "temperature": ()}
        film = FilmProbe(replace(part, **constant), speed, "")
        d = film.equilibrium(-1j * part.static_load, places[-1] if places else None)
        if d is None or film.is_invalid(d):
            return None
        places.append(d)
        seen = film.outputs(d)
        heat = part.heat_share * seen["power"]
        carried = part.density * part.specific_heat * seen["flow"]
        return float(part.inlet_temperature + heat / carried) if carried > 0.0 else math.inf

    low, end = float(part.inlet_temperature), float(part.temperature[-1])
    first = film_temperature(low)
    if first is None:
        raise QuantityError(
            f"no equilibrium: its film does not carry static_load = {part.static_load:g} N at "
            f"{speed:g} rad/s and {low:g} degC"
        )
    high = min(first, end)
    at_end = film_temperature(high)
    if at_end is not None and at_end > high:
        raise QuantityError(
            f"its film would be hotter at {speed:g} rad/s than its temperature, which ends at "
            f"{end:g} degC; give a longer list, a smaller heat_share or a thinner lubricant"
        )

    def temperature_residual(temperature: float) -> float:
        """Return the temperature residual of the heat balance; 1 if the film does not carry the
        load."""
        result = film_temperature(temperature)
        return 1.0 if result is None else temperature - result

    # imported where a balance is made: it takes longer than all else that a machine is made of
    from scipy.optimize import brentq

    balanced = float(brentq(temperature_residual, low, high, xtol=_CLOSE)) if high > low else low
    if film_temperature(balanced) is None or abs(temperature_residual(balanced)) > _STEEP * _CLOSE:
        raise QuantityError(
            f"no equilibrium: its film does not carry static_load = {part.static_load:g} N at "
            f"{speed:g} rad/s, as it heats above {low:.4g} degC"
        )
    return balanced
