"""Rotors that ROSS saved, against ROSS' own numbers (tests/reference/make_ross.py made them)."""

import json
import re
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.linear import modes, unbalance_response
from rotor_fmu.model.machine.ross import parse_ross
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.machine.toml_text import toml_text
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

HERE = Path(__file__).parents[1] / "reference"
# of ROSS 2.3.0, and of 3.1.0 also between the speeds of its tables
ANSWERS = {
    f"{folder}/{file}": output
    for folder in ("ross", "ross3")
    for file, output in json.loads((HERE / f"{folder}_answers.json").read_text()).items()
}
CLOSE = 1e-6


def text_of(file):
    return (HERE / file if "/" in file else HERE / "ross" / file).read_text()


def machine(file):
    result = parse_ross(text_of(file), is_json=file.endswith("json"))
    return parse_rotor(toml_text(result.tables))


@pytest.mark.parametrize("file", ANSWERS)
def test_natural_frequencies_and_log_decs_are_those_of_ross(file):
    rotor = machine(file)
    for speed, output in ANSWERS[file]["modal"].items():
        result = modes(rotor, float(speed), count=10)
        np.testing.assert_allclose(result.natural, output["natural"], rtol=CLOSE)
        np.testing.assert_allclose(result.log_dec, output["log_dec"], rtol=CLOSE)
        # and those that its own solver gives, among modes of torsion and along the axis
        for omega in result.natural[:4]:
            assert np.abs(np.array(output["run_modal"]) / omega - 1).min() < CLOSE


@pytest.mark.parametrize("file", ANSWERS)
def test_response_to_unbalance_is_that_of_ross(file):
    output = ANSWERS[file]
    unbalances = [(node + 1, amount, phase) for node, amount, phase in output["unbalances"]]
    result = unbalance_response(machine(file), output["speeds"], unbalances=unbalances)
    for axis in "xy":
        expected = (np.array(output[axis]) @ [1, 1j]).T
        np.testing.assert_allclose(getattr(result, axis), expected, rtol=CLOSE, atol=0)


def test_a_rub_is_that_of_ross():
    answer = json.loads((HERE / "ross_rub.json").read_text())
    parts = {
        "contact": [answer["contact"] | {"journal_radius": 0.0095, "mu": 0.0, "c": 0.0}],
        "unbalance": [answer["unbalance"]],
        "sensor": [{"node": answer["contact"]["node"], "name": "journal"}],
    }
    tables = parse_ross(text_of("rubbing.toml")).tables | parts | {"gravity": 0.0}
    expected = np.array(answer["x"]) + 1j * np.array(answer["y"])
    size, tolerance, speed = np.abs(expected).max(), 1e-4, answer["speed"]
    assert size > 1.1 * answer["contact"]["clearance"]
    sim = Simulation(parse_rotor(toml_text(tables)), choose(tolerance=tolerance), speed=speed)
    seen = []
    for time in answer["sampled"] * np.arange(len(expected)):
        if time > 0:
            sim.advance(time, speed)
        seen.append(complex(sim.read("journal.x"), sim.read("journal.y")))
    error = np.abs(np.array(seen) - expected).max()
    # what is left of an error of first order after extrapolation
    assert error < 10 * tolerance * size + answer["error"] / 10


def test_bearings_that_ross_computed_are_imported_by_their_coefficients_and_that_is_said():
    text = text_of("computed_bearings.toml")
    result = parse_ross(text)
    ball, film = result.tables["linear_bearing"]
    assert ball["kxx"] > 1e6
    assert film["speed"] == [200.0, 500.0, 900.0, 1500.0]
    assert "n_balls" not in ball
    for name in ("BallBearingElement_ball", "CylindricalBearing_film"):
        assert any(
            note.startswith(f"{name}: imported by its coefficients") for note in result.notes
        )
    seal = parse_ross(text.replace("CylindricalBearing", "LabyrinthSeal")).tables
    assert seal == result.tables | {"linear_bearing": [ball], "seal": [film]}
    for key in ("kxx = ", "cxx = "):
        with pytest.raises(QuantityError, match=r"Element of ROSS is not .* remove it, or save"):
            parse_ross(text.replace(key, "key = "))


@pytest.mark.parametrize(
    "computed",
    [
        "kp_pid = 1500.0\ng0 = 1e-3\nnw = 200",
        "n_pad = 2\nfys_load = -1000.0",
        "pivot_angle = [ 0.3, 1.6,]\npad_arc = 1.05",
    ],
)
def test_so_are_those_that_ross_saves_under_the_name_of_a_bearing_by_coefficients(computed):
    text = text_of("compressor.toml")
    head = '["BearingElement_bearing 0"]\n'
    assert head in text
    result = parse_ross(text.replace(head, head + computed + "\n", 1))
    assert result.tables == parse_ross(text).tables
    assert "BearingElement_bearing 0: imported by its coefficients" in result.notes[0]
    # a controller's coefficients are those of a frequency of vibration, not of the speed
    assert ("for synchronous vibration alone" in result.notes[0]) == ("kp_pid" in computed)


def test_where_formulations_differ_it_is_by_a_little_and_said_how():
    """Tapers: ROSS takes the shape of a cylinder with the shear of the middle section, this project
    the taper's own; Hutchinson's coefficient lacks a factor 1 + poisson in ROSS 2."""
    for file, ours, most in (
        ("compressor.toml", ("taper", "mean"), 5e-3),
        ("on_pedestals.json", ("shear", "hutchinson"), 5e-3),
    ):
        tables = parse_ross(text_of(file), is_json=file.endswith("json")).tables
        before = modes(parse_rotor(toml_text(tables)), count=4).natural
        for section in tables["section"]:
            section[ours[0]] = ours[1]
        after = modes(parse_rotor(toml_text(tables)), count=4).natural
        assert 0 < np.abs(after / before - 1).max() < most


def test_rosss_tapers_cut_into_shorter_elements_become_those_of_their_own_shape():
    """Those of the compressor, of one element each, are 5 % off in the shape of a cylinder."""
    rotor = machine("compressor.toml")

    def natural(taper, parts):
        cut, first = [], {}
        for node, core in enumerate(rotor.sections, 1):
            first[node] = len(cut) + 1
            for i in range(parts):
                shares = i / parts, (i + 1) / parts
                core_part, *layers = (
                    replace(layer.part(*shares), taper=taper, layers=())
                    for layer in core.all_layers
                )
                cut.append(core_part.with_layers(*layers))
        first[len(first) + 1] = len(cut) + 1
        moved = tuple(replace(part, node=first[part.node]) for part in rotor.parts)
        return modes(replace(rotor, sections=tuple(cut), parts=moved), 300.0, count=4).natural

    cut = natural("middle", 16)
    np.testing.assert_allclose(natural("exact", 1), cut, rtol=3e-3)
    assert np.abs(natural("middle", 1) / cut - 1).max() > 0.03


def test_elements_in_layers_and_materials_and_poisson_are_as_ross_has_them():
    rotor = machine("compressor.toml")
    assert [len(section.all_layers) for section in rotor.sections] == [1, 1, 2, 2, 1, 1]
    steel = rotor.sections[0].material
    assert steel.shear == pytest.approx(81.2e9)
    assert rotor.sections[5].material.density == 4430.0
    # of sleeves that are all mass, machines have materials whose ratio is below 0
    text = text_of("compressor.toml").replace("G_s = 81200000000.0", "G_s = 2e11", 1)
    assert parse_ross(text).tables["material"]["steel"]["poisson"] == pytest.approx(-0.4725)


def test_pedestals_become_housings():
    rotor = machine("on_pedestals.json")
    kinds = [part.KIND for part in rotor.parts]
    assert kinds.count("housing") == 2
    assert kinds.count("linear_bearing") == 2
    assert kinds.count("point_mass") == 0


def test_a_pedestal_may_have_another_mass_in_y():
    saved = json.loads(text_of("on_pedestals.json"))
    pedestals = [key for key in saved if key.startswith("PointMass")]
    assert pedestals
    for key in pedestals:
        saved[key] |= {"m": None, "mx": 10.0, "my": 14.0}
    housings = parse_ross(json.dumps(saved), is_json=True).tables["housing"]
    assert {(h["mass"], h["mass_ratio"]) for h in housings} == {(10.0, 1.4)}


def test_a_point_mass_of_the_shaft_is_one_at_its_node():
    saved = json.loads(text_of("on_pedestals.json"))
    on_shaft = saved | {"PointMass_of the shaft": {"n": 4, "mx": 3.0, "my": 3.0}}
    result = parse_ross(json.dumps(on_shaft), is_json=True)
    assert result.tables["point_mass"] == [{"node": 5, "mass": 3.0}]
    assert result.elements["point_mass[1]"] == "PointMass_of the shaft"
    on_shaft["PointMass_of the shaft"]["my"] = 4.0
    with pytest.raises(QuantityError, match=r"shaft: mx = 3 kg and my = 4 kg: must be the same"):
        parse_ross(json.dumps(on_shaft), is_json=True)


def test_tables_over_the_speed_of_ross_3_are_read_under_its_names():
    two = parse_ross(text_of("compressor.toml"))
    text = text_of("compressor.toml").replace('"2.3.0"', '"3.1.0"')
    three = parse_ross(
        text.replace("frequency =", "speed =").replace("alpha = 0.0\nbeta = 0.0", "")
    )
    assert three.tables == two.tables
    assert not three.notes
    assert all("PCHIP" in note for note in two.notes)


def test_between_two_points_of_a_table_ross_2_has_a_line_as_pchip_has():
    saved = json.loads(text_of("on_pedestals.json"))
    saved["BearingElement_Bearing 0"] |= {"kxx": [1e6, 2e6], "frequency": [0.0, 100.0]}
    result = parse_ross(json.dumps(saved), is_json=True)
    assert result.tables["linear_bearing"][0]["kxx"] == [1e6, 2e6]
    assert not result.notes


def test_damping_of_the_whole_rotor_is_in_the_place_of_the_elements():
    """ROSS 3 ignores the elements' damping where the rotor has its own."""
    text = text_of("under_tension.toml").replace("[parameters]", "[parameters]\nbeta = 2e-5")
    result = parse_ross(text)
    assert result.tables["shaft"]["eta_v"] == 2e-5
    for own in ("alpha", "beta"):
        assert parse_ross(text.replace(f"\n{own} = 0.0", f"\n{own} = 1e-3")).tables == result.tables
    assert "axial_force" in result.notes[0]
    assert not parse_ross(text_of("under_tension.toml")).notes
    free = text_of("compressor.toml").replace("[parameters]", "[parameters]\nbeta = 2e-5")
    assert parse_ross(free).notes == parse_ross(text_of("compressor.toml")).notes


def test_operating_speeds_are_carried_over():
    speeds = "min_w = 0.0\nrated_w = 'np.float64(200.0)'\nmax_w = 300.0"
    text = text_of("compressor.toml").replace("[parameters]", f"[parameters]\n{speeds}")
    operation = parse_rotor(toml_text(parse_ross(text).tables)).operation
    assert (operation.minimum_speed, operation.rated_speed) == (None, 200.0)
    assert operation.maximum_continuous_speed == 300.0


def test_numbers_that_numpy_made_are_numbers():
    """ROSS writes those as text into a TOML file; so it does the nodes of `numpy.arange`."""
    text = text_of("under_tension.toml")
    made = re.sub(r"(?m)^(n|axial_force) = (\d+)$", r'\1 = "np.int64(\2)"', text)
    made = re.sub(r"(?m)^(L|m|E) = (.*)$", r'\1 = "np.float64(\2)"', made)
    assert made.count("np.int64") > 10
    assert parse_ross(made).tables == parse_ross(text).tables


def test_what_exerts_no_lateral_force_is_said_to_be_left_out():
    text = text_of("compressor.toml")
    others = "kzz = [ 1e5,]\nseal_leakage = 0.2\nradial_clearance = 1e-4"
    given = text.replace("kzz = [ 0,]", others)
    result = parse_ross(given)
    assert result.tables == parse_ross(text).tables
    left_out = "SealElement_balance piston: kzz, radial_clearance, seal_leakage: no lateral force"
    assert f"{left_out}, left out" in result.notes


def test_a_bearing_without_coefficients_along_y_has_those_along_x():
    """As in ROSS; written by hand, a file may lack them."""
    given = json.loads(text_of("on_pedestals.json"))
    lacking = json.loads(text_of("on_pedestals.json"))
    bearings = [key for key in given if key.startswith("BearingElement")]
    for key in bearings:
        given[key] |= {f"{of}yy": given[key][f"{of}xx"] for of in "kc"}
        lacking[key] |= {"kyy": None}
        del lacking[key]["cyy"]
    expected, result = (parse_ross(json.dumps(d), is_json=True) for d in (given, lacking))
    assert result.tables == expected.tables


def test_text_survives_being_written():
    tables = {
        "name": 'a "b" \\ \t\x7f é',
        "on": True,
        "list": [1.5, 2, -3e-20],
        "material": {"two words": {"young": 2.1e11}},
        "section": [{"length": 0.1, "layer": [{"outer": 1}, {"outer": 2}]}, {"length": 0.2}],
    }
    assert tomllib.loads(toml_text(tables)) == tables


def test_null_is_nothing():
    text = text_of("compressor.toml")
    tables = parse_ross(text).tables
    data = tomllib.loads(text)
    seal = next(key for key in data if key.startswith("SealElement"))
    data[seal] |= {"seal_leakage": None, "some_other_key": None}
    assert parse_ross(json.dumps(data), is_json=True).tables == tables
