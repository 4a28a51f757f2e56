"""Speeds as options give them: one, a range, and the operating range of a machine."""

from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from ..errors import InputError
from ..units import factor, in_si, split

if TYPE_CHECKING:
    from ..model.machine.rotor import Rotor

_MOST_POINTS = 100_000
_FREE = 1e-6  # of the highest frequency: that of a free motion, which is rounding
_WITHIN = 100.0  # times the lowest natural frequency: what a range of frequencies goes up to
_FASTEST = 1e7  # rad/s; a machine that turns faster is one of wrong units

One = Annotated[
    str | None,
    typer.Option(
        "--speed",
        help="Speed, such as 3000rpm or 50Hz; a number without unit is in rad/s; default: 0, or "
        "the rated speed of a machine that oil films hold.",
    ),
]
Range = Annotated[
    str | None,
    typer.Option(
        "--speed",
        help="Speeds FROM:TO or FROM:TO:POINTS, in rad/s, or with rpm or Hz added; default: from "
        "0 to half above the operating range and to the trip speed, or, without one, a quarter "
        "above the lowest natural frequencies. 0 is where oil films begin to carry the machine.",
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
        help="Rated speed, such as 11000rpm, or in rad/s: the operating range where --range is not "
        "given; default: the machine's own range."
    ),
]
RatedSpeed = Annotated[
    str | None,
    typer.Option(
        "--rated",
        help="Rated speed, such as 11000rpm, or in rad/s; default: the machine's maximum "
        "continuous speed, or its rated one.",
    ),
]


def one_speed(text: str, option: str = "--speed") -> float:
    """A speed [rad/s] of `300`, `3000rpm`, `50Hz`; `InputError` for anything else."""
    speed = in_si(option, text, "rad/s")
    _check_size(option, text, speed)
    return speed


def _check_size(option: str, text: str, speed: float) -> None:
    if not abs(speed) <= _FASTEST:
        raise InputError(f"{option} {text}: must be at most {_FASTEST:g} rad/s in size")


def speed_range(text: str | None, points: int | None, option: str = "--speed") -> np.ndarray:
    """Speeds [rad/s] of `FROM:TO[:POINTS]`, or of a single one; none of None; points: see
    `number_range`."""
    if text is None:
        return np.array([])
    speeds = number_range(text, points, option, "rad/s")
    for end in (speeds[0], speeds[-1]):
        _check_size(option, text, float(end))
    return speeds


def number_range(text: str, points: int | None, option: str, si: str) -> np.ndarray:
    """Numbers in an SI unit of `FROM:TO[:POINTS]`, or a single one; a unit stands behind one of the
    ends, or behind both; points: without POINTS; None: the option takes the ends alone."""
    pieces = text.split(":")
    if len(pieces) == 1:
        return np.array([in_si(option, text, si)])
    low, high, count, unit = _ends(pieces, points, f"{option} {text}")
    if not low < high:
        raise InputError(f"{option} {text}: FROM must be below TO")
    scale = factor(f"{option} {text}", unit, si) if unit else 1.0
    return np.linspace(low * scale, high * scale, count)


def _ends(pieces: list[str], points: int | None, shown: str) -> tuple[float, float, int, str]:
    """Return both ends, the number of points and the unit, empty where there is none."""
    form = "FROM:TO" if points is None else "FROM:TO or FROM:TO:POINTS"
    if len(pieces) > (2 if points is None else 3) or not all(piece.strip() for piece in pieces):
        raise InputError(f"{shown}: must be {form}")
    ends = []
    for which, piece in zip(("FROM", "TO"), pieces, strict=False):
        end = split(piece)
        if end is None:
            raise InputError(f"{shown}: {which} must be a finite number, not {piece.strip()}")
        ends.append(end)
    count = points or 2
    if len(pieces) > 2:
        given = pieces[2].strip()
        count = int(given) if given.isdecimal() else 0
        if not 2 <= count <= _MOST_POINTS:
            raise InputError(
                f"{shown}: POINTS must be an integer from 2 to {_MOST_POINTS}, not {given}"
            )
    (low, unit), (high, other) = ends
    if unit and other and unit.lower() != other.lower():
        raise InputError(f"{shown}: must have one unit, not {unit} and {other}")
    return low, high, count, unit or other


def operating_range(
    text: str | None, rated: str | None, machine: "Rotor"
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
    ends = speed_range(text, None, "--range")
    if len(ends) != 2 or ends[0] <= 0:
        raise InputError(f"--range {text}: must be FROM:TO, both above 0")
    return float(ends[0]), float(ends[1])


def rated_speed(text: str | None, machine: "Rotor") -> float:
    """The speed [rad/s] of `--rated`, or the machine's own highest continuous one."""
    if text is None:
        own = machine.operation.service_speed
        if own is None:
            raise InputError(
                "--rated: must be given, such as --rated 11000rpm, or the machine's "
                "operation.maximum_continuous_speed or operation.rated_speed"
            )
        return own
    speed = one_speed(text, "--rated")
    if speed <= 0:
        raise InputError(f"--rated {text}: must be above 0")
    return speed


def usual_speeds(
    machine: "Rotor", contacts: str | None, ends: tuple[float, float] | None, points: int
) -> np.ndarray:
    """Return speeds [rad/s] from 0 to half above the operating range and to the trip speed, or,
    where there is none, to a quarter above the lowest natural frequencies at standstill."""
    from ..model import linear
    from ..model.linear.unbalance_check import highest_of_interest

    if ends is not None:
        top = highest_of_interest(machine, ends[1])
    else:
        damped = linear.modes(machine, count=4, contacts=contacts).damped
        top = 1.25 * float(damped[-1]) if len(damped) else 1000.0
    return np.linspace(0.0, top, points)


def where_carried(speeds: np.ndarray, machine: "Rotor", contacts: str | None) -> np.ndarray:
    """Return a range of speeds [rad/s] of which an end at 0 is where oil films begin to carry the
    machine."""
    ends = [*speeds[:1], *speeds[-1:]]
    if len(speeds) < 2 or all(ends):
        return speeds
    from ..model.linear import lowest_speed

    top = max(ends, key=abs)
    low, high = (end or lowest_speed(machine, top, contacts) for end in ends)
    return np.linspace(low, high, len(speeds))


def usual_frequencies(
    machine: "Rotor", speed: float, contacts: str | None, points: int
) -> np.ndarray:
    """Return frequencies [rad/s] from 1 Hz, or half the lowest natural frequency at a speed
    [rad/s], to three times the machine's highest speed and a quarter above the lowest natural
    frequencies, as far as they lie within a hundred times the first; to 500 Hz at least."""
    from ..model import linear

    found = linear.modes(machine, speed, contacts=contacts).natural
    own = (speed, *machine.operation.speeds.values())
    found = found[found > _FREE * found.max(initial=0.0)]
    low = min([2 * np.pi, *(0.5 * found[:1])])
    near = found[found <= _WITHIN * found.min(initial=np.inf)]
    high = max([1000 * np.pi, *(1.25 * near), *(3 * abs(given) for given in own)])
    return np.linspace(low, high, points)
