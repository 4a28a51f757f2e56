"""Bows of the shaft, which turn with the rotor (`structure.bow`).

A bow b [m], in the frame of the rotor, makes b e^(i theta) s, with a shape s, the stress-free line
of the shaft. The shaft is then pulled towards it with K_s s b e^(i theta), and with

    m = s^T K_s q,    V = |b|^2 s^T K_s s / 2 - Re(conj(m) b e^(i theta))

its elastic energy is larger by V than that of a straight shaft. The derivative of V with respect to
theta is a torque on the drive, that with respect to b the work of the heat.

A residual bow is constant. A thermal one changes slowly compared with a revolution, so that a step
extrapolates it with its rate at the beginning; the end of the step corrects it.
"""

from ..kernels.jit import jit
from ..structure.parameters import elastic_share


@jit
def _bow(structure, k, motion, ahead):
    """Return a bow [m], in the rotor's frame, `ahead` [s] of a motion."""
    return structure.bow[k] + _change(structure, k, motion, ahead)


@jit
def _change(structure, k, motion, ahead):
    """Return the thermal part of a bow [m], or along a row of a tangent."""
    at = structure.bows[k].state
    if at < 0:
        return 0.0j
    x = motion.internal_state[at] + ahead * motion.internal_rate[at]
    y = motion.internal_state[at + 1] + ahead * motion.internal_rate[at + 1]
    return complex(x, y)


@jit
def _rate(structure, k, motion):
    """Return the rate of a bow [m/s], in the rotor's frame."""
    at = structure.bows[k].state
    if at < 0:
        return 0.0j
    return complex(motion.internal_rate[at], motion.internal_rate[at + 1])


@jit
def _add_pull(structure, k, bow, f):
    """Add to f the force of the shaft towards a bow [m], in the frame that does not turn."""
    pull = elastic_share(structure.numbers[0].eta_h) * bow
    for i in range(len(f)):
        f[i] += structure.bow_forces[k, i] * pull


@jit
def is_bowed(structure):
    """Return whether the shaft has a residual bow."""
    result = False
    for k in range(len(structure.bows)):
        result = result or structure.bow[k] != 0.0
    return result


@jit
def add_residual_bows(structure, f):
    """Add to f, shape (n,) [N, N.m], the forces of the shaft towards its residual bows as the run
    begins, with the mark of the rotor to the right."""
    for k in range(len(structure.bows)):
        _add_pull(structure, k, structure.bow[k], f)


@jit
def add_bows(structure, spin, ahead, motion, f):
    """Add to f, shape (n,) [N, N.m], the forces of the shaft towards its bows, `ahead` [s] of the
    motion; spin: at that time."""
    for k in range(len(structure.bows)):
        bow = _bow(structure, k, motion, ahead)
        if bow != 0.0:
            _add_pull(structure, k, bow * spin.direction, f)


@jit
def add_bows_along(structure, spin, d_theta, share, ahead, row, motion, f):
    """Add to f `share` times the derivative of the forces of `add_bows` along a row of a tangent
    and along the angle."""
    for k in range(len(structure.bows)):
        change = _change(structure, k, row, ahead) + 1j * d_theta * _bow(structure, k, motion, 0.0)
        _add_pull(structure, k, share * change * spin.direction, f)


@jit
def _moment(structure, k, q):
    """Return m of a bow at displacements q, shape (n,) or longer [N]."""
    moment = 0.0j
    for i in range(structure.bow_forces.shape[1]):
        moment += structure.bow_forces[k, i] * q[i]
    return elastic_share(structure.numbers[0].eta_h) * moment


@jit
def _own_moment(structure, k, motion):
    """Return m of a bow for a shaft displaced by all its bows, in the rotor's frame [N]."""
    moment = 0.0j
    for other in range(len(structure.bows)):
        moment += structure.bow_stiffness[k, other] * _bow(structure, other, motion, 0.0)
    return elastic_share(structure.numbers[0].eta_h) * moment


@jit
def bow_torque(structure, spin, motion):
    """Return the torque that the bows demand of the drive [N.m]."""
    torque = 0.0
    for k in range(len(structure.bows)):
        bow = _bow(structure, k, motion, 0.0) * spin.direction
        torque += (_moment(structure, k, motion.q).conjugate() * bow).imag
    return torque


@jit
def bow_energy(structure, spin, motion):
    """Return the contribution of the bows to the elastic energy of the shaft [J]."""
    energy = 0.0
    for k in range(len(structure.bows)):
        bow = _bow(structure, k, motion, 0.0)
        moment = _moment(structure, k, motion.q) * spin.direction.conjugate()
        moment -= 0.5 * _own_moment(structure, k, motion)
        energy -= (moment.conjugate() * bow).real
    return energy


@jit
def bow_loss(structure, spin, motion):
    """Return the power of the shaft against the heat that bows it [W]."""
    power = 0.0
    for k in range(len(structure.bows)):
        moment = _moment(structure, k, motion.q) * spin.direction.conjugate()
        moment -= _own_moment(structure, k, motion)
        power += (moment.conjugate() * _rate(structure, k, motion)).real
    return power
