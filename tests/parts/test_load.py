"""A constant load is a force of known size: it does what gravity of the same resultant does, and
what an external force does that never changes, but weighs nothing."""

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves.journal_bearing import bearing_curves
from rotor_fmu.model.linear import modes, placed_unbalances, static
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.reduction import reduced

import rotor_fmu as rf

from ..machines import losses
from ..toml_text import table
from .machines import bearings, rigid, shaft

K, WEIGHT, SPEED = 1e4, 9.81, 300.0
FILM = {"journal_radius": 0.02, "length": 0.02, "clearance": 5e-5, "viscosity": 0.02, "short": True}
FILMS = table("[journal_bearing]", node=1, **FILM) + table("[journal_bearing]", node=3, **FILM)
DOWN = table("[load]", node=2, fy=-WEIGHT)
MESH = table("[load]", node=2, fx=300.0, fy=-200.0, offset=0.05)


def on_supports(load, gravity=9.81):
    """A shaft of two lengths of 0.5 m on stiff springs at its ends, with a sensor in the middle."""
    ends = "".join(table("[support]", node=n, stiffness=1e7, damping=200.0) for n in (1, 3))
    text = f"gravity = {gravity}\n" + shaft(0.0, 0.5, 1.0) + ends + table("[port]", node=2) + load
    return parse_rotor(text)


def test_supports_bear_it_by_the_lever_rule_and_the_shaft_bends_by_the_closed_form():
    bent = static(on_supports(table("[load]", node=2, fx=300.0, fy=-200.0), gravity=0.0))
    stiffness = 48 * 2.1e11 * np.pi / 64 * 0.02**4  # of a slender shaft of 1 m
    np.testing.assert_allclose(bent.x[1], 300.0 / stiffness + 150.0 / 1e7, rtol=2e-3)
    beside = static(on_supports(MESH, gravity=0.0))
    np.testing.assert_allclose(beside.load_x, [300.0 * 0.45, 300.0 * 0.55], rtol=1e-9)
    np.testing.assert_allclose(beside.load_y, [-200.0 * 0.45, -200.0 * 0.55], rtol=1e-9)


def test_films_answer_to_it_as_to_a_weight_of_that_size():
    """A rigid rotor without gravity under the load, and under the same force of its own weight."""
    heavy = parse_rotor(rigid(1.0, 9.81, FILMS))
    loaded = parse_rotor(rigid(1.0, 0.0, FILMS + DOWN))
    of_both = [modes(rotor, SPEED).eigenvalues for rotor in (heavy, loaded)]
    np.testing.assert_allclose(of_both[1], of_both[0], rtol=1e-4)
    turned = parse_rotor(rigid(1.0, 9.81, FILMS + table("[load]", node=2, fx=WEIGHT, fy=WEIGHT)))
    rest = [static(rotor, SPEED) for rotor in (heavy, turned)]
    np.testing.assert_allclose(rest[1].x[1], -rest[0].y[1], rtol=1e-4)  # the load is to the right
    np.testing.assert_allclose(rest[1].y[1], rest[0].x[1], rtol=1e-4)
    sim = Simulation(turned, choose("robust"), speed=SPEED)
    journal = [sim.read(f"journal_bearing[1].{axis}") for axis in "xy"]
    np.testing.assert_allclose(journal, [rest[1].x[0], rest[1].y[0]], rtol=1e-6)


def test_a_run_rests_under_it_and_its_energy_is_in_the_ledger():
    """The same as an external force from the start on, whose work the ledger books as such."""
    inside = Simulation(on_supports(MESH.replace("0.05", "0.0")), choose("robust"))
    beside = Simulation(on_supports(""), choose("robust"), loads=[300.0 - 200.0j])
    np.testing.assert_allclose(inside.motion.q, beside.motion.q, rtol=1e-9, atol=1e-15)
    rest = static(on_supports(MESH.replace("0.05", "0.0")))
    np.testing.assert_allclose(inside.motion.q[2], rest.x[1] + 1j * rest.y[1], rtol=1e-9)
    stored, of_weight = (sim.read("energy.gravity") for sim in (inside, beside))
    work = (np.conj(300.0 - 200.0j) * inside.motion.q[2]).real
    assert stored - of_weight == pytest.approx(-work, rel=1e-9)


def test_no_energy_is_lost_as_the_rotor_swings_about_where_it_would_rest():
    released = on_supports(MESH + "[start]\nx = 1e-4\n")
    simulation = Simulation(released, choose("controlled", tolerance=1e-6), speed=0.0)
    simulation.advance(0.05, 0.0)
    assert abs(simulation.read("energy.residual")) < 1e-3 * losses(simulation)


def test_fewer_dofs_keep_the_node_and_the_arm():
    whole = assemble(on_supports(MESH))
    few = reduced(whole, 1)
    np.testing.assert_allclose(
        few.one_body @ few.static_load, whole.one_body @ whole.static_load, rtol=1e-9
    )


def test_it_is_no_mass():
    """The unbalances of API 617 are of what the bearings carry, and so is the mass that whirls."""
    plain, loaded = (on_supports(of) for of in ("", MESH))
    assert placed_unbalances(loaded, 1, SPEED) == placed_unbalances(plain, 1, SPEED)
    plain, loaded = (parse_rotor(rigid(1.0, 9.81, FILMS + of)) for of in ("", MESH))
    masses = [
        bearing_curves(of, [SPEED], bearing="journal_bearing[1]").mass for of in (plain, loaded)
    ]
    assert masses[1] == pytest.approx(masses[0], rel=1e-3)
    upright = parse_rotor(f"inclination = {np.pi / 2}\n" + rigid(1.0, 9.81, FILMS + DOWN))
    assert bearing_curves(upright, [SPEED]).mass == pytest.approx(masses[0], rel=1e-3)


def test_it_is_a_parameter_of_runs_and_of_curves():
    sensor = table("[sensor]", node=2) + table("[unbalance]", node=2, amount=1e-6)
    machine = rf.parse(rigid(1.0, 0.0, bearings(K, 20.0) + DOWN + sensor))
    twice = {"load[1].fy": -2 * WEIGHT}
    run = rf.simulate(machine, stop=0.01, speed=0.0, parameters=twice, record=["sensor[1].y"])
    np.testing.assert_allclose(run["sensor[1].y"], -2 * WEIGHT / K, rtol=1e-5)
    over_load = ("load[1].fy", -2 * WEIGHT, -WEIGHT)
    means = rf.response(machine, speed=50.0, over=over_load, stability=False).dataframe()
    np.testing.assert_allclose(means["sensor[1].y"], means["load[1].fy"] / K, rtol=1e-5)
