"""Whirls that begin where the machine at rest loses its stability, towards either side."""

import numpy as np
import pytest
from rotor_fmu.model.periodic.problem import Task, machines_of
from rotor_fmu.model.periodic.self_excited import beginning_whirls
from scipy.interpolate import PchipInterpolator

import rotor_fmu as rf

from ..known import EXAMPLES
from ..parts.machines import bearings, rigid

OMEGA, CLEARANCE, WALL = 100.0, 1e-3, 4e4
DAMPING, DRIVE = 20.0, 10.0  # of the bearings, and their cross coupling by the speed [N.s/m]
THRESHOLD = DAMPING * OMEGA / DRIVE


@pytest.fixture(scope="module")
def machine():
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
    return rf.parse(rigid(parts=mounts + wall))


@pytest.fixture(scope="module")
def driven(machine):
    return rf.response(machine, speed=(150.0, 300.0), whirl=True)


def radius(motion):
    """Of the circle of the first interface, in the first harmonic [m]."""
    return np.abs(motion.orbit.b[1:3]).max()


def test_a_whirl_that_is_bounded_by_a_wall_alone_begins_at_the_threshold_of_any_size(driven):
    (branch,) = driven.branches
    assert set(branch.ends) == {"end of the range", "the whirl begins there, at rest"}
    inside = [point for point in branch.points if radius(point) < 0.9 * CLEARANCE]
    assert len(inside) > 1
    assert [p.value for p in inside] == pytest.approx([THRESHOLD] * len(inside), rel=1e-6)
    # no fold: at most that it touches, all around at once
    assert [b.kind for b in driven.bifurcations] in ([], ["grazing"])


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


@pytest.mark.parametrize("size", [0.5, 1.2])
def test_a_branch_is_followed_from_one_of_its_whirls(machine, driven, size):
    """Where it does not touch, the whirls of all sizes have one speed."""
    start = min(driven.points, key=lambda point: abs(radius(point) / CLEARANCE - size))
    (branch,) = rf.response(machine, speed=(150.0, 300.0), whirl=True, start=start).branches
    assert set(branch.ends) == {"the whirl begins there, at rest", "end of the range"}
    resting, last = sorted((branch.points[0], branch.points[-1]), key=lambda p: p.value)
    assert (resting.value, last.value) == (pytest.approx(THRESHOLD, rel=1e-3), 300.0)
    assert last.orbit.omega == pytest.approx(DRIVE * 300.0 / DAMPING, rel=1e-4)


@pytest.mark.slow
def test_a_whirl_of_oil_films_begins_towards_lower_speeds_and_turns_back():
    """It is unstable up to where it turns: beside it the machine at rest is still stable."""
    machine = rf.load(EXAMPLES / "oil_film" / "rotor.toml")
    threshold = machine.campbell(np.linspace(500.0, 700.0, 5)).threshold
    speeds = (0.93 * threshold, 1.005 * threshold)
    result = rf.response(machine, speed=speeds, whirl=True, step=0.4)
    (branch,) = result.branches
    ends = dict(zip(branch.ends, (branch.points[0], branch.points[-1]), strict=True))
    assert set(ends) == {"end of the range", "the whirl begins there, at rest"}
    at_rest = ends["the whirl begins there, at rest"]
    assert at_rest.value == pytest.approx(threshold, rel=1e-3)
    assert radius(at_rest) < 0.1 * radius(ends["end of the range"])
    (fold,) = result.bifurcations
    assert fold.kind == "fold"
    assert fold.value < 0.96 * threshold
    small, large = sorted(result.at(0.98 * threshold), key=radius)
    assert (small.is_stable, large.is_stable) == (False, True)


def stations(nodes, diameter, density, each):
    """Point masses of 1 kg at the ends of a shaft, each in a stator, on bearings of its own
    stiffness [N/m] and cross coupling by the speed [N.s/m]."""
    speeds = [100.0, 400.0]
    text = f"""
gravity = 0.0
[material]
young = 2.1e11
density = {density}
[shaft]
nodes = {nodes}
diameters = {[diameter] * (len(nodes) - 1)}
"""
    for node, (k, drive) in zip((1, len(nodes)), each, strict=True):
        cross = [drive * speed for speed in speeds]
        text += f"""
[[point_mass]]
node = {node}
mass = 1.0
[[contact]]
node = {node}
journal_radius = 0.05
clearance = {CLEARANCE}
k = {WALL}
mu = 0.0
[[linear_bearing]]
node = {node}
kxx = {k}
kyy = {k}
cxx = {DAMPING}
cyy = {DAMPING}
speed = {speeds}
kxy = {cross}
kyx = {[-value for value in cross]}
"""
    return rf.parse(text)


def test_all_whirls_are_found_that_begin_close_together():
    k = np.array([1.0, 1.002]) * OMEGA**2
    machine = stations([0.0, 0.1], 0.01, 1e-3, [(of, DRIVE) for of in k])
    task = Task(150.0, 300.0, is_whirl=True)
    problem = task.problem(machines_of(machine.rotor, task), 150.0, 3, omega=1)
    begins = [small for _, small in beginning_whirls(problem, 150.0, 300.0)]
    expected = DAMPING * np.sqrt(k) / DRIVE
    assert [begin.parameter for begin in begins] == pytest.approx(expected, rel=1e-5)
    assert [begin.omega for begin in begins] == pytest.approx(np.sqrt(k), rel=1e-5)


def test_a_mode_that_grows_within_a_fiftieth_of_the_range_begins_and_ceases_there():
    """Where the cross coupling, with a peak over the speed, exceeds what the damping takes."""
    speeds, peak = [103.0, 203.0, 303.0], 1.0001
    mounts = bearings(OMEGA**2, DAMPING, 1.0)
    for cross in ("kxy", "kyx"):
        for share in (0.01, 0.98):
            sign = "-" if cross == "kyx" else ""
            table = [0.0, float(f"{sign}{share * peak * DAMPING * OMEGA}"), 0.0]
            mounts = mounts.replace(f"{cross} = {sign}{share}\n", f"{cross} = {table}\n")
    mounts = mounts.replace("node =", f"speed = {speeds}\nnode =")
    rotor = rf.parse(rigid(parts=mounts)).rotor
    task = Task(150.0, 300.0, is_whirl=True)
    problem = task.problem(machines_of(rotor, task), 150.0, 3, omega=1)
    begins = [small.parameter for _, small in beginning_whirls(problem, 150.0, 300.0)]
    expected = PchipInterpolator(speeds, [0.0, peak, 0.0]).solve(1.0, extrapolate=False)
    assert np.ptp(expected) < 0.02 * 150.0
    assert begins == pytest.approx(expected, rel=1e-4)


@pytest.mark.slow
def test_a_branch_between_two_places_where_whirls_begin_is_followed_once():
    each = [(OMEGA**2, DRIVE), (OMEGA**2, 1.3 * DRIVE)]
    machine = stations([0.0, 0.5, 1.0], 0.005, 7800.0, each)
    branches = rf.response(machine, speed=(165.0, 200.0), whirl=True, step=0.4).branches
    # another one goes from end to end of the range
    (ends,) = (b.ends for b in branches if "the whirl begins there, at rest" in b.ends)
    assert len(set(ends)) == 1
