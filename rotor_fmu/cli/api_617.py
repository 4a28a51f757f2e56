"""`rotor-fmu critical-map` and `stability`: what API 617 and 684 ask for beside the response."""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import typer

from ..errors import InputError
from ..output_options import with_output_options
from .nodes import CrossCouplings, Stages, check_nodes, cross_couplings
from .shared import Contacts, PictureFolder, RotorFile, Units, check_count
from .show_result import machine_in_units, print_answer
from .speeds import RatedSpeed, number_range, rated_speed


@with_output_options
def critical_map(
    rotor: RotorFile = None,
    stiffness: Annotated[
        str | None,
        typer.Option(
            help="FROM:TO or FROM:TO:POINTS, in N/m or such as 1e4:1e7lbf/in, spaced evenly on a "
            "logarithmic axis; default: two decades on either side of the bearings' own."
        ),
    ] = None,
    count: Annotated[int, typer.Option(help="Number of lines, the lowest ones.")] = 4,
    at_rest: Annotated[
        bool,
        typer.Option(
            "--at-rest", help="Natural frequencies at standstill instead of critical speeds."
        ),
    ] = False,
    rigid_pedestals: Annotated[
        bool, typer.Option("--rigid-pedestals", help="Take housings and pedestals as ground.")
    ] = False,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/critical_map"),
) -> dict[str, Any]:
    """Compute the undamped critical speed map: forward critical speeds over the bearings'
    stiffness, with the stiffness that the bearings have themselves."""
    values = None if stiffness is None else _stiffnesses(stiffness)
    machine = machine_in_units(rotor, units)
    check_count(count, 100)
    from ..linear import acceptance

    result = acceptance.critical_map(
        machine,
        values,
        count=count,
        synchronous=not at_rest,
        rigid_pedestals=rigid_pedestals,
        contacts=contacts,
    )
    return print_answer(result, out, "critical_map")


@with_output_options
def stability(
    rated: RatedSpeed = None,
    rotor: RotorFile = None,
    level: Annotated[int, typer.Option(help="Level of the analysis, 1 or 2.")] = 1,
    stage: Stages = None,
    cross_coupling: CrossCouplings = None,
    node: Annotated[
        int | None,
        typer.Option(
            help="With level 1: node of the cross coupling; default: midway between the bearings, "
            "or at the largest stage where all stand beyond them."
        ),
    ] = None,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/stability"),
) -> dict[str, Any]:
    """Compute the stability at the rated speed by API 617: the least logarithmic decrement of the
    forward modes over the cross coupling (level 1) or with each seal (level 2)."""
    if level not in (1, 2):
        raise InputError(f"--level {level}: must be 1 or 2")
    machine = machine_in_units(rotor, units)
    speed = rated_speed(rated, machine)
    couplings = cross_couplings(machine, speed, stage, cross_coupling)
    from ..linear import acceptance

    result: acceptance.StabilityLevel1 | acceptance.StabilityLevel2
    if level == 1:
        check_nodes(machine, "--node", () if node is None else (node,))
        result = acceptance.level_1(
            machine, speed, node=node, anticipated=couplings or 0.0, contacts=contacts
        )
    else:
        if node is not None:
            raise InputError(
                f"--node {node}: is of level 1; at level 2 each cross coupling has its own node"
            )
        result = acceptance.level_2(machine, speed, cross_couplings=couplings, contacts=contacts)
    return print_answer(result, out, "stability")


def _stiffnesses(text: str) -> np.ndarray:
    """Stiffnesses [N/m] of `FROM:TO[:POINTS]`, spaced evenly on a logarithmic axis."""
    values = number_range(text, 33, "--stiffness", "N/m")
    if len(values) < 2 or values[0] <= 0:
        raise InputError(f"--stiffness {text}: must be FROM:TO or FROM:TO:POINTS, FROM above 0 N/m")
    return np.geomspace(values[0], values[-1], len(values))
