"""The examples of the pages in docs/development, added to a copy of the package as they stand."""

import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.parts.law import Kinematics, Weights

from tools import mutants
from tools.checkout import ROOT

from ..processes import run_anew
from .test_new_part import copied

PAGES = ROOT / "docs" / "development"
COMMAND_LINE = "import sys; from rotor_fmu.cli import main; main()"
MODULE, BEFORE, AFTER, INSTEAD = "module", "before", "after", "instead"


def changes(page):
    """The changes of a page in turn: the lines that it takes away and those that it adds."""
    text = (PAGES / f"{page}.md").read_text(encoding="utf-8")
    diffs = re.findall(r"^```diff\n(.*?)^```", text, re.M | re.S)
    blocks = re.findall(r"((?:^-.*\n)*)((?:^\+.*\n)+)", "\n".join(diffs), re.M)
    return [[re.sub(r"^[-+] ?", "", lines, flags=re.M) for lines in block] for block in blocks]


# by page: the file of each change, and the line before or after which it belongs
PLACES = {
    "add_a_command": [
        ("cli/linear.py", MODULE, ""),
        ("cli/__init__.py", BEFORE, '        "modes": "linear:modes",\n'),
    ],
    "add_an_output": [
        ("model/time_loop/observe.py", BEFORE, ")\n(_RESIDUAL,)"),
        ("model/time_loop/observe.py", AFTER, "    out[_SOLVER.residual] = r.residual\n"),
    ],
    "add_a_solver_mode": [
        *(("model/time_loop/control.py", INSTEAD, ""),) * 3,
        ("model/time_loop/control.py", BEFORE, "    return desired\n"),
        ("model/settings/table.py", INSTEAD, ""),
        ("model/settings/table.py", AFTER, '    "realtime": REALTIME,\n'),
        ("model/settings/table.py", AFTER, '    "realtime": ("newton_limit",),\n'),
    ],
    "add_a_warning": [
        ("linear/machine_warnings.py", BEFORE, "    try:\n"),
        ("model/warnings.py", BEFORE, '    RunWarning(\n        "trapped_at"'),
        ("model/time_loop/monitors.py", MODULE, ""),
        ("model/time_loop/monitors.py", AFTER, "    monitor_losses(structure, control, motion, "),
    ],
}


@pytest.fixture
def extended(tmp_path):
    """A copy with what a page adds: its `rotor-fmu` in plain Python, which returns what it
    prints."""

    def extend(page):
        package = copied(tmp_path)
        for (name, where, line), (old, block) in zip(PLACES[page], changes(page), strict=True):
            file = package / name
            text = file.read_text(encoding="utf-8")
            line = old or line
            assert text.count(line) == 1 or where == MODULE
            at = len(text) if where == MODULE else text.index(line)
            at = text.index("\n", at) + 1 if where == AFTER else at
            file.write_text(text[:at] + block + text[at + len(old) :], encoding="utf-8")
        return run

    def run(*arguments, program=COMMAND_LINE):
        environment = {"PYTHONPATH": str(tmp_path), "ROTOR_FMU_KERNELS": "python"}
        done = run_anew(program, *arguments, cwd=tmp_path, **environment)
        assert done.returncode == 0, done.stderr
        return done.stdout + done.stderr

    return extend


# the displacement at the end of a run with the new mode, for each tolerance
HALVED = """
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts import Bearing, Support
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

rotor = rig().with_parts(Bearing).with_parts(Support, Support(2, 1e6, 9.0), Support(8, 2e6))
for tolerance in (1e-2, 1e-3, 1e-4, 1e-5):
    settings = choose("controlled", mode="halving", tolerance=tolerance)
    sim = Simulation(rotor, settings, speed=185.0, warn=lambda message: None)
    sim.advance(0.02, 185.0)
    print(sim.read("disc[1].x"))
"""
RUN = ("run-down", "--direct", "--stop", "0.002")


def test_the_command_that_a_page_adds_prints_what_the_page_says(extended):
    said = extended("add_a_command")("mass")
    assert said.startswith("5.641 kg")
    assert said.strip() in (PAGES / "add_a_command.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_output_that_a_page_adds_is_a_variable_and_has_values(extended):
    run = extended("add_an_output")
    (line,) = [row for row in run("variables").splitlines() if "pace" in row]
    assert "rad/s" in line
    run(*RUN)


@pytest.mark.slow
def test_the_warnings_that_a_page_adds_are_given(extended):
    run = extended("add_a_warning")
    assert "far from the axis since t = " in run(*RUN, "--set", "disc[1].e=0.05")


@pytest.mark.slow
def test_the_mode_that_a_page_adds_has_errors_that_fall_with_the_tolerance(extended):
    *given, finest = map(float, extended("add_a_solver_mode")(program=HALVED).splitlines())
    errors = [abs(x - finest) for x in given]
    assert errors[0] < 1e-6
    assert errors[2] < errors[0] / 20.0


def test_the_state_that_a_page_adds_is_solved_and_follows_a_vibration():
    code = "".join(block for _, block in changes("add_a_law_state")).partition("MAXWELL")[0]
    own = {"jit": lambda function: function}
    exec(code, own)
    part, weights = SimpleNamespace(k=3e5, c=40.0), Weights(1.0, 200.0, 0.005)
    free, state, rate = np.array([1e-5, -2e-5]), np.zeros(2), np.zeros(2)

    def force(d):
        moved = Kinematics(d, 0.0j, 0.0, 0.0, 0.0)
        result = own["_tangent"](part, (), moved, weights, free, state)
        own["_rates"](part, (), moved, state, rate)
        assert state == pytest.approx(free + weights.rate * rate)
        return result

    d, far = 3e-5 + 1e-5j, 1e-6 - 2e-6j
    at, p, q = force(d)
    assert force(d + far)[0] - at == pytest.approx(p * far + q * far.conjugate())
    w = 500.0
    moved = Kinematics(d, 0.0j, 0.0, 0.0, 0.0)
    at, p_d, q_d, p_v, q_v = own["_vibrate"](part, (), moved, w, free, state)
    assert complex(*state) == d  # at rest, where the damper bears nothing
    assert at == q_d == q_v == 0.0
    assert p_d + 1j * w * p_v == pytest.approx(-1.0 / (1.0 / part.k + 1.0 / (1j * w * part.c)))


@pytest.mark.parametrize("page", sorted(PAGES.glob("add_*.md")), ids=lambda page: page.stem)
def test_the_files_that_a_page_names_are_there(page):
    """One without a folder beside the one that is named before it."""
    names = re.findall(r"`([\w./]+\.(?:py|md))`", page.read_text(encoding="utf-8"))
    assert len(names) >= 3
    folder = ROOT
    for name in names:
        folder = (ROOT / name).parent if "/" in name else folder
        assert (folder / name.rpartition("/")[2]).is_file(), name


def test_a_debugger_stops_where_a_page_says(tmp_path):
    text = (PAGES / "debug_a_kernel.md").read_text(encoding="utf-8")
    (script,) = re.findall(r"^```sh\n(.*?)^```", text, re.M | re.S)
    script = script.replace("b model/", f"b {ROOT}/model/")
    script = script.replace(" python ", f" {sys.executable} ")
    done = subprocess.run(
        ["sh", "-c", script], capture_output=True, text=True, check=True, cwd=tmp_path
    )
    (said,) = re.findall(r"^\(np.*\)$", done.stdout, re.M)
    place, penetration, clearance = eval(said, {"np": np})
    assert penetration == pytest.approx(abs(place) - clearance)
    assert penetration > 0.0


def test_mutants_are_of_todays_code_and_their_tests_are_there():
    """So that `make mutants` tries all of them."""
    assert [mutant for mutant in mutants.MUTANTS if not mutants.is_current(mutant, ROOT)] == []
