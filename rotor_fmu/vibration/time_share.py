"""How long a place points in each direction, over the speed."""

from dataclasses import dataclass

import numpy as np

from ..short_repr import ShortRepr
from .turns import TURN


@dataclass(frozen=True, repr=False)
class TimeShare(ShortRepr):
    """Share of the time [1] spent in each bin of an angle, shape (speeds, angles), rows of sum 1,
    or 0 where a speed was not passed; edges of the bins: speed and angle [rad/s, rad]."""

    speed: np.ndarray
    angle: np.ndarray
    share: np.ndarray


def time_share(
    t: np.ndarray,
    w: np.ndarray,
    z: np.ndarray,
    *,
    speeds: int = 240,
    angles: int = 120,
    pieces: int = 8,
) -> TimeShare:
    """Return how long a displacement z = x + i y pointed in each direction, over the speed w
    [rad/s].

    The path between two rows is a straight line, each of its `pieces` counting for the time it
    took: a quick passage is a faint trace, not the few points that happened to be recorded.
    """
    weights = np.repeat(np.diff(t) / pieces, pieces)
    share = np.tile((np.arange(pieces) + 0.5) / pieces, len(t) - 1)

    def path(values: np.ndarray) -> np.ndarray:
        before, after = (np.repeat(v, pieces) for v in (values[:-1], values[1:]))
        return before + share * (after - before)

    speed, angle = path(w), np.angle(path(z)) % TURN
    edges = (
        np.linspace(speed.min(), speed.max() + 1e-9, speeds + 1),
        np.linspace(0, TURN, angles + 1),
    )
    table, *_ = np.histogram2d(speed, angle, edges, weights=weights)
    total = table.sum(axis=1, keepdims=True)
    return TimeShare(*edges, np.divide(table, total, out=np.zeros_like(table), where=total > 0))
