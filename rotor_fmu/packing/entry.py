"""The script that an FMU's wrapper runs: makes the FMU's package importable, and imports the slave.

In the FMU this file is called <package>_entry.py, or <package>_free_entry.py where a torque drives
the rotor. The package, whose name follows its content, is
imported from a copy in the user's cache: so the compiled code of its first run is found again, two
builds in one process do not meet, and the extraction folder may be deleted.
"""

import ctypes
import importlib
import runpy
import shutil
import sys
import tempfile
from pathlib import Path

# For each instance the wrapper runs this script and then drops a reference to the module's globals
# that it never took: without one more each time, the third instance in a process would crash.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))


class Missing(ImportError):
    """A package that this host's Python lacks."""

    def __repr__(self) -> str:
        """The sentence alone: the wrapper logs the representation."""
        return str(self)


RESOURCES = Path(__file__).resolve().parent
PACKAGE = Path(__file__).stem.removesuffix("_entry").removesuffix("_free")


def _installed(package: Path) -> Path:
    """Folder to import from: the user's copy of `package`, or where it lies if none can be made."""
    cache = runpy.run_path(str(package / "model" / "kernels" / "user_cache.py"))["user_cache"]()
    folder = cache / "packages" / package.name
    sources = [path for path in package.rglob("*") if path.suffix in (".py", ".toml")]
    copies = {source: folder / package.name / source.relative_to(package) for source in sources}
    if all(c.is_file() and c.read_bytes() == s.read_bytes() for s, c in copies.items()):
        return folder
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        fresh = Path(tempfile.mkdtemp(dir=folder.parent))
        shutil.copytree(package, fresh / package.name, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.rmtree(folder, ignore_errors=True)
        fresh.rename(folder)
    except OSError:
        # another process was first, or nothing can be written here
        if not all(c.is_file() and c.read_bytes() == s.read_bytes() for s, c in copies.items()):
            return package.parent
    return folder


if PACKAGE not in sys.modules:
    for needed in ("numpy", "scipy"):
        try:
            importlib.import_module(needed)
        except ImportError as error:
            message = (
                f"{needed} is missing in the Python of this host ({sys.prefix}): "
                "pip install numpy scipy numba"
            ).replace("%", " percent")
            print(f"RotorBearing: error: {message}", file=sys.stderr, flush=True)
            raise Missing(message) from error
    sys.path.insert(0, str(_installed(RESOURCES / PACKAGE)))
    try:
        importlib.import_module(f"{PACKAGE}.fmu.slave")
    finally:
        sys.path.pop(0)

RotorBearing = sys.modules[f"{PACKAGE}.fmu.slave"].RotorBearing
