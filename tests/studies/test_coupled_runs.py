"""Rows that come through two FMUs: the rotor's and the drive train's."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.examples.drive_train.study import COUPLING, NUMBERS, fmus
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu import studies
from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.runs.recording import load_recording
from rotor_fmu.studies.executors import ExecutorConfig, engine
from rotor_fmu.studies.runner import run_study

from .functions import conducted, here, quiet

STUDY = """
module = "rotor_fmu.examples.drive_train.study"
[run]
kind = "drive-train"
torque = 0.2
from = 180
target = 200
stop = 1
[set]
"solver.tolerance" = 1e-3
[vary]
"run.torque" = { values = [0.05, 0.1] }
[keep]
w = { last = "w" }
X = { peak = "disc[3].x_amp" }
work = { last = "drive.work_out" }
taken = { last = "energy.drive_work" }
"""


@pytest.fixture(scope="module")
def coupled(tmp_path_factory):
    """A study's file, its folder and its rows."""
    folder = tmp_path_factory.mktemp("coupled")
    return conducted(STUDY, folder)


def test_a_row_is_what_both_fmus_say_coupled_by_themselves(coupled):
    _, _, data = coupled
    assert (data.status.values == "ok").all()
    for i, torque in enumerate((0.05, 0.1)):
        parameters = {"w_start": 180.0, "w_target": 200.0, "tau_max": torque, "continuation": 1.0}
        run = COUPLING.run(
            dict(zip(("partner", "rotor"), fmus(rig_toml()), strict=True)),
            stop=1.0,
            step=2e-3,
            parameters={"partner": parameters, "rotor": {"solver.tolerance": 1e-3}},
            recorded={"partner": ["work_out"], "rotor": ["disc[3].x_amp"]},
        )
        # between two communication points the rotor goes on with the speed that it was given
        assert data.w.values[i] == pytest.approx(run["partner"]["w"][-1], abs=0.01)
        assert data.work.values[i] == run["partner"]["work_out"][-1]
        assert data.X.values[i] == np.abs(run["rotor"]["disc[3].x_amp"]).max()
        assert data.taken.values[i] == pytest.approx(data.work.values[i], rel=1e-3)


@pytest.mark.slow
def test_two_processes_make_the_same_coupled_rows_bit_for_bit(coupled, tmp_path):
    path, _, data = coupled
    run_study(read_study(path), tmp_path, partial(engine, ExecutorConfig(jobs=2)), quiet)
    assert studies.open(tmp_path).identical(data)


def test_a_run_after_the_first_loads_no_library_anew(coupled):
    maps = Path("/proc/self/maps")
    if not maps.exists():
        pytest.skip("what is loaded is read from /proc")
    model = read_study(coupled[0]).model

    def loaded():
        return {line.split()[-1] for line in maps.read_text().splitlines() if ".so" in line}

    model.warm()
    before = loaded()
    assert sum("DriveTrain" in name for name in before) == 1
    model.warm()
    assert loaded() == before


def test_a_selected_coupled_run_ends_as_its_row_and_has_both_fmus_signals(coupled, process):
    path, out, data = coupled
    assert process("study", str(path), "--out", str(out), "--select", "1").returncode == 0
    recording = load_recording(out / "runs" / str(data.id.values[1]) / "recording.npz")
    assert recording.columns["w"][-1] == data.w.values[1]
    assert recording.columns["drive.work_out"][-1] == data.work.values[1]
    assert {"phi", "disc[3].x", "bearing[1].fn", "drive.tau_motor"} <= set(recording.columns)
    assert recording.units["drive.tau_motor"] == "N.m"
    assert recording.about["run"]["torque"] == 0.1


def test_values_that_an_fmu_refuses_are_a_failed_row_with_its_own_words(tmp_path):
    law = 'distribution = "normal", mean = -1e-6, std = 1e-8'
    path = tmp_path / "study.toml"
    path.write_text(
        STUDY.replace('"run.torque" = { values = [0.05, 0.1] }', f'"bearing[1].mu" = {{ {law} }}')
        + '[design]\nkind = "random"\nsize = 1\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    (status,) = studies.open(tmp_path / "out").status.values
    assert status.startswith("failed: rotor: RotorBearing.fmu: ")
    assert "bearing[1].mu = " in status


@pytest.mark.parametrize(
    ("kind", "keep"),
    [
        ("dissipated", '{ dissipated = "bearing[1]" }'),
        ("contact", '{ contact = "bearing[1]" }'),
        ("whirl", '{ whirl = "disc[3]" }'),
        ("order with speed", '{ order = 1, speed = 100, of = "disc[3].x" }'),
    ],
)
def test_what_lies_between_communication_points_is_not_kept(tmp_path, kind, keep):
    path = tmp_path / "study.toml"
    path.write_text(f"{STUDY}q = {keep}\n")
    with pytest.raises(InputError, match=rf"keep q: {kind} needs the solver's own steps"):
        read_study(path)


def test_the_usual_drive_train_of_a_study_of_the_rig_is_that_of_its_fmu(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(STUDY.replace("target = 200\n", ""))
    numbers = read_study(path).model.how.numbers
    usual = {v.name: v.start for v in COUPLING.variables}
    for name, number in NUMBERS.items():
        if number not in ("torque", "from"):
            assert numbers[number] == usual[name], name
