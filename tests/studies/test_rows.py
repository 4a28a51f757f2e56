"""Rows of a study: each once, whatever stopped the calls that made them."""

import contextlib
import errno
import random
from concurrent.futures import Executor, Future
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu import studies
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.studies import store
from rotor_fmu.studies.executors import Engine
from rotor_fmu.studies.runner import run_study
from rotor_fmu.studies.store import Store

from ..processes import run_anew
from .functions import Ishigami, here, ishigami_study, one_by_one, quiet, study_text


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
