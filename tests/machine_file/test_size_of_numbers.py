"""Numbers with which no analysis can calculate are refused where they are given."""

import pytest
from rotor_fmu.examples import example_folder
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.quantities import QuantityError, check

from rotor_fmu.errors import InputError
from rotor_fmu.fmi.interface import interface
from rotor_fmu.runs.settings_text import parse_settings
from tests.linear.api_617 import SHAFT

FILM = "[[journal_bearing]]\nnode = {}\njournal_radius = 0.02\nlength = {}\nclearance = 5e-5\n"
REST = "viscosity = 0.02\n[[disc]]\nnode = 4\ndiameter = 0.3\nwidth = 0.03\ne = 1e-5\nphase = {}\n"


def machine(length="0.02", phase="0.0"):
    films = [FILM.format(node, length) for node in (1, 7)]
    return parse_rotor(SHAFT + "viscosity = 0.02\n".join(films) + REST.format(phase))


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"length": "1e-300"}, "length = 1e-300 m: must be at least 1e-30 m"),
        ({"phase": "1e13"}, "phase = 1e+13 rad: must be finite and at most 1e+09 rad in size"),
        ({"phase": "-2e9"}, "phase = -2e+09 rad: must be finite and at most 1e+09 rad in size"),
    ],
)
def test_a_machine_of_them_is_refused(given, said):
    with pytest.raises(QuantityError) as refused:
        machine(**given)
    assert said in str(refused.value)


def test_what_is_just_allowed_has_modes():
    for given in ({"length": "1e-30"}, {"phase": "1e9"}):
        assert len(modes(machine(**given), 300.0).natural) == 8


def test_a_value_of_a_parameter_is_refused_too():
    rotor = machine()
    with pytest.raises(InputError) as refused:
        parse_settings(rotor, interface(rotor), ["disc[1].e=1e300"])
    assert str(refused.value) == "--set disc[1].e = 1e300: must not exceed 1e+30 in size"


@pytest.mark.parametrize("file", ["paper_rig/rig.toml", "turbocharger/rotor.toml"])
def test_the_limits_that_an_fmu_declares_are_allowed(file):
    example, name = file.split("/")
    rotor = parse_rotor((example_folder(example) / name).read_text(encoding="utf-8"))
    declared, limits = {v.name: v for v in interface(rotor)}, 0
    for name, of in rotor.parameters().items():
        for limit in (declared[name].least, declared[name].high):
            if limit is not None and not of.quantity.is_switch:
                check(name, of.quantity, limit)
                limits += 1
    assert limits > 10
