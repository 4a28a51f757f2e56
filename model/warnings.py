"""The warnings about a run, each with the time from which it holds."""

from __future__ import annotations

from typing import NamedTuple

from .time_loop.monitors import SLOW


class RunWarning(NamedTuple):
    """A field of the run's record, the time from which the doubt holds [s] or NaN, its code (see
    `spelling.Message`), and the words in which that time stands."""

    since: str
    code: str
    words: str


_FASTER = (
    "take a larger solver.tolerance or the preset robust, softer contacts (k) or less friction (mu)"
)
RUN_WARNINGS = (
    RunWarning(
        "trapped_at",
        "false-state",
        "false state since t = {:.4g} s: a journal jumps from wall to wall of its clearance every "
        "step or two, which is the integrator's doing; do not trust this run: take the preset "
        "robust, or a smaller solver.h",
    ),
    RunWarning(
        "overdamped_at",
        "overdamped",
        "overdamped since t = {:.4g} s: while a journal rubs the integrator takes energy that the "
        "machine's own dampers would not, and may hide an instability; do not trust this run: take "
        "the preset controlled, or a smaller solver.h",
    ),
    RunWarning(
        "slow_at",
        "slow",
        f"slow since t = {{:.4g}} s: a cycle of the motion takes more than {SLOW:,} iterations; "
        f"{_FASTER}",
    ),
    RunWarning(
        "coarse_at",
        "too-coarse",
        "too coarse since t = {:.4g} s: steps of solver.h_min, below which none is made, miss the "
        "tolerance; take a smaller solver.h_min, or a larger solver.tolerance",
    ),
    RunWarning(
        "blind_at",
        "too-coarse-in-contact",
        "too coarse in contact since t = {:.4g} s: a contact closed in a step whose local error is "
        "above a tenth of the motion, and the run may have gone over to another solution; take a "
        "smaller solver.h or the preset controlled, and compare them with --verify",
    ),
)
UNFINISHED = (
    "stopped after {d} iterations (solver.max_iterations); go on in shorter communication steps, "
    f"or {_FASTER}"
)
