"""STUDY.toml -> `Study`: every name and number is checked before anything is written or run.

What runs is the business of the subject, whose reader is handed the tables: the one of the caller,
or that of the module that the file names.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, Protocol

from ..errors import InputError, known_name, meant, read_text, toml_tables
from ..model.arguments import check_integer, check_one_of
from ..units import number
from .design import DESIGNS, GRID, Axis, Design, axis_of
from .study import Column, Limit, Model, Study, Tables, table_of

_GENERAL = ("name", "module", "vary", "design", "limits", "quick")
_OF_THE_SUBJECT = ("machine", "run", "set", "keep", "verify")
TABLES = (*_GENERAL, *_OF_THE_SUBJECT)


class Subject(Protocol):
    """The subject of a study."""

    @property
    def units(self) -> Mapping[str, str]:
        """Units of all that can be varied, by name."""
        ...

    @property
    def display_units(self) -> str:
        """Units in which it asks to be shown, empty for the usual ones."""
        ...

    def why_not(self, name: str) -> str:
        """Return why what the subject has cannot be varied, empty of a name that it has not."""
        ...

    def value(self, name: str, where: str, given: object) -> float:
        """Return a value of what can be varied from what a list in the file has; `InputError`,
        which begins with `where`."""
        ...

    def model(self, axes: tuple[Axis, ...]) -> Model:
        """Return the model of its runs; axes: the varied parameters. Raises `InputError`."""
        ...


# Of the tables of a study and the folder of its file. A module that a file names has one of the
# name `read_subject`.
ReadSubject = Callable[[Tables, Path], Subject]


def read_study_file(path: Path, read_subject: ReadSubject, *, is_quick: bool = False) -> Study:
    """Read a study's file; paths in it are relative to its folder. Raises `InputError` in one line.

    read_subject: reads the subject, unless the file names a module that does; is_quick: whether the
    entries of the table [quick] replace the same ones elsewhere.
    """
    text = read_text("study", path)
    given = toml_tables(str(path), text)
    try:
        tables = _chosen(given, is_quick)
        if "module" in tables:
            read_subject = _reader_of(tables["module"])
        subject = read_subject(tables, path.parent)
        axes = tuple(_axes(table_of(tables, "vary"), subject))
        design = _design(table_of(tables, "design"), axes)
        model = subject.model(axes)
        _check_names(model.columns, axes)
        title = _name(tables.get("name", path.stem))
        limits = {}
        columns = {c.name: c for c in model.columns}
        for name, value in table_of(tables, "limits").items():
            unit = columns[known_name("limits", name, columns)].unit
            if columns[name].dimension:
                raise InputError(f"limits {name}: is a list in each run; a limit is of a number")
            limits[name] = _limit(f"limits {name}", value, unit)
    except InputError as error:
        raise InputError(f"{path}: {error}") from error
    return Study(title, model, design, limits, text, subject.display_units)


def _limit(where: str, given: object, unit: str) -> Limit:
    """Return a limit, of a number or of `{ least = NUMBER }`."""
    if isinstance(given, dict) and given.keys() != {"least"}:
        raise InputError(f"{where} = {given!r}: must be a number, or {{ least = NUMBER }}")
    value = given["least"] if isinstance(given, dict) else given
    return Limit(number(where, value, unit), isinstance(given, dict))


def _name(given: object) -> str:
    """Return the study's name, which figures and messages have in one line."""
    if not isinstance(given, str) or not given.isprintable() or not given.strip():
        raise InputError(f"name = {given!r}: must be text, not empty, without control characters")
    return given


def _chosen(tables: Tables, is_quick: bool) -> Tables:
    """Return the tables, whose names are known, those of [quick] merged into them if asked for."""
    for key in tables:
        known_name("", key, TABLES)
    quick = table_of(tables, "quick")
    for key in quick:
        known_name("quick", key, (t for t in TABLES if t != "quick"))
    if not is_quick:
        return tables
    if not quick:
        raise InputError("--quick: the study has no table [quick]")
    return _merged(tables, quick)


def _reader_of(module: object) -> ReadSubject:
    """Return the function `read_subject` of an installed module."""
    where = f"module = {module!r}"
    if not isinstance(module, str) or not all(part.isidentifier() for part in module.split(".")):
        raise InputError(f"{where}: must be the name of a Python module")
    try:
        return import_module(module).read_subject
    except ImportError as error:
        raise InputError(f"{where}: cannot be imported: {error}") from error
    except AttributeError:
        raise InputError(f"{where}: has no function read_subject") from None


def _merged(base: Tables, over: Tables) -> dict[str, Any]:
    """Return tables with some of their entries replaced, tables in them likewise."""
    merged = dict(base)
    for key, value in over.items():
        before = merged.get(key)
        if isinstance(before, dict) and isinstance(value, dict):
            value = _merged(before, value)
        merged[key] = value
    return merged


def _axes(table: dict[str, Any], subject: Subject) -> Iterable[Axis]:
    units = subject.units
    if not table:
        raise InputError("[vary] is empty: at least one parameter must be varied")
    taken: dict[str, str] = {}
    for name, given in table.items():
        if not isinstance(given, dict):
            raise InputError(f"vary {name} = {given!r}: must be a table with values, grid or ...")
        targets = given.get("names", [name])
        patterns = targets if isinstance(targets, list) else [targets]
        if not patterns:
            raise InputError(f"vary {name}: names = []: must be names")
        result = [target for pattern in patterns for target in _matching(name, pattern, subject)]
        for target in result:
            if target in taken:
                raise InputError(f"vary {name}: {target} is varied by {taken[target]} too")
            taken[target] = name
        of = {units[target]: target for target in result}
        if len(of) > 1:
            (unit, one), (another, other) = list(of.items())[:2]
            raise InputError(f"vary {name}: {one} is in {unit}, {other} in {another}")
        read = partial(subject.value, result[0])
        yield axis_of(name, result, given, next(iter(of), ""), read)


def _matching(where: str, pattern: object, subject: Subject) -> list[str]:
    """Return the names that match a pattern, in which [*] is any number."""
    if not isinstance(pattern, str):
        raise InputError(f"vary {where}: names = {pattern!r}: must be names")
    names = subject.units
    if "[*]" not in pattern:
        return [known_name("vary", pattern, names, why_not=subject.why_not)]
    expression = re.escape(pattern).replace(r"\[\*\]", r"\[\d+\]")
    result = [name for name in names if re.fullmatch(expression, name)]
    if not result:
        one = pattern.replace("[*]", "[1]")
        hint = subject.why_not(one) or meant(one, names)
        raise InputError(f"vary {where}: {pattern}: no variable matches this pattern; {hint}")
    return result


def _design(table: dict[str, Any], axes: tuple[Axis, ...]) -> Design:
    for key in table:
        known_name("design", key, ("kind", "size", "seed", "levels"))
    kind = table.get("kind", GRID)
    check_one_of(f"design kind = {kind!r}", kind, DESIGNS)
    if kind != GRID and "size" not in table:
        raise InputError(f"design {kind}: needs size")
    for key, least in (("size", 1), ("seed", 0), ("levels", 2)):
        if key in table:
            check_integer(f"design {key}", table[key], least)
    size, levels = table.get("size", 0), table.get("levels", 4)
    if kind == GRID and size:
        raise InputError(
            f"design size = {size}: a grid has none; kind must be one of {', '.join(DESIGNS[1:])}"
        )
    if levels % 2:
        raise InputError(f"design levels = {levels}: must be even")
    return Design(axes, kind, size, table.get("seed", 0), levels=levels)


def _check_names(columns: tuple[Column, ...], axes: tuple[Axis, ...]) -> None:
    """Raise `InputError` for a name that the rows or their dimensions have already."""
    taken = {"", "run", "id", "status", *(column.dimension for column in columns)}
    named = [("vary", axis.name) for axis in axes] + [("keep", c.name) for c in columns]
    for table, name in named:
        if name in taken:
            raise InputError(f"{table} {name}: is the name of something else in the rows, or empty")
        taken.add(name)
