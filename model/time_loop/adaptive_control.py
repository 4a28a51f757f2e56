"""Step-length control of paper A: local error indicators and limits (eqs 11 to 15)."""

import math

from ..kernels.functions import cube_root
from ..kernels.jit import jit

ZIENKIEWICZ_XIE, LI_ZENG_WIBERG = 1, 2
INCREMENT_NORM, MIXED_NORM = 1, 2
SAFETY = 0.9


@jit
def error_indicator(control, h, is_first, old, new):
    """Return the relative local error of the displacements after one step [1]; fills new.jerk.

    Zienkiewicz and Xie 1991 (paper A, eq. 13): (beta - 1/6) h^2 |a1 - a0|, 1/6 exactly.
    Li, Zeng and Wiberg 1993 (eqs 11, 12): h^3 / 12 |(6 beta - 1/2) j1 - (3/2 - 6 beta) j0| with
    j1 = 2 (a1 - a0) / h - j0, started with j0 = (a1 - a0) / h.
    """
    beta = control.beta_error
    total = 0.0
    size = 0.0
    for i in range(len(old.q)):
        change = new.a[i] - old.a[i]
        before = change * (1.0 / h) if is_first else old.jerk[i]
        after = change * (2.0 / h) - before
        new.jerk[i] = after
        if control.indicator == ZIENKIEWICZ_XIE:
            local = (beta - 1.0 / 6.0) * h * h * change
        else:
            local = h * h * h / 12.0 * ((6.0 * beta - 0.5) * after - (1.5 - 6.0 * beta) * before)
        total += local.real * local.real + local.imag * local.imag
        reference = new.q[i] - old.q[i] if control.norm == INCREMENT_NORM else new.q[i]
        size += reference.real * reference.real + reference.imag * reference.imag
    scale = math.sqrt(size)
    if control.norm == MIXED_NORM:
        scale = control.atol + control.rtol * scale
    if scale == 0.0:
        return 0.0
    return math.sqrt(total) / scale


@jit
def shorter_step(control, h, error):
    """Return the length with which a rejected step is repeated [s] (eq. 15, the cube root over the
    whole ratio).

    The factor 0.9 is needed because the error is relative to the increment, which is O(h) itself: a
    rejected step would otherwise creep towards eps_max and never be accepted.
    """
    return max(control.h_min, SAFETY * h * cube_root(control.eps_max / error))


@jit
def next_step(control, proposed, h, error):
    """Return the proposed length of the next step [s] (eq. 15) after a step of length h <=
    proposed: a step that a communication point cut short does not lower it."""
    if error >= control.eps_min:
        return proposed
    if error == 0.0:
        return control.h_max
    longer = h * cube_root(control.eps_min / error)
    return max(proposed, min(control.h_max, longer))
