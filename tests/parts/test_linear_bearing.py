"""Linear bearings: their table, whirl and stability by closed forms, and their ledger."""

import math
import warnings
from contextlib import nullcontext

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts import LAWS
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.parts.linear_bearing import LINEAR_BEARING, coefficients
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import RotorNote, RotorWarning, Simulation
from rotor_fmu.model.structure.assembly import assemble
from scipy.interpolate import PchipInterpolator

from ..toml_text import refusal_of
from .machines import bearings, rigid, shaft

OMEGA, DAMPING = 100.0, 0.05  # of the rigid body [rad/s], [1]
TABLE = """
[[linear_bearing]]
node = 1
speed = [0.0, 100.0, 180.0, 400.0]
kxx = [1e6, 1.2e6, 1.1e6, 2e6]
kxy = [0.0, 1e5, 3e5, 2e5]
kyx = -1e5
kyy = 1.5e6
cxx = 100.0
cyy = [100.0, 150.0, 150.0, 180.0]
[[linear_bearing]]
node = 3
kxx = 1e6
kyy = 1e6
cxx = 80.0
cyy = 90.0
"""
FLEXIBLE = (
    "gravity = 9.81\n"
    + shaft(0.0, 0.2, 0.4)
    + """
[[disc]]
node = 2
diameter = 0.2
width = 0.03
e = 1e-4
"""
)


def run(machine, times, *, speed=0.0, rate=0.0, h=1e-4, loads=None, method="newmark"):
    """Displacements of the first probe at the times [m]."""
    settings = choose("robust", method=method, h=h)
    sim = Simulation(machine, settings, speed=speed, rate=rate, loads=loads)
    z = []
    for t in times:
        sim.advance(t, speed + rate * sim.time, np.zeros(1))
        z.append(sim.motion.q[sim.structure.probes[-1].dof])
    return np.array(z), sim


def laws_of(machine):
    """The records of the linear bearings, and the tables."""
    laws = assemble(machine).laws
    return laws[LAWS.index(LINEAR_BEARING)], laws[-1]


def pulled(cross=0.0):
    """The rigid body on bearings, with a port in its middle."""
    k, c = OMEGA**2, 2 * DAMPING * OMEGA
    return parse_rotor(rigid(parts=bearings(k, c, cross) + "[[port]]\nnode = 2\n"))


def test_a_table_is_scipys_pchip_and_constant_beyond_its_ends():
    machine = parse_rotor(FLEXIBLE + TABLE)
    records, tables = laws_of(machine)
    record = records[0]
    part = machine.parts[1]
    for speed in (-50.0, 0.0, 37.0, 100.0, 140.0, 399.0, 400.0, 1e4):
        at = min(max(speed, 0.0), 400.0)
        k, l, c, e = interpreted(coefficients)(record, tables, speed)  # noqa: E741
        K, C = part.matrices(speed)
        assert K[0, 0] == pytest.approx(PchipInterpolator(part.speed, part.kxx)(at), rel=1e-13)
        for (p, q), matrix in (((k, l), K), ((c, e), C)):
            columns = np.array([p + q, 1j * (p - q)])
            np.testing.assert_allclose(columns.real, matrix[0], rtol=1e-12, atol=1e-6)
            np.testing.assert_allclose(columns.imag, matrix[1], rtol=1e-12, atol=1e-6)


def test_the_tangent_is_the_derivative_of_the_force():
    records, tables = laws_of(parse_rotor(FLEXIBLE + TABLE))
    d, v, none = 3e-5 - 1e-5j, 0.01 + 0.02j, np.zeros(0)
    force, tangent = (interpreted(f) for f in (LINEAR_BEARING.force, LINEAR_BEARING.tangent))
    f, p, q = tangent(
        records[0], tables, Kinematics(d, v, 130.0, 0.0, 0.0), Weights(2.0, 7.0, 0.0), none, none
    )
    for z in (1e-6 + 0j, 1e-6j):
        moved = force(records[0], tables, Kinematics(d + 2 * z, v + 7 * z, 130.0, 0.0, 0.0), none)
        assert moved - f == pytest.approx(p * z + q * z.conjugate(), rel=1e-9)


def test_a_released_body_rings_down_as_the_textbook_says():
    times = np.linspace(0, 0.2, 81)[1:]
    z, _ = run(pulled(), times, loads=np.array([10.0 + 0j]), h=2.5e-5)
    x0 = 10.0 / OMEGA**2
    decay, damped = DAMPING * OMEGA, OMEGA * math.sqrt(1 - DAMPING**2)
    exact = np.exp(-decay * times) * (
        np.cos(damped * times) + decay / damped * np.sin(damped * times)
    )
    np.testing.assert_allclose(z / x0, exact, atol=2e-5)


@pytest.mark.parametrize("share", [0.8, 1.25])
def test_cross_coupling_beyond_c_omega_destabilizes(share):
    # forward whirl is stable while kxy < c omega_n (Childs 1993, ch. 1)
    cross = share * 2 * DAMPING * OMEGA * OMEGA
    roots = np.roots([1, 2 * DAMPING * OMEGA, OMEGA**2 - 1j * cross])
    growth = roots.real.max()
    with pytest.warns(RotorNote, match="unstable at rest") if share > 1 else nullcontext():
        z, _ = run(pulled(cross), np.linspace(0, 1.0, 401)[1:], loads=np.array([10.0 + 0j]), h=1e-4)
    first, last = np.abs(z[150:200]).mean(), np.abs(z[350:400]).mean()
    assert math.log(last / first) / 0.5 == pytest.approx(growth, rel=0.03)
    assert (growth > 0) == (share > 1)


def test_the_ledger_closes_with_cross_coupling_and_a_table_while_the_speed_changes():
    residuals, lost = [], []
    for h in (4e-5, 2e-5):
        _, sim = run(
            parse_rotor(FLEXIBLE + TABLE), [0.01, 0.02, 0.03], speed=60.0, rate=4000.0, h=h
        )
        lost.append(sim.read("energy.bearings_loss"))
        assert abs(sim.read("energy.circulation_loss")) > 0.1 * lost[-1]
        residuals.append(abs(sim.read("energy.residual")))
    assert residuals[1] < 1e-3 * lost[1]
    assert math.log2(residuals[0] / residuals[1]) == pytest.approx(2, abs=0.3)


def test_the_order_is_2_with_tables_and_cross_coupling():
    machine = parse_rotor(FLEXIBLE + TABLE)
    ends = [_end(machine, h) for h in (1e-4, 5e-5, 2.5e-5)]
    ratio = abs(ends[0] - ends[1]) / abs(ends[1] - ends[2])
    assert math.log2(ratio) == pytest.approx(2, abs=0.05)


def _end(machine, h):
    settings = choose("robust", h=h)
    sim = Simulation(machine, settings, speed=60.0, rate=4000.0)
    sim.advance(0.01, 60.0)
    return sim.motion.q[2]


def test_leaving_a_table_is_said_once():
    with pytest.warns(
        RotorWarning, match=r"linear_bearing\[1\]: speed 50. rad/s lies outside"
    ) as w:
        run(parse_rotor(FLEXIBLE + TABLE), [1e-4, 2e-4, 3e-4], speed=500.0)
    assert len([m for m in w if "outside" in str(m.message)]) == 1
    with warnings.catch_warnings():
        warnings.filterwarnings("error", message=".*outside")
        run(parse_rotor(FLEXIBLE + TABLE), [1e-4], speed=300.0)


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("100.0, 180.0,", "180.0, 100.0,", "linear_bearing[1].speed[3] = 100 rad/s: must be above"),
        ("100.0, 180.0,", "100.0, 100.0,", "linear_bearing[1].speed[3] = 100 rad/s: must be above"),
        ("100.0, 180.0,", "100.0, nan,", "linear_bearing[1].speed[3] = nan rad/s"),
        ("[1e6, 1.2e6, 1.1e6, 2e6]", "[1e6, 2e6]", "linear_bearing[1].kxx: 2 given, 4 needed"),
        ("[1e6, 1.2e6,", "[1e6, '1.2e6',", "linear_bearing[1].kxx[2] = '1.2e6': must be a number"),
        ("kyy = 1.5e6", "", "linear_bearing[1].kyy is missing"),
        ("speed = [0.0, 100.0, 180.0, 400.0]", "", "kxx: a list needs linear_bearing[1].speed"),
        ("speed = [", "speeds = [", "did you mean speed?"),
        ("kxx = ", "kx = ", "linear_bearing[1].kx: unknown key; did you mean kxx?"),
    ],
)  # fmt: skip
def test_a_wrong_table_is_refused_by_name(old, new, named):
    assert named in refusal_of(FLEXIBLE + TABLE.replace(old, new, 1))


def test_constant_coefficients_are_parameters_and_tables_are_not():
    names = parse_rotor(FLEXIBLE + TABLE).parameters()
    assert "linear_bearing[1].kyy" in names
    assert "linear_bearing[1].kxx" not in names
    assert "linear_bearing[2].kxx" in names
