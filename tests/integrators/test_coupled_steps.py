"""What a step tells the master of a coupled system: its energy, its end at a limit, its lines."""

import re

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import CouplingOptions, Simulation, StepFailure

from .test_sensitivities import LINE

H = 0.002


@pytest.mark.parametrize("torque", [None, 0.5])
def test_the_energy_of_a_step_grows_with_the_power_that_enters(torque):
    """Of a force f at a velocity v with f v, through a line of impedance Z with f v - Z v^2."""
    options = {} if torque is None else {"drive_torque": torque}
    run = Simulation(parse_rotor(LINE), choose("robust"), speed=100.0, **options)
    force, rate, t = 3.0 - 2.0j, 50.0 + 80.0j, 0.05
    everywhere = np.ones(len(run.structure.load_dof))
    drive = 100.0 if torque is None else torque
    run.advance(t, drive, force * everywhere, load_rates=rate * everywhere)
    force += rate * t
    before, (first, second) = run.observed.copy(), run.derivatives()
    assert (run.observed == before).all()
    for port, impedance in (("disc[1]", 0.0), ("disc[2]", 0.0), ("disc[3]", 0.0), ("joint", 50.0)):
        x, y, work = (run.names.index(f"{port}.{name}") for name in ("x", "y", "step_work"))
        v, a = complex(first[x], first[y]), complex(second[x], second[y])
        power = (force.conjugate() * v).real - impedance * abs(v) ** 2
        grows = (rate.conjugate() * v + (force - 2.0 * impedance * v).conjugate() * a).real
        assert first[work] == pytest.approx(power, rel=1e-6), port
        assert second[work] == pytest.approx(grows, rel=1e-4), port
    by_drive = first[run.names.index("step_work")]
    assert by_drive == pytest.approx(run.read("tau") * run.read("w"), rel=1e-6)


def test_the_energy_of_a_step_through_every_port_adds_up_to_the_ledger():
    toml = rig_toml() + "[base]\n"
    run = Simulation(parse_rotor(toml), speed=300.0)
    ports = [name for name in run.names if name.endswith("].step_work")]
    ports += ["coupling.step_work", "base.step_work"]
    loads = np.array([3 + 1j, -2j, 5.0, 1.0 + 1j, 0.5 - 0.3j])
    before = {name: run.read(name) for name in ("energy.external_work", "energy.drive_work")}
    for i in range(20):
        run.advance((i + 1) * H, 300.0 - i, loads * np.cos(i))
        passed = sum(run.read(name) for name in ports)
        total = run.read("energy.external_work") - before["energy.external_work"]
        scale = max(abs(run.read(name)) for name in ports)
        assert passed == pytest.approx(total, abs=1e-12 * scale + 1e-12 * abs(total) + 1e-15)
        drive = run.read("energy.drive_work") - before["energy.drive_work"]
        assert run.read("step_work") == pytest.approx(drive, rel=1e-12)
        before = {name: run.read(name) for name in before}
    assert scale > 0.0


def test_a_limit_ends_a_step_where_it_was_last_kept_and_once():
    free = Simulation(rig(), speed=200.0)
    largest, t = 0.0, 0.0
    while t < 0.2:
        t += H
        free.advance(t, 200.0)
        largest = max(
            largest,
            *(
                abs(complex(free.read(f"disc[{i}].x"), free.read(f"disc[{i}].y")))
                for i in (1, 2, 3)
            ),
        )
    limit = 0.7 * largest
    run = Simulation(rig(), speed=200.0, coupling=CouplingOptions(limit_displacement=limit))
    with pytest.raises(StepFailure, match=r"passes limit\.displacement = [0-9.e-]+ m, with"):
        run.advance(t, 200.0)
    assert 0.0 < run.time < t
    assert all(
        abs(complex(run.read(f"disc[{i}].x"), run.read(f"disc[{i}].y"))) <= limit for i in (1, 2, 3)
    )
    first = run.time
    with pytest.raises(StepFailure):
        run.advance(t, 200.0)
    assert run.time > first


def test_a_step_ends_where_a_contact_opens_and_where_it_closes():
    toml = rig_toml() + "[start]\nx = 0.0\ny = 0.0\n"
    run = Simulation(parse_rotor(toml), speed=50.0, coupling=CouplingOptions(stops_at_contact=True))
    assert (run.motion.force == 0.0).all()
    with pytest.raises(StepFailure, match=r"bearing\[\d\] closed"):
        run.advance(1.0, 50.0)
    assert np.count_nonzero(run.motion.force) >= 1
    with pytest.raises(StepFailure, match=r"bearing\[\d\] (opened|closed)"):
        run.advance(1.0, 50.0)


def test_the_line_of_a_drive_takes_off_what_its_impedance_says():
    """With nothing else on the shaft: J w' = a - Z w."""
    toml = re.sub(r"mu = [0-9.]+", "mu = 0.0", rig_toml())
    toml = re.sub(r"\be = [0-9.e-]+", "e = 0.0", toml)
    rotor = parse_rotor(toml)
    wave, impedance = 2.0, 0.5
    run = Simulation(
        rotor,
        choose("robust", h=1e-4),
        speed=0.0,
        drive_torque=wave,
        coupling=CouplingOptions(drive_impedance=impedance),
    )
    inertia = run.read("J")
    run.advance(0.02, wave)
    expected = wave / impedance * (1 - np.exp(-impedance * 0.02 / inertia))
    assert run.read("w") == pytest.approx(expected, rel=1e-5)
    assert run.read("tau_wave") == pytest.approx(wave - 2 * impedance * run.read("w"), rel=1e-7)
    taken = wave * run.read("phi")
    assert run.read("step_work") < taken


def test_the_line_of_a_node_is_a_damper_with_a_wave():
    run = Simulation(parse_rotor(LINE), speed=200.0)
    loads = np.zeros(len(run.structure.load_dof), dtype=complex)
    at = int(np.flatnonzero(run.structure.load_arms.impedance > 0.0)[0])
    loads[at] = 20.0 + 5.0j
    for i in range(10):
        run.advance((i + 1) * H, 200.0, loads)
    v = complex(run.read("joint.vx"), run.read("joint.vy"))
    wave = complex(run.read("joint.wave_x"), run.read("joint.wave_y"))
    assert abs(v) > 0.0
    assert wave == pytest.approx(20.0 + 5.0j - 100.0 * v, rel=1e-12)
