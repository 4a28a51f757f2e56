"""Choices are Enumerations: their names stand in the description of every FMU, their values are the
Integers that hosts have always set; and start values are chosen when an FMU is built."""

import ctypes
import re
from xml.etree.ElementTree import fromstring

import fmpy
import pytest
from fmpy.validation import validate_fmu
from rotor_fmu.model.settings import PRESETS
from rotor_fmu.model.settings.table import METHODS, MODES

import rotor_fmu as rf
from rotor_fmu.cli.fmus import build
from rotor_fmu.errors import InputError
from rotor_fmu.fmi.packing.archive import contents_of

FORMS = {
    "python": {},
    "FMI 2.0": {"is_native": True, "platforms": ["linux64"]},
    "FMI 3.0": {"is_native": True, "platforms": ["linux64"], "fmi": 3},
}
HHT = {"solver.preset": "paper", "solver.method": "hht", "solver.alpha_f": 0.1}
SEEN = ("w", "phi", "tau", "disc[3].x", "disc[3].y", "bearing[2].fn")


# of FMI 2.0 both have the same description
@pytest.fixture(
    scope="module", params=["python", pytest.param("FMI 2.0", marks=pytest.mark.slow), "FMI 3.0"]
)
def form(request):
    return FORMS[request.param]


@pytest.fixture(scope="module")
def fmu(form, tmp_path_factory):
    return rf.build_fmu(rf.load(), tmp_path_factory.mktemp("fmu"), **form)


def run(fmu, **options):
    return fmpy.simulate_fmu(
        str(fmu), stop_time=0.02, output_interval=0.002, output=SEEN, **options
    )


def test_the_description_names_the_values(fmu):
    """Of every choice, in the order of the values, which an Integer has too."""
    assert validate_fmu(str(fmu)) == []
    described = {v.name: v for v in fmpy.read_model_description(str(fmu)).modelVariables}
    for name, expected in (
        ("solver.preset", tuple(PRESETS)),
        ("solver.method", ("as the preset", *METHODS)),
        ("solver.adaptive", ("as the preset", *MODES)),
        ("speed_continuation", ("linear", "hold")),
    ):
        variable = described[name]
        assert variable.type == "Enumeration"
        items = variable.declaredType.items
        assert tuple(item.name for item in items) == expected
        assert [int(item.value) for item in items] == list(range(len(expected)))
        assert expected[int(variable.start)] == ("controlled" if "preset" in name else expected[0])
    assert described["solver.newton_limit"].type in ("Integer", "Int32")


def test_a_type_is_called_as_no_variable_is(fmu):
    root = fromstring(contents_of(fmu)["modelDescription.xml"])
    types = [each.get("name") for each in root.find("TypeDefinitions")]
    names = {each.get("name") for each in root.find("ModelVariables")}
    assert len(set(types)) == len(types)
    assert not names & {*types}


@pytest.mark.filterwarnings("ignore:too coarse in contact")
def test_a_host_sets_the_number_of_a_name(fmu):
    numbers = {
        "solver.preset": list(PRESETS).index("paper"),
        "solver.method": 1 + list(METHODS).index("hht"),
        "solver.alpha_f": 0.1,
    }
    assert (run(fmu, start_values=numbers) != run(fmu)).any()
    chosen = rf.simulate(rf.load(), speed=400.0, stop=0.02, step=0.002, parameters=HHT)
    last = run(fmu, start_values=numbers)[-1]
    assert last["disc[3].x"] == pytest.approx(chosen["disc[3].x"][-1], rel=1e-9)


def test_a_start_value_chosen_at_the_build_is_that_set_by_a_host(fmu, form, tmp_path):
    begun = rf.build_fmu(rf.load(), tmp_path, parameters=HHT, **form)
    # its names are those of the other one
    valid = fmpy.read_model_description(str(begun), validate_model_structure=True)
    described = {v.name: v for v in valid.modelVariables}
    values = {name: float(described[name].start) for name in HHT}
    assert (run(begun) == run(fmu, start_values=values)).all()
    # and a host may take it back
    starts = {v.name: v.start for v in fmpy.read_model_description(str(fmu)).modelVariables}
    usual = {name: float(starts[name]) for name in HHT}
    assert (run(begun, start_values=usual) == run(fmu)).all()


def test_fmi_3_takes_a_choice_as_an_int_32_too(tmp_path):
    """As hosts set it that were written for the Integer that it was."""
    fmu = rf.build_fmu(rf.load(), tmp_path, **FORMS["FMI 3.0"])
    description = fmpy.read_model_description(str(fmu))
    refs = {v.name: v.valueReference for v in description.modelVariables}
    instance = fmpy.instantiate_fmu(fmpy.extract(str(fmu)), description, "CoSimulation")
    at = [refs["solver.preset"]]
    for put in (instance.setInt32, instance.setInt64):
        for value in (1, 3):
            put(at, [value])
            assert instance.getInt32(at) == instance.getInt64(at) == [value]
        with pytest.raises(fmpy.fmi1.FMICallException):
            put(at, [len(PRESETS)])
        assert instance.getInt64(at) == [3]
    far = (ctypes.c_int64 * 1)(2**32 + 1)  # no preset, though its last 32 bits are
    vr, one = (ctypes.c_uint32 * 1)(*at), ctypes.c_size_t(1)
    put = instance.dll.fmi3SetInt64
    put.argtypes = None
    assert put(ctypes.c_void_p(instance.component), vr, one, far, one) == 3
    assert instance.getInt64(at) == [3]
    instance.freeInstance()


def test_a_jump_can_be_held_from_the_build_on(tmp_path):
    given = {"speed_continuation": "hold", "solver.max_iterations": 300}
    fmu = rf.build_fmu(rf.load(), tmp_path, parameters=given)
    described = {v.name: v for v in fmpy.read_model_description(str(fmu)).modelVariables}
    assert described["speed_continuation"].start == "1"
    assert described["solver.max_iterations"].start == "300"


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("solver.preset=papier", "--set solver.preset = papier: must be one of 0 robust, 1 paper"),
        ("solver.method=hht", "--set solver.method = hht: needs alpha_f too"),
        ("solver.method=0", "--set solver.method = 0: means as the preset and changes nothing"),
        (
            "solver.max_iterations=1.5",
            "--set solver.max_iterations = 1.5: must be an integer from 0 to 2e+09",
        ),
        ("solver.reduction=3", "--set solver.reduction: is chosen by --reduction"),
        (
            "bearing[1].mu=0.1",
            "--set bearing[1].mu: is neither a parameter of the solver nor a choice",
        ),
        ("limit.force=1", "--set limit.force: is neither a parameter of the solver nor a choice"),
        ("weight=1", "--set weight: unknown name; known: solver.adaptive, solver.alpha_f, solv"),
    ],
)
def test_a_start_value_that_cannot_be_is_refused(tmp_path, given, sentence):
    with pytest.raises(InputError, match=re.escape(sentence)):
        build.__wrapped__(sets=[given], out=tmp_path / "x")
    assert not (tmp_path / "x").exists()


def test_what_the_step_for_real_time_chooses_is_not_chosen_twice(tmp_path):
    with pytest.raises(ValueError, match=r"solver\.preset: is chosen with the step for real time"):
        build.__wrapped__(
            sets=["solver.preset=paper"],
            is_native=True,
            platforms=["here"],
            realtime="0.05ms",
            out=tmp_path,
        )
    assert not list(tmp_path.iterdir())
