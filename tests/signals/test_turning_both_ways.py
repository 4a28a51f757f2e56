"""Signals of known content of shafts that turn backward, turn back, stand, or are recorded
coarsely; whirls slower than the shaft, and resonances passed in a hurry."""

import math
import warnings

import numpy as np
import pytest
from rotor_fmu.model.linear import unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from scipy.integrate import solve_ivp

from rotor_fmu import vibration
from rotor_fmu.errors import InputError
from rotor_fmu.run_pictures.signal_plots import KINDS
from rotor_fmu.run_pictures.view import View
from rotor_fmu.vibration.recorded import recorded

from .. import recordings
from ..linear.test_linear_steady import MACHINE

TURN = 2 * math.pi


def uneven(stop, step=7e-4, seed=1):
    """Times of uneven steps."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(step * rng.uniform(0.4, 1.0, int(1.5 * stop / step)))
    return t[t < stop]


def mixed(phi):
    """A motion with 0.5x, 1x forward and backward."""
    return 1e-4 + 40e-6 * np.exp(1j * (phi - 0.6)) + (10 + 5j) * 1e-6 * np.exp(-1j * phi)


def test_a_machine_that_turns_backward_is_its_mirror_image():
    """y upside down and the angle falling: all else is the same, the speed's sign apart."""
    t = uneven(10.0)
    phi = 0.3 + 400 * t - 5 * t**2
    z = mixed(phi) + 5e-6 * np.exp(0.5j * phi)
    ahead = vibration.order_track(t, phi, z)
    back = vibration.order_track(t, -phi, z.conj())
    assert back.speed == pytest.approx(-ahead.speed)
    for order in (0.5, 1.0, 2.0):
        assert back.x(order) == pytest.approx(ahead.x(order), abs=1e-12)
        assert back.y(order) == pytest.approx(-ahead.y(order), abs=1e-12)
        assert back.minor(order) == pytest.approx(ahead.minor(order), abs=1e-12)
    for one, other in (
        (vibration.whirl(t, phi, z), vibration.whirl(t, -phi, z.conj())),
        (vibration.displacement(t, phi, z), vibration.displacement(t, -phi, z.conj())),
    ):
        for name, values in vars(one).items():
            sign = -1 if name == "speed" else 1
            assert getattr(other, name) == pytest.approx(sign * values), name
    one = vibration.full_spectrum(t, phi, z, 350.0)
    other = vibration.full_spectrum(t, -phi, z.conj(), -350.0)
    assert other.speed == pytest.approx(-one.speed)
    assert other.amplitude == pytest.approx(one.amplitude, abs=1e-15)
    assert other.frequency == pytest.approx(one.frequency)


@pytest.mark.parametrize("way", [1, -1])
def test_a_response_that_comes_late_lags_whichever_way_the_shaft_turns(way):
    t = uneven(3.0)
    turned = 200.0 * t
    late = 0.7  # rad after the mark has passed
    z = 3e-5 * np.cos(turned - late) + 1e-5j * np.cos(turned - late - 0.2)
    track = vibration.order_track(t, way * turned, z)
    assert np.angle(track.x()) == pytest.approx(-late, abs=1e-3)
    assert np.angle(track.y()) == pytest.approx(-late - 0.2, abs=1e-3)
    assert np.abs(track.x()) == pytest.approx(3e-5, rel=1e-3)


def test_blocks_of_turns_do_not_reach_across_a_reversal():
    """From 100 to -100 rad/s in 20 s, with another unbalance on the way back."""
    t = uneven(20.0, 4e-4)
    phi = 2.0 + 100 * t - 5 * t**2
    out, back = 30e-6 * np.exp(-1j), 12e-6 * np.exp(0.4j)
    z = np.where(t < 10, out, back) * np.exp(1j * phi)
    track = vibration.order_track(t, phi, z, (1.0,))
    right = np.where(track.speed > 0, out, back)
    assert np.abs(track.forward[:, 0] - right).max() < 1e-10
    assert np.abs(track.backward).max() < 1e-10
    assert track.speed == pytest.approx(100 - 10 * track.t, abs=1e-3)
    # 500 rad each way hold 78 or 79 whole turns, blocks of 4 three less
    assert [np.count_nonzero(track.speed > 0), np.count_nonzero(track.speed < 0)] == [75, 75]
    result = vibration.cascade(t, phi, z, turns=8)
    assert (
        np.abs(result.amplitude.max(axis=1) - np.where(result.speed > 0, 30e-6, 12e-6)).max() < 1e-9
    )
    spot = vibration.orbit(t, phi, z, -50.0)
    assert np.abs(spot.z) == pytest.approx(12e-6, rel=1e-4)


@pytest.mark.parametrize("kind", ["bode", "polar"])
def test_no_picture_joins_the_two_senses_of_rotation(kind):
    """Whose phase jumps by 180 degrees, as that of y does, which lags first and then leads."""
    run = recordings.recorded(stop=30.0)
    speed = vibration.order_track(run.t, run.phi, run.place("disc[2]").z).speed
    curves = [
        line.get_data() for axes in KINDS[kind](View(run, "disc[2]")).axes for line in axes.lines
    ]
    curves = [curve for curve in curves if len(curve[0]) >= len(speed)]  # not marks of speeds
    assert len(curves) == {"bode": 6, "polar": 2}[kind]
    for over, along in curves:
        sense = np.sign(over if kind == "bode" else speed)
        is_drawn = np.isfinite(np.diff(over) + np.diff(along))
        assert not (is_drawn & (np.diff(sense) != 0)).any()
        if kind == "bode":
            slowest = np.abs(over[np.isfinite(along)]).min()
            assert slowest == pytest.approx(np.abs(speed).min() / TURN, rel=1e-3)


@pytest.mark.parametrize(("stop", "turns"), [(0.15, 7), (1.0, 16)])
def test_the_picture_of_a_short_whirl_says_over_how_many_turns_it_is(stop, turns):
    above, _ = KINDS["whirl"](View(recordings.recorded(stop=stop))).axes
    assert f"over {turns} turns each" in above.get_title(loc="left")


def test_a_rest_parts_turns_and_a_small_step_back_does_not():
    t = np.arange(0, 12.0, 5e-4)
    w = np.where((t > 4) & (t < 8), 0.0, 100.0)
    phi = np.concatenate([[0], np.cumsum(w[:-1] * np.diff(t))])
    turns = vibration.turns_of(t, phi)
    assert len(np.unique(turns.passage)) == 2
    assert turns.speed == pytest.approx(100.0, rel=1e-6)
    shaken = vibration.turns_of(t, phi + 0.02 * np.sin(40 * phi + 300 * t * (w > 0)))
    assert len(np.unique(shaken.passage)) == 2
    with pytest.raises(
        vibration.TooFewTurns, match="holds 63 whole turns of the shaft on end; needed: 70"
    ):
        turns.needs(70)


@pytest.mark.parametrize("way", [1, -1])
def test_a_shaft_that_shakes_as_it_turns_has_all_of_its_turns(way):
    """In each shake it steps back, by less than what makes a reversal."""
    t = np.linspace(0.0, 10.0, 40_001)
    phi = way * (0.5 + TURN * t + 0.04 * np.sin(200.0 * t))
    assert (way * np.diff(phi) < 0).any()
    turns = vibration.synchronous(t, phi, np.cos(phi))
    assert len(turns.mark) == 9
    assert turns.sense.tolist() == 9 * [way]
    assert turns.longest == 9


def test_contacts_and_powers_have_their_turns_both_ways():
    t = np.arange(0, 20.0, 2e-4)
    phi = 100 * t - 5 * t**2
    fn = np.where(np.mod(phi, TURN) < TURN / 4, 8.0, 0.0)
    result = vibration.contact(t, phi, np.mod(phi, TURN), fn)
    fast = np.abs(result.speed) > 50
    assert result.share[fast] == pytest.approx(0.25, abs=0.01)
    assert (result.speed > 0).sum() == pytest.approx((result.speed < 0).sum(), abs=1)
    _, speed, powers = vibration.power_by_sink(t, phi, {"friction": 3.0 * t})
    assert powers["friction"] == pytest.approx(3.0)
    assert speed.min() < -90


@pytest.mark.parametrize("order", [0.2, 0.29, 0.43, 0.47, -0.43, 1.37])
def test_a_whirl_of_its_own_frequency_is_the_circle_that_it_is(order):
    t = uneven(8.0)
    z = 3e-4 + 50e-6 * np.exp(1j * (order * 250 * t + 0.3))
    whirl = vibration.whirl(t, 250 * t, z)
    assert whirl.sense == pytest.approx(math.copysign(1, order), abs=2e-4)
    assert whirl.order == pytest.approx(order, rel=1e-3)
    result = vibration.displacement(t, 250 * t, z)
    assert result.s_max == pytest.approx(50e-6, rel=7e-3)
    np.testing.assert_allclose(result.mean, 3e-4, atol=7e-3 * 50e-6)
    assert result.x_pp == pytest.approx(100e-6, rel=1e-3)
    assert result.y_pp == pytest.approx(100e-6, rel=1e-3)


def test_displacements_of_a_single_turn_are_those_about_its_mean():
    t = np.linspace(0, 0.04, 400)
    result = vibration.displacement(t, 200 * t, 2e-4 + 30e-6 * np.exp(200j * t))
    assert result.s_max == pytest.approx(30e-6, rel=1e-3)


def test_what_peaks_while_the_speed_is_held_has_no_amplification():
    """A whirl that comes and goes: both of its half-power points are at one speed."""
    t = np.linspace(0.0, 20.0, 401)
    amplitude = 0.1 + np.exp(-((t - 15.0) ** 2))
    with warnings.catch_warnings(action="error"):
        (peak,) = vibration.resonances(np.minimum(20.0 * t, 200.0), amplitude, t=t)
    assert peak.speed == 200.0
    assert math.isnan(peak.amplification)


def two_resonances(speed, apart):
    """Moduli of two modes with an amplification of 25, the second of less weight."""
    modes = (
        (150.0, 1.0),
        (150.0 + apart, 0.8),
    )
    h = [a * speed**2 / (w**2 - speed**2 + 0.04j * w * speed) for w, a in modes]
    return np.abs(h[0] - h[1])


def test_an_amplification_is_refused_where_the_trough_does_not_reach_half_power():
    speed = np.linspace(50.0, 300.0, 4001)
    first, second = vibration.resonances(speed, two_resonances(speed, 15.0))
    trough = two_resonances(np.linspace(first.speed, second.speed, 200), 15.0).min()
    assert second.amplitude * 0.5**0.5 < trough
    assert math.isnan(second.amplification)
    apart = vibration.resonances(speed, two_resonances(speed, 60.0))
    assert [peak.amplification for peak in apart] == pytest.approx([25.0, 25.0], rel=0.03)


def swept(q, rate):
    """Speed, amplitude and time of a mode of frequency 1 and amplification q that is swept through
    by `rate`, by integration of its envelope."""
    zeta = 0.5 / q
    span = max(10 * zeta, 12 * math.sqrt(abs(rate)))
    begin = 1 - math.copysign(span, rate)

    def slope(t, y):
        w = begin + rate * t
        accelerated = w * w - 1j * rate - 2 * (1j * w + zeta) * y[1]
        return [y[1], accelerated - (1 - w * w + 1j * rate + 2j * zeta * w) * y[0]]

    start = begin**2 / (1 - begin**2 + 2j * zeta * begin)
    result = solve_ivp(
        slope, (0, 2 * span / abs(rate)), [start, 0j], rtol=1e-6, atol=1e-8, max_step=3.0
    )
    return begin + rate * result.t, np.abs(result.y[0]), result.t


@pytest.mark.parametrize("way", [pytest.param(1, marks=pytest.mark.slow), -1])
def test_a_ramp_that_passes_a_resonance_too_fast_is_marked(way):
    """Slow is the square of the half width over five."""
    q = 15.0
    for share, is_fast in ((0.05, False), (1.0, True)):
        rate = way * share * (0.5 / q) ** 2
        speed, amplitude, t = swept(q, rate)
        peak = vibration.resonances(speed, amplitude, t=t)[0]
        assert peak.rate == pytest.approx(abs(rate), rel=1e-6)
        assert peak.is_fast == is_fast
        if is_fast:
            assert peak.amplification < 0.85 * q
        else:
            assert peak.amplification == pytest.approx(q, rel=0.05)


def test_a_beat_within_the_turns_of_a_block_has_no_amplification():
    """1x beside a whirl of 0.56x flickers from turn to turn: no resonance, however sharp."""
    t = np.arange(0.0, 1.0, 2e-4)
    phi = 200 * t + 300 * t**2
    z = np.exp(1j * phi) + 8 * np.exp(0.56j * phi)
    track = vibration.order_track(t, phi, z, (1.0,))
    peaks = vibration.resonances(track.speed, track.major(), t=track.t)
    assert peaks
    assert all(math.isnan(peak.amplification) and not peak.is_fast for peak in peaks)


def test_a_journal_that_goes_all_round_has_a_range_and_no_mean_angle():
    t = np.arange(0, 6.0, 5e-4)
    psi = np.mod(200 * t, TURN)
    result = vibration.contact(t, 200 * t, psi, np.full_like(t, 3.0))
    assert np.isnan(result.angle).all()
    assert result.spread == pytest.approx(1.0, abs=0.02)
    assert np.degrees(result.width).min() > 345
    # a touch about 10 degrees, across the right
    fn = np.where(np.cos(psi - 0.17) > math.cos(1.0), 3.0, 0.0)
    result = vibration.contact(t, 200 * t, psi, fn)
    step = 200 * 5e-4
    assert np.mod(result.angle + 1, TURN) == pytest.approx(1.17, abs=step)
    assert result.low == pytest.approx(0.17 - 1 + TURN, abs=step)
    assert result.width == pytest.approx(2.0, abs=2 * step)


def test_orders_that_the_rows_are_too_few_for_are_not_told():
    t = np.arange(0, 5.0, TURN / 200 / 4)  # 4 rows a turn
    track = vibration.order_track(t, 200 * t, 1e-6 * np.exp(200j * t))
    assert np.isnan(track.major(2.0)).all()
    assert track.major(1.0) == pytest.approx(1e-6, rel=0.02)
    result = vibration.full_spectrum(t, 200 * t, 1e-6 * np.exp(200j * t), 200.0)
    assert np.isnan(result.amplitude[np.abs(result.order) >= 2]).all()
    assert result.order[np.nanargmax(result.amplitude)] == 1.0
    few = np.arange(0, 5.0, TURN / 200 / 2)
    with pytest.raises(vibration.TooFewRows, match="has 2 recorded rows a turn; order 1 needs"):
        vibration.order_track(few, 200 * few, np.exp(200j * few), (1.0,))
    for function in (vibration.whirl, vibration.displacement, vibration.poincare):
        with pytest.raises(vibration.TooFewRows, match="has 2 recorded rows a turn"):
            function(few, 200 * few, np.exp(200j * few))
    with pytest.raises(vibration.TooFewRows, match="has 2 recorded rows a turn"):
        vibration.orbit(few, 200 * few, np.exp(200j * few), 200.0)


def test_times_that_fall_are_refused_also_where_they_are_numbers_without_a_sign():
    """Whose differences would not be below 0."""
    for kind in (float, np.uint8):
        with pytest.raises(InputError, match=r"^t = 1\.0 s after 2\.0 s: times must not fall$"):
            recorded(t=np.array([2, 1], kind))


def test_what_is_not_finite_is_left_out():
    t = uneven(5.0)
    z = mixed(300 * t)
    z[-200:] = np.nan
    track = vibration.order_track(t, 300 * t, z)
    assert track.t[-1] < t[-200]
    assert np.abs(track.forward[:, 1]) == pytest.approx(40e-6, rel=1e-3)


@pytest.mark.parametrize("speed", [220.0, -220.0])
def test_phases_of_a_steady_whirl_are_those_of_the_harmonic_problem(speed):
    rotor = parse_rotor(MACHINE)
    result = unbalance_response(rotor, [speed])
    x, y = (part[0, 1] for part in (result.x, result.y))
    t = np.linspace(0, 0.5, 5000)
    whirl = np.exp(1j * speed * t)
    z = (x * whirl).real + 1j * (y * whirl).real
    track = vibration.order_track(t, speed * t, z, (1.0,))
    assert np.angle(track.x()) == pytest.approx(result.phase_x[0, 1], abs=1e-4)
    assert np.angle(track.y()) == pytest.approx(result.phase_y[0, 1], abs=1e-4)
    assert track.minor() == pytest.approx(result.minor[0, 1], rel=1e-4)
