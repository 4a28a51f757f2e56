"""Step-length control: the numbers of the modes, and the switch between them."""

import math
from typing import NamedTuple

from ..kernels.jit import jit
from .adaptive_control import error_indicator, next_step, shorter_step
from .error_control import next_length, next_stage_length, repeated_length, whirl_error

FIXED, ADAPTIVE, CONTROLLED, REALTIME = 1, 2, 3, 4


class Control(NamedTuple):
    """Settings of the step-length control.

    mode: FIXED, ADAPTIVE (`adaptive_control`), CONTROLLED (`error_control`) or REALTIME, as FIXED
    but with at most newton_limit iterations a step, 0 for no limit; h_min, h_max [s]; eps_min,
    eps_max: limits of the relative error [1]; indicator: ZIENKIEWICZ_XIE or LI_ZENG_WIBERG, with
    beta_error in the place of beta; norm: INCREMENT_NORM, |q1 - q0|, or MIXED_NORM, atol + rtol
    |q1|, with atol [m] and rtol [1]; tolerance [1]; error_constant: of the scheme's local error,
    relative to h^2 (a1 - a0), in stages relative to h^2 times the deviation of the last stage's
    acceleration from its extrapolation [1]; is_fitted: whether the scheme is fitted to the motion
    (`fitting`); stages: of Radau IIA, 0 for generalized-alpha; h_in_contact, h_in_the_open: longest
    step of CONTROLLED while a journal touches, and while none does [s]; overdamping: limit of the
    energy that the integrator may dissipate in a rub, relative to that of the dampers [1].
    """

    mode: int
    h_min: float
    h_max: float
    eps_min: float
    eps_max: float
    indicator: int
    beta_error: float
    norm: int
    atol: float
    rtol: float
    tolerance: float
    error_constant: float
    is_fitted: bool
    stages: int
    newton_limit: int
    h_in_contact: float = math.inf
    h_in_the_open: float = math.inf
    overdamping: float = 1.0


@jit
def keeps_tolerance(mode):
    """Return whether a mode keeps the local error of every step within a tolerance."""
    return mode == CONTROLLED


@jit
def varies(mode):
    """Return whether the step length varies in a mode."""
    return mode == ADAPTIVE or keeps_tolerance(mode)


@jit
def step_error(structure, control, local, h, is_first, old, new):
    """Return the error of a step in the measure of the mode [1]; the step is repeated if it exceeds
    control.eps_max. local: its `local_error` [1]."""
    if control.mode == ADAPTIVE:
        return error_indicator(control, h, is_first, old, new)
    if keeps_tolerance(control.mode):
        return max(local, whirl_error(structure, control, h, new))
    return 0.0


@jit
def retry_step(structure, control, h, error, is_solved, old, new):
    """Return the length with which a step is repeated [s]; is_solved: the step was solved, but its
    error was too large."""
    if not is_solved:
        shorter = 0.5 * h
    elif control.mode == CONTROLLED:
        shorter = repeated_length(structure, control, h, error, old, new)
    else:
        shorter = shorter_step(control, h, error)
    return max(control.h_min, shorter)


@jit
def propose_step(control, desired, h, error, error_before, was_rejected):
    """Return the proposed length of the next step [s], after one of length h that a communication
    point may have cut shorter than desired."""
    if control.mode == ADAPTIVE:
        return next_step(control, desired, h, error)
    if control.mode == CONTROLLED:
        longest = h if was_rejected else control.h_max
        if control.stages > 0:
            proposed = next_stage_length(desired, h, error, error_before)
        else:
            proposed = next_length(desired, h, error, error_before)
        return max(control.h_min, min(longest, proposed))
    return desired
