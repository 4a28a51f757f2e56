"""Wrong versions of this project that its tests must see: `python -m tests.mutants [WORD]`.

Each is applied to a copy of the project, where the tests named are run; a mutant that they pass is
told, and the exit status says whether there was one. WORD: run those with it in file or text alone.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
_FMU = ("tests/fmu/test_validity.py", "tests/fmu/test_documents.py", "tests/test_readme.py")
_LEDGER = ("tests/test_energy.py",)
_INSTANT = ("tests/test_observe.py::test_what_reaches_an_output_within_an_instant_is_declared",)
_IS_FAST = "not it_runs"  # what compiles a package anew says nothing of these


class Mutant(NamedTuple):
    """A file with `old`, which stands in it once, replaced; the tests that must see it."""

    file: str
    old: str
    new: str
    tests: tuple[str, ...] = _FMU


_DESCRIPTION = "rotor_fmu/fmu/description.py"
_BUNDLE = "rotor_fmu/packing/bundle.py"
_DOCUMENTS = "rotor_fmu/packing/documents.py"
_ENERGY = "model/march/energy.py"
_OBSERVE = "model/march/observe.py"

MUTANTS = (
    # the description
    Mutant(_DESCRIPTION, "        return inputs\n", "        return []\n"),
    Mutant(_DESCRIPTION, ".name == variable.reached_by == SPEED", '.name == "none"'),
    Mutant(_DESCRIPTION, '("min", variable.low)', '("min", None)'),
    Mutant(_DESCRIPTION, '("max", variable.high)', '("max", variable.low)'),
    Mutant(_DESCRIPTION, '"nominal", repr(variable.nominal)', '"nominal", "1.0"'),
    Mutant(_DESCRIPTION, "factor=repr(factor)", "factor=repr(1 / factor)"),
    Mutant(_DESCRIPTION, "SubElement(unknowns, ", "SubElement(Element('none'), "),
    Mutant(_DESCRIPTION, "rotor-fmu {content} {table!r}", "rotor-fmu"),
    Mutant("rotor_fmu/fmu/interface.py", "reached_by=output.reached_by,\n", "\n"),
    Mutant(_OBSERVE, '        reached_by=ALL,\n    ),\n    Output(\n        "J"',
           '    ),\n    Output(\n        "J"'),
    Mutant("model/parts/clearance_contact.py", ", reached_by=SPEED", "", _INSTANT),
    Mutant("model/parts/linear_bearing.py", 'upwards", True, 10.0, reached_by=SPEED',
           'upwards", True, 10.0', _INSTANT),
    # what the FMU holds
    Mutant(_BUNDLE, '"impact", "false_state", "linear")', '"impact", "linear")'),
    Mutant(_BUNDLE, '"impact", "false_state", "linear")', '"impact", "false_state")'),
    Mutant(_BUNDLE, '"scipy>=1.11", ', ""),
    Mutant(_BUNDLE, "numba>=0.60", "numba>=0.6"),
    Mutant(_BUNDLE, 'if "__pycache__" not in name and', "if"),
    Mutant(_BUNDLE, '"torque" if is_free', '"speed" if is_free'),
    Mutant(_BUNDLE, "names == set(expected) and", ""),
    Mutant(_BUNDLE, "archive.read(name) == data for", "True for"),
    Mutant(_BUNDLE, "or _tool(archive) != f\"PythonFMU {version('pythonfmu')}\"", ""),
    Mutant(_BUNDLE, "        expected |= _documents(toml, is_free)\n", ""),
    # the documents
    Mutant(_DOCUMENTS, "with numpy and scipy;", "with numpy;"),
    Mutant(_DOCUMENTS, "Python 3.11 or newer with numpy", "Python 3.12 or newer with numpy"),
    Mutant(_DOCUMENTS, '("rotor-fmu", "pythonfmu")', '("rotor-fmu",)'),
    Mutant(_DOCUMENTS, "_REFERENCE if has_reference", "_REFERENCE if not has_reference"),
    Mutant(_DOCUMENTS, "drive=_DRIVES[table[0].name]", 'drive=_DRIVES["speed"]'),
    Mutant(_DOCUMENTS, '"tau": "tau_drive"}', '"tau": "tau"}'),
    Mutant(_DOCUMENTS, '("fx", "fy", "x", "y")', '("fx", "fy", "y")'),
    Mutant(_DOCUMENTS, 'version=__version__', 'version="0"'),
    Mutant("rotor_fmu/packing/variable_table.py", 'if number != "1":', 'if number == "1":'),
    Mutant("rotor_fmu/packing/related_files.py", "rotor != rig() or ", ""),
    Mutant("pyproject.toml", '"numba>=0.60"', '"numba>=0.61"'),
    # the ledger
    Mutant(_ENERGY, "out[1] = external", "out[1] = -external", _LEDGER),
    Mutant(_ENERGY, "    out[3] = housing\n", "    out[3] = 0.0\n", _LEDGER),
    Mutant(_ENERGY, "kinetic -= 0.5 * spin.omega", "kinetic += 0.5 * spin.omega", _LEDGER),
    Mutant(_ENERGY, "        gravity -= housing.mass", "        gravity += housing.mass", _LEDGER),
    Mutant(_ENERGY, "elastic += 0.5 * (housing.kx", "elastic += 0.4 * (housing.kx", _LEDGER),
    Mutant(_OBSERVE, "residual -= flows[0] + flows[1]", "residual -= flows[0]", _LEDGER),
)  # fmt: skip


def copied(folder: Path) -> None:
    """The project's files, laid out so that `folder` on the search path is the project."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for name in listed.stdout.split("\0"):
        if name and (ROOT / name).is_file():
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, target)
    for name in ("model", "examples"):
        (folder / "rotor_fmu" / name).symlink_to(folder / name)


def is_seen(mutant: Mutant, folder: Path) -> bool:
    """Whether a test fails in the copy `folder` with the mutant in it, which is taken out again."""
    file = folder / mutant.file
    text = file.read_text(encoding="utf-8")
    if text.count(mutant.old) != 1:
        sys.exit(f"{mutant.file}: {mutant.old!r} stands in it {text.count(mutant.old)} times")
    file.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    try:
        return fails(mutant.tests, folder)
    finally:
        file.write_text(text, encoding="utf-8")


def fails(tests: tuple[str, ...], folder: Path) -> bool:
    """Whether one of the tests fails in the copy `folder`."""
    run = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-k", _IS_FAST]
    done = subprocess.run(
        [*run, *tests],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode > 1:
        sys.exit(done.stdout + done.stderr)
    return done.returncode == 1


def main() -> int:
    """Run the mutants; the number of those that no test sees."""
    word = sys.argv[1] if len(sys.argv) > 1 else ""
    chosen = [m for m in MUTANTS if word in m.file or word in m.old]
    unseen = 0
    with tempfile.TemporaryDirectory(prefix="rotor_fmu_mutants_") as name:
        folder = Path(name)
        copied(folder)
        for tests in {mutant.tests for mutant in chosen}:
            if fails(tests, folder):
                sys.exit(f"{', '.join(tests)}: fail without a mutant")
        for mutant in chosen:
            seen = is_seen(mutant, folder)
            unseen += not seen
            told = "seen  " if seen else "UNSEEN"
            print(f"{told} {mutant.file}: {mutant.old!r} -> {mutant.new!r}", flush=True)
    print(f"{len(chosen)} mutants, {unseen} unseen")
    return unseen


if __name__ == "__main__":
    sys.exit(min(main(), 1))
