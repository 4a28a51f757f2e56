"""FMUs that others built: units of types and of other names, and what an FMU says it cannot do."""

import zipfile
from pathlib import Path

import pytest

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.master import coupled
from rotor_fmu.errors import InputError

from .test_coupling import SOURCE

PAIR = [("motor.w", "rotor.speed")]


@pytest.fixture(scope="module")
def partner(tmp_path_factory):
    source = tmp_path_factory.mktemp("partner") / "steady_motor.py"
    source.write_text(SOURCE)
    return Coupling(source).build(source.parent)


def edited(fmu, folder, *replacements):
    """The FMU with texts of its description replaced, each once."""
    other = folder / "Other.fmu"
    with zipfile.ZipFile(fmu) as old, zipfile.ZipFile(other, "w") as new:
        for entry in old.infolist():
            content = old.read(entry)
            if entry.filename == "modelDescription.xml":
                text = content.decode()
                for right, wrong in replacements:
                    assert right in text
                    text = text.replace(right, wrong, 1)
                content = text.encode()
            new.writestr(entry, content)
    return other


def with_unit(fmu, folder, unit, base, of_type):
    """The FMU with another unit of its output w, which may be that of a type."""
    given = 'declaredType="Speed"' if of_type else f'unit="{unit}"'
    with zipfile.ZipFile(fmu) as archive:
        text = archive.read("modelDescription.xml").decode()
    w = text[text.index('name="w"') : text.index('name="work"')]
    kind = f'<SimpleType name="Speed"><Real unit="{unit}"/></SimpleType>'
    defined = f'<Unit name="{unit}"><BaseUnit {base}/></Unit></UnitDefinitions>'
    types = f"{defined}<TypeDefinitions>{kind}</TypeDefinitions>"
    return edited(
        fmu,
        folder,
        (w, w.replace('unit="rad/s" displayUnit="rpm"', given)),
        ("</UnitDefinitions>", types),
    )


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


def test_an_extracted_fmu_may_be_named_from_where_the_process_is(
    fmu, native_fmu, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    for file, folder in ((fmu, "python"), (native_fmu, "native")):
        with zipfile.ZipFile(file) as archive:
            archive.extractall(folder)
    with coupled({"one": Path("python"), "other": Path("native")}, [], stop=0.01) as opened:
        assert opened.run(0.01).status == "ok"


def test_an_fmu_that_can_be_there_only_once_is_not_there_twice(partner, fmu, tmp_path):
    once = "canBeInstantiatedOnlyOncePerProcess="
    other = edited(partner, tmp_path, (f'{once}"false"', f'{once}"true"'))
    fmus = {"left": other, "rotor": fmu, "right": other}
    expected = "^fmus: left, right: are of one FMU, which can be there only once$"
    with pytest.raises(InputError, match=expected), coupled(fmus, [], stop=1.0):
        pass
    with coupled({"left": other, "rotor": fmu}, [], stop=0.01) as opened:
        assert opened.run(0.01).status == "ok"


def test_an_fmu_that_takes_equal_steps_only_is_asked_for_no_others(partner, tmp_path):
    varies = "canHandleVariableCommunicationStepSize="
    other = edited(partner, tmp_path, (f'{varies}"true"', f'{varies}"false"'))
    with coupled({"motor": other}, [], stop=1.0) as opened:
        with pytest.raises(InputError, match=r"^step = 0.3 s: must divide stop = 1 s: motor takes"):
            opened.run(0.3)
        assert len(opened.run(0.25).t) == 5
