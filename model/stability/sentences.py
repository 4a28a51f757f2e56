"""What is said of a growing whirl: before a run that would hide it, and after one that it ended."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..schemes.spectral import Method
from .resolution import resolving_step, seen_growth
from .whirls import Whirl

# Less than this share of a growth left by the integrator is called hidden; what a step that
# resolves it must leave.
HIDDEN, RESOLVED = 0.5, 0.9
# Of a root: an imaginary part below it is what a processor rounds to.
_ROUNDING = 1e-9


def longest_step(method: Method, whirls: Sequence[Whirl], tolerance: float = 1.0) -> float:
    """Longest step that leaves every growth its share `RESOLVED` [s], and more of it where the
    tolerance is small [1]; infinite without whirls."""
    share = max(RESOLVED, 1.0 - math.sqrt(tolerance))
    steps = (resolving_step(method, whirl.root, share) for whirl in whirls)
    return min(steps, default=math.inf)


def hidden_whirls(
    method: Method, h: float, whirls: Sequence[Whirl], contacts: Sequence[str]
) -> str | None:
    """A sentence about the growing whirls that steps of length h [s] hide, None where there is
    none; contacts: names of the interfaces."""
    hidden = [w for w in whirls if seen_growth(method, h, w.root) < HIDDEN * w.root.real]
    if not hidden:
        return None
    worst = hidden[0]
    seen = seen_growth(method, h, worst.root)
    does = f"damps it by {-seen:.3g} 1/s" if seen < 0 else f"leaves {seen:.3g} 1/s of it"
    return (
        f"solver steps of {h:.3g} s hide an instability: {described(worst, contacts)}, and the "
        f"integrator, at omega h = {abs(worst.root) * h:.2g}, {does}; take steps of at most "
        f"{rounded_down(longest_step(method, hidden)):g} s, or the preset controlled"
    )


def grows_at_rest(root: complex) -> str:
    """A sentence about a growth at rest, its root lambda [1/s] with an imaginary part >= 0."""
    if root.imag > _ROUNDING * abs(root):
        decrement = -2 * math.pi * root.real / root.imag
        mode = (
            f"a mode of {root.imag / (2 * math.pi):.4g} Hz ({root.imag:.4g} rad/s) grows, its "
            f"logarithmic decrement being {decrement:.3g}"
        )
    else:
        mode = f"it moves away from its equilibrium by {root.real:.3g} 1/s, without oscillating"
    return (
        f"unstable at rest: with all contacts open {mode}; look at the damping and the stiffness "
        "of its bearings"
    )


def described(whirl: Whirl, contacts: Sequence[str]) -> str:
    """The whirl in words."""
    where = "all contacts open"
    if whirl.closed:
        names = " and ".join(contacts[j] for j in whirl.closed)
        where = f"{names} in contact and slipping"
    way = "backward" if whirl.is_backward else "forward"
    return (
        f"with {where} a {way} whirl of {whirl.hz:.4g} Hz ({whirl.root.imag:.4g} rad/s) grows by "
        f"{whirl.root.real:.3g} 1/s at {whirl.speed:.4g} rad/s"
    )


def rounded_down(x: float) -> float:
    """x > 0 with two digits, no larger than it was."""
    unit = 10.0 ** (math.floor(math.log10(x)) - 1)
    return math.floor(x / unit) * unit


def nearest(whirls: Sequence[Whirl], rate: float, speed: float) -> Whirl:
    """Of some whirls that which is most like a motion that turns at `rate` [rad/s] while the
    machine does at `speed` [rad/s]: in its sense, if there is one, and nearest in frequency."""
    is_backward = (rate < 0) == (speed >= 0)
    alike = [w for w in whirls if w.is_backward == is_backward] or list(whirls)
    return min(alike, key=lambda w: abs(math.log(w.root.imag / max(abs(rate), 1e-9))))
