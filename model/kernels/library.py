"""The solver library, compiled ahead of time: located by the digest of its sources, and loaded.

A file counts only if its name shows that it was made of exactly these kernels and is complete:

    linux64.SOURCES.KERNELS.CHECKSUM.so

SOURCES is the digest of all sources of the library, KERNELS that of a run's kernels.
"""

import ctypes
import hashlib
import platform
import sys
from functools import cache
from pathlib import Path

from .cache import warn_once
from .digest import folders, kernels_digest
from .signatures import ANALYSES, INTEGER, REAL, RUN

_MACHINES = {"x86_64": "x86_64", "AMD64": "x86_64", "aarch64": "aarch64", "arm64": "aarch64"}
# By the system and the processor, as in FMI 2.0 where it has a name.
_PLATFORMS = {
    ("linux", "x86_64"): "linux64",
    ("linux", "aarch64"): "aarch64-linux",
    ("win32", "x86_64"): "win64",
    ("darwin", "x86_64"): "darwin64",
    ("darwin", "aarch64"): "aarch64-darwin",
}
_DIGITS = 16
_TYPES = {REAL: ctypes.c_double, INTEGER: ctypes.c_int64}
# The status of a function whose kernel raised an exception (`rotor_fmu/fmi/c/kernels.h`).
RAISED = 1 << 20


def here() -> str | None:
    """Return the name of this machine's platform, or None if no library can be made for it."""
    is_wide = sys.maxsize > 2**32
    machine = _MACHINES.get(platform.machine(), "")
    return _PLATFORMS.get((sys.platform, machine)) if is_wide else None


def file_name(name: str, sources: str, suffix: str, content: bytes) -> str:
    """Return the file name of a platform's library with this content."""
    checksum = hashlib.sha256(content).hexdigest()[:_DIGITS]
    return f"{name}.{sources}.{kernels_digest()}.{checksum}{suffix}"


def find(name: str, sources: str = "*") -> Path | None:
    """Return the library of a platform that was made of these kernels, if there is one;
    sources: the digest of all its sources."""
    for folder in folders():
        for file in sorted(folder.glob(f"{name}.{sources}.{kernels_digest()}.*")):
            if file.name == file_name(name, file.name.split(".")[1], file.suffix, _read(file)):
                return file
    return None


def _read(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError:
        return b""


@cache
def loaded() -> ctypes.CDLL | None:
    """Return this machine's library with the types of its functions, or None if there is none."""
    name = here()
    file = find(name) if name else None
    if file is None:
        return None
    try:
        library = ctypes.CDLL(str(file))
        for entry, numbers in (RUN | ANALYSES).items():
            types = (ctypes.c_void_p, *(_TYPES[number] for number in numbers))
            getattr(library, f"rotor_{entry}").argtypes = types
    except (OSError, AttributeError) as error:
        warn_once("library", f"the library of the solver cannot be loaded: {error}")
        return None
    return library
