"""Building the FMUs that need no Python, with the machine as data: of libraries, one a platform, or
of C source, for platforms that no library is made for."""

import struct
from collections.abc import Sequence
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from ...library.build import library
from ...library.c_source import source_files
from ...library.component import component
from ...library.platforms import COMPONENT, DRAFT, PLATFORMS, Platform
from ..description import Described
from .archive import write_archive, xml_bytes
from .documents import MANIFEST, manifest
from .machine_files import NATIVE, SOURCE, TABLE, Machine, machine_files

_COMPONENTS = "org.modelica.fmi-ls-wasm"  # the layered standard, a draft
_MAGIC = 0xCAFEBABE  # of a macOS library for several processors
# Processor, its kind, and the alignment of its part as a power of two.
_X86_64, _ARM64 = (0x01000007, 3, 14), (0x0100000C, 0, 14)


def build_native(
    out: Path, machine: Machine, fmi: int = 2, platforms: Sequence[str] = tuple(PLATFORMS)
) -> Path:
    """Build a machine's FMU in the folder `out` and return its path.

    fmi: 2 or 3, the version of the standard; platforms: of `library.platforms.PLATFORMS`, and of
    FMI 3.0 that of a WebAssembly component. Raises `LibraryError` where a library is missing and
    cannot be made, `InputError` where a tool that makes components is missing, and `OSError` if
    `out` cannot be written.
    """
    name = machine.identifier(NATIVE)
    contents = machine_files(machine, Described(machine.rotor, name), fmi)
    libraries = [PLATFORMS[platform] for platform in platforms if platform in PLATFORMS]
    contents |= _binaries(libraries, name, fmi)
    if COMPONENT.name in platforms:
        path = f"binaries/{COMPONENT.fmi3}/{name}{COMPONENT.suffix}"
        contents |= {path: component(contents[TABLE]), **_component_manifest()}
    return write_archive(out / f"{name}.fmu", contents)


def _binaries(platforms: Sequence[Platform], name: str, fmi: int) -> dict[str, bytes]:
    result = {platform: library(platform).read_bytes() for platform in platforms}
    intel, arm = PLATFORMS["darwin64"], PLATFORMS["aarch64-darwin"]
    if fmi == 2 and intel in result and arm in result:  # FMI 2.0 has one folder for both
        result[intel] = _universal(result[intel], result.pop(arm))
    return {
        f"binaries/{platform.fmi3 if fmi == 3 else platform.fmi2}/{name}{platform.suffix}": data
        for platform, data in result.items()
    }


def _universal(x86_64: bytes, arm64: bytes) -> bytes:
    """Return the file that holds both libraries (Mach-O's `fat_header`, big-endian)."""
    parts = ((_X86_64, x86_64), (_ARM64, arm64))
    head = struct.pack(">II", _MAGIC, len(parts))
    body = b""
    begin = 1 << _X86_64[2]
    for (processor, kind, alignment), data in parts:
        body += bytes(-len(body) % (1 << alignment))
        head += struct.pack(">5I", processor, kind, begin + len(body), len(data), alignment)
        body += data
    return head + bytes(begin - len(head)) + body


def _component_manifest() -> dict[str, bytes]:
    """Return what says that an FMU holds a WebAssembly component, as a draft of a layered standard
    of FMI 3.0 lays it out."""
    root = manifest(
        f"{{{MANIFEST}}}fmiLayeredStandardManifest",
        _COMPONENTS,
        f"0.1.0-draft.{DRAFT:%Y%m%d}",
        "FMI Layered Standard for WebAssembly",
    )
    return {f"extra/{_COMPONENTS}/manifest.xml": xml_bytes(root)}


def build_source(out: Path, machine: Machine, fmi: int = 2) -> Path:
    """Build the FMU of C source, which its host compiles, and return its path; arguments and errors
    are those of `build_native`, `InputError` where a tool that makes C of the kernels is missing.
    """
    name = machine.identifier(SOURCE)
    sources = source_files(fmi)
    compiled = tuple(sorted(file for file in sources if file.endswith(".c")))
    contents = machine_files(machine, Described(machine.rotor, name, sources=compiled), fmi)
    contents |= {f"sources/{file}": data for file, data in sources.items()}
    if fmi == 3:
        contents["sources/buildDescription.xml"] = xml_bytes(_build_description(name, compiled))
    return write_archive(out / f"{name}.fmu", contents)


def _build_description(name: str, compiled: tuple[str, ...]) -> Element:
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = SubElement(root, "BuildConfiguration", modelIdentifier=name)
    files = SubElement(configuration, "SourceFileSet", language="C17")
    for file in compiled:
        SubElement(files, "SourceFile", name=file)
    return root
