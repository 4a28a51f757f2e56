"""Angles that begin anew after a turn: above its critical speed a shaft lags by half of one."""

import cmath
import math

import numpy as np
import pytest

from rotor_fmu import studies
from rotor_fmu.machine_studies.metric import Metric
from rotor_fmu.machine_studies.run_excitation import Samples, Window
from rotor_fmu.machine_studies.run_metrics import KINDS
from rotor_fmu.report.study_page import study_page
from rotor_fmu.studies.analysis import analyse
from rotor_fmu.studies.runner import run_study
from rotor_fmu.studies.store import about_of, read_rows

from .functions import here, quiet
from .test_metrics import UNBALANCE, C, K, read, row

SPEED = 150.0
LAG = cmath.phase(UNBALANCE * SPEED**2 / (K - SPEED**2 + 1j * SPEED * C))
HELD = f'kind = "constant"\nspeed = {SPEED}\nsettle = 2\nturns = 4\n'
TURNED = "\"unbalance[1].phase\" = { values = ['-20 deg', '-10 deg', '0 deg', '10 deg', '20 deg'] }"


def test_phases_about_half_a_turn_have_the_mean_and_the_spread_of_the_unbalances(tmp_path):
    """Of -166 +- 20 degrees; their mean was said to be -94 degrees."""
    keep = 'phase = { last = "disc.x_1x_phase" }'
    run_study(read(tmp_path, HELD, keep, TURNED), tmp_path / "out", here, quiet)
    found = analyse(tmp_path / "out")["columns"]["phase"]
    assert math.remainder(found["mean"] - LAG, math.tau) == pytest.approx(0, abs=2e-3)
    assert found["largest"] - found["least"] == pytest.approx(math.radians(40), rel=1e-2)
    assert np.ptp(studies.open(tmp_path / "out").phase.values) > math.pi
    html = study_page(about_of(tmp_path / "out"), read_rows(tmp_path / "out"))
    assert f"{math.degrees(found['mean']):.4g}" in html or f"{found['mean']:.4g}" in html


def test_the_mean_and_the_passage_of_a_phase_do_not_fall_between_its_ends(tmp_path):
    """At the mark about which they are half a turn, phases jump between the ends of their range."""
    mark = f'"unbalance[1].phase" = {{ values = [{math.pi - LAG}] }}'
    data = row(tmp_path, HELD, 'mean = { mean = "disc.x_1x_phase" }', vary=mark)
    assert abs(float(data["mean"])) == pytest.approx(math.pi, abs=1e-3)
    phi = np.linspace(0, 1, 11)
    columns = {"a.psi": np.array([6.2] * 5 + [0.2] * 6), "phi": phi, "w": 100 + phi}
    window = Window(Samples(phi, columns), None, math.nan, 0, math.nan)
    passed = Metric("v", KINDS["value"], "a.psi", (("speed", 100.45),))
    between = 6.2 + 0.5 * (0.2 + math.tau - 6.2)
    assert KINDS["value"].make(passed, window) == pytest.approx(between)
    mean = KINDS["mean"].make(Metric("m", KINDS["mean"], "a.psi"), window)
    assert mean == pytest.approx(
        np.trapezoid(np.unwrap(columns["a.psi"]), phi) - math.tau, rel=1e-2
    )
