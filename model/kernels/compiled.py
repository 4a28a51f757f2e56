"""One decorator: numba's compiler where it is installed, plain Python where it is not."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

try:
    import numba

    IS_COMPILED = not numba.config.DISABLE_JIT
except ImportError:
    numba = None
    IS_COMPILED = False

if IS_COMPILED:
    from .kept_overloads import is_kept, keep

INTERPRETED_WARNING = (
    f"numba is {'switched off' if numba else 'not installed (pip install numba)'}: the solver runs "
    "interpreted, some five hundred times slower, with the same numbers"
)
# The kernels allocate nothing, so arrays need no reference counts (atomic ones, at every access),
# and the tuples they share are many words to hand over: inlined, a step takes half the time.
_OPTIONS = {"error_model": "numpy", "nogil": True, "forceinline": True}
if numba and hasattr(numba.core.cpu.CPUTargetOptions, "_nrt"):
    _OPTIONS["_nrt"] = False


def has_to_compile(function: Any) -> bool:
    """Whether the first call of a `compiled` function compiles it, no earlier process having kept
    its code."""
    return IS_COMPILED and not function.overloads and not is_kept(function)


def compiled(function: Callable[..., Any], to_keep: bool = True) -> Callable[..., Any]:
    """Compile `function` with numba, kept on disk if `to_keep`, or return it as it is without
    numba. What is made anew in every process (a closure) is kept in the code of its callers alone.

    The arithmetic is IEEE in both cases (no fast-math), so the numbers are the same.
    """
    if not IS_COMPILED:
        return function
    dispatcher = numba.njit(**_OPTIONS)(function)
    if to_keep:
        keep(dispatcher)
    return dispatcher


def inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """`compiled`, for a large function with one caller or two: its body becomes part of theirs
    before anything is compiled, so that it is not compiled for itself as well."""
    if not IS_COMPILED:
        return function
    return numba.njit(inline="always", **_OPTIONS)(function)


def called(function: Callable[..., Any]) -> Callable[..., Any]:
    """`compiled`, for what a run seldom needs or that is large: it is compiled once and called,
    not made part of all its callers, each of which would take longer to compile."""
    if not IS_COMPILED:
        return function
    dispatcher = numba.njit(**{**_OPTIONS, "forceinline": False})(function)
    keep(dispatcher)
    return dispatcher
