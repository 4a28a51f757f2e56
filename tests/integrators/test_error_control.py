"""Error-controlled steps: what the tolerance promises, and what must not upset the step length."""

from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.settings import SettingsError, choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.time_loop import error_control
from rotor_fmu.model.time_loop.block import LAYOUT, new_block
from rotor_fmu.model.time_loop.error_control import GROWTH, SHRINKAGE

from ..machines import DISCS, balanced, overhung
from ..validation.whip import overhung_machine

next_length = interpreted(error_control.next_length)
next_stage_length = interpreted(error_control.next_stage_length)
repeated_length = interpreted(error_control.repeated_length)


def orbit(settings, stop=1.0, interval=0.02, speed=205.0, rate=-10.0, rotor=None):
    """Disc 3 of a run-down at the ends of the intervals [m], and the simulation."""
    sim = Simulation(rotor or rig(), settings, speed=speed, rate=rate)
    seen = []
    for i in range(round(stop / interval)):
        sim.advance((i + 1) * interval, speed + rate * i * interval)
        seen.append(complex(sim.read("disc[3].x"), sim.read("disc[3].y")))
    return np.array(seen), sim


def test_errors_fall_with_the_tolerance_and_keep_to_ten_times_of_it():
    """Through the vertical resonance, against steps some twenty times shorter."""
    exact, fine = orbit(choose("robust", h=1e-5))
    size = np.abs(exact).max()
    assert fine.read("bearing[1].contact") == 1.0
    for tolerance in (1e-2, 1e-3, 1e-4):
        result, sim = orbit(choose(tolerance=tolerance))
        error = np.abs(result - exact).max() / size
        assert 0.03 * tolerance < error < 10 * tolerance
        assert sim.read("solver.steps") < fine.read("solver.steps") / 2


@pytest.mark.parametrize("speed", [100.0, 150.0, 200.0, 300.0])
@pytest.mark.parametrize("rho", [0.3, 0.5])
def test_journals_knocked_about_settle_instead_of_bouncing_for_ever(rho, speed):
    """By fixed steps of 0.5 ms rho = 0.5 falls into the false state."""
    for kick in (1.0, 3.0, 6.0):
        settings = choose(rho=rho, tolerance=1e-2)
        sim = Simulation(rig(), settings, speed=speed, warn=lambda message: None)
        sim.advance(0.2, speed)
        sim.motion.v[sim.structure.interfaces.dof] += kick * np.exp(1j * kick)
        sim.advance(1.2, speed)
        before = sim.read("solver.trapped")
        sim.advance(1.5, speed)
        assert sim.read("solver.trapped") == before


@pytest.mark.slow
def test_twenty_phases_give_the_same_peaks_and_no_false_state():
    peaks = []
    for i in range(20):
        discs = tuple(replace(disc, phase=1e-5 * i) for disc in rig().discs)
        sim = Simulation(
            rig().with_parts(Disc, *discs), choose(tolerance=1e-4), speed=400.0, rate=-10.0
        )
        largest = np.zeros(2)
        for k in range(400):
            sim.advance(0.1 * (k + 1), 400.0 - k)
            if k > 20:
                amplitudes = [sim.read(f"disc[3].{axis}_amp") for axis in "xy"]
                largest = np.maximum(largest, amplitudes)
        peaks.append(largest)
        assert sim.read("solver.trapped") == 0
    assert np.all(np.ptp(peaks, axis=0) < 2e-3 * np.median(peaks, axis=0))


FAR = ClearanceContact(node=3, journal_radius=0.02, clearance=1.0, mu=0.1, k=1e7)


@pytest.mark.parametrize("clearance", [1e-4, 2.5e-4, 3e-3, 2e-2])
@pytest.mark.parametrize("e", [1e-7, 1e-5])
def test_a_tolerance_is_of_the_motion_whatever_the_clearance(clearance, e):
    """A machine that touches nothing, through its resonance: peak and phase by the same machine
    with a tolerance of 1e-5, and steps that do not depend on the wall."""
    wall = replace(FAR, clearance=clearance)
    discs = (replace(DISCS[0], e=e), DISCS[1])
    rotor = overhung(discs=discs, others=(wall,), gravity=0.0)
    peaks, orbits = [], []
    for tolerance in (1e-2, 1e-3, 1e-5):
        seen, _ = through_resonance(rotor, tolerance)
        orbits.append(seen)
        peaks.append(np.abs(seen).max())
    assert peaks[-1] < 0.9 * clearance
    assert peaks[0] == pytest.approx(peaks[-1], rel=0.1)
    assert peaks[1] == pytest.approx(peaks[-1], rel=0.02)
    assert np.abs(orbits[1] - orbits[-1]).max() < 10 * 1e-3 * peaks[-1]


def through_resonance(rotor, tolerance):
    """The last disc's orbit of a run-up [m], and the simulation."""
    sim = Simulation(rotor, choose(tolerance=tolerance), speed=100.0, rate=100.0)
    node = 2 * (rotor.discs[-1].node - 1)
    seen = []
    for k in range(200):
        sim.advance(0.005 * (k + 1), 100.0 + 0.5 * k)
        seen.append(sim.motion.q[node])
    return np.array(seen), sim


@pytest.mark.parametrize("modes", [0, 40])
def test_a_tolerance_means_the_same_in_component_modes(modes):
    """All modes are the machine itself in other coordinates."""
    seen, sim = orbit(choose(tolerance=1e-2, reduction=modes))
    exact, whole = orbit(choose(tolerance=1e-2))
    assert sim.read("solver.steps") == pytest.approx(whole.read("solver.steps"), rel=0.05)
    assert np.abs(seen - exact).max() < 10 * 1e-2 * np.abs(exact).max()


WRONG_BRANCH = {
    "paper, 1 ms": choose("paper", h=1e-3),
    "paper, 0.5 ms": choose("paper", h=5e-4),
    "paper, 0.4 ms": choose("paper", h=4e-4),
    "Newmark, 1 ms": choose("robust", method="newmark", h=1e-3),
    "Newmark, 0.5 ms": choose("robust", method="newmark", h=5e-4),
}


@pytest.mark.parametrize("name", WRONG_BRANCH)
def test_a_fixed_step_that_ends_on_another_branch_is_called_too_coarse(name):
    """The overhung machine at 400 rad/s moves by 224 um by tolerances from 1e-2 to 1e-4 alike."""
    said = []
    rotor, settings = overhung_machine(), WRONG_BRANCH[name]
    sim = Simulation(rotor, settings, speed=400.0, warn=said.append)
    peak = 0.0
    for k in range(100):
        sim.advance(0.01 * (k + 1), 400.0)
        peak = max(peak, sim.read("disc[1].r_amp")) if k > 50 else 0.0
    assert peak != pytest.approx(224e-6, rel=0.1)
    assert any(message.startswith("too coarse in contact") for message in said)


def test_a_fixed_step_that_is_fine_enough_is_not():
    said = []
    sim = Simulation(
        overhung_machine(mu=0.05), choose("robust", h=2e-4), speed=300.0, warn=said.append
    )
    for k in range(100):
        sim.advance(0.01 * (k + 1), 300.0)
    assert sim.read("disc[1].r_amp") == pytest.approx(150.4e-6, rel=0.01)
    assert said == []
    assert 0.0 < sim.read("solver.error_rms") < sim.read("solver.error")


def test_short_communication_steps_do_not_spoil_the_step_length():
    _, whole = orbit(choose(tolerance=1e-2), stop=0.4, interval=0.4)
    _, cut = orbit(choose(tolerance=1e-2), stop=0.4, interval=0.4 / 401)
    assert whole.read("solver.h_last") > 2e-4
    # an interval of a millisecond costs at most one step more than its length asks for
    assert cut.read("solver.steps") < whole.read("solver.steps") + 2 * 401


def test_at_rest_the_steps_grow_to_the_longest():
    sim = Simulation(rig(), choose("controlled"), speed=0.0)
    sim.advance(2.0, 0.0)
    assert sim.read("solver.h_last") == pytest.approx(choose("controlled").h_max, rel=0.01)
    assert sim.read("disc[3].y") == pytest.approx(-238.396e-6, rel=1e-5)


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_a_rotor_without_bearings_or_anything_moving_it_takes_long_steps(gravity):
    sim = Simulation(balanced(overhung(gravity=gravity)), choose("controlled"), speed=50.0)
    sim.advance(1.0, 50.0)
    assert sim.read("solver.rejected") == 0
    assert sim.read("solver.steps") < 400


def test_a_rejected_step_leaves_nothing_behind():
    """Two runs that begin a step with wished lengths far apart, one of them hopeless."""
    ends = []
    for h in (1e-5, 4e-3):
        sim = Simulation(rig(), choose(tolerance=1e-5, h=h), speed=200.0, rate=-10.0)
        sim.advance(0.05, 200.0)
        ends.append((complex(sim.read("disc[3].x"), sim.read("disc[3].y")), sim))
    assert ends[1][1].read("solver.rejected") > ends[0][1].read("solver.rejected")
    assert abs(ends[1][0] - ends[0][0]) < 10 * 1e-5 * abs(ends[0][0])  # of the tolerance


def test_the_controller_keeps_to_its_limits():
    assert next_length(1e-3, 1e-3, 0.0, 0.0) == pytest.approx(GROWTH * 1e-3)
    assert next_length(1e-3, 1e-3, 1e6, 1.0) == pytest.approx(SHRINKAGE * 1e-3)
    # a growing error
    assert next_length(1e-3, 1e-3, 0.5, 0.1) < next_length(1e-3, 1e-3, 0.5, 0.5)


@pytest.mark.parametrize(
    ("propose", "error_gain", "trend_gain"),
    [(next_length, 0.35, 0.2), (next_stage_length, 0.175, 0.1)],
    ids=["generalized-alpha", "radau5"],
)
@pytest.mark.parametrize(("error", "before"), [(0.5, 0.6), (0.5, 0.3), (0.9, 0.9), (0.3, 0.1)])
def test_the_controller_has_the_gains_of_its_order(propose, error_gain, trend_gain, error, before):
    factor = 0.8 * error**-error_gain * (before / error) ** trend_gain
    assert propose(1e-3, 1e-3, error, before) == pytest.approx(factor * 1e-3, rel=1e-12)


def test_a_step_cut_short_neither_shortens_nor_hinders_the_next():
    assert next_length(1e-3, 0.5e-3, 0.9, 0.9) == pytest.approx(1e-3)
    assert next_length(1e-3, 0.5e-3, 1e-4, 1e-4) == pytest.approx(GROWTH * 1e-3)


def test_a_repeated_step_ends_where_a_journal_touches():
    run = LAYOUT.view_in_python(new_block(assemble(rig()), 0))
    structure, old, new = run.structure, run.motion, run.trial
    dof, clearance = structure.interfaces[0].dof, rig().bearings[0].clearance
    old.q[dof], new.q[dof] = 0.7 * clearance * 1j, 1.3 * clearance * 1j
    assert repeated_length(structure, choose().numbers, 1e-3, 100.0, old, new) == pytest.approx(
        0.5e-3
    )
    new.q[dof] = 0.9 * clearance * 1j
    assert repeated_length(structure, choose().numbers, 1e-3, 100.0, old, new) == pytest.approx(
        SHRINKAGE * 1e-3
    )


@pytest.mark.parametrize("tolerance", [0.0, -1e-3, float("nan"), float("inf")])
def test_a_tolerance_that_cannot_be_is_refused(tolerance):
    with pytest.raises(SettingsError, match=r"^tolerance = .*at least 1e-09 and at most 1"):
        choose(tolerance=tolerance)


def test_the_rigs_run_down_takes_few_steps():
    """188 913 before amplitudes were weighed by the motion itself; a twentieth more is allowed."""
    sim = Simulation(rig(), choose(tolerance=1e-3), speed=400.0, rate=-10.0)
    for k in range(1000):
        sim.advance(0.04 * (k + 1), 400.0 - 0.4 * k)
    assert sim.read("solver.steps") < 1.05 * 188_913


def test_a_run_from_before_zero_takes_the_steps_of_one_from_zero():
    taken = []
    for start in (0.0, -1.0):
        sim = Simulation(rig(), choose("controlled"), t=start, speed=150.0)
        sim.advance(start + 0.02, 150.0)
        taken.append(sim.read("solver.steps"))
    assert taken[1] == pytest.approx(taken[0], abs=2)
