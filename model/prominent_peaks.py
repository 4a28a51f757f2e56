"""Peaks of a sampled curve with their prominence, as SciPy has them, whose module takes half a
second to import."""

from collections.abc import Iterable

import numpy as np


def prominent_peaks(values: np.ndarray, least: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the places of a curve's peaks inside it whose prominence is at least `least`, and
    their prominences.

    values: shape (n,); of a flat peak the middle is its place. The prominence is the height above
    the higher one of the lowest values on both sides, between the peak and a higher value or the
    curve's end.
    """
    begins = np.append(0, 1 + np.flatnonzero(values[1:] != values[:-1]))[: len(values)]
    level, ends = values[begins], np.append(begins[1:], len(values)) - 1
    tops = 1 + np.flatnonzero((level[1:-1] > level[:-2]) & (level[1:-1] > level[2:]))
    places = (begins[tops] + ends[tops]) // 2
    if not len(places):
        return places, np.zeros(0)
    lows = np.minimum.reduceat(values, np.append(0, places)).tolist()  # before and behind each peak
    heights = values[places].tolist()
    before = _lowest_before(heights, lows)
    behind = _lowest_before(heights[::-1], lows[::-1])[::-1]
    prominences = values[places] - np.maximum(before, behind)
    is_high = prominences >= least
    return places[is_high], prominences[is_high]


def _lowest_before(heights: Iterable[float], lows: Iterable[float]) -> list[float]:
    """Return the lowest value before each peak, back to a higher one; lows: the lowest before each,
    back to the peak before it."""
    result, higher = [], list[tuple[float, float]]()
    for height, low in zip(heights, lows, strict=False):
        while higher and higher[-1][0] <= height:
            low = min(low, higher.pop()[1])
        higher.append((height, low))
        result.append(low)
    return result
