"""Building the FMU that needs no Python: a library a platform, and the machine as data."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ...library.build import library
from ...library.macos_universal import universal
from ...library.platforms import COMPONENT, PLATFORMS, Platform
from ..description import Described
from ..solver_parameters import NO_STARTS
from .archive import write_archive
from .component_files import component_files
from .machine_files import NATIVE, TABLE, machine_files, machine_of


def build_native(
    out: Path,
    rotor_toml: str | None = None,
    is_free: bool = False,
    fmi: int = 2,
    platforms: Sequence[str] = tuple(PLATFORMS),
    reduction: int = 0,
    step: float | None = None,
    starts: Mapping[str, float] = NO_STARTS,
) -> Path:
    """Build the FMU of a machine, driven by its speed or, where is_free, by a torque, in the folder
    `out` and return its path, which `machine_files.fmu_identifier` names.

    rotor_toml: TOML text of the rotor, by default the paper's rig; fmi: 2 or 3, the version of the
    standard; platforms: of `library.platforms.PLATFORMS`, and of FMI 3.0 that of a WebAssembly
    component; reduction: component modes kept of the shaft, 0 for all of it; step: fixed step
    length of an FMU for real time [s]; starts: start values of solver parameters by name. Raises
    `QuantityError` for an impossible rotor, `SettingsError` for an impossible step or start value,
    `LibraryError` where a library is missing and cannot be made, `InputError` where a tool that
    makes components is missing, and `OSError` if `out` cannot be written.
    """
    machine = machine_of(rotor_toml, is_free, reduction, step, starts)
    name = machine.identifier(NATIVE)
    contents = machine_files(machine, Described(machine.rotor, name), fmi)
    libraries = [PLATFORMS[platform] for platform in platforms if platform in PLATFORMS]
    contents |= _binaries(libraries, name, fmi)
    if COMPONENT.name in platforms:
        contents |= component_files(name, contents[TABLE])
    out.mkdir(parents=True, exist_ok=True)
    return write_archive(out / f"{name}.fmu", contents)


def _binaries(platforms: Sequence[Platform], name: str, fmi: int) -> dict[str, bytes]:
    result = {platform: library(platform).read_bytes() for platform in platforms}
    intel, arm = PLATFORMS["darwin64"], PLATFORMS["aarch64-darwin"]
    if fmi == 2 and intel in result and arm in result:
        result[intel] = universal(result[intel], result[arm])
    return {
        f"binaries/{platform.fmi3 if fmi == 3 else platform.fmi2}/{name}{platform.suffix}": data
        for platform, data in result.items()
    }
