"""What a machine file has and cannot be varied is said to be so, with what can."""

import pytest
from rotor_fmu.model.machine.no_parameters import why_no_parameter
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.periodic.request import response_request
from rotor_fmu.runs.settings_text import parse_starts
from tests.linear.api_617 import SHAFT

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
SAID = {
    "support[1].stiffness": f"{FIXED}support[1] has none",
    "support.stiffness": f"{FIXED}support[1] has none",
    "support[7].stiffness": "is no parameter: a support has none",
    "disc[1].diameter": f"{FIXED}those of disc[1] are e, phase",
    "pedestal.kx": "is called housing[1].kx",
    "linear_bearing[1].kxx": "is no parameter: the machine file has a list for it; those of",
    "material.young": f"{FIXED}those of the shaft are eta_v",
    "material.brass.young": f"{FIXED}those of the shaft are eta_v",
    "disc[1].node": f"{FIXED}those of disc[1] are e, phase",
    "disc[1].z": f"{FIXED}those of disc[1] are e, phase",
    "inclination": f"{FIXED}that of the machine is gravity",
    "gravity_angle": f"{FIXED}that of the machine is gravity",
    "operation.rated_speed": f"{FIXED}that of the machine is gravity",
    "shaft.nodes": f"{FIXED}those of the shaft are eta_v",
}


@pytest.mark.parametrize("name", SAID)
def test_every_way_to_give_a_value_says_why_it_cannot_be(name, tmp_path):
    rotor = parse_rotor(MACHINE)
    (tmp_path / "machine.toml").write_text(MACHINE)
    study = tmp_path / "study.toml"
    study.write_text(
        "machine = 'machine.toml'\n[run]\nkind = 'run-down'\n[keep]\na = { peak = 'disc[1].x' }\n"
        f"[vary]\n'{name}' = {{ values = [1.0, 2.0] }}\n"
    )
    for ask in (
        lambda: read_study(study),
        lambda: parse_starts(rotor, False, [f"{name}=1"]),
        lambda: response_request(rotor, speed=10.0, over=(name, 1.0, 2.0)),
        lambda: response_request(rotor, speed=(10.0, 20.0), parameters={name: 1.0}),
    ):
        with pytest.raises(InputError) as refused:
            ask()
        assert f"{name}: {SAID[name]}" in str(refused.value)


def test_of_parameters_and_of_names_of_nothing_there_is_nothing_to_say():
    rotor = parse_rotor(MACHINE)
    for name in ("gravity", "shaft.eta_v", "spport[1].stiffness", "mu", ""):
        assert why_no_parameter(rotor, name) == ""
