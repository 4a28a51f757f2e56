"""Reynolds' equation of a film in both directions, by finite differences: what the
quasi-one-dimensional film of a journal bearing is measured against."""

import math
from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import spsolve

from ..film.bearing_film import PAD
from ..parts.journal_bearing import GUEMBEL, JournalBearing

_AROUND, _ALONG = 180, 12  # cells of a whole circle, and of half the length
_ITERATIONS = 60


def film_in_plane(
    part: JournalBearing,
    speed: float,
    d: complex,
    *,
    viscosity: float,
    tilts: Sequence[complex] | np.ndarray = (),
) -> complex:
    """Return the film's force on a journal that rests at d [m] at a speed [rad/s], with its rupture
    at grid points [N]; viscosity [Pa.s]; tilts: of pads that tilt, their imaginary part how far the
    pivot gives [m]."""
    force = 0j
    for i, row in enumerate(part.pad_rows()):
        at = np.array(row)
        tilt = 1j * complex(at[PAD.pivot_x], at[PAD.pivot_y]) * (tilts[i] if len(tilts) else 0.0)
        force += _pad(part, at, viscosity * speed, d + tilt)
    return force


def _pad(part: JournalBearing, row: np.ndarray, shear: float, d: complex) -> complex:
    """Return the force of a pad on the journal [N]; shear: viscosity times speed [Pa]."""
    first, last = row[PAD.first], row[PAD.last]
    is_whole = row[PAD.is_whole] > 0
    n = _AROUND if is_whole else max(16, math.ceil(_AROUND * (last - first) / (2 * math.pi)))
    step, width = (last - first) / n, 0.5 * part.length / _ALONG
    c = part.clearance * row[PAD.clearance]
    d = d + part.clearance * complex(row[PAD.x], row[PAD.y])

    def thickness(theta: np.ndarray) -> np.ndarray:
        return np.maximum(c - (np.exp(-1j * theta) * d).real, part.roughness)

    # unknowns: at the angles of a circle's n or a pad's n - 1 inner nodes, from the middle of the
    # length, where it is symmetric, to the side, where the pressure is 0
    theta = first + step * (np.arange(n) if is_whole else np.arange(1, n))
    R = part.journal_radius
    h = thickness(theta)
    before, behind = (thickness(theta + s * step / 2) ** 3 / (step * R) ** 2 for s in (-1, 1))
    m = len(theta)
    circle = sp.diags_array([before + behind, -behind[:-1], -before[1:]], offsets=[0, 1, -1])
    circle = circle.tolil()
    if is_whole:
        circle[0, m - 1], circle[m - 1, 0] = -before[0], -behind[-1]
    across = sp.diags_array(
        [np.full(_ALONG, 2.0), -np.ones(_ALONG - 1), -np.ones(_ALONG - 1)], offsets=[0, 1, -1]
    ).tolil()
    across[0, 1] = -2.0
    A = sp.kron(sp.eye_array(_ALONG), circle) + sp.kron(across, sp.diags_array(h**3 / width**2))
    source = 6 * shear * (np.exp(-1j * theta) * -1j * d).real
    b = np.tile(source, _ALONG)
    if part.rupture == GUEMBEL:
        p = np.maximum(spsolve(A.tocsc(), b), -part.supply_pressure)
    else:
        p = _at_least_nothing(A.tocsr(), b)
    weights = np.full(_ALONG, 2.0 * width)
    weights[0] = width
    around_force = (p.reshape(_ALONG, m) * weights[:, None]).sum(axis=0) @ np.exp(1j * theta)
    return complex(-around_force * R * step)


def _at_least_nothing(A: sp.csr_array, b: np.ndarray) -> np.ndarray:
    """Return p >= 0 with A p = b where it is positive, A p >= b where not."""
    acts = b > 0
    p = np.zeros(len(b))
    for _ in range(_ITERATIONS):
        p[:] = 0.0
        inner = np.flatnonzero(acts)
        if len(inner):
            p[inner] = spsolve(A[inner][:, inner].tocsc(), b[inner])
        after = np.where(acts, p > 0, A @ p < b)
        if (after == acts).all():
            break
        acts = after
    return p
