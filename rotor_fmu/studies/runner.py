"""Carry out a study, from its runs to its rows, continuing where an earlier call stopped."""

from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future
from contextlib import AbstractContextManager, ExitStack, suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from queue import SimpleQueue

import numpy as np

from ..errors import RunFailed
from ..run_status import FAILED, has_failed
from .executors import Chunk, Done, Engine, interrupts_deferred, run_chunk, worker_errors
from .store import Store
from .study import Result, Study

_QUEUED = 2  # chunks a worker, one of them waiting
_MOST = 2000  # runs in a chunk
_WORKER_DEATHS = 2  # of workers, by a run alone, after which the run is called failed

_WRITTEN = "rows written before are whole, and the same call goes on from there"

Report = Callable[["Progress"], None]
MakeEngine = Callable[[], AbstractContextManager[Engine]]


@dataclass
class Progress:
    """How far a study is: its runs, those done before this call, done by it, and failed ones."""

    runs: int
    before: int
    now: int = 0
    failed: int = 0


class _Ahead:
    """The runs that are still to be made, in chunks as long as their time allows."""

    def __init__(self, study: Study, is_done: np.ndarray, chunk_s: float) -> None:
        self._study = study
        self._left = iter(np.flatnonzero(~is_done).tolist())
        self._chunk_s = chunk_s
        self._size = 1

    def learn(self, done: Done) -> None:
        """Adapt the chunks' length to the time of the last one, at most doubling it."""
        seconds = done.seconds / len(done.results)
        fitting = int(self._chunk_s / seconds) if seconds > 0 else _MOST
        self._size = max(1, min(fitting, 2 * self._size, _MOST))

    def next(self) -> Chunk:
        """Return the next chunk, empty at the end."""
        numbers = islice(self._left, self._size)
        return [(n, self._study.design.values(n)) for n in numbers]


def run_study(study: Study, folder: Path, engine: MakeEngine, report: Report) -> Progress:
    """Make the runs that have no row yet and write their rows into the folder.

    Whatever ends the call, what it wrote stays whole. Raises `InputError` for a folder of another
    study and `RunFailed` where rows cannot be written.
    """
    store = Store(folder, study)
    with ExitStack() as stack:
        # before anything is written: an engine that is not to be had is the user's to know
        pool = None if store.done().all() else stack.enter_context(engine())
        with store:
            is_done = store.done()
            progress = Progress(len(study.design), int(is_done.sum()))
            report(progress)
            suspects: dict[int, int] = {}  # runs during which a worker died: how often alone
            while not is_done.all():
                pool = pool or stack.enter_context(engine())
                for done in _results(study, is_done, pool, suspects):
                    store.write(done)
                    store.merge_small()
                    is_done[list(done)] = True
                    progress.now += len(done)
                    progress.failed += sum(has_failed(result.status) for result in done.values())
                    report(progress)
                stack.close()
                pool = None
            store.merge_small(least=2)
    return progress


def _results(
    study: Study, is_done: np.ndarray, pool: Engine, suspects: dict[int, int]
) -> Iterator[dict[int, Result]]:
    """Results as they come; ends when a worker died, its runs then among the suspects."""
    if suspects:
        yield from _one_by_one(study, pool, suspects)
        return
    ahead = _Ahead(study, is_done, pool.chunk_s)
    running: dict[Future, Chunk] = {}
    ended: SimpleQueue[Future] = SimpleQueue()
    fatal = worker_errors()
    while True:
        with suppress(*fatal):  # an engine that has just died: what is running will say so
            while len(running) < _QUEUED * pool.workers and (chunk := ahead.next()):
                running[_submitted(study, pool, chunk, ended)] = chunk
        if not running:
            return
        finished = [ended.get()]
        while not ended.empty():
            finished.append(ended.get())
        results: dict[int, Result] = {}
        for future in finished:
            if isinstance(_error_of(future), fatal):
                continue
            done = future.result()
            ahead.learn(done)
            results |= done.results
            del running[future]
        if results:
            yield results
        dead = [future for future in running if future in finished]
        if dead:
            suspects.update((number, 0) for future in running for number, _ in running[future])
            return


def _submitted(study: Study, pool: Engine, chunk: Chunk, ended: SimpleQueue[Future]) -> Future:
    """Return the future of a chunk, which is put into the queue of those that have ended. Ctrl-C
    while futures wait for one another would leave their locks held, and the workers without end."""
    with interrupts_deferred():
        future = pool.executor.submit(run_chunk, study.model, chunk)
        future.add_done_callback(ended.put)
    return future


def _one_by_one(
    study: Study, pool: Engine, suspects: dict[int, int]
) -> Iterator[dict[int, Result]]:
    """The suspects, one at a time: the one during which a worker dies again is at fault."""
    while suspects:
        number = next(iter(suspects))
        chunk = [(number, study.design.values(number))]
        ended: SimpleQueue[Future] = SimpleQueue()
        _submitted(study, pool, chunk, ended)
        future = ended.get()
        if isinstance(_error_of(future), worker_errors()):
            suspects[number] += 1
            if suspects[number] >= _WORKER_DEATHS:
                del suspects[number]
                yield {number: Result(f"{FAILED}the process that ran it died", {})}
            return
        del suspects[number]
        yield future.result().results


def _error_of(future: Future) -> BaseException | None:
    """Return the error of a chunk, or of its worker; raises `RunFailed` for one of no run."""
    try:
        error = future.exception()
    except CancelledError:
        raise RunFailed(f"the scheduler was lost; {_WRITTEN}") from None
    if error is None or isinstance(error, worker_errors()):
        return error
    reason = f"{type(error).__name__}: {error}"
    raise RunFailed(f"a worker cannot run anything: {reason}; {_WRITTEN}") from error
