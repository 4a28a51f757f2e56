"""The effect of an integrator on a growing oscillation: the step length up to which it resolves the
growth.

A step of length h multiplies an oscillation of root lambda by an eigenvalue of its amplification
matrix, at omega h = |lambda| h and a damping ratio xi = -Re lambda / |lambda| < 0. Numerical
damping, which prevents the false state, hides a growth that is slower than it.
"""

import math

from ..kernels.functions import logarithm, modulus
from ..kernels.jit import jit, jit_not_inlined
from ..schemes.radau import amplification

COARSEST, _FINE = 10.0, 1e-3  # omega h [rad] between which the step is looked for
_HALVINGS = 20
_STABLE = 1e-12  # rounding in a stability condition


@jit
def is_stable(scheme):
    """Return whether a scheme is unconditionally stable; scheme: anything with a scheme's
    parameters."""
    m, f = 1 - 2 * scheme.alpha_m, 1 - 2 * scheme.alpha_f
    g, b = 2 * scheme.gamma - 1, 4 * scheme.beta - 2 * scheme.gamma
    least = min(m, f * b, b + f * g, f + g, f + g - m, g * (b + f * f + f * g))
    return least >= -_STABLE


@jit
def _growth_of(x, y):
    """Return ln |1 + x + i y|."""
    d = 2.0 * x + x * x + y * y
    if abs(d) > 0.01:
        return 0.5 * logarithm(1.0 + d)
    s = d / (2.0 + d)
    z = s * s
    return s * (1.0 + z * (1.0 / 3.0 + z * (0.2 + z / 7.0)))


@jit
def _real_root(c0, c1, c2, c3):
    """Return a real root of c3 u^3 + c2 u^2 + c1 u + c0, by safeguarded Newton iteration."""
    if c3 < 0.0:
        c0, c1, c2, c3 = -c0, -c1, -c2, -c3
    bound = 1.0 + max(abs(c0), abs(c1), abs(c2)) / c3
    low, high = -bound, bound
    u = -c2 / c3 if abs(c2) < bound * c3 else 0.0
    for _ in range(200):
        value = ((c3 * u + c2) * u + c1) * u + c0
        slope = (3.0 * c3 * u + 2.0 * c2) * u + c1
        if value > 0.0:
            high = u
        else:
            low = u
        following = u - value / slope if slope != 0.0 else low
        if not low < following < high:
            following = 0.5 * (low + high)
        if abs(following - u) <= 1e-16 * abs(u):
            break
        u = following
    return u


@jit_not_inlined
def seen_growth(scheme, h, root):
    """Return the rate at which the oscillation grows in steps of length h [1/s], negative if it
    decays.

    scheme: anything with a scheme's parameters. The characteristic polynomial of the amplification
    matrix is written in (lambda - 1) / w, whose roots stay apart however small w is.
    """
    size = modulus(root)
    w, rate = size * h, -2.0 * root.real / size  # 2 xi
    af, beta, gamma = 1.0 - scheme.alpha_f, scheme.beta, scheme.gamma
    c1 = rate + w * (0.5 + gamma + af)
    c2 = 1.0 + w * (rate * (gamma + af) + w * (beta + (0.5 + gamma) * af))
    c3 = w * (1.0 - scheme.alpha_m + w * af * (rate * gamma + w * beta))
    u = _real_root(1.0, c1, c2, c3)
    # the quadratic factor that remains of the cubic: u^2 + b u + c
    b = c2 / c3 + u
    c = c1 / c3 + u * b
    half, square = -0.5 * b, 0.25 * b * b - c
    part = math.sqrt(abs(square))
    growth = _growth_of(w * u, 0.0)
    if square < 0.0:
        return max(growth, _growth_of(w * half, w * part)) / h
    return max(growth, _growth_of(w * (half - part), 0.0), _growth_of(w * (half + part), 0.0)) / h


@jit_not_inlined
def resolving_step(scheme, root, share):
    """Return the longest step [s] in which the oscillation grows at least at this share of its rate
    [1]."""
    omega = modulus(root)
    short, long = _FINE / omega, COARSEST / omega
    for _ in range(_HALVINGS):
        middle = math.sqrt(short * long)
        if seen_growth(scheme, middle, root) >= share * root.real:
            short = middle
        else:
            long = middle
    return short


@jit_not_inlined
def resolving_step_in_stages(root, share):
    """Return the same [s] for steps of Radau IIA."""
    omega = modulus(root)
    short, long = _FINE / omega, COARSEST / omega
    for _ in range(_HALVINGS):
        middle = math.sqrt(short * long)
        if logarithm(amplification(root * middle)) >= share * root.real * middle:
            short = middle
        else:
            long = middle
    return short
