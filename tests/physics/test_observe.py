"""What can be read of a run is what its state says."""

import cmath
import math
import re

import numpy as np
import pytest
from rotor_fmu.examples import example_folder
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.parts.clearance_contact import contact_angle, contact_force
from rotor_fmu.model.parts.law import Kinematics
from rotor_fmu.model.quantities import ALL, NOTHING, SPEED
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop.observe import observed

from papers.dense_machine import clearance_contacts, rest
from rotor_fmu.fmi.interface import interface, ports
from rotor_fmu.machine_file.loading import load_rotor
from tools.checkout import ROOT

from ..machines import disc_dofs, overhung
from ..parts.machines import shaft

EXAMPLES = ROOT / "examples"


def rubbing_rig():
    """The rig in its resonance, stops of 2.5 ms, with its simulation at each."""
    sim = Simulation(rig(), choose("robust"), speed=185.0)
    for i in range(1, 201):
        sim.advance(0.0025 * i, 185.0)
        yield sim


def test_positions_are_those_of_the_state():
    for sim in rubbing_rig():
        q = sim.motion.q
        for i, dof in enumerate(disc_dofs(sim.rotor), 1):
            assert complex(sim.read(f"disc[{i}].x"), sim.read(f"disc[{i}].y")) == q[dof]
        for j, bearing in enumerate(clearance_contacts(sim.structure)):
            name = f"bearing[{j + 1}]"
            housing = complex(sim.read(f"{name}.housing_x"), sim.read(f"{name}.housing_y"))
            journal = complex(sim.read(f"{name}.x"), sim.read(f"{name}.y"))
            assert housing == q[bearing.end]
            assert journal == q[bearing.dof] - q[bearing.end]
            psi = sim.read(f"{name}.psi")
            assert 0 <= psi < 2 * math.pi
            assert cmath.rect(abs(journal), psi) == pytest.approx(journal)


@pytest.mark.parametrize("angle", [0.0, 1e-300, -1e-300, -1e-17, 3.0, -3.0, math.pi, -math.pi])
def test_the_contact_angle_lies_within_one_turn(angle):
    psi = interpreted(contact_angle)(complex(math.cos(angle), math.sin(angle)))
    assert 0 <= psi < 2 * math.pi
    assert cmath.rect(1, psi) == pytest.approx(cmath.rect(1, angle))


def test_contact_forces_are_those_of_the_law():
    touched = []
    for sim in rubbing_rig():
        q, v = sim.motion.q, sim.motion.v
        for j, bearing in enumerate(clearance_contacts(sim.structure)):
            d, d_dot = q[bearing.dof] - q[bearing.end], v[bearing.dof] - v[bearing.end]
            omega = sim.read("w")
            contact = interpreted(contact_force)(bearing, Kinematics(d, d_dot, omega, omega, 0.0))
            force, normal = contact.force, contact.normal
            name = f"bearing[{j + 1}]"
            friction = math.sqrt(max(0.0, abs(force) ** 2 - normal**2))
            assert sim.read(f"{name}.fn") == pytest.approx(normal)
            assert abs(sim.read(f"{name}.ft")) == pytest.approx(friction, rel=1e-6, abs=1e-9)
            assert sim.read(f"{name}.contact") == (normal > 0)
            touched.append(contact.penetration > 0)
    assert any(touched)
    assert not all(touched)


def test_friction_is_positive_where_it_brakes_a_shaft_that_turns_forwards():
    for omega in (100.0, -100.0):
        sim = Simulation(rig(), choose("robust"), speed=omega)
        sim.advance(0.01, omega)
        assert sim.read("bearing[1].ft") * omega > 0


@pytest.mark.parametrize("speed", [190.0, -190.0])
def test_once_a_turn_is_what_order_tracking_finds_in_a_rub(speed):
    """Against the revolution-synchronous resampling of the recorded motion, with its window."""
    names = ("disc[3].x", "disc[3].y")
    sim = Simulation(rig(), speed=speed, record=names)
    assert sim.read("disc[3].x_1x") == 0.0  # before the first whole revolution
    turn = 2 * math.pi / abs(speed)
    shown = []
    for k in range(1, 41):
        sim.advance((k + 0.01) * turn, speed)
        shown.append(
            [
                sim.read(f"disc[3].{axis}_1x") * np.exp(1j * sim.read(f"disc[3].{axis}_1x_phase"))
                for axis in "xy"
            ]
        )
    assert sim.read("bearing[2].fn") > 0.0
    rows = sim.drain()
    t, z = rows[:, 0], rows[:, 1] + 1j * rows[:, 2]
    for k in range(36, 40):
        at = np.linspace(k * turn, (k + 1) * turn, 2000, endpoint=False)
        moved = np.interp(at, t, z.real), np.interp(at, t, z.imag)
        for axis, part in enumerate(moved):
            # a lag is negative whichever way the shaft turns
            right = 2 * (part * np.exp(-1j * abs(speed) * at)).mean()
            assert abs(shown[k][axis] - right) < 1e-3 * abs(right), (k, axis)


AMPLITUDES = ("x_amp", "y_amp", "r_amp", "x_1x", "y_1x")


def test_what_is_of_the_last_revolution_is_nothing_minutes_after_the_shaft_stands():
    """Stopped at once from 130 rad/s and left alone: vibration dies away, and is reported."""
    settings = choose("controlled", tolerance=1e-4)
    sim = Simulation(overhung(eta_v=1e-3), settings, speed=130.0, continues_speed=False)
    still = rest(sim.rotor)
    dof = disc_dofs(sim.rotor)[1]
    sim.advance(2.0, 130.0)
    before = {name: sim.read(f"disc[2].{name}") for name in AMPLITUDES}
    assert min(before.values()) > 1e-6
    for i in range(1, 121):
        sim.advance(2.0 + i, 0.0)
        shown = {name: sim.read(f"disc[2].{name}") for name in AMPLITUDES}
        assert shown["x_1x"] == shown["y_1x"] == 0.0
        assert shown["r_amp"] >= abs(sim.motion.q[dof] - still[dof])
    assert all(shown[name] < 0.02 * before[name] for name in AMPLITUDES)


@pytest.mark.parametrize("way", [1, -1])
def test_what_is_of_the_last_revolution_begins_anew_where_the_shaft_turns_back(way):
    sim = Simulation(overhung(eta_v=1e-3), choose("controlled"), speed=60.0 * way, rate=-60.0 * way)
    seen = []
    for i in range(1, 401):
        sim.advance(0.005 * i, way * (60.0 - 0.3 * (i - 1)))
        seen.append([sim.read("phi"), *(sim.read(f"disc[2].{name}") for name in AMPLITUDES)])
    seen = np.array(seen)
    turned = way * seen[:, 0]
    back = int(np.argmax(turned))
    assert seen[back - 5, 4] > 0.0
    first = slice(back + 1, back + int(np.argmax(turned[back:] < turned[back] - 2 * math.pi)))
    assert first.stop > first.start + 10
    assert not seen[first, 4:].any()
    assert (seen[first.stop :, 4:] > 0).all()


def test_a_shaft_that_turns_slowly_still_has_its_last_revolution():
    speed = 0.1  # rad/s, a revolution a minute
    sim = Simulation(overhung(eta_v=1e-3), choose("controlled"), speed=speed)
    for i in range(1, 131):
        sim.advance(float(i), speed)
    assert sim.read("disc[2].x_1x") > 0.0
    assert sim.read("disc[2].x_amp") >= sim.read("disc[2].x_1x") * 0.99


def test_amplitudes_are_the_largest_distances_from_rest_over_the_last_revolutions():
    omega = 130.0
    h = 2 * math.pi / omega / 200
    sim = Simulation(overhung(eta_v=1e-3), choose("robust", h=h), speed=omega)
    still = rest(sim.rotor)
    away = []
    for i in range(1, 2001):
        sim.advance(i * h, omega)
        away.append((sim.motion.q - still)[disc_dofs(sim.rotor)])
        # at least the last revolution, at most the two last
        for k in (1, 2):
            so_far = np.array(away)[:, k - 1]
            sizes = {"x": np.abs(so_far.real), "y": np.abs(so_far.imag), "r": np.abs(so_far)}
            for axis, distance in sizes.items():
                shown = sim.read(f"disc[{k}].{axis}_amp")
                assert distance[-200:].max() <= shown * (1 + 1e-12)
                assert shown <= distance[-402:].max() * (1 + 1e-12)


def test_a_peak_is_also_of_all_since_the_last_communication_point():
    """As its text says: a host with long steps misses none."""
    by_name = {of.name: of.text for of in interface(rig())}
    for name in ("disc[3].x_amp", "disc[3].r_amp", "bearing[1].fn_peak"):
        assert "over the last whole revolution and after it, and since the last" in by_name[name]
    at_once, often, seen = Simulation(rig(), speed=100.0), Simulation(rig(), speed=100.0), []
    at_once.advance(1.0, 100.0)
    for i in range(500):
        often.advance(2e-3 * (i + 1), 100.0)
        seen.append(often.read("disc[3].r_amp"))
    assert at_once.read("disc[3].r_amp") == pytest.approx(max(seen), rel=1e-2)
    assert seen[-1] < 0.7 * max(seen)


def test_every_output_is_filled_in():
    """Of every example machine, but for what only a run with sensitivities has."""
    files = [f for f in sorted(EXAMPLES.glob("*/*.toml")) if f.parent.name != "studies"]
    for rotor in (load_rotor(file)[1] for file in files):
        sim = Simulation(rotor, choose("robust"), speed=100.0, warn=lambda message: None)
        sim.observed[:] = math.nan
        sim.advance(5e-4, 100.0)
        left = [n for n, v in zip(sim.names, sim.observed, strict=True) if math.isnan(v)]
        assert not [name for name in left if not re.search(r"(^|\.)d\w+_d(drive|fx|fy)$", name)]


def test_counters_count():
    sim = Simulation(rig(), choose("robust", h=5e-4), speed=300.0)
    assert sim.read("solver.steps") == 0
    sim.advance(0.1, 300.0)
    assert sim.read("solver.steps") == 200
    assert sim.read("solver.h_last") == pytest.approx(5e-4)
    assert sim.read("solver.newton") >= 200
    assert sim.read("solver.rejected") == 0
    assert sim.read("solver.trapped_at") == -1
    assert len(sim.names) == len(set(sim.names)) == len(sim.observed)


SUPPORTED = (
    shaft(0.0, 0.2, 0.4)
    + """
[[disc]]
node = 2
diameter = 0.1
width = 0.02
e = 1e-4
[[linear_bearing]]
node = 1
speed = [-400.0, 0.0, 400.0]
kxx = [2e6, 1e6, 3e6]
kyy = 2e6
kxy = [0.0, 1e5, 3e5]
cxx = 100.0
cyy = [100.0, 120.0, 180.0]
[[support]]
node = 3
stiffness = 1e6
damping = 100.0
[[touchdown_bearing]]
node = 2
journal_radius = 0.01
clearance = 1e-6
mu = 0.1
k = 1e8
race_inertia = 1e-4
race_drag = 0.01
"""
)


def changed_at_an_instant(sim, usual, drive, loads):
    """Names of what changes when drive and loads jump and no time passes."""

    def seen(drive, loads):
        sim.restore(before)
        sim.advance(sim.time, drive, loads)
        return sim.observed.copy()

    before = sim.snapshot()
    jump = np.abs(seen(drive, loads) - seen(usual, 0 * loads))
    sim.restore(before)
    table = observed(sim.rotor)
    sizes = np.array([entry.output.nominal or 1.0 for entry in table])
    return {str(table[i].name) for i in np.flatnonzero(jump > 1e-9 * sizes)}


ROLLING = (example_folder("rolling_bearing") / "rotor.toml").read_text(encoding="utf-8")
MACHINES = {"rig": rig_toml(), "rolling bearings": ROLLING, "other parts": SUPPORTED}


@pytest.mark.parametrize("machine", MACHINES.values(), ids=MACHINES)
def test_what_reaches_an_output_within_an_instant_is_declared(machine):
    rotor = parse_rotor(machine)
    by_speed, by_load = set(), set()
    for free in ({}, {"drive_torque": 0.05}):
        sim = Simulation(rotor, choose("robust"), speed=185.0, **free)
        loads = np.full(len(sim.structure.load_dof), 3.0 - 5.0j)
        drive = free.get("drive_torque", 185.0)
        for i in range(1, 41):
            sim.advance(0.005 * i, drive, 0 * loads)
            by_load |= changed_at_an_instant(sim, drive, drive, loads)
            if not sim.is_free:
                by_speed |= changed_at_an_instant(sim, drive, -185.0, 0 * loads)
    declared = {str(name): output.reached_by for name, output in observed(rotor)}
    seen = dict.fromkeys(declared, NOTHING)
    seen |= dict.fromkeys(by_speed, SPEED) | dict.fromkeys(by_load, ALL)
    assert seen == declared


def test_a_wave_is_reached_by_the_force_of_its_own_line_alone():
    line = '[[line]]\nnode = 2\nimpedance = 50.0\nname = "joint"\n'
    sim = Simulation(parse_rotor(rig_toml() + line), choose("robust"), speed=185.0)
    sim.advance(0.1, 185.0)
    waves = [each for each in observed(sim.rotor) if each.name.quantity.startswith("wave_")]
    assert [each.output.reached_by for each in waves] == ["fx", "fy"]
    for load, (name, _) in enumerate(ports(sim.rotor)):
        for axis, force in (("x", 1.0), ("y", 1j)):
            loads = np.zeros(len(sim.structure.load_dof), dtype=complex)
            loads[load] = force
            reached = changed_at_an_instant(sim, 185.0, 185.0, loads)
            expected = {f"joint.wave_{axis}"} if name == "joint" else set()
            assert {str(each.name) for each in waves} & reached == expected
