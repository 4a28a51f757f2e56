"""One thread for the linear algebra of a call.

A machine's matrices are too small for several threads: waiting for each other costs up to twenty
times the work on a loaded processor. The command line sets the libraries to one thread before it
loads them; another process needs threadpoolctl (the extra `threads`), and without it computes the
same numbers more slowly.
"""

import sys
from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from functools import cache, wraps
from typing import Any, ParamSpec, TypeVar

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


@cache
def _controller(has_scipy: bool) -> Any:
    """Return the object that limits the threads of the libraries loaded, None without
    threadpoolctl. The libraries are searched for once, and once more after SciPy has loaded its
    own."""
    try:
        from threadpoolctl import ThreadpoolController  # type: ignore[import-untyped]
    except ImportError:
        return None
    return ThreadpoolController()


def _one_thread() -> AbstractContextManager[Any]:
    controller = _controller("scipy.linalg" in sys.modules)
    return controller.limit(limits=1, user_api="blas") if controller else nullcontext()


def on_one_thread(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Limit BLAS and LAPACK to one thread while a function runs."""

    @wraps(function)
    def limited(*arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        with _one_thread():
            return function(*arguments, **options)

    return limited
