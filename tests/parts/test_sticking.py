"""A journal that sticks, against Coulomb's closed forms: it holds, slides, swings and stops."""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.parts.base import InterfaceElement
from rotor_fmu.model.parts.clearance_contact import (
    CLEARANCE_CONTACT,
    STICKING_CONTACT,
    ClearanceContact,
)
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.parts.touchdown_bearing import TOUCHDOWN_BEARING, TouchdownBearing
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import machine_elements

from ..growing_whirls import found_last
from .machines import bearings, rigid
from .test_contact_laws import (
    KINDS,
    RACE,
    TABLES,
    force_and_tangent,
    interpreted_law,
    record,
    states,
)

pytestmark = pytest.mark.filterwarnings("ignore::rotor_fmu.model.simulation.RotorWarning")
WEIGHT, RADIUS, K, K_T, MU = 9.81, 5e-3, 1e7, 1e6, 0.3
SPRINGS = 50.0  # that keep the shaft from tilting [N/m]
PRESSED = WEIGHT - SPRINGS * RADIUS  # onto the wall [N]


def lying(kind="contact", mu=MU, k_t=K_T, c_t=100.0, more="", rest="", springs=None, radius=RADIUS):
    """One kilogram that lies in a stator, a port beside it for a load."""
    return parse_rotor(
        rigid(
            gravity=WEIGHT,
            parts=(springs or bearings(SPRINGS, 0.0))
            + f"""
[[{kind}]]
node = 2
journal_radius = 0.02
clearance = {radius}
mu = {mu}
k = {K}
c = 2000.0
k_t = {k_t}
c_t = {c_t}
{more}
[[port]]
node = 2
name = "side"
""",
            rest=rest,
        )
    )


class Loaded:
    """A run under side loads that change by the millisecond."""

    def __init__(self, machine, preset="robust", speed=0.0, **settings):
        self.simulation = Simulation(machine, choose(preset, **settings), speed=speed)
        self.speed = speed

    def pushed(self, loads, step=1e-3):
        """Where the journal is after each [m]."""
        seen = []
        for load in loads:
            t = self.simulation.time + step
            self.simulation.advance(t, self.speed, np.array([complex(load)]))
            seen.append(self.read("side.x"))
        return np.array(seen)

    def read(self, name):
        return self.simulation.read(name)


def pendulum(t, mass=1.0):
    """Velocity over force of what begins to move along the wall [m/s/N]."""
    omega = math.sqrt((PRESSED / RADIUS + SPRINGS) / mass)
    return math.sin(omega * t) / (mass * omega)


@pytest.mark.parametrize("preset", ["robust", "controlled", "moderate"])
def test_below_the_friction_a_journal_yields_to_a_side_load_as_a_spring_and_stays(preset):
    load = 0.8 * MU * PRESSED
    settings = {"tolerance": 1e-5} if preset == "controlled" else {"h": 2e-5}
    run = Loaded(lying(), preset, **settings)
    run.pushed(np.linspace(0.0, load, 200))
    held = run.pushed([load] * 300)
    stiffness = K_T + PRESSED / RADIUS + SPRINGS
    assert held[-1] == pytest.approx(load / stiffness, rel=2e-3)
    assert np.ptp(held[100:]) < 1e-4 * held[-1]
    assert run.read("contact[1].ft") == pytest.approx(load, rel=0.01)


def test_without_a_tangential_stiffness_it_creeps_at_a_share_of_v_s():
    load = 0.8 * MU * PRESSED
    crept = Loaded(lying(k_t=0.0)).pushed([load] * 100)
    # mu v / sqrt(v^2 + v_s^2) = 0.8 mu
    assert crept[20] - crept[10] == pytest.approx(1e-3 * 0.8 / 0.6 * 10e-3, rel=0.05)


def test_above_the_friction_a_journal_slides_as_a_block_on_a_slope_does():
    """m a = F - mu N; a slope of the angle alpha has F = N tan alpha. Climbing the wall it is a
    pendulum."""
    run = Loaded(lying(), h=2e-5)
    limit = MU * PRESSED
    run.pushed(np.linspace(0.0, 0.99 * limit, 200))
    still = run.read("side.vx")
    run.pushed([2.0 * limit] * 4)
    assert abs(still) < 1e-4
    assert run.read("side.vx") - still == pytest.approx(limit * pendulum(4e-3), rel=4e-3)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_the_angle_of_friction_parts_rest_from_sliding(share):
    """Gravity turned by alpha: the wall below is a slope of that angle."""
    machine = lying()
    run = Loaded(machine)
    alpha = math.atan(MU) * share
    # turn the load, weight and side together, its size constant
    turned = [WEIGHT * (cmath.exp(1j * a) * -1j + 1j) for a in np.linspace(0, alpha, 300)]
    moved = run.pushed(turned)
    moved = run.pushed(turned[-1:] * 300)
    slid = moved[-1] - WEIGHT * math.sin(alpha) / K_T
    assert (abs(slid) < 0.02 * RADIUS * alpha) == (share < 1)


def test_a_journal_on_a_spring_swings_out_as_coulomb_says_and_stays_within_its_dead_band():
    """Every half swing takes 2 mu N / k; it ends where k x < mu N."""
    k, mu, radius, start = 1e4, 0.03, 9e-3, 3e-4
    spring = "".join(
        f"[[linear_bearing]]\nnode = {node}\nkxx = {share * k}\nkyy = {share * SPRINGS}\n"
        "cxx = 0.0\ncyy = 0.0\n"
        for node, share in ((1, 0.01), (2, 0.98), (3, 0.01))
    )
    pressed = WEIGHT - SPRINGS * radius
    below = math.sqrt((radius + pressed / K) ** 2 - start**2)
    machine = lying(
        mu=mu,
        k_t=1e7,
        springs=spring,
        rest=f"[start]\nx = {start}\ny = {-below}\n",
        radius=radius,
    )
    run = Loaded(machine, h=2e-5)
    seen = run.pushed([0.0] * 800, 5e-4)
    taken = mu * pressed / (k + pressed / radius)
    turns = [seen[0], *seen[1:-1][(np.diff(seen)[1:] * np.diff(seen)[:-1]) < 0]]
    expected = start
    while abs(expected) > taken:
        expected = math.copysign(2 * taken, expected) - expected
        result = min(turns, key=lambda x: abs(x - expected))
        assert result == pytest.approx(expected, abs=0.01 * start)
    np.testing.assert_allclose(seen[-100:], expected, atol=0.01 * start)
    assert np.ptp(seen[-100:]) < 1e-4 * start


def test_a_journal_that_sticks_to_a_free_race_takes_its_inertia_along():
    """m a = F - f, J w' = R f, a = R w': no slip, where friction smoothed by v_s needs one."""
    inertia, race = 2e-4, 0.02 + RADIUS
    more = f"race_inertia = {inertia}\n"
    load, step = 0.3, 1e-3
    slid = []
    for k_t in (1e7, 0.0):
        run = Loaded(lying("touchdown_bearing", k_t=k_t, c_t=3e3, more=more), h=1e-5)
        run.pushed([load] * 5, step)
        before = run.read("side.vx")
        run.pushed([load] * 5, step)
        slid.append(abs(run.read("touchdown_bearing[1].sliding")))
        taken = 1.0 + inertia / race**2
        gained = pendulum(10 * step, taken) - pendulum(5 * step, taken)
        assert run.read("side.vx") - before == pytest.approx(load * gained, rel=0.01)
    assert slid[0] < 0.02 * slid[1]


def test_while_it_slides_it_brakes_as_the_friction_that_is_smoothed():
    """In the sense of the rotation and against it."""
    for speed in (50.0, -50.0):
        torque = []
        for k_t in (0.0, K_T):
            run = Loaded(lying(k_t=k_t), speed=speed, h=1e-4)
            run.pushed([0.0] * 500)
            torque.append(run.read("tau"))
        assert torque[1] == pytest.approx(torque[0], rel=1e-3)
        assert torque[1] * speed > 0


def test_the_ledger_closes_over_sticking_and_sliding():
    residuals = []
    for h in (4e-5, 2e-5):
        run = Loaded(lying(), h=h)
        run.pushed(3.0 * np.sin(np.linspace(0, 20, 200)) + 2.0)
        lost = run.read("energy.friction_loss")
        assert lost > 0
        residuals.append(abs(run.read("energy.residual")))
    assert max(residuals) < 2e-4 * lost


ALONE = ("hertz", "stribeck", "worn")  # each of which the last one has too


@pytest.mark.parametrize(
    "name", ["linear", *(pytest.param(name, marks=pytest.mark.slow) for name in ALONE), "all"]
)
@pytest.mark.parametrize("kind", [ClearanceContact, TouchdownBearing])
def test_the_tangent_is_the_derivative_of_the_force_and_the_springs_equation_holds(name, kind):
    more = RACE | {"race_inertia": 1.0} if kind is TouchdownBearing else {}
    part = record(kind, **KINDS[name], **more, k_t=3e7, c_t=200.0)
    law = interpreted_law(STICKING_CONTACT if kind is ClearanceContact else TOUCHDOWN_BEARING)
    count, by_d, by_v, b, spin = len(law.states), 0.7, 40.0, 2e-4, 0.5
    stuck = 0
    rng = np.random.default_rng(5)
    for d, v in states(rng, 40):
        v *= rng.choice([0.1, 30.0])
        free = np.zeros(count)
        free[-1] = rng.normal() * 1e-6

        def force(d, v, free=free):
            motion, weights = Kinematics(d, v, spin, spin, 0.0), Weights(by_d, by_v, b)
            (result, p, q), internal_state, rate = force_and_tangent(
                law, part, motion, weights, free
            )
            assert internal_state[-1] == pytest.approx(free[-1] + b * rate[-1], abs=1e-12)
            again = law.force(part, TABLES, motion, internal_state)
            assert result == pytest.approx(again, rel=1e-9, abs=1e-9 * abs(result))
            return result, p, q, internal_state

        _, p, q, internal_state = force(d, v)
        out = np.zeros(len(law.outputs))
        law.observe(part, TABLES, Kinematics(d, v, spin, spin, 0.0), internal_state, out)
        normal, rubbing = out[1], out[2]
        assert abs(rubbing) <= (part.mu + part.mu_rise) * normal * (1 + 1e-12)
        stuck += abs(rubbing) < 0.999 * part.mu * normal
        for z in (1e-10 + 0j, 1e-10j):
            ahead, behind = (force(d + s * by_d * z, v + s * by_v * z)[0] for s in (1, -1))
            expected = (ahead - behind) / 2
            scale = abs(p) * abs(z)
            assert p * z + q * z.conjugate() == pytest.approx(expected, abs=1e-3 * scale)
    assert 0 < stuck < 40


def test_friction_never_gives_energy():
    part = record(ClearanceContact, k_t=3e7)
    law = interpreted_law(STICKING_CONTACT)
    rng = np.random.default_rng(6)
    out = np.zeros(2)
    for d, v in states(rng, 100):
        internal_state = np.array([rng.normal() * 2e-4])
        law.dissipate(part, TABLES, Kinematics(d, v, 3.0, 3.0, 0.0), internal_state, out)
        assert out[1] >= 0


def test_the_elongation_is_gone_once_the_journal_is_in_the_air():
    part = record(ClearanceContact, k_t=1e7, c_t=100.0)
    law, free, internal_state, b = (
        interpreted_law(STICKING_CONTACT),
        np.array([1e-6]),
        np.zeros(1),
        1e-4,
    )
    law.tangent(
        part,
        TABLES,
        Kinematics(1e-5j, 0j, 0.0, 0.0, 0.0),
        Weights(1.0, 1.0, b),
        free,
        internal_state,
    )
    assert internal_state[0] == pytest.approx(1e-6 / (1 + b * 1e7 / 100.0))


def test_it_is_off_unless_asked_for():
    laws = [e.law for e in machine_elements(rig()) if isinstance(e, InterfaceElement)]
    assert laws == [CLEARANCE_CONTACT] * 2
    (law,) = (
        e.law
        for e in machine_elements(lying())
        if isinstance(e, InterfaceElement) and e.law.has_wall
    )
    assert law is STICKING_CONTACT


def test_dry_whip_is_looked_for_as_without():
    """A wall at which a journal may stick slips where it whirls."""
    result = [found_last(Simulation(lying(k_t=k_t), speed=50.0)) for k_t in (0.0, K_T)]
    assert result[0]
    assert len(result[0]) == len(result[1])
    for smooth, sticking in zip(*result, strict=True):
        assert sticking.root == pytest.approx(smooth.root, rel=1e-9)
        assert sticking.closed == smooth.closed
