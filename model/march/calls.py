"""The compiled functions that Python calls, taking named tuples as plain ones.

numba recognizes a named tuple by its layout and takes those of two packages (two builds of the FMU
in one process, say) for each other; it then works out all types anew at every call, which costs
more than the steps. Plain tuples have no class to mistake.
"""

from __future__ import annotations

from ..kernels.compiled import compiled
from ..schemes.family import Scheme
from ..step.contact_problem import ContactProblem
from ..step.step import Motion, Workspace
from ..structure.assembly import Structure
from . import march
from .control import Control
from .memory import Memory
from .observe import observe


def plain(structure, motion, memory, work):
    """The named tuples of a run as the plain ones that the functions below take."""
    return tuple(structure), tuple(motion), tuple(memory), (*work[:-1], tuple(work.problem))


@compiled
def _workspace(work):
    return Workspace(
        work[0],
        work[1],
        work[2],
        work[3],
        work[4],
        work[5],
        work[6],
        ContactProblem(*work[7]),
    )


@compiled
def start(structure, motion, memory, work, drive, rate, loads, observed):
    """`march.begin_interval` at the start of a run; fills `observed`."""
    machine, state, book = Structure(*structure), Motion(*motion), Memory(*memory)
    scratch = _workspace(work)
    march.begin_interval(machine, drive, rate, loads, True, state, book, scratch)
    observe(machine, state, book, scratch, observed)


@compiled
def advance(structure, motion, memory, work, scheme, control, t_end, drive, loads, trial, observed):
    """`march.advance`; fills `observed`, returns the status."""
    machine, state, book = Structure(*structure), Motion(*motion), Memory(*memory)
    scratch = _workspace(work)
    status = march.advance(
        machine,
        Scheme(*scheme),
        Control(*control),
        t_end,
        drive,
        loads,
        state,
        Motion(*trial),
        book,
        scratch,
    )
    observe(machine, state, book, scratch, observed)
    return status


@compiled
def look(structure, motion, memory, work, observed):
    """`observe` alone."""
    observe(Structure(*structure), Motion(*motion), Memory(*memory), _workspace(work), observed)
