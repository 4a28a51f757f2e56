"""Pictures of a benchmark's results."""

from collections.abc import Callable
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from rotor_fmu.plotting.colors import BLUE, GREEN, GREY, ORANGE
from rotor_fmu.plotting.figure_style import new_figure, save

from .compare import OWN, rows
from .growth import REDUCED
from .store import Store, median

# by program and the first words of its setting: (label, colour, marker)
_SERIES = {
    (OWN, "tolerance"): ("this project, error-controlled", BLUE, "o"),
    (OWN, "radau5"): ("this project, radau5", BLUE, "D"),
    (OWN, ""): ("this project, other modes", BLUE, "."),
    ("CVODE", "order 2"): ("CVODE, order 2", ORANGE, "s"),
    ("CVODE on 4 modes", ""): ("CVODE, order 2, on four modes", ORANGE, "o"),
    ("CVODE", "order 5"): ("CVODE, order 5", ORANGE, "D"),
    ("Exudyn", ""): ("Exudyn, generalized-alpha", GREEN, "^"),
    ("SciPy", "Radau"): ("SciPy, Radau", GREY, "v"),
    ("SciPy on 4 modes", "Radau"): ("SciPy, Radau, on four modes", GREY, "1"),
    ("scikit-sundae, IDA", ""): ("IDA, order 2", GREEN, "v"),
    ("scikit-sundae, IDA on 4 modes", ""): ("IDA, order 2, on four modes", GREEN, "1"),
    ("SciPy", "BDF"): ("SciPy, BDF", GREY, "<"),
    ("SciPy", "LSODA"): ("SciPy, LSODA", GREY, ">"),
    ("ROSS", ""): ("ROSS, Newmark", "black", "x"),
}


def draw(store: Store, folder: Path) -> list[Path]:
    """The pictures that the results allow."""
    result = []
    for problem, name in (
        ("run-down", "work_precision"),
        ("beginning", "work_precision_beginning"),
    ):
        if rows(store, problem):
            result.append(save(work_precision(store, problem), folder / f"{name}.png"))
    if any(row["x_peak_error"] is not None for row in rows(store, "run-down")):
        result.append(save(peaks(store), folder / "work_precision_peaks.png"))
    if store.section("growth"):
        result.append(save(growth(store), folder / "growth.png"))
    return result


def work_precision(store: Store, problem: str) -> Figure:
    """Error of the orbit against CPU time for a simulated second, a curve for each program."""
    what = "the run-down" if problem == "run-down" else "the first 0.2 s of the run-down"
    figure, axes = _against_work(store, problem, lambda row: row["orbit_max"] * 1e6)
    axes.set_xlabel("Largest error of the last disc's orbit [µm], smaller to the right")
    axes.set_title(f"Work against precision, {what}: lower is better", loc="left", fontsize=10)
    return figure


def peaks(store: Store) -> Figure:
    """Error of the peaks X and Y against CPU time for a simulated second."""
    figure, axes = _against_work(
        store,
        "run-down",
        lambda row: 100 * max(abs(row["x_peak_error"]), abs(row["y_peak_error"])),
    )
    axes.axvline(1.0, color=GREY, linewidth=1.0, linestyle=":")
    axes.set_xlabel("Larger error of the peaks X and Y [%], smaller to the right")
    axes.set_title("Work against the error of the peaks: lower is better", loc="left", fontsize=10)
    return figure


def _against_work(
    store: Store, problem: str, error: Callable[[dict], float]
) -> tuple[Figure, Axes]:
    figure, axes = new_figure(8.6, 4.4)
    stop = store.section("reference")[problem]["stop"]
    left = rows(store, problem)
    for (program, start), (label, colour, marker) in _SERIES.items():
        mine = [r for r in left if r["program"] == program and r["setting"].startswith(start)]
        left = [r for r in left if r not in mine]
        if not mine:
            continue
        points = sorted((error(r), r["cpu"] / stop) for r in mine)
        line = "none" if marker == "." else "-"
        x, y = zip(*points, strict=True)
        axes.loglog(x, y, linestyle=line, marker=marker, color=colour, label=label)
    axes.invert_xaxis()
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
    axes.set_ylabel("CPU time for a simulated second [s]")
    figure.legend(frameon=False, fontsize=8, loc="outside right upper")
    return figure, axes


def growth(store: Store) -> Figure:
    """Cost of a step against degrees of freedom."""
    figure, axes = new_figure()
    for program, colour, marker in ((OWN, BLUE, "o"), (REDUCED, BLUE, "."), ("Exudyn", GREEN, "^")):
        points = sorted(
            (row["dofs"], median(row["us"]))
            for row in store.section("growth").values()
            if row["program"] == program and row["varied"] == "elements" and row["us"]
        )
        if points:
            axes.loglog(*zip(*points, strict=True), "-", marker=marker, color=colour, label=program)
            if program == OWN:
                first = points[0]
                line = [(n, first[1] * n / first[0]) for n, _ in points]
                axes.loglog(*zip(*line, strict=True), ":", color=GREY, label="linear")
    dofs = sorted(
        {r["dofs"] for r in store.section("growth").values() if r["varied"] == "elements"}
    )
    axes.set_xticks(dofs, [f"{n}" for n in dofs])
    axes.set_xticks([], minor=True)
    axes.yaxis.set_major_formatter("{x:g}")
    axes.set_xlabel("Degrees of freedom")
    axes.set_ylabel("CPU time of a step [µs]")
    axes.set_title("A step of 0.1 ms of the rig in 7 to 200 elements", loc="left", fontsize=10)
    axes.legend(frameon=False)
    return figure
