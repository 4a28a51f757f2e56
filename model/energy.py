"""The energy ledger: what the machine holds, what flows in, what is dissipated [J, W].

Energy of the machine + dissipation = work of the drive and of external loads + residual; what
remains is the integrator's own. Exact power balance of the equations in `assembly`, so the residual
falls with the step length.
"""

from __future__ import annotations

import cmath

from .band import add_product, solve
from .compiled import compiled
from .contact import contact_force
from .excitation import circulation, drive_torque, internal_torque

# Powers that the ledger integrates over time, in this order.
FLOWS = ("drive", "external", "structure", "housing", "contact", "friction")
# Energies that the machine holds, in this order.
STORES = ("kinetic", "elastic", "gravity", "compression")


@compiled
def _quadratic(band, x, scratch):
    """Re(x^H A x) of a real symmetric band matrix."""
    n = band.shape[1]
    for i in range(n):
        scratch[i] = 0.0
    add_product(1.0, band, x, scratch)
    total = 0.0
    for i in range(n):
        total += (x[i].conjugate() * scratch[i]).real
    return total


@compiled
def powers(structure, spin, loads, motion, scratch, column, out):
    """Fill out, shape (6,) [W], in the order of `FLOWS`; returns the drive torque [N.m].

    Inflows: drive, external loads. Dissipations: shaft and supports, housing dampers, contact
    damping, friction. The torque takes the accelerations -M^-1 r of the equation of motion: those
    that generalized-alpha carries along belong to another instant, (alpha_m - alpha_f) h away.
    column: scratch of shape (n, 1).
    """
    contacts = structure.contacts
    n = structure.M.shape[1]
    external = 0.0
    for i in range(len(loads)):
        external += (loads[i].conjugate() * motion.v[structure.load_dof[i]]).real
    internal = internal_torque(structure, motion.q, motion.v, spin.omega, scratch)
    structural = _quadratic(structure.C, motion.v, scratch) + internal * spin.omega
    if internal != 0.0:
        kappa = circulation(structure, spin.omega)
        for i in range(n):
            scratch[i] = 0.0
        add_product(1.0, structure.K_shaft, motion.q, scratch)
        for i in range(n):
            structural += kappa * (motion.v[i].conjugate() * -1j * scratch[i]).real
    housing = 0.0
    damping = 0.0
    friction = 0.0
    friction_torque = 0.0
    for j in range(len(contacts)):
        q, v = motion.q[n + j], motion.v[n + j]
        housing += contacts[j].cx * v.real * v.real + contacts[j].cy * v.imag * v.imag
        d = motion.q[contacts[j].dof] - q
        force, normal, delta, rate, sliding = contact_force(
            contacts[j], d, motion.v[contacts[j].dof] - v, spin.omega
        )
        if delta > 0.0:
            damping += (normal - contacts[j].k * delta) * rate
            tangential = -(force * d.conjugate()).imag / abs(d)
            friction += tangential * sliding
            friction_torque += contacts[j].journal_radius * tangential
    for i in range(n):
        column[i, 0] = -motion.r[i]
    solve(structure.M_factors, column)
    a = column[:, 0]
    torque = drive_torque(structure, motion.q, motion.v, a, spin, friction_torque, scratch)
    out[0] = torque * spin.omega
    out[1] = external
    out[2] = structural
    out[3] = housing
    out[4] = damping
    out[5] = friction
    return torque


@compiled
def total_energy(structure, spin, motion, scratch, out):
    """Energy of the machine [J]. Fills out, shape (4,) [J], in the order of `STORES`: kinetic
    (lateral, spin and what couples them), elastic (shaft, supports, housing springs), gravity,
    compression of the contacts."""
    contacts = structure.contacts
    n = structure.M.shape[1]
    kinetic = 0.5 * _quadratic(structure.M, motion.v, scratch)
    kinetic += 0.5 * structure.inertia * spin.omega * spin.omega
    elastic = 0.5 * _quadratic(structure.K, motion.q, scratch)
    for i in range(n):
        scratch[i] = 0.0
    add_product(1.0, structure.G, motion.v, scratch)
    gravity = 0.0
    for i in range(n):
        kinetic -= 0.5 * spin.omega * (motion.q[i].conjugate() * scratch[i]).imag
        gravity -= (structure.weight[i].conjugate() * motion.q[i]).real
    turning = cmath.exp(1j * spin.theta)
    for i in range(len(structure.unbalance)):
        arm = structure.unbalance[i] * turning
        v = motion.v[structure.unbalance_dof[i]]
        kinetic += spin.omega * (arm.conjugate() * v).imag
        gravity += structure.gravity * arm.imag
    compression = 0.0
    for j in range(len(contacts)):
        q, v = motion.q[n + j], motion.v[n + j]
        kinetic += 0.5 * contacts[j].mass * (v.real * v.real + v.imag * v.imag)
        elastic += 0.5 * (contacts[j].kx * q.real * q.real + contacts[j].ky * q.imag * q.imag)
        gravity += contacts[j].mass * structure.gravity * q.imag
        delta = abs(motion.q[contacts[j].dof] - q) - contacts[j].clearance
        if delta > 0.0:
            compression += 0.5 * contacts[j].k * delta * delta
    out[0] = kinetic
    out[1] = elastic
    out[2] = gravity
    out[3] = compression
    return kinetic + elastic + gravity + compression
