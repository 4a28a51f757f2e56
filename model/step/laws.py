"""The laws of all kinds of interfaces, each call one compiled function of (laws, interface, ...);
see `parts.law`. `interface` is a record of `assembly.INTERFACE`."""

from collections.abc import Callable

from ..kernels.jit import jit, jit_not_inlined
from ..parts import LAWS
from ..parts.law import Kinematics, Law, Weights, dispatcher
from ..structure.ledger import FLOWS, STORES

MOST_LOSSES = max(len(law.losses) for law in LAWS)


def _storing(law: Law) -> Callable:
    """Return a function that adds a law's energies to their places among `STORES`."""
    energy, count = law.energy, len(law.stores)
    places = tuple(STORES.index(store.name) for store in law.stores)

    def add(part, tables, displacement, internal_state, out):
        energies = energy(part, tables, displacement, internal_state)
        for i in range(count):
            out[places[i]] += energies[i]

    return jit(add, to_cache=False)


def _dissipating(law: Law) -> Callable:
    """Return a function that adds a law's dissipation to its places among `FLOWS` and returns the
    braking torque."""
    dissipate, count = law.dissipate, len(law.losses)
    # an index into none cannot be compiled
    places = tuple(FLOWS.index(loss.name) for loss in law.losses) or (0,)

    def add(part, tables, kinematics, internal_state, scratch, out):
        torque = dissipate(part, tables, kinematics, internal_state, scratch)
        for i in range(count):
            out[places[i]] += scratch[i]
        return torque

    return jit(add, to_cache=False)


def _both_tangents(law: Law) -> Callable:
    """Return a function for force and tangents of a law by displacement and by velocity, its states
    as given."""
    tangent = law.tangent

    def both(part, tables, kinematics, free, internal_state):
        """Return F [N], then p, q by displacement [N/m] and by velocity [N.s/m]."""
        force = p_d = q_d = p_v = q_v = 0.0j
        for by_v in range(2):  # a loop, so that its code is compiled once
            weights = Weights(1.0 - by_v, 1.0 * by_v, 0.0)
            force, p, q = tangent(part, tables, kinematics, weights, free, internal_state)
            if by_v == 0:
                p_d, q_d = p, q
            else:
                p_v, q_v = p, q
        return force, p_d, q_d, p_v, q_v

    return jit(both, to_cache=False)


def _vibrating(law: Law) -> Callable:
    """Return the function `Law.vibrate` of a law, or one for a law whose states do not follow a
    vibration."""
    if law.vibrate is not None:
        return law.vibrate
    both = _both_tangents(law)

    def vibrate(part, tables, kinematics, frequency, free, internal_state):
        """Do what `Law.vibrate` does for a law whose states do not follow at a frequency."""
        return both(part, tables, kinematics, free, internal_state)

    return jit(vibrate, to_cache=False)


def _linearizing(law: Law) -> Callable:
    """Return the function `Law.linearize` of a law, or one without the derivatives by states."""
    if law.linearize is not None:
        return law.linearize
    both, rates = _both_tangents(law), law.rates

    def linearize(part, tables, kinematics, internal_state, solved, slopes):
        """Do what `Law.linearize` does for a law that has no derivatives by its states."""
        rates(part, tables, kinematics, internal_state, slopes.rates)
        return both(part, tables, kinematics, internal_state, solved)

    return jit(linearize, to_cache=False)


law_force = dispatcher([law.force for law in LAWS])
law_tangent = dispatcher([law.tangent for law in LAWS])
law_vibrate = dispatcher([_vibrating(law) for law in LAWS])
_linearize = dispatcher([_linearizing(law) for law in LAWS])
law_gap = dispatcher([law.gap for law in LAWS], takes_tables=False)
law_breaks = dispatcher([law.breaks for law in LAWS])
law_rates = dispatcher([law.rates for law in LAWS])
law_observe = dispatcher([law.observe for law in LAWS])
add_energy = dispatcher([_storing(law) for law in LAWS])
add_losses = dispatcher([_dissipating(law) for law in LAWS])


@jit_not_inlined
def law_tangent_called(laws, interface, kinematics, weights, free, internal_state):
    """Return `law_tangent`, not inlined because it is large: for all calls but the iterations of a
    step."""
    return law_tangent(laws, interface, kinematics, weights, free, internal_state)


@jit_not_inlined
def law_linearize(laws, interface, kinematics, internal_state, solved, slopes):
    """Return what `Law.linearize` does, not inlined because it is large."""
    return _linearize(laws, interface, kinematics, internal_state, solved, slopes)


@jit
def relative(interface, z):
    """Return the value of z, shape (size,), at a node relative to its housing or to ground."""
    return z[interface.dof] - z[interface.end]


@jit
def squared_normal_force(d, force):
    """Return the square of the part along d, a displacement from the middle other than 0, of an
    interface's force [N2]."""
    along = d.real * force.real + d.imag * force.imag
    return along * along / (d.real * d.real + d.imag * d.imag)


@jit
def sides(interface):
    """Return the two rows between which an interface acts, and the sign of its force there."""
    return (interface.end, -1.0), (interface.dof, 1.0)


@jit
def side_of(interface, place):
    """Return the sign of an interface's force on the housing in row `place`: 1.0 as on a node, -1.0
    opposite, 0.0 if it does not act there."""
    if interface.end == place:
        return -1.0
    return 1.0 if interface.dof == place else 0.0


@jit
def first_invalid_law(structure, q, internal_state):
    """Return the first interface whose law is invalid at the displacements q [m] and with its
    internal states, or -1."""
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        d, states = relative(interface, q), internal_state[interface.internal_state :]
        if law_breaks(structure.laws, interface, d, states):
            return j
    return -1


@jit
def kinematics(interface, spin, q, v):
    """Return the `Kinematics` of an interface, q, v of shape (size,)."""
    return Kinematics(
        relative(interface, q), relative(interface, v), spin.omega, spin.sliding, spin.theta
    )


@jit
def at_rest(displacement, speed):
    """Return the `Kinematics` of an interface whose node rests and whose surfaces do not slide."""
    return Kinematics(displacement, 0.0j, speed, 0.0, 0.0)
