"""What goes into the FMU, and building it."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from xml.etree.ElementTree import Element, fromstring, indent, tostring

from .. import model
from ..files import unfinished
from ..fmu.interface import interface
from ..fmu.slave import DRIVE_FILE, ROTOR_FILE
from ..model.kernels.library import CARRIED, find
from ..model.machine.toml import parse_rotor, rig_toml
from .documents import documents

FMU_NAME, FREE_FMU_NAME = "RotorBearing.fmu", "RotorBearingFree.fmu"
REQUIREMENTS = ("numpy>=1.26", "scipy>=1.11")
COMPILER = "numba>=0.60"  # where a library of kernels is missing
PLATFORMS = ("linux64", "win64")  # of pythonfmu's wrapper
_HERE = Path(__file__).parent
_PROJECT = _HERE.parent
# Of `model`, what no rotor needs: paper B's experiments, the analysis of the false state, linear
# answers.
_NOT_IN_FMU = ("linear",)
# What pythonfmu puts into an FMU of its own accord.
_PYTHONFMUS = (
    "modelDescription.xml",
    "binaries/",
    "resources/pythonfmu/",
    "resources/slavemodule.txt",
)
_STATES = ("--handle-state", "--serialize-state")  # pythonfmu leaves them off
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)


def build(out: Path, rotor_toml: str | None = None, is_free: bool = False) -> Path:
    """Build `RotorBearing.fmu`, or `RotorBearingFree.fmu` where a torque is to drive the rotor, in
    the folder `out` and return its path.

    rotor_toml: TOML text of the rotor, by default the paper's rig. Raises `QuantityError` for an
    impossible rotor and `OSError` if `out` cannot be written. Equal sources give equal bytes.
    """
    toml = rig_toml() if rotor_toml is None else rotor_toml
    contents = _documents(toml, is_free)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="rotor_fmu_") as name:
        folder = Path(name)
        for path, data in _resources(toml, is_free).items():
            file = folder / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(data)
        script = folder / _script(is_free)
        raw = folder / "raw.fmu"
        wrap(script, [file for file in folder.iterdir() if file != script], raw)
        return repack(raw, out / _file_name(is_free), contents)


def _file_name(is_free: bool) -> str:
    return FREE_FMU_NAME if is_free else FMU_NAME


def _script(is_free: bool) -> str:
    return f"{package_name()}_free_entry.py" if is_free else f"{package_name()}_entry.py"


def _resources(toml: str, is_free: bool) -> dict[str, bytes]:
    """The FMU's resources by their path among them, but for what pythonfmu brings."""
    package, sources = _contents()
    texts = {
        **{f"{package}/{path}": text for path, text in sources.items()},
        _script(is_free): (_HERE / "entry.py").read_text(encoding="utf-8"),
        ROTOR_FILE: toml,
        DRIVE_FILE: "torque" if is_free else "speed",
    }
    libraries = _libraries()
    needed = REQUIREMENTS if len(libraries) == len(PLATFORMS) else (*REQUIREMENTS, COMPILER)
    texts["requirements.txt"] = "\n".join(needed) + "\n"
    return {
        **{path: text.encode() for path, text in texts.items()},
        **{f"{package}/{path}": content for path, content in libraries.items()},
    }


def _libraries() -> dict[str, bytes]:
    """The libraries of kernels that there are for the platforms of pythonfmu's wrapper, by their
    path in the package."""
    found = [file for file in map(find, PLATFORMS) if file]
    return {f"model/{CARRIED.name}/{file.name}": file.read_bytes() for file in found}


def _documents(toml: str, is_free: bool) -> dict[str, bytes]:
    """What stands beside the model, by its path in the FMU."""
    rotor = parse_rotor(toml)
    return documents(rotor, interface(rotor, is_free), Path(_file_name(is_free)).stem)


def wrap(script: Path, beside: Sequence[Path], raw: Path) -> None:
    """Let pythonfmu make the FMU `raw` of a script and of what lies beside it in the resources.

    In a process of its own: an FMU that has run in this one has left its copy of pythonfmu here,
    which makes FMUs without libraries. Raises `OSError` with what pythonfmu says if it fails.
    """
    command: list[str | Path] = [sys.executable, "-m", "pythonfmu", "build", *_STATES]
    done = subprocess.run(
        [*command, "-f", script, "-d", raw, *beside],
        cwd=script.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        reason = (done.stderr.splitlines() or [f"exit status {done.returncode}"])[-1]
        raise OSError(f"pythonfmu cannot make an FMU of {script.name}: {reason}")


def _sources() -> dict[str, str]:
    """The package's modules by their path in it: two folders of the project as they are, `model`
    without what no rotor needs."""
    files = {"about.py": _PROJECT / "about.py"}
    for folder, root in (("model", Path(model.__file__).parent), ("fmu", _PROJECT / "fmu")):
        for file in root.rglob("*.py"):
            inside = file.relative_to(root)
            if folder != "model" or inside.parts[0] not in _NOT_IN_FMU:
                files[f"{folder}/{inside.as_posix()}"] = file
    return {path: file.read_text(encoding="utf-8") for path, file in sorted(files.items())}


def _contents() -> tuple[str, dict[str, str]]:
    """Name of the FMU's package, which follows its content, and the content by path."""
    contents = _sources() | {"__init__.py": ""}
    digest = hashlib.sha256()
    for path, text in sorted(contents.items()):
        digest.update(f"{path}\0{text}\0".encode())
    return f"rotorbearing_{digest.hexdigest()[:12]}", contents


def package_name() -> str:
    """Name of the package that `build` would put into the FMU now; it follows the code."""
    return _contents()[0]


def is_current(fmu: Path, rotor_toml: str | None = None, is_free: bool = False) -> bool:
    """Whether `fmu` is what `build` would make now.

    Compares all that this project puts into it; what pythonfmu makes of that by its version alone.
    Raises `QuantityError` for an impossible rotor.
    """
    if not fmu.is_file() or not zipfile.is_zipfile(fmu):
        return False
    toml = rig_toml() if rotor_toml is None else rotor_toml
    expected = {f"resources/{path}": data for path, data in _resources(toml, is_free).items()}
    with zipfile.ZipFile(fmu) as archive:
        names = {name for name in archive.namelist() if not name.startswith(_PYTHONFMUS)}
        if not _holds(archive, expected) or _tool(archive) != f"PythonFMU {version('pythonfmu')}":
            return False
        if not _has_pythonfmu(archive):
            return False
        documents = _documents(toml, is_free)  # which take longer to make than to compare
        return names == {*expected, *documents} and _holds(archive, documents)


def _holds(archive: zipfile.ZipFile, expected: Mapping[str, bytes]) -> bool:
    there = set(archive.namelist())
    return all(name in there and archive.read(name) == data for name, data in expected.items())


def _has_pythonfmu(archive: zipfile.ZipFile) -> bool:
    folders = {name.rpartition("/")[0] for name in archive.namelist()}
    return folders >= {"resources/pythonfmu", *(f"binaries/{platform}" for platform in PLATFORMS)}


def _tool(archive: zipfile.ZipFile) -> str | None:
    """What made the description."""
    return fromstring(archive.read("modelDescription.xml")).get("generationTool")


def repack(
    raw: Path,
    target: Path,
    documents: Mapping[str, bytes],
    describe: Callable[[Element], Element] = lambda root: root,
) -> Path:
    """Copy an FMU with documents added and its description completed by `describe`; sorted, with
    one date and without caches, so that equal sources give equal bytes. Returns `target`."""
    with zipfile.ZipFile(raw) as source:
        contents = {
            name: source.read(name)
            for name in source.namelist()
            if "__pycache__" not in name and not name.endswith("/")
        }
    root = describe(fromstring(contents["modelDescription.xml"].decode("utf-8")))
    indent(root)
    xml = b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="utf-8")
    contents |= {"modelDescription.xml": xml, **documents}
    return write_archive(target, contents)


def write_archive(target: Path, contents: Mapping[str, bytes]) -> Path:
    """Write files by their path in it into the FMU `target`, sorted and with one date; returns
    `target`."""
    with unfinished(target) as part, zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as sink:
        for name, data in sorted(contents.items()):
            info = zipfile.ZipInfo(name, _ZIP_DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            sink.writestr(info, data)
    return target
