"""Sensitivities over a step against rollback differences, and derivatives of what can be read
against differences of a run with small steps."""

import re

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import CouplingOptions, Simulation, StepFailure

from ..parts.films import in_films, on_dampers

H = 0.002
ON = CouplingOptions(has_sensitivities=True)
MOTIONS = ("disc[1].x", "disc[1].y", "disc[2].x", "disc[3].x", "disc[3].y")
FORCES = ("bearing[1].fn", "bearing[2].fn", "bearing[2].psi", "bearing[2].ft")
DRIVES = ("w", "phi", "a", "tau", "tau_load")
STICKING = re.sub(r"(mu = [0-9.]+)", r"\1\nk_t = 1e6\nc_t = 50.0", rig_toml(), count=2)
LINE = rig_toml() + '[[line]]\nnode = 2\nimpedance = 50.0\nname = "joint"\n'


class Differences:
    """A step that can be made again with an input changed."""

    def __init__(self, rotor, speed, steps, torque=None, coupling=ON):
        options = {} if torque is None else {"drive_torque": torque}
        self.drive = speed if torque is None else torque
        self.simulation = Simulation(
            rotor, choose("robust"), speed=speed, coupling=coupling, **options
        )
        places = len(self.simulation.structure.load_dof)
        self.loads = np.zeros(places, dtype=complex)
        self.loads[0] = 3 + 2j
        for i in range(steps):
            self.simulation.advance((i + 1) * H, self.drive, self.loads)
        self.start, self.to = self.simulation.snapshot(), (steps + 1) * H
        self.inputs = 1 + 2 * places

    def end(self, row, change):
        """What can be read after the step with the input of a row changed."""
        loads, drive = self.loads.copy(), self.drive
        if row == 0:
            drive += change
        else:
            loads[(row - 1) // 2] += change * (1.0 if row % 2 else 1j)
        self.simulation.restore(self.start)
        self.simulation.advance(self.to, drive, loads)
        return self.simulation.observed.copy()

    def derivative(self, row, change):
        """Of fourth order in the change."""
        one, half = (
            (self.end(row, by) - self.end(row, -by)) / (2 * by) for by in (change, change / 2)
        )
        return (4 * half - one) / 3

    def sensitivities(self):
        self.end(0, 0.0)
        return np.array([self.simulation.sensitivities(row) for row in range(self.inputs)])

    def errors(self, names, rows, change):
        """Largest differences, relative to the largest sensitivity of what is read to such
        inputs."""
        seen = self.sensitivities()
        at = [self.simulation.names.index(name) for name in names]
        expected = np.array([self.derivative(row, change)[at] for row in rows])
        seen = seen[np.ix_(rows, at)]
        size = np.abs(seen).max(axis=0)
        assert size.all()
        return dict(zip(names, np.abs(seen - expected).max(axis=0) / size, strict=True))


def within(errors, bound):
    return {name: error for name, error in errors.items() if not error < bound}


@pytest.mark.parametrize(
    ("toml", "speed", "steps"),
    [(rig_toml(), 400.0, 3), (rig_toml(), 200.0, 60), (STICKING, 0.5, 3), (LINE, 200.0, 20)],
    ids=["settled", "rubbing", "sticking", "with a line"],
)
def test_by_loads_and_speed_they_are_those_of_the_step_made_again_in_contact(toml, speed, steps):
    made = Differences(parse_rotor(toml), speed, steps)
    assert (np.abs(made.simulation.motion.force) > 0.0).all()
    read = (*MOTIONS, *FORCES, *(("joint.wave_x", "joint.wave_y") if toml == LINE else ()))
    assert not within(made.errors((*read, "tau"), range(1, made.inputs), 1e-3), 1e-6)
    assert not within(made.errors((*read, *DRIVES), [0], 1e-2), 1e-6)


def test_so_they_are_with_the_contacts_open():
    toml = re.sub(r"clearance = [0-9.e-]+", "clearance = 4e-4", rig_toml())
    toml += "[start]\nx = 0.0\ny = 1e-4\n"
    made = Differences(parse_rotor(toml), 300.0, 1)
    made.end(0, 0.0)
    assert (made.simulation.motion.force == 0.0).all()
    assert not within(made.errors((*MOTIONS, "tau"), range(1, made.inputs), 1e-3), 1e-6)
    assert not within(made.errors((*MOTIONS, *DRIVES), [0], 1e-3), 1e-6)


@pytest.mark.parametrize("impedance", [0.0, 0.5])
@pytest.mark.parametrize(
    ("toml", "speed", "steps", "change"),
    [(rig_toml(), 400.0, 3, 3.0), (rig_toml(), 200.0, 60, 0.03), (STICKING, 0.5, 3, 0.5)],
    ids=["settled", "rubbing", "sticking"],
)
def test_so_they_are_of_a_rotor_that_a_torque_drives(toml, speed, steps, change, impedance):
    """By a change [N.m] that moves the speed far above what its iteration leaves open, and that
    turns the contacts by little. Torques follow from speed and rate, closer than the run's own
    iteration has them."""
    coupling = CouplingOptions(has_sensitivities=True, drive_impedance=impedance)
    made = Differences(parse_rotor(toml), speed, steps, 0.05, coupling)
    read = (*MOTIONS, *FORCES, "w", "phi", "a")
    assert not within(made.errors(read, [0], change), 1e-6)
    assert not within(made.errors(read, range(1, made.inputs), 0.1), 1e-6)
    seen = dict(zip(made.simulation.names, made.sensitivities().T, strict=True))
    drive = np.arange(made.inputs) == 0
    torque, inertia = drive - impedance * seen["w"], made.simulation.read("J")
    assert seen["tau"] == pytest.approx(torque, rel=1e-14)
    assert seen["tau_wave"] == pytest.approx(torque - impedance * seen["w"], rel=1e-14)
    assert seen["tau_load"] == pytest.approx(torque - inertia * seen["a"], rel=1e-14)


LOBES = {"pads": [1.570796, 4.712389], "arc": 2.8, "preload": 0.4}
FILMS = {
    "short": (in_films(1e-5, short=True), 600.0),
    "finite": (in_films(1e-5, points=24.0), 600.0),
    "lobes": (in_films(1e-5, **LOBES, points=24.0), 600.0),
    "touching": (in_films(1e-5, points=24.0, k=1e7, roughness=4e-5), 20.0),
    "damper": (on_dampers(0.005), 600.0),
}


@pytest.mark.parametrize("name", FILMS)
@pytest.mark.parametrize("torque", [None, 0.05])
@pytest.mark.parametrize("steps", [1, 20])
def test_so_they_are_of_a_rotor_in_oil_films(name, torque, steps):
    rotor, speed = FILMS[name]
    made = Differences(rotor, speed, steps, torque)
    part = "squeeze_film_damper[1]" if name == "damper" else "journal_bearing[1]"
    assert made.simulation.read(f"{part}.contact") == (name == "touching")
    read = ["body[1].x", "body[1].y"]
    read += [f"{part}.{output}" for output in ("fx", "fy", "film", "eccentricity")]
    read += ["tau"] if torque is None and name != "damper" else []
    assert not within(made.errors(read, range(1, made.inputs), 0.25), 1e-6)
    change = 1e-4 * speed if torque is None else 1.0
    assert not within(made.errors([*read, "w", "phi"], [0], change), 1e-6)


def test_the_named_ones_are_entries_of_all():
    made = Differences(rig(), 400.0, 3)
    seen = made.sensitivities()
    names = made.simulation.names
    # the rig's loads: three discs and the coupling
    for disc in (1, 2, 3):
        for k, axis in enumerate("xy"):
            for read in "xy":
                entry = seen[2 * disc - 1 + k, names.index(f"disc[{disc}].{read}")]
                named = made.simulation.read(f"disc[{disc}].d{read}_df{axis}")
                assert named == pytest.approx(entry, rel=1e-8, abs=1e-14)
    for name in ("phi", "w", "tau", "tau_load"):
        named = made.simulation.read(f"d{name}_ddrive")
        assert named == pytest.approx(seen[0, names.index(name)], rel=1e-8)
    assert made.simulation.read("disc[3].dvx_dfx") > 0.0


@pytest.mark.parametrize("preset", ["robust", "controlled"])
@pytest.mark.parametrize("torque", [None, 0.02])
def test_they_change_no_bit_of_a_run_and_come_back_with_a_state(preset, torque):
    options = {} if torque is None else {"drive_torque": torque}
    runs = [
        Simulation(rig(), choose(preset), speed=200.0, coupling=coupling, **options)
        for coupling in (CouplingOptions(), ON)
    ]
    drive = 200.0 if torque is None else torque
    for i in range(30):
        for run in runs:
            run.advance((i + 1) * H, drive)
    off, on = runs
    named = np.array(["_ddrive" in name or "_df" in name for name in on.names])
    assert named.any()
    assert (off.observed[~named] == on.observed[~named]).all()
    assert (off.observed[named] == 0.0).all()
    snapshot, before = on.snapshot(), on.observed.copy()
    rows = [on.sensitivities(row) for row in range(3)]
    on.advance(31 * H, 1.01 * drive)
    after = on.observed.copy()
    on.restore(snapshot)
    assert (on.observed == before).all()
    assert all((on.sensitivities(row) == rows[row]).all() for row in range(3))
    on.advance(31 * H, 1.01 * drive)
    assert (on.observed == after).all()


def test_without_being_asked_for_there_are_none():
    with pytest.raises(ValueError, match="sensitivities: must be asked for"):
        Simulation(rig(), speed=400.0).sensitivities(0)


# --- by time ----------------------------------------------------------------------------------

SPACING = 1e-4


def stencil(values):
    """First and second derivatives in the middle of seven points, of sixth order."""
    a, b, c, d, e, f, g = values
    return (
        (-a + 9 * b - 45 * c + 45 * e - 9 * f + g) / (60 * SPACING),
        (2 * a - 27 * b + 270 * c - 490 * d + 270 * e - 27 * f + 2 * g) / (180 * SPACING**2),
    )


@pytest.mark.parametrize("torque", [None, 0.5])
def test_derivatives_by_time_are_differences_of_a_run_with_small_steps(torque):
    options = {} if torque is None else {"drive_torque": torque}
    toml = LINE.replace("node = 2\nimp", "node = 5\nimp")  # a disc's, where no mode is so fast
    run = Simulation(parse_rotor(toml), choose("robust", h=1e-6), speed=100.0, **options)
    loads = np.zeros(len(run.structure.load_dof), dtype=complex)
    drive = 100.0 if torque is None else torque
    to, points = 0.06, []
    rates = loads + 2.0 - 3.0j
    run.advance(to, drive, loads, load_rates=rates)
    for i in range(7):
        now = to + i * SPACING
        run.advance(now + SPACING, drive, loads + now * rates, load_rates=rates)
        points.append(run.observed.copy())
        if i == 3:
            seen = run.derivatives()
            assert (run.observed == points[-1]).all()
    expected = stencil(points)
    names = [*MOTIONS, "bearing[1].fn", "bearing[2].fn", "bearing[2].ft", "phi", "energy.elastic"]
    names += ["tau_load", "joint.wave_x", "joint.wave_y", *(("w", "a") if torque else ())]
    for name in names:
        at = run.names.index(name)
        assert seen[0, at] == pytest.approx(expected[0][at], rel=1e-4), name
        if name not in ("a", "tau_load"):  # of accelerations there is nothing to go further from
            rounding = 1e-13 * abs(run.read(name)) / SPACING**2
            assert seen[1, at] == pytest.approx(expected[1][at], rel=1e-4, abs=rounding), name


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


# --- energy, limits, lines --------------------------------------------------------------------


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
