"""The warnings about a run, each with the time from which it holds."""

from __future__ import annotations

from typing import NamedTuple

# Iterations in a cycle of the rotation or of the lowest mode, whichever is faster, above which a
# run is called slow: with steps by tolerance a cycle takes some hundreds.
SLOW = 300_000
# Error of a step, of the motion, above which a contact that closes in it may put a run on another
# branch of solutions without any other sign; error control with this tolerance keeps to it.
COARSEST_IN_CONTACT = 0.1


class RunWarning(NamedTuple):
    """A field of the run's record, the time from which the warning holds [s] or NaN, its code (see
    `spelling.Message`), and its sentence, in which that time is filled in."""

    since: str
    code: str
    words: str


FINER = "a smaller solver.h or solver.tolerance"
_FASTER = (
    "take a larger solver.tolerance or the preset robust, softer contacts (k) or less friction (mu)"
)
RUN_WARNINGS = (
    RunWarning(
        "trapped_at",
        "false-state",
        "false state since t = {:.4g} s: a journal jumps from wall to wall of its clearance every "
        "step or two, caused by the integrator; do not trust this run: take the preset "
        f"robust, or {FINER}",
    ),
    RunWarning(
        "overdamped_at",
        "overdamped",
        "overdamped since t = {:.4g} s: while a journal rubs the integrator dissipates more energy "
        "than the machine's own dampers, and may hide an instability; do not trust this run: take "
        f"the preset controlled, or {FINER}",
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
        "too coarse since t = {:.4g} s: steps of solver.h_min, the shortest allowed, miss the "
        "tolerance; take a smaller solver.h_min, or a larger solver.tolerance",
    ),
    RunWarning(
        "blind_at",
        "too-coarse-in-contact",
        "too coarse in contact since t = {:.4g} s: a contact closed in a step whose local error is "
        "above a tenth of the motion, and the run may have gone over to another solution; take a "
        "smaller solver.h, or the preset controlled with a solver.tolerance of at most "
        f"{COARSEST_IN_CONTACT}, and compare them with --verify",
    ),
)
UNFINISHED = (
    "stopped after {d} iterations (solver.max_iterations); go on in shorter communication steps, "
    f"or {_FASTER}"
)
