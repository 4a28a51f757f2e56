"""Rotors in oil films that move: threshold, limit cycle, touching, dampers; ledger and backends."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import bearing_curves, modes
from rotor_fmu.model.linear.journal_bearing_curves import BearingAlone
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.law import Weights
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation, StepFailure

import rotor_fmu as rf

from ..toml_text import table
from .films import DAMPER, OF_A_FILM, THRESHOLDS, film, heavy_shaft, in_films, on_dampers


def _run(rotor, speed, tolerance=1e-4, **options):
    return Simulation(
        rotor,
        choose("controlled", tolerance=tolerance),
        speed=speed,
        warn=lambda _: None,
        **options,
    )


def _pushed(rotor, speed):
    """A run that a side load of a millisecond has set in motion."""
    run = _run(rotor, speed)
    run.advance(1e-3, speed, np.array([20.0 + 0j]))
    run.advance(0.1, speed, np.array([0j]))
    return run


def _size(run, seconds, speed, rest):
    """The largest distance of the disc from its rest over some time [m]."""
    end, largest = run.time + seconds, 0.0
    while run.time < end:
        run.advance(run.time + 2e-4, speed)
        z = complex(run.read("body[1].x"), run.read("body[1].y"))
        largest = max(largest, abs(z - rest))
    return largest


def test_linear_threshold_is_bracketed_by_integration():
    rotor = in_films()
    threshold = bearing_curves(rotor, np.linspace(400.0, 1200.0, 5)).threshold
    assert modes(rotor, 0.99 * threshold).eigenvalues.real.max() < 0
    assert modes(rotor, 1.01 * threshold).eigenvalues.real.max() > 0
    for factor, grows in ((0.98, False), (1.02, True)):
        speed = factor * threshold
        run = _pushed(rotor, speed)
        start = _run(rotor, speed)
        rest = complex(start.read("body[1].x"), start.read("body[1].y"))
        before = _size(run, 0.05, speed, rest)
        run.advance(run.time + 1.0, speed)
        assert (_size(run, 0.05, speed, rest) > before) == grows


@pytest.mark.slow
@pytest.mark.parametrize(("factor", "grows"), [(0.99, False), (1.01, True)])
@pytest.mark.parametrize(("e", "threshold", "_whirl"), THRESHOLDS[1:])
def test_the_fmu_brackets_the_thresholds_of_a_rigid_rotor_by_one_per_cent(
    machine_of, e, threshold, _whirl, factor, grows
):
    """Begun 1 % of the clearance off its rest, the whirl decays or grows, slowly at the largest
    eccentricity, near which no whirl grows any more. The viscosity is that at which the rotor rests
    at the eccentricity e at its threshold, and without an end where e vanishes."""
    clearance, rotor = OF_A_FILM["clearance"], heavy_shaft(young=2.1e13)
    at_threshold = threshold * math.sqrt(9.81 / clearance)
    thin = JournalBearing(node=1, length=0.03, short=True, **(OF_A_FILM | {"viscosity": 1.0}))
    carried = abs(BearingAlone(thin, at_threshold).force(e * clearance))
    load = 0.5 * 9.81 * (40.0 + 100.0 * math.pi / 4 * 0.1**2 * 0.2)
    oil = {"short": True, "viscosity": load / carried}
    text, speed = rotor + film(1, **oil) + film(3, **oil), factor * at_threshold
    at = bearing_curves(parse_rotor(text), [speed])
    start = table("start", x=at.x[0] + 1e-6, y=at.y[0])
    with machine_of(text + start).start(speed=speed, tolerance=1e-4) as run:
        sizes = []
        for end in (0.3, 1.8):  # of two windows of some whirls each
            run.advance(end)
            places = []
            for _ in range(250):
                run.advance(run.time + 2e-4)
                places.append(complex(*run.read("body[1].x", "body[1].y")))
            sizes.append(np.abs(places - np.mean(places)).max())
    assert (sizes[1] > 1.02 * sizes[0]) if grows else (sizes[1] < sizes[0] / 1.02)
    assert sizes[1] < 0.5e-4


def test_ledger_closes_through_a_threshold():
    rotor = in_films(e=2e-6)
    run = _run(rotor, 400.0, 1e-3)
    run.advance(2.0, 400.0, rate=500.0)
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert run.read("energy.film_loss") > 0
    assert abs(run.read("energy.residual")) < 1e-4 * lost
    # past the threshold the journals whirl in most of their clearance
    assert (
        max(_size(run, 0.05, 1400.0, complex(run.read("body[1].x"), run.read("body[1].y"))), 0)
        > 5e-5
    )


def test_a_start_at_standstill_lies_on_its_wall_and_lifts_off():
    rotor = in_films(k=1e8)
    run = _run(rotor, 0.0, 1e-2)
    assert run.read("journal_bearing[1].contact") == 1.0
    assert run.read("journal_bearing[1].film") < 1e-6
    run.advance(0.5, 0.0, rate=600.0)
    assert run.read("journal_bearing[1].contact") == 0.0
    assert run.read("energy.friction_loss") > 0
    lost = run.read("energy.film_loss") + run.read("energy.friction_loss")
    assert abs(run.read("energy.residual")) < 1e-4 * lost


def test_ledger_closes_through_a_threshold_and_a_rub():
    """So far out of balance that past the threshold the journals press through their films."""
    run = _run(in_films(e=1e-3, k=1e8, roughness=1e-5), 400.0, 1e-3)
    touched = 0.0
    for i in range(20):
        run.advance(0.03 * (i + 1), 400.0 + 45.0 * i, rate=1500.0)
        touched = max(touched, run.read("journal_bearing[1].contact"))
    assert touched == 1.0
    assert run.read("energy.friction_loss") > 0
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert abs(run.read("energy.residual")) < 1e-4 * lost


def test_a_film_that_does_not_carry_is_said():
    with pytest.raises(
        EquilibriumError, match=r"oil film at node . does not carry them at 0 rad/s"
    ):
        _run(in_films(), 0.0)
    run = _run(in_films(), 600.0)
    with pytest.raises(StepFailure, match=r"oil film at node . is thinner than its roughness"):
        run.advance(1.0, 600.0, np.array([-1e8j]))


@pytest.mark.parametrize("what", ["plain", "damper", "tilting pads"])
def test_a_start_through_a_film_is_refused(what):
    part = {
        "plain": film(1),
        "damper": table("[squeeze_film_damper]", **{**DAMPER, "node": 1}),
        "tilting pads": film(1, pads=[0.8, 2.4, 4.0, 5.5], arc=1.3, tilting=True),
    }[what]

    def begin(x):
        text = f"gravity = 0.0\n{heavy_shaft()}{part}{table('start', x=x)}"
        return _run(parse_rotor(text), 600.0)

    with pytest.raises(EquilibriumError) as raised:
        begin(1.2e-4)
    assert str(raised.value).startswith(
        "[start]: node 1 lies 0.00012 m from the middle of its oil film, of a clearance of 0.0001 m"
    )
    assert "\n" not in str(raised.value)
    assert begin(0.5e-4).read(f"{part.split(']')[0].strip('[')}[1].film") > 1e-6


def _pressed(run):
    """Load a rotor ever harder, until no film of the thickness of its roughness carries it."""
    for i in range(1, 41):
        run.advance(2.5e-3 * i, 600.0, np.array([-2e5j * i]))


@pytest.mark.parametrize("settings", [{}, {"method": "radau5"}], ids=["default", "radau5"])
def test_a_run_ends_where_a_film_without_contact_breaks(settings):
    settings = choose("controlled", tolerance=1e-3, **settings)
    run = Simulation(in_films(), settings, speed=600.0, warn=lambda _: None)
    with pytest.raises(StepFailure, match=r"oil film at node . is thinner than its roughness"):
        _pressed(run)
    # the last good state
    assert 1e-6 <= run.read("journal_bearing[1].film") < 2e-6


def test_a_free_rotor_is_braked_by_its_films():
    rotor = in_films()
    run = _run(rotor, 600.0, drive_torque=0.0)
    torque = 2 * run.read("journal_bearing[1].torque")
    inertia = 2 * run.read("energy.kinetic") / 600.0**2
    run.advance(1e-3, 0.0)
    seen = (600.0 - run.read("w")) / 1e-3
    assert seen == pytest.approx(torque / inertia, rel=5e-3)


# --- squeeze film dampers ---


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
    up = _run(rotor, 140.0)
    up.advance(1.0, 140.0)
    up.advance(7.0, 140.0, rate=10.0)
    assert _orbit(up, 200.0, 1.0) == pytest.approx(0.87388, rel=5e-3)
    assert _orbit(_run(rotor, 200.0), 200.0, 4.0) == pytest.approx(0.41580, rel=5e-3)


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
    run = _run(on_dampers(viscosity, e=1e-4 * U), s * natural)
    assert _orbit(run, s * natural, 2.0) == pytest.approx(orbits[0], rel=5e-3)


def test_bad_damper_is_refused():
    with pytest.raises(QuantityError, match=r"sealed = true: needs squeeze_film_damper\[1\].short"):
        SqueezeFilmDamper(**DAMPER, sealed=True, short=True).check("squeeze_film_damper[1]")


@pytest.mark.parametrize(("is_full", "bound"), [(True, 1e-4), (False, 0.1)])
def test_a_damper_off_the_centre_vibrates_as_the_limitations_say(is_full, bound):
    machine = rf.parse(
        """
        [material]
        young = 2.1e11
        density = 7800.0
        [shaft]
        nodes = [0.0, 0.3, 0.6]
        diameters = [0.06, 0.06]
        [[disc]]
        node = 2
        diameter = 0.25
        width = 0.03
        e = 1e-7
        """
        + "".join(
            f"""
        [[squeeze_film_damper]]
        node = {node}
        journal_radius = 0.03
        length = 0.03
        clearance = 1e-4
        viscosity = 0.01
        stiffness = 1.7e6
        short = true
        full = {str(is_full).lower()}
        """
            for node in (1, 3)
        )
    )
    linear = machine.unbalance_response([200.0])
    run = rf.simulate(
        machine, speed=200.0, stop=1.0, tolerance=1e-5, record=["disc[1].x_1x", "disc[1].y_1x"]
    )
    found = np.array([run["disc[1].x_1x"][-1], run["disc[1].y_1x"][-1]])
    expected = np.abs([linear.x[0, 1], linear.y[0, 1]])
    off = np.abs(found / expected - 1).max()
    assert off < bound
    assert is_full or off > 0.03


# --- FMUs ---


def test_fmu_has_the_bits_of_the_simulation(machine_of):
    """The FMU in Python and the native one, with a film in lobes and a damper."""
    lobes = {"pads": [1.570796, 4.712389], "arc": 2.8, "preload": 0.4}
    damper = table("[squeeze_film_damper]", **{**DAMPER, "node": 3}, stiffness=1e7)
    text = heavy_shaft(1e-5) + film(1, **lobes, k=1e8) + damper
    names = ("journal_bearing[1].fx", "journal_bearing[1].film", "squeeze_film_damper[1].fy")
    simulation = Simulation(
        parse_rotor(text), choose("controlled", tolerance=1e-3), speed=500.0, warn=lambda _: None
    )
    with machine_of(text).start(speed=500.0, tolerance=1e-3) as run:
        for i in range(1, 6):
            run.advance(0.01 * i)
            simulation.advance(0.01 * i, 500.0)
            assert run.read(*names) == [simulation.read(name) for name in names]
