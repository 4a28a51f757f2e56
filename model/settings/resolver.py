"""Resolve settings: from a preset and changes to integrator and step control, or to the code of a
message.

A setting is a number, or for a choice the index among its names; NaN leaves it to the preset.
"""

import math

import numpy as np

from ..kernels.jit import jit
from ..quantities import places
from ..schemes.family import alphas, second_order
from ..schemes.radau import ERROR_CONSTANT, STAGES
from ..stability.resolution import is_stable
from ..time_loop.control import ADAPTIVE, CONTROLLED, REALTIME, keeps_tolerance, varies
from . import settings_messages
from .table import (
    BY_NAME,
    DEFAULTS,
    IN_STAGES,
    INDICATORS,
    METHODS,
    MODES,
    NAMES,
    NORMS,
    PRESETS,
    SETTINGS,
    SHAPES,
    Choice,
    is_idle,
)

COUNT = len(NAMES)
_AT = places(NAMES, 1)  # of `given`, whose first is the preset
_SHAPES = len(SHAPES)
_NEWMARK, _HHT, _WBZ, _CHUNG_HULBERT, _RADAU = (
    list(METHODS).index(name) for name in ("newmark", "hht", "wbz", "chung-hulbert", IN_STAGES)
)
_STABLE = 1e-12  # rounding in a stability condition


def encoded(name: str, value: object) -> float:
    """Return the number that stands for a setting's value. Raises `ValueError` for an invalid
    one."""
    return BY_NAME[name].encoded(value)


_PRESETS = np.array(
    [[encoded(name, (DEFAULTS | of)[name]) for name in NAMES] for of in PRESETS.values()]
)
_TAKES = np.array([[name in taken for name in SHAPES] for taken in METHODS.values()])
_MODES = np.array(list(MODES.values()))
_INDICATORS = np.array([code for code, _ in INDICATORS.values()])
_CORRECTED = np.array([is_corrected for _, is_corrected in INDICATORS.values()])
_NORMS = np.array(list(NORMS.values()))
_IS_NUMBER = np.array([not isinstance(setting, Choice) for setting in SETTINGS])
# lower limit, whether it is excluded, upper limit, whether it is excluded
_RANGES = np.array(
    [
        (0.0, 0.0, 0.0, 0.0)
        if isinstance(of, Choice)
        else (of.rule.least, of.rule.is_strict, of.rule.most, of.rule.is_below)
        for of in SETTINGS
    ]
)
_IS_IDLE = np.array(
    [[[is_idle(name, mode, norm) for name in NAMES] for norm in NORMS] for mode in MODES]
)


@jit
def resolve(given, numbers, arguments):
    """Fill in the record of a run's method from the settings `given`, shape (1 + COUNT,), the
    preset's place first; `given` then holds the resolved values.

    Returns the code of a sentence, with its numbers in `arguments`, or `GOOD`.
    """
    preset = int(given[0])
    base = int(_PRESETS[preset, _AT.method - 1])
    method = base if math.isnan(given[_AT.method]) else int(given[_AT.method])
    for i in range(_SHAPES):
        is_given = not math.isnan(given[_AT.alpha_f + i])
        if is_given and not _TAKES[method, i]:
            arguments[0], arguments[1], arguments[2] = i, given[_AT.alpha_f + i], method
            return settings_messages.NOT_TAKEN
        if _TAKES[method, i] and method != base and not is_given:
            arguments[0], arguments[1] = method, i
            return settings_messages.NEEDED
    is_first_given = not math.isnan(given[_AT.h])
    for slot in range(COUNT):
        if math.isnan(given[1 + slot]):
            given[1 + slot] = _PRESETS[preset, slot]
        shape = 1 + slot - _AT.alpha_f
        is_used = not 0 <= shape < _SHAPES or _TAKES[method, shape]
        if _IS_NUMBER[slot] and is_used and not _is_in_range(given[1 + slot], slot):
            arguments[0] = given[1 + slot]
            return settings_messages.OUT_OF_RANGE + slot
    mode = int(_MODES[int(given[_AT.mode])])
    h, h_min, h_max = given[_AT.h], given[_AT.h_min], given[_AT.h_max]
    if varies(mode) and h_min > h_max:
        arguments[0], arguments[1] = h_min, h_max
        return settings_messages.STEPS_CROSSED
    if varies(mode) and not is_first_given:
        given[_AT.h] = min(max(h, h_min), h_max)
    elif varies(mode) and not h_min <= h <= h_max:
        arguments[0], arguments[1], arguments[2] = h, h_min, h_max
        return settings_messages.STEP_OUTSIDE
    if mode == ADAPTIVE and not given[_AT.eps_min] < given[_AT.eps_max]:
        arguments[0], arguments[1] = given[_AT.eps_min], given[_AT.eps_max]
        return settings_messages.LIMITS_CROSSED
    if method == _RADAU and mode != CONTROLLED:
        arguments[0], arguments[1] = method, given[_AT.mode]
        return settings_messages.UNCONTROLLED
    alpha_f, alpha_m = _alphas(given, method)
    if alpha_f - alpha_m <= -1.0:
        arguments[0] = alpha_f - alpha_m
        return settings_messages.BAD_DIFFERENCE
    _fill(numbers, given, mode, second_order(alpha_f, alpha_m))
    if method == _RADAU:
        numbers.is_fitted, numbers.stages = 0, STAGES
        numbers.error_constant = ERROR_CONSTANT
    return settings_messages.GOOD


@jit
def _is_in_range(value, slot):
    low, high = _RANGES[slot, 0], _RANGES[slot, 2]
    is_above = value > low or (value == low and _RANGES[slot, 1] == 0.0)
    return is_above and (value < high or (value == high and _RANGES[slot, 3] == 0.0))


@jit
def _alphas(given, method):
    """Return alpha_f and alpha_m of a method of the generalized-alpha family."""
    if method == _CHUNG_HULBERT:
        return alphas(given[_AT.rho])
    alpha_f = 0.0 if method in (_WBZ, _NEWMARK, _RADAU) else given[_AT.alpha_f]
    alpha_m = 0.0 if method in (_HHT, _NEWMARK, _RADAU) else given[_AT.alpha_m]
    return alpha_f, alpha_m


@jit
def _fill(numbers, given, mode, scheme):
    shift = (scheme.alpha_m - scheme.alpha_f) / 2
    indicator = int(given[_AT.indicator])
    numbers.alpha_m, numbers.alpha_f = scheme.alpha_m, scheme.alpha_f
    numbers.beta, numbers.gamma = scheme.beta, scheme.gamma
    numbers.mode = mode
    numbers.h_min, numbers.h_max = given[_AT.h_min], given[_AT.h_max]
    numbers.eps_min = given[_AT.eps_min]
    numbers.eps_max = 1.0 if keeps_tolerance(mode) else given[_AT.eps_max]
    numbers.indicator = _INDICATORS[indicator]
    numbers.beta_error = scheme.beta + (shift if _CORRECTED[indicator] else 0.0)
    numbers.norm = _NORMS[int(given[_AT.norm])]
    numbers.atol, numbers.rtol = given[_AT.atol], given[_AT.rtol]
    numbers.tolerance = given[_AT.tolerance]
    numbers.error_constant = scheme.beta + shift - 1 / 6
    numbers.is_fitted = int(given[_AT.fitted])
    numbers.stages = 0
    numbers.newton_limit = int(given[_AT.newton_limit]) if mode == REALTIME else 0


@jit
def begin(given, r):
    """Write the initial step length and the limit of iterations into the record of a run."""
    r.h = given[_AT.h]
    r.max_iterations = given[_AT.max_iterations]


@jit
def radius_at_infinity(numbers):
    """Return the spectral radius at infinity of a method [1]."""
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


@jit
def warning(given, own, numbers, arguments, slot):
    """Return the code of a warning about a setting given by the user, or `GOOD`; slot: its index,
    or `COUNT` for the warning about the method.

    own: the settings as given, before `resolve` filled in the others.
    """
    method = int(given[_AT.method])
    if slot == COUNT:
        if is_stable(numbers):
            return settings_messages.GOOD
        arguments[0], arguments[1], arguments[2] = method, numbers.alpha_f, numbers.alpha_m
        arguments[3] = radius_at_infinity(numbers)
        return settings_messages.UNSTABLE
    mode, norm = int(given[_AT.mode]), int(given[_AT.norm])
    if slot == _AT.fitted - 1 and method == _RADAU and own[1 + slot] > 0.0:
        arguments[0], arguments[1] = given[1 + slot], method
        return settings_messages.FITTED_IN_STAGES
    if math.isnan(own[1 + slot]) or not _IS_IDLE[mode, norm, slot]:
        return settings_messages.GOOD
    arguments[0], arguments[1] = given[1 + slot], mode
    arguments[2] = 1.0 + norm if _MODES[mode] == ADAPTIVE else 0.0
    return settings_messages.IDLE + slot
