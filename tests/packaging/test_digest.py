"""What a library is found by follows what the kernels do, not how they are written."""

import shutil
import subprocess
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import pytest
from rotor_fmu.model.kernels import digest as installed

import rotor_fmu
from tools.checkout import ROOT

ALL = """
from rotor_fmu.model.kernels import digest
from rotor_fmu.library import build
print(digest.kernels_digest(), build.emitted_digest(), build.sources_digest())
"""
SIMULATION = ("model", "simulation.py")  # runs the kernels, and is none


def copied(folder):
    package = folder / "rotor_fmu"
    shutil.copytree(ROOT / "rotor_fmu", package, ignore=shutil.ignore_patterns("__pycache__"))
    ignored = shutil.ignore_patterns("__pycache__", "library")
    shutil.copytree(ROOT / "model", package / "model", ignore=ignored)
    return package


@pytest.fixture
def tree(tmp_path, monkeypatch):
    """A copy of the sources, laid out as a wheel is, without any library."""
    monkeypatch.setenv("ROTOR_FMU_CACHE", str(tmp_path / "none"))
    return copied(tmp_path)


@pytest.fixture(scope="module")
def before(tmp_path_factory):
    """The digests of such a copy, by itself in a process of its own."""
    folder = tmp_path_factory.mktemp("copy")
    copied(folder)
    done = subprocess.run(
        [sys.executable, "-c", ALL],
        cwd=folder,
        env={"PYTHONPATH": str(folder), "PATH": "", "ROTOR_FMU_CACHE": str(folder / "none")},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout.split()


def module(tree, *path):
    """A module of a copy, run in this process."""
    name = ".".join(("rotor_fmu", *path))
    spec = spec_from_file_location(name, tree.joinpath(*path).with_suffix(".py"))
    result = module_from_spec(spec)
    spec.loader.exec_module(result)
    return result


def digest_of(tree):
    """The module `digest` of a copy, as a process begins with it, which has parsed all before."""
    result = module(tree, "model", "kernels", "digest")
    result._parsed = installed._parsed
    return result


def digests(tree):
    digest, build = digest_of(tree), module(tree, "library", "build")
    build.imported, build.syntax_digest = digest.imported, digest.syntax_digest
    return [digest.kernels_digest(), build.emitted_digest(), build.sources_digest()]


def of_kernels(tree):
    return digest_of(tree).kernels_digest()


def edit(tree, name, old, new):
    file = tree.joinpath(*name)
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new, 1))


KERNEL = ("model", "kernels", "functions.py")
DOCSTRING = '"""Return |z| of a complex number'
ENTRY = ("library", "entry_points.py")
LAW = ("model", "contact", "wall.py")


def test_comments_docstrings_layout_and_what_runs_the_kernels_change_nothing(tree, before):
    edit(tree, KERNEL, DOCSTRING, '"""The length of a complex number')
    edit(tree, KERNEL, "_SPLIT = 134217729.0", "# a comment\n\n_SPLIT = (\n    134217729.0\n)")
    docstring = '    """Return why `rotor_start` has no equilibrium."""'
    edit(tree, ENTRY, docstring, '    """Another text."""  # a comment')
    edit(tree, SIMULATION, "import math", "import math\nOTHER = 1.0")
    assert digests(tree) == before


@pytest.mark.parametrize(
    ("name", "old", "new", "changed"),
    [
        (KERNEL, "_SPLIT = 134217729.0", "_SPLIT = 134217730.0", "KEC"),
        (ENTRY, "code = messages.GOOD", "code = messages.GOOD + 0", "EC"),
        (("fmi", "c", "run.c"), "/*", "/* of C a comment counts: ", "C"),
    ],
)
def test_what_changes_a_library_changes_its_digest_and_nothing_else_does(
    tree, before, name, old, new, changed
):
    """K: the kernels of a run; E: the functions that are emitted; C: the library."""
    edit(tree, name, old, new)
    after = digests(tree)
    seen = "".join(d for d, a, b in zip("KEC", before, after, strict=True) if a != b)
    assert seen == changed


def test_kernels_are_found_by_what_the_entries_import(tree, before):
    """A law in a module of its own counts as soon as a part imports it."""
    (tree / "model" / "contact" / "another.py").write_text("GAIN = 1.0\n")
    assert of_kernels(tree) == before[0]
    edit(tree, LAW, "import math", "import math\n\nfrom . import another")
    seen = [before[0], of_kernels(tree)]
    (tree / "model" / "contact" / "another.py").write_text("GAIN = 2.0\n")
    seen.append(of_kernels(tree))
    edit(tree, LAW, "/ (part.exponent + 1.0)", "/ (part.exponent + 2.0)")
    seen.append(of_kernels(tree))
    assert len({*seen}) == 4


def test_a_record_spares_parsing_and_counts_for_the_very_same_files_alone(tree):
    digest = digest_of(tree)
    digest.CARRIED.mkdir()
    digest.record(digest.CARRIED)
    record = tree / "model" / "library" / "kernels.digest"
    of_files, recorded = record.read_text().split()
    assert of_kernels(tree) == recorded
    record.write_text(f"{of_files} {16 * 'a'}\n")
    assert of_kernels(tree) == 16 * "a"
    edit(tree, KERNEL, "_SPLIT = 134217729.0", "_SPLIT = 134217730.0")
    assert of_kernels(tree) not in (recorded, 16 * "a")
    record.write_text("damaged")
    edit(tree, KERNEL, "_SPLIT = 134217730.0", "_SPLIT = 134217729.0")
    assert of_kernels(tree) == recorded


def test_the_checkout_has_the_digest_of_the_wheel(before):
    """Where the package lies changes nothing."""
    assert Path(rotor_fmu.__file__).parents[1] == ROOT
    assert before[0] == installed.kernels_digest()
