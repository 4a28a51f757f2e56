"""What the recorder keeps is what the run was, and the run does not feel it."""

import math

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop.observe import observed_names
from rotor_fmu.model.time_loop.recorder import Record, recordable

from ..machines import disc_dofs

SPEED = 185.0  # in the rig's resonance, where it rubs [rad/s]
NAMES = ("phi", "w", "disc[3].x", "disc[3].vy", "bearing[2].psi", "bearing[2].fn")
EVERYTHING = tuple(str(entry.name) for entry in recordable(rig()))
TURN = 2 * math.pi


def rubbing(record=(), preset="robust", speed=SPEED, **settings):
    return Simulation(rig(), choose(preset, **settings), speed=speed, record=record)


def test_a_row_is_what_can_be_read_after_the_step():
    sim = rubbing(Record(EVERYTHING, 0.0))
    h = sim.settings.h
    assert np.array_equal(
        sim.drain(), [[0.0, *sim.observed, *np.zeros(len(EVERYTHING) - len(sim.names))]]
    )
    for i in range(1, 200):
        sim.advance(i * h, SPEED)
        (row,) = sim.drain()
        assert row[0] == sim.time
        assert np.array_equal(row[1 : 1 + len(sim.names)], sim.observed)


def test_velocities_can_be_recorded_of_every_probe():
    sim = rubbing(Record(EVERYTHING, 0.0))
    sim.advance(0.3, SPEED)
    last = dict(zip(EVERYTHING, sim.drain()[-1, 1:], strict=True))
    for i, dof in enumerate(disc_dofs(sim.rotor), 1):
        assert complex(last[f"disc[{i}].vx"], last[f"disc[{i}].vy"]) == sim.motion.v[dof]


@pytest.mark.parametrize("preset", ["controlled", "robust", "paper-adaptive"])
def test_a_run_has_the_same_numbers_whether_it_is_recorded_or_not(preset):
    states = []
    for record in ((), NAMES, Record(EVERYTHING, 0.0, 2)):
        sim = rubbing(record, preset)
        for i in range(1, 26):
            sim.advance(0.02 * i, SPEED - 0.2 * i)
        states.append((sim.snapshot().tobytes(), sim.observed.tobytes()))
    assert states[0] == states[1] == states[2]


def test_every_step_is_recorded_where_that_is_asked_for():
    sim = rubbing(Record(("solver.steps",), 0.0, 100_000), "controlled")
    sim.advance(0.5, SPEED)
    rows = sim.drain()
    assert np.array_equal(rows[:, 1], np.arange(sim.read("solver.steps") + 1))
    assert (np.diff(rows[:, 0]) > 0).all()
    assert len(sim.drain()) == 0


@pytest.mark.parametrize("per_turn", [16, 64, 200])
def test_there_are_as_many_rows_a_turn_as_were_asked_for(per_turn):
    speed = 250.0  # faster than the lowest mode
    sim = rubbing(Record(("phi",), TURN / per_turn, 100_000), speed=speed, h=TURN / speed / 333)
    for i in range(1, 11):
        sim.advance(0.1 * i, speed)
    phi = sim.drain()[:, 1]
    assert len(phi) == pytest.approx(per_turn * phi[-1] / TURN, rel=0.01)
    assert np.diff(phi).max() < TURN / per_turn + TURN / 330


def test_steps_longer_than_the_angle_are_all_recorded():
    sim = rubbing(NAMES, "paper")
    sim.advance(1.0, SPEED)
    assert len(sim.drain()) == sim.read("solver.steps") + 1


def test_a_rotor_that_stands_still_is_recorded_by_its_lowest_mode():
    sim = rubbing(Record(("w", "disc[3].x"), TURN / 64), speed=0.0)
    force = np.zeros(4, complex)
    force[2] = 5.0
    sim.advance(0.5, 0.0, force)
    x = sim.drain()[:, 2]
    assert np.ptp(x) > 1e-6
    per_cycle = len(x) / (0.5 * sim.structure.numbers[0].lowest_omega / TURN)
    assert 40 < per_cycle < 65


@pytest.mark.parametrize(
    ("angle", "preset"), [(0.0, "controlled"), (TURN / 64, "controlled"), (TURN / 500, "robust")]
)
def test_a_full_tape_drops_every_second_row_and_goes_on_at_even_distances(angle, preset):
    whole, short = (
        rubbing(Record(("phi", "disc[3].x"), angle, rows), preset) for rows in (100_000, 32)
    )
    for sim in (whole, short):
        sim.advance(2.0, SPEED)
    every, retained = whole.drain(), short.drain()
    assert 16 <= len(retained) <= 32
    assert set(map(tuple, retained)) <= set(map(tuple, whole_rows(preset)))
    assert np.array_equal(retained[0], every[0])
    assert retained[-1, 0] > 2.0 * (1 - 2 / len(retained))
    gaps = np.diff(retained[:, 1])
    assert gaps.max() < 1.5 * gaps.min()
    # emptied, it begins anew at the angle that was asked for
    short.advance(2.002, SPEED)
    whole.advance(2.002, SPEED)
    assert abs(len(short.drain()) - len(whole.drain())) <= 1


def whole_rows(preset):
    sim = rubbing(Record(("phi", "disc[3].x"), 0.0, 100_000), preset)
    sim.advance(2.0, SPEED)
    return sim.drain()


def test_a_restored_run_records_its_second_way_alone():
    first, twice = rubbing(Record(NAMES, 0.0)), rubbing(Record(NAMES, 0.0))
    for sim in (first, twice):
        sim.advance(0.1, SPEED)
    before = twice.snapshot()
    twice.advance(0.13, 0.9 * SPEED)
    twice.restore(before)
    for sim in (first, twice):
        sim.advance(0.2, SPEED)
    assert np.array_equal(first.drain(), twice.drain())


def test_what_cannot_be_recorded_is_refused_by_its_name():
    with pytest.raises(
        ValueError, match=r"record: 'disc\[3\].xx' is unknown; the nearest name is disc\[3\]\.v?x"
    ):
        rubbing(("phi", "disc[3].xx"))
    with pytest.raises(ValueError, match=r"angle = -1\.0 rad: must be >= 0"):
        rubbing(Record(("phi",), -1.0))
    with pytest.raises(ValueError, match="rows = 3: must be an even number"):
        rubbing(Record(("phi",), 0.0, 3))


def test_what_can_be_read_can_be_recorded():
    assert EVERYTHING[: len(observed_names(rig()))] == observed_names(rig())
    assert len(set(EVERYTHING)) == len(EVERYTHING)
