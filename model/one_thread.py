"""One thread for the linear algebra of a call: a machine's matrices are too small for more, whose
waiting for each other costs twenty times the work on a loaded processor.

The command line says so to the libraries before it loads them; a process of another kind needs
threadpoolctl (the extra `threads`) for it, and without is as exact and slower.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


@cache
def _controller(has_scipy: bool) -> Any:
    """Return what limits the threads of the libraries loaded, which are searched for once, and once
    more when SciPy has brought its own; None where threadpoolctl is not installed."""
    try:
        from threadpoolctl import ThreadpoolController  # type: ignore[import-untyped]
    except ImportError:
        return None
    return ThreadpoolController()


def _one_thread() -> AbstractContextManager[Any]:
    controller = _controller("scipy.linalg" in sys.modules)
    return controller.limit(limits=1, user_api="blas") if controller else nullcontext()


def on_one_thread(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Let BLAS and LAPACK take one thread while a function runs, and as many as before after it."""

    @wraps(function)
    def limited(*arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        """Call the function."""
        with _one_thread():
            return function(*arguments, **options)

    return limited
