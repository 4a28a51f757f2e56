"""The added mass of a liquid seal: the shaft accelerates it, gravity and the base do not."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import level_2, modes, static, unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from ..toml_text import refusal_of
from .machines import bearings, rigid

K, C, BODY, ADDED = 1e4, 2.0, 1.0, 3.0
OMEGA, DECAY = math.sqrt(K / (BODY + ADDED)), C / 2 / (BODY + ADDED)
DAMPED = math.sqrt(OMEGA**2 - DECAY**2)
SEAL = f"""
[[seal]]
node = 2
kxx = 0.0
kyy = 0.0
cxx = 0.0
cyy = 0.0
added_mass = {ADDED}
"""
BASE = "[base]\n"


def sealed(gravity=0.0, rest=""):
    return parse_rotor(rigid(BODY, gravity, bearings(K, C) + SEAL, rest))


def test_it_lowers_the_natural_frequency_and_the_decay():
    found = modes(sealed(), 0.0, count=2)
    np.testing.assert_allclose(found.eigenvalues, complex(-DECAY, DAMPED), rtol=1e-5)


def test_it_has_no_weight():
    result = static(sealed(gravity=9.81))
    np.testing.assert_allclose(result.y[1], -9.81 * BODY / K, rtol=1e-5)
    assert result.load_y.sum() == pytest.approx(-9.81 * BODY, rel=1e-9)


def test_a_seal_bears_the_inertia_of_its_fluid():
    """So that all loads are the unbalance's pull and that of the body."""
    speed, amount = 1.3 * OMEGA, 1e-4
    found = unbalance_response(sealed(), [speed], unbalances=[(2, amount, 0.0)])
    pull = speed**2 * (amount + BODY * found.x[0, 1])
    assert found.load_x.sum() == pytest.approx(pull, rel=1e-5)
    seal = found.supports.index("seal[1]")
    assert found.load_x[0, seal] == pytest.approx(-ADDED * speed**2 * found.x[0, 1], rel=1e-9)


def test_a_start_is_about_the_centre_of_mass_of_the_rotor_without_the_fluid():
    start = "[start]\nx = 1e-4\ntilt_x = 1e-3\nvy = 0.1\nrate_y = 2.0\n"
    text = rigid(BODY, 0.0, bearings(K, C) + SEAL.replace("node = 2", "node = 1"), start)
    simulation = Simulation(parse_rotor(text), choose("robust"), speed=0.0)
    middle = 2  # the deflection of node 2
    assert simulation.motion.q[middle].real == pytest.approx(1e-4, rel=1e-9)
    assert simulation.motion.v[middle].imag == pytest.approx(0.1, rel=1e-9)


def test_a_base_that_starts_to_accelerate_takes_it_along():
    simulation = Simulation(
        sealed(rest=BASE), choose("robust", h=1e-4), speed=0.0, loads=np.zeros(1, complex)
    )
    simulation.advance(1e-4, 0.0, np.zeros(1, complex))
    acceleration, times = 2.0, np.linspace(0.0, 0.2, 41)[1:]
    z = []
    for t in times:
        simulation.advance(1e-4 + t, 0.0, np.array([acceleration + 0j]))
        z.append(simulation.motion.q[simulation.structure.probes[-1].dof].real)
    # the body falls behind by its own mass alone, and swings about that with both
    swing = np.exp(-DECAY * times) * (
        np.cos(DAMPED * times) + DECAY / DAMPED * np.sin(DAMPED * times)
    )
    lag = BODY * acceleration / K
    np.testing.assert_allclose(z, -lag * (1 - swing), atol=1e-3 * lag)
    assert abs(simulation.read("energy.residual")) < 1e-5 * K * lag**2


def test_level_2_of_a_seal_is_the_mode_of_the_machine_with_it():
    disc = "[[disc]]\nnode = 2\ndiameter = 0.1\nwidth = 0.01\n"
    machine = parse_rotor(rigid(BODY, 0.0, bearings(K, C) + SEAL, disc))
    case = level_2(machine, 50.0).cases[-1]
    found = modes(machine, 50.0, count=4)
    assert np.abs(found.damped - case.first_frequency).min() < 1e-8 * case.first_frequency


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ("added_mass = 3.0", "added_mass = -3.0", "seal[1].added_mass = -3 kg: must be >= 0"),
        (
            "added_mass = 3.0",
            'added_mass = 3.0\nhousing = "pedestal"\n'
            '[[housing]]\nname = "pedestal"\nmass = 1.0\nkx = 1e6\nky = 1e6\ncx = 0.0\ncy = 0.0',
            "seal[1].added_mass = 3 kg: must be 0 in a housing",
        ),
    ],
)
def test_an_impossible_one_is_refused(before, after, expected):
    text = rigid(BODY, 0.0, bearings(K, C) + SEAL).replace(before, after)
    assert expected in refusal_of(text)
