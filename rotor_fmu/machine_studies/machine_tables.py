"""A machine's runs from the tables of a study's file: machine, parameters and metrics."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..fmi.binding import load_names
from ..fmi.variables import Variable
from ..operating_speeds import operating_speeds
from ..runs.input_signals import read_signals
from ..runs.job import load_rotor
from ..studies.design import Axis, number, whole
from ..studies.study import Column
from ..studies.study_tables import Tables, known_name, nearest, table_of
from . import response_metrics
from .coupled_runs import CoupledRuns
from .machine_runs import RUN, VERIFICATION, Machine, MachineRuns, machine_of
from .metrics import KINDS as METRIC_DEFAULTS
from .metrics import WAYS, Metric, check, column
from .response_runs import ResponseRuns
from .run_excitation import COUPLED, FREE, KINDS, RESPONSE, WHOLE, Excitation, Kick, check_numbers


def read_machine(tables: Tables, folder: Path) -> tuple[MachineRuns, dict[str, str]]:
    """Return the runs of a machine, without what is kept, and what can be varied: the unit by the
    name."""
    machine_file = tables.get("machine")
    if machine_file is not None and not isinstance(machine_file, str):
        raise InputError(f"machine = {machine_file!r}: must be the name of a file")
    toml, _ = load_rotor(_machine_path(machine_file, folder))
    run = dict(table_of(tables, "run"))
    kind = run.pop("kind", None)
    if kind not in KINDS:
        raise InputError(f"run kind = {kind!r}: must be one of {', '.join(KINDS)}")
    machine = machine_of(toml, kind in FREE)
    how = _drive(kind, run, machine, folder)
    values = {}
    known = _settable_names(machine)
    if kind == RESPONSE:
        of_rotor = {str(name) for name, _, _ in machine.rotor.parameters()}
        known = [name for name in known if name in of_rotor]
    for name, value in table_of(tables, "set").items():
        variable = _settable(machine, known_name("set", name, known))
        values[name] = _value(f"set {name}", variable, value)
    runs = _MAKE.get(kind, MachineRuns)(toml, values, how, ())
    units = {name: _settable(machine, name).unit or "1" for name in known}
    if isinstance(runs, ResponseRuns):
        units.pop(how.over, None)
        units |= {f"{RUN}{name}": runs.unit for name in ("from", "to")}
        return runs, {f"{RUN}{name}": KINDS[kind][name].unit for name in how.numbers} | units
    return runs, units | {f"{RUN}{name}": KINDS[kind][name].unit for name in how.numbers}


def _machine_path(name: str | None, folder: Path) -> Path | None:
    """Return the machine's file, beside the study or among the examples of the package; None for
    the rig."""
    if name in (None, "rig"):
        return None
    path = folder / str(name)
    packaged = Path(str(files("rotor_fmu.examples"))) / str(name)
    return packaged if packaged.is_file() and not path.is_file() else path


_MAKE = {COUPLED: CoupledRuns, RESPONSE: ResponseRuns}
# What the kind of run decides itself.
_DRIVEN = ("speed", "speed_rate", "speed_continuation", "w_start", "tau_drive")


def _settable_names(machine: Machine) -> list[str]:
    return [v.name for v in machine.table if v.causality == "parameter" and v.name not in _DRIVEN]


def _settable(machine: Machine, name: str) -> Variable:
    return next(v for v in machine.table if v.name == name)


def _value(where: str, variable: Variable, value: object) -> float:
    if variable.kind == "Boolean" and isinstance(value, bool):
        return float(value)
    if variable.choices and isinstance(value, str):
        if value not in variable.choices:
            raise InputError(f"{where} = {value}: must be one of {', '.join(variable.choices)}")
        return variable.choices.index(value)
    given = number(where, value, variable.unit or "1")
    low = -math.inf if variable.low is None else variable.low
    high = math.inf if variable.high is None else variable.high
    if not low <= given <= high:
        bound = f">= {low:g}" if high == math.inf else f"from {low:g} to {high:g}"
        raise InputError(f"{where} = {given:g}: must be {bound}")
    return given


def _drive(kind: str, run: dict[str, Any], machine: Machine, folder: Path) -> Excitation:
    kick, file, over = run.pop("kick", None), run.pop("file", None), run.pop("over", None)
    speeds = operating_speeds(machine.rotor)
    numbers = {
        name: getattr(speeds, of.default) if isinstance(of.default, str) else of.default
        for name, of in KINDS[kind].items()
    }
    along = _along(machine, over)
    for name, value in run.items():
        known_name(f"run {kind}:", name, numbers)
        numbers[name] = number(f"run.{name}", value, KINDS[kind][name].unit or along)
    for name, value in numbers.items():
        if value is None:
            raise InputError(f"run {kind}: needs {name} [{KINDS[kind][name].unit}]")
    given = {name: float(value) for name, value in numbers.items() if value is not None}
    check_numbers(kind, given)
    if over is not None:
        if kind != RESPONSE or not isinstance(over, str):
            raise InputError(f"run {kind}: over = {over!r}: the name of a quantity, of a response")
        known_name("run response: over", over, _quantities(machine))
    if kind == RESPONSE and (kick is not None or (over is None) != (given["speed"] == 0)):
        raise InputError("run response: speed is given with over, and only then; it has no kick")
    if (kind == "signals") != isinstance(file, str):
        raise InputError(f"run {kind}: file: only of signals, which need it")
    signals = read_signals(folder / file, machine.table) if isinstance(file, str) else None
    if signals is not None and "speed" not in signals.values:
        raise InputError(f"run signals: {file}: has no column speed")
    loads = load_names(machine.rotor)
    if signals is not None:
        zeros = 0.0 * signals.t
        named = {name: zeros for pair in loads for name in pair}
        signals = type(signals)(signals.t, named | dict(signals.values))
    return Excitation(kind, given, signals, _kick(kick, loads), loads, over or "")


def _quantities(machine: Machine) -> dict[str, str]:
    """Return what a response may go over, with its unit."""
    return {str(name): described.unit for name, described, _ in machine.rotor.parameters()}


def _along(machine: Machine, over: object) -> str:
    """Return the unit of what a run goes over: the speed, or, of a response, another quantity."""
    return _quantities(machine).get(str(over), "") if over else "rad/s"


def _kick(table: object, loads: Iterable[tuple[str, str]]) -> Kick | None:
    if table is None:
        return None
    names = ("port", "force", "rate", "duration")
    if not isinstance(table, dict) or set(table) != set(names):
        raise InputError(f"run kick: must be {{ {', '.join(names)} }}")
    ports = [x.removesuffix(".fx") for x, _ in loads if x.endswith(".fx")]
    port = known_name("run kick: port", str(table["port"]), ports)
    force, rate, duration = (
        number(f"run kick {name}", table[name], unit)
        for name, unit in zip(names[1:], ("N", "rad/s", "s"), strict=True)
    )
    if not duration > 0:
        raise InputError(f"run kick duration = {duration:g} s: must be > 0")
    return Kick(port, force, rate, duration)


def with_keeps(runs: MachineRuns, tables: Tables, axes: tuple[Axis, ...]) -> MachineRuns:
    """Return the runs with what the table [keep] says and its columns."""
    machine = machine_of(runs.toml, runs.is_free)
    units = runs.units
    varied = {target for axis in axes for target in axis.targets}
    metrics, columns = [], []
    table = table_of(tables, "keep")
    if not table:
        raise InputError("[keep] is empty; a study keeps something")
    for name, given in table.items():
        metric = _metric(name, given, units, machine, runs.how)
        moved = bool(varied & {f"{RUN}from", f"{RUN}to"})
        if varied & {f"{RUN}turns", f"{RUN}count", f"{RUN}back", f"{RUN}measure"}:
            raise InputError("vary: what decides the length of lists cannot be varied")
        metrics.append(metric)
        unit = units.get(metric.of, units.get(f"{metric.of.removesuffix('.r')}.x", "1"))
        if isinstance(runs, ResponseRuns):
            columns.append(response_metrics.column(metric, unit, runs.unit))
        else:
            columns.append(column(metric, unit, runs.how, moved))
    is_verified = tables.get("verify", False)
    if not isinstance(is_verified, bool):
        raise InputError(f"verify = {is_verified!r}: must be true or false")
    if is_verified:
        if runs.how.kind in (COUPLED, RESPONSE):
            raise InputError(f"verify: not of runs of the kind {runs.how.kind}")
        text = "largest difference of the metrics from the same run, solved more finely"
        columns.append(Column(VERIFICATION, "1", text))
    return replace(runs, metrics=tuple(metrics), columns=tuple(columns), is_verified=is_verified)


def _metric(
    name: str, given: object, units: Mapping[str, str], machine: Machine, how: Excitation
) -> Metric:
    where = f"keep {name}"
    if not isinstance(given, dict):
        raise InputError(f"{where} = {given!r}: must be a table such as {{ peak = OUTPUT }}")
    known = response_metrics.KINDS if how.kind == RESPONSE else METRIC_DEFAULTS
    kinds = [key for key in given if key in known and key != "passing"]
    if not kinds and given:
        known_name(where + ":", next(iter(given)), known)
    kind = kinds[0] if kinds else ""
    # `order = 1, of = OUTPUT`, and likewise of others whose own word is a number or a list
    if "of" in given:
        of = given["of"]
    elif kind:
        of = given[kind]
    else:
        raise InputError(f"{where}: must have one of {', '.join(known)}")
    identity = known[kind]
    options = {key: value for key, value in given.items() if key not in (kind, "of")}
    if kind == "order":  # the order itself, unless a speed is to be passed
        kind = "passing" if "speed" in given else kind
        identity = known[kind]
        options["order"] = given["order"]
    for key in options:
        known_name(where + ":", key, (*identity.needed, *identity.optional))
    for key in identity.needed:
        if key not in options:
            raise InputError(f"{where}: {kind} needs {key}")
    if not isinstance(of, str):
        raise InputError(f"{where}: of = {of!r}: must be the name of an output")
    along = _along(machine, how.over)
    checked = {key: _option(where, key, value, along) for key, value in options.items()}
    scale = _radius(machine, of) if kind == "dissipated" else 0.0
    metric = Metric(name, kind, of, tuple(checked.items()), scale)
    if how.kind == RESPONSE:
        response_metrics.check(metric, how)
        if kind != "bifurcation":
            known_name(f"{where}:", of, units)
        return metric
    check(metric, how)
    if kind == "lyapunov":
        # with SciPy, which other studies do without
        from ..model.periodic.problem import check_parts

        check_parts(machine.rotor)
    for need in metric.needs:
        if need not in units:
            parts = {n.rpartition(".")[0] for n in units if "." in n}
            choice = parts if need.startswith(f"{of}.") else {*units, *(f"{p}.r" for p in parts)}
            raise InputError(f"{where}: {of}: unknown name; {nearest(of, choice)}")
    return metric


def _option(where: str, key: str, value: object, along: str) -> Any:
    if key == "which":
        return value
    if key == "way":
        if value not in WAYS:
            raise InputError(f"{where}: way = {value!r}: must be one of {', '.join(WAYS)}")
        return value
    if key == "bins":
        if not isinstance(value, dict) or set(value) != {"from", "to", "count"}:
            raise InputError(f"{where}: bins must be {{ from, to, count }}")
        low, high = (number(f"{where}: bins {end}", value[end], along) for end in ("from", "to"))
        if not low < high:
            raise InputError(f"{where}: bins from = {low:g}: must be below to = {high:g}")
        return {"from": low, "to": high, "count": whole(f"{where}: bins count", value["count"])}
    return number(
        f"{where}: {key}", value, {"speed": along, "at": along, "after": "s"}.get(key, "")
    )


def _radius(machine: Machine, part: str) -> float:
    for where, candidate in machine.rotor.named_parts():
        if where == part and hasattr(candidate, "journal_radius"):
            return float(candidate.journal_radius)
    return 0.0


def check_values(runs: MachineRuns, axes: tuple[Axis, ...]) -> None:
    """Raise `InputError` for listed values that no run could have; those of distributions fail run
    by run."""
    machine = machine_of(runs.toml, runs.is_free)
    for axis in axes:
        for target in axis.targets:
            if target in runs.values:
                raise InputError(f"vary {axis.name}: {target} stands in [set] too")
            for value in axis.values:
                if target.startswith(RUN):
                    how = runs.how.changed({target.removeprefix(RUN): value})
                    is_suited = response_metrics.check if how.kind == RESPONSE else check
                    for metric in runs.metrics:
                        is_suited(metric, how)
                else:
                    _value(f"vary {axis.name}", _settable(machine, target), value)
            own = target.removeprefix(RUN)
            if axis.distribution is not None and target.startswith(RUN) and own in WHOLE:
                raise InputError(f"vary {axis.name}: is an integer; list its values")
