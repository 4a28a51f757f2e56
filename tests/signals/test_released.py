"""What is said of a machine that begins in the air: it is measured from its release."""

from pathlib import Path

import numpy as np
import pytest

import rotor_fmu as rf
from rotor_fmu.run_pictures.signal_plots import orbit
from rotor_fmu.run_pictures.view import View
from rotor_fmu.runs.conclusions import sentences
from rotor_fmu.runs.peaks import start_up
from rotor_fmu.runs.summary import summary

from ..known import EXAMPLES


def test_the_drop_is_not_hidden_by_its_start_up():
    """It is what a touchdown bearing is made for, and was left out as a transient of the start."""
    run = rf.simulate(rf.load(EXAMPLES / "drop/compressor.toml"), speed=500.0, stop=0.5)
    figures = summary(run.points, recording=run.recording)
    c, end = run.recording.columns, start_up(run.recording.t, run.recording.w)
    x, y = (c[f"{figures['place']}.{axis}"] for axis in "xy")
    away = 1e6 * np.hypot(x - x[0], y - y[0])[run.recording.t <= end]
    assert figures["r_start_um"] == pytest.approx(away.max(), rel=1e-3)
    assert figures["r_start_um"] > 1.01 * figures["r_largest_um"] > 250.0
    said, *_ = sentences(figures, run.recording, Path("report.html"))
    assert said.endswith(f" the first {end:.3g} s, it moved by at most {away.max():.0f} um.")


def test_what_moves_more_in_the_start_up_than_ever_after_is_said():
    """A blade that is lost at once, or the transient of the start, was in no sentence."""
    quiet, thrown = (
        rf.simulate(rf.load(EXAMPLES / "jeffcott_rub/jeffcott.toml"), speed=speed, stop=1.0)
        for speed in (([0.0, 1.0], [60.0, 200.0]), 400.0)
    )
    for run, is_said in ((quiet, False), (thrown, True)):
        figures = summary(run.points, recording=run.recording)
        assert (figures["r_start_um"] > figures["r_largest_um"]) == is_said
        said, *_ = sentences(figures, run.recording, Path("report.html"))
        assert (f"it moved by at most {figures['r_start_um']:.0f} um." in said) == is_said


@pytest.mark.parametrize(
    ("example", "y_static_um", "begin", "label"),
    [
        ("drop/compressor.toml", None, "where it was released", "release"),
        ("jeffcott_rub/jeffcott.toml", pytest.approx(0.0, abs=1e-9), "rest", "rest"),
    ],
)
def test_its_release_is_not_called_its_rest(example, y_static_um, begin, label):
    """It drops by its clearance of 250 um, so it is not at rest where it begins."""
    run = rf.simulate(rf.load(EXAMPLES / example), speed=500.0, stop=0.5)
    figures = summary(run.points, recording=run.recording)
    assert figures["y_static_um"] == y_static_um
    said, *_ = sentences(figures, run.recording, Path("report.html"))
    assert f" um from {begin} after the start-up" in said
    (axes,) = orbit(View(run.recording)).axes
    assert label in [line.get_label() for line in axes.lines]
