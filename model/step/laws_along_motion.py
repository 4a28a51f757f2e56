"""The laws of some interfaces at many samples of their motion: compiled entry points, functions of
a block alone. They return DONE."""

from typing import Annotated, Any, NamedTuple

import numpy as np

from ..kernels.block import Layout
from ..kernels.jit import jit, jit_not_inlined
from ..parts import LAWS
from ..parts.law import Kinematics, Law, StateSlopes, Weights
from ..structure.structure import INTERFACE, LAW_TABLES, sizes_of_laws
from .laws import law_breaks, law_gap, law_linearize, law_rates, law_tangent_called, law_vibrate
from .step_status import DONE


class Interfaces(NamedTuple):
    """The laws' tables, and the interfaces to be evaluated."""

    laws: Annotated[tuple, LAW_TABLES]
    interfaces: Annotated[np.recarray, INTERFACE, "interfaces"]


class Samples(NamedTuple):
    """Relative displacements [m], velocities [m/s] and internal states of the interfaces at
    samples; the states that the laws solve for; forces [N], their tangents p z + q conj(z) with
    respect to displacement and velocity, rates of the states with the derivatives of `StateSlopes`,
    gaps [m], and whether the laws are invalid."""

    d: Annotated[np.ndarray, complex, "interfaces", "samples"]
    v: Annotated[np.ndarray, complex, "interfaces", "samples"]
    states: Annotated[np.ndarray, float, "samples", "states"]
    solved: Annotated[np.ndarray, float, "samples", "states"]
    force: Annotated[np.ndarray, complex, "interfaces", "samples"]
    p: Annotated[np.ndarray, complex, "2", "interfaces", "samples"]
    q: Annotated[np.ndarray, complex, "2", "interfaces", "samples"]
    rates: Annotated[np.ndarray, float, "samples", "states"]
    force_by_states: Annotated[np.ndarray, complex, "samples", "states"]
    rates_by_d: Annotated[np.ndarray, complex, "samples", "states"]
    rates_by_v: Annotated[np.ndarray, complex, "samples", "states"]
    rates_by_states: Annotated[np.ndarray, float, "samples", "states", "states"]
    gap: Annotated[np.ndarray, float, "interfaces", "samples"]
    is_invalid: Annotated[np.ndarray, bool, "interfaces", "samples"]


class LawData(NamedTuple):
    """All arrays of a block."""

    machine: Interfaces
    samples: Samples


LAYOUT = Layout(LawData)
_view = LAYOUT.view


def block_of(laws: tuple, interfaces: np.recarray, samples: int) -> tuple[np.ndarray, LawData]:
    """Return a block for a number of samples, and its arrays."""
    states = int(interfaces.states.sum())
    sizes = {"interfaces": len(interfaces), "samples": samples, "states": states}
    block = LAYOUT.new(sizes | sizes_of_laws(laws))
    data: LawData = LAYOUT.view_in_python(block)
    fill(data.machine, laws, interfaces)
    return block, data


def single_law(law: Law, record: Any, tables: np.ndarray, states: int) -> tuple[tuple, np.recarray]:
    """Return the tables of laws and the interfaces for one law that acts by itself, with a number
    of states."""
    index = LAWS.index(law)
    records = [np.zeros(int(i == index), each.dtype) for i, each in enumerate(LAWS)]
    records[index][0] = record
    interface = np.zeros(1, INTERFACE).view(np.recarray)
    interface.law, interface.states = index, states
    return (*records, tables), interface


def fill(machine: Interfaces, laws: tuple, interfaces: np.recarray) -> None:
    """Fill a block's `Interfaces`."""
    for target, source in zip(machine.laws, laws, strict=True):
        target[...] = source
    machine.interfaces[...] = interfaces


@jit
def call_laws(block, displacement, velocity, rate, speed):
    """Fill in the forces, the rates and the first of the tangents, for these `Weights`, at all
    samples, at a speed of rotation [rad/s]."""
    run = _view(block)
    weights = Weights(displacement, velocity, rate)
    laws, interfaces = run.machine
    samples = run.samples
    for j in range(len(interfaces)):
        interface = interfaces[j]
        at = interface.internal_state
        for t in range(samples.d.shape[1]):
            motion = Kinematics(samples.d[j, t], samples.v[j, t], speed, speed, 0.0)
            states, solved = samples.states[t, at:], samples.solved[t, at:]
            samples.force[j, t], samples.p[0, j, t], samples.q[0, j, t] = law_tangent_called(
                laws, interface, motion, weights, states, solved
            )
            law_rates(laws, interface, motion, states, samples.rates[t, at:])
    return DONE


@jit
def linearize_laws(block, speed):
    """Fill in the forces, the rates and all their derivatives at all samples, those by states where
    a law has them, at a speed of rotation [rad/s]."""
    run = _view(block)
    fill_linearized(run.machine, run.samples, speed)
    return DONE


@jit_not_inlined
def fill_linearized(machine, samples, speed):
    """Do what `linearize_laws` does."""
    laws, interfaces = machine
    for j in range(len(interfaces)):
        interface = interfaces[j]
        at = interface.internal_state
        for t in range(samples.d.shape[1]):
            motion = Kinematics(samples.d[j, t], samples.v[j, t], speed, speed, 0.0)
            slopes = StateSlopes(
                *(samples.rates[t, at:], samples.force_by_states[t, at:]),
                *(samples.rates_by_d[t, at:], samples.rates_by_v[t, at:]),
                samples.rates_by_states[t, at:, at:],
            )
            force, p_d, q_d, p_v, q_v = law_linearize(
                *(laws, interface, motion, samples.states[t, at:], samples.solved[t, at:], slopes)
            )
            samples.force[j, t] = force
            samples.p[0, j, t], samples.q[0, j, t] = p_d, q_d
            samples.p[1, j, t], samples.q[1, j, t] = p_v, q_v


@jit
def vibrate_laws(block, speed, sliding, frequency):
    """Fill in forces and tangents at rest at all displacements, for a vibration with a frequency
    [rad/s], and whether the laws are invalid there; speed, sliding: see `Kinematics` [rad/s]."""
    run = _view(block)
    laws, interfaces = run.machine
    samples = run.samples
    for j in range(len(interfaces)):
        interface = interfaces[j]
        at = interface.internal_state
        for t in range(samples.d.shape[1]):
            motion = Kinematics(samples.d[j, t], 0.0j, speed, sliding, 0.0)
            states, solved = samples.states[t, at:], samples.solved[t, at:]
            force, p_d, q_d, p_v, q_v = law_vibrate(
                *(laws, interface, motion, frequency, states, solved)
            )
            samples.is_invalid[j, t] = law_breaks(laws, interface, motion.displacement, solved)
            samples.force[j, t] = force
            samples.p[0, j, t], samples.q[0, j, t] = p_d, q_d
            samples.p[1, j, t], samples.q[1, j, t] = p_v, q_v
    return DONE


@jit
def find_gaps(block):
    """Fill in the gaps at all samples."""
    run = _view(block)
    laws, interfaces = run.machine
    for j in range(len(interfaces)):
        for t in range(run.samples.d.shape[1]):
            run.samples.gap[j, t] = law_gap(laws, interfaces[j], run.samples.d[j, t])
    return DONE


@jit
def find_invalid(block):
    """Fill in whether the laws are invalid at all samples."""
    run = _view(block)
    laws, interfaces = run.machine
    samples = run.samples
    for j in range(len(interfaces)):
        interface = interfaces[j]
        for t in range(samples.d.shape[1]):
            states = samples.states[t, interface.internal_state :]
            samples.is_invalid[j, t] = law_breaks(laws, interface, samples.d[j, t], states)
    return DONE
