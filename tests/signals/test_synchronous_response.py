"""A run-down to rest of a shaft whose position drifts, as that of a journal on an oil film."""

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotor_fmu.display import choose, restored
from rotor_fmu.report.report_tables import tables
from rotor_fmu.run_pictures.run_folder import distance_from_start
from rotor_fmu.run_status import OK
from rotor_fmu.runs.conclusions import sentences
from rotor_fmu.runs.recording import Recording
from rotor_fmu.runs.run_down import Run
from rotor_fmu.runs.summary import summary

from ..recordings import recorded

NATURAL, DAMPING = 150.0, 0.08  # of a rotor whose mean position sinks as it runs down
SOLVER = (
    *("steps", "rejected", "newton", "h_min_used", "h_max_used"),
    *("h_last", "trapped", "overdamped_at"),
)


def sinking(stop=40.0, rate=-9.0):
    """A run of a rotor with a resonance of 10 um, which sinks by 60 um meanwhile."""
    t = np.arange(0.0, stop, 1e-3)
    w = 400 + rate * t
    phi = 400 * t + 0.5 * rate * t**2
    r = w / NATURAL
    gain = 2 * DAMPING / (1 - r**2 + 2j * DAMPING * r)  # of 1 at resonance
    z = 10e-6 * gain * np.exp(1j * phi) - 60e-6j * (t / stop) ** 2
    columns = {"w": w, "phi": phi, "disc.x": z.real, "disc.y": z.imag}
    away = {"x": abs(z.real - z.real[0]), "y": abs(z.imag - z.imag[0]), "r": abs(z - z[0])}
    columns |= {f"disc.{axis}_amp": far for axis, far in away.items()}
    columns |= {f"solver.{name}": np.zeros(len(t)) for name in SOLVER}
    columns |= {"energy.residual": 0 * t, "energy.bearings_loss": t}
    units = dict.fromkeys(columns, "m")
    return Run(t, columns, OK, (), 0.0), Recording(t, columns, units, {"status": OK})


def test_a_resonance_is_found_beside_a_larger_drift():
    run, recording = sinking()
    figures = summary(run, recording=recording)
    assert figures["y_peak_um"] is None  # the distance from the start is largest at the end
    assert figures["synchronous_place"] == "disc"
    assert figures["synchronous_um"] == pytest.approx(10.0, rel=0.01)
    assert figures["synchronous_hz"] == pytest.approx(NATURAL / (2 * math.pi), rel=0.02)
    # of the gain over the speed by its half-power points, less what four turns smooth
    w = np.linspace(100.0, 200.0, 100001) / NATURAL
    gain = abs(2 * DAMPING / (1 - w**2 + 2j * DAMPING * w))
    above = w[gain > gain.max() * math.sqrt(0.5)]
    factor = w[np.argmax(gain)] / np.ptp(above)
    assert figures["amplification"] == pytest.approx(factor, rel=0.05)
    said = sentences(figures, recording, Path("report.html"))
    assert said[1].startswith("Largest synchronous (1x) response: disc, 10 um 0-p at 2")
    assert said[1].endswith(f"amplification factor {figures['amplification']:.3g}.")
    with restored():
        choose("rpm,pp")
        assert ", 20 um pp at 14" in sentences(figures, recording, Path("report.html"))[1]


def test_a_whip_beyond_the_resonance_is_no_synchronous_response():
    """At its natural frequency, ten times as large: at 1.33 times the resonance half of it was
    read as 1x."""
    run, recording = sinking()
    w = recording.columns["w"]
    whip = 100e-6 * np.clip((w - 190.0) / 10.0, 0.0, 1.0) * np.exp(1j * NATURAL * recording.t)
    moved = {"disc.x": whip.real, "disc.y": whip.imag}
    moved = {name: recording.columns[name] + more for name, more in moved.items()}
    figures = summary(run, recording=replace(recording, columns=recording.columns | moved))
    assert figures["synchronous_um"] == pytest.approx(10.0, rel=0.01)
    assert figures["synchronous_hz"] == pytest.approx(NATURAL / (2 * math.pi), rel=0.02)


@pytest.mark.parametrize(("stop", "largest"), [(4.0, None), (20.0, 40.0)])
def test_a_free_vibration_after_a_shock_is_no_synchronous_response(stop, largest):
    """At 7 Hz in one plane, which a shaft of 5 Hz has in its four turns: of 600 um in the blocks at
    1x, then less. While it hides what the unbalance does, nothing is said of that."""
    run, recording = sinking(stop, 0.0)
    free = 3e-3 * np.exp((-0.3 + 45.0j) * (recording.t - 0.5)).imag * (recording.t > 0.5)
    phi = 31.4 * recording.t
    z = 40e-6 * np.exp(1j * phi) + 1j * free
    moved = {"disc.x": z.real, "disc.y": z.imag, "phi": phi, "w": 31.4 + 0 * phi}
    changed = replace(recording, columns=recording.columns | moved)
    figures = summary(replace(run, columns=run.columns | moved), recording=changed)
    if largest is None:
        assert figures["synchronous_um"] is None
        assert "nan" not in tables(changed, {})
    else:
        assert figures["synchronous_um"] == pytest.approx(largest, rel=0.3)
    said = sentences(figures, changed, Path("report.html"))
    assert any("synchronous" in sentence for sentence in said) == (largest is not None)


@pytest.mark.parametrize(("stop", "rate", "is_seen"), [(40.0, 0.0, True), (0.05, -9.0, False)])
def test_a_run_at_one_speed_passes_no_resonance_and_a_short_one_has_no_response(
    stop, rate, is_seen
):
    run, recording = sinking(stop, rate)
    figures = summary(run, recording=recording)
    assert figures["amplification"] is None
    assert (figures["synchronous_um"] is not None) == is_seen
    said = sentences(figures, recording, Path("report.html"))
    assert any("synchronous" in sentence for sentence in said) == is_seen


def test_a_distance_from_the_start_is_no_peak_to_peak_amplitude():
    run, _ = sinking()
    columns = run.columns | {"disc.y_amp": 1e-5 * np.exp(-(((run.columns["w"] - 150) / 20) ** 2))}
    with restored():
        choose("rpm,pp")
        figure = distance_from_start(replace(run, columns=columns), "disc", "y", "")
    assert "[µm]" in figure.axes[0].get_ylabel()
    assert "10 µm at" in figure.legends[0].get_texts()[-1].get_text()


def test_the_largest_force_of_a_shaft_that_has_come_to_rest_is_at_no_speed():
    """Rounding leaves 5e-17 rad/s of it."""
    run = recorded()
    pressed = {"bearing[1].fn": run.t, "w": np.append(run.w[:-1], -5e-17)}
    text = tables(replace(run, columns=run.columns | pressed), {})
    assert re.search(r"<td[^>]*>bearing 1</td><td[^>]*>5.999</td><td[^>]*>0</td>", text)
