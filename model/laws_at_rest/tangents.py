"""Forces and tangents of all interfaces at given displacements, at rest."""

from typing import NamedTuple

import numpy as np

from ..backend import bound_unless_compiled
from ..parts import LAWS
from ..step.laws_along_motion import block_of, linearize_laws, vibrate_laws
from ..structure.structure import starts_of


class Tangents(NamedTuple):
    """Of m interfaces: force on the node [N], complex of shape (m,); real 2x2 matrices of (x, y),
    shape (m, 2, 2): dF/dd [N/m] and dF/dd' [N.s/m]."""

    force: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray


class StateTangents(NamedTuple):
    """Of the s states of m interfaces, as matrices of x and y in turn: of the forces by them, shape
    (2 m, s); of their rates by displacement and by velocity, shape (s, 2 m), and by themselves."""

    force: np.ndarray
    by_d: np.ndarray
    by_v: np.ndarray
    by_states: np.ndarray


class LawsAtRest:
    """The laws of m interfaces at rest; laws, interfaces: as of a `Structure`.

    machine: these, where the laws work; whirls, follows: which have states that whirl by themselves
    (`Law.whirls`), and which have states that follow a vibration, shape (m,); of the last
    `tangents`, states: own states of the laws as they were solved, shape (s,); is_invalid: whether
    a law means nothing there, shape (m,).
    """

    def __init__(self, laws: tuple, interfaces: np.recarray) -> None:
        self._block, data = block_of(laws, interfaces, 1)
        self.machine, self._samples = data.machine, data.samples
        self.states, self.is_invalid = self._samples.solved[0], self._samples.is_invalid[:, 0]
        of = [LAWS[i] for i in interfaces.law]
        self.whirls = np.array([law.whirls for law in of], bool)
        self.follows = (interfaces.vibrating > 0) & ~self.whirls
        self._starts = starts_of(interfaces)
        self._vibrate = bound_unless_compiled(vibrate_laws, self._block)
        self._linearize = bound_unless_compiled(linearize_laws, self._block)

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
        self._place(d, states)
        self._vibrate(float(speed), float(sliding), float(frequency))
        return self._tangents()

    def linearized(
        self, d: np.ndarray, speed: float, states: np.ndarray, which: np.ndarray
    ) -> tuple[Tangents, StateTangents]:
        """Return tangents as `tangents` does, where states stay, and those of the states of some
        interfaces, whose laws have `Law.linearize`; which: shape (m,)."""
        self._place(d, states)
        self._linearize(float(speed))
        at, m = self._samples, len(d)
        owner = np.repeat(np.arange(m), self.machine.interfaces.states)
        of, owner = np.flatnonzero(which[owner]), owner[which[owner]]
        own = owner[:, None] == np.arange(m)

        force, by_d, by_v = (
            (np.stack([z.real, z.imag], -1)[:, None] * own[:, :, None]).reshape(len(of), 2 * m)
            for z in (x[0, of] for x in (at.force_by_states, at.rates_by_d, at.rates_by_v))
        )
        by_states = at.rates_by_states[0][np.ix_(of, of)] * (own @ own.T)
        return self._tangents(), StateTangents(force.T, by_d, by_v, by_states)

    def _place(self, d: np.ndarray, states: np.ndarray | None) -> None:
        at = self._samples
        at.d[:, 0] = d
        at.states[0] = at.solved[0] = self._starts if states is None else states

    def _tangents(self) -> Tangents:
        at = self._samples
        return Tangents(at.force[:, 0].copy(), *matrices(at.p[:, :, 0], at.q[:, :, 0]))


def matrices(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the matrices of z -> p z + q conj(z) over x and y, shape (..., 2, 2)."""
    rows = np.array([[(p + q).real, (q - p).imag], [(p + q).imag, (p - q).real]])
    return np.moveaxis(rows, (0, 1), (-2, -1))
