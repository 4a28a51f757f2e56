"""What a run came to in sentences: its peak or why it has none, its contacts, its whirl."""

import math
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu.run_status import OK
from rotor_fmu.runs.conclusions import sentences
from rotor_fmu.runs.job import execute_recorded, prepare
from rotor_fmu.runs.peaks import start_up
from rotor_fmu.runs.recording import Recording
from rotor_fmu.runs.summary import summary

from ..known import EXAMPLES

TURN = 2 * math.pi


@pytest.mark.parametrize(
    ("touches", "said"),
    [
        ((0, 0), "No journal touched."),
        ((3, 3), "for less than 1 % of the time."),
        ((998, 999), "for more than 99 % of the time."),
        ((1000, 0), "for 0 to 100 % of the time (a: 100 %, b: 0 %)."),
        ((3, 380), "for less than 1 to 38 % of the time (a: less than 1 %, b: 38 %)."),
    ],
)
def test_a_short_touch_is_not_said_to_be_none_nor_a_long_one_to_be_always(touches, said):
    t = np.arange(1001) * 0.001
    each = zip("ab", touches, strict=True)
    forces = {f"{name}.fn": 1.0 * (t > 1 - n * 0.001 + 1e-9) for name, n in each}
    _, contacts, _ = sentences(
        {"place": None, "status": OK}, Recording(t, forces, {}, {}), Path("report.html")
    )
    assert contacts.endswith(said)


@pytest.mark.parametrize(
    ("stop", "sets", "reason"),
    [
        (1.0, [], "the largest displacement is at an edge of the run"),
        (3.0, [], "the largest displacement is at an edge of the run"),
        (0.3, [], "the speed changes by at most 1 %"),
        (3.0, ["speed=185"], "the speed is constant"),
    ],
)
def test_a_run_without_a_peak_says_why(stop, sets, reason):
    job = prepare(None, None, sets, None, stop, 0.01)
    run, recording = execute_recorded(job, "")
    figures = summary(run)
    assert figures["no_peak"] == reason
    assert figures["x_peak_um"] is figures["x_peak_hz"] is None
    assert figures["x_largest_um"] > 0
    said, *_ = sentences(figures, recording, Path("report.html"))
    assert said.startswith(f"No peak, because {reason}")
    assert "moved by at most" in said


@pytest.mark.parametrize(("speed", "stop", "is_other"), [(800.0, 1.5, True), (400.0, 1.0, False)])
def test_a_motion_that_is_not_synchronous_is_told_with_its_frequency(speed, stop, is_other):
    """In oil films the shaft whips at 800 rad/s, and whirls with its unbalance at 400."""
    rotor = EXAMPLES / "oil_film" / "rotor.toml"
    run, recording = execute_recorded(
        prepare(rotor, None, [f"speed={speed}"], None, stop, None), ""
    )
    figures = summary(run, recording=recording)
    said = sentences(figures, recording, Path("report.html"))[1]
    assert said.startswith("Where it moves most it whirls ") == is_other
    if not is_other:
        assert figures["other_order"] is figures["other_hz"] is figures["other_um"] is None
        return
    late = recording.t > 0.5 * stop
    t, z = recording.t[late], recording.place(figures["place"]).z[late]
    laps = np.ptp(np.unwrap(np.angle(z - z.mean()))) / TURN
    assert figures["other_hz"] == pytest.approx(laps / (t[-1] - t[0]), rel=0.02)
    assert figures["other_order"] == pytest.approx(figures["other_hz"] * TURN / speed)
    assert figures["other_um"] == pytest.approx(1e6 * np.abs(z - z.mean()).max(), rel=0.2)
    assert "it whirls forward at 0." in said


def test_how_far_a_place_moved_is_told_of_the_way_that_it_went_farthest():
    """On the rig at 200 rad/s 649 um, though at most 589 um along either axis."""
    run, recording = execute_recorded(prepare(None, None, ["speed=200"], None, 2.0, None), "")
    figures = summary(run)
    away = np.abs(recording.place(figures["place"]).z - recording.place(figures["place"]).z[0])
    farthest = 1e6 * away[recording.t > start_up(recording.t, recording.w)].max()
    assert farthest > 1.05 * max(figures["x_largest_um"], figures["y_largest_um"])
    assert figures["r_largest_um"] == pytest.approx(farthest, rel=1e-3)
    said, *_ = sentences(figures, recording, Path("report.html"))
    assert f"moved by at most {figures['r_largest_um']:.0f} um from rest" in said


@pytest.mark.parametrize(
    ("sets", "reason"),
    [
        (["solver.max_iterations=12"], "the run stopped in its first communication step"),
        (["solver.max_iterations=300"], "the run stopped at 0.01 s, before its end"),
    ],
)
def test_a_run_that_failed_has_no_peak_because_it_stopped(sets, reason, capsys):
    job = prepare(None, None, sets, None, None, 0.01)
    assert summary(execute_recorded(job, "")[0])["no_peak"] == reason
    capsys.readouterr()
