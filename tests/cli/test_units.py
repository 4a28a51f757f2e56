"""Numbers with units, in machine files and on the command line; the sources are the definitions of
the units: inch 25.4 mm, pound 0.45359237 kg, standard gravity 9.80665 m/s2."""

import math
import re
import tomllib

import jsonschema
import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.parts.rolling_bearing import RollingBearing

import rotor_fmu as rf
from rotor_fmu.cli.nodes import clearances_of, cross_couplings
from rotor_fmu.cli.speeds import number_range
from rotor_fmu.errors import InputError
from rotor_fmu.fmi.description import unit_definitions
from rotor_fmu.fmi.interface import interface
from rotor_fmu.machine_file.loading import machine_text, si_text
from rotor_fmu.machine_file.schema import schema
from rotor_fmu.units import _MEASURED, in_si

from ..processes import run_anew
from .bearing_machines import ROLLING

INCH, POUND, G = 0.0254, 0.45359237, 9.80665
LBF = POUND * G


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("0.1", "m", 0.1),
        ("0.1 mm", "m", 1e-4),
        ("2 mil", "m", 2e-3 * INCH),
        ("2mils", "m", 2e-3 * INCH),
        ("5 µm", "m", 5e-6),
        ("50 g.mm", "kg.m", 5e-5),
        ("1 oz-in", "kg.m", POUND / 16 * INCH),
        ("5 gm-in", "kg.m", 5e-3 * INCH),
        ("1 psi", "Pa", LBF / INCH**2),
        ("0.283 lb/in3", "kg/m3", 0.283 * POUND / INCH**3),
        ("7 lbf/in", "N/m", 7 * LBF / INCH),
        ("7 lbf.s/in", "N.s/m", 7 * LBF / INCH),
        ("3000 rpm", "rad/s", 100 * math.pi),
        ("3000RPM", "rad/s", 100 * math.pi),
        ("50Hz", "rad/s", 100 * math.pi),
        ("3 kHz", "rad/s", 6000 * math.pi),
        ("3000 cpm", "rad/s", 100 * math.pi),
        ("50 rev/s", "rad/s", 100 * math.pi),
        ("60 rpm/s", "rad/s2", 2 * math.pi),
        ("90 deg", "rad", math.pi / 2),
        ("1 N/mm^1.5", "N/m**1.5", 1000**1.5),
        ("6 1/min", "1/s", 0.1),
        ("3 kg m ^ -3", "kg/m3", 3.0),
        ("1 m.s**-2", "m/s2", 1.0),
        ("5 percent", "1", 0.05),
        ("20 cP", "Pa.s", 0.02),
        ("2 bar", "Pa", 2e5),
        ("2 kJ/(kg.K)", "J/(kg.K)", 2000.0),
        ("2 kJ/(kg.°C)", "J/(kg.K)", 2000.0),
        ("0.45 cal/(g.degC)", "J/(kg.K)", 1882.8),
        ("1 ft.lbf/(lb.degF)", "J/(kg.K)", 1.8 * 9.80665 * 12 * INCH),
        ("40 degC", "degC", 40.0),
    ],
)
def test_a_unit_is_worth_what_its_definition_says(text, unit, expected):
    assert in_si("x =", text, unit) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("50 gr.mm", "kg.m", "x = 50 gr.mm: grams or grains? write g or grain"),
        ("7.8 gr/cm3", "kg/m3", "grams or grains?"),
        ("100 ton", "kg", "metric, short or long tons? write t, short_ton or long_ton"),
        ("100tons", "kg", "metric, short or long tons?"),
    ],
)
def test_a_name_of_two_units_is_refused(text, unit, expected):
    with pytest.raises(InputError) as refused:
        in_si("x =", text, unit)
    assert expected in str(refused.value)


def test_what_to_write_in_the_place_of_such_a_name_is_read():
    assert in_si("x =", "1 grain", "kg") == pytest.approx(POUND / 7000)
    assert in_si("x =", "1 short_ton", "kg") == pytest.approx(2000 * POUND)
    assert in_si("x =", "1 long_ton", "kg") == pytest.approx(2240 * POUND)
    assert in_si("x =", "1 t", "kg") == 1000.0


@pytest.mark.parametrize(
    ("text", "unit", "expected"),
    [
        ("3 rpm", "m", "x = 3 rpm: must be a length, in m or such as mm, um, inch, mil"),
        ("3 furlnog", "m", "x = 3 furlnog: the unit 'furlnog' is unknown; must be a length"),
        (
            "5 lb/in",
            "N/m",
            "x = 5 lb/in: must be a stiffness, in N/m or such as N/mm, MN/m, lbf",
        ),
        ("5 1/min", "rad/s", "radians or turns a '1/min'? must be a speed of rotation"),
        ("4 Hz", "1/s", "x = 4 Hz: must be a rate without turns, in 1/s or such as 1/min"),
        ("mm", "m", "x = mm: must be a number, in m or with mm or um or inch or mil behind it"),
        ("1:2", "rad/s", "x = 1:2: must be a number, in rad/s or with rpm or Hz behind it"),
        ("1e999 mm", "m", "x = 1e999 mm: must be a number"),
        ("3 kg", "m/J", "x = 3 kg: must be in m/J"),  # a kind of quantity without a name
        ("313 K", "degC", "x = 313 K: must be a temperature, in degC"),
        ("0,01 mm", "m", "x = 0,01 mm: the unit ',01 mm' is unknown; must be a length"),
        ("3 000 rpm", "rad/s", "x = 3 000 rpm: the unit '000 rpm' is unknown"),
        ("3,000rpm", "rad/s", "x = 3,000rpm: the unit ',000rpm' is unknown"),
        ("0 .5 mm", "m", "x = 0 .5 mm: the unit '.5 mm' is unknown"),
        ("1 mm 2", "m", "x = 1 mm 2: the unit 'mm 2' is unknown"),
        ("1+1 mm", "m", "x = 1+1 mm: the unit '+1 mm' is unknown"),
        ("2 mm-1 mm", "m", "x = 2 mm-1 mm: "),
        ("1 mm - 1 um", "m", "x = 1 mm - 1 um: the unit 'mm - 1 um' is unknown"),
        ("1 mm*2", "m", "x = 1 mm*2: the unit 'mm*2' is unknown"),
        ("2 mm!", "m", "x = 2 mm!: the unit 'mm!' is unknown"),
        ("2 mm#x", "m", "x = 2 mm#x: the unit 'mm#x' is unknown"),
        ("two\nmm", "m", r"x = two\nmm: must be a number"),
        ("2\nxx", "m", r"x = 2\nxx: the unit 'xx' is unknown"),
    ],
)
def test_a_unit_that_does_not_fit_is_one_line(text, unit, expected):
    with pytest.raises(InputError) as error:
        in_si("x =", text, unit)
    assert expected in str(error.value)


IN_UNITS = (
    rig_toml()
    .replace("clearance = 50e-6", 'clearance = "50 um"')
    .replace("diameter = 0.12", 'diameter = "12 cm"')
    .replace("young = 2.1e11", 'young = "210 GPa"')
    .replace("rated_speed = 400.0", 'rated_speed = "63.66197723675814 Hz"')
    .replace(
        "diameters = [0.015, 0.015, 0.0093,",
        'units = { diameters = "mm" }\ndiameters = [15, 15, "9.3 mm",',
    )
    .replace("0.0093, 0.0093, 0.0093, 0.015]", "9.3, 9.3, 9.3, 15]")
)


def test_the_unit_of_a_contact_stiffness_is_that_of_its_exponent(tmp_path, refusal):
    """In a file, on the command line and in the FMU; FMI has a unit without base units for a power
    that is no integer. A rolling bearing has Hertz' exponent where none is given."""
    hertzian = rig_toml().replace("clearance = 50e-6", "clearance = 50e-6\nexponent = 1.5", 1)
    file = tmp_path / "hertzian.toml"
    file.write_text(hertzian)
    setting = ["--rotor", str(file), "--set", "bearing[1].k=1e6 N/mm"]
    assert "1e6 N/mm: must be" in refusal("run-down", *setting)
    assert "in N/m^1.5" in refusal("response", *setting, "--speed", "100:110")
    variables = interface(parse_rotor(hertzian))
    units = {v.name: v.unit for v in variables if v.name.endswith("].k")}
    assert units == {"bearing[1].k": "N/m^1.5", "bearing[2].k": "N/m"}
    defined = {unit.get("name"): unit.find("BaseUnit") for unit in unit_definitions(variables)}
    assert defined["N/m^1.5"] is None
    assert defined["N/m"].attrib == {"kg": "1", "s": "-2"}
    text = re.sub(r"(?m)^k = .*$", 'k = "253 kN/mm^1.5"', ROLLING.read_text())
    first, *_ = rf.parse(text).rotor.of_kind(RollingBearing)
    assert first.k == pytest.approx(253e3 * 1000**1.5)


def test_a_machine_in_units_is_the_machine_in_si():
    machine, rig = rf.parse(IN_UNITS).rotor, parse_rotor(rig_toml())
    assert machine.bearings[0].clearance == pytest.approx(50e-6)
    assert machine.operation.rated_speed == pytest.approx(400.0)
    assert machine.material.young == pytest.approx(rig.material.young)
    for one, other in zip(machine.sections, rig.sections, strict=True):
        assert one.outer_left == pytest.approx(other.outer_left)
    assert [disc.diameter for disc in machine.discs] == pytest.approx([0.12] * 3)


def test_a_machine_without_units_is_left_as_it_is_written():
    assert si_text(rig_toml()) == rig_toml()


def test_what_is_built_into_an_fmu_is_in_si(tmp_path):
    (tmp_path / "rig.toml").write_text(IN_UNITS)
    text = machine_text("--rotor", tmp_path / "rig.toml")
    assert parse_rotor(text) == rf.parse(IN_UNITS).rotor


def test_the_units_of_a_file_that_is_extended_are_read_too(tmp_path):
    (tmp_path / "base.toml").write_text(IN_UNITS)
    (tmp_path / "more.toml").write_text(
        'extends = "base.toml"\n[[sensor]]\nname = "probe"\nz = "150 mm"\n'
    )
    rotor = parse_rotor(machine_text("--rotor", tmp_path / "more.toml"))
    assert len(rotor.nodes) == 9
    assert rotor.nodes[4] == pytest.approx(0.15)


TABLE = """
[[linear_bearing]]
node = 1
speed = [1000, 2000]
kxx = [20, 21]
kyy = ["20", "21e6 N/m"]
cxx = 2e3
cyy = 2e3
units = { speed = "rpm", kxx = "MN/m", kyy = "N/um" }
"""


def test_a_table_has_a_unit_a_column():
    bearing = next(p for p in rf.parse(rig_toml() + TABLE).rotor.parts if hasattr(p, "kxx"))
    assert bearing.speed == pytest.approx([1000 * math.pi / 30, 2000 * math.pi / 30])
    assert bearing.kxx == bearing.kyy == pytest.approx([20e6, 21e6])
    assert bearing.cxx == 2e3


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("kxx = [20, 21]", "kxx = [20, 21, 22]", "linear_bearing[1].kxx: 3 given, 2 needed"),
        ('"MN/m"', '"mm"', "linear_bearing[1].units.kxx = 'mm': must be a stiffness"),
        ('"MN/m"', '"2 MN/m"', "units.kxx = '2 MN/m': the unit '2 MN/m' is unknown; must be a st"),
        ('kyy = "N/um', 'kxy = "N/um', "units.kxy: no number of that name is here; did you"),
        ("{ speed", "1 # { speed", "linear_bearing[1].units = 1: must be a table"),
        ("node = 1", 'node = 1\nhousing = "3 mm"', "housing = '3 mm': no housing of that name"),
    ],
)
def test_a_table_whose_units_cannot_be_is_one_line(old, new, expected):
    assert old in TABLE
    with pytest.raises(InputError) as error:
        rf.parse(rig_toml() + TABLE.replace(old, new))
    assert expected in str(error.value)


def test_the_schema_takes_units_where_the_reader_does():
    jsonschema.validate(tomllib.loads(IN_UNITS + TABLE), schema())
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(tomllib.loads(IN_UNITS.replace('"50 um"', '"wide"')), schema())


def test_plain_numbers_and_rpm_need_no_library():
    script = (
        "import sys; sys.modules['pint'] = None\n"
        "import rotor_fmu as rf\n"
        "from rotor_fmu.units import in_si\n"
        "print(rf.load().name, in_si('x', '60 rpm', 'rad/s'))\n"
        "try: in_si('--hold', '1 hour', 's')\n"
        "except rf.InputError as error: print(error)\n"
    )
    done = run_anew(script)
    assert done.returncode == 0, done.stderr
    first, second = done.stdout.splitlines()
    assert first == f"zigulic2003 {2 * math.pi}"
    assert second == "--hold 1 hour: pint is not installed: pip install 'rotor-fmu[units]'"


def test_ranges_and_what_stands_at_nodes_take_every_unit_of_their_quantity():
    """1 lbf/in is 175.1268 N/m; Alford's formula of the second stage in SI units."""
    map_over = number_range("1e3:1e6lbf/in:3", 33, "--stiffness", "N/m")
    assert map_over == pytest.approx(175.1268 * np.linspace(1e3, 1e6, 3), rel=1e-6)
    assert number_range("9000rpm:11000rpm", 2, "--range", "rad/s")[0] == pytest.approx(300 * np.pi)
    assert clearances_of(["6:0.3mm", "7: 1e-4"]) == pytest.approx({6: 3e-4, 7: 1e-4})
    machine = rig()
    stages = ["4:500kW:300mm:20mm:2.5", "4:500e3:0.3:0.02:2.5"]
    one, other = (cross_couplings(machine, 100.0, [stage], None) for stage in stages)
    assert one == pytest.approx(other)
    assert cross_couplings(machine, 100.0, None, ["4:2kN/m"]) == pytest.approx({4: 2000.0})


@pytest.mark.parametrize(
    ("read", "message"),
    [
        (lambda: clearances_of(["6:3rpm"]), "--clearance 6: 3rpm: must be a length, in m or such"),
        (lambda: clearances_of(["6:0mm"]), "--clearance 6:0mm: must be NODE:RADIUS, RADIUS above"),
        (lambda: number_range("1:2psi", 2, "--stiffness", "N/m"), "must be a stiffness, in N/m"),
        (lambda: number_range("1:2 3 N/m", 2, "--stiffness", "N/m"), "the unit '3 N/m' is unknown"),
    ],
)
def test_a_unit_of_another_quantity_is_refused_in_options_too(read, message, capsys):
    """In one line: what is refused is not asked about before."""
    with pytest.raises(InputError, match=re.escape(message)):
        read()
    assert not capsys.readouterr().err


def test_the_units_that_a_message_gives_as_examples_are_read():
    for si, (_, examples) in _MEASURED.items():
        for unit in filter(None, examples.split(", ")):
            assert in_si("x =", f"1 {unit}", si) > 0.0
