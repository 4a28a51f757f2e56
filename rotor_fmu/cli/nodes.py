"""Nodes, and what options put at them: clearances of seals, impellers, cross couplings."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError

if TYPE_CHECKING:
    from ..model.linear import Stage
    from ..model.machine.rotor import Rotor

Clearances = Annotated[
    list[str] | None,
    typer.Option(help="NODE:RADIUS, radial clearance of a seal at a node, in m; repeatable."),
]
Stages = Annotated[
    list[str] | None,
    typer.Option(
        help="NODE:POWER:DIAMETER:WIDTH:DENSITY_RATIO of an impeller, in W, m, m, 1, whose cross "
        "coupling follows from Alford's formula; repeatable."
    ),
]
CrossCouplings = Annotated[
    list[str] | None,
    typer.Option(help="NODE:STIFFNESS of a given cross coupling, in N/m; repeatable."),
]


def check_nodes(machine: Rotor, option: str, numbers: Iterable[int]) -> None:
    """Raise `InputError` for a number that is of no node."""
    for number in numbers:
        if not 1 <= number <= len(machine.nodes):
            raise InputError(f"{option} {number}: must be from 1 to {len(machine.nodes)}")


def clearances_of(texts: list[str] | None) -> dict[int, float]:
    """Return the radial clearances [m] by node of each `NODE:RADIUS`."""
    result = {}
    for text in texts or []:
        node, radius = _at_node(text)
        if not radius > 0:
            raise InputError(f"--clearance {text}: must be NODE:RADIUS, the radial clearance in m")
        result[node] = radius
    return result


def cross_couplings(
    machine: Rotor, speed: float, stages: list[str] | None, given: list[str] | None
) -> dict[int, float]:
    """Cross-coupled stiffness by node [N/m] of `--stage`, at a speed [rad/s], and
    `--cross-coupling`."""
    of_stages = [(s.node, s.cross_coupling(speed)) for s in map(_stage, stages or [])]
    result: dict[int, float] = {}
    for number, q in (*of_stages, *map(_coupling, given or [])):
        check_nodes(machine, "node", (number,))
        result[number] = result.get(number, 0.0) + q
    return result


def _coupling(text: str) -> tuple[int, float]:
    node, q = _at_node(text)
    if not q >= 0:
        raise InputError(f"--cross-coupling {text}: must be NODE:STIFFNESS, at least 0 N/m")
    return node, q


def _at_node(text: str) -> tuple[int, float]:
    """Return the node and the value of `NODE:VALUE`, which is NaN where there is no finite one."""
    node, _, value = text.partition(":")
    try:
        number, result = int(node), float(value)
    except ValueError:
        return 0, math.nan
    return number, result if math.isfinite(result) else math.nan


def _stage(text: str) -> Stage:
    from ..model.linear import Stage

    try:
        node, *numbers = text.split(":")
        power, diameter, width, ratio = (float(number) for number in numbers)
        result = Stage(int(node), power, diameter, width, ratio)
        is_known = all(0 < value < math.inf for value in result[1:])
    except ValueError:
        is_known = False
    if not is_known:
        raise InputError(
            f"--stage {text}: must be NODE:POWER:DIAMETER:WIDTH:DENSITY_RATIO, all above 0"
        )
    return result
