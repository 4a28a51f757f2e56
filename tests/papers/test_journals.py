"""A rotor in hard stops: the rotor's matrices, its penalty bearings, paper B's impact option."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from papers.integrators.members import MODERATE_DISSIPATION, TRANSIENT_FIDELITY, newmark
from papers.ishikawa_koguchi.impact.journals import JournalStructure, RunDown, run_journals
from papers.ishikawa_koguchi.impact.stepping.failures import ImpactError
from tests.dense import dense_matrices
from tests.machines import balanced

RIG = rig()
UNDAMPED = replace(RIG, eta_v=0.0)


@cache
def run(rotor, scheme, impact, dt=2.5e-4, stop=0.06):
    return run_journals(RunDown(rotor, 200.0, -10.0), scheme, dt, impact, stop)


def test_the_structure_is_the_dense_oracles():
    structure = JournalStructure(RunDown(RIG, 200.0, -10.0))
    M, C, K, G, _ = dense_matrices(assemble(RIG))
    rng = np.random.default_rng(1)
    q, v, a = rng.normal(size=(3, len(M)))
    np.testing.assert_allclose(structure.inertia(a), M @ a, rtol=1e-12)
    t = 0.7
    omega = 200.0 - 10.0 * t
    expected = C @ v + K @ q + G @ (omega * v - 5.0 * q)
    np.testing.assert_allclose(structure.internal(q, v, t), expected, rtol=1e-10)


def test_it_starts_at_rest_on_the_bottom_of_its_stops():
    still = balanced(RIG)
    result = run_journals(RunDown(still, 0.0, 0.0), MODERATE_DISSIPATION, 1e-3, "no", 0.05)
    assert np.abs(result.disc - result.disc[0]).max() < 4e-8 * np.abs(result.disc).max()
    weight = sum(result.run.force[-1])
    housings = sum(bearing.mass for bearing in RIG.bearings)
    structure = JournalStructure(RunDown(still, 0.0, 0.0))
    ups = np.r_[np.zeros(structure.size), np.ones(structure.size)]
    ups[structure.size :][: 2 * len(RIG.nodes)][1::2] = 0
    total = -structure.load(0.0) @ ups / RIG.gravity
    assert weight == pytest.approx((total - housings) * RIG.gravity, rel=1e-7)


def test_hard_stops_are_stiff_penalty_bearings_without_friction():
    """The journals' walls against the rotor's own simulation, through the first impacts."""
    slippery = tuple(replace(b, mu=0.0, c=0.0, k=2e9) for b in RIG.bearings)
    rotor = RIG.with_parts(Bearing, *slippery)
    settings = choose("robust", h=1e-5)
    simulation = Simulation(rotor, settings, speed=200.0, rate=-10.0)
    times = np.arange(1, 121) * 5e-4
    x = []
    for t in times:
        simulation.advance(t, 200.0 - 10.0 * simulation.time)
        x.append([simulation.read("disc[3].x"), simulation.read("disc[3].y")])
    result = run(RIG, MODERATE_DISSIPATION, "no", 5e-5)
    hard = np.stack([np.interp(times, result.t, axis) for axis in result.disc.T], axis=1)
    size = np.abs(np.array(x) - x[0]).max()
    assert size > 1e-4
    assert np.abs(hard - x).max() < 0.01 * size


def test_no_journal_leaves_its_stop():
    result = run(RIG, MODERATE_DISSIPATION, "no")
    assert result.impacts > 0
    for j, bearing in enumerate(RIG.bearings):
        r = np.hypot(*result.run.seen[:, 2 + 2 * j : 4 + 2 * j].T)
        assert r.max() < bearing.clearance * (1 + 1e-7)


def test_average_time_arrives_on_an_undamped_shaft_with_a_damped_scheme():
    result = run(UNDAMPED, MODERATE_DISSIPATION, "average-time")
    assert result.run.is_done
    assert result.run.cutbacks > 0
    plain = run(UNDAMPED, MODERATE_DISSIPATION, "no")
    assert np.abs(result.disc[-1] - plain.disc[-1]).max() < 0.1 * RIG.bearings[0].clearance


def test_average_time_stalls_with_an_undamped_scheme():
    result = run_journals(
        RunDown(UNDAMPED, 200.0, -10.0), newmark(), 1e-3, "average-time", 0.1, 1000
    )
    assert result.run.is_capped
    assert result.run.cutbacks > 400


@pytest.mark.parametrize(
    "scheme", [MODERATE_DISSIPATION, pytest.param(TRANSIENT_FIDELITY, marks=pytest.mark.slow)]
)
def test_impulses_ruin_a_rotor_whose_shaft_is_viscous(scheme):
    for impact in ("average-time", "current-time"):
        result = run_journals(RunDown(RIG, 200.0, -10.0), scheme, 1e-3, impact, 0.06, 1000)
        assert not result.run.is_done
    assert run(RIG, scheme, "no", 1e-3).run.is_done


def test_rotating_damping_is_refused():
    with pytest.raises(ImpactError, match="rotating internal damping"):
        JournalStructure(RunDown(replace(RIG, rotating_damping=True), 200.0, -10.0))


@pytest.mark.parametrize("kind", [Bearing, Disc])
def test_a_rotor_without_bearings_or_discs_is_refused(kind):
    with pytest.raises(ImpactError, match=f"{kind.KIND}: none given"):
        JournalStructure(RunDown(RIG.with_parts(kind), 200.0, -10.0))
