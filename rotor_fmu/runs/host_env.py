"""The environment that a host that is not a Python program needs on this machine."""

import sys
import sysconfig
from pathlib import Path

from ..errors import InputError


def host_environment() -> dict[str, str]:
    """Return the environment variables for a plain program that loads the FMU into itself, by name.

    The wrapper does not link Python's library, so it must be loaded before; and Python finds the
    packages of this environment by the `python` that is first in PATH. Raises `InputError` where
    Python has no shared library, or on other systems than Linux.
    """
    if not sys.platform.startswith("linux"):
        raise InputError(f"host-env: platform {sys.platform}: must be linux")
    folder = sysconfig.get_config_var("LIBDIR") or ""
    library = Path(folder, sysconfig.get_config_var("INSTSONAME") or "")
    if ".so" not in library.name or not library.is_file():
        raise InputError(
            f"host-env: {sys.executable}: must be a Python with a shared library (libpython3.*.so)"
        )
    return {"LD_PRELOAD": str(library), "PATH": f"{Path(sys.executable).parent}:$PATH"}
