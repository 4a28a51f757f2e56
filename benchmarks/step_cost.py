"""What a step costs, contacts solved: python -m benchmarks.step_cost

CPU time of a step of 0.1 and of 4 ms, this project's beside Exudyn's, in turns.
"""

import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rotor_fmu.model.settings import choose

from .peers import exudyn_peer, project
from .problem import Diverged, Method, Missing, Problem, run_down, timed
from .store import Store, median

# step [s]: (this project's preset, Exudyn's rho, how much of the run-down Exudyn is given [s])
CASES = {1e-4: ("robust", 0.2, 1.0), 4e-3: ("paper", 0.9, 10.0)}


def step_cost(store: Store, repetitions: int, report: Callable[[str, float], None]) -> None:
    """Fill the section `step cost`: name, step, microseconds a step (each run's)."""
    for number, (h, (preset, rho, stop)) in enumerate(CASES.items()):
        whole = replace(run_down(), sample=0.4)
        part = replace(whole, stop=stop, sample=0.04)
        runs = {
            f"this project, h = {h:g} s": (_own(preset, h), whole),
            f"this project, h = {h:g} s, first {stop:g} s": (_own(preset, h), part),
            f"Exudyn, h = {h:g} s, first {stop:g} s": (_exudyn(rho, h), part),
        }
        for _ in range(repetitions):
            for name, (method, problem) in runs.items():
                row = store.section("step cost").get(name, {"h": h, "us": [], "failed": None})
                if row["failed"] or len(row["us"]) >= repetitions:
                    continue
                report(f"cost of a step: {name}", number / len(CASES))
                store.keep("step cost", name, _measured(row, method, problem))


def _measured(row: dict, method: Method | str, problem: Problem) -> dict:
    if isinstance(method, str):
        return {**row, "failed": method}
    try:
        if not row["us"]:
            method.solve(replace(problem, stop=0.16, sample=0.04))
        seconds, result = timed(method.solve, problem)
    except Diverged as error:
        return {**row, "failed": str(error)}
    return {**row, "us": [*row["us"], 1e6 * seconds / result.steps]}


def _own(preset: str, h: float) -> Method:
    return project.method(f"{preset}, h = {h:g} s", choose(preset, h=h))


def _exudyn(rho: float, h: float) -> Method | str:
    try:
        exudyn_peer.load()
    except Missing as error:
        return str(error)
    return exudyn_peer.method(rho, h)


def main() -> None:
    """Print the table."""
    with tempfile.TemporaryDirectory() as folder:
        store = Store(Path(folder), "step cost", 5)
        step_cost(store, 5, lambda what, share: None)
    for name, row in store.section("step cost").items():
        print(f"{name:45s}", row["failed"] or f"{median(row['us']):8.2f} us a step")


if __name__ == "__main__":
    main()
