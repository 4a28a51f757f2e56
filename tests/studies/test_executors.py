"""Runs of a study in other processes: the same rows, whatever ends the processes."""

import os
import pickle
import random
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from functools import partial
from pathlib import Path

import pytest

from rotor_fmu import studies
from rotor_fmu.machine_studies import response_runs, run_metrics
from rotor_fmu.studies import store
from rotor_fmu.studies.executors import ExecutorConfig, engine
from rotor_fmu.studies.runner import run_study

from .functions import Ishigami, ishigami_study, quiet, study_text


def test_a_pool_of_processes_makes_the_same_rows_bit_for_bit(undisturbed, tmp_path):
    study, data = undisturbed
    run_study(study, tmp_path, partial(engine, ExecutorConfig(jobs=2)), quiet)
    assert studies.open(tmp_path).identical(data)


@pytest.mark.parametrize("table", [run_metrics, response_runs])
def test_every_kind_of_metric_can_be_sent_to_a_worker(table):
    for name, kind in table.KINDS.items():
        assert pickle.loads(pickle.dumps(kind)) == kind, name


@pytest.mark.slow
def test_a_local_cluster_of_two_makes_the_same_rows_bit_for_bit(undisturbed, tmp_path):
    study, data = undisturbed
    run_study(study, tmp_path, partial(engine, ExecutorConfig(cluster=2)), quiet)
    assert studies.open(tmp_path).identical(data)


def test_ctrl_c_ends_no_worker_that_has_just_been_started():
    with engine(ExecutorConfig(1)) as made:
        theirs = made.executor.submit(signal.getsignal, signal.SIGINT)
        for worker in made.executor._processes:  # other tests have children too
            os.kill(worker, signal.SIGINT)
        assert theirs.result() == signal.SIG_IGN


def test_ctrl_c_while_a_worker_is_started_is_not_lost(monkeypatch):
    # one sent to the process may come to another thread, and to this one only later
    here = threading.get_ident()
    monkeypatch.setattr(
        ProcessPoolExecutor, "submit", lambda *_: signal.pthread_kill(here, signal.SIGINT)
    )
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may ignore it
    try:
        with engine(ExecutorConfig(1)) as made, pytest.raises(KeyboardInterrupt):
            made.executor.submit(os.getpid)
    finally:
        signal.signal(signal.SIGINT, before)


def test_processes_may_be_started_in_any_thread():
    with engine(ExecutorConfig(1)) as made, ThreadPoolExecutor(1) as threads:
        assert threads.submit(made.executor.submit, os.getppid).result().result() == os.getpid()


@pytest.mark.slow
def test_workers_of_a_local_cluster_leave_ctrl_c_to_the_call():
    with engine(ExecutorConfig(cluster=1)) as made:
        assert signal.SIGINT not in signal.pthread_sigmask(signal.SIG_BLOCK, ())
        theirs = made.executor.submit(signal.pthread_sigmask, signal.SIG_BLOCK, ()).result()
    assert signal.SIGINT in theirs


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
