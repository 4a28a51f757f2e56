"""What is said of a growing whirl: before a run that would hide it, and after one that it ended."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..kernels.compiled import plain
from ..schemes.family import Scheme
from . import resolution, whirls
from .whirls import HIDDEN, RESOLVED, Whirl

# Of a root: an imaginary part below it is what a processor rounds to.
ROUNDING = 1e-9
TWO_DIGITS = 10.0

OPEN, SLIPPING, AND = "all contacts open", " in contact and slipping", " and "
WAYS = ("forward", "backward")
WHIRL = (
    "with {where} a {way} whirl of {hz:.4g} Hz ({omega:.4g} rad/s) grows by {growth:.3g} 1/s at "
    "{speed:.4g} rad/s"
)
# What numerical damping does to a growth: leaves some of it, or more than takes it away.
DOES = ("leaves {seen:.3g} 1/s of it", "damps it by {seen:.3g} 1/s")
HIDES = (
    f"solver steps of {{h:.3g}} s hide an instability: {WHIRL}, and the integrator, at omega h = "
    "{radians:.2g}, {does}; take steps of at most {longest:g} s, or the preset controlled"
)
UNSTABLE = f"unstable: {WHIRL}; the machine itself is past its threshold of stability"
OSCILLATES = (
    "a mode of {hz:.4g} Hz ({omega:.4g} rad/s) grows, its logarithmic decrement being "
    "{decrement:.3g}"
)
MOVES_AWAY = "it moves away from its equilibrium by {growth:.3g} 1/s, without oscillating"
AT_REST = (
    "unstable at rest: with all contacts open {how}; look at the damping and the stiffness of its "
    "bearings"
)
APART = (
    "the machine whirled itself apart (node {node:d} past {bound:.3g} m or not finite): "
    f"{WHIRL}, and it was seen to whirl {{seen}} at {{seen_hz:.4g}} Hz; that is the machine's own, "
    "no step length mends it: less friction or more damping does"
)


def longest_step(method: Scheme, whirls: Sequence[Whirl]) -> float:
    """Longest step that leaves every growth its share `RESOLVED` [s]; infinite without whirls."""
    resolving_step = plain(resolution.resolving_step)
    return min((resolving_step(method, w.root, RESOLVED) for w in whirls), default=math.inf)


def hidden_whirls(
    method: Scheme, h: float, found: Sequence[Whirl], contacts: Sequence[str]
) -> str | None:
    """A sentence about the growing whirls that steps of length h [s] hide, None where there is
    none; contacts: names of the interfaces."""
    growth = plain(resolution.seen_growth)
    hidden = [w for w in found if growth(method, h, w.root) < HIDDEN * w.root.real]
    if not hidden:
        return None
    worst = hidden[0]
    seen = growth(method, h, worst.root)
    return HIDES.format(
        h=h,
        **_told(worst, contacts),
        radians=abs(worst.root) * h,
        does=DOES[seen < 0].format(seen=abs(seen)),
        longest=plain(whirls.rounded_down)(longest_step(method, hidden), TWO_DIGITS),
    )


def grows_in_the_open(found: Sequence[Whirl], speed: float) -> str | None:
    """A sentence about the whirl that grows fastest at a speed [rad/s] with all contacts open, None
    where there is none."""
    whirl = next((w for w in found if not w.closed and w.speed == speed), None)
    return UNSTABLE.format(**_told(whirl, ())) if whirl else None


def grows_at_rest(root: complex) -> str:
    """A sentence about a growth at rest, its root lambda [1/s] with an imaginary part >= 0."""
    if root.imag > ROUNDING * abs(root):
        how = OSCILLATES.format(
            hz=root.imag / (2 * math.pi),
            omega=root.imag,
            decrement=-2 * math.pi * root.real / root.imag,
        )
    else:
        how = MOVES_AWAY.format(growth=root.real)
    return AT_REST.format(how=how)


def whirled_apart(
    node: int, bound: float, whirl: Whirl, contacts: Sequence[str], rate: float, speed: float
) -> str:
    """A sentence about a machine that a growing whirl took past a bound [m], turning at `rate`
    [rad/s] while the machine did at `speed` [rad/s]."""
    return APART.format(
        node=node,
        bound=bound,
        **_told(whirl, contacts),
        seen=WAYS[(rate < 0) == (speed >= 0)],
        seen_hz=abs(rate) / (2 * math.pi),
    )


def _told(whirl: Whirl, contacts: Sequence[str]) -> dict[str, str | float]:
    names = AND.join(contacts[j] for j in whirl.closed)
    return {
        "where": f"{names}{SLIPPING}" if whirl.closed else OPEN,
        "way": WAYS[whirl.is_backward],
        "hz": whirl.hz,
        "omega": whirl.root.imag,
        "growth": whirl.root.real,
        "speed": whirl.speed,
    }


def nearest(whirls: Sequence[Whirl], rate: float, speed: float) -> Whirl:
    """Of some whirls that which is most like a motion that turns at `rate` [rad/s] while the
    machine does at `speed` [rad/s]: in its sense, if there is one, and nearest in frequency."""
    is_backward = (rate < 0) == (speed >= 0)
    alike = [w for w in whirls if w.is_backward == is_backward] or list(whirls)
    return min(alike, key=lambda w: abs(math.log(w.root.imag / max(abs(rate), 1e-9))))
