"""What goes into the FMU, and building it."""

from __future__ import annotations

import hashlib
import re
import shutil
import sys
import tempfile
import zipfile
from pathlib import Path
from xml.etree.ElementTree import fromstring, indent, tostring

from pythonfmu.builder import FmuBuilder

import model
from model.rotor_toml import parse_rotor, rig_toml

from .documents import documents
from .interface import interface
from .slave import ROTOR_FILE

FMU_NAME = "RotorBearing.fmu"
REQUIREMENTS = ("numpy>=1.26", "scipy>=1.11", "numba>=0.60")
_HERE = Path(__file__).parent
_OWN_MODULES = ("about", "interface", "binding", "description", "wrapper", "state", "slave")
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)


def build(out: Path, rotor_toml: str | None = None) -> Path:
    """Build `RotorBearing.fmu` in the folder `out` and return its path.

    rotor_toml: TOML text of the rotor, by default the paper's rig. Raises `RotorError` for an
    impossible rotor and `OSError` if `out` cannot be written. Equal sources give equal bytes.
    """
    toml = rig_toml() if rotor_toml is None else rotor_toml
    described = parse_rotor(toml)
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="rotor_fmu_") as name:
        folder = Path(name)
        package = _write_package(folder)
        rotor = folder / ROTOR_FILE
        rotor.write_text(toml, encoding="utf-8")
        script = folder / f"{package.name}_entry.py"
        shutil.copyfile(_HERE / "entry.py", script)
        requirements = folder / "requirements.txt"
        requirements.write_text("\n".join(REQUIREMENTS) + "\n", encoding="utf-8")
        raw = folder / "raw.fmu"
        search_path = list(sys.path)
        try:
            FmuBuilder.build_FMU(
                script,
                dest=raw,
                project_files=[package, rotor, requirements],
                canGetAndSetFMUstate=True,
                canSerializeFMUstate=True,
            )
        finally:
            sys.path[:] = search_path
        # written beside its place and moved there, so that nothing half-written is ever found
        unfinished = out / (FMU_NAME + ".part")
        _repack(raw, unfinished, documents(described, interface(described), Path(FMU_NAME).stem))
        return unfinished.replace(out / FMU_NAME)


def _sources() -> dict[str, str]:
    """The package's modules by their path in it; `model` becomes a subpackage."""
    root = Path(model.__file__).parent
    files = {f"model/{p.relative_to(root).as_posix()}": p for p in root.rglob("*.py")}
    files |= {f"{name}.py": _HERE / f"{name}.py" for name in _OWN_MODULES}
    texts = {path: file.read_text(encoding="utf-8") for path, file in sorted(files.items())}
    return {
        path: text
        if path.startswith("model/")
        else re.sub(r"(?m)^from model\b", "from .model", text)
        for path, text in texts.items()
    }


def _contents() -> tuple[str, dict[str, str]]:
    """Name of the FMU's package, which follows its content, and the content by path."""
    contents = _sources() | {"__init__.py": ""}
    digest = hashlib.sha256()
    for path, text in sorted(contents.items()):
        digest.update(f"{path}\0{text}\0".encode())
    return f"rotorbearing_{digest.hexdigest()[:12]}", contents


def _write_package(folder: Path) -> Path:
    name, contents = _contents()
    package = folder / name
    for path, text in contents.items():
        target = package / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
    return package


def package_name() -> str:
    """Name of the package that `build` would put into the FMU now; it follows the code."""
    return _contents()[0]


def is_current(fmu: Path, rotor_toml: str | None = None) -> bool:
    """Whether `fmu` is what `build` would make now."""
    if not fmu.is_file() or not zipfile.is_zipfile(fmu):
        return False
    with zipfile.ZipFile(fmu) as archive:
        if f"resources/{package_name()}_entry.py" not in archive.namelist():
            return False
        toml = archive.read(f"resources/{ROTOR_FILE}").decode("utf-8")
    return toml == (rig_toml() if rotor_toml is None else rotor_toml)


def _repack(raw: Path, target: Path, documents: dict[str, bytes]) -> None:
    """Copy a zip file with the documents added, sorted, with one date and without caches."""
    with zipfile.ZipFile(raw) as source:
        contents = {
            name: source.read(name)
            for name in source.namelist()
            if "__pycache__" not in name and not name.endswith("/")
        }
    root = fromstring(contents["modelDescription.xml"].decode("utf-8"))
    indent(root)
    xml = b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="utf-8")
    contents |= {"modelDescription.xml": xml, **documents}
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as sink:
        for name, data in sorted(contents.items()):
            info = zipfile.ZipInfo(name, _ZIP_DATE)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.external_attr = 0o644 << 16
            sink.writestr(info, data)
