"""The temperature of an oil film as a function of the speed, and so its viscosity.

The film has one temperature at each speed, that of its heat balance,

    T = inlet + share P / (density c Q)

with the power P and the side flow Q of the journal in equilibrium under the static load, which is
along gravity. share = 1 is the adiabatic balance: all heat leaves with the lubricant. The result is
a table over the speed alone for each sense of rotation, and a run uses the viscosity of its speed
at once, wherever its journal is.
"""

import math
from collections.abc import Callable
from dataclasses import fields, replace
from functools import cache, lru_cache
from typing import Any, NamedTuple

import numpy as np

from ..machine.rotor import AnyPart, Rotor
from ..parts.base import GROUND
from ..parts.bearing_with_oil import BearingWithOil
from ..parts.film_viscosity import KEPT, HeatQuantities
from ..parts.journal_bearing import JournalBearing
from ..parts.speed_table import interpolant
from ..quantities import QuantityError

_CLOSE = 1e-6  # K, of a film's temperature
_STEEP = 1e3  # K, that a balance changes as the temperature does by one
_NO_BALANCE: dict[str, Any] = {
    field.name: field.default for field in fields(HeatQuantities) if field.name not in KEPT
}


class Oil(NamedTuple):
    """The lubricant of a film over n speeds [rad/s] of one sense of rotation, by their sizes:
    temperature [degC] and viscosity [Pa.s]."""

    speed: tuple[float, ...]
    temperature: tuple[float, ...]
    viscosity: tuple[float, ...]


def machine_with_oil(rotor: Rotor) -> Rotor:
    """Return a machine whose films have their viscosities over the speed; see `with_oil`."""
    parts = tuple(with_oil(part, where, rotor.downwards) for where, part in rotor.named_parts())
    is_same = all(a is b for a, b in zip(parts, rotor.parts, strict=True))
    return rotor if is_same else replace(rotor, parts=parts)


def with_oil(part: AnyPart, where: str, downwards: complex) -> AnyPart | BearingWithOil:
    """Return a journal bearing with the viscosity over the speed that its heat balance gives it, or
    another part as it is; where: its name; downwards: the direction of its load. Raises
    `QuantityError` as `oil_of_both` does."""
    if not isinstance(part, JournalBearing) or not part.temperature:
        return part
    try:
        positive, negative, why_positive = oil_of_both(part, downwards)
    except QuantityError as error:
        raise QuantityError(f"{where}: {error}") from None
    given = {field.name: getattr(part, field.name) for field in fields(part)}
    return BearingWithOil(
        **given | _NO_BALANCE | {"viscosity": positive.viscosity},
        negative_viscosity=negative.viscosity,
        why_positive=why_positive,
    )


def oil_of_both(part: JournalBearing, downwards: complex) -> tuple[Oil, Oil, str]:
    """Return the lubricant of a bearing with a heat balance at positive and at negative speeds;
    downwards: the direction of its load, of length 1.

    Without a balance at negative speeds, which most machines never have, the lubricant there is
    that of positive ones, and the text says why; else it is empty. Raises `QuantityError` as
    `oil_of` does for positive speeds.
    """
    positive = oil_of(part, downwards, 1)
    try:
        return positive, oil_of(part, downwards, -1), ""
    except QuantityError as error:
        return positive, positive, str(error)


def oil_of(part: JournalBearing, downwards: complex, sense: int) -> Oil:
    """Return the lubricant of a bearing with a heat balance over the speeds of its list;
    downwards: the direction of its load, of length 1; sense: of rotation, 1 or -1.

    Raises `QuantityError` if the balance leaves the list of temperatures.
    """
    if not part.pads:  # a plain circle is its own mirror image
        sense = 1
    return _balanced(replace(part, node=1, housing=GROUND, name=""), downwards, sense)


@lru_cache(maxsize=32)
def _balanced(part: JournalBearing, downwards: complex, sense: int) -> Oil:
    viscosity = _over_temperature(part)
    temperatures = tuple(_temperature(part, sense * s, viscosity, downwards) for s in part.speed)
    return Oil(part.speed, temperatures, tuple(map(viscosity, temperatures)))


def _over_temperature(part: JournalBearing) -> Callable[[float], float]:
    """Return the viscosity [Pa.s] over the temperature [degC]; its logarithm is interpolated."""
    logarithm = interpolant(part.temperature, np.log(part.viscosity))
    return lambda temperature: math.exp(float(logarithm(temperature)))


def _temperature(
    part: JournalBearing, speed: float, viscosity: Callable[[float], float], downwards: complex
) -> float:
    """Return the temperature of the film at a speed [degC]."""
    if speed == 0.0 or part.heat_share == 0.0:
        return float(part.inlet_temperature)
    # imported where a balance is made: they take longer than all else that a machine is made of
    from scipy.optimize import brentq

    from .film_at_rest import FilmAtRest

    places: list[complex] = []

    @cache
    def film_temperature(temperature: float) -> float | None:
        """Return the film temperature for the viscosity at another temperature; None if the film
        does not carry its load."""
        of_constant = replace(part, viscosity=viscosity(temperature), speed=(), temperature=())
        film = FilmAtRest(of_constant, speed, "")
        d = film.equilibrium(downwards * part.static_load, places[-1] if places else None)
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
        """Return the temperature residual of the heat balance; 1 if the film carries too little."""
        result = film_temperature(temperature)
        return 1.0 if result is None else temperature - result

    balanced = float(brentq(temperature_residual, low, high, xtol=_CLOSE)) if high > low else low
    if film_temperature(balanced) is None or abs(temperature_residual(balanced)) > _STEEP * _CLOSE:
        raise QuantityError(
            f"no equilibrium: its film does not carry static_load = {part.static_load:g} N at "
            f"{speed:g} rad/s, as it heats above {low:.4g} degC"
        )
    return balanced
