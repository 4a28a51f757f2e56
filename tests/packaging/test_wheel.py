"""The wheel holds all of the project under one name, and runs wherever it is unpacked."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

from rotor_fmu.about import __version__
from tools.checkout import ROOT, lay_out

from ..processes import run_anew


def folders(root, name):
    """Packages below a folder of the repository that is installed as `name`."""
    inits = [file.parent.relative_to(root) for file in root.rglob("__init__.py")]
    return {".".join((name, *folder.parts)) for folder in inits}


def test_every_folder_of_modules_is_packed():
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]
    there = folders(ROOT / "rotor_fmu", "rotor_fmu") | folders(ROOT / "model", "rotor_fmu.model")
    assert set(settings["packages"]) == there | {"rotor_fmu.examples"}


@pytest.fixture(scope="module")
def wheel_file(tmp_path_factory):
    """The wheel, built of what belongs to the project."""
    folder = tmp_path_factory.mktemp("wheel")
    source = folder / "source"
    lay_out(source, but=("docs/", "tests/", "tools/"))
    shutil.copytree(ROOT / "model" / "library", source / "model" / "library")
    # as pip has it built
    script = "import sys; from setuptools import build_meta; build_meta.build_wheel(sys.argv[1])"
    done = run_anew(script, folder, cwd=source)
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = folder.glob("*.whl")
    return built


@pytest.fixture(scope="module")
def wheel(wheel_file, tmp_path_factory):
    """The wheel, unpacked where nothing else of the project is."""
    unpacked = tmp_path_factory.mktemp("unpacked")
    zipfile.ZipFile(wheel_file).extractall(unpacked)
    return unpacked


@pytest.fixture(scope="module")
def environment(wheel_file, tmp_path_factory):
    """Folder of the programs of a new environment with the wheel in it; the packages that it needs
    are those of this one."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder)
    paths = sysconfig.get_paths("venv", {"base": str(folder), "platbase": str(folder)})
    programs = Path(paths["scripts"])
    # in a .pth of its own, so that this environment's .pth files, the project's among them, are not
    # read
    packages = [entry for entry in sys.path if entry.endswith("-packages")]
    Path(paths["purelib"], "needed.pth").write_text("\n".join(packages) + "\n")
    command = [sys.executable, "-m", "pip", "--python", str(programs / "python"), "install"]
    done = subprocess.run(
        [*command, "--no-deps", "--no-index", wheel_file],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return programs


def test_it_has_one_name_at_the_top(wheel):
    names = {entry.name for entry in wheel.iterdir() if not entry.name.endswith(".dist-info")}
    assert names == {"rotor_fmu"}
    (entries,) = wheel.glob("*.dist-info/entry_points.txt")
    assert entries.read_text().split("\n\n")[0].splitlines() == [
        "[console_scripts]",
        "rotor-fmu = rotor_fmu.command:main",
    ]


def test_type_checkers_are_told_that_it_has_types(wheel):
    assert (wheel / "rotor_fmu" / "py.typed").is_file()


@pytest.mark.slow  # the same modules are used unpacked below
def test_installed_in_a_new_environment_its_command_runs(environment, tmp_path):
    def said(*command):
        done = subprocess.run(
            [environment / command[0], *command[1:]],
            cwd=tmp_path,
            env={k: v for k, v in os.environ.items() if k != "PYTHONPATH"},
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    where = said("python", "-c", "import rotor_fmu.model; print(rotor_fmu.model.__file__)")
    assert Path(where.strip()).is_relative_to(environment.parent)
    assert __version__ in said("rotor-fmu", "--version")
    assert "bearing[i].clearance" in said("rotor-fmu", "variables")


def test_a_model_of_the_users_beside_a_script_is_not_met(wheel, tmp_path):
    (tmp_path / "model.py").write_text("GAIN = 7.0\n")
    script = tmp_path / "script.py"
    script.write_text(
        "import model, rotor_fmu, rotor_fmu.cli\n"
        "from pathlib import Path\n"
        "from rotor_fmu.model.machine.toml import rig\n"
        "from rotor_fmu.fmi.packing.machine_files import machine_of\n"
        "from rotor_fmu.fmi.packing.python_fmu import build\n"
        "assert model.GAIN == 7.0\n"
        "assert Path(rotor_fmu.__file__).parents[1] == Path(r'" + str(wheel) + "')\n"
        "print(len(rig().bearings), build(Path('fmu'), machine_of()).name)\n"
    )
    done = subprocess.run(
        [sys.executable, script],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(wheel)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["2", "RotorBearing.fmu"]
