"""What pythonfmu's native wrapper (0.7.0) must be spared, so that it does not crash its host."""

from __future__ import annotations

import ctypes
import os
import sys
from pathlib import Path

_settled: set[str] = set()


def hold(*objects: object) -> None:
    """Take one more reference to each object.

    The wrapper drops its references to the instance, its log queue and its class whenever an
    exception leaves a callback, and once more at the end.
    """
    for item in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(item))


def settle_exit(resources: str | None, model_identifier: str) -> None:
    """Let the wrapper in `resources`/.. be torn down once at the end of the process, not twice.

    At exit its global state is destroyed as a C++ object and then by a destructor function that
    takes it for alive: that writes into freed memory, and now and then the host ends in an abort.
    A handler registered now runs before both and leaves them nothing to destroy. The library is
    kept loaded until then, as it stays anyway.
    """
    if not sys.platform.startswith("linux") or resources is None:
        return
    library = Path(resources).parent / "binaries" / "linux64" / f"{model_identifier}.so"
    if str(library) in _settled:
        return
    try:
        wrapper = ctypes.CDLL(str(library), mode=os.RTLD_NOLOAD | os.RTLD_LAZY)
        finalize = ctypes.cast(wrapper.finalizePythonInterpreter, ctypes.c_void_p)
        ctypes.CDLL(None).__cxa_atexit(finalize, None, None)
    except (OSError, AttributeError):
        return  # not loaded, as when the FMU is being built, or another version
    _settled.add(str(library))
