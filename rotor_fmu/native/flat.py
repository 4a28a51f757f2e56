"""The functions of the library: of addresses and numbers alone, each returning 0 where all is well:
those of a run (`model.march.entries`) a status, the others the code of a sentence (`sentences`).

block: of a run (`model.march.block`); given: the solver's parameters (`settle`); told: the numbers
of the sentence, `TOLD` at most.
"""

from __future__ import annotations

import math

from numba import types

from ..model.kernels.compiled import compiled
from ..model.march import entries, equilibrium, march
from ..model.march.block import LAYOUT
from . import sentences as say
from .settle import doubt, is_stable, radius_at_infinity, settle

TOLD = 8
_BLOCK, _NUMBERS = types.CPointer(types.uint8), types.CPointer(types.float64)
_REAL = types.float64
_view = LAYOUT.view


@compiled
def _held_nodes(run):
    """How many nodes have a spring or an interface."""
    structure = run.structure
    held = 0
    for dof in range(structure.M.shape[0]):
        is_held = False
        for i in range(len(structure.springs)):
            spring = structure.springs[i]
            is_held = is_held or (spring.dof == dof and spring.stiffness > 0.0)
        for j in range(len(structure.interfaces)):
            is_held = is_held or structure.interfaces[j].dof == dof
        held += 1 if is_held else 0
    return held


@compiled
def _farthest_node(run):
    """Number of the node that is farthest away, or the first that is nowhere."""
    deflections = run.structure.deflections
    node, farthest = 0, -1.0
    for i in range(len(deflections)):
        q = run.motion.q[deflections[i, 0]]
        square = q.real * q.real + q.imag * q.imag
        distance = square if math.isfinite(square) else math.inf
        if distance > farthest:
            node, farthest = deflections[i, 1], distance
    return node


def rotor_settle(block, given, told):
    """Take up the solver's parameters."""
    return settle(_view(block), given, told)


def rotor_doubt(block, given, own, told, slot):
    """What makes a run with one of them doubtful, or, behind the last, with all of them."""
    return doubt(_view(block), given, own, told, slot)


def rotor_start(block, speed, drive, rate):
    """`entries.start`; returns its status, as the next three do."""
    return entries.start(block, speed, drive, rate)


def rotor_advance(block, t_end, drive, rate):
    """`entries.advance`."""
    return entries.advance(block, t_end, drive, rate)


def rotor_linearize(block, by_d, by_v):
    """`entries.linearize`."""
    entries.linearize(block, by_d, by_v)
    return say.GOOD


def rotor_look(block):
    """`entries.look`."""
    entries.look(block)
    return say.GOOD


def rotor_no_rest(block, status, told):
    """Why `rotor_start` found no equilibrium."""
    run = _view(block)
    held = _held_nodes(run)
    if held < 2:
        told[0] = held
        return say.NOT_HELD
    if status == equilibrium.NOT_HELD:
        told[0] = run.structure.numbers[0].bound
        return say.TOO_FAR
    return say.NO_REST


@compiled
def _last_doubt(r, told):
    """The code of the one of `DOUBTS` that began last, 0 of none: whoever tells each once has told
    the others when they began."""
    code = say.GOOD
    told[0] = -math.inf
    for i, since in enumerate((r.trapped_at, r.overdamped_at, r.slow_at, r.coarse_at)):
        if since >= told[0]:
            told[0] = since
            code = -(say.DOUBTFUL + i)
    return code


def rotor_outcome(block, status, told):
    """What `rotor_advance` came to; a negative code is a warning about a run that goes on."""
    run = _view(block)
    r = run.memory.record[0]
    if status == march.DONE:
        return _last_doubt(r, told)
    told[0], told[1], told[2] = r.failed_at, r.omega, r.failed_h
    if status == march.NOT_CONVERGED:
        return say.NOT_CONVERGED
    if status == march.STALLED:
        return say.TOO_SLOW
    told[3], told[4] = _farthest_node(run), run.structure.numbers[0].bound
    told[5] = radius_at_infinity(run.method.numbers[0])
    return say.DIVERGED if is_stable(run.method.numbers[0]) else say.DIVERGED_UNSTABLE


FUNCTIONS = {
    rotor_settle: (_BLOCK, _NUMBERS, _NUMBERS),
    rotor_doubt: (_BLOCK, _NUMBERS, _NUMBERS, _NUMBERS, types.int64),
    rotor_start: (_BLOCK, _REAL, _REAL, _REAL),
    rotor_advance: (_BLOCK, _REAL, _REAL, _REAL),
    rotor_linearize: (_BLOCK, _REAL, _REAL),
    rotor_look: (_BLOCK,),
    rotor_no_rest: (_BLOCK, types.int64, _NUMBERS),
    rotor_outcome: (_BLOCK, types.int64, _NUMBERS),
}
