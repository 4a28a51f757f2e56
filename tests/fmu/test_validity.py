"""The built file: valid by FMPy, the same bytes each time, carrying its own code."""

import os
import subprocess
import sys
import zipfile
from xml.etree.ElementTree import fromstring

import fmpy
import pytest
from fmpy.validation import validate_fmu
from rotor_fmu.model.machine.toml import rig, rig_toml
from rotor_fmu.model.quantities import SPEED

from rotor_fmu.fmu.description import reached_by
from rotor_fmu.fmu.interface import interface
from rotor_fmu.fmu.variables import Variable, unit
from rotor_fmu.packing.bundle import build, is_current


def test_fmpy_finds_no_problem(fmu):
    assert validate_fmu(str(fmu)) == []


def test_building_twice_gives_equal_bytes(fmu, tmp_path):
    assert build(tmp_path).read_bytes() == fmu.read_bytes()


def test_an_fmu_is_current_only_for_its_own_rotor(fmu):
    assert is_current(fmu)
    assert not is_current(fmu, rig_toml().replace("clearance = 50e-6", "clearance = 60e-6"))


def test_another_rotor_gives_another_guid(fmu, tmp_path):
    other = build(tmp_path, rig_toml().replace("clearance = 50e-6", "clearance = 60e-6"))
    first, second = (fmpy.read_model_description(str(path)) for path in (fmu, other))
    assert first.guid != second.guid
    clearance = next(v for v in second.modelVariables if v.name == "bearing[1].clearance")
    assert float(clearance.start) == pytest.approx(60e-6)


def test_every_variable_of_the_table_is_described(fmu):
    described = {v.name: v for v in fmpy.read_model_description(str(fmu)).modelVariables}
    for variable in interface(rig()):
        found = described[variable.name]
        assert found.causality == variable.causality
        assert found.description == variable.text
        assert found.type == variable.kind
        if variable.kind == "Real":
            assert found.unit == variable.unit
        if not variable.is_observed and variable.kind == "Real":
            assert float(found.start) == variable.start


def test_units_are_defined_by_si_exponents_and_shown_in_what_people_read(fmu):
    description = fmpy.read_model_description(str(fmu))
    defined = {unit.name: unit for unit in description.unitDefinitions}
    assert {v.unit for v in description.modelVariables if v.unit} <= set(defined)
    shown = {name: u.displayUnits[0].name for name, u in defined.items() if u.displayUnits}
    assert shown == {"m": "um", "rad": "deg", "rad/s": "rpm"}
    assert defined["rad/s"].displayUnits[0].factor == pytest.approx(unit("rad/s").display[1])
    torque = defined["N.m"].baseUnit
    assert (torque.kg, torque.m, torque.s) == (1, 2, -2)


def dependencies(fmu):
    """Names of the inputs that each output depends on, as the description has it."""
    with zipfile.ZipFile(fmu) as archive:
        root = fromstring(archive.read("modelDescription.xml"))
    names = [variable.get("name") for variable in root.iterfind("ModelVariables/ScalarVariable")]
    return {
        names[int(unknown.get("index")) - 1]: {
            names[int(index) - 1] for index in unknown.get("dependencies").split()
        }
        for unknown in root.iterfind("ModelStructure/Outputs/Unknown")
    }


def test_outputs_depend_on_the_inputs_that_reach_them_within_an_instant(fmu, free_fmu):
    """Torques and the acceleration do; what the motion says does not (tests/test_observe.py)."""
    for file, dependent in ((fmu, {"tau", "tau_load"}), (free_fmu, {"a", "tau", "tau_load"})):
        variables = fmpy.read_model_description(str(file)).modelVariables
        inputs = {v.name for v in variables if v.causality == "input"}
        expected = {v.name: set() for v in variables if v.causality == "output"}
        expected |= dict.fromkeys(dependent, inputs)
        assert dependencies(file) == expected


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
    assert len(outputs) <= 19


def test_it_runs_where_nothing_of_this_project_can_be_imported(fmu, tmp_path):
    """With the project's own packages barred, from an FMU that only carries its own code."""
    script = (
        "import sys, fmpy\n"
        "sys.modules['rotor_fmu'] = None\n"
        "r = fmpy.simulate_fmu(sys.argv[1], stop_time=0.2, output=['phi', 'disc[3].y'])\n"
        "print(r['phi'][-1], r['disc[3].y'][0])\n"
    )
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"}
    done = subprocess.run(
        [sys.executable, "-c", script, str(fmu)],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env=environment,
        check=False,
    )
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
