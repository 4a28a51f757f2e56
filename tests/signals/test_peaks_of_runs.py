"""Where a run is largest: after its start-up, and within its speeds."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu.api.result import Result
from rotor_fmu.display import choose, restored
from rotor_fmu.report.report_tables import tables
from rotor_fmu.report.run_data import run_data
from rotor_fmu.run_pictures.run_folder import distance_from_start
from rotor_fmu.run_pictures.view import View
from rotor_fmu.run_status import OK
from rotor_fmu.runs.conclusions import sentences
from rotor_fmu.runs.job import execute_recorded, prepare
from rotor_fmu.runs.peaks import is_constant, largest_row, peak_index, start_up, why_no_peak
from rotor_fmu.runs.recording import Recording
from rotor_fmu.runs.run_down import Run
from rotor_fmu.runs.summary import summary, touching

from ..recordings import recorded

TURN = 2 * math.pi


@pytest.mark.parametrize(
    ("amplitude", "expected"),
    [
        (lambda t: np.exp(-((t - 6) ** 2)), 6.0),
        (lambda t: 3e-13 * np.exp(-((t - 6) ** 2)), None),  # rounding
        (lambda t: t, None),
        (lambda t: -t, None),
        (lambda t: np.minimum(t, 9.95), None),  # the last turn's maximum at the end
        (lambda t: np.where(t < 1, 10.0, np.exp(-((t - 6) ** 2))), 6.0),  # a start-up
    ],
)
def test_an_amplitude_that_is_largest_at_an_edge_has_no_peak(amplitude, expected):
    t = np.linspace(0, 10, 1001)
    w = 400 - 20 * t
    at = peak_index(t, w, amplitude(t))
    assert (None if at is None else pytest.approx(t[at])) == expected
    assert peak_index(t, np.full_like(t, 100.0), amplitude(t)) is None


def test_a_balanced_machine_is_said_not_to_move():
    t = np.linspace(0, 10, 1001)
    assert why_no_peak(t, 400 - 20 * t, OK, largest=3e-13) == "nothing moves"


def test_a_picture_marks_no_peak_of_rounding():
    t = np.linspace(0, 10, 1001)
    columns = {"w": 400 - 20 * t, "disc[1].x_amp": 3e-13 * np.exp(-((t - 6) ** 2))}
    run = Run(t, columns, OK, (), 0.0)
    (legend,) = distance_from_start(run, "disc[1]", "x", "").legends
    assert legend.get_texts()[-1].get_text() == "this run"


@pytest.mark.parametrize(("down", "sense"), [(1.5 * math.pi, 1), (0.0, 1), (2.5, 1), (1.2, -1)])
def test_a_journal_goes_all_round_whichever_way_is_down(down, sense):
    """Between 30 and 20 Hz; before and after it rocks about its rest, up to 122 degrees ahead and
    46 back, as the rig's does just below the speed at which it first goes round."""
    t = np.linspace(0.0, 40.0, 40001)
    hz = 40 - t
    swing = np.where((hz < 30) & (hz > 20), 50 * t, 0.66 + 1.47 * np.sin(50 * t))
    swing[0] = 0.0
    figures = {"w": sense * TURN * hz, "b.psi": (down + sense * swing) % TURN, "b.fn": 0 * t + 1}
    made = summary_of_signals(t, figures)["circulation_hz"]
    assert np.sort(np.abs(made)) == pytest.approx([20.0, 30.0], abs=0.2)


def test_the_page_and_the_summary_give_one_share_of_the_time_in_contact():
    t = np.array([0.0, 1.0, 1.5, 4.0])
    columns = {"phi": 100 * t, "w": 100 + 0 * t, "bearing[1].fn": np.array([0.0, 1.0, 0.0, 2.0])}
    run = Recording(t, columns, {}, {})
    assert touching(run) == {"bearing[1]": 0.875}
    assert "<td>87.5</td>" in tables(run, {})


def test_a_spindle_that_runs_down_in_three_seconds_has_its_peak_within_the_first_two():
    t = np.linspace(0, 3, 3001)
    w = 6000 - 2000 * t
    amplitude = np.where(t < 0.1, 10.0, np.exp(-(((t - 1.55) / 0.1) ** 2)))
    assert t[peak_index(t, w, amplitude)] == pytest.approx(1.55)


@pytest.mark.parametrize(
    ("w", "at", "is_peak"),
    [
        (lambda t: 100 * (1 + (t / 30) ** 8), 29.8, False),  # within a hundredth of the end
        (lambda t: 100 * (1 + (t / 30) ** 8), 29.5, True),
        (lambda t: 2 - t / 30, 27.2, False),  # 3 s of its turns of 6 s
        (lambda t: 2 - t / 30, 26.8, True),
        (lambda t: 20 + np.maximum(100 - 10 * t, 0), 20.0, False),  # at the lowest speed, held
    ],
)
def test_a_peak_is_away_from_the_ends_of_the_run_and_of_its_speeds(w, at, is_peak):
    t = np.linspace(0, 30, 3001)
    found = peak_index(t, w(t), 9 - abs(t - at))
    assert (found is not None) == is_peak
    assert not is_peak or t[found] == pytest.approx(at)


def test_what_is_largest_while_the_highest_speed_is_held_is_no_peak():
    t = np.linspace(0, 20, 2001)
    w = np.minimum(20 * t, 300.0)
    assert peak_index(t, w, w + (t > 17) * (t < 18)) is None
    assert t[peak_index(t, w, 9 - abs(t - 9))] == pytest.approx(9)


def test_one_speed_is_told_from_many():
    assert is_constant(np.full(5, 100.0))
    assert is_constant(np.zeros(5))
    assert not is_constant(np.linspace(100, 90, 5))


def test_rounding_is_no_energy_error_of_a_rotor_that_stands():
    """Of what it dissipated, 3e-17 J, the ledger's rounding is 22 times as much."""
    run, _ = execute_recorded(prepare(None, None, ["speed=0"], None, 0.5, None), "")
    assert 0 < run.columns["energy.structure_loss"][-1] < 1e-15
    assert summary(run)["energy_residual"] is None


def test_what_feeds_a_whirl_is_not_taken_from_the_energy_dissipated():
    """Cross coupling that feeds a whirl with as much as dampers take."""
    last = {"w": 300.0, "solver.steps": 10.0, "energy.kinetic": 5e3, "energy.residual": -0.005}
    last |= {"energy.bearings_loss": 15.4, "energy.circulation_loss": -15.38}
    names = ("rejected", "newton", "h_min_used", "h_max_used", "h_last", "trapped", "overdamped_at")
    columns = {name: np.full(2, value) for name, value in last.items()}
    columns |= {f"solver.{name}": np.zeros(2) for name in names}
    run = Run(np.array([0.0, 1.0]), columns, OK, (), 0.0)
    assert summary(run)["energy_residual"] == pytest.approx(-0.005 / 15.4)


def test_shares_of_sinks_are_of_what_is_dissipated():
    """Friction takes 2 W, structure 0.5 W, and cross coupling feeds the whirl with 2.4 W."""
    run = recorded()
    fed = {"energy.circulation_loss": -2.4 * run.t}
    text = tables(replace(run, columns=run.columns | fed), {})
    named = re.findall(r"<td[^>]*>(friction|structure|circulation)</td>(.*?)</tr>", text)
    shares = {sink: float(re.findall(r">([^<]+)</td>", row)[-1]) for sink, row in named}
    assert shares == {"friction": 80.0, "structure": 20.0, "circulation": -96.0}


def test_the_start_up_of_a_fast_machine_lasts_some_turns_not_a_share_of_the_run():
    """A resonance at 90 % of the first speed is passed long after the transient of the start."""
    t = np.linspace(0.0, 0.4, 4001)
    w = 40e3 * (1 - t / 0.4)
    amplitude = 1 / np.hypot(1 - (w / 36e3) ** 2, 0.04)
    at = peak_index(t, w, amplitude)
    assert at is not None
    assert w[at] == pytest.approx(36e3, rel=1e-2)
    slow = np.full(len(t), 400.0)
    assert start_up(100 * t, slow) == pytest.approx(125 * 2 * math.pi / 400, rel=0.02)
    assert start_up(t, slow) == pytest.approx(0.08)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_the_start_up_lasts_as_many_turns_of_a_slow_machine_as_of_a_fast_one(scale):
    """A generator at 60 rpm has its 125 turns after two minutes; a run-up to the same speed does
    not wait until it has turned as often from rest."""
    t = np.linspace(0.0, 1000.0, 2001) / scale
    w = np.full(len(t), TURN * scale)
    assert start_up(t, w) == pytest.approx(125 / scale)
    assert start_up(t, w * t / t[-1]) == pytest.approx(125 / scale)
    assert start_up(t, 0 * w) == pytest.approx(0.2 * t[-1])


def test_a_run_that_begins_at_another_time_has_the_same_start_up_and_peak():
    """As of a host whose experiment begins later, or before 0, at a peak more or less than a
    tenth of it from the end."""
    for end in (19.0, 20.5):
        t = np.linspace(2.0, 22.0, 4001)
        w = 0.5 + 0.05 * t
        amplitude = 9 - abs(t - end)
        at = peak_index(t - 2.0, w, amplitude)
        assert (at is None) == (end > 20.0)
        for begin in (-1000.0, 1000.0):
            assert start_up(t + begin, w) == pytest.approx(begin + 2.0 + start_up(t - 2.0, w))
            assert peak_index(t + begin, w, amplitude) == at
            assert "at an edge" in why_no_peak(t + begin, w, "ok")
            assert "first communication step" in why_no_peak(t[:1] + begin, w[:1], "ok")


def summary_of_signals(t, signals, recording=None):
    """The figures of a run with these signals, by a solver that did nothing."""
    solver = ("steps", "rejected", "newton", "h_min_used", "h_max_used", "h_last", "trapped")
    work = {f"solver.{name}": 0 * t for name in (*solver, "trapped_at", "overdamped_at")}
    run = Run(t, work | {"energy.residual": 0 * t} | signals, OK, (), 0.0)
    return summary(run, recording=recording)


@pytest.mark.parametrize("middle", [5.0, 0.0])
def test_the_range_of_a_contact_angle_is_that_of_all_rows_even_across_0(middle):
    """It swings by 0.5 rad, and by nothing as a communication point sees it every tenth cycle."""

    def signals(step):
        t = np.arange(0.0, 40.0, step)
        w = 400 - 10 * t
        size = np.exp(-(((w - 200) / 20) ** 2))
        columns = {"phi": 400 * t - 5 * t**2, "w": w, "wall.fn": 0 * t + 1}
        columns |= {f"disc.{axis}_amp": size for axis in "xyr"} | {"disc.x": 0 * t, "disc.y": 0 * t}
        return t, columns | {"wall.psi": (middle + 0.5 * np.sin(500 * math.pi * t)) % TURN}

    figures = summary_of_signals(*signals(0.04), Recording(*signals(1e-4), {}, {}))
    low, high = np.radians(figures["psi_at_x_peak_deg"])
    assert (low, high) == pytest.approx(
        ((middle - 0.5) % TURN, (middle - 0.5) % TURN + 1), abs=1e-3
    )


def test_the_range_of_a_contact_angle_is_of_rows_with_a_contact():
    """A journal goes all round its bearing, and touches it between 4 and 5 rad; or not at the
    peak."""
    t = np.arange(0.0, 40.0, 1e-4)
    w = 400 - 10 * t
    psi = (500 * t) % TURN
    touches = (psi >= 4.0) & (psi <= 5.0)
    columns = {"phi": 400 * t - 5 * t**2, "w": w, "wall.psi": psi}
    columns |= {f"disc.{axis}_amp": np.exp(-(((w - 200) / 20) ** 2)) for axis in "xyr"}
    columns |= {"disc.x": 0 * t, "disc.y": 0 * t}
    figures = summary_of_signals(t, columns | {"wall.fn": 1.0 * touches})
    assert np.radians(figures["psi_at_x_peak_deg"]) == pytest.approx([4.0, 5.0], abs=0.05)
    figures = summary_of_signals(t, columns | {"wall.fn": 1.0 * (touches & (w < 100))})
    assert figures["psi_at_x_peak_deg"] is None


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_the_figures_of_a_run_scale_with_its_speed(scale):
    def figures(scale):
        t = np.linspace(0.0, 40.0, 4001)
        w = 400 - 10 * t
        columns = {"w": scale * w}
        columns |= {f"disc.{axis}": np.cos(10 * t) for axis in "xy"}
        columns |= {f"disc.{axis}_amp": np.exp(-(((w - 200) / 20) ** 2)) for axis in "xyr"}
        columns |= {"wall.psi": t, "wall.fn": np.ones(len(t))}
        return summary_of_signals(t / scale, columns)

    at_one, scaled = figures(1.0), figures(scale)
    assert at_one["psi_at_x_peak_deg"] == pytest.approx(np.degrees([19.9, 20.1]) - 3 * 360)
    assert scaled["psi_at_x_peak_deg"] == pytest.approx(at_one["psi_at_x_peak_deg"], abs=0.6)
    assert scaled["x_peak_hz"] == pytest.approx(scale * at_one["x_peak_hz"])
    said = sentences(scaled, recorded(), Path("report.html"))[0]
    shown = {1e-3: "at 0.0318 Hz (1.91 rpm)", 1e3: "at 31831.0 Hz (1909859 rpm)"}
    assert shown[scale] in said
    with restored():
        choose("rpm")
        said = sentences(scaled, recorded(), Path("report.html"))[0]
    assert re.sub(r"at (.*) \((.*)\)", r"at \2 (\1)", shown[scale]) in said


def test_what_is_largest_is_sought_after_the_start_up():
    """By the plots, the page's table and the speed at which the page opens; where the rows show it
    in the start-up alone, it is the largest there."""
    run = recorded()
    size = np.where(run.t < 0.6, 20.0, 1 + np.exp(-(((run.t - 4) / 0.3) ** 2)))
    moved = {f"disc[2].{axis}": size * run.columns[f"disc[2].{axis}"] for axis in "xy"}
    run = Recording(run.t, run.columns | moved, run.units, run.about)
    assert View(run, "disc[2]").speed == pytest.approx(300 - 20 * 4, abs=2)
    (largest,) = (p["largest"] for p in run_data(run)["places"] if p["name"] == "disc[2]")
    assert largest == pytest.approx(4, abs=0.1)
    (row,) = re.findall("<td[^>]*>disc 2</td>(.*?)</tr>", tables(run, {}))
    _, at, _, x, *_ = re.findall("<td[^>]*>([^<]*)</td>", row)
    assert float(at) == pytest.approx(View(run, "disc[2]").speed / TURN, rel=1e-4)
    assert float(x) == pytest.approx(2 * 200, rel=0.05)
    t, amplitude = np.arange(4.0), np.array([1.0, 3.0, math.nan, math.nan])
    assert largest_row(t, amplitude, 1.5) == 1
    assert largest_row(t, amplitude[::-1], 1.5) == 2


def test_a_transient_in_the_first_turns_is_not_in_the_displacements_of_slow_turns():
    """Sixteen turns of a hydro generator take ten seconds, its start-up two."""
    run = recorded(stop=120.0, step=0.01, speed=10.5, rate=-0.05)
    size = np.where(run.t < 1.0, 5.0, 1.0)
    moved = {f"disc[2].{axis}": size * run.columns[f"disc[2].{axis}"] for axis in "xy"}
    run = Recording(run.t, run.columns | moved, run.units, run.about)
    (row,) = re.findall("<td[^>]*>disc 2</td>(.*?)</tr>", tables(run, {}))
    *_, s_max = (float(cell) for cell in re.findall("<td[^>]*>([0-9.]+)</td>", row))
    assert s_max == pytest.approx(100, rel=0.01)


def test_a_result_shows_the_peaks_of_the_part_that_has_the_largest_one():
    t = np.linspace(0, 10, 1001)
    sizes = {"disc[1].x": 3e-4, "disc[1].y": 2e-4, "disc[2].x": 1e-5, "disc[2].y": 2e-5}
    shapes = {f"{name}_amp": size * np.exp(-((t - 6) ** 2)) for name, size in sizes.items()}
    result = Result(recorded(), Run(t, {"w": 400 - 20 * t, **shapes}, OK, (), 0.0))
    shown = repr(result)
    assert "peak of disc[1].x: 300 µm at 280 rad/s; peak of disc[1].y: 200 µm" in shown
    assert "disc[2]" not in shown
    with restored():
        choose("us")
        assert "peak of disc[1].x: 11.81 mil at 2674 rpm" in repr(result)
