"""`settings.choose` in compiled code: the solver's parameters of an FMU -> integrator and control.

A parameter is a number, or of a choice its place among the names; NaN leaves it to the preset.
"""

from __future__ import annotations

import math

import numpy as np

from ..model.kernels.compiled import compiled
from ..model.march.control import ADAPTIVE, CONTROLLED, FIXED
from ..model.schemes.family import Scheme
from ..model.settings import INDICATORS, METHODS, MODES, NORMS, PRESETS, Settings
from ..model.stability.resolution import is_stable
from . import sentences as say

CHOICES = {
    "method": tuple(METHODS),
    "mode": tuple(MODES),
    "fitted": ("no", "yes"),
    "indicator": tuple(INDICATORS),
    "norm": tuple(NORMS),
}
# The settings in the order in which they are given, behind the preset's place among the presets.
SLOTS = (*("method", *say.SHAPES, "mode", "fitted", *say.POSITIVE, "indicator", "norm"),)
_METHOD, _MODE, _FITTED, _INDICATOR, _NORM = (SLOTS.index(name) for name in CHOICES)
_SHAPE, _POSITIVE = SLOTS.index(say.SHAPES[0]), SLOTS.index(say.POSITIVE[0])
_H, _H_MIN, _H_MAX, _EPS_MIN, _EPS_MAX, _ATOL, _RTOL, _TOLERANCE = range(
    _POSITIVE, _POSITIVE + len(say.POSITIVE)
)
_SHAPES, _POSITIVES, _SLOTS = len(say.SHAPES), len(say.POSITIVE), len(SLOTS)
_IS_IDLE = np.array([text != "" for text in say.SENTENCES[say.IDLE : say.NO_REST_AT]])
_IDLE_AT = np.full(_SLOTS, -1)
for _place, _name in enumerate((*say.IDLE_NUMBERS, "indicator")):
    _IDLE_AT[SLOTS.index(_name)] = _place
_IDLE_AT[_NORM] = len(say.IDLE_NUMBERS) + len(INDICATORS)
_STABLE = 1e-12  # what is rounding in a condition of stability


def _preset(settings: Settings) -> list[float]:
    given = {name: getattr(settings, name) for name in SLOTS}
    for name, choices in CHOICES.items():
        value = given[name]
        given[name] = int(value) if isinstance(value, bool) else choices.index(value)
    return [float(given[name]) for name in SLOTS]


_PRESETS = np.array([_preset(settings) for settings in PRESETS.values()])
_TAKES = np.array([[name in taken for name in say.SHAPES] for taken in METHODS.values()])
_MODES = np.array(list(MODES.values()))
_INDICATORS = np.array([code for code, _ in INDICATORS.values()])
_CORRECTED = np.array([is_corrected for _, is_corrected in INDICATORS.values()])
_NORMS = np.array(list(NORMS.values()))
_NEWMARK, _HHT, _WBZ, _GENERALIZED, _CHUNG_HULBERT = (
    CHOICES["method"].index(name)
    for name in ("newmark", "hht", "wbz", "generalized-alpha", "chung-hulbert")
)


@compiled
def settle(run, given, told):
    """Fill in a run's method and its first step from the parameters `given`, the preset first.

    Returns the code of a sentence, with its numbers in `told`. `given` then holds what was chosen.
    """
    preset = int(given[0])
    base = int(_PRESETS[preset, _METHOD])
    method = base if math.isnan(given[1 + _METHOD]) else int(given[1 + _METHOD])
    for i in range(_SHAPES):
        is_given = not math.isnan(given[1 + _SHAPE + i])
        if is_given and not _TAKES[method, i]:
            told[0] = given[1 + _SHAPE + i]
            return say.NOT_TAKEN + method * _SHAPES + i
        if _TAKES[method, i] and method != base and not is_given:
            return say.NEEDED + method * _SHAPES + i
    for i in range(_SLOTS):
        if math.isnan(given[1 + i]):
            given[1 + i] = _PRESETS[preset, i]
    return _check_control(run, given, told, int(_MODES[int(given[1 + _MODE])]), method)


@compiled
def _check_control(run, given, told, mode, method):
    for i in range(_POSITIVES):
        value = given[1 + _POSITIVE + i]
        if not (0.0 < value < math.inf) or (i == _POSITIVES - 1 and value > 1.0):
            told[0] = value
            return say.NOT_POSITIVE + i
    h, h_min, h_max = given[1 + _H], given[1 + _H_MIN], given[1 + _H_MAX]
    eps_min, eps_max = given[1 + _EPS_MIN], given[1 + _EPS_MAX]
    if mode != FIXED and not (h_min <= h <= h_max):
        told[0], told[1], told[2] = h, h_min, h_max
        return say.STEP_OUTSIDE
    if mode == ADAPTIVE and not eps_min < eps_max:
        told[0], told[1] = eps_min, eps_max
        return say.LIMITS_CROSSED
    code, scheme = _scheme(given, told, method)
    if code == say.GOOD:
        _fill(run, given, mode, scheme)
    return code


@compiled
def _scheme(given, told, method):
    """The member of the family, as the constructors in `schemes.family` make it."""
    if method == _NEWMARK:
        return say.GOOD, Scheme(0.0, 0.0, 0.25, 0.5)
    alpha_f, alpha_m, rho = given[1 + _SHAPE], given[2 + _SHAPE], given[3 + _SHAPE]
    none = Scheme(0.0, 0.0, 0.0, 0.0)
    if method == _CHUNG_HULBERT:
        if not 0.0 <= rho <= 1.0:
            told[0] = rho
            return say.BAD_RHO, none
        alpha_f = rho / (rho + 1)
        alpha_m = (2 * rho - 1) / (rho + 1)
    elif method == _HHT:
        alpha_m = 0.0
    elif method == _WBZ:
        alpha_f = 0.0
    if not -1.0 <= alpha_f < 1.0:
        told[0] = alpha_f
        return say.BAD_ALPHA_F, none
    if not -1.0 <= alpha_m < 1.0:
        told[0] = alpha_m
        return say.BAD_ALPHA_M, none
    difference = alpha_f - alpha_m
    if difference <= -1.0:
        told[0] = difference
        return say.BAD_DIFFERENCE, none
    root = 1.0 + difference
    return say.GOOD, Scheme(alpha_m, alpha_f, root * root / 4, 0.5 + difference)


@compiled
def _fill(run, given, mode, scheme):
    """See `Settings.control`."""
    numbers = run.method.numbers[0]
    shift = (scheme.alpha_m - scheme.alpha_f) / 2
    indicator = int(given[1 + _INDICATOR])
    numbers.alpha_m, numbers.alpha_f = scheme.alpha_m, scheme.alpha_f
    numbers.beta, numbers.gamma = scheme.beta, scheme.gamma
    numbers.mode = mode
    numbers.h_min, numbers.h_max = given[1 + _H_MIN], given[1 + _H_MAX]
    numbers.eps_min = given[1 + _EPS_MIN]
    numbers.eps_max = 1.0 if mode == CONTROLLED else given[1 + _EPS_MAX]
    numbers.indicator = _INDICATORS[indicator]
    numbers.beta_error = scheme.beta + (shift if _CORRECTED[indicator] else 0.0)
    numbers.norm = _NORMS[int(given[1 + _NORM])]
    numbers.atol, numbers.rtol = given[1 + _ATOL], given[1 + _RTOL]
    numbers.tolerance = given[1 + _TOLERANCE]
    numbers.error_constant = scheme.beta + shift - 1 / 6
    numbers.is_fitted = int(given[1 + _FITTED])
    run.memory.record[0].h = given[1 + _H]


@compiled
def radius_at_infinity(numbers):
    """`Scheme.rho_infinity` of a method's record [1]."""
    beta, gamma, af = numbers.beta, numbers.gamma, numbers.alpha_f
    discriminant = (0.5 + gamma) ** 2 - 4 * beta
    if abs(discriminant) < _STABLE:
        discriminant = 0.0
    middle = 2 * beta - 0.5 - gamma
    if discriminant < 0.0:
        pair = math.sqrt(middle * middle - discriminant) / (2 * beta)
    else:
        root = math.sqrt(discriminant)
        pair = max(abs(middle - root), abs(middle + root)) / (2 * beta)
    return max(pair, abs(af / (1 - af)))


@compiled
def doubt(run, given, own, told, slot):
    """Code of a warning about one of the `own` parameters among `given`, as they were before
    `settle`, or `GOOD`; behind the last of them about the method."""
    if slot == _SLOTS:
        numbers = run.method.numbers[0]
        if is_stable(numbers):
            return say.GOOD
        told[0], told[1] = numbers.alpha_f, numbers.alpha_m
        told[2] = radius_at_infinity(numbers)
        return say.UNSTABLE + int(given[1 + _METHOD])
    if math.isnan(own[1 + slot]) or _IDLE_AT[slot] < 0:
        return say.GOOD
    context = int(given[1 + _MODE]) * len(_NORMS) + int(given[1 + _NORM])
    at = context * say.IDLE_ROW + _IDLE_AT[slot]
    told[0] = given[1 + slot]
    if slot in (_INDICATOR, _NORM):
        at += int(given[1 + slot])
    return say.IDLE + at if _IS_IDLE[at] else say.GOOD
