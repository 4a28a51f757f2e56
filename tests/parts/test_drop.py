"""Drops into touchdown bearings whose races turn: one of a second, with tables over the speed,
against CVODE; the ledger of shorter ones."""

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from . import dropped
from .machines import DROPPED, touchdown

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
        result = [np.abs(mine - true).max() / np.abs(true).max() for mine, true in pairs]
        return (*result, abs(sim.read("energy.residual")) / lost)

    return of


@pytest.mark.slow
def test_the_reference_has_converged(exact):
    coarser, _ = dropped.by_cvode(dropped.machine(), TIMES, rtol=1e-6)
    assert np.abs(coarser - exact[0]).max() < 5e-5 * np.abs(exact[0]).max()


@pytest.mark.slow
def test_a_drop_in_small_steps_converges_to_the_reference_with_order_two(error):
    orbit, race, ledger = error(choose("robust", h=1e-5))
    finer_orbit, finer_race, _ = error(choose("robust", h=5e-6))
    assert orbit < 2e-4
    assert race < 1e-4
    assert finer_orbit < orbit / 2.5
    assert finer_race < race / 2.5
    assert ledger < 1e-6


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("tolerance", "most"), [(1e-2, 6e-3), (1e-3, 3e-4), (1e-4, 5e-5), (1e-5, 5e-6)]
)
def test_the_ledger_of_the_examples_drop_closes_with_the_tolerance(tolerance, most):
    rotor = parse_rotor(dropped.COMPRESSOR.read_text(encoding="utf-8"))
    sim = Simulation(rotor, choose(tolerance=tolerance), speed=1000.0, drive_torque=0.0)
    sim.advance(0.4, 0.0)
    lost = sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
    assert abs(sim.read("energy.residual")) < most * lost


@pytest.mark.parametrize(
    ("k", "more"),
    [
        ("5e7", ""),
        ("5e9", "exponent = 1.5\n"),
        ("5e7", "wear = 5e-5\n"),
        ("5e9", "exponent = 1.5\nwear = 5e-5\nmu_rise = 0.1\n"),
    ],
)
def test_the_ledger_closes_in_a_drop_with_spin_up_and_rub(k, more):
    machine = DROPPED + touchdown(4, "b").replace("k = 5e7", f"k = {k}") + more
    sim = Simulation(parse_rotor(machine), choose("robust", h=5e-6), speed=300.0)
    for t in np.linspace(0, 0.2, 101)[1:]:
        sim.advance(t, 300.0)
    lost = sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
    assert sim.read("touchdown_bearing[1].race") > 250.0
    assert sim.read("energy.drag_loss") > 0
    assert abs(sim.read("energy.residual")) < 1e-4 * lost


def test_a_free_rotor_and_its_races_keep_what_friction_does_not_take():
    machine = parse_rotor(DROPPED + touchdown(4, "b"))
    sim = Simulation(machine, choose("robust", h=5e-6), speed=300.0, drive_torque=0.0)
    sim.advance(0.1, 0.0)
    lost = sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
    assert sim.read("w") < 299.5
    assert sim.read("energy.drive_work") == pytest.approx(0, abs=1e-5 * lost)
    assert abs(sim.read("energy.residual")) < 1e-4 * lost


def test_a_run_with_races_goes_on_from_a_snapshot_bit_for_bit():
    sim = Simulation(parse_rotor(DROPPED + touchdown(4, "b")), choose("controlled"), speed=300.0)
    sim.advance(0.02, 300.0)
    there = sim.snapshot()
    sim.advance(0.04, 300.0)
    once = sim.observed.copy()
    sim.restore(there)
    sim.advance(0.04, 300.0)
    np.testing.assert_array_equal(sim.observed, once)
