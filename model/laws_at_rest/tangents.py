"""Forces and tangents of all interfaces at given displacements, at rest."""

from typing import NamedTuple

import numpy as np

from ..backend import bound_unless_compiled
from ..step.laws_along_motion import block_of, vibrate_laws
from ..structure.structure import starts_of


class Tangents(NamedTuple):
    """Of m interfaces: force on the node [N], complex of shape (m,); real 2x2 matrices of (x, y),
    shape (m, 2, 2): dF/dd [N/m] and dF/dd' [N.s/m]."""

    force: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray


class LawsAtRest:
    """The laws of m interfaces at rest; laws, interfaces: as of a `Structure`.

    machine: these, where the laws work; of the last `tangents`, states: own states of the laws as
    they were solved, shape (s,); is_invalid: whether a law means nothing there, shape (m,).
    """

    def __init__(self, laws: tuple, interfaces: np.recarray) -> None:
        self._block, data = block_of(laws, interfaces, 1)
        self.machine, self._samples = data.machine, data.samples
        self.states, self.is_invalid = self._samples.solved[0], self._samples.is_invalid[:, 0]
        self._starts = starts_of(interfaces)
        self._vibrate = bound_unless_compiled(vibrate_laws, self._block)

    def tangents(
        self,
        d: np.ndarray,
        speed: float,
        frequency: float = 0.0,
        *,
        sliding: float = 0.0,
        states: np.ndarray | None = None,
    ) -> Tangents:
        """Linearize the laws at relative displacements d, complex of shape (m,) [m], at rest, at
        the machine's speed [rad/s], vibrating at a frequency [rad/s].

        sliding: speed at which the surfaces do [rad/s]; states: of the laws, those of the start by
        default, which stay or follow (`parts.law`).
        """
        at = self._samples
        at.d[:, 0] = d
        at.states[0] = at.solved[0] = self._starts if states is None else states
        self._vibrate(float(speed), float(sliding), float(frequency))
        p, q = at.p[:, :, 0], at.q[:, :, 0]
        matrices = np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])
        by_d, by_v = np.moveaxis(matrices, 2, 0).transpose(0, 3, 1, 2)
        return Tangents(at.force[:, 0].copy(), by_d, by_v)
