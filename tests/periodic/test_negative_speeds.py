"""A machine that turns the other way has the periodic motions of its mirror image: by harmonics, by
shooting, and the whirls that roll along a wall or grow from rest."""

from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.periodic.arclength import with_tangent
from rotor_fmu.model.periodic.branch import solution
from rotor_fmu.model.periodic.newton import solve
from rotor_fmu.model.periodic.problem import Task, machines_of
from rotor_fmu.model.periodic.self_excited import _CIRCLES, _SIZES, growing_whirls
from rotor_fmu.model.periodic.shooting import Shooting

import rotor_fmu as rf
from rotor_fmu.api.machine import Machine

from ..parts.test_limit_cycle import _rotor as oil_whirler
from ..physics.test_symmetries import GRAVITY_ANGLE, image_of_machine, turned
from .machines import jeffcott, sagging

UNLIKE = {"kxx": 1e3, "kxy": 300.0, "kyx": -200.0, "kyy": -500.0, "cxx": 1.0, "cyy": 2.0}
NOTHING = {"kxx": 0.0, "kyy": 0.0, "cxx": 0.0, "cyy": 0.0}
# beyond twice the lower speed it drives a whirl that the dampers do not hold
DRIVES = NOTHING | {"speed": (100.0, 400.0), "kxy": (500.0, 2e3), "kyx": (-500.0, -2e3)}


def askew(machine, **bearing):
    """A machine with its weight askew and one bearing more."""
    parts = (*machine.rotor.parts, LinearBearing(node=2, **bearing))
    return replace(machine.rotor, gravity_angle=GRAVITY_ANGLE, parts=parts)


def of_both(rotor, at, seeds=(), width=0.01, **options):
    """The motions of a machine at a speed [rad/s], and of its mirror image at the negative one, of
    which the larger comes first, each with its response."""
    result = []
    for sense, of in ((1, rotor), (-1, image_of_machine(rotor, -1))):
        speed = sorted((sense * (1 - width) * at, sense * (1 + width) * at))
        options["seeds"] = [sense * seed for seed in seeds]
        found = rf.response(Machine(of, ""), speed=speed, step=0.4, **options)
        motions = sorted(found.at(sense * at), key=lambda m: -found.amplitude(m, "disc"))
        result.append((found, motions))
    assert len(result[0][1]) == len(result[1][1]) > 0
    return result


def whole(found, motion):
    x, y = found.series(motion, "disc", 64)
    return x + 1j * y


def assert_mirrored(motions, mirrored):
    """Of two responses and a motion of each: through the whole period, from the mark's passing on,
    and in their stability."""
    (found, motion), (image, other) = motions, mirrored
    assert other.orbit.omega == motion.orbit.omega
    expected = turned(whole(found, motion), -1)
    near = 1e-7 * np.abs(expected).max()
    assert whole(image, other) == pytest.approx(expected, rel=0, abs=near)
    assert other.is_stable == motion.is_stable
    sizes = (np.abs(m.multipliers[0]) for m in (motion, other))
    assert next(sizes) == pytest.approx(next(sizes), rel=1e-5)


@pytest.mark.parametrize(
    ("machine", "at", "seeds", "count"), [(sagging, 245.0, (), 1), (jeffcott, 151.0, (151.0,), 2)]
)
@pytest.mark.usefixtures("one_circle")
def test_a_rub_turned_the_other_way_is_the_mirrored_one(machine, at, seeds, count):
    (found, motions), (image, mirrored) = of_both(askew(machine(), **UNLIKE), at, seeds)
    assert len(motions) == count
    for motion, other in zip(motions, mirrored, strict=True):
        assert_mirrored((found, motion), (image, other))
        assert image.check(other, 20).stays == other.is_stable


def test_a_rub_turned_the_other_way_is_the_mirrored_one_by_shooting():
    shot = []
    for of, (motion, *_) in of_both(askew(sagging(), **UNLIKE), 245.0, share=1e-6):
        speed, task = motion.value, of._response.task
        equations = Shooting(task.problem(of._response.machines(), speed, 60), motion.orbit)
        x = solve(equations, equations.join(motion.orbit), speed)
        point = with_tangent(equations, x, speed, 1.0)
        shot.append((of, solution(equations, point, task.accuracy)))
    assert_mirrored(*shot)


@pytest.mark.parametrize(
    ("rotor", "at", "turns"),
    [
        (jeffcott(0.05, 20.0, 0.1, 0.0).rotor, 4.5, -1),
        (askew(jeffcott(0.05, mu=0.0), **DRIVES), 210.0, 1),
    ],
)
def test_a_whirl_turned_the_other_way_is_the_mirrored_one(rotor, at, turns):
    """Which rolls backward along its wall, or grows forward from rest; turns: its sense beside the
    positive speed's."""
    (found, motions), (image, mirrored) = of_both(rotor, at, width=0.1, whirl=True)
    for motion, other in zip(motions, mirrored, strict=True):
        assert other.orbit.omega == pytest.approx(motion.orbit.omega, rel=1e-8)
        sizes = image.amplitude(other, "disc"), found.amplitude(motion, "disc")
        assert sizes[0] == pytest.approx(sizes[1], rel=1e-6)
        assert other.is_stable == motion.is_stable
        for of, which, sense in ((found, motion, turns), (image, other, -turns)):
            z = whole(of, which) - whole(of, which).mean()
            assert np.sign((z.conj() * np.roll(z, -1)).imag.sum()) == sense


@pytest.mark.parametrize("sense", [1, -1])
def test_the_circle_from_which_an_oil_whirl_is_sought_turns_with_the_rotor(sense):
    rotor, speed = image_of_machine(oil_whirler(), sense), sense * 1400.0
    task = Task(*sorted((speed, 1.1 * speed)), is_whirl=True)
    problem = task.problem(machines_of(rotor, task), speed, 3, omega=abs(speed))
    *_, circle = guesses = list(growing_whirls(problem, speed))
    assert len(guesses) == len(_SIZES) + len(_CIRCLES)
    cosine, sine = circle.b[1:3, 0] + 1j * circle.b[1:3, 1]
    assert abs(cosine + 1j * sense * sine) < 1e-9 * abs(cosine - 1j * sense * sine)
