"""Nodes, and what options put at them: unbalances, clearances of seals, impellers, cross
couplings."""

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from ..errors import InputError
from ..model.machine.rotor import Rotor
from ..units import in_si, split

if TYPE_CHECKING:
    from ..model.linear import Stage

Clearances = Annotated[
    list[str] | None,
    typer.Option(
        help="NODE:RADIUS, radial clearance of a seal at a node, such as 6:0.3mm, or in m; "
        "repeatable."
    ),
]
Stages = Annotated[
    list[str] | None,
    typer.Option(
        help="NODE:POWER:DIAMETER:WIDTH:DENSITY_RATIO of an impeller, such as "
        "6:500kW:300mm:20mm:2.5, or in W, m, m, 1, whose cross coupling follows from Alford's "
        "formula; repeatable."
    ),
]
CrossCouplings = Annotated[
    list[str] | None,
    typer.Option(
        help="NODE:STIFFNESS of a given cross coupling, such as 6:20kN/m, or in N/m; repeatable."
    ),
]


def check_nodes(
    machine: Rotor, option: str, numbers: Iterable[int], *, may_repeat: bool = False
) -> None:
    """Raise `InputError` for a number that is of no node, or, unless it may, is there twice."""
    seen: set[int] = set()
    for number in numbers:
        if not 1 <= number <= len(machine.nodes):
            raise InputError(f"{option} {number}: must be from 1 to {len(machine.nodes)}")
        if number in seen and not may_repeat:
            raise InputError(f"{option} {number}: is given twice; they must be different nodes")
        seen.add(number)


def clearances_of(texts: list[str] | None) -> dict[int, float]:
    """Return the radial clearances [m] by node of each `NODE:RADIUS`."""
    result = {}
    for text in texts or []:
        node, (radius,) = _at_node("--clearance", text, "NODE:RADIUS", ("m",))
        if not radius > 0:
            raise InputError(f"--clearance {text}: must be NODE:RADIUS, RADIUS above 0")
        if node in result:
            raise InputError(f"--clearance {text}: node {node} has another one already")
        ask_if_meant("--clearance", text, "clearance", radius, "m")
        result[node] = radius
    return result


def unbalances_of(texts: list[str] | None) -> list[tuple[int, float, float]]:
    """Return node, amount [kg.m] and angle [rad] of each `NODE:AMOUNT` or `NODE:AMOUNT:ANGLE`."""
    return [_unbalance(text) for text in texts or []]


def _unbalance(text: str) -> tuple[int, float, float]:
    option, form = "--unbalance", "NODE:AMOUNT or NODE:AMOUNT:ANGLE"
    pieces = text.split(":")
    if len(pieces) == 2:
        pieces.append("0")
    angle = split(pieces[-1])
    if angle is None:
        raise InputError(f"{option} {text}: must be {form}")
    if not angle[1]:
        pieces[-1] += "deg"
    node, (amount, phase) = _at_node(option, text, form, ("kg.m", "rad"), pieces)
    ask_if_meant(option, text, "amount", abs(amount), "kg.m")
    return node, amount, phase


def ask_if_meant(option: str, text: str, name: str, value: float, unit: str) -> None:
    """Warn of the value of an option, in an SI unit, that a part's quantity of this name would not
    have."""
    from ..machine_file.loading import to_screen
    from ..machine_file.plausibility import implausible_number

    for sentence in implausible_number(f"{option} {text}: {name}", name, value, unit):
        to_screen(sentence)


def cross_couplings(
    machine: Rotor, speed: float, stages: list[str] | None, given: list[str] | None
) -> dict[int, float]:
    """Cross-coupled stiffness by node [N/m] of `--stage`, at a speed [rad/s], and
    `--cross-coupling`."""
    of_stages = [("--stage", s.node, s.cross_coupling(speed)) for s in map(_stage, stages or [])]
    result: dict[int, float] = {}
    coupled = [("--cross-coupling", *_coupling(text)) for text in given or []]
    for option, number, q in (*of_stages, *coupled):
        check_nodes(machine, option, (number,))
        result[number] = result.get(number, 0.0) + q
    return result


def _coupling(text: str) -> tuple[int, float]:
    node, (q,) = _at_node("--cross-coupling", text, "NODE:STIFFNESS", ("N/m",))
    if not q >= 0:
        raise InputError(f"--cross-coupling {text}: must be NODE:STIFFNESS, at least 0 N/m")
    return node, q


def _at_node(
    option: str, text: str, form: str, units: Sequence[str], pieces: Sequence[str] = ()
) -> tuple[int, list[float]]:
    """Return the node and the values, in SI units, of `NODE:VALUE:...`; form: how it is written;
    pieces: the text's, where something was added to them."""
    node, *values = pieces or text.split(":")
    if len(values) != len(units) or not node.strip().isdecimal():
        raise InputError(f"{option} {text}: must be {form}")
    given = zip(values, units, strict=True)
    return int(node), [in_si(f"{option} {node}:", value, unit) for value, unit in given]


def _stage(text: str) -> "Stage":
    from ..model.linear import Stage

    form = "NODE:POWER:DIAMETER:WIDTH:DENSITY_RATIO"
    node, numbers = _at_node("--stage", text, form, ("W", "m", "m", "1"))
    if not min(numbers) > 0:
        raise InputError(f"--stage {text}: power, diameter, width and ratio must be above 0")
    return Stage(node, *numbers)
