"""What makes a run doubtful once it has begun, each from an instant that the run remembers."""

from __future__ import annotations

from typing import NamedTuple

from .march.watch import MOST, SLOW


class Doubt(NamedTuple):
    """A field of the run's record, the time from which the doubt holds [s] or NaN, and the words in
    which that time stands."""

    since: str
    words: str


_FASTER = (
    "take a larger solver.tolerance or the preset robust, softer contacts (k) or less friction (mu)"
)
DOUBTS = (
    Doubt(
        "trapped_at",
        "false state since t = {:.4g} s: a journal jumps from wall to wall of its clearance every "
        "step or two, which is the integrator's doing; do not trust this run: take the preset "
        "robust, or a smaller solver.h",
    ),
    Doubt(
        "overdamped_at",
        "overdamped since t = {:.4g} s: while a journal rubs the integrator takes energy that the "
        "machine's own dampers would not, and may hide an instability; do not trust this run: take "
        "the preset controlled, or a smaller solver.h",
    ),
    Doubt(
        "slow_at",
        f"slow since t = {{:.4g}} s: a cycle of the motion takes more than {SLOW:,} "
        f"iterations, and at {MOST:,} the run is given up; {_FASTER}",
    ),
    Doubt(
        "coarse_at",
        "too coarse since t = {:.4g} s: steps of solver.h_min, below which none is made, miss the "
        "tolerance; take a smaller solver.h_min, or a larger solver.tolerance",
    ),
)
_NO_REST = "no static equilibrium under gravity and the loads at the start"
# By the places that `march.equilibrium.why_not` gives, with its numbers.
NO_REST = (
    "no static equilibrium: the rotor is held at {:.0f} of its nodes and would tilt under gravity; "
    "at least 2 bearings or supports are needed",
    f"{_NO_REST}: it would lie beyond {{:.3g}} m, a tenth of the shaft's length; clearances and "
    "loads must be smaller, or springs stiffer",
    f"{_NO_REST} was found",
    f"{_NO_REST} was found: beside the stiffness of the shaft's elements, {{:.2g}} N/m, rounding "
    "hides what holds it, {:.2g} N/m; a smaller young is as rigid",
    f"{_NO_REST} that is stable was found: a journal lies on a hump of its worn bore; change "
    "wear_angle, or tell a [start]",
    "[start]: node {:.0f} lies {:.3g} m from the axis; must be within {:.3g} m, a tenth of the "
    "shaft's length",
)
STALLED = f"a cycle of the motion takes more than {MOST:,} iterations; {_FASTER}"
