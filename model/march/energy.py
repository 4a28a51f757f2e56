"""The energy ledger: what the machine holds, what flows in, what is dissipated [J, W].

Energy of the machine + dissipation = work of the drive and of external loads + residual; what
remains is the integrator's own. Exact power balance of the equations in `assembly`, so the residual
falls with the step length.
"""

from __future__ import annotations

from ..kernels.band import form
from ..kernels.compiled import compiled
from ..parts.clearance_contact import contact_force
from ..step.excitation import circulation, drive_torque, internal_torque

# Powers that the ledger integrates over time, in this order.
FLOWS = ("drive", "external", "structure", "housing", "contact", "friction")
# Energies that the machine holds, in this order.
STORES = ("kinetic", "elastic", "gravity", "compression")


@compiled
def powers(structure, spin, loads, motion, out):
    """Fill out, shape (6,) [W], in the order of `FLOWS`; returns the drive torque [N.m].

    Inflows: drive, external loads. Dissipations: shaft and supports, housing dampers, contact
    damping, friction. The torque takes the accelerations of the equation of motion: those that
    generalized-alpha carries along belong to another instant, (alpha_m - alpha_f) h away.
    """
    contacts = structure.contacts
    n = structure.M.shape[0]
    q, v = motion.q, motion.v
    external = 0.0
    for i in range(len(loads)):
        external += (loads[i].conjugate() * v[structure.load_dof[i]]).real
    structural = form(structure.C, v[:n], v[:n]).real
    internal = internal_torque(structure, q, v, spin.omega)
    if internal != 0.0:
        kappa = circulation(structure, spin.omega)
        structural += internal * spin.omega + kappa * form(structure.K_shaft, v[:n], q[:n]).imag
    housing = 0.0
    damping = 0.0
    friction = 0.0
    friction_torque = 0.0
    for j in range(len(contacts)):
        moving = v[n + j]
        housing += contacts[j].cx * moving.real**2 + contacts[j].cy * moving.imag**2
        d = q[contacts[j].dof] - q[n + j]
        force, normal, delta, rate, sliding = contact_force(
            contacts[j], d, v[contacts[j].dof] - moving, spin.omega
        )
        if delta > 0.0:
            damping += (normal - contacts[j].k * delta) * rate
            tangential = -(force * d.conjugate()).imag / abs(d)
            friction += tangential * sliding
            friction_torque += contacts[j].journal_radius * tangential
    torque = drive_torque(structure, q, v, motion.v_dot, spin, friction_torque)
    out[0] = torque * spin.omega
    out[1] = external
    out[2] = structural
    out[3] = housing
    out[4] = damping
    out[5] = friction
    return torque


@compiled
def total_energy(structure, spin, motion, out):
    """Energy of the machine [J]. Fills out, shape (4,) [J], in the order of `STORES`: kinetic
    (lateral, spin and what couples them), elastic (shaft, supports, housing springs), gravity,
    compression of the contacts."""
    contacts = structure.contacts
    n = structure.M.shape[0]
    rotor_q, rotor_v = motion.q[:n], motion.v[:n]
    kinetic = 0.5 * form(structure.M, rotor_v, rotor_v).real
    kinetic += 0.5 * structure.inertia * spin.omega * spin.omega
    kinetic -= 0.5 * spin.omega * form(structure.G, rotor_q, rotor_v).imag
    elastic = 0.5 * form(structure.K, rotor_q, rotor_q).real
    gravity = 0.0
    for i in range(n):
        gravity -= (structure.weight[i].conjugate() * rotor_q[i]).real
    for i in range(len(structure.unbalance)):
        arm = structure.unbalance[i] * spin.direction
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
