"""Whirls that begin where the machine at rest loses its stability, towards either side."""

import numpy as np
import pytest

import rotor_fmu as rf

from ..known import EXAMPLES
from ..parts.machines import bearings, rigid

OMEGA, CLEARANCE, WALL = 100.0, 1e-3, 4e4
DAMPING, DRIVE = 20.0, 10.0  # of the bearings, and their cross coupling by the speed [N.s/m]
THRESHOLD = DAMPING * OMEGA / DRIVE


@pytest.fixture(scope="module")
def driven():
    """A Jeffcott rotor in a stator, on bearings whose cross coupling is proportional to the
    speed."""
    mounts = bearings(OMEGA**2, DAMPING, 1.0)
    for cross in ("kxy", "kyx"):
        for share in (0.01, 0.98):
            sign = "-" if cross == "kyx" else ""
            ends = [float(f"{sign}{share * DRIVE * speed}") for speed in (100.0, 400.0)]
            mounts = mounts.replace(f"{cross} = {sign}{share}\n", f"{cross} = {ends}\n")
    mounts = mounts.replace("node =", "speed = [100.0, 400.0]\nnode =")
    wall = f"""
[[contact]]
node = 2
journal_radius = 0.05
clearance = {CLEARANCE}
k = {WALL}
mu = 0.0
[[sensor]]
node = 2
name = "disc"
"""
    return rf.response(rf.parse(rigid(parts=mounts + wall)), speed=(150.0, 300.0), whirl=True)


def radius(motion):
    """Of the circle of the first interface, in the first harmonic [m]."""
    return np.abs(motion.orbit.b[1:3]).max()


def test_a_whirl_that_is_bounded_by_a_wall_alone_begins_at_the_threshold_of_any_size(driven):
    (branch,) = driven.branches
    assert set(branch.ends) == {"end of the range", "the whirl begins there, at rest"}
    inside = [point for point in branch.points if radius(point) < 0.9 * CLEARANCE]
    assert len(inside) > 1
    assert [p.value for p in inside] == pytest.approx([THRESHOLD] * len(inside), rel=1e-6)
    assert all(radius(bifurcation) > 0.9 * CLEARANCE for bifurcation in driven.bifurcations)


@pytest.mark.parametrize("speed", [220.0, 260.0])
def test_beyond_it_the_whirl_has_the_frequency_at_which_the_damping_balances_the_drive(
    driven, speed
):
    (point,) = driven.at(speed)
    omega = DRIVE * speed / DAMPING
    expected = CLEARANCE / (1.0 - (omega**2 - OMEGA**2) / WALL)
    x, y = driven.series(point, "disc", 64)
    assert point.is_stable
    assert point.orbit.omega == pytest.approx(omega, rel=1e-4)
    assert np.hypot(x, y) == pytest.approx(expected, rel=1e-3)


@pytest.mark.slow
def test_a_whirl_of_oil_films_begins_towards_lower_speeds_and_turns_back():
    """It is unstable up to where it turns: beside it the machine at rest is still stable."""
    machine = rf.load(EXAMPLES / "oil_film" / "rotor.toml")
    threshold = machine.campbell(np.linspace(500.0, 700.0, 5)).threshold
    speeds = (0.93 * threshold, 1.005 * threshold)
    result = rf.response(machine, speed=speeds, whirl=True, step=0.4)
    (branch,) = result.branches
    assert branch.ends == ("end of the range", "the whirl begins there, at rest")
    assert branch.points[-1].value == pytest.approx(threshold, rel=1e-3)
    (fold,) = result.bifurcations
    assert fold.kind == "fold"
    assert fold.value < 0.96 * threshold
    assert [p.is_stable for p in result.at(0.98 * threshold)] == [True, False]
