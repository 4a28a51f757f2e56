"""Bearings with floating rings: closed forms, their own differences, CVODE on equations of its own,
ledger and backends."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.floating_ring_bearing import FloatingRingBearing
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.parts.law_probe import LawProbe
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation, StepFailure
from sksundae.cvode import CVODE

from rotor_fmu.machine_file.loading import machine_text

from .driven import of_both
from .rings import RING, SPEED, G, drag, in_series, of_side, rigid_in_rings
from .stated_law import StatedLaw

EXAMPLES = Path(__file__).parents[2] / "examples"


def _ring(**more):
    part = FloatingRingBearing(node=1, **{**RING, **more})
    part.check("floating_ring_bearing")
    return part


def _alone(part, gravity=0j):
    """A bearing's law by itself; gravity to the right and downwards [m/s2]."""
    law = StatedLaw(LawProbe(part, SPEED, "floating_ring_bearing"))
    interpreted(law.law.weigh)(law.record, law.tables, gravity)
    return law


# --- at rest ---


def test_a_concentric_ring_turns_as_the_friction_of_both_films_says():
    film = LawProbe(_ring(), SPEED, "")
    seen = film.outputs(0j)
    (R_i, L_i, c_i, mu_i), (R_o, L_o, c_o, mu_o) = of_side("inner"), of_side("outer")
    ratio = 1.0 / (1.0 + c_i / c_o * L_o / L_i * (R_o / R_i) ** 3 * mu_o / mu_i)
    assert seen["ratio"] == pytest.approx(ratio, rel=1e-12)
    assert seen["ring_speed"] == pytest.approx(ratio * SPEED, rel=1e-12)
    torque = drag("inner") * (1.0 - ratio) * SPEED
    assert seen["torque"] == pytest.approx(torque, rel=1e-12)
    assert seen["power"] == pytest.approx(torque * (1.0 - ratio) * SPEED, rel=1e-12)
    assert seen["outer_power"] == pytest.approx(torque * ratio * SPEED, rel=1e-12)


def test_a_ring_stands_with_the_shaft():
    film, turning, states = _alone(_ring()), np.array([1e-6, 0.0, 0.0, 0.0, 500.0]), np.ones(5)
    still = Kinematics(0.0j, 0.0j, 0.0, 0.0, 0.0)
    interpreted(film.law.vibrate)(film.record, film.tables, still, 0.0, turning, states)
    assert states.tolist() == [1e-6, 0.0, 0.0, 0.0, 0.0]


def _run(text, speed=SPEED, tolerance=1e-4, **options):
    return Simulation(
        parse_rotor(text),
        choose("controlled", tolerance=tolerance),
        speed=speed,
        warn=lambda _: None,
        **options,
    )


def _mass(rotor):
    """The mass that one bearing carries [kg]."""
    return 0.5 * (rotor.structure.mass_sum[::2].sum())


def test_a_run_begins_where_both_films_carry_the_load_in_series():
    run = _run(rigid_in_rings())
    d, x, w = in_series(_mass(run) * G)
    name = "floating_ring_bearing[1]"
    assert complex(run.motion.q[0]) == pytest.approx(d, rel=1e-6)
    ring = complex(run.read(f"{name}.ring_x"), run.read(f"{name}.ring_y"))
    assert ring == pytest.approx(x, rel=1e-6)
    assert run.read(f"{name}.ring_speed") == pytest.approx(w, rel=1e-6)
    assert run.read(f"{name}.eccentricity") == pytest.approx(
        abs(d - x) / RING["clearance"], rel=1e-6
    )
    # without gravity both are in the middle
    still = _run(f"gravity = 0.0\n{rigid_in_rings()}")
    assert abs(still.read(f"{name}.ring_y")) < 1e-9 * RING["clearance"]


def test_a_ring_that_is_nearly_at_rest_comes_to_rest():
    """However near its equilibrium the search begins, it ends there, but for rounding."""
    law = _alone(_ring(points=16), complex(0.0, -G))
    c_i, c_o, d = RING["clearance"], RING["outer_clearance"], -1.0e-5 - 0.6e-5j
    rested, again = law.alone._states.copy(), np.zeros(law.count)
    settle = interpreted(law.law.vibrate)
    moving = law.alone._moving(d, 0j)
    settle(law.record, law.tables, moving, SPEED, rested, rested)
    for share in (1e-4, 1e-7, 1e-10):
        off = share * np.array([c_o, c_i, 0.0, 0.0, SPEED])
        settle(law.record, law.tables, moving, SPEED, rested + off, again)
        left = np.abs(again - rested) / np.array([c_o, c_o, 1.0, 1.0, SPEED])
        assert left.max() < 1e-12


# --- tangents ---


def _states(seed, count):
    random = np.random.default_rng(seed)
    c_i, c_o = RING["clearance"], RING["outer_clearance"]

    def drawn(size):
        return size * math.sqrt(random.random()) * np.exp(2j * math.pi * random.random())

    for _ in range(count):
        x, v = drawn(0.8 * c_o), drawn(0.5 * c_o * SPEED)
        d, past = x + drawn(0.8 * c_i), drawn(0.5 * c_i * SPEED)
        spin = random.uniform(-0.2, 0.8) * SPEED
        yield d, past, np.array([x.real, x.imag, v.real, v.imag, spin]), random


@pytest.mark.parametrize(("short", "count"), [(True, 20), (False, 2)])
def test_a_step_follows_its_equations_and_its_tangent_is_the_derivative(short, count):
    law = _alone(_ring(short=short, points=16), complex(3.0, -G))
    c = RING["clearance"]
    scales = np.array([c, c, c * SPEED, c * SPEED, SPEED])
    for d, v, free, random in _states(1, count):
        b = 10 ** random.uniform(-6.5, -4)
        weights = Weights(0.5 * b * b, b, b)
        force, _, own = law.step(d, v, weights, free)
        followed = free + b * law.rates(d, v, own)
        np.testing.assert_allclose(own / scales, followed / scales, atol=1e-11)
        assert force == pytest.approx(law.force(d, v, own), rel=1e-11)
        assert law.has_tangent(d, v, weights, free, c, 1e-6)


@pytest.mark.parametrize("frequency", [0.2, 1.0, 3.0])
def test_a_vibration_is_that_of_the_equations_linearized_by_differences(frequency):
    law = _alone(_ring())
    film, d, w = law.alone, 4e-6 - 7e-6j, frequency * SPEED
    _, by_d, by_v = film.settle(d, w)
    size = 1e-4 * RING["clearance"]
    scales = [size, size, size * SPEED, size * SPEED, size * SPEED / RING["clearance"]]
    dynamic = law.vibration(d, film._states, w, size, scales)
    most = np.abs(dynamic).max()
    np.testing.assert_allclose(by_d, dynamic.real, atol=1e-5 * most)
    np.testing.assert_allclose(w * by_v, dynamic.imag, atol=1e-5 * most)


# --- in motion ---

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


def _pressed(side, z, velocity, turning):
    """The force of a short film on its journal: what is positive of its pressure summed up [N]."""
    R, L, c, mu = of_side(side)
    moved = (2.0 * velocity - 1j * turning * z) / c
    theta = np.angle(moved) + 0.5 * math.pi * _NODES
    e = np.exp(1j * theta)
    pressed = (moved * e.conj()).real / (1.0 - (z / c * e.conj()).real) ** 3
    return -mu * R * L**3 / (2.0 * c**2) * 0.5 * math.pi * (_WEIGHTS * pressed) @ e


def _slope(y, mass, push):
    """Rates of journal, ring and the ring's speed, over the clearance and the speed."""
    c = RING["clearance"]
    d, v, x, u = (c * complex(y[i], y[i + 1]) for i in (0, 2, 4, 6))
    v, u, w = v * SPEED, u * SPEED, y[8] * SPEED
    inner = _pressed("inner", d - x, v - u, SPEED + w)
    outer = _pressed("outer", x, u, w)
    driven = drag("inner", abs(d - x) / c) * (SPEED - w)
    driven += 0.5 * ((d - x) * inner.conjugate()).imag
    braked = drag("outer", abs(x) / RING["outer_clearance"]) * w
    braked -= 0.5 * (x * outer.conjugate()).imag
    a = (inner + push) / mass - 1j * G
    b = (outer - inner) / RING["ring_mass"] - 1j * G
    spin = (driven - braked) / RING["ring_inertia"] / SPEED
    v, u, a, b = (z / c for z in (v, u, a / SPEED, b / SPEED))
    return [v.real, v.imag, a.real, a.imag, u.real, u.imag, b.real, b.imag, spin]


def _rhs(mass, push):
    def slope(t, y, out):
        out[:] = _slope(y, mass, push)

    return slope


def test_modes_are_those_of_rotor_and_rings_together():
    """Of the whirls in which both journals move alike one grows and one decays slowly."""
    rotor, c = parse_rotor(rigid_in_rings()), RING["clearance"]
    mass = _mass(_run(rigid_in_rings()))
    d, x, w = in_series(mass * G)
    y = np.array([d.real / c, d.imag / c, 0, 0, x.real / c, x.imag / c, 0, 0, w / SPEED])
    steps = 1e-5 * np.eye(len(y))
    by_y = [np.subtract(*(_slope(y + s * e, mass, 0.0) for s in (1, -1))) / 2e-5 for e in steps]
    expected = np.linalg.eigvals(np.transpose(by_y))
    expected = expected[expected.imag > np.abs(expected.real)]
    found = modes(rotor, SPEED).eigenvalues
    assert sorted(expected.real > 0) == [False, True]
    for root in expected:
        assert np.abs(found - root).min() < 1e-4 * abs(root)


def test_a_pushed_rotor_moves_as_cvode_integrates_its_equations():
    """From rest, pushed for a millisecond; the journal, the ring and its speed thereafter."""
    run = _run(rigid_in_rings(), tolerance=1e-3)
    name, c = "floating_ring_bearing[1]", RING["clearance"]
    mass, push = _mass(run), 2.0

    def state():
        journal, ring = (
            complex(run.motion.q[0]) / c,
            complex(run.read(f"{name}.ring_x"), run.read(f"{name}.ring_y")) / c,
        )
        return journal, ring, run.read(f"{name}.ring_speed") / SPEED

    d, x, w = state()
    y = np.array([d.real, d.imag, 0.0, 0.0, x.real, x.imag, 0.0, 0.0, w])
    seen, expected = [], []
    for begin, end, of in ((0.0, 1e-3, push), (1e-3, 0.012, 0.0)):
        times = np.linspace(begin, end, 25)[1:]
        solver = CVODE(_rhs(mass, of), rtol=1e-7, atol=1e-9, max_num_steps=10**6)
        rows = solver.solve(np.concatenate([[begin], times]), y).y[1:]
        y = rows[-1]
        expected += [(complex(*row[:2]), complex(*row[4:6]), row[8]) for row in rows]
        for t in times:
            run.advance(t, SPEED, np.array([2.0 * of + 0j]))
            seen.append(state())
    seen, expected = np.array(seen), np.array(expected)
    moved = np.abs(expected - expected[0]).max(axis=0)
    assert (moved > [0.2, 0.1, 1e-3]).all()
    assert (np.abs(seen - expected).max(axis=0) < 1e-3 * moved).all()


def _lost(run):
    return sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))


@pytest.mark.parametrize("method", [{}, {"method": "radau5"}], ids=["default", "radau5"])
def test_the_ledger_closes_as_rings_whirl(method):
    run = Simulation(
        parse_rotor(f"gravity = 0.0\n{rigid_in_rings(e=5e-7)}"),
        choose("controlled", tolerance=1e-3, **method),
        speed=1000.0,
        warn=lambda _: None,
    )
    run.advance(0.1, 1000.0, rate=1e5)
    assert run.read("floating_ring_bearing[1].eccentricity") > 0.5
    assert abs(run.read("energy.rings")) > 0.0
    assert abs(run.read("energy.residual")) < 1e-4 * _lost(run)


def test_a_free_rotor_is_braked_by_the_inner_films():
    run = _run(rigid_in_rings(), drive_torque=0.0)
    torque = 2 * run.read("floating_ring_bearing[1].torque")
    inertia = 2 * run.read("energy.kinetic") / SPEED**2
    run.advance(1e-4, 0.0)
    assert (SPEED - run.read("w")) / 1e-4 == pytest.approx(torque / inertia, rel=1e-2)


def test_fmu_has_the_bits_of_the_simulation(machine_of):
    text = rigid_in_rings(e=1e-6, points=12, short=False)
    names = [f"floating_ring_bearing[1].{n}" for n in ("fx", "ring_y", "ratio", "power")]
    names.append("energy.rings")
    of_fmu, of_simulation = of_both(machine_of, text, names, SPEED, step=1e-3)
    assert of_fmu == of_simulation


# --- refused ---


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"ring_mass": 0.0}, "ring_mass = 0 kg: must be > 0"),
        ({"ring_inertia": 0.0}, "ring_inertia = 0 kg.m2: must be > 0"),
        ({"ring_inertia": 1e-6}, "ring_inertia = 1e-06 kg.m2: must be at most 1.26e-07 kg.m2"),
        ({"outer_radius": 3.5e-3}, "outer_radius = 0.0035 m: must be above 0.003516 m"),
        ({"outer_length": 0.03}, "outer_length = 0.03 m: must be at most 2 diameters, 0.024 m"),
        ({"roughness": 1e-5}, "roughness = 1e-05 m: must be below half the clearance, 8e-06 m"),
        (
            {"roughness": 1e-5, "clearance": 4e-5, "outer_clearance": 1.5e-5},
            "roughness = 1e-05 m: must be below half the outer clearance, 7.5e-06 m",
        ),
        ({"points": 9.5}, "points = 9.5: must be a whole number"),
    ],
)
def test_rings_that_cannot_be_are_refused(more, message):
    with pytest.raises(QuantityError) as raised:
        _ring(**more)
    assert str(raised.value).startswith(f"floating_ring_bearing.{message}")
    assert "\n" not in str(raised.value)


def test_what_a_ring_cannot_stand_on_is_refused():
    with pytest.raises(QuantityError, match=r"floating_ring_bearing\[1\].*housing"):
        parse_rotor(rigid_in_rings(housing="pedestal"))
    refusal = r"floating_ring_bearing\[1\]: is not compatible with \[base\]: its own mass"
    with pytest.raises(QuantityError, match=refusal):
        parse_rotor(rigid_in_rings() + "[base]\nname = 'ground'\n")


def _overload(run):
    """Load a rotor ever harder."""
    for i in range(1, 100):
        run.advance(1e-3 * i, SPEED, np.array([-50.0j * i]))


def test_films_that_do_not_carry_are_said():
    with pytest.raises(EquilibriumError, match=r"does not carry them at 0 rad/s"):
        _run(rigid_in_rings(), 0.0)
    heavy = f"gravity = 1e8\n{rigid_in_rings()}"
    with pytest.raises(EquilibriumError, match="no static equilibrium under gravity"):
        _run(heavy)


@pytest.mark.slow
def test_a_film_that_is_loaded_ever_harder_ends_the_run():
    with pytest.raises(StepFailure, match=r"oil film at node . is thinner than its roughness"):
        _overload(_run(rigid_in_rings()))


def test_each_film_has_its_own_numbers():
    """Films of finite length are weaker than Ocvirk's, the more the longer they are."""
    film = LawProbe(_ring(short=False), SPEED, "")
    short = LawProbe(_ring(), SPEED, "")
    assert abs(film.force(8e-6 + 0j)) < abs(short.force(8e-6 + 0j))
    thick = LawProbe(replace(_ring(), outer_viscosity=0.1), SPEED, "").outputs(0j)
    assert thick["ratio"] < 0.2 * short.outputs(0j)["ratio"]


@pytest.mark.parametrize("turned", [0.0, 0.5 * math.pi, math.pi, 1.5 * math.pi])
def test_a_machine_rests_below_its_load_whichever_way_that_points(turned):
    text = machine_text("--rotor", EXAMPLES / "turbocharger/rotor.toml")
    sideways = f"gravity = 98.1\ngravity_angle = {turned!r}\n{text}"
    run = Simulation(parse_rotor(sideways), speed=1000.0)
    straight = Simulation(parse_rotor(f"gravity = 98.1\n{text}"), speed=1000.0)
    places = [complex(r.read("body[1].x"), r.read("body[1].y")) for r in (run, straight)]
    back = places[0] * complex(math.cos(turned), -math.sin(turned))
    assert back == pytest.approx(places[1], rel=1e-9)
