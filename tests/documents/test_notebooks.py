"""The tutorial notebooks run from top to bottom, and show what they speak of, with what the README
has a reader install."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys

import pytest

from tools.checkout import ROOT, lay_out

from ..packaging.environments import closure, environment

nbformat = pytest.importorskip("nbformat", reason="pip install 'rotor-fmu[test]'")
NOTEBOOKS = sorted((ROOT / "docs" / "tutorials").glob("*.ipynb"))
QUICK = "own_machine"
# all but the quickest are slow
RUN = [
    pytest.param(path, id=path.stem, marks=() if path.stem == QUICK else pytest.mark.slow)
    for path in NOTEBOOKS
]
# what `make run-down` installs, and the README's line for notebooks
MADE = re.search(
    r"^\$\(VENV\)/made:.*?\"\.\[([\w,]+)\]\"", (ROOT / "Makefile").read_text(), re.M | re.S
)[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
LINE = re.search(r"`([^`\n]*pip install[^`\n]*\[(\w+)\][^`\n]*)`, then `[^`\n]*jupyter lab", README)
INDEX = [sys.executable, "-m", "pip", "download", "--quiet", "--no-deps", "pip"]


def read(path):
    return nbformat.read(path, as_version=4)


@pytest.fixture(scope="module")
def kernel(tmp_path_factory):
    """A kernel in an environment of the packages alone that a reader has: its name in Jupyter, and
    the variables of a process that knows it."""
    folder = tmp_path_factory.mktemp("reader")
    programs = environment(folder / "venv", closure([*MADE.split(","), LINE[2]]))
    spec = folder / "kernels" / "reader"
    spec.mkdir(parents=True)
    start = [str(programs / "python"), "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    about = {"argv": start, "display_name": "reader", "language": "python"}
    (spec / "kernel.json").write_text(json.dumps(about))
    path = f"{programs}{os.pathsep}{os.environ['PATH']}"
    return spec.name, {"JUPYTER_PATH": str(folder), "PATH": path}


def stderr_and_pictures(notebook):
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert all(cell.execution_count for cell in code)
    outputs = [output for cell in code for output in cell.outputs]
    pictures = ["image/png" in output.get("data", {}) for output in outputs]
    return [each.text for each in outputs if each.get("name") == "stderr"], sum(pictures)


@pytest.mark.parametrize("path", RUN)
def test_a_notebook_runs_without_a_warning_and_shows_its_pictures(
    path, kernel, tmp_path, monkeypatch
):
    from nbclient import NotebookClient

    name, variables = kernel
    for variable, value in variables.items():
        monkeypatch.setenv(variable, value)
    notebook = read(path)
    # no package of this environment is there that a reader has not
    hidden = "import importlib.util; assert not importlib.util.find_spec('pytest')"
    notebook.cells.insert(0, nbformat.v4.new_code_cell(hidden))
    folder = {"metadata": {"path": str(tmp_path)}}
    NotebookClient(notebook, kernel_name=name, resources=folder, timeout=1200).execute()
    said, pictures = stderr_and_pictures(notebook)
    assert not said
    assert pictures


@pytest.fixture(scope="module")
def reader(tmp_path_factory):
    """A checkout in which `make` and the README's line have installed what they say."""
    folder = tmp_path_factory.mktemp("checkout")
    if not shutil.which("make"):
        pytest.skip("needs make")
    if subprocess.run(INDEX, cwd=folder, capture_output=True, check=False).returncode:
        pytest.skip("needs pip to reach its index of packages")
    checkout = folder / "rotor-fmu"
    lay_out(checkout, but=("tests/",))
    shutil.copytree(ROOT / "model" / "library", checkout / "model" / "library")
    make = ["make", f"PYTHON={sys.executable}", ".venv/made"]
    for command in (make, shlex.split(LINE[1])):
        done = subprocess.run(command, cwd=checkout, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
    return checkout


@pytest.mark.slow
@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_after_make_and_the_line_of_the_readme(path, reader):
    programs = reader / ".venv" / ("Scripts" if os.name == "nt" else "bin")
    copy = reader / path.name
    shutil.copyfile(path, copy)
    done = subprocess.run(
        [programs / "jupyter", "execute", "--inplace", copy.name],
        cwd=reader,
        env={**os.environ, "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    said, pictures = stderr_and_pictures(read(copy))
    assert not said
    assert pictures


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_are_kept_without_what_they_printed(path):
    for cell in read(path).cells:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None
