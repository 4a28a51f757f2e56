"""Imports run one way, and ARCHITECTURE.md shows the packages and the flow as they are."""

import re
import sys
from graphlib import TopologicalSorter

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build
from tools import architecture


def test_no_imports_between_packages_go_round():
    packages = architecture.order()
    for above, below in (
        ("rotor_fmu.model.simulation", "rotor_fmu.model.kernels"),
        ("rotor_fmu.fmi", "rotor_fmu.model.time_loop"),
        ("rotor_fmu.machine_studies", "rotor_fmu.runs"),
        ("rotor_fmu.machine_studies", "rotor_fmu.studies"),
        ("rotor_fmu.cli", "rotor_fmu.studies"),
    ):
        assert packages.index(below) < packages.index(above)


def test_no_imports_between_modules_go_round_and_none_for_type_checkers_do():
    known = architecture.modules()
    # a package is imported with each of its modules
    TopologicalSorter(
        {
            name: {
                below
                for below in architecture.imports(name, file, known)
                if not f"{name}.".startswith(f"{below}.")
            }
            for name, file in known.items()
        }
    ).prepare()


def test_the_model_knows_nothing_of_fmi_files_or_screens():
    outside = {
        (above, below)
        for above, below in architecture.arrows()
        if above.startswith("rotor_fmu.model.") and not below.startswith("rotor_fmu.model.")
    }
    assert not outside
    for word in ("pythonfmu", "fmpy", "matplotlib", "fmi2"):
        assert not [f for f in architecture.mentions(word) if f.startswith("model/")], word


def test_the_picture_is_made_from_the_code_as_it_is():
    made = architecture.PICTURE.read_text(encoding="utf-8")
    assert made == architecture.picture(), "python -m tools.architecture"


def test_a_build_goes_the_way_that_the_picture_shows(tmp_path):
    steps = [(module, function) for module, function, *_ in architecture.FLOW]
    ended = []

    def note(frame, event, argument):
        step = frame.f_globals.get("__name__"), frame.f_code.co_name
        if event == "return" and step in steps and step not in ended:
            ended.append(step)

    sys.setprofile(note)
    try:
        build(tmp_path, machine_of())
    finally:
        sys.setprofile(None)
    assert ended == steps


def test_the_pages_packages_are_there():
    page = (architecture.ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    named = set(re.findall(r"`((?:model|rotor_fmu)/[a-z_/]+?)/?`", page))
    for package in architecture.order():
        if package.count(".") == 1 and architecture.modules()[package].name == "__init__.py":
            place = package.replace(".", "/")
            assert [name for name in named if f"{name}/".startswith(f"{place}/")], package
    for name in named:
        assert (architecture.ROOT / name).is_dir(), name
