"""How a machine is run: `[operation]`, the ramps of run-down and run-up, the start of its FMU."""

import math
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.quantities import QuantityError

from rotor_fmu.cli.speeds import rated_speed
from rotor_fmu.errors import InputError
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.machine_files import NATIVE, machine_of
from rotor_fmu.fmi.packing.python_fmu import build
from rotor_fmu.operating_speeds import operating_speeds
from rotor_fmu.runs.input_signals import RampGiven
from rotor_fmu.runs.job import prepare
from tools.checkout import ROOT

from ..known import EXAMPLES
from ..toml_text import refusal_of, table

RPM = math.pi / 30


def operated(text, name="rig of ours", identifier=""):
    """The rig with another table `[operation]` and another name."""
    toml = rig_toml().replace("rated_speed = 400.0", text).replace("run_down_rate = 10.0\n", "")
    named = toml.replace('"zigulic2003"', f'"{name}"').replace('"RotorBearing"', f'"{identifier}"')
    assert named != rig_toml()
    return named


def test_a_run_down_begins_at_the_trip_speed_and_a_run_up_ends_at_the_highest_of_operation():
    rotor = parse_rotor(
        operated(
            "rated_speed = 300.0\nmaximum_continuous_speed = 315.0\ntrip_speed = 350.0\n"
            "run_up_rate = 5.0\nrun_down_rate = 7.0"
        )
    )
    down, up = RampGiven().on(rotor), RampGiven(is_up=True).on(rotor)
    assert (down.first, down.last, down.rate) == (350.0, 0.0, 7.0)
    assert (up.first, up.last, up.rate) == (0.0, 315.0, 5.0)
    assert down.end == pytest.approx(50.0)


def test_stability_is_that_at_the_highest_continuous_speed_unless_a_speed_is_given():
    """As API 617 asks, and as the report of a machine has it."""
    fast = parse_rotor(operated("rated_speed = 300.0\nmaximum_continuous_speed = 315.0"))
    rated = parse_rotor(operated("rated_speed = 300.0"))
    assert (rated_speed(None, fast), rated_speed(None, rated)) == (315.0, 300.0)
    assert rated_speed("290", fast) == 290.0
    with pytest.raises(InputError, match=r"maximum_continuous_speed or operation\.rated_speed"):
        rated_speed(None, parse_rotor(operated("")))


def test_the_rig_runs_down_as_in_paper_a():
    signals = RampGiven().on(rig()).signals(0.0)
    assert signals.t.tolist() == [0.0, 40.0]
    assert signals.values["speed"].tolist() == [400.0, 0.0]


def test_a_machine_that_says_nothing_passes_its_lowest_natural_frequency():
    """The rig's lowest, 204 rad/s with its discs on its bearings, lies amid the run."""
    rotor = parse_rotor(operated(""))
    speeds = operating_speeds(rotor)
    assert 1.5 * 204 < speeds.trip < 2.5 * 204
    assert speeds.trip / speeds.run_down_rate == pytest.approx(40.0, rel=0.05)
    ten = parse_rotor(operated("").replace("young = 2.1e11", "young = 2.1e13"))
    stiffer = operating_speeds(ten)
    assert stiffer.trip / speeds.trip > 1.5
    turns = [s.trip**2 / s.run_down_rate for s in (speeds, stiffer)]
    assert turns[0] == pytest.approx(turns[1])


def test_oil_films_hold_a_machine_whatever_else_surrounds_its_shaft():
    """Clearances that its shaft may touch hold nothing while its bearings do, and soft seals hold
    less than its oil films."""
    plain = (EXAMPLES / "oil_film" / "rotor.toml").read_text()
    keys = {"journal_radius": 0.015, "clearance": 3e-4, "mu": 0.1, "k": 1e7}
    contacts = "".join(table("[contact]", node=node, **keys) for node in (2, 3, 4))
    soft = {"kxx": 2e4, "kyy": 2e4, "cxx": 10.0, "cyy": 10.0}
    seals = "".join(table("[seal]", node=node, **soft) for node in (2, 4))
    alone, between, sealed = (
        operating_speeds(parse_rotor(f"{plain}\n{others}")).rated
        for others in ("", contacts, seals)
    )
    assert between == alone
    assert sealed == pytest.approx(alone, rel=0.1)


def test_speeds_rates_and_times_take_units_and_are_held_at_the_highest_speed():
    down = RampGiven(False, "3000rpm", "10 Hz", "60rpm/s", "500ms").on(rig())
    assert (down.first, down.last) == pytest.approx((3000 * RPM, 600 * RPM))
    signals = down.signals(60.0)
    assert signals.t.tolist() == pytest.approx([0.0, 0.5, 40.5, 60.0])
    assert signals.values["speed"].tolist() == pytest.approx(
        [3000 * RPM, 3000 * RPM, 600 * RPM, 600 * RPM]
    )
    up = RampGiven(True, "0", "300", "10", "2").on(rig())
    assert (up.before, up.after, up.end) == (0.0, 2.0, 32.0)
    assert np.interp(31.0, *(lambda s: (s.t, s.values["speed"]))(up.signals(0.0))) == 300.0


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        (
            {"first": "3 mm"},
            "--from 3 mm: must be a speed of rotation, in rad/s or such as rpm",
        ),
        ({"first": "fast"}, "--from fast: must be a number, in rad/s or with rpm or Hz behind it"),
        ({"rate": "-1"}, "--rate -1: must be > 0; the speeds say whether up or down"),
        ({"hold": "-1"}, "--hold -1: must be >= 0"),
        ({"first": "100", "last": "100"}, "--from 100 rad/s: must differ from --to 100 rad/s"),
        (
            {"first": "50Hz", "last": "3000rpm"},
            "--from 50Hz: must differ from --to 3000rpm; a constant speed is given by --set "
            "speed=3000rpm",
        ),
        (
            {"first": "10 Hz", "last": "1200 rpm"},
            "--to 1200 rpm: must be smaller in size than --from = 10 Hz",
        ),
        (
            {"last": "500"},
            "--to 500 rad/s: must be smaller in size than --from = 400 rad/s; the other way is",
        ),
        (
            {"is_up": True, "first": "500"},
            "--to 400 rad/s: must be larger in size than --from = 500 rad/s",
        ),
    ],
)
def test_a_ramp_that_cannot_be_is_one_line(given, expected):
    with pytest.raises(InputError) as error:
        RampGiven(**given).on(rig())
    assert expected in str(error.value)


def test_the_refusal_of_a_run_up_that_no_film_carries_from_rest_names_from(tmp_path):
    file = tmp_path / "film.toml"
    text = (EXAMPLES / "oil_film" / "rotor.toml").read_text()
    file.write_text("\n".join(line for line in text.splitlines() if not line.startswith("k =")))
    with pytest.raises(InputError, match=r"the oil film at node .* a speed .*--from$"):
        prepare(file, None, [], None, 0.1, None, RampGiven(True))
    with pytest.raises(InputError, match=r"wall$"):
        prepare(file, None, ["speed=0"], None, 0.1, None, RampGiven(True))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "rated_speed = 300.0\ntrip_speed = 200.0",
            "operation.trip_speed = 200 rad/s: must be at least operation.rated_speed = 300 rad/s",
        ),
        (
            "minimum_speed = 300.0\nmaximum_continuous_speed = 200.0",
            "operation.maximum_continuous_speed = 200 rad/s: must be at least operation.minimum_",
        ),
        ("rated_speed = -1.0", "operation.rated_speed = -1 rad/s: must be > 0"),
        ("rated = 1.0", "operation.rated: unknown key; did you mean rated_speed?"),
    ],
)
def test_an_operation_that_cannot_be_is_one_line(text, expected):
    assert expected in refusal_of(operated(text))


@pytest.mark.parametrize(
    ("name", "identifier", "expected"),
    [
        ("fan", "", "Fan"),
        ("boiler feed pump, 3rd stage", "", "BoilerFeedPump3rdStage"),
        ("2nd fan", "", "Rotor2ndFan"),
        ("Lüfter", "", "LFter"),
        ("转子", "", "Rotor"),
        ("fan", "my_fan", "my_fan"),
    ],
)
def test_an_fmu_is_called_after_its_machine(name, identifier, expected):
    toml = operated("", name, identifier)
    assert machine_of(toml).identifier() == expected
    assert machine_of(toml, is_free=True).identifier(NATIVE) == f"{expected}FreeNative"


def test_an_identifier_that_is_none_is_refused():
    with pytest.raises(QuantityError, match=r"identifier = '3 fans': must be a word of letters"):
        parse_rotor(operated("", identifier="3 fans"))


def test_an_fmu_has_the_names_and_the_start_of_its_machine(tmp_path):
    fmu = build(tmp_path, machine_of(operated("rated_speed = 250.0", "test fan")))
    assert fmu.name == "TestFan.fmu"
    with zipfile.ZipFile(fmu) as archive:
        root = ElementTree.fromstring(archive.read("modelDescription.xml"))
        page = archive.read("documentation/index.html").decode()
    assert root.get("modelName") == "test fan"
    assert root.find("CoSimulation").get("modelIdentifier") == "TestFan"
    assert root.get("description").startswith("test fan: a flexible rotor with")
    speed = root.find("ModelVariables/ScalarVariable[@name='speed']/Real")
    assert float(speed.get("start")) == 250.0
    assert "<h1>test fan" in page


def test_a_free_rotor_starts_at_the_rated_speed_too():
    table = interface(parse_rotor(operated("rated_speed = 250.0")), is_free=True)
    assert next(v.start for v in table if v.name == "w_start") == 250.0


@pytest.mark.usefixtures("drawn")
def test_a_run_of_less_than_a_turn_is_drawn_where_it_was(command, tmp_path):
    machine = str(ROOT / "examples" / "magnetic_bearing" / "compressor.toml")
    command("run-up", "--rotor", machine, "--direct", "--stop", "0.05", "--quiet")
    assert (tmp_path / "out" / "run_up_psi.png").read_bytes().startswith(b"\x89PNG")
