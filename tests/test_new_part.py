"""A new kind of part is one file and one line: everything else follows from them."""

import json
import os
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest
import rotor_fmu.model

import rotor_fmu

HERE = Path(__file__).parent / "new_part"
LINE = "from .cubic_spring import CubicSpring\n"


@pytest.fixture(scope="module")
def seen(tmp_path_factory):
    """What a copy of the package says that has one file and one line more; without the compiler."""
    folder = tmp_path_factory.mktemp("copy")
    copy = folder / "rotor_fmu"
    ignored = shutil.ignore_patterns("__pycache__")
    shutil.copytree(Path(rotor_fmu.__file__).parent, copy, ignore=ignored)
    shutil.copytree(Path(rotor_fmu.model.__file__).parent, copy / "model", ignore=ignored)
    shutil.copy(HERE / "cubic_spring.py", copy / "model" / "parts")
    register = copy / "model" / "parts" / "__init__.py"
    before = "from .disc import"
    text = register.read_text()
    assert text.count(before) == 1
    register.write_text(text.replace(before, LINE + before))
    done = subprocess.run(
        [sys.executable, HERE / "dry_run.py", HERE / "machine.toml", folder],
        env={**os.environ, "PYTHONPATH": str(folder), "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


def test_the_file_is_read_and_refuses_like_any_other(seen):
    assert "cubic_spring[1].cubik: unknown key; did you mean cubic?" in seen["misspelt"]
    assert seen["impossible"] == "cubic_spring[1].cubic = -4e+12 N/m3: must be > 0 and finite"


def test_its_numbers_are_variables_of_the_fmu(seen):
    table = seen["table"]
    assert table["cubic_spring[1].cubic"] == [
        "parameter",
        "N/m3",
        "cubic_spring 1: cubic stiffness",
    ]
    assert table["cubic_spring[1].pull"][:2] == ["output", "N"]
    assert {"energy.cubic", "energy.cubic_loss"} <= set(table)
    assert "energy.compression" not in table  # of a law that this machine has not


def test_its_variables_stand_in_the_documents(seen):
    assert "cubic stiffness" in seen["page"]


def test_its_tangent_is_the_derivative_of_its_force(seen):
    assert seen["tangent"] < 1e-6


def test_its_energy_is_in_the_ledger(seen):
    assert seen["stored"] > 0.0
    assert seen["residual"][-1] < 1e-2 * seen["loss"]
    for coarse, fine in pairwise(seen["residual"]):
        assert 3.0 < coarse / fine < 5.5


def test_the_motion_converges_with_the_square_of_the_step(seen):
    coarse, fine = seen["x"]
    assert 3.4 < coarse / fine < 4.6


def test_the_fmu_runs_with_it(seen):
    assert len(seen["pull"]) == 3
    assert all(pull > 0.0 for pull in seen["pull"])
    assert all(energy > 0.0 for energy in seen["energy"])
