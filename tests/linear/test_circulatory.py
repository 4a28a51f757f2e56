"""Rotating internal damping: stable up to Omega = omega_n (1 + c_ext / c_int), and not beyond.

Jeffcott's rotor, internal damping c_int = eta_v k of the shaft, external damping c_ext at the disc,
bearings all but rigid, so that the whole elastic energy is the shaft's (Zorzi and Nelson 1977;
Genta, Dynamics of Rotating Systems, 2005).
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import campbell, modes, unbalance_response
from rotor_fmu.model.linear.frequency_response import ControlLoop, sensitivity
from rotor_fmu.model.linear.unbalance_check import critical_peaks
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import HYSTERETIC_AS_SLOWER, Simulation
from rotor_fmu.model.structure.assembly import assemble

import rotor_fmu as rf
from rotor_fmu.linear.machine_warnings import machine_warnings

from ..dense import to_dense
from ..machines import (
    disc_dofs,
    first_order,
    jeffcott,
    jeffcott_shaft_mass,
    jeffcott_stiffness,
    unbalance_vector,
)

ETA_V = 1e-4
C_INT = ETA_V * jeffcott_stiffness()
RATIOS = [0.0, 0.5, 1.0, 2.0]


def natural_frequency():
    """Of the disc with the shaft's share of mass [rad/s]."""
    disc = jeffcott().discs[0].mass(jeffcott().material.density)
    return math.sqrt(jeffcott_stiffness() / (disc + 17 / 35 * jeffcott_shaft_mass()))


def classical_threshold(ratio):
    return natural_frequency() * (1 + ratio)


def whirling(ratio, rotating=True):
    return jeffcott(damping=ratio * C_INT, eta_v=ETA_V, rotating_damping=rotating)


def growth(rotor, omega):
    """Largest real part of all eigenvalues [1/s]."""
    return np.linalg.eigvals(first_order(assemble(rotor), omega)).real.max()


def threshold(rotor, low, high):
    """Speed at which the rotor loses stability [rad/s], by bisection."""
    assert growth(rotor, low) < 0 < growth(rotor, high)
    while high - low > 1e-4 * low:
        middle = (low + high) / 2
        low, high = (middle, high) if growth(rotor, middle) < 0 else (low, middle)
    return low


@pytest.mark.parametrize("ratio", RATIOS)
def test_eigenvalues_cross_at_the_classical_threshold(ratio):
    expected = classical_threshold(ratio)
    result = threshold(whirling(ratio), 0.5 * expected, 2 * expected)
    assert result == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("ratio", RATIOS)
def test_damping_that_stands_still_is_stable_at_any_speed(ratio):
    for omega in np.linspace(0, 10 * natural_frequency(), 20):
        assert growth(whirling(ratio, rotating=False), omega) < 0


def test_whirl_does_not_care_which_way_the_unstable_shaft_turns():
    for omega in (200.0, 400.0):
        assert growth(whirling(0.5), omega) == pytest.approx(growth(whirling(0.5), -omega))


def test_hysteretic_damping_of_a_run_feeds_the_forward_whirl_until_outer_damping_balances_it():
    # as it does above the critical speed; a run does not know how fast a whirl is
    eta_h = 0.01  # feeds it with eta_h k / omega_n (Zorzi and Nelson 1977)
    balance = eta_h * jeffcott_stiffness() / natural_frequency()
    for share in (0.0, 0.95, 1.05, 2.0):
        rotor = jeffcott(damping=share * balance, eta_h=eta_h, rotating_damping=True)
        for omega in (20.0, 200.0, 800.0):
            eigenvalues = np.linalg.eigvals(first_order(assemble(rotor), omega))
            whirl = eigenvalues[np.abs(eigenvalues - 1j * natural_frequency()).argmin()]
            expected = (1 - share) * eta_h * natural_frequency() / 2
            assert whirl.real == pytest.approx(expected, rel=0.03, abs=0.01)


@pytest.mark.parametrize("eta_h", [0.01, 0.3])
def test_hysteresis_drives_the_forward_whirl_above_its_critical_speed_only(eta_h):
    """Genta 2004: it pulls with i eta_h of the stiffness, times the sign in which the shaft is bent
    in its own frame, that of the whirl's frequency less the speed; however large it is."""
    free = modes(jeffcott(), 0.0, count=1).natural[0]
    size = math.hypot(1, eta_h)
    damped = 1j * free * np.sqrt(complex(1 + eta_h, eta_h) / size)
    driven = 1j * free * np.sqrt(complex(1 + eta_h, -eta_h) / size)
    rotor = jeffcott(eta_h=eta_h, rotating_damping=True)
    for share in (0.0, 0.5, 0.99, 1.01, 3.0, -0.99, -1.01):
        result = modes(rotor, share * damped.imag, count=2)
        fast = [damped, damped]
        expected = fast if abs(share) < 1 else [damped, driven]
        of_growth = np.argsort(result.eigenvalues.real)
        np.testing.assert_allclose(result.eigenvalues[of_growth], expected, rtol=2e-4)
        if abs(share) > 1:
            assert [result.whirl[i] for i in of_growth] == ["backward", "forward"]
    speeds = free * np.array([0.2, 0.8, 1.5])
    assert campbell(rotor, speeds, count=2).threshold == pytest.approx(damped.imag, rel=1e-4)


@pytest.mark.parametrize(("zeta", "shares"), [(3.0, (0.0, 5.0, -30.0)), (1.01, (0.0,))])
def test_hysteresis_moves_modes_beside_decays_and_adds_none(zeta, shares):
    """A disc with more than critical damping decays; a loss factor of 0.01 moves each mode that is
    left, whose stiffness is 1 % more, by no more than twice that."""
    damping = 2 * zeta * jeffcott_stiffness() / natural_frequency()
    smooth, lossy = (
        jeffcott(damping=damping, eta_h=eta_h, rotating_damping=True) for eta_h in (0.0, 0.01)
    )
    for share in shares:
        speed = share * natural_frequency()
        expected = modes(smooth, speed, count=6).eigenvalues
        result = modes(lossy, speed, count=6).eigenvalues
        assert (np.abs(result - expected) < 0.02 * np.abs(expected)).all()


@pytest.mark.parametrize("eta_h", [0.0, 0.01])
def test_runs_and_responses_say_what_they_take_hysteresis_for(eta_h):
    """Below its critical speed the rotor is stable: to a run it is not."""
    rotor, said = jeffcott(e=1e-5, eta_h=eta_h, rotating_damping=True), []
    Simulation(rotor, speed=0.5 * natural_frequency(), warn=said.append)
    codes = [message.code for message in said if message.code != "interpreted"]
    assert codes == (["hysteretic-as-slower", "unstable"] if eta_h else [])
    for notes in (machine_warnings(rotor), rf.response(rotor, speed=(20.0, 21.0)).notes):
        assert [*notes] == [str(HYSTERETIC_AS_SLOWER)] * (eta_h > 0)


@pytest.mark.parametrize(("share", "is_stable"), [(0.0, True), (0.5, True), (1.5, False)])
def test_a_control_loop_is_stable_where_hysteresis_damps_all_whirls(share, is_stable):
    """Those faster than the rotation; the loop has no force."""
    rotor = jeffcott(damping=1e-3 * C_INT, eta_h=0.02, rotating_damping=True)
    loop = ControlLoop("idle", 2, 2, kp=0.0, kd=0.0, force_per_current=1.0)
    speed = share * natural_frequency()
    assert sensitivity(rotor, [50.0], [loop], speed=speed).is_stable == is_stable


@pytest.mark.parametrize("eta_h", [0.01, 0.05])
def test_a_critical_speed_is_as_sharp_as_the_response_to_unbalance_is(eta_h):
    """Hysteresis, which damps the whirl below its critical speed and drives it above, does not move
    it there; a backward whirl it damps."""
    rotor = jeffcott(damping=C_INT, e=1e-5, eta_h=eta_h, rotating_damping=True)
    speeds = natural_frequency() * np.linspace(0.6, 1.4, 5)
    backward, forward = campbell(rotor, speeds, count=2).critical
    plain = campbell(replace(rotor, eta_h=0.0), speeds, count=2).critical[1]
    assert (backward.whirl, forward.whirl) == ("backward", "forward")
    assert forward.log_dec == pytest.approx(plain.log_dec, rel=eta_h)
    assert backward.log_dec == pytest.approx(plain.log_dec + math.pi * eta_h, rel=2 * eta_h)
    peak = critical_peaks(rotor, speeds[-1], [2])[0].peak
    assert peak.amplification == pytest.approx(math.pi / forward.log_dec, rel=0.01)


def test_hysteresis_does_not_touch_what_turns_with_the_shaft():
    """An unbalance bends it once and for all: by its stiffness alone, at the critical speed too."""
    rotor = jeffcott(e=1e-5, damping=0.5 * C_INT, eta_h=0.02, rotating_damping=True)
    s = assemble(rotor)
    M, C, K, G = (to_dense(band) for band in (s.M, s.C, s.K, s.G))
    for speed in natural_frequency() * np.array([0.7, 1.0, 1.005, 1.01, 1.4, -1.01]):
        left = K + 1j * speed * C - speed**2 * (M - G)
        expected = np.linalg.solve(left, speed**2 * unbalance_vector(s))
        result = unbalance_response(rotor, [speed])
        np.testing.assert_allclose(np.abs(result.x[0]), np.abs(expected[::2]), rtol=1e-6)


def test_hysteretic_damping_stiffens_the_shaft():
    eta_h = 0.05  # by (1 + eta_h) / sqrt(1 + eta_h^2) (Zorzi and Nelson 1977)
    stiff, plain = (
        np.linalg.eigvals(first_order(assemble(jeffcott(eta_h=eta, rotating_damping=True)), 0.0))
        for eta in (eta_h, 0.0)
    )
    ratio = np.abs(stiff.imag).min() / np.abs(plain.imag).min()
    assert ratio**2 == pytest.approx((1 + eta_h) / math.hypot(1, eta_h), rel=1e-4)


def measured_growth(rotor, omega, seconds):
    """Rate [1/s] at which the disc's whirl grows after a kick, in a run without dissipation of the
    integrator's own; mean radii over whole whirls, which leave out the faster modes."""
    sim = Simulation(rotor, choose("robust", method="newmark", h=5e-4), speed=omega)
    disc = disc_dofs(rotor)[0]
    sim.advance(0.01, omega, np.array([1.0 + 0j]))
    radii = []
    for start in (0.5 * seconds, seconds):
        sim.advance(start, omega, np.zeros(1))
        window = []
        for t in np.linspace(start, start + 8 * math.pi / natural_frequency(), 201)[1:]:
            sim.advance(t, omega)
            window.append(abs(sim.motion.q[disc]))
        radii.append(np.mean(window))
    return math.log(radii[1] / radii[0]) / (0.5 * seconds)


@pytest.mark.parametrize("share", [0.5, 0.96, 1.04, 1.3])
@pytest.mark.parametrize("ratio", [0.5, 1.0])
def test_a_kicked_rotor_calms_down_below_the_threshold_and_whirls_up_above(share, ratio):
    rotor, omega = whirling(ratio), share * classical_threshold(ratio)
    rate = measured_growth(rotor, omega, seconds=4.0)
    assert np.sign(rate) == np.sign(share - 1)
    assert rate == pytest.approx(growth(rotor, omega), rel=0.05)


def test_a_kicked_rotor_calms_down_at_any_speed_if_its_damping_stands_still():
    assert measured_growth(whirling(0.5, rotating=False), 3 * classical_threshold(0.5), 1.0) < -1
