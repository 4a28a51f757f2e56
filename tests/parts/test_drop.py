"""A drop of one second into two touchdown bearings, with tables over the speed, against CVODE."""

import numpy as np
import pytest
from rotor_fmu.model.settings import choose

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


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
def test_an_error_controlled_drop_stays_within_some_hundredths_of_the_clearance(error, tolerance):
    """More than ten tolerances below 1e-2: what an impact amplifies is not asked of a step."""
    orbit, race, ledger = error(choose(tolerance=tolerance))
    assert orbit < 0.05
    assert race < 0.01
    assert ledger < 3e-4
