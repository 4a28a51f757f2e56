"""Sensitivities over a step against rollback differences, and derivatives of what can be read
against differences of a run with small steps."""

import re

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import CouplingOptions, Simulation

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


def test_so_they_are_of_a_journal_that_sticks_at_rest():
    """Whose spring is stretched by nothing but rounding, in a contact beside the vertical."""
    load = np.zeros(4, dtype=complex)
    load[0] = 3 + 2j
    made = Differences(parse_rotor(STICKING), 0.0, 0)
    made.loads, options = load, {"speed": 0.0, "loads": load, "coupling": ON}
    made.simulation = Simulation(parse_rotor(STICKING), choose("robust"), **options)
    made.simulation.advance(H, 0.0, load)
    made.start, made.to = made.simulation.snapshot(), 2 * H
    assert not within(made.errors((*MOTIONS, "bearing[2].ft"), [0], 1e-2), 1e-3)


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


def test_a_torques_second_derivative_nears_differences_with_the_square_of_the_step():
    """Of the rig that rubs; it involves the fourth derivative of the motion."""
    worst = []
    for h in (2e-6, 1e-6):
        run = Simulation(rig(), choose("robust", h=h), speed=400.0)
        at, to, seen = run.names.index("tau"), 0.06, []
        run.advance(to, 400.0)
        for i in range(1, 201):
            run.advance(to + i * 0.2 * SPACING, 400.0)
            seen.append((run.observed[at], run.derivatives()[1, at]))
        tau, second = np.array(seen).T
        differences = [25.0 * stencil(tau[i - 3 : i + 4])[1] for i in range(3, len(tau) - 3)]
        worst.append(np.abs(second[3:-3] - differences).max() / np.abs(differences).max())
    assert worst[0] < 0.6
    assert worst[0] / worst[1] == pytest.approx(4.0, rel=0.1)
