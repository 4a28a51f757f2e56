"""How many harmonics a motion has: more where the highest are not small, fewer where they are far
below what is asked for."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from . import arclength
from .arclength import Lost, Point
from .balance import Problem

_MANY, _FEW = 1.4, 1.1  # times the harmonics, at once; where these are too many


@dataclass(frozen=True)
class Accuracy:
    """How many harmonics: `least` to `most`, so that the highest are below `share` of the motion;
    whether multipliers are computed."""

    share: float = 1e-5
    least: int = 3
    most: int = 60
    has_stability: bool = True


def refined(
    problem: Problem, point: Point, accuracy: Accuracy, is_held: bool = False
) -> tuple[Problem, Point]:
    """With as many harmonics as the point needs, along the curve, or, if it is held, at the same
    value; raises `Lost`."""
    while problem.last_share(point.x) > accuracy.share and accuracy.most > problem.H:
        try:
            problem, point = _with(problem, point, _MANY, accuracy, is_held)
        except Lost:
            problem, point = _with(problem, point, _FEW, accuracy, is_held)
    return problem, point


def _with(
    problem: Problem, point: Point, more: float, accuracy: Accuracy, is_held: bool
) -> tuple[Problem, Point]:
    """With so many times the harmonics; raises `Lost`."""
    H = min(accuracy.most, math.ceil(more * problem.H) + problem.turns)
    other = problem.like(H, at=point.value)
    before = _moved(problem, point.direction, other)
    before /= np.linalg.norm(before)
    plane = np.append(np.zeros(len(before) - 1), 1.0) if is_held else before
    result = arclength.correct(
        other, problem.moved(point.x, other), point.value, plane, other.parameter.scale, before
    )
    bend = _moved(problem, point.bend, other)
    return other, result._replace(corrections=point.corrections, bend=bend)


def _moved(problem: Problem, way: np.ndarray, other: Problem) -> np.ndarray:
    """A direction of a curve, or nothing, by other harmonics."""
    return np.append(problem.moved(way[:-1], other), way[-1]) if len(way) else way


def thinned(problem: Problem, point: Point, accuracy: Accuracy) -> tuple[Problem, Point]:
    """With fewer harmonics where the highest are far below what is asked for."""
    H = max(accuracy.least * problem.turns, math.ceil(0.6 * problem.H))
    if H < problem.H and problem.last_share(point.x) < 1e-3 * accuracy.share:
        other = problem.like(H, at=point.value)
        if other.last_share(problem.moved(point.x, other)) < 0.1 * accuracy.share:
            before = _moved(problem, point.direction, other)
            before /= np.linalg.norm(before)
            try:
                result = arclength.correct(
                    other,
                    problem.moved(point.x, other),
                    point.value,
                    before,
                    other.parameter.scale,
                    before,
                )
            except Lost:
                return problem, point
            bend = _moved(problem, point.bend, other)
            return other, result._replace(corrections=point.corrections, bend=bend)
    return problem, point
