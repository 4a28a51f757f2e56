"""A contact over a run: where it rubs, how hard, how long; and the power of each sink of energy."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..short_repr import ShortRepr
from .recorded import finite, recorded
from .turns import TURN, turns_of

# Spread above which a mean direction says nothing: of a journal that goes round three quarters of
# its bearing and more.
ALL_ROUND = 0.75


@dataclass(frozen=True, repr=False)
class Contact(ShortRepr):
    """A contact over a run, one row a turn.

    t [s], speed [rad/s]; share: of the turn that it touched [1]; peak, mean: largest normal force
    and its mean over the turn [N]; angle: mean direction of the touch, weighted by the force, in
    [0, 2 pi), NaN without a touch and where the touch goes all round, its spread above `ALL_ROUND`
    [rad]; spread: 0, always there, to 1, all round [1]; low, width: the range of all touches, from
    low in [0, 2 pi) counterclockwise to low + width, NaN without a touch [rad]; shape (turns,).
    """

    t: np.ndarray
    speed: np.ndarray
    share: np.ndarray
    peak: np.ndarray
    mean: np.ndarray
    angle: np.ndarray
    spread: np.ndarray
    low: np.ndarray
    width: np.ndarray


def contact(
    t: np.ndarray,
    phi: np.ndarray,
    psi: np.ndarray,
    fn: np.ndarray,
    fn_peak: np.ndarray | None = None,
) -> Contact:
    """Return a contact's angle psi [rad], all NaN where it is not known, and normal force fn [N]
    over a run, by turns. Where nothing touches no angle is needed. fn_peak: the largest force of
    all steps over the last revolution [N], where it is known: fn misses what is between samples.

    The samples are taken as they are, each for the interval about it: a force that comes and goes
    within a few steps is not interpolated. Raises `TooFewTurns` for less than a turn, `InputError`
    for what is no signal.
    """
    fn_peak = fn if fn_peak is None else fn_peak
    t, phi, psi, fn, fn_peak = recorded(t=t, phi=phi, psi=psi, fn=fn, fn_peak=fn_peak)
    if np.isfinite(psi).any():
        psi = np.where(fn == 0, 0.0, psi)
        t, phi, psi, fn, fn_peak = finite(t=t, phi=phi, psi=psi, fn=fn, fn_peak=fn_peak)
    else:
        t, phi, fn, fn_peak = finite(t=t, phi=phi, fn=fn, fn_peak=fn_peak)
        psi = np.full(len(t), np.nan)
    turns = turns_of(t, phi)
    turns.needs(1)
    is_seen = turns.rows > 0  # not of steps longer than a turn
    ends = np.column_stack([turns.row, turns.row + turns.rows])[is_seen].ravel()

    def sums(values: np.ndarray) -> np.ndarray:
        return np.add.reduceat(np.append(values, 0), ends)[::2]

    weight = np.gradient(t)
    total = sums(weight)
    force = sums(weight * fn)
    touching = sums(weight * (fn > 0))
    push = sums(weight * fn * np.exp(1j * psi))
    is_met = force > 0
    length = np.divide(np.abs(push), force, out=np.zeros_like(force), where=is_met)
    spread = np.where(is_met, 1 - length, np.nan)
    low, width = _ranges(psi, fn, ends)
    return Contact(
        turns.middle[is_seen],
        turns.speed[is_seen],
        touching / total,
        np.maximum.reduceat(np.append(fn_peak, 0), ends)[::2],
        force / total,
        np.where(spread <= ALL_ROUND, np.mod(np.angle(push), TURN), np.nan),
        spread,
        low,
        width,
    )


def _ranges(psi: np.ndarray, fn: np.ndarray, ends: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return, for each turn, the range of angles at which there is a force, its low end and its
    width: all of the circle but the widest gap between two of them."""
    turn = np.repeat(np.arange(len(ends) // 2), np.diff(ends)[::2])
    row = np.concatenate([np.arange(a, b) for a, b in ends.reshape(-1, 2)])
    touches = (fn[row] > 0) & np.isfinite(psi[row])
    turn, angle = turn[touches], np.mod(psi[row[touches]], TURN)
    order = np.lexsort((angle, turn))
    turn, angle = turn[order], angle[order]
    low, width = np.full((2, len(ends) // 2), np.nan)
    if len(turn):
        first = np.flatnonzero(np.diff(turn, prepend=-1))
        last = np.append(first[1:], len(turn)) - 1
        # from each angle on to the next, of the last one to the first
        gap = np.append(np.diff(angle), 0.0)
        gap[last] = angle[first] + TURN - angle[last]
        widest = np.maximum.reduceat(gap, first)
        is_widest = gap == np.repeat(widest, last - first + 1)
        at = np.flatnonzero(is_widest)[np.searchsorted(np.flatnonzero(is_widest), first)]
        after = np.where(at == last, first, at + 1)
        low[turn[first]], width[turn[first]] = angle[after], TURN - widest
    return low, width


def power_by_sink(
    t: np.ndarray, phi: np.ndarray, losses: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Return the mean power of each turn that every sink took.

    losses: energy dissipated since the start by the sink's name, shape (n,) [J]. Returns the times
    of the turns' middles [s], their speeds [rad/s] and powers by name, shape (turns,) [W], NaN next
    to an energy that is not finite. Raises `TooFewTurns` for less than a turn, `InputError` for
    what is no signal.
    """
    named = {f"losses[{name}]": energy for name, energy in losses.items()}
    t, phi, *energies = recorded(t=t, phi=phi, **named)
    is_known = np.isfinite(t) & np.isfinite(phi)
    t, phi = t[is_known], phi[is_known]
    turns = turns_of(t, phi)
    turns.needs(1)
    lasted = turns.end - turns.begin
    edges = np.stack([turns.begin, turns.end])
    powers = {
        name: np.diff(np.interp(edges, t, energy[is_known]), axis=0)[0] / lasted
        for name, energy in zip(losses, energies, strict=True)
    }
    return turns.middle, turns.speed, powers
