"""Signals against closed forms: chirps with known orders, ellipses, whirls of a known frequency."""

from itertools import pairwise

import numpy as np
import pytest
import scipy.signal
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.prominent_peaks import prominent_peaks
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu import vibration
from rotor_fmu.linear.answers import unbalance_response

TURN = 2 * np.pi


def run_down(duration=20.0, speed=400.0, rate=-10.0, step=7e-4, seed=1):
    """Time and angle of a run-down at uneven steps."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(step * rng.uniform(0.4, 1.0, int(1.4 * duration / step)))
    t = t[t < duration]
    return t, 0.3 + speed * t + rate * t**2 / 2


def test_a_chirp_gives_back_amplitude_and_phase_of_its_orders():
    t, phi = run_down()
    given = {0.5: 3e-6 * np.exp(0.4j), 1.0: 80e-6 * np.exp(-1.1j), 2.0: 7e-6 * np.exp(2.0j)}
    z = 1e-3 - 2e-4j + sum(a * np.exp(1j * k * phi) for k, a in given.items())
    track = vibration.order_track(t, phi, z)
    for i, (order, amplitude) in enumerate(given.items()):
        assert np.abs(track.forward[:, i] - amplitude).max() < 2e-9, order
        assert np.abs(track.backward[:, i]).max() < 2e-9, order
        assert track.major(order) == pytest.approx(abs(amplitude), rel=1e-3)
    assert np.mod(track.phase_x(1.0) + 1.1 + np.pi, TURN) == pytest.approx(np.pi, abs=1e-3)
    # y lags x by a quarter turn
    assert track.phase_y(1.0) == pytest.approx(track.phase_x(1.0) - np.pi / 2, abs=1e-3)
    assert track.speed == pytest.approx(400.0 - 10.0 * track.t, rel=1e-4)


def test_a_straight_line_is_half_forward_and_half_backward():
    t, phi = run_down(5.0)
    track = vibration.order_track(t, phi, 50e-6 * np.cos(phi - 0.7))
    assert np.abs(track.forward[:, 1]) == pytest.approx(25e-6, rel=1e-3)
    assert np.abs(track.backward[:, 1]) == pytest.approx(25e-6, rel=1e-3)
    assert np.abs(track.x()) == pytest.approx(50e-6, rel=1e-3)
    assert np.abs(track.y()).max() < 1e-9
    assert np.angle(track.x()) == pytest.approx(-0.7, abs=1e-3)


def test_an_amplitude_that_changes_is_followed():
    t, phi = run_down()
    amplitude = 1e-6 * (20 + 60 * np.exp(-(((400 - 10 * t - 300) / 15) ** 2)))
    track = vibration.order_track(t, phi, amplitude * np.exp(1j * phi))
    assert track.major() == pytest.approx(np.interp(track.t, t, amplitude), rel=2e-3)


def test_a_resonance_has_the_amplification_of_one_over_two_zeta():
    zeta, critical = 0.02, 200.0
    speed = np.linspace(400.0, 20.0, 4001)
    r = speed / critical
    amplitude = 1e-5 / np.abs(1 - r**2 + 2j * zeta * r)
    (peak,) = vibration.resonances(speed, amplitude)
    assert peak.speed == pytest.approx(critical, rel=1e-3)
    assert peak.amplitude == pytest.approx(1e-5 / (2 * zeta), rel=1e-3)
    assert peak.amplification == pytest.approx(1 / (2 * zeta), rel=1e-2)
    (cut,) = vibration.resonances(speed[speed > 197.5], amplitude[speed > 197.5])
    assert np.isnan(cut.amplification)
    assert vibration.resonances(speed, np.zeros_like(speed)) == []
    ripple = 0.05 * peak.amplitude * np.sin(speed) * (speed < 150)
    assert len(vibration.resonances(speed, amplitude + np.abs(ripple))) == 1
    (backward,) = vibration.resonances(-speed, amplitude)
    assert backward.amplification == pytest.approx(peak.amplification)
    (at_once,) = vibration.resonances(speed, amplitude, t=np.zeros_like(speed))
    assert np.isnan(at_once.rate)


def test_full_spectrum_tells_forward_from_backward():
    t, phi = run_down(10.0)
    z = 5e-5j + 40e-6 * np.exp(1j * phi) + 10e-6 * np.exp(-1j * phi) + 5e-6 * np.exp(-0.5j * phi)
    result = vibration.full_spectrum(t, phi, z, 350.0)
    at = {round(k, 6): a for k, a in zip(result.order, result.amplitude, strict=True)}
    assert result.speed == pytest.approx(350.0, abs=2.0)
    assert at[1.0] == pytest.approx(40e-6, rel=1e-3)
    assert at[-1.0] == pytest.approx(10e-6, rel=1e-3)
    assert at[-0.5] == pytest.approx(5e-6, rel=1e-3)
    assert at[0.5] < 1e-9
    assert at[0.0] < 1e-9
    assert result.frequency[np.argmax(result.amplitude)] == pytest.approx(result.speed)


def test_orders_do_not_leak_past_the_neighbouring_lines():
    t, phi = run_down(10.0)
    result = vibration.full_spectrum(t, phi, 1e-4 * np.exp(1j * phi), 350.0)
    far = np.abs(result.order - 1.0) > 1.5 * result.resolution
    assert result.amplitude[far].max() < 1e-8
    # between two lines Hann's window takes at most 15 %
    between = vibration.full_spectrum(t, phi, 1e-4 * np.exp(1j * (1 + 1 / 32) * phi), 350.0)
    assert 0.84e-4 < between.amplitude.max() < 0.86e-4


def test_what_is_faster_than_half_the_sampling_does_not_fold_back():
    t, phi = run_down(5.0, step=6e-5)
    z = 1e-6 * np.exp(1j * phi) + 1e-5 * np.exp(63j * phi)
    # 64 samples a turn would show order 63 as backward 1x
    folded = vibration.order_track(t, phi, z, per_turn=64)
    assert np.abs(folded.backward[:, 1]).min() > 5e-6
    track = vibration.order_track(t, phi, z)
    assert np.abs(track.backward[:, 1]).max() < 2e-8
    assert track.major(1.0) == pytest.approx(1e-6, rel=0.02)


def test_cascade_follows_an_order_and_a_frequency_of_its_own():
    t, phi = run_down(30.0)
    own = 250.0
    z = 30e-6 * np.exp(1j * phi) + 10e-6 * np.exp(-1j * own * t)
    result = vibration.cascade(t, phi, z, lines=40)
    assert result.amplitude.shape == (40, len(result.order))
    forward = result.order > 0
    ahead = np.argmax(np.where(forward, result.amplitude, 0), axis=1)
    assert result.order[ahead] == pytest.approx(1.0)
    back = np.argmax(np.where(forward, 0, result.amplitude), axis=1)
    line = 1.01 * result.speed / 16
    assert np.all(np.abs(result.frequency[np.arange(40), back] + own) < line)


@pytest.mark.parametrize(("sense", "order"), [(1, 1.0), (-1, -1.0), (0, 0.0)])
def test_sense_of_whirl_of_circles_and_of_a_line(sense, order):
    t, phi = run_down(5.0)
    z = {1: np.exp(1j * phi), -1: np.exp(-1j * phi), 0: np.cos(phi) + 0j}[sense] * 1e-5
    result = vibration.whirl(t, phi, 3e-4 + z)
    assert result.sense == pytest.approx(sense, abs=1e-3)
    assert result.order == pytest.approx(order, abs=1e-2)


def test_sense_and_order_of_a_backward_whip():
    t, phi = run_down(5.0, step=1.5e-4)
    result = vibration.whirl(t, phi, 1e-4 * np.exp(-5j * phi))
    assert result.sense == pytest.approx(-1, abs=1e-3)
    assert result.order == pytest.approx(-5, rel=1e-2)


def test_a_circle_about_a_place_that_moves_far_is_still_a_circle():
    """Its radius is a thousandth and less of the way of its middle."""
    phi = np.linspace(0, 400 * TURN, 40001)
    for moves in (1e-3 * phi + 2e-7j * phi**2, 1e3 + 0j):
        whirl = vibration.whirl(phi / 100, phi, np.exp(1j * phi) + moves, turns=4)
        assert whirl.order == pytest.approx(1.0, abs=2e-4)
        assert whirl.sense == pytest.approx(1.0, abs=2e-4)
    tiny = vibration.whirl(phi / 100, phi, 1.0 + 1e-9 * np.exp(1j * phi))
    assert tiny.order == pytest.approx(1.0, abs=1e-3)


def test_the_rounding_of_a_place_that_stands_does_not_whirl():
    phi = np.linspace(0, 100 * TURN, 10001)
    z = np.where(phi < 50 * TURN, 0.0, 0.7 + 0.1j)
    with np.errstate(invalid="raise"):
        result = vibration.whirl(phi / 100, phi, z)
    stands = np.abs(np.arange(len(result.t)) - len(result.t) / 2) > 10
    assert (result.sense[stands] == 0.0).all()
    assert (result.order[stands] == 0.0).all()


def test_a_share_of_time_counts_the_time_of_a_straight_path():
    z = np.array([2 + 1j, -3 + 1j, -3 + 1j])  # two fifths of the first second to the right
    result = vibration.time_share([0.0, 1.0, 4.0], [5.0] * 3, z, speeds=1, angles=4, pieces=3)
    assert result.share[0] == pytest.approx([1 / 12, 11 / 12, 0, 0])


def test_orbit_begins_at_the_mark_and_holds_whole_turns():
    t, phi = run_down(10.0)
    z = 40e-6 * np.exp(1j * (phi - 0.5)) + 10e-6 * np.exp(-1j * phi)
    result = vibration.orbit(t, phi, z, 350.0, turns=2)
    at_mark = 40e-6 * np.exp(-0.5j) + 10e-6
    assert np.abs(result.marks - at_mark).max() < 1e-9
    assert result.z[0] == result.marks[0]
    assert np.abs(result.z).max() == pytest.approx(50e-6, rel=1e-3)
    assert np.abs(result.z).min() == pytest.approx(30e-6, rel=3e-3)
    assert result.t[-1] - result.t[0] == pytest.approx(2 * TURN / 350.0, rel=0.02)


def test_poincare_points_of_a_motion_of_two_turns_alternate():
    t, phi = run_down(5.0)
    z = 1e-5 * np.exp(1j * phi) + 4e-6 * np.exp(0.5j * phi)
    points = vibration.poincare(t, phi, z).points
    assert np.abs(np.abs(np.diff(points)) - 8e-6).max() < 1e-8
    assert np.abs(points[2:] - points[:-2]).max() < 1e-8


def test_displacements_of_an_ellipse():
    t, phi = run_down(5.0)
    z = 2e-4 + 30e-6 * np.cos(phi) + 20e-6j * np.sin(phi)
    result = vibration.displacement(t, phi, z)
    assert result.x_pp == pytest.approx(60e-6, rel=2e-3)
    assert result.y_pp == pytest.approx(40e-6, rel=2e-3)
    assert result.s_max == pytest.approx(30e-6, rel=2e-3)
    np.testing.assert_allclose(result.mean, 2e-4, rtol=1e-4)


def test_a_contact_that_touches_a_quarter_of_each_turn():
    t, phi = run_down(10.0, step=5e-5)
    psi = np.mod(phi, TURN)
    touches = (psi > np.pi) & (psi < 1.5 * np.pi)
    result = vibration.contact(t, phi, psi, 40.0 * touches)
    assert result.share == pytest.approx(0.25, abs=0.01)
    assert result.mean == pytest.approx(10.0, rel=0.04)
    assert result.peak == pytest.approx(40.0)
    assert result.angle == pytest.approx(1.25 * np.pi, abs=0.02)
    # mean of exp(i psi) over a quarter is 2 sqrt(2) / pi long
    assert result.spread == pytest.approx(1 - 2 * np.sqrt(2) / np.pi, abs=0.01)


@pytest.mark.parametrize(
    ("angles", "low", "width"),
    [
        ((-10, 20, 100), 350, 110),
        ((100, 20, 50), 20, 80),
        ((300, 20, 310), 300, 80),
        ((30, 30), 30, 0),
    ],
)
def test_the_range_of_a_contact_is_all_but_the_widest_gap(angles, low, width):
    phi = np.radians(np.arange(0, 1081, 10))
    psi, fn = np.full(len(phi), np.radians(200)), np.zeros(len(phi))
    for turn in (0, 2):
        rows = 36 * turn + 5 + np.arange(len(angles))
        psi[rows], fn[rows] = np.radians(angles) + TURN * turn, 1.0
    result = vibration.contact(phi / 100, phi, psi, fn)
    assert np.degrees(result.low) == pytest.approx([low, np.nan, low], nan_ok=True)
    assert np.degrees(result.width) == pytest.approx([width, np.nan, width], nan_ok=True, abs=1e-9)


def test_turns_in_which_nothing_was_recorded_have_no_contact():
    phi = np.append(np.linspace(0, 3 * TURN, 300), np.linspace(7 * TURN, 9 * TURN, 200))
    result = vibration.contact(phi / 100, phi, phi, np.ones(len(phi)))
    assert len(result.t) == len(vibration.turns_of(phi / 100, phi).rows) - 3
    assert result.mean == pytest.approx(1.0)
    without_angle = vibration.contact(phi / 100, phi, np.full(len(phi), np.nan), np.ones(len(phi)))
    assert np.isnan(without_angle.low).all()
    assert without_angle.share == pytest.approx(1.0)


def test_without_a_touch_there_is_no_angle():
    t, phi = run_down(2.0)
    result = vibration.contact(t, phi, np.zeros_like(t), np.zeros_like(t))
    assert not result.share.any()
    assert np.isnan(result.angle).all()


def test_a_row_without_its_time_takes_no_power_from_the_turns_about_it():
    t = np.arange(0.0, 1.0, 1e-3)
    lost = np.where(np.arange(len(t)) == 523, np.nan, t)  # the last row of the fifth turn
    _, _, powers = vibration.power_by_sink(lost, 60.0 * t, {"friction": 3.0 * t})
    assert powers["friction"] == pytest.approx(3.0)


def test_power_by_sink_is_what_was_dissipated_in_the_turn():
    t, phi = run_down(5.0)
    middle, speed, powers = vibration.power_by_sink(t, phi, {"friction": 3.0 * t, "shaft": t**2})
    assert powers["friction"] == pytest.approx(3.0)
    assert powers["shaft"] == pytest.approx(2 * middle, rel=1e-3)
    assert speed == pytest.approx(400.0 - 10.0 * middle, rel=1e-3)


def test_at_constant_speed_the_spectrum_is_of_the_last_turns():
    turns = np.linspace(0.0, 40.0, 40 * 64 + 1)
    phi = 2 * np.pi * turns
    settled = np.exp(1j * phi) * (1.0 + np.exp(-turns / 2))
    result = vibration.full_spectrum(turns, phi, settled, 2 * np.pi, turns=8)
    assert result.amplitude.max() == pytest.approx(1.0, abs=np.exp(-32.0 / 2))


@pytest.mark.parametrize("off", [-1e-12, 0.0, 1e-12])
def test_a_turn_that_begins_at_a_mark_but_for_rounding_is_whole(off):
    phi = 2 * np.pi * (np.linspace(1.0, 3.0, 129) + off)
    assert len(vibration.turns_of(np.linspace(0.0, 2.0, 129), phi).mark) == 2


def test_an_order_that_the_block_does_not_hold_is_refused():
    """Nor 0.25, which is a line of the block's spectrum, but one into which the mean leaks."""
    t, phi = run_down(2.0)
    for order in (0.3, 0.25):
        reason = r"a block of 4 turns resolves multiples of 0\.25, from 0\.5"
        with pytest.raises(ValueError, match=rf"order {order}: {reason}"):
            vibration.order_track(t, phi, phi + 0j, [order])
    with pytest.raises(ValueError, match=r"order 3: must be one of 0\.5, 1, 2"):
        vibration.order_track(t, phi, phi + 0j).x(3)


def test_a_slow_run_down_without_contact_follows_the_linear_response_to_unbalance():
    text = rig_toml().split("[[bearing]]")[0]
    bearings = "".join(
        f"[[linear_bearing]]\nnode = {node}\nkxx = 4e5\nkyy = 2e6\ncxx = 60.0\ncyy = 60.0\n"
        for node in (2, 8)
    )
    rotor = parse_rotor(text + bearings)
    rate, speed, stop = -2.5, 225.0, 16.0
    simulation = Simulation(rotor, choose("controlled", tolerance=1e-4), speed=speed, rate=rate)
    names = ("phi", "disc[2].x", "disc[2].y")
    times = np.arange(0.0, stop, TURN / 24 / speed)
    rows = [[simulation.read(name) for name in names]]
    for t, to in pairwise(times):
        simulation.advance(to, speed + rate * t)
        rows.append([simulation.read(name) for name in names])
    phi, x, y = np.array(rows).T
    track = vibration.order_track(times, phi, x + 1j * y)
    late = np.flatnonzero(track.t > 4.0)[::40]
    linear = unbalance_response(rotor, track.speed[late])
    node = rotor.discs[1].node - 1
    for result, truth in ((track.x(), linear.x[:, node]), (track.y(), linear.y[:, node])):
        difference = np.abs(result[late] - truth) / np.abs(truth).max()
        assert difference.max() < 0.02
        assert np.median(np.abs(np.angle(result[late] / truth))) < 0.02


def test_the_vector_and_the_ellipse_of_an_order_of_a_quarter_are_those_of_the_angle_itself():
    t = np.arange(0.0, 3.0, 1e-3)
    phi = 1000.0 + 60.0 * t
    z = 3e-5j * np.exp(0.25j * phi) + 1e-5 * np.exp(-0.25j * phi)
    track = vibration.order_track(t, phi, z, [0.25], turns=8)
    assert track.forward == pytest.approx(3e-5j, rel=1e-3)
    assert track.backward == pytest.approx(1e-5, rel=1e-3)
    assert track.major(0.25) == pytest.approx(4e-5, rel=1e-3)
    assert track.minor(0.25) == pytest.approx(2e-5, rel=1e-3)


def test_peaks_and_their_prominences_are_those_of_scipy():
    """Of curves of few values, that have flat peaks and equal ones, and of a logarithm of 0."""
    rng = np.random.default_rng(5)
    for count in range(120):
        values = rng.integers(0, 2 + count % 8, count).astype(float)
        values[values == rng.integers(0, 8)] = -np.inf
        for least in (0.0, 2.0):
            at, heights = prominent_peaks(values, least)
            expected, of = scipy.signal.find_peaks(values, prominence=least)
            assert at.tolist() == expected.tolist()
            assert heights.tolist() == of["prominences"].tolist()
