"""Of a start that a film does not carry: the load on that film, and what it would carry."""

from __future__ import annotations

from .kernels.functions import modulus
from .kernels.jit import jit, jit_not_inlined
from .parts.law import Weights
from .step.excitation import add_applied, static_spin
from .step.laws import at_rest, law_breaks, law_tangent_called, relative

_HALVINGS = 40


@jit_not_inlined
def load_on(run, j):
    """Return the load that the weight and the loads at the start put on interface j [N], and
    whether that is known: of a machine held at another node alone, by the lever; of others all of
    the machine's."""
    structure, memory = run.structure, run.memory
    applied = run.motion.v_dot  # nobody's until the run begins
    for i in range(len(applied)):
        applied[i] = 0.0
    add_applied(structure, static_spin(memory.record[0].omega), memory.loads, applied)
    total = moment = 0.0j
    for i in range(len(structure.weight)):
        total += structure.one_body[0, i] * applied[i]
        moment += structure.one_body[1, i] * applied[i]
        applied[i] = 0.0
    own = structure.interfaces[j].dof
    others, other = 0, own
    for dof in range(len(structure.weight)):
        if dof != own and is_held(structure, dof):
            others += 1
            other = dof
    if others != 1 or own >= len(structure.weight):
        return modulus(total), False
    here, there = structure.one_body[1, own], structure.one_body[1, other]
    return modulus((moment - there * total) / (here - there)), True


@jit
def is_held(structure, dof):
    """Return whether a spring or an interface acts at a dof."""
    result = False
    for i in range(len(structure.springs)):
        spring = structure.springs[i]
        result = result or (spring.dof == dof and spring.stiffness > 0.0)
    for j in range(len(structure.interfaces)):
        result = result or structure.interfaces[j].dof == dof
    return result


@jit_not_inlined
def carried_by(run, j):
    """Return the force of interface j, whose law breaks where the last step led, in that direction
    where it breaks just not yet [N]."""
    structure = run.structure
    interface = structure.interfaces[j]
    d = relative(interface, run.trial.q)
    own = run.trial.internal_state[interface.internal_state :]
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if law_breaks(structure.laws, interface, middle * d, own):
            high = middle
        else:
            low = middle
    force, _p, _q = law_tangent_called(
        *(structure.laws, interface, at_rest(low * d, run.memory.record[0].omega)),
        *(Weights(1.0, 0.0, 0.0), own, run.problem.internal_state[interface.internal_state :]),
    )
    return modulus(force)
