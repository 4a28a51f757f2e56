"""Evaluates one part's force law at a prescribed motion of its node, its housing fixed."""

from typing import Any

import numpy as np

from ..kernels.kernel import interpreted
from ..quantities import quantities
from .base import InterfaceElement, Part
from .law import BY_D, BY_V, Kinematics, Weights

_ROUNDING = 1e-12  # of the largest


def numbers_of(kind: type, source: Any) -> tuple[float, ...]:
    """Return the numbers of a law's or a housing's record from the quantities of a part, 0 for
    those in a table."""
    values = [getattr(source, name) for name in quantities(kind)]
    return tuple(0.0 if isinstance(value, tuple) else float(value) for value in values)


class LawProbe:
    """The first law of a part at a prescribed motion of its node, at a speed [rad/s].

    part: the part; where: its name, for messages; sliding: sliding speed of the surfaces, by
    default the speed of the machine [rad/s].
    """

    def __init__(self, part: Part, speed: float, where: str, sliding: float | None = None) -> None:
        element = next(e for e in part.elements(where, 0.0) if isinstance(e, InterfaceElement))
        self.speed, self.where, self._law = float(speed), where, element.law
        self._sliding = self.speed if sliding is None else sliding
        numbers = list(numbers_of(self._law.kind, part))
        self._outputs = element.law.outputs_of(part)
        self._tables: Any = np.zeros(0)
        if self._law.table is not None:
            # whose numbers are Python's, which are calculated with in less time than numpy's
            self._tables = self._law.table(part).ravel().data
            numbers += [0, len(self._tables)]
        self._record = np.array([tuple(numbers)], self._law.dtype).view(np.recarray)[0]
        self._states = np.array(self._law.states_of(part), dtype=float)
        self._follows = self._law.vibrate is not None  # whether it is known as the node vibrates
        self._settled: tuple[Any, Any] | None = None  # the states at rest, and the result with them

    def _moving(self, d: complex, v: complex) -> Kinematics:
        return Kinematics(complex(d), complex(v), self.speed, self._sliding, 0.0)

    def settle(self, d: complex, frequency: float = 0.0) -> tuple[complex, np.ndarray, np.ndarray]:
        """Let the law's states rest where the node does; return the force [N] and its derivatives
        by displacement and velocity as the node vibrates at a frequency [rad/s]."""
        if self._settled is None or self._settled[0] != (d, frequency):
            self._settled = (d, frequency), self._vibrating(d, frequency)
        return self._settled[1]

    def _vibrating(self, d: complex, frequency: float) -> tuple[complex, np.ndarray, np.ndarray]:
        """Return the result of `vibrate` without its cache."""
        vibrate = interpreted(self._law.vibrate)
        moving, free = self._moving(d, 0j), self._states.copy()
        force, *by = vibrate(self._record, self._tables, moving, frequency, free, self._states)
        return complex(force), _matrix(*by[:2]), _matrix(*by[2:])

    def _settle_at(self, d: complex, v: complex) -> None:
        if self._follows and v == 0.0:
            self.settle(d)

    def force(self, d: complex, v: complex = 0j) -> complex:
        """Return the force on the node [N] at a displacement [m] and a velocity [m/s], with the
        law's states in equilibrium."""
        if self._follows and v == 0.0:
            return self.settle(d)[0]
        force = interpreted(self._law.force)
        return complex(force(self._record, self._tables, self._moving(d, v), self._states))

    def tangent(self, d: complex, v: complex, weights: Weights) -> np.ndarray:
        """Return the force's derivative for `Weights`, shape (2, 2)."""
        if self._follows and v == 0.0:
            _, by_d, by_v = self.settle(d)
            return weights.displacement * by_d + weights.velocity * by_v
        tangent = interpreted(self._law.tangent)
        moving, states = self._moving(d, v), self._states
        _, p, q = tangent(self._record, self._tables, moving, weights, states, states.copy())
        return _matrix(p, q)

    def outputs(self, d: complex, v: complex = 0j) -> dict[str, float]:
        """Return the outputs of the part by their names."""
        self._settle_at(d, v)
        out = np.zeros(len(self._outputs))
        observe = interpreted(self._law.observe)
        observe(self._record, self._tables, self._moving(d, v), self._states, out)
        return {o.name: float(value) for o, value in zip(self._outputs, out, strict=True)}

    def coefficients(self, d: complex) -> tuple[np.ndarray, np.ndarray]:
        """Return K [N/m] and C [N.s/m] of the node at rest at a displacement, shape (2, 2) each,
        for a vibration at the frequency of rotation."""
        if self._follows:
            _, by_d, by_v = self.settle(d, abs(self.speed))
            return -by_d, -by_v
        return -self.tangent(d, 0j, BY_D), -self.tangent(d, 0j, BY_V)


def _matrix(p: complex, q: complex) -> np.ndarray:
    """Return the matrix of z -> p z + q conj(z), shape (2, 2)."""
    return np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])


def cleared(values: np.ndarray) -> np.ndarray:
    """Return values with rounding errors replaced by 0."""
    return np.where(np.abs(values) > _ROUNDING * np.abs(values).max(), values, 0.0)
