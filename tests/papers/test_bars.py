"""Two elastic bars: the analytic solution, the laws of conservation, paper B's section 3.1."""

import re
from functools import cache

import numpy as np
import pytest

from papers.integrators.members import (
    MODERATE_DISSIPATION,
    TRANSIENT_FIDELITY,
    Scheme,
    hht,
    newmark,
)
from papers.ishikawa_koguchi.impact.bars import Bars, run_bars
from papers.ishikawa_koguchi.impact.stepping.failures import ImpactError

NEWMARK, CONTACT_NEWMARK = newmark(), newmark(0.5, 0.5)
DAMPED = [(hht(0.5), "no"), (MODERATE_DISSIPATION, "no"), (TRANSIENT_FIDELITY, "average-time")]


@cache
def run(scheme, dt, impact="no", **bars):
    """The wave is the same across the bars' height, without transverse contraction."""
    return run_bars(Bars(**({"ny": 1} | bars)), scheme, dt, impact)


def test_the_average_acceleration_method_doubles_the_energy_at_short_steps():
    result = run(NEWMARK, 5e-5)
    assert result.rms_error() > 1
    assert result.energy_change > 1


def test_newmark_with_beta_one_half_keeps_the_energy_and_rings():
    result = run(CONTACT_NEWMARK, 5e-5)
    assert result.rms_error() > 0.4
    assert abs(result.energy_change) < 0.1
    assert run(CONTACT_NEWMARK, 8e-4).rms_error("plateau") > 0.3


@pytest.mark.parametrize(("scheme", "impact"), DAMPED)
@pytest.mark.parametrize("opening", [0.01, pytest.param(0.02, marks=pytest.mark.slow)])
def test_damped_schemes_follow_the_wave(scheme, impact, opening):
    fine = run(scheme, 5e-5, impact, opening=opening)
    assert fine.rms_error() < 0.2
    assert fine.rms_error("plateau") < 0.02
    assert fine.mean_after_release == pytest.approx(-1, abs=0.03)
    assert run(scheme, 8e-4, impact, opening=opening).rms_error("plateau") < 0.02


# dt, RMS error, in the plateau, after the release, relative change of energy
PROTOTYPE = [
    (*DAMPED[0], 5e-5, 0.154, 0.0, 0.083, -0.019),
    (*DAMPED[1], 5e-5, 0.157, 0.0, 0.084, -0.022),
    (*DAMPED[2], 5e-5, 0.152, 0.0, 0.095, -0.013),
    (CONTACT_NEWMARK, "no", 8e-4, 0.457, 0.461, 0.404, -0.031),
    (*DAMPED[0], 8e-4, 0.231, 3e-4, 0.172, -0.074),
    (*DAMPED[1], 8e-4, 0.231, 1.7e-3, 0.174, -0.078),
    (*DAMPED[2], 8e-4, 0.231, 0.0, 0.193, -0.050),
]


@pytest.mark.parametrize(
    ("scheme", "impact", "dt", "rms", "plateau", "released", "change"), PROTOTYPE
)
def test_errors_are_those_of_an_independent_program(
    scheme, impact, dt, rms, plateau, released, change
):
    """Run once by a prototype that shares no code with this one."""
    result = run(scheme, dt, impact)
    assert result.rms_error() == pytest.approx(rms, abs=1.5e-3)
    assert result.rms_error("plateau") == pytest.approx(plateau, abs=1e-3)
    assert result.rms_error("released") == pytest.approx(released, abs=1e-3)
    assert result.energy_change == pytest.approx(change, abs=6e-4)


@pytest.mark.parametrize(("is_lumped", "lost"), [(True, 0.0125), (False, 0.0125 / np.sqrt(3))])
def test_an_impulse_costs_the_energy_of_half_an_element(is_lumped, lost):
    result = run(NEWMARK, 5e-5, "average-time", is_lumped=is_lumped)
    assert result.energy_change == pytest.approx(-lost, abs=1e-6)


@pytest.mark.parametrize("opening", [0.01, 0.02, 0.0200008])
def test_average_time_cuts_back_twice_at_impact_and_release(opening):
    fine = run(TRANSIENT_FIDELITY, 5e-5, "average-time", opening=opening)
    assert fine.run.cutbacks == 2
    assert fine.run.increments in (803, 804)
    coarse = run(TRANSIENT_FIDELITY, 8e-4, "average-time", opening=opening)
    assert (coarse.run.cutbacks, coarse.run.increments) == (2, 54)


def test_the_status_log_is_paper_bs_figure_8():
    shown = [
        str(line)
        for line in run(TRANSIENT_FIDELITY, 5e-5, "average-time", opening=0.0200008).run.log
    ]
    paper = """\
1 198 1 0 1 1 0.00990 0.00990 5.000e-005
1 199 1 0 1 1 0.00995 0.00995 5.000e-005
1 200 1 0 1 1 0.0100 0.0100 5.000e-005
1 201 1 0 1 1 0.0100 0.0100 5.000e-005
1 201 2 0 1 1 0.0100 0.0100 4.000e-007
1 202 1 0 0 0 0.0100 0.0100 5.000e-011
1 203 1 0 1 1 0.0100 0.0100 4.960e-005
1 204 1 0 1 1 0.0101 0.0101 5.000e-005
1 205 1 0 1 1 0.0101 0.0101 5.000e-005
1 206 1 0 1 1 0.0102 0.0102 5.000e-005"""
    assert [line.split() for line in shown[197:207]] == [line.split() for line in paper.split("\n")]


@pytest.mark.parametrize(
    ("scheme", "impact"), [(NEWMARK, "no"), *DAMPED, (NEWMARK, "current-time")]
)
def test_the_momentum_of_both_bars_stays_zero(scheme, impact):
    result = run(scheme, 5e-5, impact)
    left, both = result.run.seen[:, 1], result.run.seen[:, 2]
    assert left[0] == pytest.approx(0.01)
    assert np.abs(both).max() < 1e-12 * left[0]


@pytest.mark.parametrize("scheme", [NEWMARK, CONTACT_NEWMARK])
def test_the_contact_force_changes_the_momentum_by_its_impulse(scheme):
    result = run(scheme, 8e-4)
    impulse = np.trapezoid(result.contact_force, result.t)
    left = result.run.seen[:, 1]
    assert left[-1] - left[0] == pytest.approx(-impulse, rel=1e-10)


def test_the_contact_force_is_the_waves():
    bars = Bars()
    result = run(MODERATE_DISSIPATION, 5e-5)
    inside = (result.t > bars.t_impact + 0.004) & (result.t < bars.t_impact + 0.018)
    assert result.contact_force[inside].mean() == pytest.approx(bars.contact_force, rel=0.01)


def test_no_force_ever_pulls_and_no_opening_is_negative():
    result = run(CONTACT_NEWMARK, 8e-4)
    assert result.run.force.min() >= 0
    assert result.run.seen[:, 3].min() > -1e-12 * Bars().opening


def test_a_stiff_penalty_blurs_towards_the_hard_contact():
    hard = run(MODERATE_DISSIPATION, 5e-5, ny=4)
    errors = []
    for penalty in (1e3, 1e5):
        soft = run(MODERATE_DISSIPATION, 5e-5, penalty=penalty, ny=4)
        errors.append(float(np.sqrt(np.mean((soft.tip_velocity - hard.tip_velocity) ** 2))))
        assert soft.run.seen[:, 3].min() < -1e-6
    assert errors[1] < 0.25 * errors[0]


def test_an_unstable_scheme_runs_until_it_is_caught():
    result = run_bars(Bars(), Scheme(0.3, 0.0, 0.1, 0.4), 8e-4)
    number = result.run.increments
    assert 1 < number < 50
    assert re.fullmatch(
        rf"diverged at t = {8e-4 * number:.6g} s, increment {number}, energy \S+ J \(.*\)",
        result.run.status,
    )
    assert result.run.energy[-1] > 1e6 * result.run.energy[0]
    assert result.run.energy[-2] < 1e6 * result.run.energy[0]


@pytest.mark.parametrize(
    ("bars", "names"),
    [
        ({"nx": 0}, "nx = 0"),
        ({"density": -1.0}, "density = -1"),
        ({"E": 0.0}, "E = 0"),
        ({"nu": 0.5}, "nu = 0.5"),
        ({"opening": -1e-3}, "opening = -0.001"),
        ({"penalty": 0.0}, "penalty = 0"),
    ],
)
def test_impossible_bars_are_refused_by_name(bars, names):
    with pytest.raises(ImpactError, match=names):
        run_bars(Bars(**bars), MODERATE_DISSIPATION, 8e-4)


@pytest.mark.parametrize(
    ("dt", "impact", "t_end"), [(0.0, "no", 0.04), (1e-3, "later", 0.04), (1e-3, "no", 0.0)]
)
def test_impossible_runs_are_refused(dt, impact, t_end):
    with pytest.raises(ImpactError):
        run_bars(Bars(), MODERATE_DISSIPATION, dt, impact, t_end)


def test_a_scheme_without_implicit_equation_is_refused():
    with pytest.raises(ImpactError, match="beta > 0"):
        run_bars(Bars(), Scheme(0.0, 0.0, 0.0, 0.5), 8e-4)


def test_a_penalty_has_no_impulse():
    with pytest.raises(ImpactError, match="hard contacts"):
        run_bars(Bars(penalty=1e4), TRANSIENT_FIDELITY, 8e-4, "average-time")
