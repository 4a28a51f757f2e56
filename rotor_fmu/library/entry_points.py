"""The functions of the library: of addresses and numbers alone, each returning 0 where all is well:
those of a run (`model.march.entries`) a status, the others the code of a sentence (`messages`).

block: of a run (`model.march.block`); given, own: the solver's settings (`settings.resolver`);
told: the numbers of the sentence, `TOLD` at most.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from numba import types

from ..model import messages as say
from ..model import outcomes
from ..model.doubts import DOUBTS
from ..model.kernels.compiled import compiled
from ..model.march import entries, march
from ..model.march.block import LAYOUT
from ..model.settings import resolver

_BLOCK, _NUMBERS = types.CPointer(types.uint8), types.CPointer(types.float64)
_REAL = types.float64
_view = LAYOUT.view


def rotor_settle(block, given, told):
    """Take up the solver's settings; `given` then holds what was chosen."""
    run = _view(block)
    code = resolver.resolve(given, run.method.numbers[0], told)
    if code == say.GOOD:
        resolver.begin(given, run.memory.record[0])
    return code


def rotor_doubt(block, given, own, told, slot):
    """What makes a run with one of them doubtful, or, behind the last, with all of them."""
    return resolver.warning(given, own, _view(block).method.numbers[0], told, slot)


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
    return outcomes.no_rest(_view(block), status, told)


assert [doubt.since for doubt in DOUBTS] == ["trapped_at", "overdamped_at", "slow_at", "coarse_at"]


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
    return outcomes.growth_at_rest(_view(block).survey.rest[0], told)


def rotor_hidden(block, told):
    """Which of the whirls that `rotor_survey` found the steps hide."""
    return outcomes.hidden(_view(block), told)


def rotor_outcome(block, status, told):
    """What `rotor_advance` came to; a negative code is a warning about a run that goes on. Where it
    diverged, `rotor_survey` has to have been asked anew."""
    run = _view(block)
    if status == march.DONE:
        return _last_doubt(run.memory.record[0], told)
    return outcomes.failure(run, status, told)


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
