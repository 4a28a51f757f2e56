"""What the FMUs of a coupled system are called: in its pairs, in messages, in a saved run."""

import re

import pytest

from rotor_fmu.cosimulation.master import coupled
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native


@pytest.fixture(scope="module")
def native_3(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fmi3")
    return build_native(folder, machine_of(), fmi=3, platforms=["linux64"])


def test_of_two_fmus_of_one_file_a_message_says_which(native_3):
    fmus, pairs = {"left": native_3, "right": native_3}, []
    given = {"right": {"bearing[1].k": -1.0}}
    expected = r"^right: RotorBearingNative\.fmu: bearing\[1\]\.k = -1 N/m: must be > 0"
    with (
        pytest.raises(RunFailed, match=expected),
        coupled(fmus, pairs, parameters=given, stop=1.0) as opened,
    ):
        opened.run(0.5)


def test_of_two_fmus_of_one_file_a_warning_says_which(fmu, native_fmu, native_3, capfd):
    given = {"solver.preset": 3, "solver.tolerance": 1e-4}  # fixed steps have no tolerance
    for file in (fmu, native_fmu, native_3):
        two = dict.fromkeys(("left", "right"), file)
        with coupled(two, [], parameters={"left": given}, stop=1.0) as opened:
            opened.run(0.5)
        (said,) = (m for m in opened.messages if m.code == "idle-setting")
        assert said.startswith(f"left: {file.name}: solver.tolerance = 0.0001: has no effect")
        assert "left: warning: solver.tolerance = 0.0001: has no effect" in capfd.readouterr().err


@pytest.mark.parametrize("name", ["my rotor", "a.b", "", "a\nb", "a\0b", "\udcff", 1])
def test_a_name_that_is_no_word_is_refused(native_3, name):
    """A saved run of `my rotor` was read as one of `my`."""
    said = re.escape(f"fmus: {name!r}: must be a word without a dot")
    with pytest.raises(InputError, match=f"^{said}$"), coupled({name: native_3}, [], stop=1.0):
        pass


def test_arguments_of_another_type_are_refused_by_name_and_a_text_is_a_path(native_3):
    with coupled({"rotor": str(native_3)}, [], stop=1.0) as opened:
        assert opened.run(0.5).status == "ok"
    for given, said in (
        ({"fmus": [native_3]}, r"fmus = \[.*\]: must be a dictionary"),
        ({"fmus": {"rotor": 3}}, "fmus: rotor = 3: must be a path"),
        ({"parameters": [1]}, r"parameters = \[1\]: must be a dictionary"),
        ({"parameters": {"rotor": 3}}, "parameters: rotor = 3: must be a dictionary"),
        ({"recorded": {"rotor": "tau"}}, "recorded: rotor = 'tau': must be a list of names"),
    ):
        whole = {"fmus": {"rotor": native_3}, "connections": [], "stop": 1.0} | given
        with pytest.raises(InputError, match=f"^{said}$"), coupled(**whole):
            pass
