"""The ellipse of a node that moves as x = Re(X exp(i w t)), y = Re(Y exp(i w t)).

In complex coordinates x + i y = f exp(i w t) + b exp(-i w t), with f = (X + i Y) / 2 that turns
with and b = conj(X - i Y) / 2 that turns against the shaft. At a resonance without damping X and Y
are infinite, and what they would be made of is not known.
"""

import numpy as np

# of the largest orbit of a mode: nodes whose orbits are smaller rest, but for rounding
AT_REST = 1e-9
_ANGLES = np.exp(2j * np.pi * np.arange(360) / 360)  # of a turn, between which it is nearly a line


def forward_part(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return f of complex amplitudes."""
    with np.errstate(invalid="ignore"):
        return (x + 1j * y) / 2


def backward_part(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return b of complex amplitudes."""
    with np.errstate(invalid="ignore"):
        return np.conj(x - 1j * y) / 2


def semi_axes(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the major and minor semi-axis; the latter is negative where the node whirls back."""
    forward, backward = np.abs(forward_part(x, y)), np.abs(backward_part(x, y))
    is_infinite = np.isinf(x) | np.isinf(y)
    return np.where(is_infinite, np.inf, forward + backward), forward - backward


def farthest(rest: complex, x: np.ndarray, y: np.ndarray) -> float:
    """Return the largest distance from the middle of a motion of complex amplitudes, each of one
    number, about where it rests, x + i y: as far as both together only where it rests along the
    major axis."""
    if np.isinf(x) or np.isinf(y):
        return np.inf
    f, b = forward_part(x, y), backward_part(x, y)
    away = np.abs(rest + f * _ANGLES + b * _ANGLES.conj())
    top = int(away.argmax())
    before, most, after = away[[top - 1, top, (top + 1) % len(away)]]
    bent = 2 * most - before - after
    return float(most + (after - before) ** 2 / (8 * bent) if bent > 0 else most)


def lengths_of_nodes(z: np.ndarray) -> np.ndarray:
    """Return the length of the shaft that is nearer to each of ascending nodes z than to others, by
    which a sum over nodes does not depend on how many there are, shape (n,) [m]."""
    return np.convolve(np.diff(z), [0.5, 0.5])
