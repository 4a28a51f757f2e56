"""Tables of a benchmark's results, as a page of Markdown, with its pictures.

python -m benchmarks.report FOLDER --docs writes them anew from saved results, and puts the tables
that docs/explanation/performance.md and docs/development/benchmarks.md show into these pages.
"""

import re
from collections.abc import Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from rotor_fmu.errors import InputError, run

from .compare import OWN, own_front, ratio_to_own, rows
from .goals import goals
from .pictures import draw
from .store import Store, median

_DOCS = Path(__file__).parents[1] / "docs"
PAGES = (_DOCS / "explanation" / "performance.md", _DOCS / "development" / "benchmarks.md")
_TITLES = {
    "run-down": "The run-down",
    "beginning": "Its first 0.2 s, for programs too slow for the whole",
}


def write_report(store: Store, folder: Path) -> list[Path]:
    """`table.md` and the pictures in `folder`; returns what was written."""
    parts = ["# Benchmark", _measured_on(store), "## Goals", _goals_table(store)]
    parts += [_race(store, problem) for problem in _TITLES if store.section(problem)]
    parts += ["## A step", _step_cost_table(store)]
    parts += ["## Dissipation, fixed steps", _dissipation_table(store)]
    parts += ["## Larger machines, h = 0.1 ms", _growth_table(store)]
    parts += ["## Through the FMU, the default preset", _hosting_table(store)]
    page = folder / "table.md"
    page.write_text("\n\n".join(part for part in parts if part) + "\n", encoding="utf-8")
    return [store.path, page, *draw(store, folder)]


def filled_pages(store: Store, texts: Sequence[str]) -> list[str]:
    """Return pages whose parts between `<!-- NAME -->` and `<!-- end -->` are the tables so named,
    and whose figures are those of the results' day. Each table must have one place among them."""
    texts = [
        re.sub(r"(benchmarks/results/)[^/]+/", rf"\g<1>{store.about['date']}/", text)
        for text in texts
    ]
    parts = {
        "head": _measured_on(store),
        "goals": _goals_table(store),
        "run-down": _race_table(store, "run-down"),
        "beginning": _race_table(store, "beginning"),
        "dissipation": _dissipation_table(store),
        "larger machines": _growth_table(store),
        "hosting": _hosting_table(store),
    }
    for name, part in parts.items():
        place = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.S)
        count = sum(len(place.findall(text)) for text in texts)
        if count != 1:
            names = ", ".join(page.name for page in PAGES)
            raise ValueError(f"{names}: {count} places for {name!r}, must be one")
        texts = [place.sub(partial(_filled, part), text) for text in texts]
    return texts


def _filled(part: str, found: re.Match[str]) -> str:
    return f"{found[1]}\n{part}\n\n{found[2]}"


def table(head: Sequence[str], lines: Iterable[Sequence[str]]) -> str:
    """A Markdown table; columns after the first are right-aligned."""
    rule = ["---", *["---:"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in (head, rule, *lines))


def _measured_on(store: Store) -> str:
    about = store.about
    versions = ", ".join(f"{k} {v}" for k, v in about["versions"].items() if v)
    missing = store.section("missing").get("programs", {}).get("lines", [])
    text = (
        f"Measured on {about['date']}: {about['machine']}, one thread; Python {about['python']}, "
        f"{versions}. CPU times, medians of {about['runs']} runs in turns."
    )
    return "\n\n".join([text, *(f"Not run: {line}." for line in missing)])


def _goals_table(store: Store) -> str:
    lines = [
        (what, goal, measured, "yes" if is_met else "**no**")
        for what, goal, measured, is_met in goals(store)
    ]
    return table(("what", "goal", "measured", "met"), lines)


def _race_table(store: Store, problem: str) -> str:
    truth = store.section("reference")[problem]
    own = own_front(store, problem)
    lines = []
    for row in sorted(rows(store, problem), key=lambda r: (r["program"] != OWN, r["program"])):
        ratio = ratio_to_own(row, own)
        line = [
            f"{row['program']}, {row['setting']}",
            f"{row['orbit_max'] * 1e6:.3g}",
            f"{row['orbit_rms'] * 1e6:.2g}",
            _percent(row["x_peak_error"]),
            _percent(row["y_peak_error"]),
            f"{row['cpu']:.3g}",
            str(row["steps"]),
            f"{truth['stop'] / row['cpu']:.3g}",
            "" if row["program"] == OWN else "-" if ratio is None else f"{ratio:.1f}",
        ]
        lines.append(line)
    for name, row in store.section(problem).items():
        if row["failed"]:
            lines.append([name, row["failed"], *[""] * 7])
    head = [
        "program",
        "orbit error [µm]",
        "rms [µm]",
        "X [%]",
        "Y [%]",
        "CPU [s]",
        "steps",
        "simulated s per s of CPU",
        "CPU relative to this project",
    ]
    if truth["x_peak"] is None:
        lines, head = ([[*x[:3], *x[5:]] for x in lines], [*head[:3], *head[5:]])
    return table(head, lines)


def _race(store: Store, problem: str) -> str:
    truth = store.section("reference")[problem]
    peaks = ""
    if truth["x_peak"]:
        peaks = f"; X = {truth['x_peak'] * 1e6:.2f} µm, Y = {truth['y_peak'] * 1e6:.2f} µm"
    return (
        f"## {_TITLES[problem]}\n\n"
        f"{truth['stop']:g} s, last disc. Errors against CVODE of order 5 at rtol = 1e-8 "
        f"({truth['cpu_s']:.1f} s of CPU, {truth['steps']} steps{peaks}): the largest and the root "
        "mean square of the orbit's, and those of the peaks. Last column: CPU time relative to "
        "this project's at the same orbit error.\n\n" + _race_table(store, problem)
    )


def _percent(value: float | None) -> str:
    return "" if value is None else f"{100 * value:+.2f}"


def _step_cost_table(store: Store) -> str:
    lines = [
        (name, row["failed"] or f"{median(row['us']):.2f}")
        for name, row in store.section("step cost").items()
    ]
    return table(("program", "µs of CPU"), lines)


def _dissipation_table(store: Store) -> str:
    result = list(store.section("dissipation").values())
    steps = sorted({row["h"] for row in result}, reverse=True)
    lines = [
        (
            f"{rho:g}",
            *(
                f"{row['orbit_max'] * 1e6:.3g}"
                for h in steps
                for row in result
                if row["rho"] == rho and row["h"] == h
            ),
        )
        for rho in sorted({row["rho"] for row in result})
    ]
    return table(("rho", *(f"orbit error, h = {h * 1e3:g} ms [µm]" for h in steps)), lines)


def _growth_table(store: Store) -> str:
    result = store.section("growth").values()
    lines = [
        (
            row["program"],
            str(row["elements"]),
            str(row["bearings"]),
            str(row["dofs"]),
            row["failed"] or f"{median(row['us']):.1f}",
        )
        for row in sorted(
            result,
            key=lambda r: (r["program"], r["varied"] == "bearings", r["dofs"]),
        )
    ]
    head = ("program", "elements", "bearings", "dofs", "µs of CPU a step")
    return table(head, lines)


def _hosting_table(store: Store) -> str:
    lines = [
        (
            f"{row['step']:g}",
            f"{median(row['fmpy_cpu_s']):.2f}",
            f"{median(row['direct_cpu_s']):.2f}",
        )
        for row in store.section("communication").values()
    ]
    head = ("communication step [s]", "through FMPy [s of CPU]", "the model alone [s of CPU]")
    text = table(head, lines)
    starts = [
        (name, f"{median(row['wall_s']):.2f}", f"{median(row['cpu_s']):.2f}")
        for name, row in store.section("process").items()
    ]
    if starts:
        head = ("FMPy from the start of a process to the result", "wall [s]", "CPU [s]")
        text += "\n\n" + table(head, starts)
    memory = [(name, f"{row['peak'] / 1e6:.0f}") for name, row in store.section("memory").items()]
    if memory:
        text += "\n\n" + table(("peak memory of a process", "MB"), memory)
    return text


app = typer.Typer(add_completion=False)


@app.command()
def main(
    folder: Annotated[Path, typer.Argument(help="Folder of a benchmark's results.")],
    docs: Annotated[
        bool, typer.Option("--docs", help="Put them into the pages of docs/ that show them.")
    ] = False,
) -> None:
    """Write table and pictures anew from kept results."""
    try:
        store = Store.read(folder)
    except OSError as error:
        raise InputError(f"{folder}: no results there: {error.strerror}") from error
    for path in write_report(store, folder):
        print(path)
    if docs:
        texts = filled_pages(store, [page.read_text(encoding="utf-8") for page in PAGES])
        for page, text in zip(PAGES, texts, strict=True):
            page.write_text(text, encoding="utf-8")
            print(page)


if __name__ == "__main__":
    run(app)
