"""The jumps of a rotor that rubs all the way round, run up and down through its FMU, against the
closed form of the full annular rub."""

import math
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu.cosimulation.member import Member
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build

MACHINE = Path(__file__).parents[2] / "examples" / "jeffcott_rub" / "jeffcott.toml"
FOLD = 2.02208  # over the natural frequency of 100 rad/s: the discriminant's zero
E, ZETA = 0.5, 0.1  # eccentricity in clearances, damping
HELD = 1.0  # 100 over the natural frequency [s]


@pytest.fixture(scope="module")
def radii(tmp_path_factory):
    """Radius in clearances after each of a list of speeds [rad/s] has been held."""
    fmu = build(tmp_path_factory.mktemp("fold"), machine_of(MACHINE.read_text(encoding="utf-8")))

    def result(speeds):
        seen = []
        held = {"speed": speeds[0], "speed_continuation": 1}
        with Member(fmu, held, []) as rotor:
            rotor.begin()
            for n, speed in enumerate(speeds):
                rotor.set({"speed": speed})
                rotor.step(n * HELD, HELD)
                seen.append(math.hypot(*rotor.get(["disc.x", "disc.y"]).values()) / 1e-3)
        return np.array(seen)

    return result


def jump(speeds, seen):
    """Between which speeds the radius changes most [rad/s]."""
    at = int(np.argmax(np.abs(np.diff(seen))))
    return 0.5 * (speeds[at] + speeds[at + 1])


def test_run_up_through_the_fmu_the_rub_ends_at_its_fold_within_a_percent(radii):
    # begun where nothing but the rub exists
    speeds = np.array([120.0, 140.0, 160.0, 180.0, 190.0, *np.arange(196.0, 210.0, 0.5)])
    seen = radii(speeds)
    # closed form, stable branch
    assert seen[[0, 1, 3]] == pytest.approx([1.296981, 1.580638, 2.777077], rel=1e-3)
    assert jump(speeds, seen) / 100 == pytest.approx(FOLD, rel=0.01)


def test_run_down_through_the_fmu_the_rub_begins_where_the_free_whirl_fills_the_clearance(radii):
    # (e w^2)^2 = (1 - w^2)^2 + (2 zeta w)^2, the larger root
    a, b = 1 - E**2, 2 * ZETA**2 - 1
    touching = math.sqrt((-b + math.sqrt(b * b - a)) / a)
    speeds = np.array([230.0, 200.0, 180.0, 160.0, 150.0, *np.arange(146.0, 132.0, -0.5)])
    seen = radii(speeds)
    free = E * 4.0 / math.hypot(1 - 4.0, 2 * ZETA * 2.0)
    assert seen[1] == pytest.approx(free, rel=1e-3)
    assert jump(speeds, seen) / 100 == pytest.approx(touching, rel=0.01)
