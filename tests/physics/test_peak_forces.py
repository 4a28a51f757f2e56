"""The largest contact force, although a touch may be shorter than the time between two rows."""

import math
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop.recorder import Record

from rotor_fmu.api.machine import Machine
from rotor_fmu.api.simulate import simulate
from rotor_fmu.report.report_tables import tables
from rotor_fmu.run_pictures.signal_plots import contact_force
from rotor_fmu.run_pictures.view import View
from rotor_fmu.runs.conclusions import sentences
from rotor_fmu.runs.summary import last_contact

from ..parts.machines import bouncing

SPEED = 101.0
TURN = 2 * math.pi / SPEED
HARD = bouncing()
ROUNDING = 1e-9


@pytest.mark.parametrize(
    ("rotor", "contact"),
    [(parse_rotor(HARD), "contact[1]"), (rig(), "bearing[1]")],
    ids=["hard", "rig"],
)
def test_it_is_the_largest_of_all_steps_over_the_last_revolutions(rotor, contact):
    record = Record((f"{contact}.fn",), angle=0.0, rows=2**16)
    sim = Simulation(rotor, choose("controlled"), speed=SPEED, record=record)
    rows, touched = np.zeros((0, 2)), 0
    for i in range(1, 61):
        sim.advance(0.4 * i * TURN, SPEED)
        rows = np.concatenate([rows, sim.drain()])
        shown = sim.read(f"{contact}.fn_peak")
        for turns, least in ((1.0, True), (2.0, False)):
            fn = rows[rows[:, 0] >= sim.time - turns * TURN * (1 + ROUNDING), 1].max()
            difference = (shown - fn) * (1 if least else -1)
            assert difference >= -ROUNDING * max(shown, fn), (i, turns)
        touched += shown > 0
    assert touched > 20


@cache
def bounces(per_turn):
    rotor = parse_rotor(HARD)
    return simulate(
        Machine(rotor, ""), speed=SPEED, stop=40 * TURN, tolerance=1e-4, per_turn=per_turn
    )


def test_a_report_and_its_pictures_tell_it_of_a_recording_of_64_rows_a_turn():
    largest = bounces(None)["contact[1].fn"].max()
    run = bounces(64).recording
    assert run.columns["contact[1].fn"].max() < 0.8 * largest
    _, row = re.findall("<td[^>]*>contact 1</td>(.*?)</tr>", tables(run, {}))
    force, speed, _ = re.findall("<td[^>]*>([^<]*)</td>", row)
    assert float(force) == pytest.approx(largest, rel=2e-3)
    assert float(speed) == pytest.approx(SPEED / (2 * math.pi), rel=2e-3)
    (line, *_) = contact_force(View(run)).axes[0].lines
    assert np.nanmax(line.get_ydata()) == pytest.approx(largest, rel=ROUNDING)


def test_a_touch_between_all_rows_is_known():
    run = bounces(64).recording
    never = run.columns | {"contact[1].fn": 0.0 * run.t}
    run = type(run)(run.t, never, run.units, run.about)
    figures = {"place": None, "status": "ok"}
    _, contacts, _ = sentences(figures, run, Path("report.html"))
    assert contacts.startswith("Journals touched, but too shortly")
    assert last_contact({"first.psi": run.t, "first.fn": 0.0 * run.t} | never) == "contact[1]"
    assert contact_force(View(run)).axes[0].get_title("left").endswith("of contact 1")


@pytest.mark.parametrize("force", [200.0, 400.0])
def test_at_standstill_no_force_is_lost_between_a_row_and_a_communication_point(force):
    machine = Machine(parse_rotor(HARD + "[[port]]\nnode = 2\n"), "")
    t = np.linspace(0.0, 0.5, 51)
    loads = {"port[1].fx": (t, np.where(np.arange(51) % 6 < 3, force, -force))}
    largest, shown = (
        simulate(machine, speed=0.0, loads=loads, step=1e-3, per_turn=rows)["contact[1].fn_peak"]
        for rows in (None, 64)
    )
    assert shown.max() == largest.max() > 10.0
