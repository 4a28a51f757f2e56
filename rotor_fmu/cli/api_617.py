"""`rotor-fmu critical-map`, `stability` and `unbalance`, by API 617 and 684, and `balance`."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
import typer

from ..errors import InputError, writable_folder
from ..files import write_csv
from ..output_options import with_output_options
from ..screen import progress_of
from ..units import in_si
from .nodes import (
    Clearances,
    CrossCouplings,
    Stages,
    ask_if_meant,
    check_nodes,
    clearances_of,
    cross_couplings,
    unbalances_of,
)
from .shared import Contacts, PictureFolder, RotorFile, Units, check_count
from .show_result import machine_in_units, print_answer, say
from .speeds import (
    OperatingRange,
    Range,
    Rated,
    RatedSpeed,
    number_range,
    one_speed,
    operating_range,
    rated_speed,
    speed_range,
    usual_speeds,
    where_carried,
)

if TYPE_CHECKING:
    from ..linear.answers import UnbalanceResponse
    from ..model.machine.rotor import Rotor


@with_output_options
def critical_map(
    rotor: RotorFile = None,
    stiffness: str | None = None,
    count: int = 4,
    at_rest: bool = False,
    rigid_pedestals: bool = False,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/critical_map"),
) -> dict[str, Any]:
    """Compute the undamped critical speed map: forward critical speeds over the bearings'
    stiffness, with the stiffness that the bearings have themselves.

    stiffness: FROM:TO or FROM:TO:POINTS, in N/m or such as 1e4:1e7lbf/in, spaced evenly on a
        logarithmic axis; default: two decades on either side of the bearings' own.
    count: How many critical speeds, the lowest at each stiffness, lie on lines.
    at_rest: Natural frequencies at standstill instead of critical speeds.
    rigid_pedestals: Take housings and pedestals as ground.
    """
    values = None if stiffness is None else _stiffnesses(stiffness)
    machine = machine_in_units(rotor, units)
    check_count(count, 100)
    from ..linear import acceptance
    from ..linear.where_linearized import where_beyond_ranges
    from ..model.linear.undamped import without_seals

    result = acceptance.critical_map(
        machine,
        values,
        count=count,
        synchronous=not at_rest,
        rigid_pedestals=rigid_pedestals,
        contacts=contacts,
    )
    speeds = [crossing.speed for crossing in result.crossings]
    say(where_beyond_ranges(without_seals(machine), speeds))
    return print_answer(result, out, "critical_map")


@with_output_options
def stability(
    rated: RatedSpeed = None,
    rotor: RotorFile = None,
    level: int = 1,
    stage: Stages = None,
    cross_coupling: CrossCouplings = None,
    node: int | None = None,
    contacts: Contacts = None,
    units: Units = None,
    out: PictureFolder = Path("out/stability"),
) -> dict[str, Any]:
    """Compute the stability at the maximum continuous or the rated speed by API 617: the least
    logarithmic decrement of the forward modes over the cross coupling (level 1) or with each seal
    (level 2).

    level: Level of the analysis, 1 or 2.
    node: With level 1: node of the cross coupling; default: midway between the bearings, or at the
        largest stage where all stand beyond them.
    """
    if level not in (1, 2):
        raise InputError(f"--level {level}: must be 1 or 2")
    machine = machine_in_units(rotor, units)
    speed = rated_speed(rated, machine)
    couplings = cross_couplings(machine, speed, stage, cross_coupling)
    from ..linear import stability_answers
    from ..linear.where_linearized import where_linearized
    from ..model.linear.undamped import without_seals

    result: stability_answers.StabilityLevel1 | stability_answers.StabilityLevel2
    if level == 1:
        check_nodes(machine, "--node", () if node is None else (node,))
        result = stability_answers.level_1(
            machine, speed, node=node, anticipated=couplings or 0.0, contacts=contacts
        )
        machine, couplings = without_seals(machine), {result.node: result.anticipated}
    else:
        if node is not None:
            raise InputError(
                f"--node {node}: is of level 1; at level 2 each cross coupling has its own node"
            )
        result = stability_answers.level_2(
            machine, speed, cross_couplings=couplings, contacts=contacts
        )
    say(where_linearized(machine, [speed], contacts, coupling=couplings))
    return print_answer(result, out, "stability")


def _stiffnesses(text: str) -> np.ndarray:
    """Stiffnesses [N/m] of `FROM:TO[:POINTS]`, spaced evenly on a logarithmic axis."""
    values = number_range(text, 33, "--stiffness", "N/m")
    if len(values) < 2 or values[0] <= 0:
        raise InputError(f"--stiffness {text}: must be FROM:TO or FROM:TO:POINTS, FROM above 0 N/m")
    return np.geomspace(values[0], values[-1], len(values))


@with_output_options
def unbalance(
    rotor: RotorFile = None,
    speed: Range = None,
    node: list[int] | None = None,
    at: Annotated[list[str] | None, typer.Option("--unbalance")] = None,
    mode: int | None = None,
    factor: float | None = None,
    operating: OperatingRange = None,
    rated: Rated = None,
    clearance: Clearances = None,
    contacts: Contacts = None,
    units: Units = None,
    out: Path = Path("out/unbalance"),
) -> dict[str, Any]:
    """Compute the steady response to unbalance, its critical speeds with amplification factors,
    and, with --range, separation margins, probe limits and clearances by API 617.

    The answer has x, y, major semi-axis and phase at each node shown, of more than 12 speeds also
    at the peaks between them. These nodes are the probes.

    node: Node to show, counted from 1; repeatable; default: the nodes with the largest orbits.
    at: NODE:AMOUNT:ANGLE, such as 4:50g.mm:90, or in kg.m and with a unit behind the angle, which
        is else in degrees; replaces the machine's own unbalances and bows; repeatable.
    mode: Place the unbalances that API 617 prescribes (4W/N) for this mode, from 1, instead of the
        machine's own and its bows.
    factor: With --mode: multiple of the residual unbalance 4W/N; default: 2.
    out: Folder for picture and CSV.
    """
    from ..model.linear.unbalance_check import SPEEDS

    speeds, machine = speed_range(speed, SPEEDS), machine_in_units(rotor, units)
    given: Any = unbalances_of(at) or None
    ends = operating_range(operating, rated, machine)
    gaps = clearances_of(clearance)
    if mode is not None and given:
        raise InputError("--mode, --unbalance: only one of them may place unbalances")
    if mode is None and factor is not None:
        raise InputError(f"--factor {factor:g}: needs --mode, whose unbalances it multiplies")
    if (mode is not None or gaps) and ends is None:
        raise InputError("--mode and --clearance: need the operating range, --range FROM:TO")
    check_nodes(machine, "--node", node or ())
    check_nodes(machine, "--clearance", gaps)
    check_nodes(machine, "--unbalance", (n for n, _, _ in given or ()), may_repeat=True)
    from ..linear import acceptance, answers
    from ..linear.where_linearized import which_bows_act
    from ..model.linear.unbalance_placement import FACTOR, placed_unbalances

    if mode is not None and ends is not None:
        times = FACTOR if factor is None else factor
        placed = placed_unbalances(machine, mode, ends[1], factor=times, contacts=contacts)
        given = [p.acting for p in placed]
    if len(speeds) == 0:
        speeds = usual_speeds(machine, contacts, ends, SPEEDS)
    speeds = where_carried(speeds, machine, contacts)
    acting: dict[str, Any] = {"contacts": contacts, "unbalances": given}
    if len(speeds) > answers.MOST_SPEEDS:
        result = answers.response_with_peaks(machine, speeds, nodes=node or (), **acting)
    else:
        result = answers.unbalance_response(machine, speeds, **acting)
    nodes = node or result.nodes()
    if ends is None:
        ends_of_ways = {float(min(*speeds, 0.0)), float(max(*speeds, 0.0))}
        tops = sorted(ends_of_ways - {0.0}) or [0.0]
        checked: Any = acceptance.critical_peaks(machine, tops, nodes, **acting)
    else:
        checked = acceptance.unbalance_check(machine, *ends, nodes, clearances=gaps, **acting)
    say(which_bows_act(machine, given))
    _say_where_it_holds(machine, result, ends, contacts)
    writable_folder(out)
    _write_response(result, nodes, out / "unbalance.csv")
    more = {"criticals" if ends is None else "check": checked}
    shown = result.table(nodes), result.figure(nodes, ends)
    return print_answer(result, out, "unbalance", *shown, more)


def _say_where_it_holds(
    machine: "Rotor",
    response: "UnbalanceResponse",
    ends: tuple[float, float] | None,
    contacts: str | None,
) -> None:
    """Print about which states a response, and its check over an operating range, is linearized."""
    from ..linear.where_linearized import where_films_are_left, where_linearized, where_not_reached
    from ..model.linear.unbalance_check import highest_of_interest

    looked_at = [*response.speeds]
    # a magnetic pull makes a machine unstable where its films are soft, whirls where it is fast
    outermost = [max(looked_at, key=abs), min(filter(None, looked_at), key=abs, default=0.0)]
    if ends is not None:
        looked_at += [ends[0], highest_of_interest(machine, ends[1])]
        outermost.append(ends[1])
    say(
        where_linearized(machine, looked_at, contacts),
        where_not_reached(machine, dict.fromkeys(outermost), contacts),
        where_films_are_left(machine, response),
    )


def _write_response(result: Any, nodes: list[int], path: Path) -> None:
    """A row a speed: of each node the amplitudes 0-p, the phases and the semi-axes."""
    columns = {"speed [rad/s]": result.speeds}
    for node in nodes:
        at = node - 1
        columns |= {
            f"node[{node}].x [m]": np.abs(result.x[:, at]),
            f"node[{node}].y [m]": np.abs(result.y[:, at]),
            f"node[{node}].x_phase [rad]": result.phase_x[:, at],
            f"node[{node}].y_phase [rad]": result.phase_y[:, at],
            f"node[{node}].major [m]": result.major[:, at],
            f"node[{node}].minor [m]": result.minor[:, at],
        }
    write_csv(columns, path)


@with_output_options
def balance(
    rotor: RotorFile = None,
    speed: list[str] | None = None,
    plane: list[int] | None = None,
    node: list[int] | None = None,
    trial: Annotated[str | None, typer.Option(metavar="UNBALANCE")] = None,
    units: Units = None,
    out: PictureFolder = Path("out/balance"),
) -> dict[str, Any]:
    """Balance a machine by influence coefficients (ISO 21940-12), from runs in time: as it is, with
    a trial unbalance in each correction plane, and with the correction unbalances.

    speed: Balancing speed, in rad/s or with rpm or Hz added; at least one; repeatable.
    plane: Node of a correction plane, counted from 1; at least one; repeatable.
    node: Node where vibration is measured; repeatable; default: the planes.
    trial: Trial unbalance of each plane, such as 50g.mm, or in kg.m; default: all together pull
        with a tenth of the rotor's weight.
    """
    if not speed or not plane:
        raise InputError("--speed and --plane: must be given, such as --speed 1500rpm --plane 4")
    speeds, machine = [one_speed(text) for text in speed], machine_in_units(rotor, units)
    amount = None
    if trial is not None:
        amount = in_si("--trial", trial, "kg.m")
        ask_if_meant("--trial", trial, "amount", amount, "kg.m")
    check_nodes(machine, "--plane", plane)
    check_nodes(machine, "--node", node or ())
    from ..balancing.trial_runs import balance as balanced
    from ..linear.where_linearized import where_it_is_not_balanced

    runs = len(speeds) * (2 + len(plane))
    with progress_of("balance", runs, first=0.0) as update:

        def report(done: int, what: str) -> Callable[[float, Callable[[], str]], None]:
            words = f"run {done + 1} of {runs}, {what}"
            if not done:  # all that was asked for is checked, and nothing was run
                writable_folder(out)
                say(where_it_is_not_balanced(machine, max(speeds, key=abs)))
            update(done, lambda: words, False)

            def within(share: float, steps: Callable[[], str]) -> None:
                text = f"{words}, {share:.0%} done, "
                update(done + share, lambda: text + steps(), False)

            return within

        result = balanced(machine, speeds, plane, measured=node, trial=amount, report=report)
    return print_answer(result, out, "balance")
