"""Forces and tangents of all interfaces at given displacements, at rest."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..kernels.jit import interpreted, jit
from ..step.laws import at_rest, law_vibrate
from ..structure.structure import Structure, starts_of


class Tangents(NamedTuple):
    """Of m interfaces: force on the node [N], complex of shape (m,); real 2x2 matrices of (x, y),
    shape (m, 2, 2): dF/dd [N/m] and dF/dd' [N.s/m]."""

    force: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray


@jit
def _fill(laws, interfaces, d, speed, frequency, free, internal_state, force, p, q):
    """Forces, and both tangents as p z + q conj(z); p, q of shape (2, m): by d, by d'."""
    for j in range(len(interfaces)):
        interface = interfaces[j]
        at = interface.internal_state
        force[j], p[0, j], q[0, j], p[1, j], q[1, j] = law_vibrate(
            laws, interface, at_rest(d[j], speed), frequency, free[at:], internal_state[at:]
        )


def tangents(structure: Structure, d: np.ndarray, speed: float, frequency: float = 0.0) -> Tangents:
    """Linearize the laws at relative displacements d, complex of shape (m,) [m], at rest, at the
    machine's speed [rad/s], vibrating at a frequency [rad/s]; surfaces do not slide, a law's
    internal states are those of its start, or follow (`parts.law`).
    """
    interfaces = structure.interfaces
    m = len(interfaces)
    free, internal_state = starts_of(interfaces), starts_of(interfaces)
    force, p, q = (np.zeros(shape, complex) for shape in (m, (2, m), (2, m)))
    interpreted(_fill)(
        structure.laws,
        interfaces,
        d.astype(complex),
        float(speed),
        float(frequency),
        free,
        internal_state,
        force,
        p,
        q,
    )
    matrices = np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])
    by_d, by_v = np.moveaxis(matrices, 2, 0).transpose(0, 3, 1, 2)
    return Tangents(force, by_d, by_v)
