"""The functions that the solver library exports. Their arguments are addresses and numbers alone,
and they return 0 where all is well: otherwise those of a run (`model.time_loop.entry_points`), of
laws (`model.step.laws_along_motion`) and of periodic motions (`model.periodic.entry_points`) a
status, the others the code of a message (`messages`).

block: of a run (`model.time_loop.block`), of laws or of periodic motions; given, own: the solver's
settings (`settings.resolver`); arguments: the numbers of the message, at most `MOST_ARGUMENTS`.
"""

import math
from collections.abc import Callable, Mapping
from typing import Any

from numba import literal_unroll, types

from ..model import messages, outcomes
from ..model.kernels.jit import jit
from ..model.kernels.signatures import INTEGER, LAWS, PERIODIC, REAL, RUN
from ..model.periodic import entry_points as periodic
from ..model.settings import resolver
from ..model.step import laws_along_motion
from ..model.step.step_status import DONE
from ..model.time_loop import entry_points
from ..model.time_loop.block import LAYOUT
from ..model.warnings import RUN_WARNINGS

_BLOCK, _NUMBERS = types.CPointer(types.uint8), types.CPointer(types.float64)
_TYPES = {REAL: types.float64, INTEGER: types.int64}
_view = LAYOUT.view


def rotor_resolve_settings(block, given, arguments):
    """Resolve the solver's settings; `given` then holds the resolved values."""
    run = _view(block)
    code = resolver.resolve(given, run.method.numbers[0], arguments)
    if code == messages.GOOD:
        resolver.begin(given, run.memory.record[0])
    return code


def rotor_settings_warning(block, given, own, arguments, slot):
    """Return the warning about one of the settings, or, behind the last, about all of them."""
    return resolver.warning(given, own, _view(block).method.numbers[0], arguments, slot)


def rotor_no_rest(block, status, arguments):
    """Return why `rotor_start` has no equilibrium."""
    return outcomes.no_rest(_view(block), status, arguments)


# the fields of a run's record
_SINCE = tuple(warning.since for warning in RUN_WARNINGS)


@jit
def _last_run_warning(r, arguments):
    """Return the code of the one of `RUN_WARNINGS` that began last, 0 if there is none: a caller
    that shows each once has shown the earlier ones when they began."""
    code = messages.GOOD
    arguments[0] = -math.inf
    i = 0
    for name in literal_unroll(_SINCE):
        if r[name] >= arguments[0]:
            arguments[0] = r[name]
            code = -(messages.FIRST_RUN_WARNING + i)
        i += 1  # noqa: SIM113 (numba unrolls the names alone)
    return code


def rotor_growth(block, arguments):
    """Return the message about the growth at rest of the last `rotor_survey`."""
    return outcomes.growth_at_rest(_view(block).survey.rest[0], arguments)


def rotor_unstable(block, arguments):
    """Return the message about a whirl of the last `rotor_survey` that is the machine's own."""
    return outcomes.unstable(_view(block), arguments)


def rotor_hidden(block, arguments):
    """Return the message about a whirl of the last `rotor_survey` that the steps hide."""
    return outcomes.hidden(_view(block), arguments)


def rotor_outcome(block, status, arguments):
    """Return the outcome of `rotor_advance`; a negative code is a warning about a run that goes on.
    If it diverged, `rotor_survey` must have been called again before."""
    run = _view(block)
    if status == DONE:
        return _last_run_warning(run.memory.record[0], arguments)
    return outcomes.failure(run, status, arguments)


def _source(kernel: Any) -> Callable[..., Any]:
    """Return the function that a kernel is made of: compiled once, as the library's own."""
    function: Callable[..., Any] = kernel.py_func
    return function


def _exported(module: Any, signatures: Mapping[str, tuple[str, ...]]) -> dict[str, Any]:
    """Return the entry points of a module with the types of their arguments."""
    return {
        f"rotor_{name}": (_source(getattr(module, name)), (_BLOCK, *(_TYPES[n] for n in numbers)))
        for name, numbers in signatures.items()
    }


FUNCTIONS = {
    "rotor_resolve_settings": (rotor_resolve_settings, (_BLOCK, _NUMBERS, _NUMBERS)),
    "rotor_settings_warning": (
        rotor_settings_warning,
        (_BLOCK, _NUMBERS, _NUMBERS, _NUMBERS, types.int64),
    ),
    "rotor_no_rest": (rotor_no_rest, (_BLOCK, types.int64, _NUMBERS)),
    "rotor_growth": (rotor_growth, (_BLOCK, _NUMBERS)),
    "rotor_unstable": (rotor_unstable, (_BLOCK, _NUMBERS)),
    "rotor_hidden": (rotor_hidden, (_BLOCK, _NUMBERS)),
    "rotor_outcome": (rotor_outcome, (_BLOCK, types.int64, _NUMBERS)),
    **_exported(entry_points, RUN),
    **_exported(laws_along_motion, LAWS),
    **_exported(periodic, PERIODIC),
}
