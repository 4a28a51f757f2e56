"""Speeds as options give them: one, a range, and the operating range of a machine."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from ..errors import InputError
from ..units import in_si, units_for

if TYPE_CHECKING:
    from ..model.machine.rotor import Rotor

_MOST_POINTS = 100_000

One = Annotated[
    str,
    typer.Option(
        "--speed", help="Speed, such as 3000rpm or 50Hz; a number without unit is in rad/s."
    ),
]
Range = Annotated[
    str | None,
    typer.Option(
        "--speed", help="Speeds FROM:TO or FROM:TO:POINTS, in rad/s, or with rpm or Hz added."
    ),
]
OperatingRange = Annotated[
    str | None,
    typer.Option(
        "--range",
        help="Minimum and maximum continuous speed FROM:TO, in rad/s, or with rpm or Hz added; "
        "default: those of the machine's table operation.",
    ),
]
Rated = Annotated[
    str | None,
    typer.Option(
        help="Rated speed, such as 11000rpm: the range where --range is not given; default: the "
        "machine's own."
    ),
]


def one_speed(text: str, option: str = "--speed") -> float:
    """A speed [rad/s] of `300`, `3000rpm`, `50Hz`; `InputError` for anything else."""
    return in_si(option, text, "rad/s")


def _without_unit(text: str, option: str, si: str) -> tuple[str, float]:
    """The text without the unit that stands in it, and what that is in the SI unit."""
    units = {unit.lower(): factor for unit, factor in units_for(si).items()}
    any_unit = "|".join(sorted(units, key=len, reverse=True))
    result = {unit.lower() for unit in re.findall(any_unit, text, re.I)}
    if len(result) > 1:
        raise InputError(f"{option} {text}: must have one unit, not {' and '.join(sorted(result))}")
    return re.sub(any_unit, "", text, flags=re.I), units[result.pop() if result else si.lower()]


def speed_range(text: str | None, points: int, option: str = "--speed") -> np.ndarray:
    """Speeds [rad/s] of `FROM:TO[:POINTS]`, or of a single one; none of None."""
    return np.array([]) if text is None else number_range(text, points, option, "rad/s")


def number_range(text: str, points: int, option: str, si: str) -> np.ndarray:
    """Numbers in an SI unit of `FROM:TO[:POINTS]`, or a single one."""
    plain, factor = _without_unit(text, option, si)
    ends = plain.split(":")
    if len(ends) == 1:
        return np.array([in_si(option, text, si)])
    try:
        low, high = (float(end) * factor for end in ends[:2])
        count = int(ends[2]) if len(ends) > 2 else points
        is_range = len(ends) <= 3 and math.isfinite(low) and math.isfinite(high)
    except ValueError:
        is_range = False
    if not is_range:
        raise InputError(f"{option} {text}: must be FROM:TO or FROM:TO:POINTS")
    if not low < high:
        raise InputError(f"{option} {text}: FROM must be below TO")
    if not 2 <= count <= _MOST_POINTS:
        raise InputError(f"{option} {text}: POINTS must be an integer from 2 to {_MOST_POINTS}")
    return np.linspace(low, high, count)


def operating_range(
    text: str | None, rated: str | None, machine: Rotor
) -> tuple[float, float] | None:
    """The minimum and maximum continuous speed [rad/s] of `--range` and `--rated`, the range alone
    where both are given; without either those of the machine's own `[operation]`, None if it has
    none."""
    if text is None:
        if rated is None:
            own = [speed for speed in machine.operation.continuous_speeds if speed > 0]
            return (own[0], own[-1]) if own else None
        speed = rated_speed(rated, machine)
        return speed, speed
    ends = speed_range(text, 2, "--range")
    if len(ends) != 2 or ends[0] <= 0:
        raise InputError(f"--range {text}: must be FROM:TO, both above 0")
    return float(ends[0]), float(ends[1])


def rated_speed(text: str | None, machine: Rotor) -> float:
    """The speed [rad/s] of `--rated`, or the machine's own."""
    if text is None:
        own = machine.operation.rated_speed
        if own is None:
            raise InputError(
                "--rated: must be given, such as --rated 11000rpm, or operation.rated_speed"
            )
        return own
    speed = one_speed(text, "--rated")
    if speed <= 0:
        raise InputError(f"--rated {text}: must be above 0")
    return speed


def usual_speeds(
    machine: Rotor, contacts: str | None, ends: tuple[float, float] | None, points: int
) -> np.ndarray:
    """Return speeds [rad/s] from 0 to half above the operating range, or, where there is none, to a
    quarter above the lowest critical speeds."""
    from ..model import linear
    from ..model.linear.unbalance_check import LOOKED_AT

    if ends is not None:
        top = LOOKED_AT * ends[1]
    else:
        damped = linear.modes(machine, count=4, contacts=contacts).damped
        top = 1.25 * float(damped[-1]) if len(damped) else 1000.0
    return np.linspace(0.0, top, points)
