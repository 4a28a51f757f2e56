"""The amplitude of a place over the speed in a run whose speed changes."""

import math

import numpy as np

from ..api.result import Result

_BINS = 120


def amplitude_over_speed(
    result: Result, place: str, during: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return speeds [rad/s] and the largest distance from the mean over time in each of `_BINS`
    bins [m]."""
    if not place or not during.any():
        return np.zeros(0), np.zeros(0)
    w = np.abs(result.speed)[during]
    z = (result[f"{place}.x"] + 1j * result[f"{place}.y"])[during]
    lasted = np.gradient(result.t)[during]
    edges = np.linspace(w.min(), w.max(), _BINS + 1)
    bins = np.clip(np.digitize(w, edges) - 1, 0, _BINS - 1)
    middles = (edges[:-1] + edges[1:]) / 2
    values = [_radius(z[bins == i], lasted[bins == i]) for i in range(_BINS)]
    known = np.isfinite(values)
    return middles[known], np.array(values)[known]


def _radius(z: np.ndarray, lasted: np.ndarray) -> float:
    if len(z) <= 2:
        return math.nan
    return float(np.abs(z - np.average(z, weights=lasted)).max())
