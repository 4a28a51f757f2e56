"""Where a journal rests on tilting pads: the least of a potential.

A pad that tilts bears along its pivot alone, the more the closer the journal is to the pivot. So a
journal at rest has a convex potential, the sum of one for each pad, and rests where that and its
load's is least. There the force need not be smooth: a pad that begins to bear does so with the root
of the approach (a central pivot), or at once (an offset one), and Newton's method goes to and fro
between its two sides. Cuts through the centre of gravity do not: the force at a displacement says
on which side of it the least is (Levin 1965, Newman 1965), whatever the force is there.
"""

from collections.abc import Callable

import numpy as np

_SPRING = 1e-7  # of load and clearance: takes the journal to the middle of where it is free
_SIZES = (2.0, 8.0, 32.0, 128.0)  # of the square in which the rest is looked for, in clearances
_CUTS, _SMALL = 300, 1e-11  # of the clearance
_INSIDE = 0.99


def rest_in_potential(
    force: Callable[[complex], complex], load: complex, clearance: float
) -> complex | None:
    """Return the displacement [m] at which a load [N] and the force of a convex potential balance,
    the one closest to the middle if there are many; None if there is none in reach."""
    spring = _SPRING * abs(load) / clearance
    for size in _SIZES:
        corners = size * clearance * np.array([-1 - 1j, 1 - 1j, 1 + 1j, -1 + 1j])
        d = 0j
        for _ in range(_CUTS):
            d = _centre(corners)
            corners = _cut(corners, d, force(d) + load - spring * d)
            if len(corners) < 3 or np.abs(corners - d).max() <= _SMALL * clearance:
                break
        if max(abs(d.real), abs(d.imag)) < _INSIDE * size * clearance:
            return d
    return None


def _centre(corners: np.ndarray) -> complex:
    """Return the centre of gravity of a convex polygon."""
    sides = corners[1:] - corners[0]
    areas = (sides[:-1].conjugate() * sides[1:]).imag
    if areas.sum() <= 0.0:  # as thin as rounding
        return complex(corners.mean())
    return complex(corners[0] + (areas * (sides[:-1] + sides[1:])).sum() / (3.0 * areas.sum()))


def _cut(corners: np.ndarray, at: complex, ahead: complex) -> np.ndarray:
    """Return what of a convex polygon lies ahead of a point in a direction."""
    height = ((corners - at) * np.conj(ahead)).real
    kept: list[complex] = []
    for z, h, before, low in zip(
        corners, height, np.roll(corners, 1), np.roll(height, 1), strict=True
    ):
        if h * low < 0.0:
            kept.append(before + (z - before) * low / (low - h))
        if h >= 0.0:
            kept.append(z)
    return np.array(kept)
