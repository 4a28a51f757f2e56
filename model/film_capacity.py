"""The load and the capacity of a film that cannot carry the machine at its start."""

from .kernels.functions import modulus
from .kernels.jit import jit, jit_not_inlined
from .parts.law import Weights
from .step.excitation import add_applied, static_spin
from .step.laws import at_rest, law_breaks, law_tangent_called, relative

_HALVINGS = 40


@jit_not_inlined
def film_load(run, j):
    """Return the part of the weight and of the loads at the start that interface j bears [N], and
    whether it is known: the lever rule gives it where one other node supports the machine;
    otherwise the load of the whole machine is returned."""
    structure, memory = run.structure, run.memory
    applied = run.motion.v_dot  # unused until the run begins
    applied[:] = 0.0
    add_applied(structure, static_spin(memory.record[0].omega), memory.loads, applied)
    total = moment = 0.0j
    for i in range(len(structure.static_load)):
        total += structure.one_body[0, i] * applied[i]
        moment += structure.one_body[1, i] * applied[i]
        applied[i] = 0.0
    dof_of_film = structure.interfaces[j].dof
    others, other = 0, dof_of_film
    for dof in range(len(structure.static_load)):
        if dof != dof_of_film and is_supported(structure, dof):
            others += 1
            other = dof
    if others != 1 or dof_of_film >= len(structure.static_load):
        return modulus(total), False
    here, there = structure.one_body[1, dof_of_film], structure.one_body[1, other]
    return modulus((moment - there * total) / (here - there)), True


@jit
def is_supported(structure, dof):
    """Return whether a spring or an interface acts at a dof."""
    result = False
    for i in range(len(structure.springs)):
        spring = structure.springs[i]
        result = result or (spring.dof == dof and spring.stiffness > 0.0)
    for j in range(len(structure.interfaces)):
        result = result or structure.interfaces[j].dof == dof
    return result


@jit_not_inlined
def film_capacity(run, j):
    """Return the largest force [N] of interface j, whose law is invalid where the last step led,
    along that displacement: the force where the law is just still valid."""
    structure = run.structure
    interface = structure.interfaces[j]
    d = relative(interface, run.trial.q)
    states = run.trial.internal_state[interface.internal_state :]
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if law_breaks(structure.laws, interface, middle * d, states):
            high = middle
        else:
            low = middle
    force, _p, _q = law_tangent_called(
        *(structure.laws, interface, at_rest(low * d, run.memory.record[0].omega)),
        *(Weights(1.0, 0.0, 0.0), states, run.problem.internal_state[interface.internal_state :]),
    )
    return modulus(force)
