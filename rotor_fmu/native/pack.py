"""Building the native FMU: a library a platform, the machine as data, description and documents."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import indent, tostring

from ..fmu.description import guid
from ..fmu.interface import interface
from ..model.machine.toml import parse_rotor, rig_toml
from ..packing.bundle import write_archive
from ..packing.documents import documents
from .core import PLATFORMS, Platform, core_digest, library
from .describe import TIME, description
from .table import FILE, REDUCTION_NAME, Face, table_bytes
from .universal import universal

NAME, FREE_NAME = "RotorBearingNative", "RotorBearingFreeNative"
_PYTHON_ONLY = ("documentation/externalDependencies.txt", "documentation/licenses/pythonfmu.txt")
# The picture beside the description: where FMI 3.0 wants it, and FMI 2.0.
_ICON, _PICTURE = "terminalsAndIcons/icon.png", "model.png"


def build_native(
    out: Path,
    rotor_toml: str | None = None,
    is_free: bool = False,
    fmi: int = 2,
    platforms: Sequence[str] = tuple(PLATFORMS),
    reduction: int = 0,
) -> Path:
    """Build `RotorBearingNative.fmu`, or `RotorBearingFreeNative.fmu` where a torque is to drive
    the rotor, in the folder `out` and return its path.

    rotor_toml: TOML text of the rotor, by default the paper's rig; fmi: 2 or 3, the version of the
    standard; platforms: of `core.PLATFORMS`; reduction: component modes kept of the shaft, 0 for
    all of it. Raises `QuantityError` for an impossible rotor, `CoreError` where a library is
    missing and cannot be made, and `OSError` if `out` cannot be written.
    """
    toml = rig_toml() if rotor_toml is None else rotor_toml
    rotor = parse_rotor(toml)
    table = tuple(
        replace(variable, start=reduction) if variable.name == REDUCTION_NAME else variable
        for variable in interface(rotor, is_free)
    )
    name = FREE_NAME if is_free else NAME
    known = table if fmi == 2 else (*table, TIME)
    identifier = guid(table, f"native {fmi} {core_digest()} {toml}")
    root = description(name, identifier, table, fmi)
    indent(root)
    contents = {
        file: data
        for file, data in documents(rotor, table, name, needs_python=False).items()
        if file not in _PYTHON_ONLY
    }
    if fmi == 3:
        contents = _as_fmi3(contents)
    contents |= {
        "modelDescription.xml": b'<?xml version="1.0" encoding="UTF-8"?>\n'
        + tostring(root, encoding="utf-8"),
        f"resources/{FILE}": table_bytes(Face(rotor, known, is_free), core_digest(), identifier),
        "resources/rotor.toml": toml.encode(),
        **_binaries([PLATFORMS[platform] for platform in platforms], name, fmi),
    }
    out.mkdir(parents=True, exist_ok=True)
    return write_archive(out / f"{name}.fmu", contents)


def _as_fmi3(contents: dict[str, bytes]) -> dict[str, bytes]:
    """The documents with FMI 3.0's names and version."""
    changed = {file: data for file, data in contents.items() if not file.startswith("extra/")}
    changed[_ICON] = changed.pop(_PICTURE)
    terminals = "terminalsAndIcons/terminalsAndIcons.xml"
    changed[terminals] = changed[terminals].replace(b'fmiVersion="2.0"', b'fmiVersion="3.0"')
    return changed


def _binaries(platforms: Sequence[Platform], name: str, fmi: int) -> dict[str, bytes]:
    found = {platform: library(platform).read_bytes() for platform in platforms}
    intel, arm = PLATFORMS["darwin64"], PLATFORMS["aarch64-darwin"]
    if fmi == 2 and intel in found and arm in found:
        found[intel] = universal(found[intel], found[arm])
    return {
        f"binaries/{platform.fmi3 if fmi == 3 else platform.fmi2}/{name}{platform.suffix}": data
        for platform, data in found.items()
    }
