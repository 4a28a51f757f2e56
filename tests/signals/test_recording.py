import numpy as np
import pytest
from rotor_fmu.model.time_loop.recorder import Record

from rotor_fmu.errors import InputError
from rotor_fmu.runs.job import prepare
from rotor_fmu.runs.recording import Recording, load_recording
from rotor_fmu.runs.run_down import run_direct, run_recorded, usual


def test_a_recording_comes_back_from_its_file_as_it_was(tmp_path):
    t = np.linspace(0.0, 1.0, 7)
    given = Recording(t, {"phi": t**2, "w": 2 * t}, {"phi": "rad", "w": "rad/s"}, {"status": "ok"})
    given.save(tmp_path / "recording.npz")
    result = load_recording(tmp_path / "recording.npz")
    assert np.array_equal(result.t, t)
    assert list(result.columns) == ["phi", "w"]
    assert np.array_equal(result.columns["phi"], t**2)
    assert (result.units, result.about) == (given.units, given.about)
    assert [path.name for path in tmp_path.iterdir()] == ["recording.npz"]


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04 cut short"])
def test_another_file_is_refused_by_its_name(tmp_path, content):
    path = tmp_path / "summary.npz"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"summary\.npz: is not a recording"):
        load_recording(path)


def test_a_recorded_run_is_the_run():
    job = prepare(None, None, ["speed=185"], None, 0.5, 0.02)
    bare = run_direct(job)
    run, recording = run_recorded(job)
    assert np.array_equal(run.t, bare.t)
    assert all(np.array_equal(run.columns[name], bare.columns[name]) for name in bare.columns)
    assert list(recording.columns) == list(usual(job.rotor))
    assert recording.units["disc[3].vx"] == "m/s"
    assert recording.about["status"] == run.status == "ok"


def test_a_recording_goes_through_the_communication_points():
    job = prepare(None, "robust", ["speed=185"], None, 0.5, 0.02)
    run, recording = run_recorded(job, Record(("disc[3].x", "bearing[2].fn"), 0.0))
    assert list(recording.columns) == ["phi", "w", "disc[3].x", "bearing[2].fn"]
    assert len(recording.t) == run.columns["solver.steps"][-1] + 1
    at = np.searchsorted(recording.t, run.t)
    assert np.array_equal(recording.t[at], run.t)
    for name, column in recording.columns.items():
        assert np.array_equal(column[at], run.columns[name])


def test_a_run_that_fails_is_recorded_until_then():
    job = prepare(None, "paper", ["solver.method=wbz", "solver.alpha_m=0.08"], None, 5.0, 0.1)
    run, recording = run_recorded(job)
    assert run.status.startswith("failed")
    assert run.t[-1] < recording.t[-1] <= run.t[-1] + 0.1
    assert recording.about["status"] == run.status


@pytest.mark.parametrize("stop", [1e-6, 0.5])
def test_a_recording_ends_where_its_run_does(stop):
    job = prepare(None, None, ["speed=185"], None, stop, None)
    run, recording = run_recorded(job, Record(("disc[3].x", "disc[3].vx", "energy.friction_loss")))
    assert recording.t[0] == 0 < np.diff(recording.t).min()
    assert recording.t[-1] == run.t[-1] == stop
    for name in ("phi", "disc[3].x", "energy.friction_loss"):
        assert recording.columns[name][-1] == run.columns[name][-1]
    every = run_recorded(job, Record(("disc[3].vx",), 0.0))[1]
    assert recording.columns["disc[3].vx"][-1] == every.columns["disc[3].vx"][-1]


def test_a_recording_holds_the_loads_of_its_run_until_its_end(tmp_path):
    file = tmp_path / "loads.csv"
    file.write_text("time,speed,disc[1].fx,disc[2].fx\n0,200,0,0\n0.1,199,30,0\n1,190,-60,0\n")
    _, recording = run_recorded(prepare(None, None, ["disc[2].fy=-5"], file, 0.2, 0.02))
    loads = recording.about["loads"]
    assert loads.pop("disc[1].fx") == pytest.approx([0.0, 30.0])
    assert loads == {"disc[2].fy": [-5.0, -5.0]}
