"""Squeeze film dampers: circular orbits, coefficients off the middle, jumps; runs against them."""

import math

import numpy as np
import pytest
from rotor_fmu.model.film.film_outputs import film_state
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.parts.law import Weights
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper
from rotor_fmu.model.quantities import QuantityError

import rotor_fmu as rf

from ..toml_text import table
from .films import DAMPER, on_dampers, run_of
from .machines import shaft


@pytest.mark.parametrize("e", [0.1, 0.5, 0.8])
def test_centred_circular_orbits_of_a_short_damper(e):
    omega = 100.0
    scale = 0.01 * 0.05 * 0.02**3 * omega / 1e-8
    for full in (False, True):
        damper = BearingAlone(SqueezeFilmDamper(**DAMPER, short=True, full=full), 0.0)
        force = damper.force(e * 1e-4, 1j * omega * e * 1e-4) / scale
        radial, tangential = -2 * e**2 / (1 - e**2) ** 2, -math.pi * e / (2 * (1 - e**2) ** 1.5)
        expected = complex(0.0, 2 * tangential) if full else complex(radial, tangential)
        assert force == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("full", [False, True])
@pytest.mark.parametrize("e", [0.1, 0.5, 0.9])
def test_the_largest_pressure_of_a_short_damper_is_ocvirks(e, full):
    """Where the journal moves along its displacement the peak is at the thinnest place; on a
    circular orbit it is beside it."""
    damper = BearingAlone(SqueezeFilmDamper(**DAMPER, short=True, full=full), 0.0)
    v = 100.0 * e * 1e-4
    angles = np.linspace(0.0, 2.0 * math.pi, 20001)
    for velocity, wave in ((v, np.cos(angles)), (1j * v, np.sin(angles))):
        moving = damper._moving(e * 1e-4, velocity)
        state = interpreted(film_state)(damper._bearing, damper._tables, moving, True)
        pressure = 1.5 * 0.01 * 0.02**2 * v * wave / (1e-4 * (1.0 - e * np.cos(angles))) ** 3
        assert state.largest == pytest.approx(pressure.max(), rel=2e-3)


@pytest.mark.parametrize("e", [0.1, 0.5, 0.8])
def test_centred_circular_orbits_of_a_sealed_damper(e):
    """Sommerfeld's closed form of a long film, all around and its positive half."""
    omega = 100.0
    scale = (
        12 * math.pi * 0.01 * 0.05**3 * 0.02 * omega / 1e-8 * e / (2 + e**2) / math.sqrt(1 - e**2)
    )
    for full in (False, True):
        part = SqueezeFilmDamper(**DAMPER, sealed=True, full=full, points=192)
        force = BearingAlone(part, 0.0).force(e * 1e-4, 1j * omega * e * 1e-4) / scale
        if full:
            assert force == pytest.approx(-2j, rel=3e-4)
        else:
            assert force.imag == pytest.approx(-1.0, rel=4e-4)
            assert force.real == pytest.approx(-2 / math.pi * e / math.sqrt(1 - e**2), rel=2e-3)


def test_a_full_film_of_finite_length_is_weaker_than_a_short_one():
    """By less than 2 % of a fifth of the diameter, on a small orbit; it has no pull either."""
    v = 1e-3j
    forces = [
        BearingAlone(SqueezeFilmDamper(**DAMPER, short=short, full=True), 0.0).force(1e-5, v)
        for short in (True, False)
    ]
    assert 0.98 < forces[1].imag / forces[0].imag < 1.0
    assert abs(forces[1].real) < 1e-9 * abs(forces[1])


def test_tangent_of_a_damper():
    sealed = {"sealed": True}
    for options in ({"short": True}, {"short": True, "full": True}, {}, {"full": True}, sealed):
        damper = BearingAlone(SqueezeFilmDamper(**DAMPER, stiffness=1e5, **options), 0.0)
        d, v = 3e-5 - 4e-5j, 1e-3 + 2e-3j
        for weights, h in ((Weights(1.0, 0.0, 0.0), 1e-9), (Weights(0.0, 1.0, 0.0), 1e-7)):
            seen = []
            for z in (1, 1j):
                by_d, by_v = h * weights.displacement * z, h * weights.velocity * z
                change = damper.force(d + by_d, v + by_v) - damper.force(d - by_d, v - by_v)
                seen.append([change.real / (2 * h), change.imag / (2 * h)])
            tangent = damper.tangent(d, v, weights)
            np.testing.assert_allclose(tangent, np.transpose(seen), atol=1e-6 * abs(tangent).max())


@pytest.mark.parametrize("e", [0.0, 0.3, 0.6, 0.9])
def test_coefficients_of_a_short_damper_off_its_middle(e):
    """Ocvirk's film, of which half is ruptured: pi (1 + 2 e^2) / 2 (1 - e^2)^2.5 along the
    displacement, pi / 2 (1 - e^2)^1.5 across it."""
    scale = 0.01 * 0.05 * 0.02**3 / 1e-4**3
    ahead, across = 1.0 + 2.0 * e * e, 1.0 - e * e
    expected = scale * 0.5 * math.pi / across**2.5 * np.diag([ahead, across])
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    for full in (False, True):
        damper = BearingAlone(SqueezeFilmDamper(**DAMPER, short=True, full=full), 0.0)
        _, C = damper.coefficients(e * 1e-4 * complex(*turn[:, 0]))
        halves = 2.0 if full else 1.0
        within = {"rtol": 1e-9, "atol": 1e-9 * expected.max()}
        np.testing.assert_allclose(turn.T @ C @ turn, halves * expected, **within)


def test_coefficients_of_a_ruptured_film_are_what_a_small_vibration_sees():
    """At its frequency: the force goes with the velocity, but not alike ahead and back."""
    phases = np.linspace(0.0, 2.0 * math.pi, 16, endpoint=False)
    for options in ({"short": True}, {"full": True}, {}, {"sealed": True}):
        damper = BearingAlone(SqueezeFilmDamper(**DAMPER, **options), 0.0)
        d = 6e-5 - 3e-5j
        _, C = damper.coefficients(d)
        for z in (d / abs(d), 1j * d / abs(d)):
            force = [damper.force(d, 1e-3 * z * math.cos(phase)) for phase in phases]
            seen = 2.0 * np.mean(np.array(force) * np.cos(phases))
            expected = -1e-3 * complex(*(C @ [z.real, z.imag]))
            assert seen == pytest.approx(expected, abs=1e-9 * abs(seen)), options


def _orbit(run, speed, seconds):
    run.advance(run.time + seconds, speed)
    return run.read("squeeze_film_damper[1].eccentricity")


def test_jump_of_a_rotor_on_dampers():
    # B = 2 mu R L^3 / (m c^3 w_n) = 0.05 with two dampers; e from the closed form of the orbit
    natural = 100.0
    viscosity = 0.05 * 10.0 * 1e-12 * natural / (2 * 0.05 * 0.02**3)
    rotor = on_dampers(viscosity)
    # from below the fold on and slowly up: the large orbit; begun at 2.0: the small one
    up = run_of(rotor, 140.0)
    up.advance(1.0, 140.0)
    up.advance(7.0, 140.0, rate=10.0)
    assert _orbit(up, 200.0, 1.0) == pytest.approx(0.87388, rel=5e-3)
    assert _orbit(run_of(rotor, 200.0), 200.0, 4.0) == pytest.approx(0.41580, rel=5e-3)


def test_a_heavy_unbalance_locks_the_dampers_up():
    """Six tenths of the clearance out of balance there is one orbit at twice the natural frequency,
    the large one, at which the film is a stiff spring: a rotor begun at rest goes there."""
    natural, s, U, B = 100.0, 2.0, 0.6, 0.05
    viscosity = B * 10.0 * 1e-12 * natural / (2 * 0.05 * 0.02**3)
    e = np.linspace(1e-3, 0.999, 100000)
    stiff, drag = 2 * B * s * e / (1 - e**2) ** 2, math.pi * B * s / (2 * (1 - e**2) ** 1.5)
    left = e**2 * ((1 - s**2 + stiff) ** 2 + drag**2) - (U * s**2) ** 2
    orbits = e[:-1][np.diff(np.sign(left)) != 0]
    assert len(orbits) == 1
    assert stiff[np.searchsorted(e, orbits[0])] > 3.0  # than the centring springs
    run = run_of(on_dampers(viscosity, e=1e-4 * U), s * natural)
    assert _orbit(run, s * natural, 2.0) == pytest.approx(orbits[0], rel=5e-3)


def test_bad_damper_is_refused():
    with pytest.raises(QuantityError, match=r"sealed = true: needs squeeze_film_damper\[1\].short"):
        SqueezeFilmDamper(**DAMPER, sealed=True, short=True).check("squeeze_film_damper[1]")


@pytest.mark.parametrize(("is_full", "bound"), [(True, 1e-4), (False, 0.1)])
def test_a_damper_off_the_centre_vibrates_as_the_limitations_say(is_full, bound):
    disc = table("[disc]", node=2, diameter=0.25, width=0.03, e=1e-7)
    more = {"clearance": 1e-4, "viscosity": 0.01, "stiffness": 1.7e6, "full": is_full}
    dampers = [
        table("[squeeze_film_damper]", node=n, journal_radius=0.03, length=0.03, short=True, **more)
        for n in (1, 3)
    ]
    steel = table("material", young=2.1e11, density=7800.0)
    turned = shaft(0.0, 0.3, 0.6, diameter=0.06, material=steel)
    machine = rf.parse(f"{turned}{disc}{''.join(dampers)}")
    linear = machine.unbalance_response([200.0])
    run = rf.simulate(
        machine, speed=200.0, stop=1.0, tolerance=1e-5, record=["disc[1].x_1x", "disc[1].y_1x"]
    )
    found = np.array([run["disc[1].x_1x"][-1], run["disc[1].y_1x"][-1]])
    expected = np.abs([linear.x[0, 1], linear.y[0, 1]])
    off = np.abs(found / expected - 1).max()
    assert off < bound
    assert is_full or off > 0.03
