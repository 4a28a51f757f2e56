"""A residual bow: at slow roll the shaft turns with its shape, above the critical speed it is
straightened, and an unbalance opposite to it takes it away at one speed (Nicholas, Gunter and
Allaire 1976)."""

import cmath
import math

import numpy as np
import pytest
from rotor_fmu.model.linear import static, unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf

from ..machines import losses
from ..toml_text import table
from .machines import shaft

M, C, AMPLITUDE, PHASE = 10.0, 200.0, 1e-4, 0.7
B = AMPLITUDE * cmath.exp(1j * PHASE)
BOW = table("[bow]", node=3, amplitude=AMPLITUDE, phase=PHASE)


def jeffcott(more, gravity=0.0, density=1.0):
    """A mass amid a light shaft of 1 m on stiff bearings, with a damper to ground."""

    def bearing(node, k, c):
        return table("[linear_bearing]", node=node, kxx=k, kyy=k, cxx=c, cyy=c)

    ends = bearing(1, 1e11, 1.0) + bearing(5, 1e11, 1.0) + bearing(3, 1e-6, C)
    material = f"[material]\nyoung = 2.1e11\ndensity = {density}\n"
    text = shaft(0.0, 0.25, 0.5, 0.75, 1.0, diameter=0.03, material=material)
    mass = table("[point_mass]", node=3, mass=M) + table("[sensor]", node=3)
    return f"gravity = {gravity}\n" + text + mass + ends + more


def stiffness():
    """Of the shaft under its mass [N/m]."""
    return 1.0 / static(parse_rotor(jeffcott("")), loads=[(3, 1.0, 0.0)]).x[2]


def whirl(speeds, amount=0.0):
    """The closed form of the bow's whirl, and of an unbalance's opposite to it, x + i y [m]."""
    k, w = stiffness(), np.asarray(speeds)
    return (k * B - amount * cmath.exp(1j * PHASE) * w**2) / (k - M * w**2 + 1j * C * w)


@pytest.mark.parametrize("amount", [0.0, 1.5e-3])
def test_its_whirl_follows_the_closed_form(amount):
    against = table("[unbalance]", node=3, amount=amount, phase=PHASE + math.pi)
    rotor = parse_rotor(jeffcott(BOW + against))
    critical = math.sqrt(stiffness() / M)
    speeds = critical * np.array([0.0, 0.3, 0.7, 1.0, 1.6, 4.0, -0.7])
    found = unbalance_response(rotor, speeds)
    expected = whirl(speeds, amount)
    tolerance = 1e-3 * np.abs(expected).max()
    np.testing.assert_allclose(found.x[:, 2], expected, atol=tolerance)
    np.testing.assert_allclose(found.y[:, 2], -1j * expected, atol=tolerance)


def test_an_unbalance_opposite_to_it_takes_it_away_at_one_speed():
    k = stiffness()
    amount = 1.5e-3
    at = math.sqrt(k * AMPLITUDE / amount)
    against = table("[unbalance]", node=3, amount=amount, phase=PHASE + math.pi)
    found = unbalance_response(parse_rotor(jeffcott(BOW + against)), [0.5 * at, at])
    assert abs(found.x[1, 2]) < 1e-3 * abs(found.x[0, 2])


def test_at_slow_roll_the_shaft_turns_with_its_shape():
    """On bearings at 0.25 and 0.75 m of 1 m, bent by one curvature over 0.1 m about its middle, and
    straight elsewhere. There it lies on two lines that meet at a height h above the line through
    its ends, at an angle of 4 h; the arc between them is lower by an eighth of 0.1 times that."""
    z = [0.0, 0.25, 0.45, 0.5, 0.55, 0.75, 1.0]
    ends = "".join(table("[support]", node=n, stiffness=1e9, damping=100.0) for n in (2, 6))
    bow = table("[bow]", node=4, amplitude=AMPLITUDE)
    rotor = parse_rotor("gravity = 0.0\n" + shaft(*z, diameter=0.02) + ends + bow)
    found = unbalance_response(rotor, [1e-3]).x[0].real
    lines = 2.0 * AMPLITUDE / 0.95 * np.minimum(z, 1.0 - np.array(z))
    lines[3] = AMPLITUDE
    np.testing.assert_allclose(found, lines - lines[1], atol=1e-3 * AMPLITUDE)


def test_a_run_begins_with_it_and_becomes_the_linear_answer():
    rotor = parse_rotor(jeffcott(BOW, gravity=9.81, density=100.0))
    speed = 1.5 * math.sqrt(stiffness() / M)
    run = Simulation(rotor, choose(tolerance=1e-4), speed=speed)
    bowed = run.motion.q[4]
    straight = static(rotor)
    sag = straight.x[2] + 1j * straight.y[2]
    assert bowed == pytest.approx(sag + B, rel=1e-3)
    for i in range(2000):
        run.advance((i + 1) * 2 * math.pi / speed / 40, speed)
    found = (run.motion.q[4] - sag) * cmath.exp(-1j * speed * run.time)
    expected = unbalance_response(rotor, [speed]).x[0, 2]
    assert abs(found - expected) < 2e-3 * abs(expected)
    assert run.read("sensor[1].x_amp") == pytest.approx(abs(expected), rel=2e-3)


def test_its_energy_is_in_the_ledger():
    """A free rotor runs down through its critical speed, and the bow turns its energy into
    bending."""
    wheel = table("[body]", node=3, mass=1.0, I_d=0.02, I_p=0.04)
    rotor = parse_rotor(jeffcott(BOW + wheel, density=1000.0))
    run = Simulation(rotor, choose(tolerance=1e-4), speed=260.0, drive_torque=-8.0)
    run.advance(1.5, -8.0)
    assert run.read("w") < 200.0
    assert abs(run.read("energy.residual")) < 1e-3 * losses(run)


def test_a_response_curve_is_the_linear_one_and_follows_it():
    machine = rf.parse(jeffcott(BOW, density=1000.0))
    curve = rf.response(machine, speed=(60.0, 320.0), stability=False).dataframe()
    exact = unbalance_response(machine.rotor, curve["speed"].to_numpy())
    np.testing.assert_allclose(curve["sensor[1].x_1x"], np.abs(exact.x[:, 2]), rtol=1e-6)
    over = rf.response(machine, speed=150.0, over=("bow[1].amplitude", 1e-4, 3e-4), stability=False)
    rows = over.dataframe()
    ratio = rows["sensor[1].x_1x"] / rows["bow[1].amplitude"]
    np.testing.assert_allclose(ratio, ratio.iloc[0], rtol=1e-6)


def test_a_run_begun_on_a_rub_that_a_bow_drives_stays_there():
    machine = rf.parse(jeffcott(BOW + wall(clearance=1.5e-4, mu=0.0, c=300.0), density=1000.0))
    curve = rf.response(machine, speed=(60.0, 150.0))
    rub = curve.branches[0].points[-1]
    assert rub.is_stable
    assert np.abs(rub.motion[1]).max() > 1.5e-4
    assert curve.check(rub, 20).distance < 1e-5


def test_it_is_a_parameter_of_runs_and_two_take_each_other_away():
    machine = rf.parse(jeffcott(BOW, density=1000.0))
    given = {"bow[1].amplitude": 2 * AMPLITUDE, "bow[1].phase": 0.0}
    run = rf.simulate(machine, stop=0.01, speed=0.0, parameters=given, record=["sensor[1].x"])
    np.testing.assert_allclose(run["sensor[1].x"], 2 * AMPLITUDE, rtol=1e-3)
    against = table("[bow]", node=3, amplitude=AMPLITUDE, phase=PHASE + math.pi)
    none = unbalance_response(parse_rotor(jeffcott(BOW + against)), [100.0])
    assert np.abs(none.x).max() < 1e-9 * AMPLITUDE


def test_fewer_dofs_keep_its_shape():
    """At slow roll, with one mode beside what is retained, as with all dofs."""
    ends = "".join(table("[support]", node=n, stiffness=1e6, damping=100.0) for n in (1, 11))
    sensors = "".join(table("[sensor]", node=node) for node in (3, 6, 8))
    text = "gravity = 0.0\n" + shaft(*np.linspace(0.0, 1.0, 11).tolist()) + ends + sensors
    whole = parse_rotor(text + table("[bow]", node=6, amplitude=AMPLITUDE, phase=PHASE))
    runs = [Simulation(whole, choose(reduction=few), speed=0.0) for few in (0, 1)]
    assert len(runs[1].motion.q) < len(runs[0].motion.q)
    every, few = (
        [run.read(f"sensor[{i}].{axis}") for i in (1, 2, 3) for axis in "xy"] for run in runs
    )
    np.testing.assert_allclose(few, every, atol=1e-6 * AMPLITUDE)


def wall(clearance, mu, c):
    return table("[contact]", node=3, journal_radius=0.02, clearance=clearance, mu=mu, k=1e6, c=c)


def test_it_may_close_a_contact_from_the_start_on():
    more = BOW + wall(clearance=5e-5, mu=0.1, c=100.0)
    run = Simulation(parse_rotor(jeffcott(more, density=1000.0)), speed=0.0)
    k = stiffness()
    pressed = (AMPLITUDE - 5e-5) * k * 1e6 / (k + 1e6)
    assert run.read("contact[1].fn") == pytest.approx(pressed, rel=1e-3)


@pytest.mark.parametrize(
    ("more", "said"),
    [
        (
            table("[bow]", node=1, amplitude=1e-4),
            r"bow\[1\].node = 1: must be between nodes 1 and 5",
        ),
        (table("[bow]", node=3, amplitude=-1e-4), r"bow\[1\].amplitude = -0.0001 m: must be >= 0"),
        (BOW + "[start]\nx = 1e-4\n", "start: cannot be given with a bow"),
    ],
)
def test_impossible_bows_are_refused(more, said):
    with pytest.raises(QuantityError, match=said):
        parse_rotor(jeffcott(more))
