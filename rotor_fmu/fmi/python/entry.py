"""The script that an FMU's wrapper runs: imports the FMU's package, and the slave from it.

In the FMU this file is called <package>_entry.py. The package is imported from where it lies and
from nowhere else, all of it at once, so that the extraction folder may be deleted. Its name follows
its content: two builds in one process do not meet.
"""

import ctypes
import importlib
import importlib.util
import sys
from pathlib import Path

# For each instance the wrapper runs this script and then drops a reference to the module's globals
# that it never took: without one more each time, the third instance in a process would crash.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

here = Path(__file__).parent
package = Path(__file__).stem.removesuffix("_entry")
# a package that is there without its slave was imported from a folder that is gone
if f"{package}.slave" not in sys.modules:
    folder = here.resolve() / package
    spec = importlib.util.spec_from_file_location(
        package, folder / "__init__.py", submodule_search_locations=[str(folder)]
    )
    if spec is None or spec.loader is None:
        raise ImportError(f"{folder}: is not a package")
    sys.modules[package] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(sys.modules[package])

# The wrapper puts the resources on the search path for each instance anew. Of the folders with this
# script one is left, which pythonfmu takes away when it builds.
others = [entry for entry in sys.path if not Path(entry, Path(__file__).name).is_file()]
sys.path[:] = [str(here), *(entry for entry in others if entry != str(here))]

RotorBearing = importlib.import_module(f"{package}.slave").RotorBearing
