"""The functions of the library: of addresses and numbers alone, each returning 0 where all is well:
those of a run (`model.march.entries`) a status, the others the code of a sentence (`sentences`).

block: of a run (`model.march.block`); given: the solver's parameters (`settle`); told: the numbers
of the sentence, `TOLD` at most.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from numba import types

from ..model.kernels.compiled import compiled
from ..model.kernels.functions import modulus
from ..model.march import entries, equilibrium, march
from ..model.march.block import LAYOUT
from ..model.march.control import CONTROLLED, FIXED
from ..model.stability.resolution import is_stable, resolving_step, seen_growth
from ..model.stability.sentences import ROUNDING, TWO_DIGITS
from ..model.stability.whirls import HIDDEN, RESOLVED, rounded_down
from . import sentences as say
from .settle import doubt, radius_at_infinity, settle

TOLD = 16
_TWO_PI = 2 * math.pi
_BLOCK, _NUMBERS = types.CPointer(types.uint8), types.CPointer(types.float64)
_REAL = types.float64
_view = LAYOUT.view


@compiled
def _farthest(run):
    """Which deflection is farthest away, or the first that is nowhere."""
    deflections = run.structure.deflections
    place, farthest = 0, -1.0
    for i in range(len(deflections)):
        q = run.motion.q[deflections[i, 0]]
        square = q.real * q.real + q.imag * q.imag
        distance = square if math.isfinite(square) else math.inf
        if distance > farthest:
            place, farthest = i, distance
    return place


def rotor_settle(block, given, told):
    """Take up the solver's parameters."""
    return settle(_view(block), given, told)


def rotor_doubt(block, given, own, told, slot):
    """What makes a run with one of them doubtful, or, behind the last, with all of them."""
    return doubt(_view(block), given, own, told, slot)


def rotor_survey(block, speed, is_start):
    """`entries.survey`."""
    entries.survey(block, speed, is_start)
    return say.GOOD


def rotor_look(block):
    """`entries.look`."""
    entries.look(block)
    return say.GOOD


def rotor_no_rest(block, status, told):
    """Why `rotor_start` found no equilibrium."""
    run = _view(block)
    return say.NO_REST_AT + equilibrium.why_not(run.structure, run.motion, status, told)


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


def rotor_growth(block, told):
    """What `rotor_survey` found to grow at rest."""
    root = _view(block).survey.rest[0]
    if root != root:
        return say.GOOD
    if root.imag > ROUNDING * modulus(root):
        told[0], told[1] = root.imag / _TWO_PI, root.imag
        told[2] = -_TWO_PI * root.real / root.imag
        return say.OSCILLATES_AT_REST
    told[0] = root.real
    return say.MOVES_AT_REST


@compiled
def _tell_whirl(whirl, told, at):
    """Six numbers about a row of `survey.found`."""
    told[at] = -1.0 - whirl[3] if whirl[3] < 0.0 else whirl[3] + 2.0
    told[at + 1] = whirl[2]
    told[at + 2], told[at + 3] = whirl[1] / _TWO_PI, whirl[1]
    told[at + 4], told[at + 5] = whirl[0], whirl[4]


def rotor_hidden(block, told):
    """Which of the whirls that `rotor_survey` found the steps hide: see
    `stability.sentences.hidden_whirls`."""
    run = _view(block)
    survey, numbers = run.survey, run.method.numbers[0]
    if numbers.mode == CONTROLLED or not is_stable(numbers):
        return say.GOOD
    h = run.memory.record[0].h if numbers.mode == FIXED else numbers.h_max
    longest = math.inf
    for i in range(survey.counted[0]):
        whirl = survey.found[i]
        root = complex(whirl[0], whirl[1])
        seen = seen_growth(numbers, h, root)
        if not seen < HIDDEN * root.real:
            continue
        if longest == math.inf:
            told[0] = h
            _tell_whirl(whirl, told, 1)
            told[7] = modulus(root) * h
            told[8] = told[10] = 1.0 if seen < 0.0 else 0.0
            told[9] = abs(seen)
        longest = min(longest, resolving_step(numbers, root, RESOLVED))
    if longest == math.inf:
        return say.GOOD
    told[11] = rounded_down(longest, TWO_DIGITS)
    return say.HIDES


@compiled
def _whirled_apart(run, told):
    """Whether there are growing whirls; if so, from told[5] on, the one most like the motion
    reached: see `stability.sentences.nearest`."""
    survey, motion, speed = run.survey, run.motion, run.memory.record[0].omega
    dof = run.structure.deflections[_farthest(run), 0]
    q, v = motion.q[dof], motion.v[dof]
    rate = (q.conjugate() * v).imag / (q.real * q.real + q.imag * q.imag)
    is_backward = (rate < 0.0) == (speed >= 0.0)
    is_any = True
    for i in range(survey.counted[0]):
        is_any = is_any and (survey.found[i, 2] == 1.0) != is_backward
    nearest = math.inf
    for i in range(survey.counted[0]):
        whirl = survey.found[i]
        ratio = whirl[1] / max(abs(rate), 1e-9)
        ratio = max(ratio, 1.0 / ratio)
        is_alike = is_any or (whirl[2] == 1.0) == is_backward
        if is_alike and (nearest == math.inf or ratio < nearest):
            nearest = ratio
            _tell_whirl(whirl, told, 5)
    told[11] = 1.0 if is_backward else 0.0
    told[12] = abs(rate) / _TWO_PI
    return survey.counted[0] > 0


def rotor_outcome(block, status, told):
    """What `rotor_advance` came to; a negative code is a warning about a run that goes on. Where it
    diverged, `rotor_survey` has to have been asked anew."""
    run = _view(block)
    r = run.memory.record[0]
    if status == march.DONE:
        return _last_doubt(r, told)
    told[0], told[1], told[2] = r.failed_at, r.omega, r.failed_h
    if status == march.NOT_CONVERGED:
        return say.NOT_CONVERGED
    if status == march.STALLED:
        return say.TOO_SLOW
    told[3] = run.structure.deflections[_farthest(run), 1]
    told[4] = run.structure.numbers[0].bound
    if not is_stable(run.method.numbers[0]):
        told[5] = radius_at_infinity(run.method.numbers[0])
        return say.DIVERGED_UNSTABLE
    return say.WHIRLED_APART if _whirled_apart(run, told) else say.DIVERGED


def _source(kernel: Any) -> Callable[..., Any]:
    """The function that a kernel is made of: compiled once, as the library's own."""
    function: Callable[..., Any] = kernel.py_func
    return function


FUNCTIONS = {
    "rotor_settle": (rotor_settle, (_BLOCK, _NUMBERS, _NUMBERS)),
    "rotor_doubt": (rotor_doubt, (_BLOCK, _NUMBERS, _NUMBERS, _NUMBERS, types.int64)),
    "rotor_start": (_source(entries.start), (_BLOCK, _REAL, _REAL, _REAL)),
    "rotor_advance": (_source(entries.advance), (_BLOCK, _REAL, _REAL, _REAL)),
    "rotor_survey": (rotor_survey, (_BLOCK, _REAL, types.int64)),
    "rotor_look": (rotor_look, (_BLOCK,)),
    "rotor_no_rest": (rotor_no_rest, (_BLOCK, types.int64, _NUMBERS)),
    "rotor_growth": (rotor_growth, (_BLOCK, _NUMBERS)),
    "rotor_hidden": (rotor_hidden, (_BLOCK, _NUMBERS)),
    "rotor_outcome": (rotor_outcome, (_BLOCK, types.int64, _NUMBERS)),
}
