"""All programs on the same problems, in turns, so that a busy machine slows all of them alike."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from .peers import cvode, exudyn_peer, ida, project, ross_peer, scipy_peer
from .problem import Diverged, Method, Missing, Orbit, Problem, beginning, run_down, timed
from .store import Store

PEERS = (project, cvode, exudyn_peer, scipy_peer, ida, ross_peer)
_ENOUGH = 20.0  # of CPU time, after which a program is not run again [s]
_WARM_UP = 0.04  # compiles, loads and fills caches before anything is timed [s]
_QUICK_STOP = 4.0  # of the run-down of a quick run [s]

Report = Callable[[str, float], None]  # (what, share done)


def methods() -> tuple[list[Method], list[str]]:
    """What can be run here, and a line for each program that cannot."""
    result, missing = [], []
    for peer in PEERS:
        try:
            result += peer.methods()
        except Missing as error:
            missing.append(str(error))
    return result, missing


def race(store: Store, repetitions: int, is_quick: bool, report: Report) -> None:
    """Run every method on its problems `repetitions` times in turns; keep each result at once."""
    result, missing = methods()
    store.keep("missing", "programs", {"lines": missing})
    problems = [beginning(), run_down()]
    if is_quick:
        problems[1] = replace(problems[1], stop=_QUICK_STOP)
    for problem in problems:
        chosen = [m for m in result if not m.only_short or problem.name == "beginning"]
        _race(store, problem, chosen, repetitions, report)


def _race(
    store: Store, problem: Problem, chosen: list[Method], repetitions: int, report: Report
) -> None:
    truth = _reference(store, problem, report)
    is_warm = set()
    total = repetitions * len(chosen)
    for repetition in range(repetitions):
        for number, method in enumerate(chosen):
            row = store.section(problem.name).get(method.name)
            if row is not None and _is_done(row, repetition):
                continue
            report(f"{problem.name}: {method.name}", (repetition * len(chosen) + number) / total)
            if method.name not in is_warm:
                is_warm.add(method.name)
                _attempt(method, replace(problem, stop=_WARM_UP, sample=_WARM_UP / 4))
            attempt = _attempt(method, problem)
            if isinstance(attempt, str):
                row = {**_label(method), "failed": attempt, "cpu_s": []}
            else:
                seconds, result = attempt
                row = row or {**_label(method), "failed": None, "cpu_s": []}
                row |= _errors(result, truth)
                row["cpu_s"] = [*row["cpu_s"], seconds]
            store.keep(problem.name, method.name, row)


def _is_done(row: dict, repetition: int) -> bool:
    has_run_long_enough = sum(row["cpu_s"]) > _ENOUGH
    return bool(row["failed"]) or len(row["cpu_s"]) > repetition or has_run_long_enough


def _attempt(method: Method, problem: Problem) -> tuple[float, Orbit] | str:
    try:
        return timed(method.solve, problem)
    except Diverged as error:
        return str(error)


def _label(method: Method) -> dict[str, str | float | None]:
    return {
        "program": method.program,
        "setting": method.setting,
        "tolerance": method.tolerance,
    }


def _reference(store: Store, problem: Problem, report: Report) -> Orbit:
    stored = store.section("reference").get(problem.name)
    if stored is None:
        report(f"{problem.name}: converged reference", 0.0)
        cvode.reference(replace(problem, stop=_WARM_UP, sample=_WARM_UP / 4))
        seconds, result = timed(cvode.reference, problem)
        stored = {
            "x": result.disc.real.tolist(),
            "y": result.disc.imag.tolist(),
            "steps": result.steps,
            "x_peak": result.x_peak,
            "y_peak": result.y_peak,
            "cpu_s": seconds,
            "stop": problem.stop,
        }
        store.keep("reference", problem.name, stored)
    disc = np.array(stored["x"]) + 1j * np.array(stored["y"])
    return Orbit(disc, stored["steps"], stored["x_peak"], stored["y_peak"])


def _errors(result: Orbit, truth: Orbit) -> dict[str, float | int | None]:
    """Of the orbit, its largest and its root mean square [m]; of X and Y, relative [1]."""
    error = np.abs(result.disc - truth.disc)
    signal = np.abs(truth.disc - truth.disc[0]).max()
    figures: dict[str, float | int | None] = {
        "steps": result.steps,
        "orbit_max": float(error.max()),
        "orbit_rms": float(np.sqrt((error**2).mean())),
        "orbit_relative": float(error.max() / signal),
    }
    for name in ("x_peak", "y_peak"):
        value, exact = getattr(result, name), getattr(truth, name)
        figures[name] = value
        figures[f"{name}_error"] = None if exact is None else value / exact - 1
    return figures
