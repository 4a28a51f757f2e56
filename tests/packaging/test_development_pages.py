"""The examples of the pages in docs/development, added to a copy of the package as they stand."""

import os
import re
import subprocess
import sys

import pytest

from tools.checkout import ROOT

from .test_new_part import copied

PAGES = ROOT / "docs" / "development"
PROGRAM = "import sys; from rotor_fmu.cli import main; main()"
MODULE, BEFORE, AFTER = "module", "before", "after"


def added(page):
    """The lines that a page adds, in turn: one text for each place that it names."""
    text = (PAGES / f"{page}.md").read_text(encoding="utf-8")
    diffs = re.findall(r"^```diff\n(.*?)^```", text, re.M | re.S)
    blocks = re.findall(r"(?:^\+.*\n)+", "".join(f"{diff}\n" for diff in diffs), re.M)
    return [re.sub(r"^\+ ?", "", block, flags=re.M) for block in blocks]


# by page: the file of each block that is added, and the line before or after which it belongs
PLACES = {
    "add_a_command": [
        ("cli/linear.py", MODULE, ""),
        ("cli/__init__.py", BEFORE, '        "modes": "linear:modes",\n'),
    ],
    "add_an_output": [
        ("model/time_loop/observe.py", BEFORE, ")\n(_RESIDUAL,)"),
        ("model/time_loop/observe.py", AFTER, "    out[_SOLVER.residual] = r.residual\n"),
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
        for (name, where, line), block in zip(PLACES[page], added(page), strict=True):
            file = package / name
            text = file.read_text(encoding="utf-8")
            assert text.count(line) == 1 or where == MODULE
            at = len(text) if where == MODULE else text.index(line)
            at = text.index("\n", at) + 1 if where == AFTER else at
            file.write_text(text[:at] + block + text[at:], encoding="utf-8")
        return run

    def run(*arguments):
        environment = {"PYTHONPATH": str(tmp_path), "ROTOR_FMU_KERNELS": "python"}
        done = subprocess.run(
            [sys.executable, "-c", PROGRAM, *arguments],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            check=False,
            cwd=tmp_path,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout + done.stderr

    return extend


RUN = ("run-down", "--direct", "--stop", "0.002")


def test_the_command_that_a_page_adds_prints_what_the_page_says(extended):
    said = extended("add_a_command")("mass")
    assert said.startswith("5.641 kg")
    assert said.strip() in (PAGES / "add_a_command.md").read_text(encoding="utf-8")


def test_the_output_that_a_page_adds_is_a_variable_and_has_values(extended):
    run = extended("add_an_output")
    (line,) = [row for row in run("variables").splitlines() if "pace" in row]
    assert "rad/s" in line
    run(*RUN)


def test_the_warnings_that_a_page_adds_are_given(extended):
    run = extended("add_a_warning")
    assert "far from the axis since t = " in run(*RUN, "--set", "disc[1].e=0.05")
