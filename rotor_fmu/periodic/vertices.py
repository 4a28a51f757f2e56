"""The line of a branch: its points with the bifurcations between them, stable and unstable."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple, TypeAlias

import numpy as np

from ..model.periodic.branch import Bifurcation, Branch, Solution

Motion: TypeAlias = Solution | Bifurcation

_SMOOTH = 0.7  # least cosine of two chords between which the curve has no corner
_TURN = 0.1  # of a drawn line at one of its points [rad]
_MOST = 8  # parts of a chord


class Vertex(NamedTuple):
    """A point of a branch or a bifurcation, and whether the motions that follow it are stable."""

    motion: Motion
    is_stable: bool


def vertices(branch: Branch) -> list[Vertex]:
    """Return the points of a branch with the bifurcations between them, in their order."""
    result = list[Vertex]()
    for i, point in enumerate(branch.points):
        passed = [b for b in branch.bifurcations if b.behind == i - 1]
        if passed:
            both = result[-1].is_stable and point.is_stable
            result += [Vertex(b, both) for b in passed[:-1]]
            result.append(Vertex(passed[-1], point.is_stable))
        result.append(Vertex(point, point.is_stable))
    return result


def drawn(branch: Branch) -> list[Vertex]:
    """Return the vertices of a branch with motions between them where a line through these would
    show corners that the curve has not."""
    line = vertices(branch)
    between = _between([vertex.motion for vertex in line]) if line else []
    return [
        Vertex(motion, vertex.is_stable)
        for vertex, more in zip(line, between, strict=True)
        for motion in (vertex.motion, *more)
    ]


def pieces(branch: Branch) -> list[tuple[list[Motion], bool]]:
    """Return the stretches of a branch that are all stable or all not, each up to the first motion
    of the next one, and which, as they are drawn."""
    result = list[tuple[list[Motion], bool]]()
    for motion, is_stable in drawn(branch):
        if not result or result[-1][1] != is_stable:
            if result:
                result[-1][0].append(motion)
            result.append(([], is_stable))
        result[-1][0].append(motion)
    return result


def _between(line: Sequence[Motion]) -> Iterator[list[Motion]]:
    """Yield the motions behind each of a line's: on cubics along the arc (Hermite), with tangents
    by three vertices; none across a corner of the curve itself."""
    values = [motion.value for motion in line]
    span = (max(values) - min(values)) or 1.0
    size = max(float(np.linalg.norm(m.motion)) for m in line) or 1.0
    shape = max(len(m.motion) for m in line), line[0].motion.shape[1]

    def place(motion: Motion) -> np.ndarray:
        """Return amplitudes and parameter, as shares of their sizes."""
        padded = np.zeros(shape, complex)
        padded[: len(motion.motion)] = motion.motion
        return np.append(padded.ravel() / size, motion.value / span)

    places = [place(motion) for motion in line]
    chords = [b - a for a, b in pairwise(places)]
    tangents = [None, *(_tangent(*ways) for ways in pairwise(chords)), None]
    for motion, start, way, ends in zip(line, places, chords, pairwise(tangents), strict=False):
        length = float(np.linalg.norm(way)) or 1.0
        more = list[Motion]()
        for t, at in _on_cubic(way / length, *ends):
            moved = start + t * way + length * at
            more.append(
                motion._replace(
                    motion=size * moved[:-1].reshape(shape), value=span * float(moved[-1].real)
                )
            )
        yield more
    yield []


def _tangent(before: np.ndarray, after: np.ndarray) -> np.ndarray | None:
    """Return the tangent of a parabola between two chords, or None where there is a corner."""
    lengths = [float(np.linalg.norm(way)) for way in (before, after)]
    if min(lengths) == 0.0:
        return None
    first, second = before / lengths[0], after / lengths[1]
    if np.vdot(first, second).real < _SMOOTH:
        return None
    result = (lengths[1] * first + lengths[0] * second) / sum(lengths)
    slopes = first[-1].real, second[-1].real
    if slopes[0] * slopes[1] > 0:  # beside a resonance the parameter must not turn back
        result[-1] = sum(lengths) / (lengths[1] / slopes[0] + lengths[0] / slopes[1])
    return result


def _on_cubic(
    chord: np.ndarray, begin: np.ndarray | None, end: np.ndarray | None
) -> list[tuple[float, np.ndarray]]:
    """Return places on a cubic over a chord of length 1, by the share of the chord and how far away
    from it; begin, end: tangents, of which a parabola has one."""
    parts = [None if tangent is None else tangent - chord for tangent in (begin, end)]
    both = [part for part in parts if part is not None]
    if not both:
        return []
    as_parabola = -both[0]
    as_parabola[-1] = 0.0  # the parameter must not turn back
    first, last = (as_parabola if part is None else part for part in parts)
    turn = float(np.linalg.norm(last - first))
    count = min(_MOST, math.ceil(turn / _TURN))
    shares = [k / count for k in range(1, count)]
    return [(t, t * (1 - t) * ((1 - t) * first - t * last)) for t in shares]
