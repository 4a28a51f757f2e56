"""The energy ledger: energy stored in the machine, inflow and dissipation [J, W].

Energy of the machine + dissipation = work of the drive and of external loads + residual; the
residual is the error of the integrator. The powers are those of the equations in `assembly`
exactly, so the residual falls with the step length.
"""

from ..kernels.band import form, square
from ..kernels.jit import jit
from ..parts.housing import masses
from ..quantities import places
from ..step.bows import bow_energy, bow_loss, bow_torque
from ..step.excitation import at_load, at_place, circulation, drive_torque, internal_torque
from ..step.laws import add_energy, add_losses, kinematics, relative
from ..structure.ledger import BOW, FLOWS, MACHINE_FLOWS, MACHINE_STORES

_MACHINE_STORES, _MACHINE_FLOWS = len(MACHINE_STORES), len(MACHINE_FLOWS)
STORE, FLOW = places(MACHINE_STORES), places(MACHINE_FLOWS)
_BOW = FLOWS.index(BOW.name)


@jit
def powers(structure, spin, loads, motion, scratch, out):
    """Fill out, shape (flows,) [W], in the order of `ledger.FLOWS`; return the drive torque [N.m].

    Inflows: drive, external loads. Dissipations: shaft and supports, housing dampers, the laws of
    the interfaces. The torque uses the accelerations of the equation of motion: those carried by
    generalized-alpha belong to another instant, (alpha_m - alpha_f) h away.
    """
    n = structure.M.shape[0]
    q, v = motion.q, motion.v
    external = 0.0
    for i in range(len(loads)):
        if loads[i] != 0.0:
            external += load_power(structure, spin, i, loads[i], v)
    structural = square(structure.C, v[:n])
    internal = internal_torque(structure, q, v, spin.omega)
    if internal != 0.0:
        kappa = circulation(structure, spin.omega)
        structural += internal * spin.omega + kappa * form(structure.K_shaft, v[:n], q[:n]).imag
    housing = 0.0
    for k in range(len(structure.housings)):
        rate = v[n + k]
        damper = structure.housings[k]
        housing += damper.cx * rate.real**2 + damper.cy * rate.imag**2
    out[_MACHINE_FLOWS:] = 0.0
    braking = 0.0
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        moving = kinematics(interface, spin, q, v)
        internal_state = motion.internal_state[interface.internal_state :]
        braking += add_losses(structure.laws, interface, moving, internal_state, scratch, out)
    if len(structure.bows) > 0:
        braking += bow_torque(structure, spin, motion)
        out[_BOW] = bow_loss(structure, spin, motion)
    torque = drive_torque(structure, loads, q, v, motion.v_dot, spin, braking)
    out[FLOW.drive] = torque * spin.omega
    out[FLOW.external] = external
    out[FLOW.structure] = structural
    out[FLOW.housing] = housing
    return torque


@jit
def load_power(structure, spin, i, load, v):
    """Return the power of one of the loads [W], by the velocities v [m/s]."""
    if structure.load_dof[i] >= 0:
        return (load.conjugate() * at_load(structure, i, v)).real
    return -(load.conjugate() * _momentum(structure, spin, v)).real


@jit
def has_power(structure, i, load):
    """Return whether power may enter with one of the loads."""
    return load != 0.0 or structure.load_arms[i].impedance > 0.0


@jit
def port_power(structure, spin, i, load, v):
    """Return the power that enters with one of the loads [W], for a transmission line less the
    reflected power."""
    power = load_power(structure, spin, i, load, v)
    impedance = structure.load_arms[i].impedance
    if impedance > 0.0:
        velocity = at_load(structure, i, v)
        power -= impedance * (velocity.real * velocity.real + velocity.imag * velocity.imag)
    return power


@jit
def _momentum(structure, spin, v):
    """Return the momentum of all masses on the base [N.s]."""
    n = structure.M.shape[0]
    total = 0.0j
    for i in range(n):
        total += structure.mass_sum[i] * v[i]
    for i in range(len(structure.unbalance)):
        total += 1j * spin.omega * structure.unbalance[i] * spin.direction
    for k in range(len(structure.housings)):
        m_x, m_y = masses(structure.housings[k])
        total += complex(m_x * v[n + k].real, m_y * v[n + k].imag)
    return total


@jit
def total_energy(structure, spin, motion, out):
    """Return the energy of the machine [J]. Fill out, shape (stores,) [J], in the order of
    `ledger.STORES`: kinetic (lateral, spin and their coupling), elastic (shaft, supports, housing
    springs), gravity with the constant forces, and the stores of the interface laws."""
    n = structure.M.shape[0]
    numbers = structure.numbers[0]
    rotor_q, rotor_v = motion.q[:n], motion.v[:n]
    kinetic = 0.5 * square(structure.M, rotor_v)
    kinetic += 0.5 * numbers.inertia * spin.omega * spin.omega
    kinetic -= 0.5 * spin.omega * form(structure.G, rotor_q, rotor_v).imag
    elastic = 0.5 * square(structure.K, rotor_q)
    if len(structure.bows) > 0:
        elastic += bow_energy(structure, spin, motion)
    g = numbers.gravity * complex(numbers.down_x, numbers.down_y)
    gravity = 0.0
    for i in range(n):
        gravity -= (structure.static_load[i].conjugate() * rotor_q[i]).real
    for i in range(len(structure.unbalance)):
        arm = structure.unbalance[i] * spin.direction
        v = at_place(structure.unbalances[i], motion.v)
        kinetic += spin.omega * (arm.conjugate() * v).imag
        gravity -= (g.conjugate() * arm).real
    for k in range(len(structure.housings)):
        housing = structure.housings[k]
        q, v = motion.q[n + k], motion.v[n + k]
        m_x, m_y = masses(housing)
        kinetic += 0.5 * (m_x * v.real * v.real + m_y * v.imag * v.imag)
        elastic += 0.5 * (housing.kx * q.real * q.real + housing.ky * q.imag * q.imag)
        gravity -= m_x * g.real * q.real + m_y * g.imag * q.imag
    out[STORE.kinetic] = kinetic
    out[STORE.elastic] = elastic
    out[STORE.gravity] = gravity
    out[_MACHINE_STORES:] = 0.0
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        d, internal_state = (
            relative(interface, motion.q),
            motion.internal_state[interface.internal_state :],
        )
        add_energy(structure.laws, interface, d, internal_state, out)
    total = 0.0
    for i in range(len(out)):
        total += out[i]
    return total
