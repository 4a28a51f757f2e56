"""What a machine file has and cannot be varied is said to be so, with what can."""

import pytest
from rotor_fmu.model.machine.no_parameters import why_no_parameter
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.periodic.request import response_request
from rotor_fmu.runs.settings_text import machine_values, parse_starts
from tests.linear.api_617 import SHAFT
from tests.parts.films import OF_A_FILM
from tests.toml_text import table

MACHINE = (
    SHAFT
    + """
[[support]]
node = 1
stiffness = 1e7
[[housing]]
name = "pedestal"
mass = 3.0
kx = 2e7
ky = 2e7
cx = 100.0
cy = 100.0
[[linear_bearing]]
node = 7
speed = [100.0, 200.0]
kxx = [1e7, 2e7]
kyy = 1e7
cxx = 100.0
cyy = 100.0
housing = "pedestal"
[[disc]]
node = 4
diameter = 0.3
width = 0.03
e = 1e-5
"""
)
FIXED = "is no parameter: the machine file fixes it; "
DISC = f"{FIXED}those of disc[1] are diameter, width, e, phase, bore"
# Of what neither an FMU nor a study or a response changes.
SAID = {
    "pedestal.kx": "is called housing[1].kx",
    "linear_bearing[1].kxx": "is no parameter: the machine file has a list for it; those of",
    "material.young": f"{FIXED}those of the shaft are eta_v",
    "material.brass.young": f"{FIXED}those of the shaft are eta_v",
    "disc[1].node": DISC,
    "disc[1].z": DISC,
    "inclination": f"{FIXED}that of the machine is gravity",
    "gravity_angle": f"{FIXED}that of the machine is gravity",
    "operation.rated_speed": f"{FIXED}that of the machine is gravity",
    "shaft.nodes": f"{FIXED}those of the shaft are eta_v",
}
# Of what an FMU has in its matrices: a study, or a response, makes them anew.
SAID_BY_AN_FMU = {
    "support[1].stiffness": f"{FIXED}support[1] has none",
    "support.stiffness": f"{FIXED}support[1] has none",
    "support[7].stiffness": "is no parameter: a support has none",
    "disc[1].diameter": f"{FIXED}those of disc[1] are e, phase",
    "disc[1].node": f"{FIXED}those of disc[1] are e, phase",
    "disc[1].z": f"{FIXED}those of disc[1] are e, phase",
}


def study_over(name, folder, machine=MACHINE, vary="{ values = [0.1, 0.2] }"):
    (folder / "machine.toml").write_text(machine)
    file = folder / "study.toml"
    file.write_text(
        "machine = 'machine.toml'\n[run]\nkind = 'run-down'\nfrom = 50\nrate = 1e4\n"
        f"[keep]\na = {{ last = 'disc[1].y' }}\n[vary]\n'{name}' = {vary}\n"
    )
    return read_study(file)


@pytest.mark.parametrize("name", SAID)
def test_every_way_to_give_a_value_says_why_it_cannot_be(name, tmp_path):
    rotor = parse_rotor(MACHINE)
    for ask in (
        lambda: study_over(name, tmp_path),
        lambda: response_request(rotor, speed=10.0, over=(name, 1.0, 2.0)),
        lambda: response_request(rotor, speed=(10.0, 20.0), parameters={name: 1.0}),
    ):
        with pytest.raises(InputError) as refused:
            ask()
        assert f"{name}: {SAID[name]}" in str(refused.value)


@pytest.mark.parametrize("name", SAID | SAID_BY_AN_FMU)
def test_an_fmu_says_what_it_has_fixed(name):
    with pytest.raises(InputError) as refused:
        parse_starts(parse_rotor(MACHINE), False, [f"{name}=1"])
    assert f"{name}: {(SAID | SAID_BY_AN_FMU)[name]}" in str(refused.value)


@pytest.mark.parametrize(
    ("name", "value", "in_file", "instead"),
    [
        ("support[1].stiffness", 2e7, "stiffness = 1e7", "stiffness = 2e7"),
        ("disc[2].diameter", 0.2, "diameter = 0.3", "diameter = 0.2"),
    ],
)
def test_a_study_varies_what_an_fmu_has_fixed(name, value, in_file, instead, tmp_path):
    """A run is that of the machine with that number in its file."""
    rows = [
        study_over(name, tmp_path).model.run({name: value}),
        study_over(name, tmp_path, MACHINE.replace(in_file, instead)).model.run({}),
        study_over(name, tmp_path).model.run({}),
    ]
    sags = [row.cells["a"] for row in rows]
    assert sags[0] == sags[1] != sags[2]


def test_a_response_is_over_what_an_fmu_has_fixed():
    request = response_request(
        parse_rotor(MACHINE), speed=150.0, over=("support[1].stiffness", 1e7, 2e7)
    )
    assert [rotor.parts[-1].stiffness for rotor in request.ends()] == [1e7, 2e7]


def test_of_parameters_and_of_names_of_nothing_there_is_nothing_to_say():
    rotor = parse_rotor(MACHINE)
    for name in ("gravity", "shaft.eta_v", "spport[1].stiffness", "mu", ""):
        assert why_no_parameter(rotor, name, rotor.parameters()) == ""


def test_what_is_counted_has_no_distribution_and_no_curve(tmp_path):
    """A curve over it ended in a traceback, and every row of a study was a failed one."""
    text = MACHINE + table("[journal_bearing]", node=1, length=0.02, **OF_A_FILM)
    name = "journal_bearing[1].points"
    with pytest.raises(InputError, match=r"journal_bearing\[1\].points = .*: must be a whole numb"):
        response_request(parse_rotor(text), speed=150.0, over=(name, 40.0, 61.0))
    drawn = "{ distribution = 'uniform', low = 40, high = 60 }\n[design]\nkind = 'random'\nsize = 2"
    for vary, said in (
        (drawn, r"vary .*: journal_bearing\[1\].points = .*: must be a whole number"),
        ("{ values = [40.5] }", r"points = 40.5: must be a whole number"),
    ):
        with pytest.raises(InputError, match=said):
            study_over(name, tmp_path, text, vary)
    study_over(name, tmp_path, text, "{ values = [40, 41] }")


def test_a_wall_is_varied_in_the_unit_that_its_exponent_gives_it(tmp_path):
    """The study called it N/m, and refused the right unit."""
    wall = table("[contact]", node=4, journal_radius=0.02, clearance=1e-4, k=1e8, mu=0.1)
    (tmp_path / "machine.toml").write_text(MACHINE + wall)
    file = tmp_path / "study.toml"
    file.write_text(
        "machine = 'machine.toml'\n[run]\nkind = 'linear'\nspeed = 150\nto = 200\n"
        "[set]\n'contact[1].c' = '1 kN.s/m'\n'contact[1].exponent' = 1.5\n"
        "[keep]\na = { mode = 'frequency' }\n"
        "[vary]\n'contact[1].k' = { values = ['1e9 N/m^1.5', 2e9] }\n"
    )
    (axis,) = read_study(file).design.axes
    assert (axis.values, axis.unit) == ((1e9, 2e9), "N/m^1.5")
    text = file.read_text().replace("contact[1].c' = '1 kN.s/m'", "contact[1].k' = '2e9 N/m^1.5'")
    file.write_text(text.partition("[vary]")[0] + "[vary]\ngravity = { values = [1.0] }\n")
    assert read_study(file).model.values["contact[1].k"] == 2e9
    given = {"contact[1].k": "2e9 N/m^1.5", "contact[1].exponent": "1.5"}
    assert machine_values("", parse_rotor(MACHINE + wall), given)["contact[1].k"] == 2e9
