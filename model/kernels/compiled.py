"""One decorator: numba's compiler where it is installed, plain Python where it is not.

Compiled code is kept in a folder of the user's, named after the content of this package: numba
itself looks at each file alone and would go on using code that it compiled from an older version
of another file.
"""

from __future__ import annotations

import hashlib
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

from .user_cache import user_cache

try:
    import numba
    from llvmlite import binding

    IS_COMPILED = not numba.config.DISABLE_JIT
except ImportError:
    numba = None
    IS_COMPILED = False

INTERPRETED_WARNING = (
    f"numba is {'switched off' if numba else 'not installed (pip install numba)'}: the solver runs "
    "interpreted, some five hundred times slower, with the same numbers"
)
# The kernels allocate nothing, so arrays need no reference counts (atomic ones, at every access),
# and the tuples they share are many words to hand over: inlined, a step takes half the time.
_OPTIONS = {"error_model": "numpy", "nogil": True, "forceinline": True}
if numba and hasattr(numba.core.cpu.CPUTargetOptions, "_nrt"):
    _OPTIONS["_nrt"] = False
_KEPT_VERSIONS = 8


def _code_cache() -> str:
    """The folder for code compiled from exactly these sources for this Python, numba and processor;
    "" (numba's own choice) if none can be made. Only the newest few versions are kept."""
    processor = f"{binding.get_host_cpu_name()} {binding.get_host_cpu_features().flatten()}"
    digest = hashlib.sha256(f"{sys.version} {numba.__version__} {processor}".encode())
    for source in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(source.read_bytes())
    versions = user_cache() / "compiled"
    folder = versions / digest.hexdigest()[:16]
    try:
        if not folder.is_dir():
            folder.mkdir(parents=True, exist_ok=True)
            by_age = sorted(versions.iterdir(), key=lambda p: p.stat().st_mtime, reverse=True)
            for old in by_age[_KEPT_VERSIONS:]:
                shutil.rmtree(old, ignore_errors=True)
    except OSError:
        return ""
    return str(folder)


_CODE_CACHE = _code_cache() if IS_COMPILED else ""


def has_to_compile(function: Callable) -> bool:
    """Whether the first call of a `compiled` function compiles it, no earlier process having kept
    its code."""
    if not IS_COMPILED:
        return False
    name = f"{function.__module__.rpartition('.')[2]}.{function.__name__}-"
    return not any(Path(function.stats.cache_path).glob(f"{name}*.nbi"))


def compiled(function: Callable, is_kept: bool = True) -> Callable:
    """Compile `function` with numba, cached on disk if `is_kept`, or return it as it is without
    numba. What is made anew in every process (a closure) is kept in the code of its callers alone.

    The arithmetic is IEEE in both cases (no fast-math), so the numbers are the same.
    """
    if numba is None:
        return function
    if not is_kept:
        return numba.njit(**_OPTIONS)(function)
    before = numba.config.CACHE_DIR
    numba.config.CACHE_DIR = _CODE_CACHE or before
    try:
        return numba.njit(cache=True, **_OPTIONS)(function)
    finally:
        numba.config.CACHE_DIR = before


def inlined(function: Callable) -> Callable:
    """`compiled`, for a large function with one caller or two: its body becomes part of theirs
    before anything is compiled, so that it is not compiled for itself as well."""
    if numba is None:
        return function
    return numba.njit(inline="always", **_OPTIONS)(function)
