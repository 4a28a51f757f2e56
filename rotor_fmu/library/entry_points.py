"""The functions of the library: of addresses and numbers alone, each returning 0 where all is well:
those of a run (`model.time_loop.entries`) a status, the others the code of a sentence (`messages`).

block: of a run (`model.time_loop.block`); given, own: the solver's settings (`settings.resolver`);
arguments: the numbers of the sentence, `TOLD` at most.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from numba import types

from ..model import messages, outcomes
from ..model.kernels.jit import jit
from ..model.settings import resolver
from ..model.time_loop import entries, time_loop
from ..model.time_loop.block import LAYOUT
from ..model.warnings import RUN_WARNINGS

_BLOCK, _NUMBERS = types.CPointer(types.uint8), types.CPointer(types.float64)
_REAL = types.float64
_view = LAYOUT.view


def rotor_resolve_settings(block, given, arguments):
    """Take up the solver's settings; `given` then holds what was chosen."""
    run = _view(block)
    code = resolver.resolve(given, run.method.numbers[0], arguments)
    if code == messages.GOOD:
        resolver.begin(given, run.memory.record[0])
    return code


def rotor_settings_warning(block, given, own, arguments, slot):
    """What makes a run with one of them doubtful, or, behind the last, with all of them."""
    return resolver.warning(given, own, _view(block).method.numbers[0], arguments, slot)


def rotor_survey(block, speed, is_start):
    """`entries.survey`."""
    entries.survey(block, speed, is_start)
    return messages.GOOD


def rotor_refresh_outputs(block):
    """`entries.refresh_outputs`."""
    entries.refresh_outputs(block)
    return messages.GOOD


def rotor_no_rest(block, status, arguments):
    """Why `rotor_start` found no equilibrium."""
    return outcomes.no_rest(_view(block), status, arguments)


assert [warning.since for warning in RUN_WARNINGS] == [
    "trapped_at",
    "overdamped_at",
    "slow_at",
    "coarse_at",
    "blind_at",
]


@jit
def _last_run_warning(r, arguments):
    """The code of the one of `RUN_WARNINGS` that began last, 0 of none: whoever tells each once has
    told the others when they began."""
    code = messages.GOOD
    arguments[0] = -math.inf
    for i, since in enumerate((r.trapped_at, r.overdamped_at, r.slow_at, r.coarse_at, r.blind_at)):
        if since >= arguments[0]:
            arguments[0] = since
            code = -(messages.FIRST_RUN_WARNING + i)
    return code


def rotor_growth(block, arguments):
    """What `rotor_survey` found to grow at rest."""
    return outcomes.growth_at_rest(_view(block).survey.rest[0], arguments)


def rotor_unstable(block, arguments):
    """Which of the whirls that `rotor_survey` found is the machine's own."""
    return outcomes.unstable(_view(block), arguments)


def rotor_hidden(block, arguments):
    """Which of the whirls that `rotor_survey` found the steps hide."""
    return outcomes.hidden(_view(block), arguments)


def rotor_outcome(block, status, arguments):
    """What `rotor_advance` came to; a negative code is a warning about a run that goes on. Where it
    diverged, `rotor_survey` has to have been asked anew."""
    run = _view(block)
    if status == time_loop.DONE:
        return _last_run_warning(run.memory.record[0], arguments)
    return outcomes.failure(run, status, arguments)


def _source(kernel: Any) -> Callable[..., Any]:
    """The function that a kernel is made of: compiled once, as the library's own."""
    function: Callable[..., Any] = kernel.py_func
    return function


FUNCTIONS = {
    "rotor_resolve_settings": (rotor_resolve_settings, (_BLOCK, _NUMBERS, _NUMBERS)),
    "rotor_settings_warning": (
        rotor_settings_warning,
        (_BLOCK, _NUMBERS, _NUMBERS, _NUMBERS, types.int64),
    ),
    "rotor_start": (_source(entries.start), (_BLOCK, _REAL, _REAL, _REAL)),
    "rotor_advance": (_source(entries.advance), (_BLOCK, _REAL, _REAL, _REAL)),
    "rotor_survey": (rotor_survey, (_BLOCK, _REAL, types.int64)),
    "rotor_refresh_outputs": (rotor_refresh_outputs, (_BLOCK,)),
    "rotor_no_rest": (rotor_no_rest, (_BLOCK, types.int64, _NUMBERS)),
    "rotor_growth": (rotor_growth, (_BLOCK, _NUMBERS)),
    "rotor_unstable": (rotor_unstable, (_BLOCK, _NUMBERS)),
    "rotor_hidden": (rotor_hidden, (_BLOCK, _NUMBERS)),
    "rotor_outcome": (rotor_outcome, (_BLOCK, types.int64, _NUMBERS)),
}
