"""A part's law by itself: its node is moved by hand in a housing that stands."""

from __future__ import annotations

import numpy as np

from ..kernels.jit import interpreted
from ..parts.base import Interface, Part
from ..parts.law import Kinematics, Weights
from ..quantities import quantities

_ROUNDING = 1e-12  # of the largest
_BY_D, _BY_V = Weights(1.0, 0.0, 0.0), Weights(0.0, 1.0, 0.0)


class LawAlone:
    """The first law of a part, whose node is moved by hand at a speed [rad/s].

    part: the part; where: its name, for messages; sliding: speed of the surfaces that slide, by
    default that of the machine [rad/s].
    """

    def __init__(self, part: Part, speed: float, where: str, sliding: float | None = None) -> None:
        element = next(e for e in part.elements(where, 0.0) if isinstance(e, Interface))
        self.speed, self.where, self._law = float(speed), where, element.law
        self._sliding = self.speed if sliding is None else sliding
        numbers = [float(getattr(part, name)) for name in quantities(self._law.kind)]
        self._tables = np.zeros(0)
        if self._law.table is not None:
            self._tables = self._law.table(part).ravel()
            numbers += [0, len(self._tables)]
        self._record = np.array([tuple(numbers)], self._law.dtype).view(np.recarray)[0]
        self._states = np.array(self._law.states, dtype=float)

    def _moving(self, d: complex, v: complex) -> Kinematics:
        return Kinematics(complex(d), complex(v), self.speed, self._sliding, 0.0)

    def force(self, d: complex, v: complex = 0j) -> complex:
        """Return the force on the node [N] at a displacement [m] and a velocity [m/s]."""
        force = interpreted(self._law.force)
        return complex(force(self._record, self._tables, self._moving(d, v), self._states))

    def tangent(self, d: complex, v: complex, weights: Weights) -> np.ndarray:
        """Return the force's derivative for `Weights`, shape (2, 2)."""
        tangent = interpreted(self._law.tangent)
        moving, states = self._moving(d, v), self._states
        _, p, q = tangent(self._record, self._tables, moving, weights, states, states.copy())
        return np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])

    def outputs(self, d: complex, v: complex = 0j) -> dict[str, float]:
        """Return the outputs of the part by their names."""
        out = np.zeros(len(self._law.outputs))
        observe = interpreted(self._law.observe)
        observe(self._record, self._tables, self._moving(d, v), self._states, out)
        return {o.name: float(value) for o, value in zip(self._law.outputs, out, strict=True)}

    def coefficients(self, d: complex) -> tuple[np.ndarray, np.ndarray]:
        """Return K [N/m] and C [N.s/m] of the node at rest at a displacement, each of shape
        (2, 2)."""
        return -self.tangent(d, 0j, _BY_D), -self.tangent(d, 0j, _BY_V)


def cleared(values: np.ndarray) -> np.ndarray:
    """Return values with 0 where but rounding stands."""
    return np.where(np.abs(values) > _ROUNDING * np.abs(values).max(), values, 0.0)
