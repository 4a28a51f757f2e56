"""Building the FMU of C source, for platforms that no library is made for."""

from collections.abc import Mapping
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from ...library.c_source import source_files
from ..description import Described
from ..solver_parameters import NO_STARTS
from .archive import write_archive, xml_bytes
from .machine_files import SOURCE, machine_files, machine_of


def build_source(
    out: Path,
    rotor_toml: str | None = None,
    is_free: bool = False,
    fmi: int = 2,
    reduction: int = 0,
    step: float | None = None,
    starts: Mapping[str, float] = NO_STARTS,
) -> Path:
    """Build the FMU of a machine, driven by its speed or, where is_free, by a torque, in the folder
    `out` and return its path, which `machine_files.fmu_identifier` names. A host compiles it.

    rotor_toml: TOML text of the rotor, by default the paper's rig; fmi: 2 or 3, the version of the
    standard; reduction: component modes kept of the shaft, 0 for all of it; step: fixed step length
    of an FMU for real time [s]; starts: start values of solver parameters by name. Raises
    `QuantityError` for an impossible rotor, `SettingsError` for an impossible step or start value,
    `InputError` where a tool that makes C of the kernels is missing, `LibraryError` where it fails,
    and `OSError` if `out` cannot be written.
    """
    machine = machine_of(rotor_toml, is_free, reduction, step, starts)
    name = machine.identifier(SOURCE)
    sources = source_files(fmi)
    compiled = tuple(sorted(file for file in sources if file.endswith(".c")))
    contents = machine_files(machine, Described(machine.rotor, name, sources=compiled), fmi)
    contents |= {f"sources/{file}": data for file, data in sources.items()}
    if fmi == 3:
        contents["sources/buildDescription.xml"] = xml_bytes(_build_description(name, compiled))
    out.mkdir(parents=True, exist_ok=True)
    return write_archive(out / f"{name}.fmu", contents)


def _build_description(name: str, compiled: tuple[str, ...]) -> Element:
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=name)
    files = SubElement(configuration, "SourceFileSet", language="C17")
    for file in compiled:
        SubElement(files, "SourceFile", name=file)
    return root
