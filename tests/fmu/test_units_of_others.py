"""Units of FMUs that others built: those of types, and those of other names."""

import zipfile

import pytest

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.master import coupled
from rotor_fmu.errors import InputError

from .test_coupling import SOURCE

NAME, DESCRIPTION = 'name="w"', "modelDescription.xml"
PAIR = [("motor.w", "rotor.speed")]


@pytest.fixture(scope="module")
def partner(tmp_path_factory):
    source = tmp_path_factory.mktemp("partner") / "steady_motor.py"
    source.write_text(SOURCE)
    return Coupling(source).build(source.parent)


def with_unit(fmu, folder, unit, base, of_type):
    """The FMU with another unit of its output w, which may be that of a type."""
    other = folder / "Other.fmu"
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(other, "w") as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename == DESCRIPTION:
                before, at, after = content.decode().partition(NAME)
                given = 'declaredType="Speed"' if of_type else f'unit="{unit}"'
                after = after.replace('unit="rad/s" displayUnit="rpm"', given, 1)
                content = before + at + after
                defined = f'<Unit name="{unit}"><BaseUnit {base}/></Unit>'
                ends = content.replace("</UnitDefinitions>", f"{defined}</UnitDefinitions>", 1)
                kind = f'<SimpleType name="Speed"><Real unit="{unit}"/></SimpleType>'
                types = f"</UnitDefinitions><TypeDefinitions>{kind}</TypeDefinitions>"
                content = ends.replace("</UnitDefinitions>", types, 1).encode()
            new.writestr(entry, content)
    return other


@pytest.mark.parametrize("of_type", [False, True])
def test_a_unit_is_that_of_the_variable_or_of_its_type(partner, fmu, tmp_path, of_type):
    """As Modelica tools write them: revolutions per minute went into rad/s without a word."""
    base = 's="-1" rad="1" factor="0.10471975511965977"'
    other = with_unit(partner, tmp_path, "rpm", base, of_type)
    said = r"^connections: motor\.w \[rpm\], rotor\.speed \[rad/s\]: must have the same unit$"
    with (
        pytest.raises(InputError, match=said),
        coupled({"motor": other, "rotor": fmu}, PAIR, stop=1.0),
    ):
        pass


@pytest.mark.parametrize("of_type", [False, True])
def test_a_unit_of_another_name_is_what_the_fmu_says_that_it_is(partner, fmu, tmp_path, of_type):
    other = with_unit(partner, tmp_path, "radians per second", 's="-1" rad="1"', of_type)
    with coupled({"motor": other, "rotor": fmu}, PAIR, stop=0.01) as opened:
        assert opened.run(0.01)["motor"]["w"][0] == 100.0
