"""Points of a piece of a curve between two of its points, and roots of functions along it."""

import math
from bisect import bisect
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from . import arclength
from .arclength import CurvePoint, chord, distance
from .method_switch import PeriodicEquations
from .newton import NotConverged

_EVALUATIONS = 40  # evaluations of a test function at most
_PRECISE = 1e-9  # of the length of a piece
_CLOSE = 1e-5  # of it: a test function changes little so close to its root
_LITTLE = 1e-2  # of its larger value at the ends,
_ERRORS = 10.0  # or errors of a point along the curve, over the length
_FARTHEST = 2.0  # of its length: how far from its begin a point of a piece may be
_AHEAD = 0.5  # cosine of two tangents: of less the curve has a corner between their points
# Of its length: between points so near the cubic through them is as exact as the points.
_NEAR, _ASIDE = 0.011, 0.005


class PiecePoints:
    """Points of a curve between two of its points, each computed once, by their shares of the
    length along the tangent of the first one."""

    def __init__(self, problem: PeriodicEquations, before: CurvePoint, after: CurvePoint) -> None:
        self.problem, self.length = problem, distance(before, after, problem.scale)
        self._shares, self._points = [0.0, 1.0], [before, after]
        self._between = dict[float, CurvePoint]()
        self._last = after

    def at(self, share: float) -> CurvePoint:
        """Return the point at a share of the length; raises `NotConverged`, also where Newton's
        method leads far away."""
        place = bisect(self._shares, share)
        if self._shares[place - 1] == share:
            return self._points[place - 1]
        problem, first, near = self.problem, self._points[0], self._interpolated(place, share)
        problem.fix_phase(first.x)
        point = arclength.correct(problem, near.x, near.value, first.direction)
        if distance(first, point, problem.scale) > _FARTHEST * self.length:  # another branch
            raise NotConverged()
        self._shares.insert(place, share)
        self._points.insert(place, point)
        self._last = point
        return point

    def motion_at(self, share: float) -> CurvePoint:
        """Return the point at a share of the length, interpolated where its neighbours are near:
        close to where branches cross, Newton's method finds none. Raises `NotConverged`."""
        place = bisect(self._shares, share)
        if place == len(self._shares) or share in self._shares:
            return self.at(share)
        if self._shares[place] - self._shares[place - 1] > _NEAR:
            return self.at(share)
        if share not in self._between:
            self._between[share] = self._interpolated(place, share)
        return self._between[share]

    def _interpolated(self, place: int, share: float) -> CurvePoint:
        """Return the point of the cubic through two neighbouring points, along their tangents,
        from which a smooth curve differs by the fourth power of their distance."""
        a, b = self._points[place - 1], self._points[place]
        begin, end = self._shares[place - 1], self._shares[place]
        plane, scale = self._points[0].direction, self.problem.scale
        way, slopes = chord(a, b, scale), []
        for point in (a, b):
            cosine = float(point.direction @ plane)
            slopes.append(way if cosine < _AHEAD else way @ plane / cosine * point.direction)
        t = (share - begin) / (end - begin)
        bend = (1.0 - t) * (slopes[0] - way) - t * (slopes[1] - way)
        ahead = t * (way + (1.0 - t) * bend)
        mean = (1.0 - t) * a.direction + t * b.direction
        x, value = a.x + ahead[:-1], a.value + scale * float(ahead[-1])
        return CurvePoint(x, value, mean[:-1], float(mean[-1]))

    def narrow(self, test: Callable[[float], float]) -> None:
        """Compute points near the root of a function on both sides of it, unless there are such.
        Raises `NotConverged`."""
        low, high = self._around_root(test)
        if high - low > _NEAR:
            root = brentq(test, low, high, xtol=_ASIDE, maxiter=_EVALUATIONS, disp=False)
            for share in (root - _ASIDE, root + _ASIDE):
                self.at(min(max(share, 0.0), 1.0))

    def is_smooth_about(self, test: Callable[[float], float]) -> bool:
        """Return whether the nearest points about a function's root, which `narrow` has put there,
        are of one smooth piece of the curve."""
        low, high = map(self.at, self._around_root(test))
        return low.cosine(high) > 1.0 - arclength.SAME_PIECE

    def root(self, test: Callable[[float], float]) -> tuple[CurvePoint, bool]:
        """Return the root of a function of the share, which has opposite signs at both ends, by
        Brent's method from the nearest known points about it, and whether the function is smooth
        there."""
        most = max(abs(test(0.0)), abs(test(1.0)))
        error = self.problem.tolerance * (1.0 + float(np.linalg.norm(self._points[0].x)))
        little = most * max(_LITTLE, min(_ERRORS * error / self.length, 0.5))
        try:
            ends = self._around_root(test)
            found = brentq(test, *ends, xtol=_PRECISE, maxiter=_EVALUATIONS, disp=False)
            # not at the root alone: within rounding of a corner a function has any value
            beside = max(found - _CLOSE, 0.0), min(found + _CLOSE, 1.0)
            is_smooth = all(abs(test(share)) < little for share in beside)
            return self._between.get(found) or self.at(found), is_smooth
        except NotConverged:
            return self._last, False

    def _around_root(self, test: Callable[[float], float]) -> tuple[float, float]:
        """Return the shares of two neighbouring points between which a function changes its
        sign."""
        shares = sorted({*self._shares, *self._between})
        low, high, sign = 0, len(shares) - 1, math.copysign(1.0, test(0.0))
        while high - low > 1:
            middle = (low + high) // 2
            low, high = (middle, high) if sign * test(shares[middle]) > 0 else (low, middle)
        return shares[low], shares[high]
