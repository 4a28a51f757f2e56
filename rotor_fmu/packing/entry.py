"""The script that an FMU's wrapper runs: imports the FMU's package, and the slave from it.

In the FMU this file is called <package>_entry.py, or <package>_free_entry.py where a torque drives
the rotor. The package is imported from where it lies and from nowhere else, all of it at once, so
that the extraction folder may be deleted. Its name follows its content: two builds in one process
do not meet.
"""

import ctypes
import importlib
import importlib.util
import os
import sys
from pathlib import Path

# For each instance the wrapper runs this script and then drops a reference to the module's globals
# that it never took: without one more each time, the third instance in a process would crash.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))


RESOURCES = Path(__file__).resolve().parent
PACKAGE = Path(__file__).stem.removesuffix("_entry").removesuffix("_free")
SLAVE = f"{PACKAGE}.fmu.slave"

# Classes and functions that a script of each instance made would never be freed: the first makes
# them, and they go with it.
if SLAVE not in sys.modules:

    class Missing(ImportError):
        """A package that this host's Python lacks."""

        def __repr__(self) -> str:
            """The sentence alone: the wrapper logs the representation."""
            return str(self)

    def _import_package(folder: Path) -> None:
        """Import the package in `folder` without a look at `sys.path`, and tell it where the user
        wants compiled code to be kept."""
        spec = importlib.util.spec_from_file_location(
            PACKAGE, folder / "__init__.py", submodule_search_locations=[str(folder)]
        )
        if spec is None or spec.loader is None:
            raise Missing(f"{folder}: is no package")
        sys.modules[PACKAGE] = package = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(package)
        cache = os.environ.get("ROTOR_FMU_CACHE")
        if cache:
            importlib.import_module(f"{PACKAGE}.model.kernels.user_cache").keep_in(Path(cache))

    for needed in ("numpy", "scipy"):
        try:
            importlib.import_module(needed)
        except ImportError as error:
            message = (
                f"{needed} is missing in the Python of this host ({sys.prefix}): "
                "pip install numpy scipy"
            ).replace("%", " percent")
            print(f"RotorBearing: error: {message}", file=sys.stderr, flush=True)
            raise Missing(message) from error
    # a package that is there without its slave was imported from a folder that is gone
    if PACKAGE not in sys.modules or not Path(sys.modules[PACKAGE].__file__ or "").is_file():
        _import_package(RESOURCES / PACKAGE)

# The wrapper puts the resources on the search path for each instance anew. Of the folders with this
# script one is left, which pythonfmu takes away when it builds.
here = Path(__file__).parent
others = [entry for entry in sys.path if not Path(entry, Path(__file__).name).is_file()]
sys.path[:] = [str(here), *(entry for entry in others if entry != str(here))]

RotorBearing = importlib.import_module(SLAVE).RotorBearing
