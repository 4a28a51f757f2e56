"""One thread for the linear algebra of a call: a machine's matrices are too small for more, whose
waiting for each other costs twenty times the work on a loaded processor."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import cache, wraps
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController  # type: ignore[import-untyped]

_Arguments = ParamSpec("_Arguments")
_Result = TypeVar("_Result")


@cache
def _controller(has_scipy: bool) -> ThreadpoolController:
    """Return what limits the threads of the libraries loaded, which are searched for once, and once
    more when SciPy has brought its own."""
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def on_one_thread(function: Callable[_Arguments, _Result]) -> Callable[_Arguments, _Result]:
    """Let BLAS and LAPACK take one thread while a function runs, and as many as before after it."""

    @wraps(function)
    def limited(*arguments: _Arguments.args, **options: _Arguments.kwargs) -> _Result:
        """Call the function."""
        with _controller("scipy.linalg" in sys.modules).limit(limits=1, user_api="blas"):
            return function(*arguments, **options)

    return limited
