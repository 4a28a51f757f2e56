"""One decorator: numba's compiler where it is installed, plain Python where it is not.

numba is imported when the first kernel is jit: a run on the library of kernels made ahead
(`library`) never does, and starts in a fraction of the time.
"""

from __future__ import annotations

import builtins
import os
from collections.abc import Callable
from dis import get_instructions
from functools import cached_property, update_wrapper
from importlib.util import find_spec
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any

_PACKAGE = __name__.rpartition(".kernels.")[0]
IS_SWITCHED_OFF = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
IS_COMPILED = not IS_SWITCHED_OFF and find_spec("numba") is not None

INTERPRETED_WARNING = (
    f"numba is {'switched off' if IS_SWITCHED_OFF else 'not installed (pip install numba)'}: the "
    "solver runs interpreted, some five hundred times slower, with the same numbers"
)
# The kernels allocate nothing, so arrays need no reference counts (atomic ones, at every access),
# and the tuples they share are many words to hand over: inlined, a step takes half the time.
OPTIONS = {"error_model": "numpy", "nogil": True, "forceinline": True}


class Kernel:
    """A function that numba compiles for the types of its first call, or into the function that
    calls it. Every other attribute is that of numba's dispatcher."""

    def __init__(self, function: Callable[..., Any], make: Callable[[], Any]) -> None:
        self.py_func = function
        self._make = make
        update_wrapper(self, function)

    @cached_property
    def dispatcher(self) -> Any:
        """Return numba's dispatcher of the function."""
        return self._make()

    @cached_property
    def interpreted(self) -> Callable[..., Any]:
        """The function interpreted, with all that it calls."""
        return _interpreted(self.py_func)

    def __call__(self, *arguments: Any) -> Any:
        """Compile the function if need be, and call it."""
        return self.dispatcher(*arguments)

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the dispatcher."""
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.dispatcher, name)

    def __reduce__(self) -> Any:
        """Pickle the kernel as numba's dispatcher does."""
        return self.dispatcher.__reduce__()


def interpreted(function: Any) -> Any:
    """Return a `jit` function interpreted, with all that it calls: for what is called once a
    machine, where importing a compiler would take longer. Anything else is as it was."""
    if isinstance(function, Kernel):
        return function.interpreted
    if isinstance(function, ModuleType) and function.__name__.startswith(_PACKAGE):
        return _PlainModule(function)
    return function


class _PlainModule:
    """A module of kernels, interpreted."""

    def __init__(self, module: ModuleType) -> None:
        self._module = module

    def __getattr__(self, name: str) -> Any:
        setattr(self, name, interpreted(getattr(self._module, name)))
        return self.__dict__[name]


def _interpreted(function: Callable[..., Any]) -> Callable[..., Any]:
    assert isinstance(function, FunctionType)
    scope = function.__globals__
    known = {
        name: interpreted(scope[name]) for name in _globals(function.__code__) if name in scope
    }
    cells = tuple(CellType(interpreted(cell.cell_contents)) for cell in function.__closure__ or ())
    known["__builtins__"] = builtins
    return FunctionType(function.__code__, known, function.__name__, function.__defaults__, cells)


def _globals(code: CodeType) -> set[str]:
    """Return the names of globals that a function's code reads."""
    inner = (_globals(c) for c in code.co_consts if isinstance(c, CodeType))
    own = {i.argval for i in get_instructions(code) if i.opname == "LOAD_GLOBAL"}
    return own.union(*inner)


def has_to_compile(function: Any) -> bool:
    """Return whether the first call of a `jit` function compiles it, no code of it being cached."""
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
    """Compile `function` with numba, its code cached on disk if `to_cache`, or return it as it is
    without numba. What is made anew in every process (a closure) is cached in the code of its
    callers alone.

    The arithmetic is IEEE in both cases (no fast-math), so the numbers are the same.
    """
    return _kernel(function, to_cache)


def jit_inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """`jit`, for a large function with one caller or two: its body becomes part of theirs
    before anything is compiled, so that it is not compiled for itself as well."""
    return _kernel(function, False, inline="always")


def jit_not_inlined(function: Callable[..., Any]) -> Callable[..., Any]:
    """`jit`, for what a run seldom needs or that is large: it is compiled once and called,
    not made part of all its callers, each of which would take longer to compile."""
    return _kernel(function, True, forceinline=False)
