"""Balancing by influence coefficients: the algebra, and runs of the rig without contact."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import static
from rotor_fmu.model.linear.residual_unbalance import balance_quality_grade, tolerance_planes
from rotor_fmu.model.machine.operating_speeds import Operation
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.body import Body
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.parts.unbalance import Unbalance
from rotor_fmu.model.simulation import HYSTERETIC_AS_SLOWER

from rotor_fmu.balancing.trial_runs import balance
from rotor_fmu.errors import InputError
from rotor_fmu.linear.answers import unbalance_response
from rotor_fmu.vibration.influence_coefficients import correction
from tests.linear.api_617 import RPM, SHAFT, example, support
from tests.linear.test_growth_without_oscillation import pulled
from tests.linear.test_subsynchronous import on_pads
from tests.physics.test_symmetries import image_of_machine, turned


def without_contact(kyy=2.5e6):
    """The rig on linear bearings in the place of its clearance bearings."""
    bearings = [
        LinearBearing(node=b.node, kxx=2e6, kyy=kyy, cxx=300.0, cyy=300.0) for b in rig().bearings
    ]
    return rig().with_parts(Bearing, *bearings)


def test_what_two_planes_do_two_planes_take_away():
    rng = np.random.default_rng(1)
    influence = rng.standard_normal((4, 2)) + 1j * rng.standard_normal((4, 2))
    unbalances = np.array([2e-4 + 1e-4j, -3e-4j])
    trials = np.array([1e-4, 2e-4j])
    initial = influence @ unbalances
    result = correction(initial, [initial + influence[:, k] * trials[k] for k in (0, 1)], trials)
    np.testing.assert_allclose(result.unbalances, -unbalances, rtol=1e-9)
    np.testing.assert_allclose(result.influence, influence, rtol=1e-9)
    assert np.abs(result.expected).max() < 1e-9 * np.abs(initial).max()


def test_two_trial_runs_of_the_rig_without_contact_leave_less_than_one_percent():
    rotor, runs = without_contact(), []
    result = balance(rotor, [150.0], [4, 6], measured=[4, 6], report=lambda *run: runs.append(run))
    assert result.residual < 0.01
    assert result.messages == ()
    assert [done for done, _ in runs] == [0, 1, 2, 3]
    assert runs[2][1].startswith("trial unbalance at node 6, ")
    assert not result.touches
    # and the run does what the coefficients say, within the run's own error
    size = max(abs(v.initial) for v in result.vibrations)
    assert max(abs(v.corrected - v.expected) for v in result.vibrations) < 1e-4 * size
    assert result.departure < 1e-4
    assert "not linear" not in result.table().title
    # a film whose stiffness grows with the motion does otherwise
    off = tuple(v._replace(corrected=v.expected + 0.2 * v.initial) for v in result.vibrations)
    title = replace(result, vibrations=off).table().title
    assert "it is 20 % of the initial one off the expected: the machine is not linear" in title


def test_influence_coefficients_from_runs_are_those_of_the_linear_response():
    rotor = without_contact()
    result = balance(rotor, np.array([150.0]), np.array([4]), measured=[6])
    linear = unbalance_response(rotor, [150.0], unbalances=[(4, 1.0, 0.0)])
    expected = [linear.x[0, 5], linear.y[0, 5]]
    np.testing.assert_allclose(result.influence[:, 0], expected, rtol=1e-3)


def test_a_machine_is_balanced_at_a_negative_speed_as_its_mirror_image_is_at_the_positive_one():
    """On bearings that whirl it differently in the two senses."""
    bearings = without_contact().of_kind(LinearBearing)
    bearings = [replace(bearing, kxy=4e5) for bearing in bearings]
    rotor = rig().with_parts(Bearing, *bearings)
    found = balance(rotor, [-150.0], [4], measured=[4, 6])
    image = balance(image_of_machine(rotor, -1), [150.0], [4], measured=[4, 6])
    assert found.residual < 0.5
    assert found.departure < 1e-4
    (plane,), (other,) = found.planes, image.planes
    assert other.unbalance == pytest.approx(turned(plane.unbalance, -1), rel=1e-4)
    linear = unbalance_response(rotor, [-150.0], unbalances=[(4, 1.0, 0.0)])
    expected = [of[0, node - 1] for node in (4, 6) for of in (linear.x, linear.y)]
    np.testing.assert_allclose(found.influence[:, 0], expected, rtol=1e-3)


@pytest.mark.parametrize(
    ("rpm", "grade", "micrometres"),
    [(3000, 2.5, 7.96), (3000, 6.3, 20.1), (1500, 6.3, 40.1), (12000, 1.0, 0.796), (950, 16, 161)],
)
def test_a_balance_quality_grade_permits_what_the_standard_does(rpm, grade, micrometres):
    """Of 80 kg; the values are those of the diagram of ISO 21940-11, to three digits."""
    permitted = 80 * micrometres * 1e-6
    assert balance_quality_grade(0.995 * permitted, 80, rpm * RPM) == grade
    assert balance_quality_grade(1.005 * permitted, 80, rpm * RPM) > grade
    assert balance_quality_grade(80 * 50.0, 80, rpm * RPM) == np.inf


@pytest.mark.parametrize(("rpm", "grade"), [(3600, 6.3), (9000, 1.0)])
def test_an_unbalance_of_all_that_a_grade_permits_has_that_grade(rpm, grade):
    """Rounding of the product with the speed makes no worse grade of it."""
    assert balance_quality_grade(30 * (1e-3 * grade / (rpm * RPM)), 30, rpm * RPM) == grade


def test_the_unbalance_of_a_rotor_is_divided_between_its_bearings_as_a_force_is():
    """An overhung one, whose body has its centre of mass beside its node."""
    supports = support(2, 1e9) + support(5, 1e9)
    body = Body(node=7, mass=3.0, I_d=0.01, I_p=0.02, offset=0.05, e=1e-4, phase=0.5)
    rotor = parse_rotor(SHAFT + supports)
    rotor = replace(rotor, parts=(*rotor.parts, body))
    first, last = tolerance_planes(rotor)
    z = rotor.nodes
    share = (z[4] - (z[6] + 0.05)) / (z[4] - z[1])
    expected = 3e-4 * np.exp(0.5j) * np.array([share, 1 - share])
    np.testing.assert_allclose([first.unbalance, last.unbalance], expected, rtol=1e-12)
    borne = np.abs(static(rotor).load_y) / rotor.gravity
    np.testing.assert_allclose([first.mass, last.mass], borne, rtol=1e-6)
    assert not tolerance_planes(parse_rotor(SHAFT + support(4, 1e7)))


def test_the_unbalance_of_a_bowed_rotor_is_what_its_bearings_bear_at_slow_speeds():
    """On two bearings, one of which stands inside an end; with a disc that its bow tilts."""
    parts = support(2, 1e9) + support(7, 1e9)
    parts += "[[body]]\nnode = 3\nmass = 5.0\nI_d = 0.1\nI_p = 0.19\ne = 1e-5\nphase = 2.0\n"
    parts += "[[bow]]\nnode = 5\namplitude = 1e-4\nphase = 0.7\n"
    parts += "[[bow]]\nnode = 2\namplitude = 2e-4\nphase = -1.0\n"
    rotor = replace(parse_rotor(SHAFT + parts), gravity=0.0)
    borne = unbalance_response(rotor, [1.0]).load_x[0]
    found = [plane.unbalance for plane in tolerance_planes(rotor)]
    np.testing.assert_allclose(found, borne, rtol=1e-4)


@pytest.mark.parametrize(
    ("z", "shares"),
    [
        (0.5, (0.5, 0.5)),
        (0.4, (0.6, 0.4)),
        (0.1, (0.7, 0.3)),
        (1.05, (0.3, 1.05)),
        (1.4, (0.4, 1.3)),
    ],
)
def test_no_plane_is_permitted_less_than_three_tenths_of_the_whole(z, shares):
    """ISO 21940-11 keeps the shares of inboard rotors from 0.3 to 0.7, of overhung ones to 1.3."""
    light = "[material]\nyoung = 2e11\ndensity = 1e-3\n[shaft]\nnodes = [0.0, 1.0, 1.5]\n"
    light += "diameters = [0.05, 0.05]\n" + support(1, 1e9) + support(2, 1e9)
    rotor = parse_rotor(light + f"[[body]]\nz = {z}\nmass = 80.0\nI_d = 0.1\nI_p = 0.1\n")
    graded = [plane.graded_mass for plane in tolerance_planes(rotor)]
    np.testing.assert_allclose(graded, 80.0 * np.array(shares), rtol=1e-6)


def test_what_is_left_in_the_bearings_planes_has_its_grade():
    """One plane takes away the sum of the discs' unbalances, which are alike, and none of the rest;
    at 150 rad/s, at which the rotor is nearly rigid."""
    rotor = replace(without_contact(), operation=Operation(maximum_continuous_speed=3000 * RPM))
    result = balance(rotor, [150.0], [5])
    planes = tolerance_planes(rotor)
    assert [r.initial for r in result.residuals] == [plane.unbalance for plane in planes]
    (plane,) = result.planes
    for left, first in zip(result.residuals, planes, strict=True):
        assert left.corrected == pytest.approx(first.unbalance + plane.unbalance / 2, rel=1e-9)
        assert left.permitted == pytest.approx(6350e-6 * left.mass / 3000, rel=1e-9)
        size = abs(left.corrected) / left.mass * 3000 * RPM * 1e3
        assert left.grade / 2.6 < size <= left.grade
    assert "unbalances permitted at 50 Hz" in result.table().title
    assert f"G {result.residuals[0].grade:g}" in result.table().text()


@pytest.fixture
def few_turns(monkeypatch):
    """Runs that are short, where what they lead to is not looked at."""
    monkeypatch.setattr("rotor_fmu.balancing.trial_runs._MOST_TURNS", 20)
    monkeypatch.setattr("rotor_fmu.balancing.trial_runs._LEAST_TURNS", 10)


@pytest.mark.usefixtures("few_turns")
def test_without_a_service_speed_it_is_that_of_balancing():
    rotor = replace(without_contact(), operation=Operation(minimum_speed=0.0))
    assert balance(rotor, [150.0], [5]).service_speed == 150.0


@pytest.mark.usefixtures("few_turns")
def test_a_machine_whose_slowest_mode_outlasts_the_runs_says_so():
    slow = balance(without_contact(), [300.0], [4])
    assert not slow.settles
    assert "20 turns are too few for the slowest mode to settle" in slow.table().title


@pytest.mark.parametrize("slower", [0, 8])
def test_a_machine_that_does_not_settle_is_refused(slower):
    """Also where it is the tenth mode that grows, after those of eight heavy housings."""
    heavy = slower * [replace(rig().bearings[0], mass=200.0, clearance=1.0)]
    rotor = replace(without_contact(), rotating_damping=True)
    rotor = replace(rotor, parts=(*rotor.parts, *heavy))
    with pytest.raises(InputError, match=r"300 rad/s: the machine is unstable there.*7\.86 1/s"):
        balance(rotor, [300.0], [4])


def test_a_machine_that_leaves_its_place_without_oscillating_is_refused():
    rotor = pulled(k=-5e6)
    rotor = replace(rotor, parts=(*rotor.parts, Unbalance(4, 1e-4)))
    with pytest.raises(InputError, match=r"= 300 rad/s: the machine is unstable there .* 1/s\)"):
        balance(rotor, [300.0], [4])


@pytest.mark.usefixtures("few_turns")
def test_what_the_runs_say_of_their_numbers_is_said_once():
    """Hysteresis, which a run takes otherwise than `unbalance` does."""
    rotor = replace(without_contact(), eta_h=1e-4, rotating_damping=True)
    result = balance(rotor, [150.0], [4])
    assert result.messages.count(str(HYSTERETIC_AS_SLOWER)) == 1
    assert len(result.messages) == 1 + (not result.settles)
    assert str(HYSTERETIC_AS_SLOWER) in result.table().title


@pytest.mark.usefixtures("few_turns")
def test_a_whirl_that_the_unbalance_does_not_drive_is_said():
    """Of floating rings, which hardly decays at one speed, and grows at another."""
    result = balance(example("turbocharger"), [440.0], [2])
    assert result.messages[0].startswith("the vibration was not steady:")
    with pytest.raises(InputError, match=r"500 rad/s: the machine is unstable there.*3\.23 1/s"):
        balance(example("turbocharger"), [500.0], [2])


def test_a_speed_at_which_a_whirl_in_tilting_pads_grows_is_refused():
    """Which no mode shows whose pads follow at the frequency of rotation."""
    with pytest.raises(InputError, match=r"1000 rad/s: the machine is unstable there.*1\.43 1/s"):
        balance(parse_rotor(on_pads(8e5)), [1000.0], [2])


@pytest.mark.usefixtures("drawn")
@pytest.mark.usefixtures("few_turns")
def test_the_command_tells_the_corrections(tmp_path, command):
    assert "plane at node 5 [g.mm]" in command("balance", "--speed", "150", "--plane", "5")
    data = json.loads((tmp_path / "out" / "balance.json").read_text())
    assert data["planes"][0]["node"] == 5
    assert (tmp_path / "out" / "balance.png").read_bytes().startswith(b"\x89PNG")


def test_planes_that_the_vibration_cannot_tell_apart_get_the_smallest_unbalances():
    """Two planes whose effects are alike but for 1e-7 of them, an error of the measurement."""
    alike = np.array([1.0, -1j])
    influence = np.column_stack([alike, alike * (1 + 1e-7 * np.array([1.0, -1.0]))])
    initial = alike * (1 + 1e-6 * np.array([1j, -1j]))
    trials = [initial + influence[:, k] for k in (0, 1)]
    result = correction(initial, trials, [1.0, 1.0])
    assert result.rank == 1
    np.testing.assert_allclose(result.unbalances, [-0.5, -0.5], rtol=1e-5)
    assert np.abs(result.expected).max() < 1e-5


def test_a_plane_with_little_influence_is_balanced_by_its_own_trial_unbalance():
    influence = np.array([[1e6, 1.0], [3e5, 2.0], [1e5, 1.0]])
    unbalances = np.array([2e-6, 2.0 + 1.0j])
    initial, trial = -influence @ unbalances, np.array([1e-6, 1.0])
    result = correction(initial, initial + (influence * trial).T, trial)
    assert result.rank == 2
    np.testing.assert_allclose(result.unbalances, unbalances, rtol=1e-9)
    np.testing.assert_allclose(result.influence, influence, rtol=1e-9)
    np.testing.assert_allclose(result.expected, 0, atol=1e-12)


@pytest.mark.usefixtures("few_turns")
def test_a_machine_balanced_to_nothing_does_not_vibrate_by_its_sag():
    """Three planes at the three discs take their unbalance away as a whole."""
    result = balance(without_contact(2e6), [150.0, 500.0], [4, 5, 6], measured=[4, 6])
    assert result.residual < 1e-4
    table = result.table()
    assert "rank" not in table.title
    measured = [row for row in table.rows if row[0].startswith("node")]
    for row, v in zip(measured, result.vibrations, strict=True):
        assert row[7:9] == pytest.approx((1e6 * abs(v.corrected), 1e6 * abs(v.expected)))


def test_a_machine_whose_planes_are_dependent_says_so():
    result = balance(without_contact(2e6), [150.0], [4, 6], measured=[4])
    own = sum(d.e * 1.8 for d in rig().discs)  # the discs have less than 1.8 kg each
    assert max(abs(p.unbalance) for p in result.planes) < own
    assert "of 2 planes have rank 1" in result.table().title


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"speeds": [], "planes": [4]}, "speeds"),
        ({"speeds": 150.0, "planes": [4]}, "speeds = 150.0: must be a list of numbers"),
        ({"speeds": [150.0], "planes": 4}, "planes = 4: must be a list of nodes"),
        ({"speeds": [150.0], "planes": [4], "measured": 4}, "measured = 4: must be a list"),
        ({"speeds": [150.0], "planes": [4.5]}, "node = 4.5: must be an integer from 1 to 8"),
        ({"speeds": [500 / 3, 500 / 3], "planes": [4]}, "speeds: 166.667, 166.667 rad/s: must be"),
        (
            {"speeds": [150.0], "planes": [4], "measured": [5, 5]},
            "measured: [5, 5]: must be different",
        ),
        ({"speeds": [1e-300], "planes": [4]}, "speed = 1e-300 rad/s: must be finite and not 0"),
        ({"speeds": [150.0], "planes": [4], "trial": 1e300}, "= 1e+300 kg.m: must not exceed"),
        ({"speeds": [150.0], "planes": [4], "measured": []}, "measured: []: must be different"),
        ({"speeds": [150.0], "planes": [3, 4, 6], "measured": [4]}, "2 measurements for 3 planes"),
    ],
)
def test_what_cannot_be_balanced_is_refused_before_any_run(arguments, expected):
    runs = []
    with pytest.raises(InputError) as refused:
        balance(without_contact(), **arguments, report=lambda *run: runs.append(run))
    assert expected in str(refused.value)
    assert not runs


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "--speed and --plane: must be given"),
        (["--speed", "150", "--plane", "9"], "--plane 9: must be from 1 to 8"),
        (["--speed", "150", "--plane", "4", "--plane", "4"], "must be different nodes"),
        (["--speed", "0", "--plane", "4"], "balancing speed = 0 rad/s: must be finite and"),
        (["--speed", "150", "--plane", "4", "--trial", "0"], "trial unbalance = 0"),
    ],
)
def test_impossible_wishes_are_refused(refusal, arguments, expected):
    assert expected in refusal("balance", *arguments)


def test_a_machine_without_unbalance_is_not_balanced():
    rotor = without_contact()
    bare = rotor.with_parts(Disc, *[Disc(d.node, d.diameter, d.width) for d in rotor.discs])
    opposite = [Unbalance(4, 1e-5, 0.0), Unbalance(4, 1e-5, math.pi)]
    for machine in (bare, bare.with_parts(Unbalance, *opposite)):
        with pytest.raises(InputError, match="no unbalance"):
            balance(machine, [150.0], [4])


@pytest.mark.parametrize(
    ("initial", "trials", "unbalances", "expected"),
    [
        ([1.0], [[1.0, 2.0]], [1.0], "shape"),
        ([np.nan], [[1.0]], [1.0], r"initial = \[nan\]: must be finite numbers"),
        (
            [1.0],
            [[1.0], [2.0, 3.0]],
            [1.0, 1.0],
            r"trials = \[\[1.0\], \[2.0, 3.0\]\]: must be finite",
        ),
        ([1.0], [[1.0]], ["50 g.mm"], "unbalances = .* must be finite numbers"),
        ([1.0], [[1.0]], [0.0], "trial unbalance is 0"),
        ([1.0], [[1.0], [2.0]], [1.0, 1.0], "1 measurements for 2 planes"),
    ],
)
def test_measurements_that_do_not_fit_are_refused(initial, trials, unbalances, expected):
    with pytest.raises(InputError, match=expected):
        correction(initial, trials, unbalances)
