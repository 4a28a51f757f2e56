"""The files that a run leaves in its folder."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from ..cells import column_head
from ..files import write_csv
from . import PLOTS
from .recording import RECORDING
from .run_down import Run

# What a run leaves in its folder.
RESULTS = (
    *("summary.json", RECORDING, "report.html"),
    *(f"run_{way}{rest}" for way in ("down", "up") for rest in (".csv", "_*.png")),
)


def clear(out: Path, results: Sequence[str] = RESULTS) -> None:
    """Remove what an earlier run left in its folder, its own files alone; results: patterns of
    their names. Pictures are of the recording that lies beside them."""
    if (out / RECORDING).exists():
        results = (*results, *(f"{kind}.png" for kind in PLOTS))
    for pattern in results:
        for path in out.glob(pattern):
            path.unlink()


def write_points(run: Run, units: Mapping[str, str], path: Path) -> None:
    """Every communication point: `time [s]`, then all that the model computes, with units."""
    columns = {"time [s]": run.t.tolist()}
    for name, column in run.columns.items():
        columns[column_head(name, units[name])] = column.tolist()
    write_csv(columns, path)
