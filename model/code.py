"""What carries out the functions of `entries`: the library of kernels where there is one for this
machine, else numba, else Python. The numbers are the same."""

from __future__ import annotations

import os
from collections.abc import Callable
from enum import Enum
from functools import cache, partial
from importlib import import_module
from typing import Any, NamedTuple

import numpy as np

from .kernels import library
from .kernels.cache import warn_once
from .kernels.compiled import IS_COMPILED, IS_SWITCHED_OFF, has_to_compile, plain
from .march import entries

VARIABLE = "ROTOR_FMU_KERNELS"


class Code(Enum):
    """What carries out the kernels."""

    LIBRARY = "library"
    NUMBA = "numba"
    PYTHON = "python"


class Calls(NamedTuple):
    """The functions of `entries` for one block, which has to outlive them."""

    start: Callable[[float, float, float], int]
    advance: Callable[[float, float, float], int]
    survey: Callable[[float, int], object]
    look: Callable[[], object]


@cache
def chosen() -> Code:
    """What carries out the kernels in this process: the one that the environment's
    ROTOR_FMU_KERNELS names, or the first that there is.

    Raises `ValueError` for a name that is none, or a library that is not there.
    """
    wanted = os.environ.get(VARIABLE)
    if wanted is not None and wanted not in {code.value for code in Code}:
        known = ", ".join(code.value for code in Code)
        raise ValueError(f"{VARIABLE} = {wanted}: must be one of {known}")
    if wanted == Code.PYTHON.value or (wanted is None and IS_SWITCHED_OFF):
        return Code.PYTHON
    if wanted != Code.NUMBA.value and library.loaded():
        return Code.LIBRARY
    if wanted == Code.LIBRARY.value:
        raise ValueError(
            f"{VARIABLE} = {wanted}: there is none made of these kernels for this machine"
        )
    return Code.NUMBA if IS_COMPILED and _has_numba() else Code.PYTHON


def _has_numba() -> bool:
    try:
        import_module(".kernels.dispatching", __package__)
    except ImportError as error:
        warn_once("numba", f"numba cannot be imported: {error}")
        return False
    return True


def waits_for_compiler() -> bool:
    """Whether the first run in this process compiles the kernels."""
    return chosen() is Code.NUMBA and has_to_compile(entries.advance)


def calls(block: np.ndarray, code: Code | None = None) -> Calls:
    """The functions for a block, carried out by `code`, the one chosen if None."""
    code = code or chosen()
    functions: tuple[Any, ...] = entries.start, entries.advance, entries.survey, entries.look
    if code is Code.LIBRARY:
        made = library.loaded()
        assert made is not None
        address = block.ctypes.data
        return Calls(
            partial(made.rotor_start, address),
            partial(made.rotor_advance, address),
            partial(made.rotor_survey, address),
            partial(made.rotor_look, address),
        )
    if code is Code.NUMBA:
        return Calls(*(partial(function.dispatcher, block) for function in functions))
    return Calls(*(partial(plain(function), block) for function in functions))
