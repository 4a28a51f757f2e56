"""What ROSS saves and no machine has, refused by its name."""

import json
import re

import pytest
from rotor_fmu.model.machine.ross import parse_ross
from rotor_fmu.model.quantities import QuantityError

from rotor_fmu.errors import InputError
from rotor_fmu.machine_file.loading import import_ross

from .test_ross import text_of


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ('["SealElement_balance', '["GearElement_balance', "GearElement of ROSS is not supported"),
        ("mxx = [ 0,]", "mxx = [ 2.0,]", "piston.mxx = 2.0, myy = 0.0: must be the same, at all"),
        ("mxx = [ 0,]", "mxx = [ 2.0, 3.0,]", "piston.mxx = [2.0, 3.0], myy = 0.0: must be"),
        ("mxy = [ 0,]", "mxy = [ 2.0,]", "piston.mxy = 2.0: must be 0; it is not supported"),
        ("torque = 0\n", "torque = 5.0\n", "torque = 5.0: must be 0"),
        ("gyroscopic = true", "gyroscopic = false", "gyroscopic = false: not supported, a shaft"),
        ("shear_effects = true", 'shear_effects = ""', "shear_effects = '': must be true or false"),
        ("alpha = 0.0", "alpha = 0.1", "alpha: is not the same of all shaft elements; here one"),
        ('"cowper"', '"timoshenko"', "must be cowper or hutchinson"),
        (
            "n = 1\n",
            "n = 9\n",
            "ShaftElement with n = 1 is missing; the elements must be those of one",
        ),
        ("n = 5\nscale", "n_link = 2\nn = 5\nscale", "a bearing between two shaft nodes is not"),
        ("n = 5\nscale", "n_link = 12\nn = 5\nscale", "a pedestal must be a PointMass"),
        ("kxx = [ 2000000.0,]", "kxx = [ nan,]", "kxx = nan: must be finite"),
        ("kxx = [ 2000000.0,]", "kxx = [ [1.0, 2.0],]", "over the speed and the whirl frequency"),
        ("kxx = [ 2000000.0,]", "kxx = [ 1.0, 2.0,]", "frequency: must be a list"),
        ("kxx = [ 2000000.0,]", "", "SealElement_balance piston.kxx is missing"),
        ("cxx = [ 3000.0,]", "cxx = []", "SealElement_balance piston.cxx is missing"),
        ("m = 12.0", "m = 12.0\nIq = 1.0", "Iq: unknown key, not carried over"),
        ("n = 4\nm", "n = 14\nm", "n = 14: the shaft ends at 6"),
        ("L = 0.06", "L = true", "L = True: must be a number"),
        ("L = 0.06", 'L = "np.float64(1.2.3)"', "L = 'np.float64(1.2.3)': must be a number"),
        ("n = 1\n", 'n = "np.float64(1.0)"\n', "n = 1.0: must be an integer from 0"),
        ("n = 1\n", "", "ShaftElement_Shaft Element 1.n is missing"),
        ("G_s = 81200000000.0", "G_s = 0.0", "G_s = 0 Pa: must be > 0"),
        ('ross_version = "2.3.0"', "ross_version", "not valid TOML"),
        ("[parameters]", "[parameters]\nalpha = 8.0", "parameters.alpha = 8.0: must be 0"),
        ("[parameters]", "[parameters]\nmodal_damping_ratio = [0.1, 0.2]", "must be 0"),
        ("[parameters]", "[parameters]\nsigma = 8.0", "parameters.sigma: unknown key"),
        ("[parameters]", "parameters = 1", "parameters = 1: must be a table"),
        ('"cowper"', '["cowper"]', "must be cowper or hutchinson"),
        ("m = 12.0", f"m = 1{400 * '0'}", "must be a number"),
        ("G_s = 81200000000.0", "G_s = 1e12", "Element 0.material: E / (2 G_s) - 1 = -0.8945"),
        ('["SealElement_balance', '["SealElement\\nbalance', "SealElement\\nbalance piston"),
        ("mxx = [ 0,]", '"a\\nb" = 1', "balance piston.a\\nb: unknown key"),
    ],
)
def test_what_cannot_be_carried_over_is_refused_by_name(before, after, expected):
    text = text_of("compressor.toml")
    assert before in text
    with pytest.raises(QuantityError) as refused:
        parse_ross(text.replace(before, after, 1))
    assert expected in str(refused.value)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("element", "given", "expected"),
    [
        ("BearingElement_Bearing 2", {"mxx": [5.0]}, "Bearing 2.mxx = 5.0: must be 0; it is not"),
        ("BearingElement_Bearing 2", {"kxy": [5.0]}, "Bearing 2.kxy: a pedestal here stands on"),
        (
            "BearingElement_Bearing 2",
            {"kxx": [1e6, 2e6], "frequency": [1.0, 2.0]},
            "Bearing 2.kxx: a pedestal here stands on constant springs",
        ),
        ("BearingElement_Bearing 2", {"n_link": 3}, "Bearing 2.n_link: a pedestal here stands on"),
        ("BearingElement_Bearing 2", {"n": 9}, "there is 15 kg on 0 of them"),
        ("BearingElement_Bearing 3", {"n": 11}, "there is 15 kg on 2 of them"),
        ("PointMass_Point Mass 0", {"m": 0.0, "mx": 0.0}, "there is 0 kg on 1 of them"),
        ("PointMass_Point Mass 0", {"my": 0.0}, "a pedestal must be a PointMass on one Bearing"),
        ("PointMass_Point Mass 0", {"mass": 1.0}, "Mass 0.mass: unknown key"),
        (
            "BearingElement_Bearing 0",
            {"kxx": [1e6, 2e6], "frequency": [1.0, 2.0], "interpolation": "linear"},
            "interpolation = 'linear': must be pchip",
        ),
        ("DiskElement_Disk 0", {"n": True}, "DiskElement_Disk 0.n = True: must be an integer from"),
        ("DiskElement_Disk 0", {"n": 1.0}, "DiskElement_Disk 0.n = 1.0: must be an integer from 0"),
        ("DiskElement_Disk 0", {"n": -1}, "DiskElement_Disk 0.n = -1: must be an integer from 0"),
        ("DiskElement_Disk 0", {"m": None}, "DiskElement_Disk 0.m is missing"),
        (
            "ShaftElement_Shaft Element 0",
            {"material": "steel"},
            "'steel': must be a table",
        ),
        ("ShaftElement_Shaft Element 0", {"n": 1, "L": 9.0}, "n = 0 is missing"),
        ("ShaftElement_Shaft Element 1", {"n": 0, "L": 9.0}, "n = 1 is missing"),
        ("ShaftElement_Shaft Element 9", {"n": 0, "L": 9.0}, "n = 0: layers of different L"),
    ],
)
def test_elements_that_make_no_machine_are_refused_by_name(element, given, expected):
    saved = json.loads(text_of("on_pedestals.json"))
    saved[element] |= given
    with pytest.raises(QuantityError, match=re.escape(expected)):
        parse_ross(json.dumps(saved), is_json=True)


@pytest.mark.parametrize(
    ("saved", "expected"),
    [
        ([1], "not a rotor that ROSS saved"),
        ({"DiskElement_a": {}}, "not a rotor that ROSS saved"),
        ({"ross_version": "2.3.0"}, "ShaftElement_... is missing"),
        ({"ShaftElement_a": 5}, "ShaftElement_a = 5: must be a table"),
    ],
)
def test_what_is_no_rotor_of_ross_is_said(saved, expected):
    with pytest.raises(QuantityError, match=re.escape(expected)):
        parse_ross(json.dumps(saved), is_json=True)


def test_elements_of_one_name_are_refused_in_json_as_in_toml():
    text = text_of("on_pedestals.json").replace('"DiskElement_Disk 1"', '"DiskElement_Disk 0"')
    with pytest.raises(QuantityError, match="not valid JSON: 'DiskElement_Disk 0' is there twice"):
        parse_ross(text, is_json=True)


def test_a_table_over_the_whirl_frequency_of_ross_3_is_refused_beside_one_over_the_speed():
    saved = json.loads(text_of("on_pedestals.json")) | {"ross_version": "3.0.0"}
    ends = {"frequency": [1.0, 2.0], "speed": [1.0, 2.0]}
    saved["BearingElement_Bearing 0"] |= {"kxx": [1e6, 2e6]} | ends
    with pytest.raises(QuantityError, match=r"0.frequency: a table over the whirl frequency"):
        parse_ross(json.dumps(saved), is_json=True)


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ("m = 12.0", "m = -12.0", "DiskElement_Disk 1: body[2].mass = -12 kg: must be > 0"),
        ("L = 0.06", "L = -0.06", "ShaftElement_Shaft Element 0: section[1].length = -0.06 m"),
        ("odl = 0.12\n", "odl = -1\n", "Element 3: section[3].layer[1].outer_left = -1 m: must"),
        ("idl = 0.09", "idl = 0.08", "Shaft Element 3: shaft.element[3].layer[1].bore_left = 0.08"),
        ("rho = 4430.0", "rho = -1", "Element 3.material: material.titanium.density = -1 kg/m3"),
        ("[parameters]", "[parameters]\nmax_w = -1", "parameters: operation.maximum_continuous"),
        ("\nbeta = 0.0", "\nbeta = -1", "beta: shaft.eta_v = -1 s: must be >= 0 and finite"),
    ],
)
def test_a_value_that_no_machine_has_is_refused_with_the_element(tmp_path, before, after, expected):
    file = tmp_path / "rotor.toml"
    text = text_of("compressor.toml")
    assert before in text
    file.write_text(text.replace(before, after))
    with pytest.raises(InputError) as refused:
        import_ross("--rotor", file)
    assert str(refused.value).startswith(f"{file}: ")
    assert expected in str(refused.value)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "rotor.json: not valid JSON: "),
        ('{"ross_version": "2.3", ', "rotor.json: not valid JSON: "),
        ("[1]", "rotor.json: not a rotor that ROSS saved"),
        ('{"material": {}}', "rotor.json: not a rotor that ROSS saved"),
    ],
)
def test_a_file_of_json_that_is_no_rotor_is_refused_as_json(refusal, tmp_path, text, expected):
    file = tmp_path / "rotor.json"
    file.write_text(text)
    assert expected in refusal("show", "--rotor", str(file))
    above = tmp_path / "above.toml"
    above.write_text('extends = "rotor.json"')
    if "valid" in expected:
        said = refusal("show", "--rotor", str(above))
        assert "above.toml: extends = 'rotor.json': is not valid JSON" in said
