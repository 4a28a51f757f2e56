"""The energy ledger closes, and the torque is what keeps the speed."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts import LAWS
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.parts.floating_ring_bearing import FloatingRingBearing
from rotor_fmu.model.parts.heated_contact import HeatedContact
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.parts.rolling_bearing import RollingBearing
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.parts.touchdown_bearing import TouchdownBearing
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.ledger import STORES

from ..machines import METHODS, STEEL, balanced, losses, overhung


def stored(sim):
    return sum(sim.read(f"energy.{s}") for s in STORES if f"energy.{s}" in sim.names)


def run(rotor, settings, duration, *, speed, rate=0.0, stops=50, loads=None):
    sim = Simulation(rotor, settings, speed=speed, rate=rate)
    for t in np.linspace(0, duration, stops + 1)[1:]:
        sim.advance(t, speed + rate * sim.time, loads)
    return sim


@pytest.mark.parametrize("speed", [400.0, 215.0, 40.0])
def test_the_ledger_of_the_rubbing_rig_closes(speed):
    sim = run(rig(), choose("robust", h=1e-4), 3.0, speed=speed, rate=-10.0)
    assert sim.read("energy.friction_loss") > 0.5  # it did rub
    assert abs(sim.read("energy.residual")) < 1e-3 * losses(sim)


def test_the_residual_is_the_balance_of_what_is_listed():
    sim = run(rig(), choose("robust", h=2e-4), 0.5, speed=300.0)
    start = stored(Simulation(rig(), choose("robust"), speed=300.0))
    inflow = sim.read("energy.drive_work") + sim.read("energy.external_work")
    expected = stored(sim) - start - inflow + losses(sim)
    # the stores, of some 800 J, cancel
    assert sim.read("energy.residual") == pytest.approx(expected, rel=1e-6, abs=1e-12 * start)


def orders_of_residual(method, run):
    """The orders of the step with which the residual of a run without contact falls."""
    residuals = [
        run(overhung(), choose("robust", **METHODS[method], h=h), 0.04, speed=100.0, stops=40).read(
            "energy.residual"
        )
        for h in (2e-5, 1e-5, 5e-6)
    ]
    return np.log2(np.abs(residuals[:-1]) / np.abs(residuals[1:]))


@pytest.mark.parametrize("method", METHODS)
def test_without_contact_the_residual_falls_with_the_square_of_the_step(method):
    orders = orders_of_residual(method, partial(run, rate=2000.0))
    assert orders == pytest.approx(2, abs=0.3)


@pytest.mark.parametrize(
    "internal", [{"eta_v": 2e-4}, {"eta_h": 0.02}, {"eta_v": 1e-4, "eta_h": 0.01}]
)
@pytest.mark.parametrize("speed", [60.0, -250.0])
def test_the_ledger_closes_with_internal_damping_that_turns(internal, speed):
    rotor = overhung(**internal, rotating_damping=True)
    sim = run(rotor, choose("robust", method="newmark", h=2e-5), 0.3, speed=speed, rate=speed)
    assert losses(sim) > 1e-4
    assert abs(sim.read("energy.residual")) < 1e-3 * losses(sim)


def test_every_loss_of_the_rig_only_grows():
    sim = Simulation(rig(), choose("robust", h=2e-4), speed=215.0, rate=-10.0)
    names = [name for name in sim.names if name.endswith("_loss")]
    before = np.zeros(len(names))
    for t in np.linspace(0, 2, 401)[1:]:
        sim.advance(t, 215 - 10 * sim.time)
        now = np.array([sim.read(name) for name in names])
        assert np.all(now >= before * (1 - 1e-12))
        before = now
    assert np.all(before > 0)


def test_a_constant_force_works_force_times_way():
    loads = np.array([3.0 - 5.0j, -2.0j])
    rotor = overhung()
    start = Simulation(rotor, choose("robust"), speed=100.0)
    sim = run(rotor, choose("robust", h=1e-5), 0.1, speed=100.0, loads=loads)
    at = sim.structure.load_dof
    way = sim.motion.q[at] - start.motion.q[at]
    work = (loads.conjugate() * way).sum().real
    assert abs(work) > 1e-4
    assert sim.read("energy.external_work") == pytest.approx(work, rel=1e-6)


def test_a_jump_of_the_speed_is_work_of_the_drive():
    sim = Simulation(overhung(), choose("robust", h=1e-5), speed=100.0)
    sim.advance(0.05, 100.0)
    before, inertia = sim.read("energy.drive_work"), sim.structure.numbers[0].inertia
    sim.advance(0.05 + 1e-5, 120.0)
    jump = 0.5 * inertia * (120.0**2 - 100.0**2)
    assert sim.read("energy.drive_work") - before == pytest.approx(jump, rel=0.01)
    sim.advance(0.1, 120.0)
    assert abs(sim.read("energy.residual")) < 1e-4 * losses(sim) + 1e-6 * jump


def test_a_balanced_rotor_speeds_up_by_its_moment_of_inertia_alone():
    rotor = balanced(overhung(gravity=0.0))
    inertia = sum(disc.polar_inertia(STEEL.density) for disc in rotor.discs)
    inertia += STEEL.density * 0.7 * math.pi / 32 * 0.02**4
    sim = run(rotor, choose("robust"), 0.1, speed=50.0, rate=30.0)
    assert sim.read("tau") == pytest.approx(30 * inertia, rel=1e-9)
    assert sim.read("energy.kinetic") == pytest.approx(0.5 * inertia * 53.0**2, rel=1e-9)


@pytest.mark.parametrize("omega", [-280.0, 280.0])
def test_at_constant_speed_the_drive_supplies_what_is_lost(omega):
    h, settle, window = 2e-4, 2.0, 40 * 2 * math.pi / abs(omega)
    sim = Simulation(rig(), choose("robust", h=h), speed=omega)
    sim.advance(settle, omega)
    before = losses(sim), sim.read("energy.drive_work")
    times = np.linspace(settle, settle + window, round(window / h) + 1)
    torques = [sim.read("tau")]
    for t in times[1:]:
        sim.advance(t, omega)
        torques.append(sim.read("tau"))
    lost = losses(sim) - before[0]
    assert lost > 1
    assert sim.read("energy.drive_work") - before[1] == pytest.approx(lost, rel=0.005)
    assert np.trapezoid(torques, times) * omega == pytest.approx(lost, rel=0.005)


@pytest.mark.parametrize("omega", [100.0, -100.0])
def test_a_balanced_rotor_climbs_by_the_angle_of_friction(omega):
    machine = rig()
    bearings = tuple(replace(b, mu=0.2, cx=2000.0, cy=2000.0) for b in machine.bearings)
    sim = Simulation(
        balanced(machine).with_parts(Bearing, *bearings), choose("robust"), speed=omega
    )
    sim.advance(3.0, omega)
    friction_angle = math.copysign(math.atan(0.2), omega)
    weight = abs(sim.structure.static_load[::2].sum())
    for j in (1, 2):
        psi = sim.read(f"bearing[{j}].psi")
        assert psi == pytest.approx(1.5 * math.pi - friction_angle, abs=1e-3)
    # N = W / sqrt(1 + mu^2) stands on the rotor with its friction
    torque = 7.5e-3 * weight * math.sin(friction_angle)
    assert sim.read("tau") == pytest.approx(torque, rel=1e-3)


WALL = {"journal_radius": 0.01, "clearance": 2e-5, "mu": 0.2, "k": 2e7}
NEAR = {**WALL, "clearance": 1e-5}
AWAY = {**WALL, "clearance": 0.1}
STILL = {"race_inertia": 1e9}
FILM = {"length": 0.02, "journal_radius": 0.02, "clearance": 1e-4, "short": True}
PADS = {
    **(FILM | {"short": False, "points": 12.0}),
    **{"pads": (0.8, 2.4, 4.0, 5.5), "arc": 1.2, "tilting": True, "pad_inertia": 1e-6},
}
RING = {
    **FILM,
    **{"outer_radius": 0.03, "outer_length": 0.02, "outer_clearance": 1e-4},
    **{"ring_mass": 0.05, "ring_inertia": 3e-5},
}
RING_AWAY = {
    **(RING | {"clearance": 0.1, "outer_clearance": 0.1, "outer_radius": 0.2}),
    **{"viscosity": 1e-12, "outer_viscosity": 1e-12, "ring_mass": 1e-20, "ring_inertia": 1e-24},
}
HEAT = {"bow_per_heat": 1e-9, "bow_decay": 0.1}
BALLS = {"count": 8, "pitch_diameter": 0.05, "element_diameter": 0.01, "k": 1e9}
TOUCHES = ("compression", "contact_loss", "friction_loss")
# A part with a law and its entries of the ledger; such a part, and what acts as it does: another
# kind, or nothing where the part carries nothing.
KINDS = {
    "contact": (
        ClearanceContact(node=2, **WALL),
        TOUCHES,
        (ClearanceContact(node=2, **WALL), TouchdownBearing(node=2, **WALL, **STILL)),
    ),
    "touchdown_bearing": (
        TouchdownBearing(node=3, **WALL, race_inertia=1e-4, race_drag=0.01),
        ("races", "drag_loss", *TOUCHES),
        (TouchdownBearing(node=3, **WALL, **STILL), ClearanceContact(node=3, **WALL)),
    ),
    "linear_bearing": (
        LinearBearing(node=3, kxx=1e5, kxy=2e4, kyy=1e5, cxx=50.0, cyy=50.0),
        ("bearings", "bearings_loss", "circulation_loss"),
        (LinearBearing(node=3, kxx=1e5, kyy=1e5, cxx=50.0, cyy=50.0), Support(3, 1e5, 50.0)),
    ),
    "sticking contact": (
        ClearanceContact(node=2, **WALL, k_t=1e6),
        TOUCHES,
        (ClearanceContact(node=2, **AWAY, k_t=1e6),),
    ),
    "heated_contact": (
        HeatedContact(node=2, **WALL, **HEAT),
        TOUCHES,
        (HeatedContact(node=2, **AWAY, **HEAT),),
    ),
    "bearing": (
        Bearing(node=2, **NEAR, mass=1.0, kx=1e6, ky=1e6, cx=500.0, cy=500.0),
        ("housing_loss", *TOUCHES),
        (Bearing(node=2, **AWAY, mass=1.0, kx=1e6, ky=1e6, cx=500.0, cy=500.0),),
    ),
    "rolling_bearing": (
        RollingBearing(node=3, **BALLS),
        ("compression", "contact_loss"),
        (RollingBearing(node=3, **BALLS, clearance=0.1),),
    ),
    "journal_bearing": (
        JournalBearing(node=3, **FILM, viscosity=0.01),
        ("film_loss",),
        (JournalBearing(node=3, **(FILM | {"clearance": 0.1}), viscosity=1e-12),),
    ),
    "tilting pads": (
        JournalBearing(node=3, **PADS, viscosity=0.01),
        ("pads", "film_loss"),
        (JournalBearing(node=3, **(PADS | {"clearance": 0.1}), viscosity=1e-12),),
    ),
    "squeeze_film_damper": (
        SqueezeFilmDamper(node=3, **FILM, viscosity=0.01, stiffness=1e6),
        ("centring", "film_loss"),
        (SqueezeFilmDamper(node=3, **(FILM | {"clearance": 0.1}), viscosity=1e-12),),
    ),
    "floating_ring_bearing": (
        FloatingRingBearing(node=3, **RING, viscosity=0.01, outer_viscosity=0.02),
        ("rings", "film_loss"),
        (FloatingRingBearing(node=3, **RING_AWAY),),
    ),
}


def entries(seconds, *parts):
    sim = run(overhung(others=parts), choose("robust", h=2e-5), seconds, speed=200.0, stops=1)
    return {n.removeprefix("energy."): sim.read(n) for n in sim.names if n.startswith("energy.")}


@pytest.mark.parametrize("seconds", [0.025, pytest.param(0.05, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", KINDS)
def test_an_entry_is_its_own_whatever_stands_beside_it(kind, seconds):
    """All other kinds at once, and what acts as they do."""
    part, names, _ = KINDS[kind]
    others = [beside for other, (_, _, beside) in KINDS.items() if other != kind]
    result = entries(seconds, part, *(beside for beside, *_ in others))
    expected = entries(seconds, part, *(each for _, *alike in others for each in alike))
    for name in names:
        assert abs(result[name]) > 0
        assert result[name] == pytest.approx(expected[name], rel=1e-5)


def test_every_law_stands_beside_every_other():
    parts = [part for part, _, _ in KINDS.values()]
    laws = {e.law for part in parts for e in part.elements("part", 7800.0) if hasattr(e, "law")}
    assert laws == set(LAWS)
