"""Tables of a benchmark's results, as a page of Markdown, with its pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from .compare import OWN, own_front, ratio_to_own, rows
from .goals import goals
from .pictures import draw
from .store import Store, median

_TITLES = {
    "run-down": "The run-down",
    "beginning": "Its first 0.2 s, for programs too slow for the whole",
}


def write_report(store: Store, folder: Path) -> list[Path]:
    """`table.md` and the pictures in `folder`; returns what was written."""
    parts = [_head(store), _goals(store)]
    parts += [_race(store, problem) for problem in _TITLES if store.section(problem)]
    parts += [_step_cost(store), _growth(store), _hosting(store)]
    page = folder / "table.md"
    page.write_text("\n\n".join(part for part in parts if part) + "\n", encoding="utf-8")
    return [store.path, page, *draw(store, folder)]


def table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A Markdown table; columns after the first are right-aligned."""
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, rule, *lines))


def _head(store: Store) -> str:
    about = store.about
    versions = ", ".join(f"{k} {v}" for k, v in about["versions"].items() if v)
    missing = store.section("missing").get("programs", {}).get("lines", [])
    lines = [
        f"# Benchmark, {about['date']}",
        f"{about['machine']}; one thread; Python {about['python']}, {versions}. CPU times are "
        f"medians ({about['kind']}); `python -m benchmarks` makes this page.",
        *(f"Not run: {line}." for line in missing),
    ]
    return "\n\n".join(lines)


def _goals(store: Store) -> str:
    lines = [
        (what, goal, measured, "yes" if is_met else "**no**")
        for what, goal, measured, is_met in goals(store)
    ]
    return "## Goals\n\n" + table(("what", "goal", "measured", "met"), lines)


def _race(store: Store, problem: str) -> str:
    truth = store.section("reference")[problem]
    own = own_front(store, problem)
    lines = []
    for row in sorted(rows(store, problem), key=lambda r: (r["program"] != OWN, r["program"])):
        ratio = ratio_to_own(row, own)
        lines.append(
            (
                f"{row['program']}, {row['setting']}",
                f"{row['orbit_max'] * 1e6:.3g}",
                f"{row['orbit_rms'] * 1e6:.2g}",
                _percent(row["x_peak_error"]),
                _percent(row["y_peak_error"]),
                f"{row['cpu']:.3g}",
                f"{row['steps']}",
                f"{truth['stop'] / row['cpu']:.3g}",
                "" if row["program"] == OWN else "-" if ratio is None else f"{ratio:.1f}",
            )
        )
    for name, row in store.section(problem).items():
        if row["failed"]:
            lines.append((name, row["failed"], *[""] * 7))
    head = (
        "program",
        "orbit error [µm]",
        "rms [µm]",
        "X [%]",
        "Y [%]",
        "CPU [s]",
        "steps",
        "simulated s a s",
        "CPU of this project at its error",
    )
    peaks = ""
    if truth["x_peak"]:
        peaks = f"; X = {truth['x_peak'] * 1e6:.2f} µm, Y = {truth['y_peak'] * 1e6:.2f} µm"
    return (
        f"## {_TITLES[problem]}\n\n"
        f"{truth['stop']:g} s, last disc. Errors against CVODE of order 5 at rtol = 1e-8 "
        f"({truth['cpu_s']:.1f} s of CPU, {truth['steps']} steps{peaks}): the largest and the root "
        "mean square of the orbit's, and those of the peaks.\n\n" + table(head, lines)
    )


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100 * value:+.2f}"


def _step_cost(store: Store) -> str:
    lines = [
        (name, row["failed"] or f"{median(row['us']):.2f}")
        for name, row in store.section("step cost").items()
    ]
    return "## A step\n\n" + table(("program", "µs of CPU"), lines) if lines else ""


def _growth(store: Store) -> str:
    found = store.section("growth").values()
    lines = [
        (
            row["program"],
            str(row["elements"]),
            str(row["bearings"]),
            str(row["dofs"]),
            row["failed"] or f"{median(row['us']):.1f}",
        )
        for row in sorted(
            found,
            key=lambda r: (r["program"] != OWN, r["varied"] == "bearings", r["dofs"]),
        )
    ]
    head = ("program", "elements", "bearings", "dofs", "µs of CPU a step")
    return "## Larger machines, h = 0.1 ms\n\n" + table(head, lines) if lines else ""


def _hosting(store: Store) -> str:
    lines = [
        (
            f"{row['step']:g}",
            f"{median(row['fmpy_cpu_s']):.2f}",
            f"{median(row['direct_cpu_s']):.2f}",
        )
        for row in store.section("communication").values()
    ]
    if not lines:
        return ""
    head = ("communication step [s]", "through FMPy [s of CPU]", "the model alone [s of CPU]")
    text = "## Through the FMU, the default preset\n\n" + table(head, lines)
    process = store.section("process").get("fmpy")
    if process:
        text += (
            f"\n\nFrom the start of a process to the result, communication step 0.04 s: "
            f"{median(process['wall_s']):.2f} s ({median(process['cpu_s']):.2f} s of CPU)."
        )
    memory = [(name, f"{row['peak'] / 1e6:.0f}") for name, row in store.section("memory").items()]
    if memory:
        text += "\n\n## Peak memory of a process\n\n" + table(("program", "MB"), memory)
    return text
