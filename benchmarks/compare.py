"""Work at equal precision: what is read off the results of the race."""

import itertools
import math
from collections.abc import Iterable

from .store import Store, median

OWN = "this project"


def rows(store: Store, problem: str) -> list[dict]:
    """Results of a problem that came to its end, with the median CPU time as `cpu` [s]."""
    return [
        row | {"cpu": median(row["cpu_s"])}
        for row in store.section(problem).values()
        if row["cpu_s"]
    ]


def front(chosen: Iterable[dict], error: str = "orbit_max") -> list[tuple[float, float]]:
    """(error, CPU seconds), error falling: only what nothing beats in both."""
    best: list[tuple[float, float]] = []
    for point in sorted((row["cpu"], row[error]) for row in chosen):
        if not best or point[1] < best[-1][0]:
            best.append((point[1], point[0]))
    return best


def work_at(error: float, points: list[tuple[float, float]]) -> float | None:
    """CPU seconds [s] at which a front reaches this error, on straight lines between its points in
    a log-log plane; None below its smallest error, its cheapest point above its largest."""
    if not points or error < points[-1][0]:
        return None
    if error >= points[0][0]:
        return points[0][1]
    for (e0, c0), (e1, c1) in itertools.pairwise(points):
        if e1 <= error <= e0:
            share = math.log(e0 / error) / math.log(e0 / e1)
            return c0 * (c1 / c0) ** share
    return None


def own_front(store: Store, problem: str) -> list[tuple[float, float]]:
    """This project's best, whatever the settings."""
    return front(row for row in rows(store, problem) if row["program"] == OWN)


def ratio_to_own(row: dict, own: list[tuple[float, float]]) -> float | None:
    """How many times this project's CPU time a run took, at the error that it had."""
    work = work_at(row["orbit_max"], own)
    return None if work is None else row["cpu"] / work


def within_one_percent(store: Store, problem: str) -> dict | None:
    """This project's cheapest run whose X and Y lie within 1 % of the converged ones."""
    good = [
        row
        for row in rows(store, problem)
        if row["program"] == OWN
        and row["x_peak_error"] is not None
        and max(abs(row["x_peak_error"]), abs(row["y_peak_error"])) <= 0.01
    ]
    return min(good, key=lambda row: row["cpu"], default=None)


def growth_exponent(store: Store, program: str, least: int, most: int) -> float | None:
    """p of cost a step ~ dofs^p between two numbers of elements."""
    result = {
        row["elements"]: (row["dofs"], median(row["us"]))
        for row in store.section("growth").values()
        if row["program"] == program and row["varied"] == "elements" and row["us"]
    }
    if least not in result or most not in result:
        return None
    (n0, c0), (n1, c1) = result[least], result[most]
    return math.log(c1 / c0) / math.log(n1 / n0)
