"""The observed quantities of a run in a flat array: their names, and the kernel that fills it."""

import math
from dataclasses import replace
from typing import NamedTuple

from ..kernels.functions import angle, modulus
from ..kernels.jit import jit, jit_inlined
from ..machine.names import Name
from ..machine.rotor import Rotor
from ..parts.base import (
    MOUNT_OUTPUTS,
    PORT_OUTPUTS,
    PROBE_OUTPUTS,
    STEP_WORK,
    VELOCITY_OUTPUTS,
    WALL_OUTPUTS,
    WAVE_OUTPUTS,
    outputs_of,
)
from ..quantities import ALL, SPEED, Output, places, remembered
from ..step.excitation import at_load, at_place
from ..step.laws import kinematics, law_observe, squared_normal_force
from ..structure.ledger import (
    INFLOWS,
    LAW_LOSSES,
    LAW_STORES,
    MACHINE_FLOWS,
    MACHINE_LOSSES,
    MACHINE_STORES,
    law_entries,
)
from .energy import FLOW, total_energy
from .memory import AXIS, ONCE, PEAK, SENSE, spin_now

SHAFT = (
    Output("phi", "rad", "angle of rotation, integral of the speed", True, 100.0),
    Output("w", "rad/s", "speed of rotation", nominal=100.0, reached_by=SPEED),
    Output("a", "rad/s2", "rate of the speed", nominal=10.0, reached_by=ALL),
    Output(
        "tau",
        "N.m",
        "torque that the drive must supply to turn the rotor at its speed",
        True,
        0.1,
        reached_by=ALL,
    ),
    Output(
        "tau_load",
        "N.m",
        "load torque of friction, whirl and unbalance, tau - J a: the load of a partner that "
        "integrates the speed with the rotor's moment of inertia J",
        True,
        0.1,
        reached_by=ALL,
    ),
    Output(
        "J",
        "kg.m2",
        "moment of inertia about the axis of rotation, including eccentric masses",
        nominal=0.01,
    ),
    Output(
        "tau_wave",
        "N.m",
        "reflected wave of the drive's transmission line, tau_drive - 2 Z w; tau without a line",
        nominal=0.1,
        reached_by=ALL,
    ),
    *remembered(
        replace(STEP_WORK, reached_by=SPEED),
        *(
            Output(
                f"d{name}_ddrive",
                "1",
                f"change of {name}, at the end of the last communication step, by the speed or the "
                "torque that was given for it, in SI units; 0 unless solver.sensitivities asks "
                "for it",
                nominal=1.0,
            )
            for name in ("phi", "w", "tau", "tau_load")
        ),
    ),
)
SOLVER = remembered(
    Output("h_last", "s", "length of the last step", nominal=1e-3),
    Output("steps", "1", "steps taken", kind="Integer"),
    Output("rejected", "1", "steps rejected and repeated", kind="Integer"),
    Output("newton", "1", "iterations of the interfaces' problem", kind="Integer"),
    Output(
        "error",
        "1",
        "largest local error of a step over the last revolution, relative to the tolerance",
        nominal=1.0,
    ),
    Output(
        "error_rms",
        "1",
        "root mean square of the steps' local errors over the last revolution, relative to the "
        "tolerance",
        nominal=0.1,
    ),
    Output(
        "error_last",
        "1",
        "error of the last step as its mode measures it: the error indicator of the adaptive mode, "
        "in tolerances in the controlled one",
        nominal=1.0,
    ),
    Output("h_min_used", "s", "shortest step length chosen", nominal=1e-3),
    Output("h_max_used", "s", "longest step length chosen", nominal=1e-3),
    Output(
        "trapped",
        "1",
        "steps in the false state, in which the integrator makes a journal jump from wall to wall",
        kind="Integer",
    ),
    Output(
        "trapped_at", "s", "time at which the false state was first seen; -1: never", nominal=1.0
    ),
    Output(
        "overdamped_at",
        "s",
        "time from which numerical damping during a rub may hide an instability; -1: never",
        nominal=1.0,
    ),
    Output(
        "residual",
        "N",
        "largest difference in a step between the force of an interface and that of its law, where "
        "the mode limits the iterations",
        nominal=1.0,
    ),
)
(_RESIDUAL,) = remembered(
    Output(
        "residual", "J", "energy error of the integrator: gained, or, negative, lost", nominal=0.1
    )
)


class Observed(NamedTuple):
    """An observed quantity: its name and its declaration."""

    name: Name
    output: Output


def observed(rotor: Rotor) -> tuple[Observed, ...]:
    """Return all observed quantities of a machine's run, in the order of the array that `observe`
    fills: shaft, parts, solver, energies."""
    table = [Observed(Name("", 0, output.name), output) for output in SHAFT]
    table += _of_parts(rotor)
    table += [Observed(Name("solver", 0, output.name), output) for output in SOLVER]
    return (*table, *(Observed(Name("energy", 0, o.name), o) for o in _ledger(rotor)))


def observed_names(rotor: Rotor) -> tuple[str, ...]:
    """Return the names of `observed`."""
    return tuple(str(entry.name) for entry in observed(rotor))


def _of_parts(rotor: Rotor) -> list[Observed]:
    return [
        Observed(Name(*key, output.name), output)
        for key, element in rotor.indexed_elements()
        for output in outputs_of(element)
    ]


def _ledger(rotor: Rotor) -> list[Output]:
    stores, losses = law_entries(rotor)
    inflows = [replace(inflow, name=f"{inflow.name}_work") for inflow in INFLOWS]
    dissipated = (*MACHINE_LOSSES, *(LAW_LOSSES[i] for i in losses))
    lost = [replace(loss, name=f"{loss.name}_loss") for loss in dissipated]
    stored = [*MACHINE_STORES, *(LAW_STORES[i] for i in stores)]
    return [*stored, *remembered(*inflows, *lost), _RESIDUAL]


# Places in `out` where the parts' outputs begin; how many the solver has, and a velocity.
PARTS_AT, _SOLVERS, _VELOCITIES = len(SHAFT), len(SOLVER), len(VELOCITY_OUTPUTS)
_MACHINE_STORES, _MACHINE_FLOWS, _INFLOWS = len(MACHINE_STORES), len(MACHINE_FLOWS), len(INFLOWS)
_WAVE = places(WAVE_OUTPUTS, len(PORT_OUTPUTS))
_SHAFT, _SOLVER, _PROBE = places(SHAFT), places(SOLVER), places(PROBE_OUTPUTS)
_WALL = places(WALL_OUTPUTS)
_VELOCITY, _MOUNT, _PORT = places(VELOCITY_OUTPUTS), places(MOUNT_OUTPUTS), places(PORT_OUTPUTS)


@jit_inlined
def energies_at(structure, out):
    """Return the index in `out` at which the energies begin."""
    return len(out) - (
        _MACHINE_STORES + len(structure.stores) + _MACHINE_FLOWS + len(structure.losses) + 1
    )


@jit
def observe(structure, motion, memory, work, out, has_energies):
    """Fill `out` in the order of `observed`, the energies, which cost most, on demand."""
    r = memory.record[0]
    inertia = structure.numbers[0].inertia
    out[_SHAFT.phi] = r.theta
    out[_SHAFT.w] = r.omega
    out[_SHAFT.a] = r.alpha
    out[_SHAFT.tau] = r.torque
    out[_SHAFT.tau_load] = r.torque - inertia * r.alpha
    out[_SHAFT.J] = inertia
    out[_SHAFT.tau_wave] = r.torque - r.drive_impedance * r.omega
    out[_SHAFT.step_work] = memory.work[FLOW.drive] - r.drive_work_ref
    _observe_parts(structure, motion, memory, out[PARTS_AT:])
    energies = energies_at(structure, out)
    _observe_solver(r, out[energies - _SOLVERS : energies])
    if has_energies:
        _observe_energies(structure, motion, memory, work, out[energies:])


@jit_inlined
def _observe_solver(r, out):
    out[_SOLVER.h_last] = r.h_last
    out[_SOLVER.steps] = r.steps
    out[_SOLVER.rejected] = r.rejected
    out[_SOLVER.newton] = r.newton
    out[_SOLVER.error] = max(r.error_largest, r.error_largest_before)
    out[_SOLVER.error_rms] = r.error_rms
    out[_SOLVER.error_last] = r.error
    out[_SOLVER.h_min_used] = r.h_smallest
    out[_SOLVER.h_max_used] = r.h_largest
    out[_SOLVER.trapped] = r.trapped
    out[_SOLVER.trapped_at] = -1.0 if math.isnan(r.trapped_at) else r.trapped_at
    out[_SOLVER.overdamped_at] = -1.0 if math.isnan(r.overdamped_at) else r.overdamped_at
    out[_SOLVER.residual] = r.residual


@jit
def _largest(peaks):
    """Return the largest value over the two revolutions and since the last communication point."""
    return max(
        peaks[PEAK.this_revolution], peaks[PEAK.last_revolution], peaks[PEAK.since_communication]
    )


@jit_inlined
def _observe_parts(structure, motion, memory, out):
    peaks, once = memory.peaks, memory.once
    n = structure.M.shape[0]
    for i in range(len(structure.probes)):
        probe = out[structure.probes[i].out :]
        q = at_place(structure.probes[i], motion.q)
        probe[_PROBE.x] = q.real
        probe[_PROBE.y] = q.imag
        probe[_PROBE.x_amp] = _largest(peaks[:, AXIS.x, i])
        probe[_PROBE.y_amp] = _largest(peaks[:, AXIS.y, i])
        probe[_PROBE.r_amp] = math.sqrt(_largest(peaks[:, AXIS.squared_distance, i]))
        forward = once[ONCE.mean, SENSE.forward, i]
        backward = once[ONCE.mean, SENSE.backward, i].conjugate()
        x, y = forward + backward, -1j * (forward - backward)
        probe[_PROBE.x_1x] = modulus(x)
        probe[_PROBE.y_1x] = modulus(y)
        probe[_PROBE.x_1x_phase] = angle(x)
        probe[_PROBE.y_1x_phase] = angle(y)
    for i in range(len(structure.load_dof)):
        port = out[structure.load_arms[i].out :]
        port[_PORT.step_work] = memory.load_work[i]
        impedance = structure.load_arms[i].impedance
        if impedance > 0.0:
            wave = memory.loads[i] - 2.0 * impedance * at_load(structure, i, motion.v)
            port[_WAVE.wave_x] = wave.real
            port[_WAVE.wave_y] = wave.imag
    for i in range(len(structure.velocities)):
        at = structure.velocities[i].out
        v = motion.v[structure.velocities[i].dof]
        for place in range(_VELOCITIES):
            out[at + place] = velocity_output(v, place)
    for i in range(len(structure.housings)):
        at = structure.housings[i].out
        out[at + _MOUNT.housing_x] = motion.q[n + i].real
        out[at + _MOUNT.housing_y] = motion.q[n + i].imag
    spin = spin_now(memory.record)
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        moving = kinematics(interface, spin, motion.q, motion.v)
        internal_state = motion.internal_state[interface.internal_state :]
        law_observe(structure.laws, interface, moving, internal_state, out[interface.out :])
        if interface.has_wall == 1:
            squared = _largest(memory.wall_peaks[:, j])
            if motion.force[j] != 0.0:
                now = squared_normal_force(moving.displacement, motion.force[j])
                squared = max(squared, now)
            out[interface.wall_out + _WALL.fn_peak] = math.sqrt(squared)


@jit
def velocity_output(v, place):
    """Return one of the `VELOCITY_OUTPUTS` of a velocity [m/s], by its place among them."""
    return v.imag if place == _VELOCITY.vy else v.real


@jit_inlined
def _observe_energies(structure, motion, memory, work, out):
    now = spin_now(memory.record)
    residual = total_energy(structure, now, motion, work.stores)
    residual -= memory.record[0].energy_at_start
    at = 0
    for i in range(_MACHINE_STORES):
        out[at + i] = work.stores[i]
    at += _MACHINE_STORES
    for i in range(len(structure.stores)):
        out[at + i] = work.stores[_MACHINE_STORES + structure.stores[i]]
    at += len(structure.stores)
    flows = memory.work
    for i in range(_MACHINE_FLOWS):
        out[at + i] = flows[i]
    at += _MACHINE_FLOWS
    for i in range(len(structure.losses)):
        out[at + i] = flows[_MACHINE_FLOWS + structure.losses[i]]
    at += len(structure.losses)
    residual -= flows[FLOW.drive] + flows[FLOW.external]
    for i in range(_INFLOWS, len(flows)):
        residual += flows[i]
    out[at] = residual
