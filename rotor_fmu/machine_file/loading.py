"""Machine files as a user has them: our own TOML, one that extends another, or a rotor from ROSS.

`extends = "base.toml"` at the head of a file takes what stands in another, also one from ROSS: its
tables are added to, its numbers and words replaced, its lists of parts continued; an empty list
empties one.
"""

import json
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..display import display_of
from ..errors import InputError, read_text
from ..model.laws_at_rest.oil import machine_with_oil
from ..model.machine.ross import Imported, is_ross, parse_ross
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor, rig_toml
from ..model.machine.toml_text import toml_text
from ..model.quantities import QuantityError
from .plausibility import implausible_values
from .units_in_files import in_si_units

_EXTENDS = "extends"
_OF_STUDIES = {"vary", "design", "keep"}  # tables of a study's file, and of no machine's
_MOST = 8  # files that extend one another


def machine_text(option: str, path: Path, note: Callable[[str], None] = lambda _: None) -> str:
    """Return the whole machine as TOML text; note: takes the notes on an import from ROSS.
    `InputError` for a file that cannot be read or merged."""
    text = read_text(option, path)
    data = _content(path, text)
    if data is not None and _OF_STUDIES & data.keys():
        raise InputError(f"{option} {path}: is a study, not a machine: rotor-fmu study runs it")
    if data is not None and (_EXTENDS in data or is_ross(data)):
        return toml_text(_tables(path, data, 0, note))
    if _is_json(path, text):
        import_ross(option, path)  # which says why it is none
    if data is None:
        return text
    return si_text(text, f"{path}: ")


def si_text(text: str, where: str = "") -> str:
    """Return a machine's TOML with all numbers in SI units, unchanged where none has a unit; where:
    what messages begin with. Raises `InputError` for a unit that does not fit its quantity."""
    try:
        data = tomllib.loads(text)
    except (ValueError, RecursionError):
        return text  # whose reader reports why
    converted = in_si_units(data, where)
    return text if converted == data else toml_text(converted)


def import_ross(option: str, path: Path) -> Imported:
    """Return a rotor from ROSS, checked to be a machine; `InputError` otherwise."""
    text = read_text(option, path)
    elements: dict[str, str] = {}
    try:
        result = parse_ross(text, path.stem, is_json=_is_json(path, text))
        elements = result.elements
        parse_rotor(toml_text(result.tables))
    except QuantityError as error:
        said = str(error)
        named = [key for key in elements if said.startswith((f"{key}.", f"{key}:", f"{key} "))]
        of = f"{elements[max(named, key=len)]}: " if named else ""
        raise InputError(f"{path}: {of}{said}") from error
    return result


def _is_json(path: Path, text: str) -> bool:
    return path.suffix.lower() == ".json" or text.lstrip().startswith("{")


def _content(path: Path, text: str) -> dict[str, Any] | None:
    """Return a file's contents, None if it is neither TOML nor JSON: its reader reports why."""
    try:
        data = json.loads(text) if _is_json(path, text) else tomllib.loads(text)
    except (ValueError, RecursionError):
        return None
    return data if isinstance(data, dict) else None


def _tables(
    path: Path, data: dict[str, Any], above: int, note: Callable[[str], None]
) -> dict[str, Any]:
    """Return the tables of a file with those of what it extends; above: files that extend it."""
    if is_ross(data):
        result = import_ross("--rotor", path)
        for line in result.notes:
            note(line)
        return result.tables
    data = in_si_units(data, f"{path}: ")
    base = data.get(_EXTENDS)
    if base is None:
        return data
    if not isinstance(base, str) or "\0" in base:
        raise InputError(f"{path}: {_EXTENDS} = {base!r}: must be the name of a file")
    if above >= _MOST:
        raise InputError(
            f"{path}: {_EXTENDS} = {base!r}: goes round, or more than {_MOST} files extend another"
        )
    other = path.parent / base
    text = read_text(f"{path}: {_EXTENDS}", other)
    inner = _content(other, text)
    if inner is None:
        kind = "JSON" if _is_json(other, text) else "TOML"
        raise InputError(f"{path}: {_EXTENDS} = {base!r}: is not valid {kind}")
    own = {key: value for key, value in data.items() if key != _EXTENDS}
    return _merged(_tables(other, inner, above + 1, note), own)


def _merged(base: dict[str, Any], own: dict[str, Any]) -> dict[str, Any]:
    merged = dict(base)
    for key, value in own.items():
        before = merged.get(key)
        if isinstance(before, dict) and isinstance(value, dict):
            merged[key] = _merged(before, value)
        elif isinstance(before, list) and isinstance(value, list) and value:
            is_parts = all(isinstance(item, dict) for item in value)
            merged[key] = [*before, *value] if is_parts else value
        else:
            merged[key] = value
    return merged


def to_screen(warning: str) -> None:
    """Print a warning in a line of standard error."""
    print(f"rotor-fmu: warning: {warning}", file=sys.stderr, flush=True)


def load_rotor(
    path: Path | None, warn: Callable[[str], None] = to_screen, option: str = "--rotor"
) -> tuple[str, Rotor]:
    """Return TOML text and rotor of a file, or of the paper's rig; `InputError` for an impossible
    one; warn: is given the notes on an import from ROSS, and warnings of implausible values;
    option: that names the file."""
    warnings: list[str] = []
    text = rig_toml() if path is None else machine_text(option, path, warnings.append)
    try:
        rotor = parse_rotor(text)
        display_of("units =", rotor.units)
        machine_with_oil(rotor)  # a heat balance is refused here, where the file is known
        warnings += implausible_values(rotor)
    except (QuantityError, InputError) as error:
        raise InputError(f"{path}: {error}" if path else str(error)) from error
    for warning in warnings:
        warn(f"{path}: {warning}" if path else warning)
    return text, rotor


def warn_of_changes(
    option: str, rotor: Rotor, *changed: Rotor, warn: Callable[[str], None] = to_screen
) -> None:
    """Warn once of each implausible value that an option gave a machine; changed: the machines that
    it makes of it."""
    before = implausible_values(rotor)
    found = (sentence for other in changed for sentence in implausible_values(other))
    for sentence in dict.fromkeys(found):
        if sentence not in before:
            warn(f"{option} {sentence}")
