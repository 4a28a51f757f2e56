"""Threads of libraries of linear algebra: a machine's matrices are too small for more than one."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")

ONE_THREAD = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
)


def with_one_thread(solve: Callable[P, T]) -> Callable[P, T]:
    """Let a function solve with one thread, whatever NumPy was imported with."""

    @wraps(solve)
    def run(*arguments: P.args, **options: P.kwargs) -> T:
        # imported where something is solved
        from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

        with threadpool_limits(1):
            return solve(*arguments, **options)

    return run
