"""Balancing by influence coefficients: the algebra, and runs of the rig without contact."""

import json
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.linear_bearing import LinearBearing

from rotor_fmu.cli import app
from rotor_fmu.errors import InputError
from rotor_fmu.linear.answers import unbalance_response
from rotor_fmu.trial_balancing import balance
from rotor_fmu.vibration.influence_coefficients import correction


def without_contact():
    """The rig on linear bearings in the place of its clearance bearings."""
    bearings = [
        LinearBearing(node=b.node, kxx=2e6, kyy=2.5e6, cxx=300.0, cyy=300.0) for b in rig().bearings
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
    assert [done for done, _ in runs] == [0, 1, 2, 3]
    assert runs[2][1].startswith("trial unbalance at node 6, ")
    assert not result.touches
    # and the run does what the coefficients say, within the run's own error
    size = max(abs(v.initial) for v in result.vibrations)
    assert max(abs(v.corrected - v.expected) for v in result.vibrations) < 1e-4 * size


def test_influence_coefficients_from_runs_are_those_of_the_linear_response():
    rotor = without_contact()
    result = balance(rotor, [150.0], [4], measured=[6])
    linear = unbalance_response(rotor, [150.0], unbalances=[(4, 1.0, 0.0)])
    expected = [linear.x[0, 5], linear.y[0, 5]]
    np.testing.assert_allclose(result.influence[:, 0], expected, rtol=1e-3)


def test_a_machine_that_does_not_settle_is_refused():
    rotor = replace(without_contact(), rotating_damping=True)
    with pytest.raises(InputError, match=r"balancing speed = 300 rad/s: the machine is unstable"):
        balance(rotor, [300.0], [4])


def test_a_contact_that_closes_is_said():
    assert balance(rig(), [150.0], [5]).touches


def test_the_command_tells_the_corrections(tmp_path, capsys):
    app(
        ["balance", "--speed", "150", "--plane", "5", "--out", str(tmp_path)],
        standalone_mode=False,
    )
    assert "plane at node 5 [g.mm]" in capsys.readouterr().out
    data = json.loads((tmp_path / "balance.json").read_text())
    assert data["planes"][0]["node"] == 5
    assert (tmp_path / "balance.png").read_bytes().startswith(b"\x89PNG")


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


def test_a_machine_balanced_to_nothing_does_not_vibrate_by_its_sag():
    """Three planes at the three discs take their unbalance away as a whole."""
    bearings = [
        LinearBearing(node=b.node, kxx=2e6, kyy=2e6, cxx=300.0, cyy=300.0) for b in rig().bearings
    ]
    result = balance(
        rig().with_parts(Bearing, *bearings), [150.0, 500.0], [4, 5, 6], measured=[4, 6]
    )
    assert result.residual < 1e-4


def test_a_machine_whose_planes_are_dependent_says_so():
    bearings = [
        LinearBearing(node=b.node, kxx=2e6, kyy=2e6, cxx=300.0, cyy=300.0) for b in rig().bearings
    ]
    result = balance(rig().with_parts(Bearing, *bearings), [150.0], [4, 6], measured=[4])
    own = sum(d.e * 1.8 for d in rig().discs)  # the discs have less than 1.8 kg each
    assert max(abs(p.unbalance) for p in result.planes) < own
    assert "of 2 planes have rank 1" in result.table().title


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"speeds": [], "planes": [4]}, "speeds"),
        ({"speeds": [150.0, 150.0], "planes": [4]}, "speeds"),
        (
            {"speeds": [150.0], "planes": [4], "measured": [5, 5]},
            "measured: [5, 5]: must be different",
        ),
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
        (["--speed", "150", "--plane", "9"], "node 9: must be from 1 to 8"),
        (["--speed", "150", "--plane", "4", "--plane", "4"], "must be different nodes"),
        (["--speed", "-150", "--plane", "4"], "balancing speed = -150"),
        (["--speed", "150", "--plane", "4", "--trial", "0"], "trial unbalance = 0"),
    ],
)
def test_impossible_wishes_are_refused(tmp_path, arguments, expected):
    with pytest.raises(InputError) as refused:
        app(["balance", *arguments, "--out", str(tmp_path / "out")], standalone_mode=False)
    assert expected in str(refused.value)
    assert not list(tmp_path.iterdir())


def test_a_machine_without_unbalance_is_not_balanced():
    rotor = without_contact()
    bare = rotor.with_parts(Disc, *[Disc(d.node, d.diameter, d.width) for d in rotor.discs])
    with pytest.raises(InputError, match="no unbalance"):
        balance(bare, [150.0], [4])


@pytest.mark.parametrize(
    ("initial", "trials", "unbalances", "expected"),
    [
        ([1.0], [[1.0, 2.0]], [1.0], "shape"),
        ([1.0], [[1.0]], [0.0], "trial unbalance is 0"),
        ([1.0], [[1.0], [2.0]], [1.0, 1.0], "1 measurements for 2 planes"),
    ],
)
def test_measurements_that_do_not_fit_are_refused(initial, trials, unbalances, expected):
    with pytest.raises(InputError, match=expected):
        correction(initial, trials, unbalances)
