"""The built file: valid by FMPy, the same bytes each time, carrying its own code."""

import ast
import math
import re
import sys
import tomllib
import zipfile
from functools import cache
from hashlib import sha256
from pathlib import Path
from xml.etree.ElementTree import fromstring

import fmpy
import pint
import pytest
from fmpy.validation import validate_fmu
from rotor_fmu.examples import example_folder
from rotor_fmu.model.machine.toml import rig, rig_toml
from rotor_fmu.model.quantities import SPEED

from rotor_fmu.fmi.description import reached_by
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.archive import contents_of
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build, is_current
from rotor_fmu.fmi.variables import Variable, unit
from rotor_fmu.library.build import LibraryError
from rotor_fmu.machine_file.loading import load_rotor

from ..processes import run_anew

ROOT = Path(__file__).parents[2]


def test_fmpy_finds_no_problem(fmu):
    assert validate_fmu(str(fmu)) == []


def test_building_twice_gives_equal_bytes(fmu, tmp_path):
    assert build(tmp_path, machine_of()).read_bytes() == fmu.read_bytes()


def test_an_fmu_is_current_only_for_its_own_rotor(fmu):
    assert is_current(fmu, machine_of())
    other = rig_toml().replace("clearance = 50e-6", "clearance = 60e-6")
    assert not is_current(fmu, machine_of(other))


whole = cache(contents_of)


def remade(fmu, target, **changes):
    """A copy with some files replaced, added or, where None, left out."""
    with zipfile.ZipFile(target, "w") as sink:
        for name, data in (whole(fmu) | changes).items():
            if data is not None:
                sink.writestr(name, data)
    return target


def test_an_fmu_is_current_only_with_all_that_it_would_hold_now(fmu, tmp_path):
    contents, machine = whole(fmu), machine_of()
    assert is_current(remade(fmu, tmp_path / "same.fmu"), machine)
    ours = [n for n in contents if not n.startswith(("binaries/", "resources/pythonfmu/"))]
    # of each folder one, since they are treated alike
    ours = {name.rpartition("/")[0]: name for name in ours if "slavemodule" not in name}.values()
    for name in {*ours, "model.png", "resources/rotor.toml", "modelDescription.xml"}:
        assert not is_current(remade(fmu, tmp_path / "old.fmu", **{name: b"old"}), machine), name
        assert not is_current(remade(fmu, tmp_path / "less.fmu", **{name: None}), machine), name
    for folder in ("binaries/linux64/", "binaries/win64/", "resources/pythonfmu/"):
        without = dict.fromkeys(name for name in contents if name.startswith(folder))
        assert without
        assert not is_current(remade(fmu, tmp_path / "less.fmu", **without), machine), folder
    for name in ("documentation/more.txt", "resources/more.py"):
        assert not is_current(remade(fmu, tmp_path / "more.fmu", **{name: b""}), machine), name


def test_an_fmu_of_another_version_of_pythonfmu_is_not_current(fmu, tmp_path):
    description = contents_of(fmu)["modelDescription.xml"]
    by_another = description.replace(b"PythonFMU ", b"PythonFMU 1")
    older = remade(fmu, tmp_path / "tool.fmu", **{"modelDescription.xml": by_another})
    assert not is_current(older, machine_of())


def test_it_holds_its_skin_its_libraries_its_machine_and_nothing_else(fmu):
    with zipfile.ZipFile(fmu) as archive:
        names = set(archive.namelist())
    (script,) = (name for name in names if name.endswith("_entry.py"))
    package = script.removesuffix("_entry.py")
    libraries = {name for name in names if name.endswith(("/linux64.so", "/win64.dll"))}
    assert libraries
    skin = {f"{package}/{name}.py" for name in ("__init__", "slave", "wrapper")}
    machine = {f"resources/{name}" for name in ("machine.table", "rotor.toml", "slavemodule.txt")}
    beside = ("binaries/", "resources/pythonfmu/", "documentation/", "extra/", "terminalsAndIcons/")
    result = {name for name in names if not name.startswith(beside)}
    assert result == {script, "modelDescription.xml", "model.png"} | skin | libraries | machine
    assert all(library.startswith(f"{package}/") for library in libraries)
    with zipfile.ZipFile(fmu) as archive:
        sums = {Path(name).name: sha256(archive.read(name)).hexdigest() for name in libraries}
        scope = {}
        exec(archive.read(f"{package}/__init__.py"), scope)
    assert scope["CHECKSUMS"] == sums


def test_it_imports_nothing_that_a_bare_python_has_not(fmu):
    imported = set()
    with zipfile.ZipFile(fmu) as archive:
        for name in archive.namelist():
            if name.endswith(".py"):
                for node in ast.walk(ast.parse(archive.read(name))):
                    if isinstance(node, ast.Import):
                        imported |= {alias.name.partition(".")[0] for alias in node.names}
                    elif isinstance(node, ast.ImportFrom) and not node.level:
                        imported.add(node.module.partition(".")[0])
    # which the FMU carries itself
    assert imported - sys.stdlib_module_names == {"pythonfmu"}


def test_its_documents_name_what_it_requires(fmu):
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    python = project["requires-python"].removeprefix(">=")
    with zipfile.ZipFile(fmu) as archive:
        for page in ("externalDependencies.txt", "index.html"):
            text = " ".join(archive.read(f"documentation/{page}").decode().split())
            assert f"Python {python} or newer, and" in text
            assert "no package beside it" in text
    readme = " ".join((ROOT / "README.md").read_text(encoding="utf-8").split())
    assert f"Python {python} or newer and no package beside it" in readme


def test_another_rotor_gives_another_guid(fmu, tmp_path):
    other = build(
        tmp_path, machine_of(rig_toml().replace("clearance = 50e-6", "clearance = 60e-6"))
    )
    first, second = (fmpy.read_model_description(str(path)) for path in (fmu, other))
    assert first.guid != second.guid
    clearance = next(v for v in second.modelVariables if v.name == "bearing[1].clearance")
    assert float(clearance.start) == pytest.approx(60e-6)


def test_every_variable_of_the_table_is_described(fmu):
    described = {v.name: v for v in fmpy.read_model_description(str(fmu)).modelVariables}
    for variable in interface(rig()):
        result = described[variable.name]
        assert result.causality == variable.causality
        assert result.description == variable.text
        assert result.type == variable.kind
        if variable.kind == "Real":
            assert result.unit == variable.unit
        if not variable.is_observed and variable.kind == "Real":
            assert float(result.start) == variable.start


@pytest.mark.parametrize("is_free", [False, True])
def test_the_text_of_each_input_says_which_fmu_takes_its_derivative(is_free):
    """FMI 3.0 and pythonfmu have none."""
    inputs = [v.text for v in interface(rig(), is_free) if v.causality == "input"]
    assert len(inputs) > 1
    for text in inputs:
        assert text.endswith("by its derivative in an FMI 2.0 FMU without Python"), text


def test_limits_nominal_values_and_unknowns_are_those_of_the_table(fmu):
    root = fromstring(contents_of(fmu)["modelDescription.xml"])
    table = interface(rig())
    variables = root.findall("ModelVariables/ScalarVariable")
    for variable, output in zip(table, variables, strict=True):
        said = {key: output[0].get(key) for key in ("min", "max", "nominal")}
        limits = (variable.least, variable.high) if variable.kind != "Boolean" else (None, None)
        nominal = variable.nominal if variable.kind == "Real" else None
        for key, value in zip(said, (*limits, nominal), strict=True):
            assert (value is None) == (said[key] is None), (variable.name, key)
            assert value is None or float(said[key]) == value, (variable.name, key)
    outputs = [i for i, variable in enumerate(table, 1) if variable.causality == "output"]
    unknowns = root.iterfind("ModelStructure/InitialUnknowns/Unknown")
    assert [int(unknown.get("index")) for unknown in unknowns] == outputs


def test_a_parameter_of_the_machine_has_the_limits_of_its_rule():
    """A machine that starts in motion: velocities may be negative."""
    rotor = load_rotor(example_folder("drop") / "compressor.toml")[1]
    table = {variable.name: variable for variable in interface(rotor)}
    for name, parameter in rotor.parameters().items():
        variable, rule = table[name], parameter.quantity.rule
        if variable.kind == "Boolean":
            continue
        limits = (
            -math.inf if variable.low is None else variable.low,
            math.inf if variable.high is None else variable.high,
        )
        assert limits == (rule.least, rule.most)


def test_units_are_defined_by_si_exponents_and_shown_in_what_people_read(fmu):
    description = fmpy.read_model_description(str(fmu))
    defined = {unit.name: unit for unit in description.unitDefinitions}
    assert {v.unit for v in description.modelVariables if v.unit} <= set(defined)
    shown = {name: u.displayUnits[0].name for name, u in defined.items() if u.displayUnits}
    assert shown == {"m": "um", "rad": "deg", "rad/s": "rpm"}
    assert defined["rad/s"].displayUnits[0].factor == pytest.approx(unit("rad/s").display[1])
    for name in defined.keys() - {"1"}:
        base, expected = defined[name].baseUnit, read_by_pint(name).dimensionality
        for dimension, exponent in (("mass", base.kg), ("length", base.m), ("time", base.s)):
            assert exponent == expected.get(f"[{dimension}]", 0), name


def read_by_pint(name):
    """A unit of the FMU as pint reads it."""
    spelled = re.sub(r"(?<=[a-z])(\d)", r"**\1", name.replace(".", "*"))
    return pint.application_registry.parse_units("" if name == "1" else spelled)


@pytest.mark.parametrize("is_free", [False, True])
def test_a_derivative_by_the_drive_has_its_unit_over_that_of_the_drive(is_free):
    units = {v.name: v.unit for v in interface(rig(), is_free)}
    drive = read_by_pint(units["tau_drive" if is_free else "speed"])
    derivatives = [name for name in units if name.endswith("_ddrive")]
    assert len(derivatives) == 4
    for name in derivatives:
        of = read_by_pint(units[name.removeprefix("d").removesuffix("_ddrive")])
        assert (read_by_pint(units[name]) * drive).dimensionality == of.dimensionality, name


def dependencies(fmu):
    """Names of the inputs that each output depends on, as the description has it."""
    root = fromstring(contents_of(fmu)["modelDescription.xml"])
    names = [variable.get("name") for variable in root.iterfind("ModelVariables/ScalarVariable")]
    return {
        names[int(unknown.get("index")) - 1]: {
            names[int(index) - 1] for index in unknown.get("dependencies").split()
        }
        for unknown in root.iterfind("ModelStructure/Outputs/Unknown")
    }


def test_outputs_depend_on_the_inputs_that_reach_them_within_an_instant(fmu, free_fmu):
    """Torques and the acceleration do; what the motion says does not: see
    `tests/physics/test_observe.py`."""
    for file, dependent in ((fmu, {"tau", "tau_load"}), (free_fmu, {"a", "tau_load"})):
        variables = fmpy.read_model_description(str(file)).modelVariables
        inputs = {v.name for v in variables if v.causality == "input"}
        expected = {v.name: set() for v in variables if v.causality == "output"}
        expected |= dict.fromkeys(dependent, inputs)
        if file == free_fmu:
            expected["tau"] = {"tau_drive"}
        assert dependencies(file) == expected


def test_a_wave_depends_on_the_force_of_its_own_line(tmp_path):
    line = '[[line]]\nnode = 2\nimpedance = 50.0\nname = "joint"\n'
    of = dependencies(build(tmp_path, machine_of(rig_toml() + line)))
    assert (of["joint.wave_x"], of["joint.wave_y"]) == ({"joint.fx"}, {"joint.fy"})


def test_the_speed_reaches_an_output_where_it_is_an_input():
    force = Variable("f", "Real", "output", "a force by the speed", reached_by=SPEED)
    driven = (Variable("speed", "Real", "input", ""), Variable("fx", "Real", "input", ""), force)
    free = (Variable("tau_drive", "Real", "input", ""), force)
    assert reached_by(driven, force) == [0]
    assert reached_by(free, force) == []


def test_names_are_not_cut_short_by_fmpy(fmu):
    outputs = [
        v.name
        for v in fmpy.read_model_description(str(fmu)).modelVariables
        if v.causality in ("input", "output")
    ]
    assert max(map(len, outputs)) <= 18


def test_the_outputs_fit_fmpys_plot(fmu):
    outputs = [
        v for v in fmpy.read_model_description(str(fmu)).modelVariables if v.causality == "output"
    ]
    assert len(outputs) <= 17


def test_it_runs_where_nothing_of_this_project_can_be_imported(fmu, tmp_path):
    """With the project's own packages barred, from an FMU that only carries its own code."""
    script = (
        "import sys, fmpy\n"
        "sys.modules['rotor_fmu'] = None\n"
        "r = fmpy.simulate_fmu(sys.argv[1], stop_time=0.2, output=['phi', 'disc[3].y'])\n"
        "print(r['phi'][-1], r['disc[3].y'][0])\n"
    )
    done = run_anew(script, fmu, cwd=tmp_path, PYTHONPATH="")
    assert done.returncode == 0, done.stderr
    phi, y = map(float, done.stdout.split()[-2:])
    assert phi == pytest.approx(80.0, rel=1e-9)
    assert y == pytest.approx(-238.4e-6, abs=0.3e-6)


def test_it_carries_no_caches_and_says_what_it_needs(fmu):
    with zipfile.ZipFile(fmu) as archive:
        names = archive.namelist()
        needs = archive.read("documentation/externalDependencies.txt").decode()
    assert not [name for name in names if "__pycache__" in name]
    assert "Python 3.11" in needs


@pytest.mark.parametrize("is_free", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_a_reduction_is_built_in_and_named(tmp_path, is_free):
    """The host sees it among the start values, and cannot change it."""
    reduced = build(tmp_path, machine_of(is_free=is_free, reduction=4))
    assert is_current(reduced, machine_of(is_free=is_free, reduction=4))
    assert not is_current(reduced, machine_of(is_free=is_free))
    description = fmpy.read_model_description(str(reduced))
    output = {v.name: v for v in description.modelVariables}
    assert output["solver.reduction"].start == "4"
    sizes = [
        len(zipfile.ZipFile(f).read("resources/machine.table"))
        for f in (reduced, build(tmp_path / "whole", machine_of(is_free=is_free)))
    ]
    assert sizes[0] < sizes[1]


def test_without_a_library_an_fmu_is_not_built_and_a_sentence_says_what_makes_one(
    tmp_path, monkeypatch
):
    monkeypatch.setattr("rotor_fmu.library.build.find", lambda *_: None)
    monkeypatch.setattr("rotor_fmu.fmi.packing.python_fmu.find", lambda *_: None)
    monkeypatch.setattr("rotor_fmu.library.build.find_spec", lambda name: None)
    with pytest.raises(
        LibraryError, match=r"no library .* for linux64.*pip install 'rotor-fmu\[(kernels|build)\]'"
    ):
        build(tmp_path, machine_of())
    monkeypatch.setattr("rotor_fmu.fmi.packing.python_fmu.here", lambda: "aarch64-darwin")
    with pytest.raises(
        LibraryError, match=r"no library .* rotor-fmu library --platform linux64 makes"
    ):
        build(tmp_path, machine_of())
    assert list(tmp_path.iterdir()) == []
