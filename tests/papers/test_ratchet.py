"""The ratchet: closed forms of the slide, what each scheme makes of the impacts, its TOML file."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rotor_fmu.model.kernels.band import to_dense

from papers.integrators.members import MODERATE_DISSIPATION, TRANSIENT_FIDELITY, newmark
from papers.ishikawa_koguchi.impact.ratchet import build, parse_ratchet, ratchet_toml, run_ratchet
from papers.ishikawa_koguchi.impact.stepping.failures import ImpactError

RATCHET = parse_ratchet(ratchet_toml())


@cache
def run(scheme, impact="no", cap=10_000):
    return run_ratchet(RATCHET, scheme, impact=impact, cap=cap)


def test_a_rigid_pawl_gives_the_wheels_acceleration():
    mass = 7800 * 0.05 * 0.01 * 0.01
    box = mass * (0.05**2 / 3 + 0.01**2 / 12)
    assert box < RATCHET.pawl_inertia < 1.15 * box
    # torque and force over inertia, with the nose's tip 7 mm below the pin
    arm = 0.2 * 0.05 / (0.05 + 0.2 * 0.007)
    inertia = 7.66e-4 + arm**2 * RATCHET.pawl_inertia
    assert pytest.approx(-(2 + arm * 0.05 * 20) / inertia) == RATCHET.acceleration
    assert pytest.approx(-2867, rel=0.01) == RATCHET.acceleration
    assert RATCHET.t_locking == pytest.approx(0.0118, abs=5e-5)


def test_moderate_dissipation_slides_locks_and_rebounds():
    result = run(MODERATE_DISSIPATION)
    assert result.run.is_done
    assert result.run.increments == 3000
    assert result.slope == pytest.approx(RATCHET.acceleration, rel=2e-4)
    assert result.slope == pytest.approx(-2867, rel=0.01)
    assert result.t_reversal == pytest.approx(0.0118, rel=0.02)
    assert result.wheel_speed.min() == pytest.approx(-33.5, abs=0.5)
    rebound = result.wheel_speed[result.t < 0.02].max()
    # converged: 21.7 rad/s (increments of 2e-6 s, four schemes)
    assert rebound == pytest.approx(21.7, rel=0.02)
    assert result.run.energy[-1] < 0


def test_no_nose_passes_through_a_tooth():
    result = run(MODERATE_DISSIPATION)
    assert (result.run.force >= 0).all()
    assert result.run.seen[:, 0].min() * 0.05 > -0.0103


def test_average_acceleration_shakes_the_pawl_and_makes_energy():
    fast = run(newmark())
    assert fast.fast_content > 50 * run(MODERATE_DISSIPATION).fast_content
    assert fast.energy_sliding > 1e-3
    assert -2e-3 < run(MODERATE_DISSIPATION).energy_sliding < 0


@pytest.mark.slow
def test_average_time_stalls_in_cutbacks():
    result = run(TRANSIENT_FIDELITY, "average-time", 2000)
    assert "2000 increments" in result.run.status
    assert result.run.increments == 2000
    assert result.run.cutbacks > 1000
    assert result.t[-1] < 0.03
    assert math.isnan(result.t_reversal)


@pytest.mark.slow
def test_the_same_scheme_without_cutbacks_or_with_impulses_arrives():
    for impact in ("no", "current-time"):
        result = run(TRANSIENT_FIDELITY, impact)
        assert result.run.is_done
        assert result.run.cutbacks == 0
        assert result.slope == pytest.approx(RATCHET.acceleration, rel=0.01)


def test_the_pinned_pawl_turns_freely_and_bends_as_a_beam():
    made = build(RATCHET)
    stiffness = to_dense(made.structure.stiffness)
    n = len(stiffness)
    points = RATCHET.plate.points
    turn = np.zeros(2 * len(points))
    turn[::2], turn[1::2] = -points[:, 1], points[:, 0]
    force = stiffness[: n - 1, : n - 1] @ turn[made.free]
    assert np.abs(force).max() < 1e-9 * np.abs(stiffness).max() * 0.05
    assert stiffness[-1, -1] == 0
    # clamped at the pin's end, without its bent nose: F L^3 / (3 E' I), shear aside
    straight = replace(RATCHET, tooth=replace(RATCHET.tooth, slope=0.0))
    long = replace(straight, pawl=replace(straight.pawl, elements=(40, 8)))
    made = build(long)
    dense = to_dense(made.structure.stiffness)[:-1, :-1]
    clamped = np.isin(made.free, np.r_[2 * long.plate.columns[0], 2 * long.plate.columns[0] + 1])
    u = np.zeros(len(dense))
    free = np.flatnonzero(~clamped)
    u[free] = np.linalg.solve(dense[np.ix_(free, free)], made.structure.force[:-1][free])
    pawl = long.pawl
    plane = pawl.E / (1 - pawl.nu**2)
    inertia = pawl.thickness * pawl.height**3 / 12
    bending = pawl.force * pawl.length**3 / (3 * plane * inertia)
    area = pawl.thickness * pawl.height
    shear = 1.2 * pawl.force * pawl.length / (pawl.E / 2 / (1 + pawl.nu) * area)
    assert -u[made.nose[:, 1]].mean() == pytest.approx(bending + shear, rel=0.03)


def test_a_frame_is_kept_at_each_interval():
    result = run_ratchet(RATCHET, MODERATE_DISSIPATION, t_end=0.001, frame_time=2e-4)
    assert result.shape_t == pytest.approx([0, 2e-4, 4e-4, 6e-4, 8e-4, 1e-3])
    assert result.shapes.shape == (6, 21 * 5, 2)
    assert np.abs(result.shapes[0]).max() == 0
    assert result.shapes[-1].min() < -1e-5


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("radius = 0.05", "radius = -0.05", "wheel.radius = -0.05: must be > 0"),
        ("radius = 0.05", "radios = 0.05", "wheel.radios: unknown key"),
        ("slip = 0.01", "", "tooth.slip is missing"),
        ("slip = 0.01", "slip = 'far'", "tooth.slip = 'far': must be a finite number"),
        ("density = 7800.0", "density = -1.0", "pawl.density = -1: must be > 0"),
        ("nu = 0.3", "nu = 0.5", "nu = 0.5: must be above -1 and below 0.5"),
        ("[20, 4]", "[20, 3]", "pawl.elements = .20, 3.: must be two numbers"),
        ("[20, 4]", "[0, 4]", "pawl.elements = .0, 4.: must be two numbers"),
        ("[20, 4]", "20", "pawl.elements = 20: must be two numbers"),
        ("nose_length = 0.01", "nose_length = 0.06", "nose_length = 0.06 m: must be below"),
        ("[tooth]", "[teeth]", "teeth: unknown key"),
        ("name =", "name", "not valid TOML"),
    ],
)
def test_an_impossible_ratchet_is_refused_by_name(old, new, message):
    text = ratchet_toml()
    assert old in text
    with pytest.raises(ImpactError, match=message):
        build(parse_ratchet(text.replace(old, new, 1)))
