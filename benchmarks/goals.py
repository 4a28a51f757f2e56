"""What was wanted of this project's speed, against what was measured."""

from collections.abc import Iterator

from .compare import OWN, front, growth_exponent, own_front, rows, within_one_percent, work_at
from .peers.cvode import REDUCED
from .starting import goals as starting_goals
from .store import Store, median

_WHOLE = "run-down"
Line = tuple[str, str, str, bool | None]  # what, goal, measured, whether met


def goals(store: Store) -> list[Line]:
    """Every goal with its figure; the last entry is None where the run did not measure it."""
    stop = store.section("reference").get(_WHOLE, {}).get("stop", 40.0)
    return [
        *_step(store),
        *_whole_run(store, stop),
        *_against_cvode(store),
        *_tolerances(store),
        *_scatter(store),
        *_process(store),
        *_growth(store),
        *starting_goals(store),
    ]


def _us(store: Store, name: str) -> float | None:
    row = store.section("step cost").get(name)
    return median(row["us"]) if row and row["us"] else None


def _step(store: Store) -> Iterator[Line]:
    for h, goal in ((1e-4, 3.0), (4e-3, 4.0)):
        us = _us(store, f"this project, h = {h:g} s")
        if us is not None:
            yield f"a step, h = {h:g} s", f"at most {goal:g} µs", f"{us:.2f} µs", us <= goal
    own = _us(store, "this project, h = 0.0001 s, first 1 s")
    other = _us(store, "Exudyn, h = 0.0001 s, first 1 s")
    if own and other:
        ratio = other / own
        yield "Exudyn's step, h = 1e-4 s", "at least 12 times", f"{ratio:.1f} times", ratio >= 12


def _whole_run(store: Store, stop: float) -> Iterator[Line]:
    best = within_one_percent(store, _WHOLE)
    if best is None:
        return
    speed = stop / best["cpu"]
    yield (
        f"the run-down with X and Y within 1 % ({best['setting']})",
        "at least 200 times real time",
        f"{speed:.0f} times, {best['cpu']:.2f} s",
        speed >= 200,
    )
    steps = best["steps"]
    yield "its steps", "fewer than 80 000", f"{steps:,}".replace(",", " "), steps < 80_000


def _against_cvode(store: Store) -> Iterator[Line]:
    own = own_front(store, _WHOLE)
    second = front(
        row
        for row in rows(store, _WHOLE)
        if row["program"] == "CVODE" and row["setting"].startswith("order 2")
    )
    on_modes = front(row for row in rows(store, _WHOLE) if row["program"] == REDUCED)
    for peer, named, error, least in (
        (second, "CVODE of order 2", 10e-6, 20),
        (second, "CVODE of order 2", 1e-6, 20),
        (second, "CVODE of order 2", 0.2e-6, 20),
        (on_modes, REDUCED, 1e-6, 8),
    ):
        ours, theirs = work_at(error, own), work_at(error, peer)
        what = f"{named} at an orbit error of {error * 1e6:g} µm"
        goal = f"at least {least} times the CPU"
        if theirs is None:
            continue
        if ours is None:
            yield what, goal, "this project does not reach it", False
        else:
            yield what, goal, f"{theirs / ours:.1f} times", theirs >= least * ours


def _tolerances(store: Store) -> Iterator[Line]:
    result = {row["tolerance"]: row for row in rows(store, _WHOLE) if row["tolerance"]}
    before = None
    for tolerance in (1e-3, 1e-4, 1e-5):
        if tolerance not in result:
            continue
        error = result[tolerance]["orbit_relative"]
        is_met = error <= 10 * tolerance and (before is None or error < before)
        yield (
            f"orbit error at tolerance {tolerance:g}",
            "within a factor of 10, falling",
            f"{error:.1e} of the orbit's size",
            is_met,
        )
        before = error


def _scatter(store: Store) -> Iterator[Line]:
    runs = list(store.section("scatter").values())
    if not runs:
        return
    width = 0.0
    for peak in ("x_peak", "y_peak"):
        values = [run[peak] for run in runs]
        width = max(width, (max(values) - min(values)) / median(values))
    trapped = sum(run["trapped"] > 0 for run in runs)
    yield (
        f"{len(runs)} runs, unbalance phase differing by 1e-5 rad",
        "X and Y within 0.2 %, none in the false state",
        f"{100 * width:.3f} %, {trapped} in the false state",
        width < 0.002 and trapped == 0,
    )


def _process(store: Store) -> Iterator[Line]:
    process = store.section("process").get("warm")
    model = store.section("communication").get("0.04 s")
    if process:
        wall = median(process["wall_s"])
        yield (
            "through FMPy, process start to result, warm",
            "below 2.5 s",
            f"{wall:.2f} s",
            wall < 2.5,
        )
    if model:
        cpu = median(model["direct_cpu_s"])
        yield "of which the model", "below 0.5 s", f"{cpu:.2f} s", cpu < 0.5


def _growth(store: Store) -> Iterator[Line]:
    exponent = growth_exponent(store, OWN, 7, 70)
    if exponent is not None:
        yield (
            "cost of a step, 7 to 70 elements",
            "at most linear in the dofs",
            f"dofs to the power of {exponent:.2f}",
            exponent <= 1,
        )
