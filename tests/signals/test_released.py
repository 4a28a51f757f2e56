"""What is said of a machine that begins in the air: it is measured from its release."""

from pathlib import Path

import pytest

import rotor_fmu as rf
from rotor_fmu.run_pictures.signal_plots import orbit
from rotor_fmu.run_pictures.view import View
from rotor_fmu.runs.summary import sentences, summary

from ..known import EXAMPLES


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
