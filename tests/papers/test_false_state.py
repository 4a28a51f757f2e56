"""The false state: what is predicted of it is what the integrator does."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.settings import Settings
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from papers.integrators.false_state import bouncing, one_axis
from papers.integrators.false_state import cycles as false_state
from papers.integrators.false_state.planting import plant, put
from papers.integrators.members import chung_hulbert, generalized_alpha, hht, newmark, wbz
from papers.integrators.survey.planted import lasting_cycles

from ..machines import overhung

H = 5e-4
STEPS = (4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1e-4)
SOME_STEPS = [h if h in (1e-3, H) else pytest.param(h, marks=pytest.mark.slow) for h in STEPS]
SCHEMES = {
    "newmark": newmark(),
    "hht": hht(0.1),
    "moderate": hht(math.sqrt(2) - 1),
    "wbz": wbz(-0.1),
    "paper A": generalized_alpha(0.1, 0.08),
    "chung-hulbert": chung_hulbert(0.6),
}
AXIS = one_axis.axis_of(rig(), 0, one_axis.X)


def smooth(c=80.0):
    """A rotor that is held besides its one bearing, without spin, unbalance and friction, whose
    contact damping is there at once: on one axis nothing is left out."""
    bearing = Bearing(
        node=3, journal_radius=0.01, clearance=5e-5, k=2e8, mu=0.0, mass=0.5, kx=2e5, ky=5e5,
        cx=50.0, cy=90.0, c=c, delta_c=1e-15,
    )  # fmt: skip
    discs = (Disc(2, 0.1, 0.02), Disc(3, 0.05, 0.01))
    supports = (Support(1, 2e7, 40.0), Support(2, 1e4, 10.0))
    return overhung(discs, supports, (bearing,), gravity=0.0)


def simulation_of(scheme, rotor, h):
    settings = Settings("generalized-alpha", alpha_f=scheme.alpha_f, alpha_m=scheme.alpha_m, h=h)
    return Simulation(rotor, settings, warn=lambda message: None)


def displacements(simulation, h, count):
    """Of the journal relative to its housing, shape (count,), complex [m]."""
    contact, q = simulation.structure.interfaces[0], simulation.motion.q
    seen = []
    for n in range(count):
        seen.append(q[contact.dof] - q[contact.end])
        simulation.advance((n + 1) * h, 0.0)
    return np.array(seen)


def by_turns(others):
    """Each scheme with one of two others, by turns; with the second one among the slow tests."""
    return [
        pytest.param(name, others[(i + second) % 2], marks=[pytest.mark.slow] * second)
        for i, name in enumerate(SCHEMES)
        for second in (0, 1)
    ]


@pytest.mark.parametrize(("name", "direction"), by_turns((one_axis.X, one_axis.Y)))
def test_a_predicted_cycle_is_a_motion_of_the_integrator(name, direction):
    scheme, rotor = SCHEMES[name], smooth()
    axis = one_axis.axis_of(rotor, 0, direction)
    result = [c for c in false_state.cycles(axis, scheme, H) if c.is_stable]
    assert result
    for cycle in result:
        simulation = simulation_of(scheme, rotor, H)
        plant(simulation, 0, direction, cycle)
        seen = displacements(simulation, H, 60)
        along, across = (
            (seen.real, seen.imag) if direction == one_axis.X else (seen.imag, seen.real)
        )
        np.testing.assert_allclose(along, np.resize(cycle.displacement, 60), rtol=1e-6)
        assert np.abs(across).max() < 1e-8 * axis.clearance


@pytest.mark.parametrize("name", SCHEMES)
def test_the_integrator_makes_the_power_that_is_predicted(name):
    scheme, rotor = SCHEMES[name], smooth()
    axis = one_axis.axis_of(rotor, 0, one_axis.X)
    cycle = next(c for c in false_state.cycles(axis, scheme, H) if c.is_stable)
    simulation = simulation_of(scheme, rotor, H)
    plant(simulation, 0, one_axis.X, cycle)
    period = len(cycle.word) * H
    simulation.advance(period, 0.0)
    before = simulation.read("energy.residual")
    simulation.advance(11 * period, 0.0)
    made = simulation.read("energy.residual") - before
    assert made == pytest.approx(cycle.power * 10 * period, rel=1e-4)


def test_a_cycle_lasts_in_the_rig_with_its_friction_spin_and_weight():
    scheme = hht(math.sqrt(2) - 1)
    _, bearing, direction, _, cycle = next(
        entry for entry in lasting_cycles(scheme, H) if entry[2] == one_axis.X
    )
    settings = Settings("hht", alpha_f=scheme.alpha_f, h=H)
    simulation = Simulation(rig(), settings, speed=120.0, warn=lambda message: None)
    plant(simulation, bearing, direction, cycle)
    simulation.advance(0.4, 120.0)
    before = simulation.read("energy.residual")
    simulation.advance(0.5, 120.0)
    power = (simulation.read("energy.residual") - before) / 0.1
    assert cycle.word == "RRLL"
    assert simulation.read("solver.trapped") * H > 0.4
    assert power == pytest.approx(cycle.power, rel=0.1)


@pytest.mark.parametrize("p", [2, 3, 4, 5, 6])
def test_the_words_are_all_there_and_none_twice(p):
    result = false_state.words(p)
    every = {word[i:] + word[:i] for word in result for i in range(p)}
    assert len(every) == p * len(result)

    def primitive(letters):
        """Aperiodic words of length p, by Moebius inversion."""
        moebius = {1: 1, 2: -1, 3: -1, 4: 0, 5: -1, 6: 1}
        return sum(moebius[p // d] * letters**d for d in range(1, p + 1) if p % d == 0)

    assert len(every) == primitive(3) - 2 * primitive(2) + primitive(1)


@pytest.mark.parametrize("h", STEPS)
@pytest.mark.parametrize("name", SCHEMES)
def test_no_stable_integrator_bounces_between_the_walls_at_every_step(name, h):
    assert all(cycle.word != "RL" for cycle in false_state.cycles(AXIS, SCHEMES[name], h, 2))


@pytest.mark.parametrize("rho", [0.0, 0.1, 0.3, 0.5, 0.9])
@pytest.mark.parametrize("h", [1e-3, 2.5e-4])
def test_between_hard_walls_the_quarter_phase_decides_whether_rrll_exists(rho, h):
    scheme = chung_hulbert(rho)
    hard = replace(AXIS, k=1e12, c=0.0)
    exists = any(cycle.word == "RRLL" for cycle in false_state.cycles(hard, scheme, h, 4))
    assert exists == (false_state.quarter_phase(AXIS, scheme, h) < math.pi / 4)


def test_newmark_sees_a_mass_as_a_mass_at_any_step():
    still = replace(AXIS, C=0 * AXIS.C, K=1e-9 * AXIS.K)
    assert false_state.quarter_phase(still, newmark(), H) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("name", "h"),
    [
        *by_turns((1e-3, H)),
        *(
            pytest.param(name, h, marks=pytest.mark.slow)
            for name in SCHEMES
            for h in (4e-3, 2e-3, 2.5e-4)
        ),
    ],
)
def test_on_the_rig_only_cycles_without_a_free_step_bear_anything_and_last(name, h):
    for bears, *_, cycle in lasting_cycles(SCHEMES[name], h):
        assert "." not in cycle.word or bears < 20.0


@pytest.mark.parametrize("rho", [0.0, pytest.param(0.1, marks=pytest.mark.slow), 0.2])
@pytest.mark.parametrize("h", SOME_STEPS)
def test_chung_hulbert_up_to_0_2_has_no_cycle_that_bears_two_newtons(rho, h):
    assert all(bears < 2.0 for bears, *_ in lasting_cycles(chung_hulbert(rho), h))


def test_a_cycle_bears_what_its_inequalities_say():
    scheme = hht(math.sqrt(2) - 1)
    cycle = next(c for c in false_state.cycles(AXIS, scheme, H) if c.word == "RRLL")
    for share, remains in ((0.99, True), (1.01, False)):
        loaded = replace(AXIS, along=share * cycle.load[1])
        words = [c.word for c in false_state.cycles(loaded, scheme, H, 4)]
        assert ("RRLL" in words) == remains


@pytest.mark.parametrize("name", ["newmark", "moderate", "chung-hulbert"])
def test_the_map_of_an_impact_is_the_integrators(name):
    scheme, rotor = SCHEMES[name], smooth(c=0.0)
    axis = one_axis.axis_of(rotor, 0, one_axis.X)
    speed, count = 0.3, 80
    predicted = bouncing.follow(axis, scheme, H, np.array([speed]), count)[:, 0, 3]
    start = axis.clearance - 3.5 / bouncing.INSTANTS * H * speed
    simulation = simulation_of(scheme, rotor, H)
    shape = np.append(axis.static[0], 0.0)  # and ground
    put(simulation, start * shape, speed * shape, 0 * shape)
    seen = displacements(simulation, H, count + 1)[1:].real
    np.testing.assert_allclose(seen[:20], predicted[:20], rtol=1e-6, atol=1e-8 * axis.clearance)


def test_impacts_end_in_the_false_state_with_newmark_and_never_with_0_2():
    speeds = np.array([0.05, 0.1, 0.4])
    assert (bouncing.trapped_share(AXIS, newmark(), H, speeds) > 0.5).all()
    assert (bouncing.trapped_share(AXIS, chung_hulbert(0.2), H, speeds) == 0.0).all()


def test_slow_unbalance_loads_the_bearings_with_its_own_force():
    omega = 5.0
    structure = assemble(rig())
    pull = abs(structure.unbalance.sum()) * omega**2
    loads = one_axis.unbalance_loads(structure, omega)
    np.testing.assert_allclose(loads.sum(axis=0), pull, rtol=0.01)
