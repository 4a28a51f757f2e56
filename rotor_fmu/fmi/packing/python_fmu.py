"""Building the FMU that pythonfmu wraps: a thin layer of Python over its library."""

import hashlib
import zipfile
from collections.abc import Sequence
from pathlib import Path

from ...files import scratch_folder
from ...library.build import LibraryError, library, sources_digest
from ...library.platforms import PLATFORMS
from ...model.kernels.library import find, here
from ..description import Described
from .archive import contents_of, wrap, write_archive
from .machine_files import Machine, machine_files

SYSTEMS = ("linux64", "win64")  # of pythonfmu's wrapper
_SKIN = Path(__file__).parents[1] / "python"
_CLASS = "RotorBearing"  # which pythonfmu names the wrapper's files after
# What pythonfmu puts into an FMU of its own accord.
_PYTHONFMUS = ("binaries/", "resources/pythonfmu/", "resources/slavemodule.txt")
_WRAPPED: dict[str, dict[str, bytes]] = {}  # by package


def build(out: Path, machine: Machine, platforms: Sequence[str] | None = None) -> Path:
    """Build the FMU that runs in its host's Python, and return its path; arguments and errors are
    those of `native_fmu.build_native`. Equal sources give equal bytes.

    platforms: of `SYSTEMS`, by default those whose library is there, or this machine's.
    """
    libraries = _libraries(platforms)
    contents = _contents(machine, libraries)
    name = machine.identifier()
    wrapped = {
        path.replace(f"/{_CLASS}.", f"/{name}.") if path.startswith("binaries/") else path: data
        for path, data in _wrapped(*_package(libraries)).items()
    }
    return write_archive(out / f"{name}.fmu", wrapped | contents)


def _wrapped(package: str, sources: dict[str, bytes]) -> dict[str, bytes]:
    """Return what pythonfmu makes of an FMU's package, by the path in the FMU: the same for every
    machine, since the package's name follows its content."""
    if package not in _WRAPPED:
        with scratch_folder() as folder:
            (folder / package).mkdir()
            for path, data in sources.items():
                (folder / path).write_bytes(data)
            raw = folder / "raw.fmu"
            wrap(folder / f"{package}_entry.py", [folder / package], raw)
            _WRAPPED[package] = contents_of(raw)
    return _WRAPPED[package]


def is_current(fmu: Path, machine: Machine) -> bool:
    """Return whether `fmu` is what `build` would make now.

    Compares all files of this project; those of pythonfmu are compared by its version only. Raises
    `LibraryError` as `build` does.
    """
    if not fmu.is_file() or not zipfile.is_zipfile(fmu):
        return False
    with zipfile.ZipFile(fmu) as archive:
        names = {name for name in archive.namelist() if not name.startswith(_PYTHONFMUS)}
        if not _has_pythonfmu(archive):
            return False
        expected = _contents(machine, _libraries(None))
        return names == {*expected} and all(
            archive.read(name) == data for name, data in expected.items()
        )


def fmu_in(out: Path, machine: Machine) -> Path:
    """Return the machine's FMU in the folder `out`, built if it is not there or not up to date."""
    fmu = out / f"{machine.identifier()}.fmu"
    return fmu if is_current(fmu, machine) else build(out, machine)


def package_name() -> str:
    """Return the name of the package that `build` puts into the FMU; it follows the code."""
    return _package(_libraries(None))[0]


def _libraries(platforms: Sequence[str] | None) -> dict[str, bytes]:
    """Return the libraries of platforms, by the file's name in the FMU's package."""
    if platforms is None:
        platforms = [name for name in SYSTEMS if find(name, sources_digest())]
    if not platforms:
        mine = here()
        if mine not in SYSTEMS:
            raise LibraryError(
                f"there is no library of the solver for {' or '.join(SYSTEMS)}, on which the FMU "
                f"runs: rotor-fmu library --platform {SYSTEMS[0]} makes one"
            )
        platforms = [mine]
    return {
        f"{name}{PLATFORMS[name].suffix}": library(PLATFORMS[name]).read_bytes()
        for name in platforms
    }


def _package(libraries: dict[str, bytes]) -> tuple[str, dict[str, bytes]]:
    """Return the name of the FMU's package, which follows its content, and the files by their path
    among the resources, the script beside it included."""
    sources = {name: (_SKIN / name).read_bytes() for name in ("entry.py", "slave.py", "wrapper.py")}
    digest = hashlib.sha256()
    for name, data in sorted((sources | libraries).items()):
        digest.update(f"{name}\0{len(data)}\0".encode() + data)
    package = f"rotorbearing_{digest.hexdigest()[:12]}"
    entry = sources.pop("entry.py")
    sums = {name: hashlib.sha256(data).hexdigest() for name, data in sorted(libraries.items())}
    inside = {"__init__.py": f"CHECKSUMS = {sums}\n".encode(), **sources, **libraries}
    files = {f"{package}/{name}": data for name, data in inside.items()}
    return package, files | {f"{package}_entry.py": entry}


def _contents(machine: Machine, libraries: dict[str, bytes]) -> dict[str, bytes]:
    """Return all of the FMU that is not pythonfmu's, by the path in it."""
    from importlib.metadata import version  # which no run needs

    tool = f"PythonFMU {version('pythonfmu')}"
    described = Described(machine.rotor, machine.identifier(), tool=tool, needs_python=True)
    _, sources = _package(libraries)
    return machine_files(machine, described, 2) | {
        f"resources/{path}": data for path, data in sources.items()
    }


def _has_pythonfmu(archive: zipfile.ZipFile) -> bool:
    folders = {name.rpartition("/")[0] for name in archive.namelist()}
    return folders >= {"resources/pythonfmu", *(f"binaries/{platform}" for platform in SYSTEMS)}
