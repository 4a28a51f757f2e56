"""The command run-down: what a run writes and says, and how it ends."""

import json
import math
import signal
import subprocess
import sys

import fmpy
import pytest
from rotor_fmu.model.machine.toml import rig_toml

import rotor_fmu as rf
from rotor_fmu.api.simulate import plan
from rotor_fmu.runs import job as jobs

from ..processes import interrupted


def test_a_run_writes_its_figures_and_pictures(process, tmp_path):
    done = process(
        *("run-down", "--preset", "paper-adaptive", "--stop", "4", "--direct", "--out", "here")
    )
    assert done.returncode == 0, done.stderr
    figures = json.loads((tmp_path / "here" / "summary.json").read_text())
    assert set(figures) >= {
        *("x_peak_um", "x_peak_hz", "y_peak_um", "y_peak_hz", "y_static_um"),
        *("psi_at_x_peak_deg", "circulation_hz", "steps", "rejected", "newton_per_step"),
        *("h_min", "h_max", "h_last", "wall_s", "energy_residual", "status"),
    }
    assert figures["status"] == "doubtful: too-coarse-in-contact"
    written = {path.name for path in (tmp_path / "here").iterdir()}
    pictures = {f"run_down_{name}.png" for name in ("x", "y", "psi", "orbit", "error", "h")}
    assert written == pictures | {"summary.json", "run_down.csv", "recording.npz", "report.html"}
    rows = (tmp_path / "here" / "run_down.csv").read_text().splitlines()
    head = "time [s],phi [rad],w [rad/s],a [rad/s2],tau [N.m],tau_load [N.m],J [kg.m2],"
    assert rows[0].startswith(f"{head}tau_wave [N.m],step_work [J],")
    assert len(rows) == 1 + 101


def test_a_machine_that_turns_in_less_than_the_usual_step_has_a_row_a_turn():
    fast = rf.parse(rig_toml().replace("rated_speed = 400.0", "rated_speed = 4e4"))
    for machine, stop, expected in (
        (rf.load(), 40.0, 0.004),
        (fast, 0.4, math.tau / 4e4),
        (fast, 20.0, 0.002),
        (fast, 400.0, 0.004),
    ):
        assert plan(machine, 100.0, None, stop, None, None, None, None).step == expected


def test_a_run_at_one_speed_is_drawn_over_time_and_frequency_and_replaces_an_earlier_one(
    process, tmp_path
):
    (tmp_path / "run_down_x.png").write_bytes(b"of an earlier run")
    done = process(
        *("run-down", "--set", "speed=185", "--preset", "robust", "--stop", "1"),
        *("--direct", "--out", "."),
    )
    assert done.returncode == 0, done.stderr
    assert "No peak, because the speed is constant; disc 2 moved by at most " in done.stdout
    assert "open report.html" in done.stdout
    pictures = {f"run_down_{name}.png" for name in ("time", "spectrum", "orbit")}
    written = {path.name for path in tmp_path.iterdir()}
    assert written == pictures | {"summary.json", "run_down.csv", "recording.npz", "report.html"}


def test_a_run_that_diverges_ends_with_status_1_and_a_reason(process, tmp_path):
    done = process(
        *("run-down", "--preset", "paper", "--set", "solver.method=wbz"),
        *("--set", "solver.alpha_m=0.08", "--direct", "--out", "."),
    )
    assert done.returncode == 1
    assert "diverged" in done.stderr
    assert json.loads((tmp_path / "summary.json").read_text())["status"].startswith("failed")


@pytest.mark.parametrize(("how", "level"), [([], "warning"), (["--direct"], "note")])
def test_a_setting_without_effect_is_said(process, tmp_path, how, level):
    done = process(
        *("run-down", "--preset", "robust", "--set", "solver.tolerance=1e-4"),
        *("--stop", "0.01", "--out", ".", *how),
    )
    assert done.returncode == 0, done.stderr
    sentence = "solver.tolerance = 0.0001: has no effect in the mode fixed"
    assert done.stderr.count(sentence) == done.stderr.count(f"{level}: {sentence}") == 1
    assert sentence in json.loads((tmp_path / "summary.json").read_text())["messages"]


@pytest.mark.parametrize("order", [1, -1])
def test_parameters_that_go_together_are_taken_together(process, tmp_path, order):
    sets = ["shaft.eta_h=0.01", "shaft.rotating_damping=true"][::order]
    done = process(
        *("run-down", "--direct", "--stop", "0.01", "--out", "."),
        *(word for text in sets for word in ("--set", text)),
    )
    assert done.returncode == 0, done.stderr


STEPPING = """
from {module} import {name}
step = {name}.{method}
def first(*arguments, **named):
    {name}.{method} = step
    print("running", flush=True)
    return step(*arguments, **named)
{name}.{method} = first
from rotor_fmu.cli import main
main()
"""


@pytest.mark.parametrize(
    ("how", "module", "name", "method"),
    [
        # within a step of the FMU, which test_members stops too
        pytest.param([], "fmpy.fmi2", "FMU2Slave", "doStep", marks=pytest.mark.slow),
        (["--direct"], "rotor_fmu.model.simulation", "Simulation", "advance"),
    ],
)
def test_ctrl_c_ends_a_run_in_one_line_and_leaves_no_results(tmp_path, how, module, name, method):
    """A run of minutes, which says when it takes its first step."""
    script = STEPPING.format(module=module, name=name, method=method)
    process = subprocess.Popen(
        [
            *(sys.executable, "-c", script, "run-down"),
            *("--preset", "robust", "--set", "solver.h=1e-6", "--out", ".", *how),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
    )
    status, said = interrupted(process, lambda: process.stdout.readline() == "running\n")
    assert status == 130, said
    assert "stopped" in said
    assert "Traceback" not in said
    assert not (tmp_path / "summary.json").exists()
    assert not (tmp_path / "run_down.csv").exists()


def test_results_of_an_earlier_run_stay_where_another_one_is_stopped(
    process, monkeypatch, tmp_path
):
    def stopped(*arguments, **named):
        raise KeyboardInterrupt

    (tmp_path / "summary.json").write_text("of an earlier run")
    monkeypatch.setattr(jobs, "execute_recorded", stopped)
    assert process("run-down", "--direct", "--out", ".").returncode == 130
    assert (tmp_path / "summary.json").read_text() == "of an earlier run"


def test_ctrl_c_while_an_fmu_is_instantiated_ends_the_run_in_one_line(process, monkeypatch):
    instantiate = fmpy.instantiate_fmu

    def interrupted(*arguments, **named):
        try:
            signal.raise_signal(signal.SIGINT)  # in this thread, at once
        except KeyboardInterrupt:  # which an FMU in Python makes an error of its own
            raise RuntimeError("Failed to instantiate model") from None
        return instantiate(*arguments, **named)

    monkeypatch.setattr(fmpy, "instantiate_fmu", interrupted)
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell may ignore it
    try:
        done = process("run-down", "--stop", "0.1", "--out", ".")
    finally:
        signal.signal(signal.SIGINT, before)
    assert done.returncode == 130
    assert "stopped" in done.stderr


@pytest.mark.parametrize("limit", [400e-6, pytest.param(600e-6, marks=pytest.mark.slow)])
def test_a_run_that_a_limit_ends_ends_there_with_and_without_the_fmu(process, tmp_path, limit):
    """Also in its first step, of which the FMU leaves no row."""
    done = process(
        *("run-down", "--set", f"limit.displacement={limit}", "--set", "speed=185"),
        *("--stop", "0.1", "--step", "0.05", "--verify", "--out", "."),
    )
    assert "the FMU" not in done.stderr
    assert "The run stopped before its end" in done.stdout
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert "passes limit.displacement" in summary["status"]
    assert summary["recorded_apart"] == 0.0


def test_a_run_with_a_reduced_shaft_drives_an_fmu_that_was_built_with_it(process, tmp_path):
    done = process(
        *("run-down", "--set", "solver.reduction=4", "--set", "speed=150"),
        *("--stop", "0.1", "--out", "."),
    )
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["status"] == "ok"
    assert summary["recorded_apart"] == 0.0
