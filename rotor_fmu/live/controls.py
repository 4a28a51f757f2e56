"""The controls of the page: a field, and where its range is known a slider, for everything that a
host may set in the FMU; their values under which a recorded run is repeated; and what a run
records."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ..display import current
from ..errors import InputError
from ..fmi.packing.machine_files import Machine, machine_of
from ..fmi.solver_parameters import PREFIX, REDUCTION
from ..fmi.variables import Variable, start_values
from ..model.machine.rotor import Rotor
from ..model.quantities import ANY, GRAVITY, Rule
from ..model.structure.assembly import assemble
from ..model.structure.structure import total_mass
from ..operating_speeds import operating_speeds
from ..runs.measuring_points import display_name
from ..runs.recording import Recording

# What the page sets by itself from the course of the speed, and what no host can set.
NO_CONTROLS = ("speed", "speed_rate", "speed_continuation", REDUCTION.name)
# Shown at once; the others of a part are one click away.
_USUAL = ("clearance", "mu", "e", "eta_v", "preset", "tolerance", "gravity")
_RECORDED = ("x", "y", "r_amp", "fn", "ft", "psi", "w", "tau", "phi")
_OF_SOLVER = ("solver.steps", "solver.h_last", "solver.error")
_DEGREE = math.pi / 180.0
_SAMPLES_A_TURN = 16
MOST_ROWS = 400_000  # points of a run
_ROUNDED = 2.0**0.5  # by which the distance of two points may be rounded down to a number such as 2
_DECADE, _FEW = 10.0, 4.0  # how far a slider goes from the value in the machine file
_STRAIGHT = 1e-6  # of the largest speed: how far a ramp may be from a straight line


def course(rotor: Rotor) -> dict[str, Any]:
    """Return the controls of the course of the speed, at first the machine's run-down, or a faster
    one where that takes more points than there may be."""
    usual = operating_speeds(rotor)
    least = _ROUNDED * usual.trip**2 * _SAMPLES_A_TURN / (2 * math.pi * MOST_ROWS)
    speed, rate = _linear(0.0, 3 * usual.trip), max(usual.run_down_rate, least)
    rates = {"low": rate / _DECADE, "high": _DECADE * rate, "log": True}
    rows = (
        ("from", "speed at the start", "rad/s", usual.trip, speed),
        ("to", "speed at the end", "rad/s", 0.0, speed),
        ("rate", "rate of the speed", "rad/s2", rate, rates),
        ("hold", "time at the last speed", "s", 0.0, None),
        ("samples", "samples a turn, at the highest speed", "1", float(_SAMPLES_A_TURN), None),
    )
    return {
        "title": "speed",
        "controls": [
            _control(Variable(f"course.{name}", "Real", "parameter", text, unit, start), None)
            | {"slider": slider, "usual": True}
            for name, text, unit, start, slider in rows
        ],
    }


def groups(machine: Machine) -> list[dict[str, Any]]:
    """Return the controls of a machine, in groups: its loads, its parts, the solver."""
    rules = {name: of.quantity.rule for name, of in machine.rotor.parameters().items()}
    largest = _largest(machine.table)
    weight = _weight(machine)
    found: dict[str, dict[str, Any]] = {}
    for reference, v in enumerate(machine.table):
        if v.is_observed or v.name in NO_CONTROLS:
            continue
        part, _, quantity = v.name.rpartition(".")
        title = "loads" if v.causality == "input" else _title(part) if part else "machine"
        slider = _slider(v, rules.get(v.name), largest[_kind(v)])
        if v.causality == "input":
            slider = _linear(-weight, weight) if v.unit == "N" else _linear(-10.0, 10.0)
        group = found.setdefault(title, {"title": title, "controls": []})
        control = _control(v, reference) | {"slider": slider, "usual": quantity in _USUAL}
        group["controls"].append(control)
    return list(found.values())


def _title(part: str) -> str:
    return display_name(part).replace("_", " ")


def _kind(v: Variable) -> tuple[str, str]:
    """Return what parts of one kind share: the kind and the quantity."""
    part, _, quantity = v.name.rpartition(".")
    return part.partition("[")[0], quantity


def _largest(table: Sequence[Variable]) -> Mapping[tuple[str, str], float]:
    """Return the largest value in size of a quantity over all parts of one kind."""
    result: dict[tuple[str, str], float] = {}
    for v in table:
        if v.start is not None:
            result[_kind(v)] = max(result.get(_kind(v), 0.0), abs(float(v.start)))
    return result


def _weight(machine: Machine) -> float:
    """Return the rotor's weight on earth, rounded up to one digit: what loads compare with [N]."""
    mass = total_mass(assemble(machine.rotor))
    decade = 10.0 ** math.floor(math.log10(mass * GRAVITY))
    return math.ceil(mass * GRAVITY / decade) * decade


def _control(v: Variable, reference: int | None) -> dict[str, Any]:
    part, _, _ = v.name.rpartition(".")
    text = v.text.partition(";")[0].removeprefix(f"{display_name(part)}: ")
    return {
        "name": v.name,
        "reference": reference,
        "kind": v.kind,
        "text": text.partition(": 0 ")[0],
        "label": display_name(v.name),
        "about": v.text,
        "si": v.unit if v.kind == "Real" else "1",
        **shown_in(v.unit if v.kind == "Real" else "1"),
        "start": None if v.start is None else float(v.start),
        "unset": v.is_unset_at_start,
        "choices": list(v.choices),
    }


def shown_in(unit: str) -> dict[str, Any]:
    """Return the unit in which a quantity in an SI unit is shown, and the factor to it; angles are
    shown in degrees, numbers without unit."""
    factor, shown = (1.0 / _DEGREE, "°") if unit == "rad" else current().of_si(unit)
    return {"unit": "" if shown == "1" else shown, "factor": factor}


def _slider(v: Variable, rule: Rule | None, largest: float) -> dict[str, Any] | None:
    """Return the range of a quantity's slider, None for one that has only a field."""
    if v.kind != "Real" or v.name.startswith(PREFIX):
        return None
    if v.unit == "rad":
        start = float(v.start or 0.0)
        middle = start if abs(start) > math.pi else 0.0
        return _linear(middle - math.pi, middle + math.pi)
    if not largest or rule is None:
        return None
    if rule is ANY:
        return _linear(-_FEW * largest, _FEW * largest)
    if rule.is_strict and rule.least == 0.0:
        high = min(_DECADE * largest, rule.most)
        return {"low": largest / _DECADE, "high": high, "log": True}
    return _linear(rule.least, min(rule.least + _FEW * largest, rule.most))


def _linear(low: float, high: float) -> dict[str, Any]:
    return {"low": low, "high": high, "log": False}


def recorded(machine: Machine) -> list[dict[str, Any]]:
    """Return what a run records: outputs, what the pictures are made of, what the solver does."""
    return [
        _control(v, reference)
        for reference, v in enumerate(machine.table)
        if v.is_observed
        and (
            v.causality == "output"
            or v.name.rpartition(".")[2] in _RECORDED
            or v.name in _OF_SOLVER
        )
    ]


def places(machine: Machine) -> list[dict[str, str | None]]:
    """Return the places that move, first those with a largest distance from the start in a turn:
    titles, names of x and y, of that distance and of the clearance, where they have them."""
    names = {v.name for v in machine.table}
    parts = list(dict.fromkeys(v.name.rpartition(".")[0] for v in machine.table if v.is_observed))
    found = [
        {
            "title": _title(part),
            "x": f"{part}.x",
            "y": f"{part}.y",
            "farthest": f"{part}.r_amp" if f"{part}.r_amp" in names else None,
            "clearance": f"{part}.clearance" if f"{part}.clearance" in names else None,
        }
        for part in parts
        if {f"{part}.x", f"{part}.y"} <= names
    ]
    return sorted(found, key=lambda place: place["farthest"] is None)


def machine_of_run(run: Recording) -> Machine:
    """Return the machine of a run. Raises `InputError` if the recording holds none."""
    if run.rotor is None:
        raise InputError(f"{run.name}: its recording holds no machine")
    parameters = run.about.get("parameters", {})
    return machine_of(str(run.about["toml"]), reduction=int(parameters.get(REDUCTION.name, 0)))


def settings_of_run(run: Recording, machine: Machine) -> dict[str, float]:
    """Return the values of controls, SI units, under which a page repeats a run: its parameters,
    its loads and the course of its speed.

    Raises `InputError` for a load that changes, and for a speed that is neither constant nor
    changes at one rate, and then stays.
    """
    starts = start_values(v for v in machine.table if v.causality == "parameter")
    parameters = {
        name: float(value)
        for name, value in run.about.get("parameters", {}).items()
        if name in starts and name not in NO_CONTROLS and value != starts[name]
    }
    units = run.parameter_units()
    for name, (low, high) in run.about.get("loads", {}).items():
        if low != high:
            raise InputError(
                f"{run.name}: {name} changes from {low:g} to {high:g} {units[name]}; a page holds "
                "its loads"
            )
        parameters[name] = low
    return parameters | _course(run)


def _course(run: Recording) -> dict[str, float]:
    t, w = run.t - run.t[0], run.w
    duration, first, last = float(t[-1]), float(w[0]), float(w[-1])
    near = _STRAIGHT * float(np.abs(w).max())
    at = int(np.argmax(np.abs(w - last) <= near))  # where the last speed is reached
    line = np.interp(t, [0.0, t[at]], [first, float(w[at])])
    if np.abs(w - line).max() > 2.0 * near:
        raise InputError(
            f"{run.name}: its speed does not change at one rate and then stay; a page has no other "
            "course"
        )
    if at == 0:
        return {"course.from": first, "course.to": first, "course.hold": duration}
    rate = abs(float(w[at]) - first) / float(t[at])
    course = {"course.from": first, "course.to": last, "course.rate": rate}
    held = duration - abs(last - first) / rate
    return course | ({"course.hold": held} if at < len(t) - 1 and held > 0.0 else {})
