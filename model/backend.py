"""The backend that runs the compiled functions of a block: the solver library if there is one for
this machine, otherwise numba, otherwise plain Python. All three give the same numbers."""

import os
from collections.abc import Callable
from enum import Enum
from functools import cache, partial
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from .kernels import library
from .kernels.cache import warn_once
from .kernels.jit import IS_COMPILED, IS_SWITCHED_OFF, has_to_compile
from .kernels.kernel import interpreted
from .time_loop import entry_points

VARIABLE = "ROTOR_FMU_KERNELS"


class Backend(Enum):
    """The backend that runs the kernels."""

    LIBRARY = "library"
    NUMBA = "numba"
    PYTHON = "python"


class EntryPoints(NamedTuple):
    """The functions of `time_loop.entry_points` bound to one block, which must outlive them."""

    start: Callable[[float, float, float], int]
    advance: Callable[[float, float, float], int]
    survey: Callable[[float, int], object]
    refresh_outputs: Callable[[], object]
    differentiate: Callable[[int], object]


@cache
def selected_backend() -> Backend:
    """Return the backend of this process: the one named by the environment variable
    ROTOR_FMU_KERNELS, or the first that is available.

    Raises `ValueError` for an unknown name or a missing library.
    """
    wanted = os.environ.get(VARIABLE)
    if wanted is not None and wanted not in {backend.value for backend in Backend}:
        known = ", ".join(backend.value for backend in Backend)
        raise ValueError(f"{VARIABLE} = {wanted}: must be one of {known}")
    if wanted == Backend.PYTHON.value or (wanted is None and IS_SWITCHED_OFF):
        return Backend.PYTHON
    if wanted != Backend.NUMBA.value and library.loaded():
        return Backend.LIBRARY
    if wanted == Backend.LIBRARY.value:
        raise ValueError(
            f"{VARIABLE} = {wanted}: there is none made of these kernels for this machine"
        )
    return Backend.NUMBA if IS_COMPILED and _has_numba() else Backend.PYTHON


def _has_numba() -> bool:
    try:
        import_module(".kernels.dispatching", __package__)
    except ImportError as error:
        warn_once("numba", f"numba cannot be imported: {error}")
        return False
    return True


def why_interpreted() -> str:
    """Return the sentence that says why Python interprets the kernels, and what that means."""
    if os.environ.get(VARIABLE) == Backend.PYTHON.value:
        why = f"{VARIABLE} = {Backend.PYTHON.value}"
    elif IS_SWITCHED_OFF:
        why = "numba is switched off"
    else:
        why = "numba cannot be imported (pip install numba)"
    return (
        f"{why}: the solver runs interpreted, some five hundred times slower, with the same numbers"
    )


def waits_for_compiler(entry: Any = entry_points.advance) -> bool:
    """Return whether the first call of an entry point in this process compiles it."""
    return selected_backend() is Backend.NUMBA and has_to_compile(entry)


def bound(entry: Any, block: np.ndarray, backend: Backend | None = None) -> Callable[..., Any]:
    """Return a compiled function of a block and numbers as a function of the numbers alone, run by
    `backend`, by default the selected one. The block must outlive it."""
    backend = backend or selected_backend()
    if backend is Backend.LIBRARY:
        made = getattr(library.loaded(), f"rotor_{entry.__name__}")
        return partial(made, block.ctypes.data)
    return partial(entry.dispatcher if backend is Backend.NUMBA else interpreted(entry), block)


def bound_unless_compiled(entry: Any, block: np.ndarray) -> Callable[..., Any]:
    """Return `bound` with the library, or interpreted where there is none: for calls so rare that
    compiling would take longer."""
    is_made = selected_backend() is Backend.LIBRARY
    return bound(entry, block, Backend.LIBRARY if is_made else Backend.PYTHON)


def bound_entry_points(block: np.ndarray) -> EntryPoints:
    """Return the functions for a block, run by the selected backend."""
    return EntryPoints(*(bound(getattr(entry_points, name), block) for name in EntryPoints._fields))
