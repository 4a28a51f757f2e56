"""What grows with all contacts open grows as fast as its eigenvalue says, and is said once."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from scipy.optimize import least_squares

from ..dense import dense_matrices
from ..growing_whirls import found_last
from ..machines import STEEL, cylinders, first_order

GROWTHS = (2e-4, 5e-4, 1e-3, 2e-3, 5e-3)  # 1/s over rad/s: from which speed on a machine is taken


def damped_from_inside(seed: int) -> Rotor:
    """A shaft on springs and dampers whose internal damping turns with it, drawn at random."""
    draw = np.random.default_rng(seed)
    nodes = int(draw.integers(4, 8))
    shaft = cylinders(
        np.linspace(0.0, draw.uniform(0.4, 1.2), nodes), [draw.uniform(0.015, 0.04)] * (nodes - 1)
    )
    disc = Disc(
        int(draw.integers(2, nodes)), draw.uniform(0.15, 0.3), 0.03, e=10 ** draw.uniform(-7, -5)
    )
    supports = [
        Support(node, 10 ** draw.uniform(6, 7.5), draw.uniform(50, 1000)) for node in (1, nodes)
    ]
    eta_v = draw.uniform(3e-5, 1e-4)
    return Rotor(STEEL, shaft, (disc, *supports), eta_v=eta_v, rotating_damping=True)


def unstable(seed: int) -> tuple[Rotor, float, complex]:
    """A machine, a speed past its threshold and the root that grows there."""
    rotor = damped_from_inside(seed)
    structure = Simulation(rotor, warn=lambda message: None).structure
    lowest = structure.numbers[0].lowest_omega
    for speed in np.arange(0.5, 6.0, 0.25) * lowest:
        roots = np.linalg.eigvals(first_order(structure, speed))
        root = roots[np.argmax(roots.real)]
        if root.real > GROWTHS[seed % len(GROWTHS)] * abs(root):
            return rotor, float(speed), complex(root)
    return unstable(seed + 100)


def seen_growth(rotor, speed, root, tolerance):
    """Growth rate of the mode of a root in a run [1/s]: of the part of the motion along its left
    eigenvector, apart from what unbalance and weight make of it."""
    said = []
    sim = Simulation(rotor, choose(tolerance=tolerance), speed=speed, warn=said.append)
    matrix = first_order(sim.structure, speed)
    values, left, _ = scipy.linalg.eig(matrix, left=True)
    along = left[:, np.argmin(abs(values - root))].conj()
    turn = 2 * math.pi / abs(root.imag)
    sim.advance(turn / 4, speed, np.full(len(sim.rotor.discs), 10.0 + 0j))
    times = turn / 4 + np.arange(1, 801) / 800 * min(1.5 / root.real, 300 * turn)
    size, seen = len(sim.structure.static_load), []
    for t in times:
        sim.advance(t, speed, np.zeros(len(sim.rotor.discs), dtype=complex))
        seen.append(along @ np.concatenate([sim.motion.q[:size], sim.motion.v[:size]]))
    y, t = np.array(seen)[100:], times[100:] - times[100]

    def rest(parameters):
        basis = np.stack(
            [np.exp(complex(*parameters) * t), np.exp(1j * speed * t), np.ones_like(t)], axis=1
        )
        off = (basis @ np.linalg.lstsq(basis, y, rcond=None)[0] - y) / np.abs(y).max()
        return np.concatenate([off.real, off.imag])

    near = min(
        np.linspace(-5e-3, 5e-3, 201),
        key=lambda d: sum(rest((root.real, root.imag * (1 + d))) ** 2),
    )
    result = least_squares(
        rest, (root.real, root.imag * (1 + near)), x_scale=(root.real, 1e-3 * abs(root.imag))
    )
    return float(result.x[0]), said


@pytest.mark.parametrize(
    ("seed", "tolerance"),
    [
        *((seed, 1e-2) for seed in range(3)),
        *(
            pytest.param(seed, tolerance, marks=pytest.mark.slow)
            for seed in range(10)
            for tolerance in (1e-2, 1e-3, 1e-4)
        ),
    ],
)
def test_an_unstable_mode_grows_at_the_rate_of_its_eigenvalue(seed, tolerance):
    rotor, speed, root = unstable(seed)
    growth, said = seen_growth(rotor, speed, root, tolerance)
    assert growth == pytest.approx(root.real, rel=0.05)
    (message,) = said
    assert message.startswith("unstable: with no contacts a forward whirl")
    assert f"{root.imag:.4g} rad/s" in message
    assert f"{speed:.4g} rad/s" in message


def threshold(rotor) -> float:
    """Speed at which the first mode begins to grow, by eigenvalues of dense matrices [rad/s]."""
    structure = Simulation(rotor, warn=lambda message: None).structure

    def growth(speed):
        return np.linalg.eigvals(first_order(structure, speed)).real.max()

    low, high = 1.0, 1.0
    while growth(high) <= 0:
        high *= 1.1
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if growth(middle) > 0 else (middle, high)
    return high


def growing(rotor: Rotor) -> Rotor:
    """The machine with a wall far enough to be of no account before it grows."""
    stator = ClearanceContact(
        node=rotor.discs[0].node, journal_radius=0.1, clearance=2e-3, mu=0.1, k=1e7
    )
    return replace(rotor, parts=(*rotor.parts, stator))


def test_a_ramp_through_the_threshold_says_so_once_and_grows_as_its_roots_do():
    rotor = growing(damped_from_inside(1))
    begins = threshold(rotor)
    said = []
    rate = 0.1 * begins
    sim = Simulation(rotor, choose(tolerance=1e-2), speed=0.9 * begins, rate=rate, warn=said.append)
    for k in range(100):
        before = bool(said)
        speed = sim.read("w")
        sim.advance(0.02 * (k + 1), 0.9 * begins + rate * 0.02 * k)
        if said and not before:
            assert begins * 0.999 < sim.read("w") < 1.02 * begins
            assert speed < 1.02 * begins
    (message,) = said
    assert message.startswith("unstable: with all contacts open")


def test_a_table_driven_bearing_is_unstable_where_its_cross_coupling_is():
    """Cross coupling q feeds a mass on springs by q / (m w), its damper takes c / m."""
    shaft = cylinders((0.0, 0.05, 0.1), (0.05, 0.05))
    bearing = LinearBearing(
        node=2,
        speed=(100.0, 200.0, 300.0),
        kxx=1e6,
        kyy=1e6,
        kxy=(0.0, 2e4, 4e4),
        kyx=(0.0, -2e4, -4e4),
        cxx=20.0,
        cyy=20.0,
    )
    ends = (Support(1, 1e3, 1.0), Support(3, 1e3, 1.0))
    rotor = Rotor(STEEL, shaft, (Disc(2, 0.2, 0.1), bearing, *ends), gravity=0.0)
    for speed, is_unstable in ((120.0, False), (290.0, True)):
        said = []
        Simulation(rotor, speed=speed, warn=said.append)
        assert any(message.startswith("unstable: with") for message in said) == is_unstable


def test_a_run_that_comes_back_below_the_threshold_takes_long_steps_again():
    rotor = damped_from_inside(1)
    begins = threshold(rotor)
    sim = Simulation(rotor, choose(), speed=1.5 * begins, warn=lambda message: None)
    sim.advance(0.1, 1.5 * begins)
    record = sim._run.memory.record
    assert record["h_in_the_open"][0] < math.inf
    for k in range(20):
        sim.advance(0.1 + 0.01 * (k + 1), (1.5 - 0.05 * k) * begins)
    assert record["h_in_the_open"][0] == math.inf


def damped_rig() -> Rotor:
    """The rig, its shaft's damping turning with it."""
    turning = rig_toml().replace("rotating_damping = false", "rotating_damping = true")
    return parse_rotor(turning.replace("\nc = 100.0", "\nc = 0.0"))


def roots_on_contacts(sim: Simulation, speed: float) -> np.ndarray:
    """Eigenvalues of a machine that lies on its contacts, about its rest: dense matrices, and the
    wall's force -k (|d| - clearance) (1 + i mu) d / |d| by differences."""
    structure = sim.structure
    M, C, K, G, circulatory = dense_matrices(structure)
    K = K + structure.numbers[0].kappa_v * speed * circulatory
    half = len(M) // 2
    for part, interface in zip(sim.rotor.bearings, structure.interfaces, strict=True):
        at = np.zeros(half)
        at[interface.dof], at[interface.end] = 1.0, -1.0
        d = sim.motion.q[interface.dof] - sim.motion.q[interface.end]

        def force(z, part=part):
            return -part.k * (abs(z) - part.clearance) * (1 + 1j * part.mu) * z / abs(z)

        h = 1e-10
        for column, turn in enumerate((1.0, 1j)):
            slope = (force(d + h * turn) - force(d - h * turn)) / (2 * h)
            for row, value in enumerate((slope.real, slope.imag)):
                place = slice(row * half, (row + 1) * half), slice(column * half, None)
                K[place[0], place[1]][:, :half] -= value * np.outer(at, at)
    none, one = np.zeros_like(M), np.eye(len(M))
    A = np.block([[none, one], [-np.linalg.solve(M, K), -np.linalg.solve(M, C + speed * G)]])
    return np.linalg.eigvals(A)


@pytest.mark.parametrize(
    ("speed", "is_unstable"), [(100.0, False), (200.0, False), (400.0, True), (-400.0, True)]
)
def test_a_machine_that_lies_on_its_contacts_is_as_stable_as_it_lies(speed, is_unstable):
    """Not as it would fly, when its free precession would grow from the first revolution on."""
    said = []
    sim = Simulation(damped_rig(), speed=speed, warn=said.append)
    assert (sim.motion.force != 0).all()
    roots = roots_on_contacts(sim, abs(speed))
    fastest = roots[np.argmax(roots.real / abs(roots))]
    assert (fastest.real > 1e-5 * abs(fastest)) == is_unstable
    messages = [m for m in said if m.startswith("unstable")]
    assert len(messages) == is_unstable
    for message in messages:
        at_rest = [w for w in found_last(sim) if w.speed == speed and len(w.closed) == 2]
        expected = complex(fastest.real, abs(fastest.imag))
        assert min(abs(w.root - expected) for w in at_rest) < 1e-3 * abs(expected)
        assert message.startswith("unstable: with the contacts as they carry the machine at rest a")
        assert f"({expected.imag:.3g}" in message


@pytest.mark.parametrize("lift", [0.0, 600.0])
def test_one_that_is_lifted_off_them_is_not_judged_as_it_lay(lift):
    """As by magnetic bearings, which are another FMU's."""
    said = []
    sim = Simulation(damped_rig(), speed=100.0, warn=said.append)
    loads = np.zeros(len(sim.structure.load_dof), complex)
    loads[: len(sim.rotor.discs)] = 1j * lift / len(sim.rotor.discs)
    for i in range(1, 5):
        sim.advance(5e-4 * i, 100.0 + 75.0 * i, loads, rate=1.5e5)
    assert (sim.motion.force == 0).all() == (lift > 0)
    assert [m.startswith("unstable") for m in said] == [True] * (lift == 0)
