"""The files that a run leaves in its folder."""

import csv
from collections.abc import Mapping, Sequence
from pathlib import Path

from ..files import unfinished
from . import PLOTS
from .run_down import Run

# What a run leaves in its folder.
RESULTS = (
    *("summary.json", "recording.npz", "report.html"),
    *(f"run_{way}{rest}" for way in ("down", "up") for rest in (".csv", "_*.png")),
)


def clear(out: Path, results: Sequence[str] = RESULTS) -> None:
    """Remove what an earlier run left in its folder, its own files alone; results: patterns of
    their names. Pictures are of the recording that lies beside them."""
    if (out / "recording.npz").exists():
        results = (*results, *(f"{kind}.png" for kind in PLOTS))
    for pattern in results:
        for path in out.glob(pattern):
            path.unlink()


def write_csv(run: Run, units: Mapping[str, str], path: Path) -> None:
    """Every communication point: `time [s]`, then all that the model computes, with units."""
    heads = (f"{name} [{units[name]}]" if units[name] != "1" else name for name in run.columns)
    with unfinished(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", *heads])
        for row in zip(run.t.tolist(), *(c.tolist() for c in run.columns.values()), strict=True):
            writer.writerow([f"{value:.9g}" for value in row])
