"""What an integrator makes of a growing oscillation: at which step length it still sees it grow.

A step of length h multiplies an oscillation of root lambda by an eigenvalue of its amplification
matrix, at omega h = |lambda| h and a damping ratio xi = -Re lambda / |lambda| < 0. Numerical
damping, that serves against the false state, hides a growth that is slower than it.
"""

from __future__ import annotations

import math

from ..schemes.spectral import Method, spectral_radius

COARSEST, _FINE = 10.0, 1e-3  # omega h [rad] between which the step is looked for
_HALVINGS = 20


def seen_growth(method: Method, h: float, root: complex) -> float:
    """Rate at which the oscillation grows in steps of length h [1/s], negative where it decays."""
    return math.log(spectral_radius(method, abs(root) * h, -root.real / abs(root))) / h


def resolving_step(method: Method, root: complex, share: float) -> float:
    """Longest step [s] in which the oscillation grows by this share of its rate at least [1]."""
    omega = abs(root)
    short, long = _FINE / omega, COARSEST / omega
    for _ in range(_HALVINGS):
        middle = math.sqrt(short * long)
        if seen_growth(method, middle, root) >= share * root.real:
            short = middle
        else:
            long = middle
    return short
