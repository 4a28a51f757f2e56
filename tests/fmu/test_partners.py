"""What holds for every FMU of the examples that the rotor is coupled with."""

import math
import re
from dataclasses import dataclass

import fmpy
import pytest
from fmpy.validation import validate_fmu
from rotor_fmu.examples import example_folder
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import InputError
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build

from .test_coupling import SOURCE


@dataclass(frozen=True)
class Partner:
    """Its coupling, what it starts from, a parameter of it, an output, an input with what drives
    it, and what is seen of it."""

    coupling: Coupling
    starts: tuple
    parameter: str
    output: str
    inputs: tuple
    size: float
    seen: tuple
    step: float


PARTNERS = {
    "drive train": Partner(
        Coupling(example_folder("drive_train") / "drive_train.py"),
        ("w_start",),
        "kp",
        "w_motor",
        ("tau_load",),
        0.01,
        ("w", "phi", "tau_motor", "work_out", "loss"),
        1e-3,
    ),
    "magnetic bearing": Partner(
        Coupling(example_folder("magnetic_bearing") / "magnetic_bearing.py"),
        ("w", "left_x"),
        "kp",
        "left_fx",
        ("left_x", "left_dx"),
        1e-5,
        ("left_fx", "left_ixa", "left_sx", "work", "w_ref"),
        1e-4,
    ),
}


@pytest.fixture(scope="module", params=PARTNERS)
def partner(request):
    return PARTNERS[request.param]


@pytest.fixture(scope="module")
def built(partner, tmp_path_factory):
    return partner.coupling.build(tmp_path_factory.mktemp("partner"))


def test_the_description_is_valid_and_says_what_the_table_does(partner, built):
    assert validate_fmu(str(built)) == []
    description = fmpy.read_model_description(str(built))
    for variable, listed in zip(
        description.modelVariables, partner.coupling.variables, strict=True
    ):
        assert (variable.name, variable.unit) == (listed.name, listed.unit)


def test_an_fmu_without_outputs_is_valid_too(tmp_path):
    """As of one that only looks on."""
    source = tmp_path / "looks_on.py"
    source.write_text(SOURCE.replace('"output"', '"local"'))
    assert validate_fmu(str(Coupling(source).build(tmp_path))) == []


def test_a_unit_is_written_as_in_modelica(partner):
    """A quotient has one factor below its line, or several in parentheses."""
    written = re.compile(r"[^/]+(/(\([^/()]+\)|[^./()]+))?")
    assert [
        v.name for v in partner.coupling.variables if not written.fullmatch(v.unit or "1")
    ] == []


def test_building_twice_gives_the_same_bytes(partner, built, tmp_path):
    assert partner.coupling.build(tmp_path).read_bytes() == built.read_bytes()


def test_outputs_are_at_the_end_of_the_initialization_what_they_were_in_it(partner, built):
    given = {name: 1.0 + i for i, name in enumerate(partner.starts)}
    computed = [
        v.name
        for v in partner.coupling.variables
        if v.causality in ("output", "local") and v.name != "begun"
    ]
    with Member(built, {}, []) as member:
        member.set(given)
        before = member.get([*computed, "begun"])
        assert before == member.get([*computed, "begun"])
        assert before.pop("begun") == 0.0
        assert 1.0 in before.values()
        member.begin()
        assert member.get([*computed, "begun"]) == before | {"begun": 1.0}


def test_it_goes_on_from_a_saved_state(partner, built):
    with Member(built, {}, []) as member:
        member.begin()

        def march(first):
            rows = []
            for i in range(first, first + 300):
                member.set(dict.fromkeys(partner.inputs, partner.size * math.cos(i)))
                member.step(i * partner.step, partner.step)
                rows.append(member.get(partner.seen))
            return rows

        before = march(0)
        state = member._fmu.serializeFMUstate(member._fmu.getFMUState())
        first = march(300)
        assert first != before
        member._fmu.setFMUState(member._fmu.deSerializeFMUstate(state))
        assert march(300) == first


def refused(messages, call, *arguments):
    """What the FMU says when it refuses a call."""
    with pytest.raises(fmpy.fmi1.FMICallException):
        call(*arguments)
    return messages[-1]


def test_what_it_cannot_take_it_refuses_and_goes_on(partner, built):
    messages = []
    with Member(built, {}, messages) as member:
        fmu = member._fmu
        names = (partner.parameter, partner.output)
        gain, output = (member.variable(name).valueReference for name in names)
        given, count = member.get([partner.parameter]), len(partner.coupling.variables)
        early = refused(messages, fmu.doStep, 0.0, partner.step)
        assert early.endswith("doStep: the initialization has not ended")
        member.begin()
        late = refused(messages, fmu.exitInitializationMode)
        assert late.endswith("exitInitializationMode: the initialization has ended")
        for _ in range(20):  # a reference too few and the host would be gone
            message = refused(messages, fmu.getReal, [count])
            assert f"value reference {count}: must be from 0 to {count - 1}" in message
            message = refused(messages, fmu.setReal, [gain], [1.0])
            assert f"{partner.parameter}: is fixed once" in message
            message = refused(messages, fmu.setReal, [output], [1.0])
            assert f"{partner.output}: is computed" in message
            for call in (fmu.getInteger, fmu.getBoolean, fmu.getString):
                assert "all variables are Real" in refused(messages, call, [gain])
            assert "all variables are Real" in refused(messages, fmu.setInteger, [gain], [1])
            assert "all variables are Real" in refused(messages, fmu.setBoolean, [gain], [True])
            assert "all variables are Real" in refused(messages, fmu.setString, [gain], ["a"])
        for h in (0.0, math.inf, math.nan):
            assert f"doStep over {h:g} s: the step must be > 0" in refused(
                messages, fmu.doStep, 0.0, h
            )
        member.step(0.0, partner.step)
        assert member.get([partner.parameter]) == given


def test_a_partner_and_a_machine_of_one_name_do_not_take_each_others_place(tmp_path):
    coupling = PARTNERS["drive train"].coupling
    machine = machine_of(rig_toml().replace('"RotorBearing"', '"DriveTrain"'))
    for first, second, whose in (
        (coupling.build, lambda out: build(out, machine), "another model"),
        (lambda out: build(out, machine), coupling.build, "a machine"),
    ):
        out = tmp_path / whose
        content = first(out).read_bytes()
        with pytest.raises(InputError, match=rf"DriveTrain\.fmu: is the FMU of {whose}; must have"):
            second(out)
        assert [file.name for file in out.iterdir()] == ["DriveTrain.fmu"]
        assert first(out).read_bytes() == content
