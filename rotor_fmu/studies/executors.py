"""Where the runs of a study are made: this machine's processes, or Dask's workers.

Both are executors in the sense of the standard library; what is sent is a chunk of runs, what
comes back their results and the seconds they took.
"""

import contextlib
import logging
import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import resource_tracker
from typing import Any, NamedTuple

from ..errors import InputError, optional
from ..run_status import FAILED
from ..threads import ONE_THREAD
from .study import Model, Result

TIME_OUT = 10.0  # within which a scheduler must answer [s]
Chunk = list[tuple[int, dict[str, float]]]
_warmed: set[str] = set()


class Done(NamedTuple):
    """A chunk that was run: results by the runs' numbers, and the seconds that it took."""

    results: dict[int, Result]
    seconds: float


def run_chunk(model: Model, chunk: Chunk) -> Done:
    """Run a chunk in this process; compiled code is warmed before the first."""
    identity = model.identity
    if identity not in _warmed:
        _warmed.add(identity)
        model.warm()
    begun = time.perf_counter()
    results = {}
    for number, values in chunk:
        try:
            results[number] = model.run(values)
        except Exception as error:  # whatever it is, it is the reason in that run's row
            results[number] = Result(f"{FAILED}{type(error).__name__}: {error}", {})
    return Done(results, time.perf_counter() - begun)


@dataclass(frozen=True)
class ExecutorConfig:
    """The user's choice: processes on this machine, a scheduler's address, or a local cluster."""

    jobs: int = 0
    scheduler: str = ""
    cluster: int = 0


class Engine(NamedTuple):
    """An executor, how many runs it makes at a time, how long a chunk should take [s]."""

    executor: Executor
    workers: int
    chunk_s: float


def worker_errors() -> tuple[type[BaseException], ...]:
    """Return the errors that a chunk raises whose worker died."""
    with contextlib.suppress(ImportError):
        from distributed.scheduler import KilledWorker

        return (BrokenProcessPool, KilledWorker)
    return (BrokenProcessPool,)


@contextlib.contextmanager
def engine(where: ExecutorConfig) -> Iterator[Engine]:
    """The engine that a user chose; its workers end with the context."""
    if where.scheduler or where.cluster:
        with _dask(where) as result:
            yield result
        return
    # before a worker loads NumPy: one thread a process, and the same bits in each
    with _environment(ONE_THREAD):
        spawn = multiprocessing.get_context("spawn")
        executor = _Processes(where.jobs, spawn, initializer=_begin_worker)
        try:
            yield Engine(executor, where.jobs, 1.0)
        finally:
            processes = list((getattr(executor, "_processes", None) or {}).values())
            executor.shutdown(wait=False, cancel_futures=True)
            for process in processes:  # whatever they are at is made again
                process.terminate()
            executor.shutdown(wait=True)


class _Processes(ProcessPoolExecutor):
    """Workers that Ctrl-C does not reach from their start on, which is when they are given work."""

    def submit(self, *work: Any, **named: Any) -> Future:
        """Schedule a call, as `Executor.submit` does."""
        with interrupts_deferred():
            return super().submit(*work, **named)


def _begin_worker() -> None:
    """Leave Ctrl-C to the parent, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@contextlib.contextmanager
def interrupts_deferred() -> Iterator[None]:
    """Keep Ctrl-C from processes that are started, which inherit that the signal is blocked, and
    from a lock that would stay held; one that comes meanwhile ends the call afterwards. Windows
    blocks no signals."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # begun by the first process, it would unblock the signal
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _environment(changes: Mapping[str, str]) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in changes}
    os.environ.update(changes)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _dask(where: ExecutorConfig) -> Iterator[Engine]:
    dask = optional("distributed", "cluster", "--scheduler, --cluster")
    with contextlib.ExitStack() as stack:
        address: Any = where.scheduler
        options = {
            "threads_per_worker": 1,
            "dashboard_address": None,
            "silence_logs": logging.ERROR,
        }
        if where.cluster:
            stack.enter_context(_environment(ONE_THREAD))
            with interrupts_deferred():
                cluster = dask.LocalCluster(where.cluster, **options)
            address = stack.enter_context(cluster)
        try:
            client = stack.enter_context(dask.Client(address, timeout=TIME_OUT))
        except (OSError, ValueError, TypeError) as error:
            raise InputError(
                f"--scheduler {where.scheduler}: no scheduler answers within {TIME_OUT:g} s"
            ) from error
        workers = sum(client.nthreads().values())
        if not workers:
            raise InputError(f"--scheduler {where.scheduler}: has no workers")
        yield Engine(client.get_executor(pure=False), workers, 2.0)
