"""A new kind of part is one file and one line: everything else follows from them."""

import json
import os
import shutil
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import fmpy
import pytest
import rotor_fmu.model

import rotor_fmu

HERE = Path(__file__).parents[1] / "new_part"
PARTS = {"cubic_spring": "CubicSpring", "elastic_stop": "ElasticStop"}


def copied(folder):
    """A copy of the package in a folder."""
    copy = folder / "rotor_fmu"
    ignored = shutil.ignore_patterns("*.nb?", "library")
    shutil.copytree(Path(rotor_fmu.__file__).parent, copy)
    shutil.copytree(Path(rotor_fmu.model.__file__).parent, copy / "model", ignore=ignored)
    return copy


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The folder of a copy of the package that has one file and one line more for each part."""
    folder = tmp_path_factory.mktemp("copy")
    copy = copied(folder)
    for name in PARTS:
        shutil.copy(HERE / f"{name}.py", copy / "model" / "parts")
    register = copy / "model" / "parts" / "__init__.py"
    before = "from .disc import"
    text = register.read_text()
    assert text.count(before) == 1
    lines = "".join(f"from .{name} import {kind}\n" for name, kind in PARTS.items())
    register.write_text(text.replace(before, lines + before))
    return folder


def run(copy, *arguments, **environment):
    """Standard output of a program that imports the copy."""
    done = subprocess.run(
        [sys.executable, *arguments],
        env={**os.environ, "PYTHONPATH": str(copy), **environment},
        capture_output=True,
        text=True,
        check=False,
        cwd=copy,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def seen(copy):
    """What the copy says without the compiler."""
    dry_run = HERE / "dry_run.py", HERE / "machine.toml"
    return json.loads(run(copy, *dry_run, NUMBA_DISABLE_JIT="1").splitlines()[-1])


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


def test_a_wall_with_quantities_of_its_own_is_one_to_linear_analyses_and_periodic_motions(seen):
    assert seen["clearances"] == [["elastic_stop[1]", 3e-4]]
    assert seen["corners"] == pytest.approx([2e-4, -1e-4])
    assert seen["rolling"] == 0  # of a wall without friction


@pytest.mark.slow
@pytest.mark.parametrize("options", [(), ("--native", "--platform", "here")])
def test_both_fmus_run_with_it_once_the_library_knows_it(copy, options):
    """The first of them makes the library, which takes minutes."""
    cli = "-c", "from rotor_fmu.cli import main; main()", "build", *options
    cache = {"ROTOR_FMU_CACHE": str(copy / "cache")}
    built = run(copy, *cli, "--rotor", HERE / "machine.toml", "--out", copy / "fmu", **cache)
    result = fmpy.simulate_fmu(
        built.split()[-1],
        stop_time=0.008,
        output_interval=0.004,
        start_values={"speed": 180.0, "cubic_spring[1].drag": 50.0},
        output=["cubic_spring[1].pull", "energy.cubic"],
    )
    assert len(result) == 3
    assert (result["cubic_spring[1].pull"] > 0.0).all()
    assert (result["energy.cubic"] > 0.0).all()
