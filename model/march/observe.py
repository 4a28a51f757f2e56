"""What can be read of a run, as one flat array: the names, and the kernel that fills it."""

from __future__ import annotations

import math

from ..kernels.compiled import compiled
from ..parts.clearance_contact import contact_angle, contact_force
from ..step.excitation import spin_of
from ..structure.assembly import Structure
from .energy import FLOWS, STORES, total_energy

_SHAFT = ("phi", "w", "a", "tau", "tau_load", "J")
_DISC = ("x", "y", "x_amp", "y_amp")
_BEARING = ("psi", "fn", "ft", "x", "y", "housing_x", "housing_y", "contact")
_SOLVER = (
    "h_last",
    "steps",
    "rejected",
    "newton",
    "error",
    "h_min_used",
    "h_max_used",
    "trapped",
    "trapped_at",
)


def observed_names(structure: Structure) -> tuple[str, ...]:
    """Names of the observed quantities, in the order of the array that `observe` fills.

    Units: displacements [m], angles [rad], forces [N], torques [N.m], inertia [kg.m2], energies
    [J], times [s].
    """
    names = list(_SHAFT)
    for i in range(1, len(structure.disc_dof) + 1):
        names += [f"disc[{i}].{name}" for name in _DISC]
    for j in range(1, len(structure.contacts) + 1):
        names += [f"bearing[{j}].{name}" for name in _BEARING]
    names += [f"solver.{name}" for name in _SOLVER]
    names += [f"energy.{name}" for name in STORES]
    names += [f"energy.{name}" for name in ("drive_work", "external_work")]
    names += [f"energy.{name}_loss" for name in FLOWS[2:]]
    return (*names, "energy.residual")


@compiled
def observe(structure, motion, memory, work, out):
    """Fill `out` in the order of `observed_names`."""
    contacts = structure.contacts
    n = structure.M.shape[0]
    r = memory.record[0]
    out[0] = r.theta
    out[1] = r.omega
    out[2] = r.alpha
    out[3] = r.torque
    out[4] = r.torque - structure.inertia * r.alpha
    out[5] = structure.inertia
    at = 6
    for i in range(len(structure.disc_dof)):
        q = motion.q[structure.disc_dof[i]]
        out[at] = q.real
        out[at + 1] = q.imag
        for axis in range(2):
            peaks = memory.peaks
            out[at + 2 + axis] = max(peaks[0, axis, i], peaks[1, axis, i], peaks[2, axis, i])
        at += 4
    for j in range(len(contacts)):
        housing = motion.q[n + j]
        d = motion.q[contacts[j].dof] - housing
        d_dot = motion.v[contacts[j].dof] - motion.v[n + j]
        force, normal, _, _, _ = contact_force(contacts[j], d, d_dot, r.omega)
        out[at] = contact_angle(d)
        out[at + 1] = normal
        out[at + 2] = 0.0 if normal == 0.0 else -(force * d.conjugate()).imag / abs(d)
        out[at + 3] = d.real
        out[at + 4] = d.imag
        out[at + 5] = housing.real
        out[at + 6] = housing.imag
        out[at + 7] = 1.0 if normal > 0.0 else 0.0
        at += 8
    out[at] = r.h_last
    out[at + 1] = r.steps
    out[at + 2] = r.rejected
    out[at + 3] = r.newton
    out[at + 4] = r.error
    out[at + 5] = r.h_smallest
    out[at + 6] = r.h_largest
    out[at + 7] = r.trapped
    out[at + 8] = -1.0 if math.isnan(r.trapped_at) else r.trapped_at
    at += 9
    now = spin_of(r.omega, r.alpha, r.theta)
    stores = work.stores
    energy = total_energy(structure, now, motion, stores)
    for i in range(len(stores)):
        out[at + i] = stores[i]
    at += len(stores)
    flows = memory.work
    for i in range(len(flows)):
        out[at + i] = flows[i]
    at += len(flows)
    losses = flows[2] + flows[3] + flows[4] + flows[5]
    out[at] = energy - r.energy_at_start - flows[0] - flows[1] + losses
