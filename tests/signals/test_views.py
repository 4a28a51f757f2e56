"""Pictures of runs draw the run, not where it was sampled."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.text import Text
from rotor_fmu.model.time_loop.recorder import Record

from rotor_fmu import vibration
from rotor_fmu.display import choose, restored
from rotor_fmu.errors import InputError
from rotor_fmu.plotting.figure_style import broken_at_turns, new_figure
from rotor_fmu.report.report_tables import tables
from rotor_fmu.report.run_data import run_data
from rotor_fmu.run_pictures.run_folder import distance_axes, spectra, write_run_pictures
from rotor_fmu.run_pictures.signal_plots import (
    cascade,
    contact_angle,
    contact_force,
    polar,
    spectrum,
)
from rotor_fmu.run_pictures.view import View, speed_axis
from rotor_fmu.runs.conclusions import sentences
from rotor_fmu.runs.input_signals import Signals
from rotor_fmu.runs.job import prepare
from rotor_fmu.runs.measuring_points import probe_that_moves_most
from rotor_fmu.runs.recording import Recording
from rotor_fmu.runs.run_down import Run, run_recorded
from rotor_fmu.runs.run_files import clear
from rotor_fmu.runs.summary import last_contact

from ..recordings import recorded

TURN = 2 * math.pi
NAMES = ("bearing[2].x", "bearing[2].y", "bearing[2].psi")


def sampled(recording: Recording, rate: float) -> Recording:
    """The rows nearest to equal times, as an FMU's host has them."""
    even = np.arange(recording.t[0], recording.t[-1], 1 / rate)
    rows = np.searchsorted(recording.t, even)
    columns = {name: column[rows] for name, column in recording.columns.items()}
    return Recording(recording.t[rows], columns, recording.units, {})


def test_a_phase_about_180_degrees_is_drawn_to_the_edge_on_both_sides():
    """Each of its points stays, however often it passes the edge; the curve is broken there."""
    speed = np.arange(5.0)
    angle = np.radians([170.0, -170.0, 175.0, 178.0, -178.0])
    over, phase = broken_at_turns(speed, angle)
    assert np.isin(np.degrees(angle), phase).all()
    assert np.isnan(phase).sum() == 3
    assert over[[1, 3]] == pytest.approx(0.5)
    assert phase[[1, 3]].tolist() == [180.0, -180.0]
    assert np.nanmax(np.abs(np.diff(phase))) < 15.0


@pytest.fixture(scope="module")
def past_50_hz():
    """Through 50 Hz, 250 Hz over 5, at 64 and at 150 rows a turn, and at every step."""
    job = prepare(None, None, ["solver.tolerance=1e-4"], None, 4.0, 0.04)
    t = np.array([0.0, 1.0, 4.0])
    speed = TURN * np.array([52.0, 52.0, 48.0])
    constant = {name: np.zeros(3) for name in job.signals.values}
    signals = Signals(t, constant | {"speed": speed})
    plan = prepare(None, None, ["solver.tolerance=1e-4", f"speed={speed[0]}"], None, 4.0, 0.04)
    plan = type(plan)(**{**vars(plan), "signals": signals})

    def at(angle):
        recording = run_recorded(plan, Record(NAMES, angle, 100_000))[1]
        late = recording.t > 1.0
        columns = {name: column[late] for name, column in recording.columns.items()}
        return Recording(recording.t[late], columns, recording.units, {})

    return at(TURN / 64), at(TURN / 150), at(0.0)


def test_the_contact_that_is_shown_is_the_last_one_that_touches():
    columns = recorded().columns
    idle = {"labyrinth.psi": columns["bearing[1].psi"], "labyrinth.fn": 0 * columns["phi"]}
    assert last_contact(columns | idle) == "bearing[1]"
    faint = {"bearing[1].fn": 1e-3 * columns["bearing[1].fn"]}
    assert last_contact(columns | idle | faint) == "bearing[1]"
    assert last_contact(idle) == "labyrinth"
    assert last_contact({"phi": columns["phi"]}) is None


def test_where_nothing_touches_the_picture_says_so_over_the_speeds_of_the_run():
    run = recorded()
    quiet = Recording(run.t, run.columns | {"bearing[1].fn": 0 * run.t}, run.units, {})
    axes = contact_angle(View(quiet, "bearing[1]")).axes[0]
    assert axes.get_title("left").endswith("where bearing 1 touches: nowhere in this run")
    low, high = axes.get_xlim()
    assert low < run.w.min() / TURN < run.w.max() / TURN < high


def test_surfaces_that_touch_through_a_film_have_a_force_in_pictures_and_no_angle():
    run = recorded()
    film = {"damper.fn": 2 * run.columns["bearing[1].fn"]}
    both = Recording(run.t, run.columns | film, run.units, {})
    force, angle = contact_force(View(both)), contact_angle(View(both))
    assert force.axes[0].get_title("left").endswith("contact force of damper")
    assert not angle.axes[0].get_title("left").endswith("where damper touches")
    shares = [vibration.contact(run.t, run.phi, c.psi, c.fn).share for c in both.contacts]
    np.testing.assert_array_equal(shares[0], shares[-1])
    assert run_data(both)["touches"][-1]["label"] == "damper"
    alone = Recording(run.t, {"phi": run.phi} | film, run.units, {})
    with pytest.raises(InputError, match="has no contact angle"):
        contact_angle(View(alone))


def apart(one, other):
    """Share of the time by which two pictures differ, at each speed [1]."""
    bins = {"speeds": 40, "angles": 36}
    shares = [
        vibration.time_share(run.t, run.w, run.place("bearing[2]").z, **bins).share
        for run in (one, other)
    ]
    return 0.5 * np.abs(shares[0] - shares[1]).sum(axis=1)


def test_contact_angles_do_not_depend_on_the_rate_of_recording(past_50_hz):
    at_64, at_150, every = past_50_hz
    assert len(every.t) > 1.3 * len(at_64.t)
    for other in (at_150, every):
        assert apart(at_64, other).max() < 0.05


def test_samples_at_250_hz_show_islands_at_50_hz_which_the_recording_has_not(past_50_hz):
    at_64, _, every = past_50_hz
    as_sampled = apart(sampled(every, 250.0), every)
    assert as_sampled.max() > 5 * apart(at_64, every).max()


def test_a_spectrum_tells_amplitude_and_frequency_of_unevenly_sampled_sines():
    rng = np.random.default_rng(1)
    t = np.sort(rng.uniform(0, 4, 20_000))
    f, lines = vibration.spectrum(
        t, 3.0 + 2.0 * np.sin(TURN * 25 * t) + 0.1 * np.sin(TURN * 60 * t)
    )
    for hz, size in ((25, 2.0), (60, 0.1)):
        near = np.abs(f - hz) < 1
        assert lines[near].max() == pytest.approx(size, rel=0.02)
    assert lines[0] < 0.01


def test_spectra_of_a_run_whose_speed_does_not_go_one_way_are_drawn_over_time():
    """One that goes up to 300 rad/s in 3 s and down again: the first 16 turns take 1.42 s."""
    run = recorded(step=2e-3)
    w = 100.0 * np.minimum(run.t, 6.0 - run.t)
    phi = np.cumsum(w) * 2e-3
    moves = {"disc[2].x": 4e-5 * np.cos(phi), "disc[2].y": 4e-5 * np.sin(phi)}
    both = Recording(run.t, run.columns | {"phi": phi, "w": w} | moves, run.units, {})
    axes = cascade(View(both, "disc[2]")).axes[0]
    assert axes.get_title("left").endswith("waterfall of the full spectrum of disc 2")
    assert axes.get_ylabel() == "Time [s]"
    assert {text.get_text() for text in axes.texts} == {"-2x", "-1x", "+1x", "+2x"}
    at = np.concatenate([mesh.get_coordinates()[:, 0, 1] for mesh in axes.collections])
    assert at.min() == pytest.approx(math.sqrt(16 * TURN / 50) / 2, rel=0.01)
    assert 4.5 < at.max() < 6.0


def test_the_place_that_moves_most_stands_for_a_machine():
    """Of all that are observed, whatever their kind, not of the journals in their bearings; of two
    that move as much the last that is no bearing."""
    t = np.linspace(0, 1, 101)

    def columns(**amplitudes):
        moved = {f"{name}.x": a * np.sin(50 * t) for name, a in amplitudes.items()}
        moved |= {f"{name}.y": 0 * t for name in amplitudes}
        return moved | {f"{name}.x_amp": t for name in amplitudes if name != "bearing"}

    assert probe_that_moves_most(columns(disc=1.0, probe=2.0, bearing=9.0)) == "probe"
    assert probe_that_moves_most(columns(probe=1.0, disc=2.0)) == "disc"
    assert probe_that_moves_most(columns(first=1.0, second=1.001, third=1.0)) == "third"
    pull = columns(core=1.0, end=0.5, pull=1.0)
    assert probe_that_moves_most(pull, {"end", "pull"}) == "core"
    assert probe_that_moves_most(columns(core=0.9, pull=1.0), {"pull"}) == "pull"
    assert probe_that_moves_most(columns(bearing=1.0)) is None


def test_a_doubtful_run_names_the_message_that_makes_it_so():
    """Not the first one, which may be a note, and none for a verification, which has its own."""
    figures = {"place": None, "status": "doubtful: too-coarse"}
    figures |= {"messages": ["a whirl grows", "the step is long"], "codes": ["", "too-coarse"]}
    *_, said = sentences(figures, recorded(stop=1.0), Path("report.html"))
    assert said == "The run is doubtful: too-coarse: the step is long; open report.html."
    figures["status"] = "doubtful: not-confirmed"
    *_, said = sentences(figures, recorded(stop=1.0), Path("report.html"))
    assert said == "The run is doubtful: not-confirmed; open report.html."


def test_a_run_whose_fmu_ended_in_its_first_step_has_no_pictures(tmp_path):
    recording = recorded(stop=1.0)
    none = {name: np.zeros(0) for name in recording.columns}
    run = Run(np.zeros(0), none, "failed: a limit", (), 0.0)
    assert write_run_pictures(run, recording, {"place": "disc[2]"}, "run", True, tmp_path) == []
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("um", "said"), [(283.4, "283 um"), (12.3, "12 um"), (0.3412, "0.34 um"), (2e-4, "0.0002 um")]
)
def test_a_small_motion_is_not_said_to_be_none(um, said):
    figures = {"place": "disc[2]", "no_peak": "the speed is constant"}
    figures |= dict.fromkeys(("x_peak_um", "y_peak_um"))
    figures |= {"r_start_um": None, "r_largest_um": um, "status": "ok"}
    first, *_ = sentences(figures, recorded(stop=1.0), Path("report.html"))
    assert first == (
        f"No peak, because the speed is constant; disc 2 moved by at most {said} from rest after "
        "the start-up."
    )


def test_a_run_takes_away_its_own_earlier_files_alone(tmp_path):
    own = ("summary.json", "run_down.csv", "recording.npz", "run_down_orbit.png")
    for name in (*own, "notes.txt", "RotorBearing.fmu", "summary.json.bak"):
        (tmp_path / name).write_bytes(b"")
    clear(tmp_path)
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"notes.txt", "RotorBearing.fmu", "summary.json.bak"}


def test_pictures_go_with_the_recording_that_they_were_drawn_of(tmp_path):
    for name in ("orbit.png", "mine.png"):
        (tmp_path / name).write_bytes(b"")
    clear(tmp_path)  # without a recording they are the user's
    assert {path.name for path in tmp_path.iterdir()} == {"orbit.png", "mine.png"}
    (tmp_path / "recording.npz").write_bytes(b"")
    clear(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"mine.png"}


@pytest.mark.parametrize("speed", [100.0, -103.3, 107.7])
def test_the_spectrum_of_a_run_at_one_speed_has_its_1x_on_a_line(speed):
    t = np.arange(0.0, 4.0, 4e-4)
    phi = speed * t
    x = 3e-5 * np.cos(phi - 0.4)
    late = vibration.second_half(t, phi)
    assert 1.9 < t[-1] - t[late][0] < 2.0
    f, lines = vibration.spectrum(t[late], x[late])
    assert lines.max() == pytest.approx(3e-5, rel=2e-3)
    assert f[np.argmax(lines)] == pytest.approx(abs(speed) / TURN, rel=2e-3)


@pytest.mark.parametrize("order", [1.0, 3.5])
def test_orders_of_whole_turns_are_lines_of_a_spectrum_however_few_their_rows(order):
    t = np.arange(20 * 8 + 1) / 8  # 20 turns of 8 rows, the last row being a mark again
    f, lines = vibration.spectrum(t, 7.0 + 2.0 * np.cos(order * TURN * t + 0.3))
    assert f[np.argmax(lines)] == pytest.approx(order, rel=1e-12)
    assert lines.max() == pytest.approx(2.0, rel=1e-12)
    assert lines[np.abs(f - order) > 0.06].max() < 1e-12


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_a_signal_of_too_few_rows_for_a_spectrum_says_so(rows):
    t = np.arange(rows) * 1e-3
    with pytest.raises(vibration.TooFewRows, match=f"has {rows} recorded rows; needed: at least 3"):
        vibration.spectrum(t, t)
    if rows:
        assert vibration.second_half(t, t) == slice(0, None)
    else:
        with pytest.raises(vibration.TooFewRows, match="has 0 recorded rows; needed: at least 1"):
            vibration.second_half(t, t)


@pytest.mark.parametrize(("turn", "rows"), [(0.01, 3), (0.01, 4), (1.0, 5)])
def test_half_of_a_run_that_failed_after_a_few_steps_is_enough_for_a_spectrum(turn, rows):
    """turn: by which the shaft turned in a step, in turns."""
    t = np.arange(float(rows))
    late = vibration.second_half(t, TURN * turn * t)
    assert len(t[late]) == 3
    assert np.isfinite(vibration.spectrum(t[late], t[late])[1]).all()


@pytest.mark.parametrize(
    ("slowest", "fastest", "ends"),
    [(0.3, 1.67, (0, 2)), (48.0, 219.3, (0, 220)), (-1.67, -0.1, (-2, 0)), (1e-13, 1e-13, (0, 10))],
)
def test_the_speeds_of_a_slow_machine_fill_their_axis(slowest, fastest, ends):
    _, axes = new_figure()
    speed_axis(axes, np.array([slowest, fastest]))
    assert axes.get_xlim() == pytest.approx(ends)


@pytest.mark.parametrize(("axis", "direction"), [("x", "horizontal"), ("y", "vertical")])
def test_distances_in_pictures_of_a_run_are_those_of_the_direction_named(axis, direction):
    _, axes = new_figure()
    run = recorded(stop=0.1)
    distance_axes(axes, run, "disc[2]", axis)
    far = f"Largest {direction} distance of disc 2\nfrom its start, in a turn [µm]"
    assert axes.get_ylabel() == far
    shown = [view.shown.amplitude_unit for view in (View(run), View(run, wants_pp=True))]
    assert shown == ["µm 0-p", "µm pp"]
    assert axes.get_ylim()[0] == 0.0


def test_speeds_in_pictures_have_all_digits_before_the_point():
    speed = 12345.0 / (30 / math.pi)
    run = recorded(stop=0.3, step=1e-4, speed=speed, rate=0.0)
    with restored():
        choose("rpm")
        assert spectrum(View(run)).axes[0].get_title("left").endswith("at 12345 rpm")
        line = spectra(run, "disc[1]", "").axes[0].get_legend().get_texts()[-1]
        assert line.get_text() == "1x, 12345 cpm"
        marks = [text.get_text() for text in polar(View(run)).axes[0].texts]
        assert set(marks) == {"12345"}


@pytest.mark.usefixtures("drawn")
def test_the_speeds_in_a_polar_plot_do_not_cover_each_other():
    """Of a run at one speed, whose 1x vectors hardly move."""
    figure = polar(View(recorded(stop=0.3, rate=0.0)))
    figure.draw_without_rendering()
    boxes = [Text.get_window_extent(text) for text in figure.axes[0].texts]
    assert len(boxes) == 10
    assert not any(box.count_overlaps(boxes[:i]) for i, box in enumerate(boxes))


@pytest.mark.parametrize("size", [1.0, 1e-6, 0.0])
def test_a_spectrum_spans_five_decades_below_its_highest_line(size):
    """Of a rotor that moves by picometres too."""
    run = recorded(stop=0.3, rate=0.0)
    still = {name: size * run.columns[name] for name in ("disc[1].x", "disc[1].y")}
    axes = spectra(Recording(run.t, run.columns | still, run.units, {}), "disc[1]", "").axes[0]
    low, high = axes.get_ylim()
    highest = max(float(line.get_ydata().max()) for line in axes.get_lines()[:2]) if size else 1.0
    assert (low, high) == pytest.approx((1e-5 * highest, 2 * highest))


def test_a_contact_without_a_force_has_no_speed_of_its_largest():
    run = recorded(stop=1.0)
    quiet = Recording(run.t, run.columns | {"bearing[1].fn": 0 * run.t}, run.units, {})
    row = re.findall("<td[^>]*>bearing 1</td>(.*?)</tr>", tables(quiet, {}))[-1]
    assert re.findall("<td[^>]*>([^<]*)</td>", row) == ["0", "-", "0"]
    title = contact_force(View(quiet)).axes[0].get_title("left")
    assert title.endswith("contact force of bearing 1: nowhere in this run")


def test_a_line_beyond_3x_is_seen_in_the_spectrum_of_few_rows_a_turn():
    """What so few rows cannot show is NaN, and must not hide what they show."""
    run = recorded(stop=2.0, step=TURN / 300 / 12, rate=0.0)
    more = {"disc[2].x": run.columns["disc[2].x"] + 3e-5 * np.cos(5 * run.phi)}
    both = Recording(run.t, run.columns | more, run.units, run.about)
    low, high = spectrum(View(both, "disc[2]")).axes[0].get_xlim()
    assert low < -5 * 300 / TURN < 5 * 300 / TURN < high
