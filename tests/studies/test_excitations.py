"""Every kind of run of a machine takes it through the speeds and kicks that its table says."""

import math

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig_toml
from scipy.signal import lsim

from rotor_fmu import studies
from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.studies.runner import run_study

from .functions import here, quiet

JEFFCOTT = 'machine = "jeffcott_rub/jeffcott.toml"\n'
DRIVE_TRAIN = 'module = "rotor_fmu.examples.drive_train.study"\n'
COMPRESSOR = 'machine = "drop/compressor.toml"\n'
# head, [run], an output and its value at the end
RUNS = {
    "run-up": (JEFFCOTT, "from = 50\nto = 60\nrate = 100", "w", 60.0),
    "run-down": (JEFFCOTT, "from = 60\nto = 50\nrate = 100", "w", 50.0),
    "up-and-down": (JEFFCOTT, "from = 50\nto = 60\nrate = 100\nstep = 1e-3", "w", 50.0),
    "constant": (JEFFCOTT, "speed = 50\nsettle = 0\nturns = 1", "w", 50.0),
    "steps": (JEFFCOTT, "from = 50\nto = 60\ncount = 2\nsettle = 0\nturns = 1", "w", 60.0),
    "signals": (JEFFCOTT, 'file = "speed.csv"\nstop = 0.1', "w", 52.0),
    # free fall for 5 ms: g t^2 / 2
    "drop": (COMPRESSOR, "speed = 100\nstop = 5e-3", "touchdown_bearing[1].y", -1.226e-4),
    "motor": ("", "torque = 5\ntarget = 20\nramp = 100\nstop = 1\nfrom = 10", "w", 20.0),
    "drive-train": (
        DRIVE_TRAIN,
        "torque = 5\ntarget = 20\nramp = 20\nstop = 3\nfrom = 10",
        "w",
        20.0,
    ),
}


@pytest.mark.parametrize("kind", RUNS)
def test_every_kind_of_run_ends_where_it_is_told_to(tmp_path, kind):
    head, run, output, end = RUNS[kind]
    (tmp_path / "speed.csv").write_text("time,speed\n0,50\n1,70\n")
    path = tmp_path / "study.toml"
    path.write_text(
        f'{head}[run]\nkind = "{kind}"\n{run}\n[vary]\n"solver.tolerance" = {{ values = [1e-3] }}\n'
        f'[keep]\nend = {{ last = "{output}" }}\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    assert data.status.values.tolist() == ["ok"]
    assert float(data.end.values.ravel()[-1]) == pytest.approx(end, rel=2e-2)


@pytest.mark.parametrize(
    ("kind", "expected"),
    [
        ("run-down", {"from": 130.0, "to": 0.0, "rate": 4.0}),
        ("run-up", {"from": 0.0, "to": 110.0, "rate": 3.0}),
        ("up-and-down", {"from": 0.0, "to": 110.0, "rate": 3.0}),
        ("motor", {"target": 90.0, "ramp": 3.0}),
        ("drive-train", {"target": 90.0, "ramp": 3.0}),
    ],
)
def test_a_run_is_that_of_the_machines_own_speeds(tmp_path, kind, expected):
    (tmp_path / "machine.toml").write_text(
        rig_toml().partition("[operation]")[0]
        + "[operation]\nrated_speed = 90.0\nmaximum_continuous_speed = 110.0\ntrip_speed = 130.0\n"
        + "run_up_rate = 3.0\nrun_down_rate = 4.0\n\n[material]"
        + rig_toml().partition("[material]")[2]
    )
    path = tmp_path / "study.toml"
    needed = "torque = 1\nstop = 1\n" if "target" in expected else ""
    head = DRIVE_TRAIN if kind == "drive-train" else ""
    path.write_text(
        f'{head}machine = "machine.toml"\n[run]\nkind = "{kind}"\n{needed}'
        '[vary]\n"solver.tolerance" = { values = [1e-3] }\n[keep]\nend = { last = "w" }\n'
    )
    numbers = read_study(path).model.how.numbers
    assert {name: numbers[name] for name in expected} == expected


def test_loads_of_a_file_are_linear_between_its_points_whatever_the_step(tmp_path):
    """Of which the longest holds almost three periods; SciPy's exact answer of a linear system."""
    t = np.linspace(0.0, 0.2, 201)
    lines = [f"{a!r},10,{5 * math.sin(300 * a)!r}\n" for a in t.tolist()]
    (tmp_path / "loads.csv").write_text("time,speed,disc.fx\n" + "".join(lines))
    path = tmp_path / "study.toml"
    path.write_text(
        'machine = "studies/whip.toml"\n[run]\nkind = "signals"\nfile = "loads.csv"\nstop = 0.2\n'
        '[set]\n"solver.tolerance" = 1e-5\n[vary]\n"run.step" = { values = [0.06, 4e-3, 5e-4] }\n'
        '[keep]\nx = { last = "disc.x" }\npeak = { peak = "disc.x" }\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    assert data.status.values.tolist() == ["ok"] * 3
    grid = np.linspace(0.0, 0.2, 20_001)
    _, x, _ = lsim(([1.0], [1.0, 10.0, 1e4]), np.interp(grid, t, 5 * np.sin(300 * t)), grid)
    largest = np.abs(x).max()
    assert data.peak.values == pytest.approx([largest] * 3, rel=1e-3)
    assert data.x.values == pytest.approx([x[-1]] * 3, abs=1e-3 * largest)


@pytest.mark.parametrize("target", [15.0, 5.0, -15.0])
def test_a_motor_follows_its_ramp_to_a_higher_a_lower_and_a_reversed_speed(tmp_path, target):
    path = tmp_path / "study.toml"
    path.write_text(
        f'[run]\nkind = "motor"\ntorque = 5\nfrom = 10\ntarget = {target}\nramp = 20\ngain = 5\n'
        'stop = 1.5\n[vary]\n"solver.tolerance" = { values = [1e-2] }\n[keep]\nw = { last = "w" }\n'
    )
    seen = read_study(path).model.record({})
    ramp = np.interp(seen.t, [0.0, abs(target - 10.0) / 20.0], [10.0, target])
    assert seen.columns["w"] == pytest.approx(ramp, abs=0.2)


@pytest.mark.parametrize("way", ["run-up", "up-and-down"])
def test_the_speed_of_a_ramp_goes_on_during_a_kick(tmp_path, way):
    path = tmp_path / "study.toml"
    path.write_text(
        f'machine = "studies/whip.toml"\n[run]\nkind = "{way}"\nfrom = 10\nto = 20\nrate = 20\n'
        'kick = { port = "disc", force = 1, rate = 100, duration = 0.25 }\n'
        '[vary]\n"contact[1].mu" = { values = [0.1] }\n[keep]\nx = { peak = "disc.x" }\n'
    )
    seen = read_study(path).model.record({})
    assert seen.columns["w"] == pytest.approx(20 - 20 * np.abs(seen.t - 0.5))
    assert np.abs(seen.columns["disc.x"]).max() > 1e-4


@pytest.mark.parametrize(
    ("run", "expected"),
    [
        ("run-up\nfrom = 10\nto = 20\nrate = 100", "kick duration = 0.1 s: must be below the 0.1"),
        ("drop\nspeed = 10\nstop = 1", "run drop: has no kick"),
        ("motor\ntorque = 1\nstop = 1", "run motor: has no kick"),
    ],
)
def test_a_kick_that_a_run_does_not_have_is_refused(tmp_path, run, expected):
    path = tmp_path / "study.toml"
    kind, _, numbers = run.partition("\n")
    path.write_text(
        f'machine = "studies/whip.toml"\n[run]\nkind = "{kind}"\n{numbers}\n'
        'kick = { port = "disc", force = 1, rate = 1, duration = 0.1 }\n'
        '[vary]\n"contact[1].mu" = { values = [0.1] }\n[keep]\nx = { peak = "disc.x" }\n'
    )
    with pytest.raises(InputError, match=expected):
        read_study(path)


@pytest.mark.parametrize("rate", [0.0, 200.0, -200.0])
def test_a_kick_moves_the_rotor_that_would_rest_and_turns_as_it_is_told_to(tmp_path, rate):
    """A force F exp(i rate t) on 1 kg for 1 ms, then a swing of 100 rad/s until 10 ms after."""
    path = tmp_path / "study.toml"
    path.write_text(
        'machine = "studies/whip.toml"\n[run]\nkind = "constant"\nspeed = 10\n'
        "settle = 0\nmeasure = 0.01\n"
        f'kick = {{ port = "disc", force = 5.0, rate = {rate}, duration = 0.001 }}\n'
        '[vary]\n"contact[1].mu" = { values = [0.1] }\n'
        '[keep]\nx = { last = "disc.x" }\ny = { last = "disc.y" }\n'
    )
    run_study(read_study(path), tmp_path / "out", here, quiet)
    data = studies.open(tmp_path / "out")
    impulse = 5e-3 * np.exp(0.5e-3j * rate)
    expected = impulse / 100 * math.sin(100 * 10.5e-3) * math.exp(-5 * 10.5e-3)
    assert complex(data.x.values[0], data.y.values[0]) == pytest.approx(expected, rel=0.03)
    pushed = read_study(path).model.record({}).about["loads"]
    assert pushed == {"disc.fx": [-5.0, 5.0], "disc.fy": [-5.0, 5.0]}
