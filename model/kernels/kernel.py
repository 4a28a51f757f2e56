"""A kernel: a function that numba compiles when it is first called, and that can also be
interpreted with everything that it calls."""

import builtins
from collections.abc import Callable
from dis import get_instructions
from functools import cached_property, update_wrapper
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any

_PACKAGE = __name__.rpartition(".kernels.")[0]


class Kernel:
    """A function that numba compiles for the types of its first call, or into the function that
    calls it. Every other attribute is that of numba's dispatcher."""

    def __init__(self, function: Callable[..., Any], make: Callable[[], Any]) -> None:
        self.py_func = function
        self._make = make
        update_wrapper(self, function)

    @cached_property
    def dispatcher(self) -> Any:
        """Numba's dispatcher of the function."""
        return self._make()

    @cached_property
    def interpreted(self) -> Callable[..., Any]:
        """The function interpreted, with everything that it calls."""
        return _interpreted(self.py_func)

    def __call__(self, *arguments: Any) -> Any:
        """Compile the function if need be, and call it."""
        return self.dispatcher(*arguments)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return getattr(self.dispatcher, name)

    def __reduce__(self) -> Any:
        """Pickle the kernel as numba's dispatcher does."""
        return self.dispatcher.__reduce__()


def interpreted(function: Any) -> Any:
    """Return a `jit` function interpreted, with everything that it calls: for a function that is
    called once per machine, where importing a compiler would take longer. Any other object is
    returned unchanged."""
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
    """Return a function whose globals and closure hold interpreted functions."""
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
