"""The warnings about a run, each with the time from which it holds."""

from typing import NamedTuple

# Iterations in a cycle of the rotation or of the lowest mode, whichever is faster, above which a
# run is called slow: with steps by tolerance a cycle takes some hundreds.
SLOW = 300_000
# Error of a step, of the motion, above which a contact that closes in it may put a run on another
# branch of solutions without any other sign; error control with this tolerance keeps to it.
COARSEST_IN_CONTACT = 0.1


class RunWarning(NamedTuple):
    """A warning about a run: the field of the run's record that holds the time from which it
    applies [s] (NaN: it does not), its code (see `message_templates.Message`), and its text, into
    which that time is filled in."""

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
        "false state since t = {.4g} s: numerical artefact, a journal jumps between opposite "
        "walls of its clearance every one or two steps; do not trust this run: take the preset "
        f"robust, or {FINER}",
    ),
    RunWarning(
        "overdamped_at",
        "overdamped",
        "overdamped since t = {.4g} s: while a journal rubs the integrator dissipates more energy "
        "than the machine's own dampers, and may hide an instability; do not trust this run: take "
        f"the preset controlled, or {FINER}",
    ),
    RunWarning(
        "slow_at",
        "slow",
        f"slow since t = {{.4g}} s: a cycle of the motion takes more than {SLOW:,} iterations; "
        f"{_FASTER}",
    ),
    RunWarning(
        "coarse_at",
        "too-coarse",
        "too coarse since t = {.4g} s: at solver.h_min, the shortest step allowed, the tolerance "
        "is not met; lower solver.h_min, or raise solver.tolerance",
    ),
    RunWarning(
        "blind_at",
        "too-coarse-in-contact",
        "too coarse in contact since t = {.4g} s: a contact closed in a step whose local error is "
        "above a tenth of the motion, and the run may have jumped to another branch of solutions; "
        "take a smaller solver.h, or the preset controlled with a solver.tolerance of at most "
        f"{COARSEST_IN_CONTACT}, and compare them with --verify",
    ),
)
UNFINISHED = (
    "stopped after {d} iterations (solver.max_iterations); go on in shorter communication steps, "
    f"allow more of them, or {_FASTER}"
)
