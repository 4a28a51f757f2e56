"""RotorBearingFree.fmu: torque in, speed out; and the energy of both FMUs."""

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop.observe import observed_names

from rotor_fmu.cosimulation.member import Member
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import is_current

LOSSES = [name for name in observed_names(rig()) if name.endswith("_loss")]
LEDGER = ["energy.residual", "energy.drive_work", *LOSSES]


def test_its_description_is_valid_and_that_of_the_table(free_fmu):
    assert validate_fmu(str(free_fmu)) == []
    description = fmpy.read_model_description(str(free_fmu))
    assert description.coSimulation.modelIdentifier == "RotorBearingFree"
    table = interface(rig(), is_free=True)
    for variable, listed in zip(description.modelVariables, table, strict=True):
        assert (variable.name, variable.causality) == (listed.name, listed.causality)
    causality = {v.name: v.causality for v in description.modelVariables}
    assert causality["tau_drive"] == "input"
    assert {causality[name] for name in ("w", "phi", "a")} == {"output"}
    assert "speed" not in causality


def test_both_fmus_have_the_same_variables_beside_the_drive():
    driven, free = ({v.name for v in interface(rig(), is_free)} for is_free in (False, True))
    assert driven - free == {"speed", "speed_rate", "speed_continuation"}
    assert free - driven == {"tau_drive", "w_start", "tau_impedance"}


def test_each_is_current_as_itself_only(fmu, free_fmu):
    assert is_current(free_fmu, machine_of(is_free=True))
    assert is_current(fmu, machine_of())
    assert not is_current(free_fmu, machine_of())
    assert not is_current(fmu, machine_of(is_free=True))


def simulate(fmu, stop, step, output, **options):
    return fmpy.simulate_fmu(
        str(fmu), stop_time=stop, output_interval=step, output=output, validate=False, **options
    )


def test_it_gives_what_the_model_gives(free_fmu):
    start = {"tau_drive": -0.05, "w_start": 150.0}
    run = simulate(free_fmu, 0.2, 0.01, ["w", "phi", "a", "disc[3].x"], start_values=start)
    sim = Simulation(rig(), choose(), speed=150.0, drive_torque=-0.05)
    for row in run:
        if row["time"] > 0:
            sim.advance(sim.time + 0.01, -0.05)
        assert [sim.read(name) for name in run.dtype.names[1:]] == pytest.approx(
            list(row)[1:], rel=1e-9, abs=1e-12
        )


def test_a_state_goes_from_one_instance_to_another(free_fmu):
    def march(rotor, t):
        seen = []
        for i in range(20):
            rotor.set({"tau_drive": 0.01 * i})
            rotor.step(t + i * 1e-3, 1e-3)
            seen.append(rotor.get(["w", "phi", "a", "tau", "bearing[1].fn"]))
        return seen

    with Member(free_fmu, {"w_start": 170.0}, []) as one:
        one.begin()
        march(one, 0.0)
        state = one._fmu.serializeFMUstate(one._fmu.getFMUState())
        expected = march(one, 0.02)
    with Member(free_fmu, {"w_start": 170.0}, []) as other:
        other.begin()
        other._fmu.setFMUState(other._fmu.deSerializeFMUstate(state))
        assert march(other, 0.02) == expected


def test_a_constant_drag_lets_it_coast_down_as_the_papers_law(fmu, free_fmu):
    """400 - 10 t rad/s while the whirl is small, with what the bearings lack of that for a drag."""
    ramp = np.array([(0.0, 400.0), (2.0, 380.0)], dtype=[("time", float), ("speed", float)])
    driven = simulate(fmu, 2.0, 5e-4, ["tau"], input=ramp, start_values={"speed_rate": -10.0})
    drag = driven["tau"][driven["time"] > 1.0].mean()
    run = simulate(free_fmu, 14.0, 0.01, ["w", "disc[3].x_amp"], start_values={"tau_drive": drag})
    assert run["disc[3].x_amp"][run["time"] > 2.0].max() < 180e-6  # it does not resonate yet
    assert np.abs(run["w"] - (400 - 10 * run["time"])).max() < 1.0
    below = simulate(free_fmu, 5.0, 0.01, ["w"], start_values={"tau_drive": drag, "w_start": 220.0})
    assert below["w"][-1] < 170 - 1.0  # whirl and rub at the resonances slow it further


@pytest.mark.parametrize("is_free", [False, True])
@pytest.mark.slow  # of short runs the ledger is tested in tests/physics/test_energy
def test_over_both_resonances_drive_work_is_energy_and_dissipation(fmu, free_fmu, is_free):
    """From 400 rad/s to below 100, to 1e-4 of what was dissipated, a third of the drive's work."""
    start = {"solver.tolerance": 1e-4}
    if is_free:
        options = {"start_values": start | {"tau_drive": -0.073}}
    else:
        ramp = np.array([(0.0, 400.0), (30.0, 100.0)], dtype=[("time", float), ("speed", float)])
        options = {"input": ramp, "start_values": start | {"speed_rate": -10.0}}
    run = simulate(
        free_fmu if is_free else fmu, 30.0, 0.01, ["w", "disc[3].x_amp", *LEDGER], **options
    )
    assert run["w"][-1] < 101
    assert run["disc[3].x_amp"].max() > 370e-6
    lost = sum(run[name][-1] for name in LOSSES)
    assert np.abs(run["energy.residual"]).max() < 1e-4 * lost


def test_a_coupling_that_diverges_is_called_that_by_the_speed(free_fmu):
    """Before the solver fails at it: a torque that each step doubles and turns round."""
    with Member(free_fmu, {"w_start": 200.0}, []) as rotor:
        rotor.begin()
        for i in range(12):
            rotor.set({"tau_drive": 300.0 * (-2.0) ** i})
            rotor.step(i * 1e-3, 1e-3)
        assert abs(rotor.get(["w"])["w"]) > 25e3
    (message,) = (text for text in rotor.messages if text.code == "burst-speed")
    assert "does a coupling diverge?" in message
