"""What can be read of a run, as one flat array: the names, and the kernel that fills it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from ..kernels.compiled import compiled, inlined
from ..kernels.functions import angle, modulus
from ..machine.rotor import Name, Rotor, spelled
from ..protocol.part import outputs_of
from ..quantities import ALL, SPEED, Output
from ..step.excitation import at_place, spin_of
from ..step.laws import law_observe, relative
from ..structure.ledger import (
    INFLOWS,
    LAW_LOSSES,
    LAW_STORES,
    OWN_FLOWS,
    OWN_LOSSES,
    OWN_STORES,
    law_entries,
)
from .energy import total_energy

SHAFT = (
    Output("phi", "rad", "angle of rotation, integral of the speed", True, 100.0),
    Output("w", "rad/s", "speed of rotation reached", nominal=100.0, reached_by=SPEED),
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
        "what friction, whirl and unbalance take of it, tau - J a: the load of a partner that "
        "integrates the speed with the rotor's inertia J",
        True,
        0.1,
        reached_by=ALL,
    ),
    Output(
        "J",
        "kg.m2",
        "moment of inertia about the axis of rotation, eccentric masses included",
        nominal=0.01,
    ),
)
SOLVER = (
    Output("h_last", "s", "length of the last step", nominal=1e-3),
    Output("steps", "1", "steps taken", kind="Integer"),
    Output("rejected", "1", "steps rejected and repeated", kind="Integer"),
    Output("newton", "1", "iterations of the interfaces' problem", kind="Integer"),
    Output(
        "error",
        "1",
        "largest local error of a step over the last revolution, over the one tolerated",
        nominal=1.0,
    ),
    Output(
        "error_rms",
        "1",
        "root mean square of the steps' local errors over the last revolution, over the one "
        "tolerated",
        nominal=0.1,
    ),
    Output("h_min_used", "s", "shortest step length chosen", nominal=1e-3),
    Output("h_max_used", "s", "longest step length chosen", nominal=1e-3),
    Output(
        "trapped",
        "1",
        "steps in the false state, a journal jumping from wall to wall by the integrator's doing",
        kind="Integer",
    ),
    Output(
        "trapped_at", "s", "time at which the false state was first seen; -1: never", nominal=1.0
    ),
    Output(
        "overdamped_at",
        "s",
        "time from which the integrator damped a rub so much that it may hide an instability; "
        "-1: never",
        nominal=1.0,
    ),
)
_RESIDUAL = Output(
    "residual", "J", "energy that the integrator made (or, negative, lost)", nominal=0.1
)


class Observed(NamedTuple):
    """A quantity that can be read: its name, and what it is."""

    name: Name
    output: Output


def observed(rotor: Rotor) -> tuple[Observed, ...]:
    """All that can be read of a machine's run, in the order of the array that `observe` fills:
    shaft, parts, solver, energies."""
    table = [Observed(Name("", 0, output.name), output) for output in SHAFT]
    table += _of_parts(rotor)
    table += [Observed(Name("solver", 0, output.name), output) for output in SOLVER]
    return (*table, *(Observed(Name("energy", 0, o.name), o) for o in _ledger(rotor)))


def observed_names(rotor: Rotor) -> tuple[str, ...]:
    """The names of `observed`."""
    return tuple(str(entry.name) for entry in observed(rotor))


def _of_parts(rotor: Rotor) -> list[Observed]:
    density = rotor.material.density
    return [
        Observed(Name(*key, output.name), output)
        for key, part in rotor.indexed_parts()
        for element in part.elements(spelled(*key), density)
        for output in outputs_of(element)
    ]


def _ledger(rotor: Rotor) -> list[Output]:
    stores, losses = law_entries(rotor)
    inflows = [replace(inflow, name=f"{inflow.name}_work") for inflow in INFLOWS]
    dissipated = (*OWN_LOSSES, *(LAW_LOSSES[i] for i in losses))
    lost = [replace(loss, name=f"{loss.name}_loss") for loss in dissipated]
    return [*OWN_STORES, *(LAW_STORES[i] for i in stores), *inflows, *lost, _RESIDUAL]


# Places in `out` where the parts' outputs begin; and how many the solver has.
_PARTS_AT, _SOLVERS = len(SHAFT), len(SOLVER)
_OWN_STORES, _OWN_FLOWS = len(OWN_STORES), len(OWN_FLOWS)


@inlined
def energies_at(structure, out):
    """Place in `out` where the energies begin."""
    return len(out) - (_OWN_STORES + len(structure.stores) + _OWN_FLOWS + len(structure.losses) + 1)


@compiled
def observe(structure, motion, memory, work, out, has_energies):
    """Fill `out` in the order of `observed`, the energies, which cost most, on demand."""
    r = memory.record[0]
    inertia = structure.numbers[0].inertia
    out[0] = r.theta
    out[1] = r.omega
    out[2] = r.alpha
    out[3] = r.torque
    out[4] = r.torque - inertia * r.alpha
    out[5] = inertia
    _observe_parts(structure, motion, memory, out[_PARTS_AT:])
    at = energies_at(structure, out) - _SOLVERS
    out[at] = r.h_last
    out[at + 1] = r.steps
    out[at + 2] = r.rejected
    out[at + 3] = r.newton
    out[at + 4] = max(r.error_largest, r.error_largest_before)
    out[at + 5] = r.error_rms
    out[at + 6] = r.h_smallest
    out[at + 7] = r.h_largest
    out[at + 8] = r.trapped
    out[at + 9] = -1.0 if math.isnan(r.trapped_at) else r.trapped_at
    out[at + 10] = -1.0 if math.isnan(r.overdamped_at) else r.overdamped_at
    if has_energies:
        _observe_energies(structure, motion, memory, work, out[at + _SOLVERS :])


@inlined
def _observe_parts(structure, motion, memory, out):
    peaks, once = memory.peaks, memory.once
    n = structure.M.shape[0]
    for i in range(len(structure.probes)):
        at = structure.probes[i].out
        q = at_place(structure.probes[i], motion.q)
        out[at] = q.real
        out[at + 1] = q.imag
        for axis in range(3):
            largest = max(peaks[0, axis, i], peaks[1, axis, i], peaks[2, axis, i])
            out[at + 2 + axis] = largest if axis < 2 else math.sqrt(largest)
        forward, backward = once[2, 0, i], once[2, 1, i].conjugate()
        components = (forward + backward, -1j * (forward - backward))
        for axis in range(2):
            out[at + 5 + axis] = modulus(components[axis])
            out[at + 7 + axis] = angle(components[axis])
    for i in range(len(structure.velocities)):
        at = structure.velocities[i].out
        v = motion.v[structure.velocities[i].dof]
        out[at] = v.real
        out[at + 1] = v.imag
    for h in range(len(structure.housings)):
        at = structure.housings[h].out
        out[at] = motion.q[n + h].real
        out[at + 1] = motion.q[n + h].imag
    omega = memory.record[0].omega
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        law_observe(
            structure.laws,
            interface,
            relative(interface, motion.q),
            relative(interface, motion.v),
            omega,
            omega,
            motion.own[interface.own :],
            out[interface.out :],
        )


@inlined
def _observe_energies(structure, motion, memory, work, out):
    r = memory.record[0]
    now = spin_of(r.omega, r.alpha, r.theta)
    residual = total_energy(structure, now, motion, work.stores) - r.energy_at_start
    at = 0
    for i in range(_OWN_STORES):
        out[at + i] = work.stores[i]
    at += _OWN_STORES
    for i in range(len(structure.stores)):
        out[at + i] = work.stores[_OWN_STORES + structure.stores[i]]
    at += len(structure.stores)
    flows = memory.work
    for i in range(_OWN_FLOWS):
        out[at + i] = flows[i]
    at += _OWN_FLOWS
    for i in range(len(structure.losses)):
        out[at + i] = flows[_OWN_FLOWS + structure.losses[i]]
    at += len(structure.losses)
    residual -= flows[0] + flows[1]
    for i in range(2, len(flows)):
        residual += flows[i]
    out[at] = residual
