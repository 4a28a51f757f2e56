"""STUDY.toml -> `Study`: every name and number is checked before anything is written or run."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

from ..errors import InputError, read_text
from ..model.quantities import QuantityError
from ..studies.design import DESIGNS, GRID, Axis, Design, axis_of, number, whole
from ..studies.study import Column, Model, Study
from ..studies.study_tables import Tables, known_name, nearest, table_of
from .machine_runs import MachineRuns, machine_of
from .machine_tables import check_values, read_machine, with_keeps

TABLES = ("name", "machine", "run", "set", "vary", "design", "keep", "limits", "quick", "verify")
# Tables of a study and its folder -> the model, without columns, and the unit of all that can be
# varied, by its name.
ReadModel = Callable[[Tables, Path], tuple[Model, Mapping[str, str]]]


def read_study(path: Path, read_model: ReadModel | None = None, *, is_quick: bool = False) -> Study:
    """Read a study's file; paths in it are relative to its folder. Raises `InputError` in one line.

    read_model: reads another subject than a machine; is_quick: whether the entries of the table
    [quick] replace the same ones elsewhere.
    """
    text = read_text("study", path)
    try:
        tables = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{path}: is not valid TOML: {error}") from error
    try:
        for key in tables:
            known_name("", key, TABLES)
        quick = table_of(tables, "quick")
        for key in quick:
            known_name("quick", key, (t for t in TABLES if t != "quick"))
        if is_quick:
            if not quick:
                raise InputError("--quick: the study has no table [quick]")
            tables = _merged(tables, quick)
        model, units = (read_model or read_machine)(tables, path.parent)
        axes = tuple(_axes(table_of(tables, "vary"), units))
        design = _design(table_of(tables, "design"), axes)
        if isinstance(model, MachineRuns):
            model = with_keeps(model, tables, axes)
            check_values(model, axes)
        _check_columns(model.columns, axes)
        limits = {}
        numbers = {c.name: c.unit for c in model.columns if not c.dimension}
        for name, value in table_of(tables, "limits").items():
            unit = numbers[known_name("limits", name, numbers)]
            limits[name] = number(f"limits {name}", value, unit)
    except (InputError, QuantityError) as error:
        raise InputError(f"{path}: {error}") from error
    shown = machine_of(model.toml, False).rotor.units if isinstance(model, MachineRuns) else ""
    return Study(str(tables.get("name", path.stem)), model, design, limits, text, shown)


def _merged(base: Tables, over: Tables) -> dict[str, Any]:
    """Return tables with some of their entries replaced, tables in them likewise."""
    merged = dict(base)
    for key, value in over.items():
        before = merged.get(key)
        if isinstance(before, dict) and isinstance(value, dict):
            value = _merged(before, value)
        merged[key] = value
    return merged


def _axes(table: dict[str, Any], units: Mapping[str, str]) -> Iterable[Axis]:
    if not table:
        raise InputError("[vary] is empty; a study varies something")
    taken: dict[str, str] = {}
    for name, given in table.items():
        if not isinstance(given, dict):
            raise InputError(f"vary {name} = {given!r}: must be a table with values, grid or ...")
        targets = given.get("names", [name])
        patterns = targets if isinstance(targets, list) else [targets]
        result = [target for pattern in patterns for target in _matching(name, pattern, units)]
        for target in result:
            if target in taken:
                raise InputError(f"vary {name}: {target} is varied by {taken[target]} too")
            taken[target] = name
        of = {units[target]: target for target in result}
        if len(of) > 1:
            (unit, one), (another, other) = list(of.items())[:2]
            raise InputError(f"vary {name}: {one} is in {unit}, {other} in {another}")
        yield axis_of(name, result, given, next(iter(of), ""))


def _matching(where: str, pattern: object, names: Iterable[str]) -> list[str]:
    """Return the names that a pattern stands for, whose [*] is any number."""
    if not isinstance(pattern, str):
        raise InputError(f"vary {where}: names = {pattern!r}: must be names")
    if "[*]" not in pattern:
        return [known_name("vary", pattern, names)]
    expression = re.escape(pattern).replace(r"\[\*\]", r"\[\d+\]")
    result = [name for name in names if re.fullmatch(expression, name)]
    if not result:
        one = nearest(pattern.replace("[*]", "[1]"), names)
        raise InputError(f"vary {where}: {pattern}: no name is so; {one}")
    return result


def _design(table: dict[str, Any], axes: tuple[Axis, ...]) -> Design:
    for key in table:
        known_name("design", key, ("kind", "size", "seed", "levels"))
    kind = table.get("kind", GRID)
    if kind not in DESIGNS:
        raise InputError(f"design kind = {kind!r}: must be one of {', '.join(DESIGNS)}")
    if kind != GRID and "size" not in table:
        raise InputError(f"design {kind}: needs size")
    size = whole("design size", table["size"]) if "size" in table else 0
    seed = whole("design seed", table.get("seed", 0), 0)
    levels = whole("design levels", table.get("levels", 4), 2)
    return Design(axes, kind, size, seed, levels=levels)


def _check_columns(columns: tuple[Column, ...], axes: tuple[Axis, ...]) -> None:
    taken = {"run", "id", "status", *(axis.name for axis in axes)}
    for retained in columns:
        if retained.name in taken:
            raise InputError(
                f"keep {retained.name}: is the name of something varied, or of the study's"
            )
