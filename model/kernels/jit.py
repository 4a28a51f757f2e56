"""One decorator: numba's compiler where it is installed, plain Python where it is not.

numba is imported when the first kernel is jit: a run on the library of kernels made ahead
(`library`) never does, and starts in a fraction of the time.
"""

import os
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

from .kernel import Kernel

IS_SWITCHED_OFF = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
IS_COMPILED = not IS_SWITCHED_OFF and find_spec("numba") is not None

# The kernels allocate nothing, so arrays need no reference counts (atomic ones, at every access),
# and the tuples they share are many words to hand over: inlined, a step takes half the time.
OPTIONS = {"error_model": "numpy", "nogil": True, "forceinline": True}


def has_to_compile(function: Any) -> bool:
    """Return whether the first call of a `jit` function compiles it: none of it is cached."""
    if not IS_COMPILED or function.overloads:
        return False
    from .dispatching import is_cached

    return not is_cached(function.py_func)


def _kernel(function: Callable[..., Any], to_cache: bool, **options: Any) -> Callable[..., Any]:
    if not IS_COMPILED:
        return function

    def make() -> Any:
        from .dispatching import dispatcher

        return dispatcher(function, to_cache, {**OPTIONS, **options})

    return Kernel(function, make)


def jit(function: Callable[..., Any], to_cache: bool = True) -> Callable[..., Any]:
    """Compile `function` with numba, its code cached on disk if `to_cache`; without numba return it
    unchanged. A function that is created anew in every process (a closure) is cached only in the
    code of its callers.

    The arithmetic is IEEE in both cases (no fast-math), so the numbers are the same.
    """
    return _kernel(function, to_cache)


def jit_inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Apply `jit` to a large function with one or two callers: its body is inserted into theirs
    before anything is compiled, so that it is not compiled separately as well."""
    return _kernel(function, False, inline="always")


def jit_not_inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """Apply `jit` to a function that is rarely needed or large: it is compiled once and called, not
    inlined into all its callers, each of which would take longer to compile."""
    return _kernel(function, True, forceinline=False)
