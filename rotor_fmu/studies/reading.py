"""STUDY.toml -> `Study`: every name and number is checked before anything is written or run."""

from __future__ import annotations

import difflib
import math
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from ..errors import InputError, read_text
from ..fmu.binding import load_names
from ..fmu.variables import Variable
from ..model.quantities import QuantityError
from ..runs.job import load_rotor
from ..runs.signals import read_signals
from .design import DESIGNS, GRID, Axis, Design, axis_of, number, whole
from .driving import FREE, KINDS, LEVELS, WHOLE, Drive, Kick, check_numbers
from .keeping import KINDS as KEPT
from .keeping import WAYS, Keep, column
from .machine_runs import RUN, Machine, MachineRuns, machine_of
from .study import Column, Model, Study

TABLES = ("name", "machine", "run", "set", "vary", "design", "keep", "limits", "quick")
Tables = Mapping[str, Any]
# Tables of a study and its folder -> the model, without columns, and the names that can be varied.
ReadModel = Callable[[Tables, Path], tuple[Model, Iterable[str]]]


def read_study(path: Path, read_model: ReadModel | None = None, *, is_quick: bool = False) -> Study:
    """Read a study's file; paths in it are relative to its folder. Raises `InputError` in one line.

    read_model: what is run, in the place of a machine; is_quick: with what stands in the table
    [quick] in the place of the same elsewhere.
    """
    text = read_text("study", path)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is not valid TOML: {error}") from error
    try:
        for key in tables:
            _known("", key, TABLES)
        quick = _table(tables, "quick")
        for key in quick:
            _known("quick", key, TABLES[:-1])
        if is_quick:
            if not quick:
                raise InputError("--quick: the study has no table [quick]")
            tables = _merged(tables, quick)
        model, names = (read_model or read_machine)(tables, path.parent)
        axes = tuple(_axes(_table(tables, "vary"), tuple(names)))
        design = _design(_table(tables, "design"), axes)
        if isinstance(model, MachineRuns):
            model = _with_keeps(model, tables, axes)
            _check_values(model, axes)
        _check_columns(model.columns, axes)
        limits = {}
        numbers = [c.name for c in model.columns if not c.dimension]
        for name, value in _table(tables, "limits").items():
            limits[_known("limits", name, numbers)] = number(f"limits {name}", value)
    except (InputError, QuantityError) as error:
        raise InputError(f"{path}: {error}") from error
    return Study(str(tables.get("name", path.stem)), model, design, limits, text)


def _merged(base: Tables, over: Tables) -> dict[str, Any]:
    """Tables with some of their entries replaced, tables in them likewise."""
    merged = dict(base)
    for key, value in over.items():
        before = merged.get(key)
        if isinstance(before, dict) and isinstance(value, dict):
            value = _merged(before, value)
        merged[key] = value
    return merged


def nearest(name: str, known: Iterable[str]) -> str:
    """What a misspelt name may have meant."""
    listed = sorted(set(known))
    near = difflib.get_close_matches(name, listed, 3, 0.5) or listed[:3]
    return f"did you mean {', '.join(near)}?" if near else "there is none"


def _known(where: str, name: str, known: Iterable[str]) -> str:
    known = tuple(known)
    if name not in known:
        raise InputError(f"{where} {name}: unknown name; {nearest(name, known)}".strip())
    return name


def _table(tables: Tables, key: str) -> dict[str, Any]:
    table = tables.get(key, {})
    if not isinstance(table, dict):
        raise InputError(f"{key} = {table!r}: must be a table")
    return table


def _axes(table: dict[str, Any], names: tuple[str, ...]) -> Iterable[Axis]:
    if not table:
        raise InputError("[vary] is empty; a study varies something")
    taken: dict[str, str] = {}
    for name, given in table.items():
        if not isinstance(given, dict):
            raise InputError(f"vary {name} = {given!r}: must be a table with values, grid or ...")
        targets = given.get("names", [name])
        patterns = targets if isinstance(targets, list) else [targets]
        found = [target for pattern in patterns for target in _matching(name, pattern, names)]
        for target in found:
            if target in taken:
                raise InputError(f"vary {name}: {target} is varied by {taken[target]} too")
            taken[target] = name
        yield axis_of(name, found, given)


def _matching(where: str, pattern: object, names: tuple[str, ...]) -> list[str]:
    """The names that a pattern stands for, whose [*] is any number."""
    if not isinstance(pattern, str):
        raise InputError(f"vary {where}: names = {pattern!r}: must be names")
    if "[*]" not in pattern:
        return [_known("vary", pattern, names)]
    expression = re.escape(pattern).replace(r"\[\*\]", r"\[\d+\]")
    found = [name for name in names if re.fullmatch(expression, name)]
    if not found:
        one = nearest(pattern.replace("[*]", "[1]"), names)
        raise InputError(f"vary {where}: {pattern}: no name is so; {one}")
    return found


def _design(table: dict[str, Any], axes: tuple[Axis, ...]) -> Design:
    for key in table:
        _known("design", key, ("kind", "size", "seed", "levels"))
    kind = table.get("kind", GRID)
    if kind not in DESIGNS:
        raise InputError(f"design kind = {kind!r}: must be one of {', '.join(DESIGNS)}")
    if kind != GRID and "size" not in table:
        raise InputError(f"design {kind}: needs size")
    size = whole("design size", table["size"]) if "size" in table else 0
    seed = whole("design seed", table.get("seed", 0), 0)
    levels = whole("design levels", table.get("levels", 4), 2)
    return Design(axes, kind, size, seed, levels=levels)


def read_machine(tables: Tables, folder: Path) -> tuple[MachineRuns, list[str]]:
    """The runs of a machine, without what is kept, and the names that can be varied."""
    machine_file = tables.get("machine")
    if machine_file is not None and not isinstance(machine_file, str):
        raise InputError(f"machine = {machine_file!r}: must be the name of a file")
    toml, _ = load_rotor(_machine_path(machine_file, folder))
    run = dict(_table(tables, "run"))
    kind = run.pop("kind", None)
    if kind not in KINDS:
        raise InputError(f"run kind = {kind!r}: must be one of {', '.join(KINDS)}")
    machine = machine_of(toml, kind in FREE)
    how = _drive(kind, run, machine, folder)
    values = {}
    for name, value in _table(tables, "set").items():
        variable = _settable(machine, _known("set", name, _settable_names(machine)))
        values[name] = _value(f"set {name}", variable, value)
    runs = MachineRuns(toml, values, how, ())
    own = [f"{RUN}{name}" for name in how.numbers]
    return runs, [*_settable_names(machine), *own]


def _machine_path(name: str | None, folder: Path) -> Path | None:
    """Beside the study, or among the examples that come with the package; None: the rig."""
    if name in (None, "rig"):
        return None
    path = folder / str(name)
    packaged = Path(str(files("rotor_fmu.examples"))) / str(name)
    return packaged if packaged.is_file() and not path.is_file() else path


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
    given = number(where, value)
    low = -math.inf if variable.low is None else variable.low
    high = math.inf if variable.high is None else variable.high
    if not low <= given <= high:
        bound = f">= {low:g}" if high == math.inf else f"from {low:g} to {high:g}"
        raise InputError(f"{where} = {given:g}: must be {bound}")
    return given


def _drive(kind: str, run: dict[str, Any], machine: Machine, folder: Path) -> Drive:
    kick, file = run.pop("kick", None), run.pop("file", None)
    numbers = {name: told.default for name, told in KINDS[kind].items()}
    for name, value in run.items():
        _known(f"run {kind}:", name, numbers)
        numbers[name] = number(f"run.{name}", value)
    for name, value in numbers.items():
        if value is None:
            raise InputError(f"run {kind}: needs {name} [{KINDS[kind][name].unit}]")
    given = {name: float(value) for name, value in numbers.items() if value is not None}
    check_numbers(kind, given)
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
    return Drive(kind, given, signals, _kick(kick, loads), loads)


def _kick(table: object, loads: Iterable[tuple[str, str]]) -> Kick | None:
    if table is None:
        return None
    names = ("port", "force", "rate", "duration")
    if not isinstance(table, dict) or set(table) != set(names):
        raise InputError(f"run kick: must be {{ {', '.join(names)} }}")
    ports = [x.removesuffix(".fx") for x, _ in loads if x.endswith(".fx")]
    port = _known("run kick: port", str(table["port"]), ports)
    force, rate, duration = (number(f"run kick {n}", table[n]) for n in names[1:])
    if not duration > 0:
        raise InputError(f"run kick duration = {duration:g} s: must be > 0")
    return Kick(port, force, rate, duration)


def _with_keeps(runs: MachineRuns, tables: Tables, axes: tuple[Axis, ...]) -> MachineRuns:
    machine = machine_of(runs.toml, runs.is_free)
    units = {v.name: v.unit for v in machine.table if v.is_observed}
    varied = {target for axis in axes for target in axis.targets}
    keeps, columns = [], []
    table = _table(tables, "keep")
    if not table:
        raise InputError("[keep] is empty; a study keeps something")
    for name, given in table.items():
        keep = _keep(name, given, units, machine, runs.how)
        moved = bool(varied & {f"{RUN}from", f"{RUN}to"})
        if varied & {f"{RUN}turns", f"{RUN}count", f"{RUN}back", f"{RUN}measure"}:
            raise InputError("vary: what decides the length of lists cannot be varied")
        keeps.append(keep)
        unit = units.get(keep.of, units.get(f"{keep.of.removesuffix('.r')}.x", "1"))
        columns.append(column(keep, unit, runs.how, moved))
    return MachineRuns(runs.toml, runs.values, runs.how, tuple(keeps), tuple(columns))


def _keep(name: str, given: object, units: Mapping[str, str], machine: Machine, how: Drive) -> Keep:
    where = f"keep {name}"
    if not isinstance(given, dict):
        raise InputError(f"{where} = {given!r}: must be a table such as {{ peak = OUTPUT }}")
    kinds = [key for key in given if key in KEPT and key != "passing"]
    if not kinds and given:
        _known(where + ":", next(iter(given)), KEPT)
    kind = kinds[0] if kinds else ""
    # `order = 1, of = OUTPUT`, and likewise of others whose own word is a number or a list
    if "of" in given:
        of = given["of"]
    elif kind:
        of = given[kind]
    else:
        raise InputError(f"{where}: must have one of {', '.join(KEPT)}")
    told = KEPT[kind]
    options = {key: value for key, value in given.items() if key not in (kind, "of")}
    if kind == "order":  # the order itself, unless a speed is to be passed
        kind = "passing" if "speed" in given else kind
        told = KEPT[kind]
        options["order"] = given["order"]
    for key in options:
        _known(where + ":", key, (*told.needed, *told.optional))
    for key in told.needed:
        if key not in options:
            raise InputError(f"{where}: {kind} needs {key}")
    if not isinstance(of, str):
        raise InputError(f"{where}: of = {of!r}: must be the name of an output")
    checked = {key: _option(where, key, value) for key, value in options.items()}
    held = LEVELS if kind == "order" else ("constant",)
    if told.in_turns and (how.kind not in held or how.numbers["measure"]):
        raise InputError(f"{where}: {kind} is kept of runs at a constant speed in whole turns")
    if kind == "jump" and how.kind != "steps":
        raise InputError(f"{where}: jump is kept of runs in steps")
    if kind in ("value", "amplitude", "passing") and how.kind in LEVELS:
        raise InputError(f"{where}: {kind} is kept of runs whose speed goes on")
    if kind == "order" and (checked["order"] * how.numbers["turns"]) % 1:
        raise InputError(f"{where}: order = {checked['order']:g}: must make whole periods in turns")
    if kind == "spectrum" and checked["orders"] > how.numbers["per_turn"] / 2:
        raise InputError(f"{where}: orders = {checked['orders']:g}: at most half of run.per_turn")
    scale = _radius(machine, of) if kind == "dissipated" else 0.0
    keep = Keep(name, kind, of, tuple(checked.items()), scale)
    for need in keep.needs:
        if need not in units:
            parts = {n.rpartition(".")[0] for n in units if "." in n}
            choice = parts if need.startswith(f"{of}.") else {*units, *(f"{p}.r" for p in parts)}
            raise InputError(f"{where}: {of}: unknown name; {nearest(of, choice)}")
    return keep


def _option(where: str, key: str, value: object) -> Any:
    if key == "way":
        if value not in WAYS:
            raise InputError(f"{where}: way = {value!r}: must be one of {', '.join(WAYS)}")
        return value
    if key == "bins":
        if not isinstance(value, dict) or set(value) != {"from", "to", "count"}:
            raise InputError(f"{where}: bins must be {{ from, to, count }}")
        low, high = (number(f"{where}: bins {end}", value[end]) for end in ("from", "to"))
        if not low < high:
            raise InputError(f"{where}: bins from = {low:g}: must be below to = {high:g}")
        return {"from": low, "to": high, "count": whole(f"{where}: bins count", value["count"])}
    return number(f"{where}: {key}", value)


def _radius(machine: Machine, part: str) -> float:
    for where, candidate in machine.rotor.named_parts():
        if where == part and hasattr(candidate, "journal_radius"):
            return float(candidate.journal_radius)
    return 0.0


def _check_values(runs: MachineRuns, axes: tuple[Axis, ...]) -> None:
    """Refuse listed values that no run could have; those of distributions fail run by run."""
    machine = machine_of(runs.toml, runs.is_free)
    for axis in axes:
        for target in axis.targets:
            if target in runs.values:
                raise InputError(f"vary {axis.name}: {target} stands in [set] too")
            for value in axis.values:
                if target.startswith(RUN):
                    runs.how.changed({target.removeprefix(RUN): value})
                else:
                    _value(f"vary {axis.name}", _settable(machine, target), value)
            own = target.removeprefix(RUN)
            if axis.distribution is not None and target.startswith(RUN) and own in WHOLE:
                raise InputError(f"vary {axis.name}: is an integer; list its values")


def _check_columns(columns: tuple[Column, ...], axes: tuple[Axis, ...]) -> None:
    taken = {"run", "id", "status", *(axis.name for axis in axes)}
    for kept in columns:
        if kept.name in taken:
            raise InputError(
                f"keep {kept.name}: is the name of something varied, or of the study's"
            )
