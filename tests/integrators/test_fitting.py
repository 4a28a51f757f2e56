"""Fitting to the pace of the motion: a steady whirl keeps its size and phase at coarse steps, and a
rotor that turns falls as any other body."""

import math
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.step import fitting
from rotor_fmu.model.structure.structure import WEIGHT
from rotor_fmu.model.time_loop import error_control

from papers.integrators.members import chung_hulbert, generalized_alpha, hht, newmark

from ..machines import disc_dofs, overhung, unbalance_vector

COMPRESSOR = Path(__file__).parents[2] / "examples" / "drop" / "compressor.toml"
fitted, unfitted = interpreted(fitting.fitted), interpreted(fitting.unfitted)

SCHEMES = [
    chung_hulbert(0.3),
    chung_hulbert(0.0),
    hht(0.3),
    newmark(),
    generalized_alpha(0.1, 0.08),
]


def whirl_error(omega, fit, per_revolution=24):
    """Relative error of the steady whirl's complex amplitude after its start has died away."""
    machine = overhung(gravity=0.0, eta_v=2e-3)
    h = 2 * math.pi / omega / per_revolution
    sim = Simulation(machine, choose("robust", rho=0.3, h=h, fitted=fit), speed=omega)
    turns = 120
    for i in range(turns):
        sim.advance((i + 1) * per_revolution * h, omega)
    s = sim.structure
    M, C, K, G = (to_dense(band) for band in (s.M, s.C, s.K, s.G))
    dynamic = K + 1j * omega * (C - 1j * omega * G) - omega**2 * M
    amplitude = np.linalg.solve(dynamic, omega**2 * unbalance_vector(s))
    seen = sim.motion.q[: len(M)] * np.exp(-1j * sim.read("phi"))
    discs = disc_dofs(machine)
    return np.abs(seen - amplitude)[discs].max() / np.abs(amplitude)[discs].max()


@pytest.mark.parametrize("omega", [60.0, 110.0])
def test_a_steady_whirl_comes_out_several_times_closer(omega):
    assert whirl_error(omega, False) > 0.004
    assert whirl_error(omega, True) < 0.25 * whirl_error(omega, False)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_the_factors_approach_one_with_the_square_of_the_step(scheme):
    coarse, fine = (np.array(fitted(scheme, w)) - 1 for w in (0.02, 0.01))
    for a, b in zip(coarse, fine, strict=True):
        assert abs(a) < 1e-9 or a / b == pytest.approx(4, rel=0.01)
    assert fitted(scheme, 1e-5) == unfitted()
    assert fitted(scheme, -0.3) == pytest.approx(fitted(scheme, 0.3))


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_free_oscillation_keeps_its_period(scheme):
    """The undamped oscillator, stepped by hand: the phase of its least damped root."""
    am, af, beta, gamma = scheme
    for w in (0.1, 0.4):
        phases = []
        for s in (1.0, fitted(scheme, w).mass):
            left = np.array([[1, 0, -beta], [0, 1, -gamma], [w * w * (1 - af), 0, s * (1 - am)]])
            right = np.array([[1, 1, 0.5 - beta], [0, 1, 1 - gamma], [-w * w * af, 0, -s * am]])
            roots = np.linalg.eigvals(np.linalg.solve(left, right))
            phases.append(abs(np.angle(roots[np.argmax(np.abs(roots) * (roots.imag > 0))])))
        assert abs(phases[1] - w) < 0.1 * abs(phases[0] - w)


def test_a_rotor_that_turns_falls_as_any_other_body():
    """Fitted to its rotation alone its mass, and so its fall, would be wrong by percents."""
    rotor = parse_rotor(COMPRESSOR.read_text(encoding="utf-8"))
    fallen = []
    for fit in (True, False):
        sim = Simulation(rotor, choose("robust", fitted=fit), speed=400.0)
        for i in range(12):
            sim.advance(5e-4 * (i + 1), 400.0)
        fallen.append(sum(sim.read(f"touchdown_bearing[{k}].y") for k in (1, 2)) / 2)
    assert fallen[0] == pytest.approx(fallen[1], rel=1e-4)
    assert fallen[0] == pytest.approx(-9.81 * sim.time**2 / 2, rel=0.01)


@pytest.mark.parametrize(
    ("motion", "expected"),
    [
        (lambda t: np.exp(157j * t), 157.0),
        (lambda t: np.cos(157 * t), 157.0),
        (lambda t: np.exp(-400j * t), 400.0),
        (lambda t: np.exp(2800j * t), 400.0),
    ],
    ids=["a slow whirl", "a slow swing", "a whirl backward", "a shake, at most the rotation"],
)
def test_the_pace_of_a_motion_is_its_angular_frequency(motion, expected):
    assert characteristic_frequency_of(motion, turning(slowest=10.0), 400.0) == pytest.approx(
        expected, rel=0.01
    )


@pytest.mark.parametrize("omega", [0.0, 40.0])
def test_a_rotor_that_swings_freely_below_its_lowest_frequency_has_the_pace_of_that(omega):
    result = characteristic_frequency_of(lambda t: np.cos(290 * t), turning(slowest=290.0), omega)
    assert result == pytest.approx(290.0, rel=0.01)


def turning(slowest):
    """What a pace asks of a machine: one mass, and the pace of its slowest motion [rad/s]."""
    return SimpleNamespace(
        weights=np.rec.array([(0, 0, 1.0)], dtype=WEIGHT),
        numbers=np.rec.array([(slowest,)], dtype=[("slowest", float)]),
    )


def pace_after(machine, omega, h, old, new, before):
    measures = interpreted(error_control.measure)(machine.weights, 1.0 + 0j, old, new)
    return interpreted(fitting.characteristic_frequency_after)(machine, omega, h, measures, before)


def characteristic_frequency_of(motion, machine, omega):
    def at(t, d=1e-5):
        v = (motion(t + d) - motion(t - d)) / (2 * d)
        a = (motion(t + d) - 2 * motion(t) + motion(t - d)) / d**2
        return SimpleNamespace(v=np.array([complex(v)]), a=np.array([complex(a)]))

    h, square = 2e-4, 0.0
    for i in range(1000):
        square = pace_after(machine, omega, h, at(i * h), at((i + 1) * h), square)
    return math.sqrt(square)


def test_a_pace_is_learnt_over_a_revolution_and_lost_within_a_radian():
    machine, rest = turning(slowest=10.0), SimpleNamespace(v=np.zeros(1, complex), a=np.zeros(1))
    fall = [SimpleNamespace(v=np.array([-9.81j * t]), a=np.array([-9.81j])) for t in (0.1, 0.101)]
    shake = [SimpleNamespace(v=np.zeros(1), a=np.array([a + 0j])) for a in (9e2, 1.1e3)]
    assert pace_after(machine, 100.0, 1e-3, *shake, 400.0) == pytest.approx(
        400.0 + 0.1 / (2 * math.pi) * (100.0**2 - 400.0)
    )
    retained = 400.0 + 0.1 * (400.0 * 9.81**2 / (9.81**2 + 400.0 * (0.1005 * 9.81) ** 2) - 400.0)
    assert pace_after(machine, 100.0, 1e-3, *fall, 400.0) == pytest.approx(retained)
    assert pace_after(machine, 100.0, 1e-3, rest, rest, 400.0) == 400.0


def test_the_pace_of_a_fall_is_none_and_of_rest_what_it_was():
    machine = turning(slowest=10.0)
    fall = [SimpleNamespace(v=np.array([-9.81j * t]), a=np.array([-9.81j])) for t in (0.1, 0.101)]
    assert pace_after(machine, 400.0, 1e-3, *fall, 0.0) == 0.0
    rest = SimpleNamespace(v=np.zeros(1, complex), a=np.zeros(1, complex))
    assert pace_after(machine, 400.0, 1e-3, rest, rest, 900.0) == 900.0
    assert pace_after(machine, 20.0, 1e-3, rest, rest, 900.0) == 400.0
