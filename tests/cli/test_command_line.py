"""The command line: what a user may give, and what happens when it cannot be."""

import re
import runpy
import sys
from pathlib import Path

import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.cli import COMMANDS, _loaded

from ..processes import run_anew

JEFFCOTT = Path(__file__).parents[2] / "examples" / "jeffcott_rub" / "jeffcott.toml"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--preset", "best"], "--preset best: must be one of robust, paper"),
        (["--set", "bearing[1].clearence=1e-5"], "did you mean bearing[1].clearance"),
        (
            ["--set", "solver.mode=fixed"],
            "solver.mode: unknown name; did you mean solver.adaptive?",
        ),
        (["--set", "tolerance=1e-4"], "tolerance: unknown name; did you mean solver.tolerance?"),
        (["--set", "solver.preset=robst"], "5 realtime; did you mean robust?"),
        (["--set", "tau=1"], "--set tau: is an output, which the model computes"),
        (["--step", "1e-9"], "--step 1e-09 s: would give 4e+10 rows"),
        (["--rate", "1e-300"], "stop = 4e+302 s: would give 1e+305 rows at the communication step"),
        (["--rate", "1e300"], "speed_rate = -1e+300 rad/s2: must not exceed 1e+30 in size"),
        (["--rate", "1e20"], "stop = 4e-18 s: must be at least 1e-15 s"),
        (["--hold", "1e300"], "stop = 1e+300 s: would give 2.5e+302 rows at the communication st"),
        (["--preset", "robusd"], "did you mean robust?"),
        (["--set", "gravity"], "--set gravity: must be NAME=VALUE"),
        (["--set", "=3"], "--set =3: must be NAME=VALUE"),
        (["--set", "gravity=heavy"], "--set gravity = heavy: must be a number, in m/s2"),
        (["--set", "gravity=nan"], "--set gravity = nan: must be"),
        (["--set", "gravity=-1"], "--set gravity = -1: must be a finite number >= 0 m/s2"),
        (["--set", "bearing[1].clearance=0"], "bearing[1].clearance = 0 m: must be > 0"),
        (["--set", "solver.method=9"], "--set solver.method = 9: must be one of 0 as the preset"),
        (["--set", "solver.method=hht"], "solver.method = hht: needs alpha_f too"),
        (["--set", "solver.alpha_f=0.1"], "not a parameter of chung-hulbert"),
        (["--set", "solver.alpha_f=1"], "solver.alpha_f = 1: means as the preset and changes not"),
        (["--set", "solver.h=0"], "--set solver.h = 0: means as the preset and changes nothing"),
        (["--set", "solver.rho=-1"], "--set solver.rho = -1: means as the preset and changes not"),
        (["--set", "solver.norm=as the preset"], "means as the preset and changes nothing"),
        (["--set", "solver.tolerance=1.5"], "--set solver.tolerance = 1.5: must be a finite"),
        (["--set", "shaft.eta_h=0.01"], "shaft.eta_h = 0.01: must be 0 unless"),
        (["--set", "shaft.rotating_damping=perhaps"], "must be true or false"),
        (["--preset", "paper-adaptive", "--set", "solver.h=1"], "solver.h = 1 s: must lie between"),
        (["--set", "gravity=1", "--set", "gravity=2"], "--set gravity: is given twice"),
        (
            ["--preset", "robust", "--set", "solver.preset=paper"],
            "--preset robust: --set solver.preset gives it too",
        ),
        (["--stop", "-1"], "--stop -1 s: must be > 0"),
        (["--step", "50"], "--step 50 s: must be > 0 and at most --stop = 40 s"),
        (["--stop", "soon"], "--stop soon: "),
        (["--nonsense"], "--nonsense"),
        (["drop.toml"], "(drop.toml); a machine file follows --rotor"),
        (["--rotor", "none.toml"], "--rotor none.toml: cannot be read"),
        (["--input", "none.csv"], "rotor-fmu: none.csv: cannot be read: No such file"),
        (["--input", "/dev/zero"], "/dev/zero: cannot be read: is not a file"),
        (["--out", "/proc/nothing"], "--out /proc/nothing: cannot be written to"),
        (
            ["--out", "run_down.CSV"],
            "--out run_down.CSV: is a folder for files, and is called like",
        ),
    ],
)
def test_bad_options_are_refused_in_one_line(input_error, arguments, expected):
    assert expected in input_error("run-down", *arguments)


@pytest.mark.parametrize("modes", ["10001", "99999999999"])
def test_a_reduction_that_no_fmu_can_have_is_refused_in_one_line(input_error, modes):
    expected = f"solver.reduction = {modes}: must be an integer from 0 to 10000"
    assert expected in input_error("build", "--reduction", modes, "--out", "new/folder")


def test_an_option_before_the_command_is_told_where_it_belongs(input_error):
    said = input_error("--rotor", "drop.toml", "run-down")
    assert said.endswith("No such option: --rotor; options follow the command")


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("modes --count x", "--count x: "),  # the reason is in the words of the parser
        ("modes --count=x", "--count x: "),
        ("build --reduction -1", "--reduction -1: "),
        ("response --share x", "--share x: "),
        ("unbalance --node 3 --node x", "--node 3, x: "),
        ("plot bode", "RUN: must be given"),
        ("study", "STUDY.toml: must be given"),
        # before the first run
        ("balance --speed 9 --plane 4 --out /dev/null", "--out /dev/null: cannot be written to"),
        ("modes --contacts shut", "--contacts shut: must be one of open, pinned"),
        (f"unbalance --rotor {JEFFCOTT} --speed 0", "--speed 0 rad/s: must be > 0 and finite"),
        ("response --share 0", "--share 0: must be above 0 and below 1"),
        ("response --step=100", "--step 100: must be from 0.0001 to 10"),
        (
            "response --speed 1:2 --seed 31.4159",
            "--seed 5 Hz: must be from 0.15915 Hz to 0.31831 Hz",
        ),
        ("response --set grav=1", "--set grav: unknown name; did you mean gravity?"),
        ("response --over grav=1:2", "--over grav: unknown name; did you mean gravity?"),
        ("response --fold-over a=1:2", "--fold-over a: unknown name; known: "),
        ("response --load a=1", "--load: 'a' is not a force on a port; known: coupling.fx, cou"),
        ("plot orbit out --pp", "--pp: changes no plot orbit, only bode, polar, cascade"),
        ("plot bode out --speed 3", "--speed: changes no plot bode, only orbit, spectrum"),
        ("balance --speed 10 --plane 99", "--plane 99: must be from 1 to 8"),
        ("balance --speed 10 --plane 4 --node 0", "--node 0: must be from 1 to 8"),
    ],
)
def test_a_refusal_has_the_option_as_it_was_typed_once(input_error, command, expected):
    said = input_error(*command.split()).removeprefix("rotor-fmu: ")
    assert said.startswith(expected)
    assert said.count("--") == expected.count("--")


def test_what_is_typed_in_two_lines_is_refused_in_one(input_error):
    said = input_error("modes", "--count", "a\nb")
    assert said.startswith(r"rotor-fmu: --count a\nb: ")


@pytest.mark.parametrize(
    ("command", "name", "others"),
    [
        ("build", "RotorBearing.fmu", ()),
        ("ssp", "OspSystemStructure.xml", ("RotorBearing.fmu", "DriveTrain.fmu", "System.ssp")),
    ],
)
def test_a_folder_of_a_files_name_is_bad_input_and_stays(
    input_error, tmp_path, command, name, others
):
    """Others are written before it."""
    for each in others:
        (tmp_path / each).touch()
    (tmp_path / name).mkdir()
    said = input_error(command, "--out", ".")
    assert said.endswith(f"{name}: is a folder, where a file of this name is to be written")


def test_help_names_every_command_and_loads_none(tmp_path):
    script = (
        "import sys, rotor_fmu.cli as c; sys.argv = ['rotor-fmu', '--help']\n"
        "try: c.main()\n"
        "finally: print('loaded:', *{n.split('.')[0] for n in sys.modules})"
    )
    done = run_anew(script)
    said, _, loaded = done.stdout.partition("loaded:")
    assert done.returncode == 0, done.stderr
    for panel in COMMANDS.values():
        for name in panel:
            assert re.search(rf"│ {name} +[A-Z]", said), name
    assert not {"numba", "numpy", "scipy", "matplotlib", "fmpy"} & set(loaded.split())


def test_nothing_asked_prints_help_alone(process):
    done = process()
    assert (done.returncode, done.stderr) == (0, "")
    assert "Usage:" in done.stdout


def test_a_misspelt_command_is_told_its_neighbour(input_error):
    assert "'buidl'. Did you mean 'build'?" in input_error("buidl")


# what a command asks for beside the machine
ASKED = {
    "balance": ("--speed", "10", "--plane", "4"),
    "frequency-response": ("--force", "1"),
    "stability": ("--rated", "100"),
}


def test_every_command_refuses_a_machine_file_that_is_not_there(input_error):
    """In one line, with the option and the file."""
    names = [name for panel in COMMANDS.values() for name in panel]
    of_machines = [n for n in names if any(p.name == "rotor" for p in _loaded(n).params)]
    assert {"run-down", "build", "modes", *ASKED} <= set(of_machines)
    for name in of_machines:
        said = input_error(name, *ASKED.get(name, ()), "--rotor", "none.toml")
        assert said == "rotor-fmu: --rotor none.toml: cannot be read: No such file or directory"


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("clearance = 50e-6", "clearance = -50e-6", "bearing[1].clearance = -5e-05 m: must be > 0"),
        ("node = 4\n", "node = 44\n", "disc[1].node = 44: must be an integer from 1 to 8"),
        ("young = 2.1e11", "yuong = 2.1e11", "material.yuong: unknown key"),
        ("mu = 0.05", "mu = nan", "bearing[1].mu = nan: must be >= 0 and finite"),
        ("0.043,", "0.0,", "length = 0 m: must be > 0"),
    ],
)
def test_bad_rotors_are_refused_in_one_line_by_runs_and_builds(
    input_error, tmp_path, old, new, expected
):
    assert old in rig_toml()
    (tmp_path / "rotor.toml").write_text(rig_toml().replace(old, new))
    for command in ("run-down", "build"):
        line = input_error(command, "--rotor", "rotor.toml")
        assert expected in line
        assert "rotor.toml" in line


def test_build_fmu_py_builds_into_the_folder_named(tmp_path, monkeypatch):
    script = Path(__file__).parents[2] / "build_fmu.py"
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", [str(script), "--out", "fmus"])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(script), run_name="__main__")
    assert not end.value.code
    assert (tmp_path / "fmus" / "RotorBearing.fmu").is_file()
