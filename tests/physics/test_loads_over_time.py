"""Loads, torques, base motion and speeds over time are linear between the points of their series,
whatever the communication step: closed forms, the exact answer of a linear system, the ledger."""

import math
from contextlib import suppress
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation, StepFailure
from scipy.signal import lsim

import rotor_fmu as rf
from rotor_fmu.cosimulation.member import Member
from rotor_fmu.fmi.interface import interface
from rotor_fmu.runs.input_signals import Driver, Signals

from ..machines import balanced, losses
from ..parts.machines import bearings, rigid

K, C = 1e4, 10.0  # of a mass of 1 kg
MASS = parse_rotor(rigid(parts=bearings(K, C) + '[[port]]\nnode = 2\nname = "amb"\n'))
MOVED = parse_rotor(rigid(parts=bearings(K, C) + '[base]\n[[port]]\nnode = 2\nname = "amb"\n'))
FINE = choose("robust", h=2e-5)
T = np.array([0.0, 0.013, 0.05, 0.0501, 0.09, 0.12])
F = np.array([0.0, 5.0, -3.0, 2.0, 2.0, -1.0])


def driven(rotor, t, columns, step, stop=None, speed=0.0, settings=FINE):
    """The simulation at the end of a run along a series, in communication steps [s]."""
    names = [v.name for v in interface(rotor) if v.causality == "input"]
    given = {"speed": np.full(len(t), speed)} | columns
    signals = Signals(t, {name: given.get(name, np.zeros(len(t))) for name in names})
    pairs = list(zip(names[1::2], names[2::2], strict=True))
    first = {name: signals.at(name, 0.0) for name in names}
    loads = np.array([complex(first[x], first[y]) for x, y in pairs])
    simulation = Simulation(
        rotor, settings, speed=first["speed"], rate=signals.first_rate, loads=loads
    )
    driver = Driver(signals, pairs)
    n = 0
    stop = stop or float(t[-1])
    while n * step < stop - 1e-12:
        driver.advance(simulation, n * step, min((n + 1) * step, stop))
        n += 1
    return simulation


def test_the_loads_of_a_step_are_each_series_at_its_time_bit_for_bit():
    """Before the first time and after the last, at one and between two; FMPy's formula."""
    given = {"a.x": F, "a.y": -0.1 * F, "b.x": F / 3.0, "b.y": np.roll(F, 1)}
    driver = Driver(Signals(T, {"speed": F, **given}), [("a.x", "a.y"), ("b.x", "b.y")])
    for t in (-1.0, *T, 0.017, 0.05003, 0.1, 1.0):
        after = int(np.clip(np.searchsorted(T, t), 1, len(T) - 1))
        at = np.clip(t, T[0], T[-1])
        weight = (T[after] - at) / (T[after] - T[after - 1])
        x_y = [weight * of[after - 1] + (1 - weight) * of[after] for of in given.values()]
        expected = [complex(*x_y[:2]), complex(*x_y[2:])]
        np.testing.assert_array_equal(driver.forces(t), expected)


@cache
def exact():
    """Displacement of the mass at the end under the force F, linear between the points of T, by
    SciPy's exact simulation of a linear system between samples."""
    grid = np.linspace(0.0, T[-1], 1201)
    assert np.isin(np.round(T * 1e6), np.round(grid * 1e6)).all()
    _, x, _ = lsim(([1.0], [1.0, C, K]), np.interp(grid, T, F), grid)
    return x[-1]


@pytest.mark.parametrize("step", [0.12, 4e-3, 7e-4])
def test_a_mass_follows_a_force_as_the_exact_answer_does(step):
    simulation = driven(MASS, T, {"amb.fx": F, "amb.fy": -2 * F}, step)
    x = exact()
    assert simulation.read("amb.x") == pytest.approx(x, rel=2e-5)
    assert simulation.read("amb.y") == pytest.approx(-2 * x, rel=2e-5)


def test_a_force_that_is_held_is_wrong_where_the_series_is_not_constant():
    """What a master that does not know the series has to live with: of first order in its step."""
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        simulation = Simulation(MASS, FINE)
        for n in range(round(T[-1] / step)):
            load = np.interp(n * step, T, F)
            simulation.advance((n + 1) * step, 0.0, np.array([load + 0j]))
        errors.append(abs(simulation.read("amb.x") / exact() - 1))
    assert min(errors) > 0.01
    assert errors[0] > 1.5 * errors[2]


@pytest.mark.parametrize("step", [0.12, 4e-3])
def test_a_base_that_moves_is_a_force_on_the_mass(step):
    simulation = driven(MOVED, T, {"base.ax": F}, step)
    assert simulation.read("amb.x") == pytest.approx(-exact(), rel=2e-5)


@pytest.mark.parametrize("preset", ["robust", "controlled"])
def test_steps_of_the_solver_hit_every_bend(preset):
    """At a tolerance too coarse to see them the series is followed all the same."""
    settings = choose(preset, **({"h": 1e-4} if preset == "robust" else {}))
    simulation = driven(MASS, T, {"amb.fx": F}, 0.12, settings=settings)
    coarse = driven(MASS, T, {"amb.fx": F}, 4e-3, settings=settings)
    assert simulation.read("amb.x") == pytest.approx(coarse.read("amb.x"), rel=0.05)


@pytest.mark.parametrize("step", [0.7, 0.11, 4e-3])
def test_a_speed_that_bends_within_steps_gives_its_integral(step):
    t, speed = np.array([0.0, 0.23, 0.4, 0.7]), np.array([20.0, 60.0, 60.0, -5.0])
    simulation = driven(MASS, t, {"speed": speed}, step)
    assert simulation.read("phi") == pytest.approx(np.trapezoid(speed, t), rel=1e-12)
    assert simulation.read("w") == pytest.approx(-5.0, rel=1e-12)


def test_the_last_values_are_held_after_the_end_of_a_series():
    t, speed = np.array([0.1, 0.2]), np.array([10.0, 30.0])
    simulation = driven(MASS, t, {"speed": speed, "amb.fx": np.array([1.0, 4.0])}, 0.07, stop=2.0)
    assert simulation.read("phi") == pytest.approx(1.0 + 2.0 + 1.8 * 30.0, rel=1e-12)
    assert simulation.read("amb.x") == pytest.approx(4.0 / K, rel=1e-3)


def test_a_torque_that_rises_turns_a_balanced_rotor_as_its_integral():
    rotor = balanced(rig()).with_values({"bearing[1].mu": 1e-9, "bearing[2].mu": 1e-9})
    simulation = Simulation(rotor, choose("robust"), speed=100.0, drive_torque=0.01)
    inertia = simulation.read("J")
    for n in range(5):  # 2 N.m/s
        simulation.advance(0.05 * (n + 1), 0.01 + 0.1 * n, rate=2.0)
    gained = (0.01 * 0.25 + 0.5 * 2.0 * 0.25**2) / inertia
    assert simulation.read("w") == pytest.approx(100.0 + gained, rel=1e-5)


def test_the_ledger_closes_with_the_square_of_the_step_when_loads_vary():
    residuals, works = [], []
    t, force = np.array([0.0, 0.02, 0.04, 0.08, 0.12]), np.array([0.0, 5.0, -3.0, 2.0, 1.0])
    loads = {"amb.fx": 2 * force, "amb.fy": force, "base.ay": force}
    for h in (4e-4, 2e-4, 1e-4):
        settings = choose("robust", method="newmark", h=h)
        simulation = driven(MOVED, t, loads, 0.03, settings=settings)
        residuals.append(abs(simulation.read("energy.residual")))
        works.append(simulation.read("energy.external_work"))
    assert residuals[0] < 1e-2 * abs(works[0])
    for coarse, fine in pairwise(residuals):
        assert 3.3 < coarse / fine < 4.8
    assert losses(simulation) > 0.0


def test_the_ledger_closes_when_the_torque_varies():
    def residual(h):
        simulation = Simulation(
            rig(), choose("robust", method="newmark", h=h), speed=60.0, drive_torque=0.0
        )
        simulation.advance(0.2, 0.0, rate=0.3)
        simulation.advance(0.4, 0.06, rate=-0.3)
        return abs(simulation.read("energy.residual")), simulation.read("energy.drive_work")

    (coarse, work), (fine, _) = residual(2e-4), residual(1e-4)
    assert fine < 1e-3 * abs(work)
    assert fine < 0.5 * coarse


ORBIT = {"speed": 150.0, "stop": 0.3, "per_turn": None}


def rotating(step):
    """The rig's orbit under a load that turns, by its series of 1 kHz, in the last tenth."""
    t = np.linspace(0.0, 0.3, 301)
    loads = {"disc[2].fx": (t, 30 * np.cos(180 * t)), "disc[2].fy": (t, 30 * np.sin(180 * t))}
    run = rf.simulate(rf.load(), loads=loads, step=step, **ORBIT)
    assert run.status == "ok"
    instants = np.linspace(0.25, 0.3, 500)
    return np.array([np.interp(instants, run.t, run[f"disc[3].{axis}"]) for axis in "xy"])


def test_an_orbit_is_the_same_whatever_the_communication_step():
    """It was off by half its size, of first order in the step, when loads were held."""
    reference = rotating(1e-4)
    size = np.abs(reference).max()
    for step in (4e-3, 1e-3):
        assert np.abs(rotating(step) - reference).max() < 5e-3 * size, step


def test_points_on_a_line_are_no_bends():
    t = np.linspace(0.0, 40.0, 1001)
    ramp = Signals(t, {"speed": 400.0 - 10.0 * t, "disc[1].fx": np.full(1001, 3.0)})
    assert len(ramp.bends) == 1  # the end of the series, after which it is held
    assert Signals(t[:2], {"speed": np.full(2, 7.0)}).bends.tolist() == []
    bent = Signals(np.array([0.0, 1.0, 2.0]), {"speed": np.array([0.0, 1.0, 1.5])})
    assert bent.bends.tolist() == [1.0, 2.0]


def test_a_state_taken_while_loads_vary_goes_on_bit_for_bit():
    rates = np.array([300.0 - 100j])
    simulation = Simulation(MASS, FINE)
    simulation.advance(0.01, 0.0, np.array([1.0 + 0j]), load_rates=rates)
    state = simulation.snapshot()
    ends = []
    for _ in range(2):
        simulation.advance(0.02, 0.0)  # held where they are
        ends.append(simulation.observed.copy())
        simulation.restore(state)
    assert (ends[0] == ends[1]).all()
    simulation.advance(1.0, 0.0)
    held = np.array([1.0 + 0.01 * 300.0, -0.01 * 100.0]) / K
    assert [simulation.read(f"amb.{axis}") for axis in "xy"] == pytest.approx(held, rel=1e-2)


def test_a_run_that_stops_early_goes_on_where_it_stands_with_its_loads():
    """`max_iterations` ends a call, not the run: the next one goes on as if there had been none."""
    whole = Simulation(rig(), choose("robust"), speed=200.0, rate=0.0)
    parts = Simulation(rig(), choose("robust", max_iterations=50), speed=200.0, rate=0.0)
    whole.advance(0.1, 200.0)
    with pytest.raises(StepFailure, match=r"stopped after 50 iterations \(solver.max_iterations\)"):
        parts.advance(0.1, 200.0)
    assert 0.0 < parts.time < 0.1
    while parts.time < 0.1:
        with suppress(StepFailure):
            parts.advance(0.1, 200.0)
    for name in ("disc[3].x", "disc[3].y", "phi"):
        assert parts.read(name) == pytest.approx(whole.read(name), rel=1e-2, abs=1e-7)
    assert math.isclose(parts.time, 0.1)


def test_a_search_for_the_equilibrium_that_ends_at_max_iterations_says_so():
    with pytest.raises(EquilibriumError, match=r"found in 5 iterations .*; allow more of them$"):
        Simulation(rig(), choose("robust", max_iterations=5), speed=200.0)


def through(fmu, t, forces, takes_slopes):
    """disc[3].x after every communication step of an FMU, each of which ends at a point."""
    start = {"speed": 150.0, "disc[2].fx": forces[0].real, "disc[2].fy": forces[0].imag}
    with Member(fmu, start, []) as rotor:
        inputs = ("disc[2].fx", "disc[2].fy")
        references = [rotor.variable(name).valueReference for name in inputs]
        rotor.begin()
        ends = []
        for i in range(len(t) - 1):
            rotor.set(dict(zip(inputs, (forces[i].real, forces[i].imag), strict=True)))
            slope = (forces[i + 1] - forces[i]) / (t[i + 1] - t[i])
            if takes_slopes:
                slopes = [slope.real, slope.imag]
                rotor._fmu.setRealInputDerivatives(references, [1, 1], slopes)
            rotor.step(t[i], t[i + 1] - t[i])
            ends += rotor.get(["disc[3].x"]).values()
        return np.array(ends)


def test_an_fmu_follows_them_with_derivatives_and_holds_them_without(tmp_path):
    t = np.linspace(0.0, 0.2, 51)
    forces = 30 * np.exp(180j * t)
    loads = {"disc[2].fx": (t, forces.real), "disc[2].fy": (t, forces.imag)}
    run = rf.simulate(rf.load(), speed=150.0, loads=loads, record=["disc[3].x"], per_turn=None)
    exact = np.interp(t[1:], run.t, run["disc[3].x"])
    native = rf.build_fmu(rf.load(), tmp_path, is_native=True, platforms=["linux64"])
    off = [
        np.abs(through(fmu, t, forces, takes) - exact).max() / np.abs(exact).max()
        for fmu, takes in (
            (native, True),
            (native, False),
            (rf.build_fmu(rf.load(), tmp_path), False),
        )
    ]
    assert off[0] < 5e-3
    assert off[1] == pytest.approx(off[2], rel=1e-12)
    assert off[1] > 0.1
