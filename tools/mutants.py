"""Wrong versions of this project that its tests must see: `python -m tools.mutants [WORD]`.

Each is applied to a copy of the project, where the test named is run. A mutant that passes its test
is reported as unseen, one whose file or test has changed as outdated, and the exit status is 1 if
there is one of either. WORD: only mutants that have it in file, text or test.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from tools.checkout import ROOT, lay_out

_VALID, _PAGES = "tests/fmu/test_validity.py::test_", "tests/fmu/test_documents.py::test_"
_DEPEND = f"{_VALID}outputs_depend_on_the_inputs_that_reach_them_within_an_instant"
_BY_SPEED = f"{_VALID}the_speed_reaches_an_output_where_it_is_an_input"
_LIMITS = f"{_VALID}limits_nominal_values_and_unknowns_are_those_of_the_table"
_UNITS = f"{_VALID}units_are_defined_by_si_exponents_and_shown_in_what_people_read"
_GUID = f"{_VALID}another_rotor_gives_another_guid"
_HOLDS = f"{_VALID}it_holds_its_skin_its_libraries_its_machine_and_nothing_else"
_IMPORTS = f"{_VALID}it_imports_nothing_that_a_bare_python_has_not"
_CURRENT = f"{_VALID}an_fmu_is_current_only_with_all_that_it_would_hold_now"
_TOOL = f"{_VALID}an_fmu_of_another_version_of_pythonfmu_is_not_current"
_NAMES = f"{_VALID}its_documents_name_what_it_requires"
_PAGE = f"{_PAGES}each_page_tells_its_own_drive_and_what_it_carries"
_TERMINALS = (
    f"{_PAGES}the_terminals_members_are_the_motion_and_the_torque_of_the_shaft_and_of_bodies"
)
_LICENCES = f"{_PAGES}the_licences_of_what_is_carried_are_there"
_README = "tests/documents/test_readme.py::test_the_pages_made_from_the_code_say_what_it_says_now"
_RESULT = "tests/fmu/test_reference.py::test_another_rotor_does_not_carry_the_rigs_result"
_INSTANT = (
    "tests/physics/test_observe.py::test_what_reaches_an_output_within_an_instant_is_declared"
)
_LEDGER = "tests/physics/test_energy.py"
_FORCE = f"{_LEDGER}::test_a_constant_force_works_force_times_way"
_JUMP = f"{_LEDGER}::test_a_jump_of_the_speed_is_work_of_the_drive"


_WHIRLS = "tests/linear/test_whirls.py::test_"
_OWN_WHIRLS = f"{_WHIRLS}rings_and_pads_follow_each_whirl_at_its_own_frequency"
_STANDSTILL = f"{_WHIRLS}what_oil_films_alone_carry_is_not_looked_at_at_standstill"
_IDLE_PAD = f"{_WHIRLS}a_pad_that_bears_nothing_does_not_make_a_machine_free"


class Mutant(NamedTuple):
    """A file with `old`, which stands in it once, replaced; the test that must see it."""

    file: str
    old: str
    new: str
    test: str


_DESCRIPTION = "rotor_fmu/fmi/description.py"
_PACKING = "rotor_fmu/fmi/packing"
_PYTHON_FMU = f"{_PACKING}/python_fmu.py"
_DOCUMENTS = f"{_PACKING}/documents.py"
_OF_TERMINALS = "rotor_fmu/fmi/terminals.py"
_ENERGY = "model/time_loop/energy.py"
_SURVEY, _AT_REST = "model/stability/matrices.py", "model/stability/whirls.py"
_OBSERVE = "model/time_loop/observe.py"

MUTANTS = (
    # the description
    Mutant(_DESCRIPTION, "        return inputs\n", "        return []\n", _DEPEND),
    Mutant(_DESCRIPTION, "in (variable.reached_by, own)", "== own", _BY_SPEED),
    Mutant(_DESCRIPTION, '("min", variable.least)', '("min", None)', _LIMITS),
    Mutant(_DESCRIPTION, '("max", variable.high)', '("max", variable.low)', _LIMITS),
    Mutant(_DESCRIPTION, '["nominal"] = repr(variable.nominal)', '["nominal"] = "1.0"', _LIMITS),
    Mutant(_DESCRIPTION, "factor=repr(factor)", "factor=repr(1 / factor)", _UNITS),
    Mutant(_DESCRIPTION, "SubElement(unknowns, ", "SubElement(Element('none'), ", _LIMITS),
    Mutant(_DESCRIPTION, "rotor-fmu {content} {table!r}", "rotor-fmu", _GUID),
    Mutant("rotor_fmu/fmi/interface.py", "is_driven else output.reached_by", "is_driven else ''",
           _DEPEND),
    Mutant(_OBSERVE, '        reached_by=ALL,\n    ),\n    Output(\n        "J"',
           '    ),\n    Output(\n        "J"', _INSTANT),
    Mutant("model/parts/clearance_contact.py", ", reached_by=SPEED", "", _INSTANT),
    Mutant("model/parts/base.py", 'upwards", True, 10.0, reached_by=SPEED',
           'upwards", True, 10.0', _INSTANT),
    # what the FMU holds
    Mutant(_PYTHON_FMU, '"slave.py", "wrapper.py")', '"slave.py", "wrapper.py", "__init__.py")',
           _HOLDS),
    Mutant("rotor_fmu/fmi/python/slave.py", "from struct import Struct",
           "import numpy\nfrom struct import Struct", _IMPORTS),
    Mutant(_PYTHON_FMU, "names == {*expected} and", "", _CURRENT),
    Mutant(_PYTHON_FMU, "archive.read(name) == data for", "True for", _CURRENT),
    Mutant(_PYTHON_FMU, "if not _has_pythonfmu(archive):", "if False:", _CURRENT),
    Mutant(_PYTHON_FMU, "PythonFMU {version('pythonfmu')}", "PythonFMU", _TOOL),
    # the documents
    Mutant(_DOCUMENTS, "runs in the Python of its host: Python 3.11", "runs: Python 3.12", _NAMES),
    Mutant(_DOCUMENTS, '("rotor-fmu", "pythonfmu") if', '("rotor-fmu",) if', _LICENCES),
    Mutant(_DOCUMENTS, "_REFERENCE if related", "_REFERENCE if not related", _PAGE),
    Mutant(_DOCUMENTS, "drive=_DRIVES[table[0].name]", 'drive=_DRIVES["speed"]', _PAGE),
    Mutant(_OF_TERMINALS, '"tau": "tau_drive"}', '"tau": "tau"}', _TERMINALS),
    Mutant(_OF_TERMINALS, '("fx", "fy", "x", "y")', '("fx", "fy", "y")', _TERMINALS),
    Mutant(_DOCUMENTS, 'version=__version__', 'version="0"', _PAGE),
    Mutant(_DOCUMENTS, 'len(variables) == len(', 'len(variables) != len(', _README),
    Mutant(_DOCUMENTS, "rotor != rig() or ", "", _RESULT),
    # the ledger
    Mutant(_ENERGY, "out[FLOW.external] = external", "out[FLOW.external] = -external", _FORCE),
    Mutant(_ENERGY, "    out[FLOW.housing] = housing\n", "    out[FLOW.housing] = 0.0\n", _LEDGER),
    Mutant(_ENERGY, "kinetic -= 0.5 * spin.omega", "kinetic += 0.5 * spin.omega", _JUMP),
    Mutant(_ENERGY, "gravity -= m_x * g.real", "gravity += m_x * g.real", _LEDGER),
    Mutant(_ENERGY, "elastic += 0.5 * (housing.kx", "elastic += 0.4 * (housing.kx", _LEDGER),
    Mutant(_OBSERVE, "flows[FLOW.drive] + flows[FLOW.external]", "flows[FLOW.drive]", _LEDGER),
    Mutant(_SURVEY, "if interface.vibrating > 0:", "if interface.vibrating < 0:", _OWN_WHIRLS),
    Mutant(_SURVEY, "size + at, row] = force", "size + at, row] = -force", _OWN_WHIRLS),
    Mutant(_AT_REST, "0.0 and not _rests_here(", "0.0 and _rests_here(", _STANDSTILL),
    Mutant(_SURVEY, "        if stays:\n", "        if False:\n", _IDLE_PAD),
    Mutant(_OBSERVE, "LAW_LOSSES[i] for i in losses", "LAW_LOSSES[-i] for i in losses", _LEDGER),
)  # fmt: skip


def copied(folder: Path) -> None:
    """The project and its solver library, so that `folder` on the search path is the project."""
    lay_out(folder)
    shutil.copytree(ROOT / "model/library", folder / "model/library", dirs_exist_ok=True)
    for name in ("model", "examples"):
        (folder / "rotor_fmu" / name).symlink_to(folder / name)


def is_current(mutant: Mutant, folder: Path) -> bool:
    """Whether what a mutant replaces stands once in its file, and its test is there."""
    file, test = folder / mutant.file, folder / mutant.test.partition("::")[0]
    if not file.is_file() or file.read_text(encoding="utf-8").count(mutant.old) != 1:
        return False
    return test.exists() and mutant.test.partition("::")[2] in test_names(test)


def test_names(path: Path) -> set[str]:
    """Names of the test functions in a file, and the empty one, which stands for all."""
    if path.is_dir():
        return {""}
    return {"", *re.findall(r"^def (test_\w+)", path.read_text(encoding="utf-8"), re.M)}


def is_seen(mutant: Mutant, folder: Path) -> bool:
    """Whether a test fails in the copy `folder` with the mutant in it, which is taken out again."""
    file = folder / mutant.file
    text = file.read_text(encoding="utf-8")
    file.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
    # a library of other kernels does not fit, and compiling these takes longer than one test does
    # in plain Python, less than a whole file of them
    is_quick = mutant.file.startswith("model/") and "::" in mutant.test
    kernels = {"ROTOR_FMU_KERNELS": "python"} if is_quick else {}
    try:
        return bool(failure([mutant.test], folder, kernels))
    finally:
        file.write_text(text, encoding="utf-8")


def failure(tests: Iterable[str], folder: Path, variables: Mapping[str, str]) -> str:
    """What pytest says if a test fails in the copy `folder` with `variables` of the environment."""
    run = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider"]
    done = subprocess.run(
        [*run, *tests],
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1", **variables},
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode > 1:
        sys.exit(done.stdout + done.stderr)
    return done.stdout if done.returncode == 1 else ""


def main() -> int:
    """Run the mutants; the number of those that no test sees or that cannot be made any more."""
    word = sys.argv[1] if len(sys.argv) > 1 else ""
    chosen = [m for m in MUTANTS if word in m.file or word in m.old or word in m.test]
    if not chosen:
        sys.exit(f"no mutant has {word!r} in file, text or test")
    unseen = 0
    with tempfile.TemporaryDirectory(prefix="rotor_fmu_mutants_") as name:
        folder = Path(name)
        copied(folder)
        outdated = [mutant for mutant in chosen if not is_current(mutant, folder)]
        for mutant in outdated:
            print(f"OUTDATED {mutant.file}: {mutant.old!r}, {mutant.test}")
        chosen = [mutant for mutant in chosen if mutant not in outdated]
        if report := failure(sorted({mutant.test for mutant in chosen}), folder, {}):
            sys.exit(f"{report}\na test fails without a mutant")
        for mutant in chosen:
            seen = is_seen(mutant, folder)
            unseen += not seen
            verdict = "seen  " if seen else "UNSEEN"
            print(f"{verdict} {mutant.file}: {mutant.old!r} -> {mutant.new!r}", flush=True)
    print(f"{len(chosen)} mutants, {unseen} unseen, {len(outdated)} outdated")
    return unseen + len(outdated)


if __name__ == "__main__":
    sys.exit(min(main(), 1))
