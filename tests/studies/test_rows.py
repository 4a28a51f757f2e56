"""Rows of a study: each once, whatever stopped the calls that made them."""

import contextlib
import errno
import multiprocessing
import os
import random
import signal
import subprocess
import sys
import time
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu import studies
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.studies import store
from rotor_fmu.studies.executors import Engine, ExecutorConfig, engine
from rotor_fmu.studies.runner import run_study
from rotor_fmu.studies.store import Store

from ..processes import run_anew
from .functions import Ishigami, here, ishigami_study, one_by_one, quiet, study_text


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """A study, and its rows made in one go."""
    folder = tmp_path_factory.mktemp("undisturbed")
    study = ishigami_study(folder)
    run_study(study, folder / "out", here, quiet)
    return study, studies.open(folder / "out")


def test_rows_are_those_of_the_function_in_the_order_of_the_runs(undisturbed):
    study, data = undisturbed
    assert data.run.values.tolist() == list(range(80)) == list(range(len(study.design)))
    x1, x2, x3 = (data[name].values for name in ("x1", "x2", "x3"))
    exact = np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)
    assert data.y.values == pytest.approx(exact, rel=1e-14)
    assert (data.curve.sel(beside=0.0).values == data.y.values).all()
    assert len(set(data.id.values)) == len(set(zip(x1, x2, x3, strict=True)))


class Killed(BaseException):
    """What no handler expects."""


def test_a_call_that_dies_at_any_moment_leaves_rows_that_the_next_one_goes_on_from(
    undisturbed, tmp_path, monkeypatch
):
    study, data = undisturbed
    chance = random.Random(5)
    whole, replace = store.write_part, Path.replace

    def dying_write(table, path):
        whole(table, path)
        if chance.random() < 0.05:
            path.write_bytes(path.read_bytes()[:-9])
            raise Killed

    def dying_replace(self, target):
        moved = replace(self, target)
        if chance.random() < 0.1:
            raise Killed
        return moved

    monkeypatch.setattr(store, "write_part", dying_write)
    monkeypatch.setattr(Path, "replace", dying_replace)
    deaths = 0
    while True:
        try:
            run_study(study, tmp_path / "out", one_by_one, quiet)
        except Killed:
            deaths += 1
            continue
        break
    assert deaths >= 3
    assert studies.open(tmp_path / "out").identical(data)


def test_a_row_that_stands_in_two_parts_counts_once(undisturbed, tmp_path):
    study, data = undisturbed
    run_study(study, tmp_path, here, quiet)
    with Store(tmp_path, study) as again:
        again.write({7: study.model.run(study.design.values(7))})
    assert len(store.parts(tmp_path)) > 1
    assert studies.open(tmp_path).identical(data)


def test_merging_parts_changes_no_row(undisturbed, tmp_path):
    study, data = undisturbed
    with Store(tmp_path, study) as written:
        for number in range(len(study.design)):
            written.write({number: study.model.run(study.design.values(number))})
            written.merge_small(least=9)
    assert len(store.parts(tmp_path)) < 9
    assert studies.open(tmp_path).identical(data)


def test_rows_are_read_while_the_call_at_work_merges_their_parts(
    undisturbed, tmp_path, monkeypatch
):
    study, data = undisturbed
    with Store(tmp_path, study) as written:
        for number in range(len(study.design)):
            written.write({number: study.model.run(study.design.values(number))})
        listed = store.parts

        def merging(folder):
            there = listed(folder)
            monkeypatch.setattr(store, "parts", listed)
            written.merge_small(least=2)
            return there

        for read in (studies.open, lambda _: written.done()):
            monkeypatch.setattr(store, "parts", merging)
            found = read(tmp_path)
            assert found.identical(data) if read is studies.open else found.all()
            written.write({0: study.model.run(study.design.values(0))})


def test_a_full_disk_is_said_in_one_line_and_loses_no_row_that_was_written(
    undisturbed, tmp_path, monkeypatch
):
    study, data = undisturbed
    whole, written = store.write_part, []

    def full(table, path):
        if len(written) == 5:
            path.write_bytes(b"half")
            raise OSError(errno.ENOSPC, "No space left on device")
        written.append(table.num_rows)
        whole(table, path)

    monkeypatch.setattr(store, "write_part", full)
    with pytest.raises(RunFailed, match="cannot be written to: No space left on device; what was"):
        run_study(study, tmp_path, one_by_one, quiet)
    assert studies.open(tmp_path).sizes["run"] == sum(written)
    assert not list(tmp_path.rglob("*.unfinished"))
    monkeypatch.setattr(store, "write_part", whole)
    assert run_study(study, tmp_path, one_by_one, quiet).before == sum(written)
    assert studies.open(tmp_path).identical(data)


def cancel(future):
    """As Dask does with what it has lost."""
    future.cancel()
    future.set_running_or_notify_cancel()


@pytest.mark.parametrize(
    ("end", "expected"),
    [
        (cancel, "the scheduler was lost; rows written before are whole"),
        (
            lambda future: future.set_exception(ModuleNotFoundError("No module named 'rotor_fmu'")),
            "a worker cannot run anything: ModuleNotFoundError: No module named 'rotor_fmu'; rows",
        ),
    ],
)
def test_an_engine_that_is_lost_is_said_in_one_line(undisturbed, tmp_path, end, expected):
    study, _ = undisturbed

    class Lost(Executor):
        def submit(self, fn, /, *arguments, **named):
            future = Future()
            end(future)
            return future

    @contextlib.contextmanager
    def lost():
        yield Engine(Lost(), 1, 1.0)

    with pytest.raises(RunFailed, match=expected):
        run_study(study, tmp_path, lost, quiet)


def test_a_run_that_fails_is_a_row_with_its_reason(tmp_path):
    study = ishigami_study(tmp_path, Ishigami(fails_above=2.0))
    progress = run_study(study, tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    too_large = data.x1.values > 2.0
    assert progress.failed == too_large.sum() > 0
    assert (data.status.values[~too_large] == "ok").all()
    for status in data.status.values[too_large]:
        assert status.startswith("failed: ValueError: x1 = ")
    assert np.isnan(data.y.values).tolist() == too_large.tolist()
    assert np.isnan(data.curve.values).any(axis=1).tolist() == too_large.tolist()


def test_a_folder_of_another_study_is_refused_and_left_alone(undisturbed, tmp_path):
    study, _ = undisturbed
    run_study(study, tmp_path / "out", here, quiet)
    before = {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")}
    other = ishigami_study(tmp_path, text=study_text(size=32))
    with pytest.raises(InputError, match="holds another study, 'study'"):
        run_study(other, tmp_path / "out", here, quiet)
    assert {path: path.stat().st_mtime_ns for path in (tmp_path / "out").rglob("*")} == before


def test_a_damaged_file_of_a_study_is_named(undisturbed, tmp_path):
    study, data = undisturbed
    run_study(study, tmp_path, here, quiet)
    (part,) = store.parts(tmp_path)
    part.write_bytes(part.read_bytes()[:300])
    for reads in (studies.open, lambda folder: run_study(study, folder, here, quiet)):
        with pytest.raises(InputError, match=f"{part.name}: is damaged"):
            reads(tmp_path)
    part.unlink()
    run_study(study, tmp_path, here, quiet)
    assert studies.open(tmp_path).identical(data)
    (tmp_path / "study.json").write_text("[]")
    with pytest.raises(InputError, match=r"its study\.json is that of no study"):
        studies.open(tmp_path)


def test_two_calls_are_not_at_work_in_one_folder(undisturbed, tmp_path):
    study, _ = undisturbed
    with (
        Store(tmp_path, study),
        pytest.raises(InputError, match="another call is at work"),
        Store(tmp_path, study),
    ):
        pass


def test_a_pool_of_processes_makes_the_same_rows_bit_for_bit(undisturbed, tmp_path):
    study, data = undisturbed
    run_study(study, tmp_path, partial(engine, ExecutorConfig(jobs=2)), quiet)
    assert studies.open(tmp_path).identical(data)


@pytest.mark.slow
def test_a_local_cluster_of_two_makes_the_same_rows_bit_for_bit(undisturbed, tmp_path):
    study, data = undisturbed
    run_study(study, tmp_path, partial(engine, ExecutorConfig(cluster=2)), quiet)
    assert studies.open(tmp_path).identical(data)


def test_ctrl_c_ends_no_worker_that_has_just_been_started():
    with engine(ExecutorConfig(1)) as made:
        theirs = made.executor.submit(signal.getsignal, signal.SIGINT)
        for process in multiprocessing.active_children():
            os.kill(process.pid, signal.SIGINT)
        assert theirs.result() == signal.SIG_IGN


def test_processes_may_be_started_in_any_thread():
    with engine(ExecutorConfig(1)) as made, ThreadPoolExecutor(1) as threads:
        assert threads.submit(made.executor.submit, os.getppid).result().result() == os.getpid()


@pytest.mark.slow
def test_workers_of_a_local_cluster_leave_ctrl_c_to_the_call():
    before = signal.getsignal(signal.SIGINT)
    with engine(ExecutorConfig(cluster=1)) as made:
        theirs = made.executor.submit(signal.getsignal, signal.SIGINT).result()
        assert signal.getsignal(signal.SIGINT) == before
    assert theirs == signal.SIG_IGN


@pytest.mark.slow
def test_a_scheduler_at_an_address_shares_the_work_out(undisturbed, tmp_path):
    distributed = pytest.importorskip("distributed", reason="the extra cluster is not installed")
    study, data = undisturbed
    with distributed.LocalCluster(1, threads_per_worker=1, dashboard_address=None) as cluster:
        where = ExecutorConfig(scheduler=cluster.scheduler_address)
        run_study(study, tmp_path, partial(engine, where), quiet)
    assert studies.open(tmp_path).identical(data)


@pytest.mark.slow
def test_ctrl_c_ends_a_call_with_its_workers_and_its_rows_stay(undisturbed, tmp_path):
    _, data = undisturbed
    process = started(tmp_path)
    while "now=0" in process.stdout.readline():
        pass
    process.send_signal(signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode != 0
    stored = studies.open(tmp_path / "out")
    assert 0 < stored.sizes["run"] < data.sizes["run"]
    assert (stored.y.values == data.y.sel(run=stored.run).values).all()


@pytest.mark.slow
def test_a_run_that_kills_its_process_is_a_row_and_takes_no_other_with_it(tmp_path):
    text = study_text("latin-hypercube", 9)
    study = ishigami_study(tmp_path, Ishigami(deadly_above=2.45), text)
    run_study(study, tmp_path / "out", partial(engine, ExecutorConfig(jobs=1)), quiet)
    data = studies.open(tmp_path / "out")
    deadly = data.x1.values > 2.45
    assert deadly.sum() == 1
    assert (data.status.values[~deadly] == "ok").all()
    assert set(data.status.values[deadly]) == {"failed: the process that ran it died"}


ALONE = """
import sys
from concurrent.futures import Executor, Future
from functools import partial
from pathlib import Path
from rotor_fmu.studies.runner import run_study
from rotor_fmu.studies.executors import ExecutorConfig, engine
from tests.studies.functions import Ishigami, ishigami_study
if __name__ == "__main__":
    folder = Path(sys.argv[1])
    study = ishigami_study(folder, Ishigami(pause=0.05))
    shared = partial(engine, ExecutorConfig(jobs=2))
    run_study(study, folder / "out", shared, lambda p: print(p, flush=True))
"""


def started(folder):
    """A call in a process of its own, which says its progress."""
    script = folder / "alone.py"
    script.write_text(ALONE)
    root = Path(__file__).parents[2]
    return subprocess.Popen(
        [sys.executable, str(script), str(folder)],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        cwd=root,
        env={**os.environ, "PYTHONPATH": str(root)},
        text=True,
    )


@pytest.mark.slow
def test_killed_ten_times_at_random_moments_the_rows_are_those_of_an_undisturbed_call(
    undisturbed, tmp_path
):
    _, data = undisturbed
    chance, counts = random.Random(11), []
    for _ in range(10):
        process = started(tmp_path)
        process.stdout.readline()  # it has begun
        time.sleep(chance.uniform(0.0, 3.0))
        process.kill()
        process.communicate()
        assert process.returncode in (-signal.SIGKILL, 0)
        rows = store.parts(tmp_path / "out")
        counts.append(studies.open(tmp_path / "out").sizes["run"] if rows else 0)
    assert counts == sorted(counts)
    process = started(tmp_path)
    process.communicate(timeout=120)
    assert process.returncode == 0
    assert studies.open(tmp_path / "out").identical(data)


@pytest.mark.slow
def test_a_hundred_thousand_rows_are_made_and_opened_in_little_memory(tmp_path):
    script = """
import sys
from pathlib import Path
from tests.studies.functions import here, ishigami_study, one_by_one, quiet, study_text
from rotor_fmu.studies.runner import run_study
study = ishigami_study(Path(sys.argv[1]), text=study_text("random", 100_000))
run_study(study, Path(sys.argv[1]) / "out", here, quiet)
print(next(x for x in open("/proc/self/status") if x.startswith("VmHWM")).split()[1])
"""
    if not Path("/proc/self/status").exists():
        pytest.skip("memory is read from /proc")
    done = run_anew(script, tmp_path, cwd=Path(__file__).parents[2])
    assert done.returncode == 0, done.stderr
    assert int(done.stdout.split()[-1]) < 500 * 1024
    assert studies.open(tmp_path / "out").sizes["run"] == 100_000
