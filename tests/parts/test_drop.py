"""A drop of one second into two touchdown bearings, with tables over the speed, against CVODE."""

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from . import dropped

pytestmark = pytest.mark.slow
TIMES = np.linspace(0.0, dropped.STOP, 2001)


@pytest.fixture(scope="module")
def exact():
    return dropped.by_cvode(dropped.machine(), TIMES)


@pytest.fixture(scope="module")
def error(exact):
    """Largest errors of the journals' orbits and of the races' speeds, relative to the largest of
    either, and the ledger's residual by all that was dissipated."""

    def of(settings):
        orbits, races, sim = dropped.by_simulation(dropped.machine(), TIMES, settings)
        pairs = ((orbits, exact[0]), (races, exact[1]))
        lost = sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
        assert lost > 40.0
        found = [np.abs(mine - true).max() / np.abs(true).max() for mine, true in pairs]
        return (*found, abs(sim.read("energy.residual")) / lost)

    return of


def test_the_reference_has_converged(exact):
    coarser, _ = dropped.by_cvode(dropped.machine(), TIMES, rtol=1e-6)
    assert np.abs(coarser - exact[0]).max() < 5e-5 * np.abs(exact[0]).max()


def test_a_drop_in_small_steps_converges_to_the_reference_with_order_two(error):
    orbit, race, ledger = error(choose("robust", h=1e-5))
    finer_orbit, finer_race, _ = error(choose("robust", h=5e-6))
    assert orbit < 2e-4
    assert race < 1e-4
    assert finer_orbit < orbit / 2.5
    assert finer_race < race / 2.5
    assert ledger < 1e-6


@pytest.mark.parametrize(
    ("tolerance", "most_orbit", "most_race", "most_ledger"),
    [
        (1e-2, 1e-1, 1e-2, 3e-4),
        (1e-3, 1e-2, 1e-3, 1e-4),
        (1e-4, 1e-3, 1e-4, 1e-4),
        (1e-5, 1e-4, 1e-5, 1e-5),
    ],
)
def test_an_error_controlled_drop_converges_with_the_tolerance(
    error, tolerance, most_orbit, most_race, most_ledger
):
    """Orbits within ten tolerances, races within one; the ledger within 1e-4 of what is lost from
    1e-3 on."""
    orbit, race, ledger = error(choose(tolerance=tolerance))
    assert orbit < most_orbit
    assert race < most_race
    assert ledger < most_ledger


@pytest.mark.parametrize(
    ("tolerance", "most"), [(1e-2, 6e-3), (1e-3, 3e-4), (1e-4, 5e-5), (1e-5, 5e-6)]
)
def test_the_ledger_of_the_examples_drop_closes_with_the_tolerance(tolerance, most):
    rotor = parse_rotor(dropped.COMPRESSOR.read_text(encoding="utf-8"))
    sim = Simulation(rotor, choose(tolerance=tolerance), speed=1000.0, drive_torque=0.0)
    sim.advance(0.4, 0.0)
    lost = sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
    assert abs(sim.read("energy.residual")) < most * lost
