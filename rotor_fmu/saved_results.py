"""Read what a path holds: a run, with its recording and its figures, or a study, with its rows."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .errors import InputError, optional
from .runs.recording import RECORDING, Recording, load_recording
from .studies.study import STUDY

if TYPE_CHECKING:
    import pyarrow


def is_study(path: Path) -> bool:
    """Return whether a folder is a study's."""
    return (path / STUDY).is_file()


def refuse_other(out: Path, other: str) -> None:
    """Raise `InputError` for a folder of results that holds what the other kind of result leaves,
    `RECORDING` or `STUDY`: of a folder with both, pages would show the study alone."""
    if (out / other).is_file():
        there, new = ("run", "study") if other == RECORDING else ("study", "run")
        raise InputError(
            f"--out {out}: holds a {there}, beside which no {new} can lie; name another folder"
        )


def read_run(path: Path) -> Recording:
    """Return the recording of a run's folder or file, in which the shaft's turns can be counted."""
    file = path / RECORDING if path.is_dir() else path
    if not file.exists():
        what = f"holds no {RECORDING}" if path.is_dir() else "is not there"
        raise InputError(f"{path}: {what}; give the folder of a run")
    recording = load_recording(file)
    recording.check_rotation()
    return recording


def read_summary(path: Path) -> dict[str, Any]:
    """Return the figures beside a run's recording, none where there are none."""
    file = (path if path.is_dir() else path.parent) / "summary.json"
    try:
        return json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise InputError(f"{file}: cannot be read") from error


def read_study(path: Path) -> "tuple[dict[str, Any], pyarrow.Table]":
    """Return what a study's folder says of it, and its rows, each once, in runs' order."""
    arrow_error = optional("pyarrow", "study", str(path)).ArrowException
    from .studies.store import about_of, read_rows

    try:
        return about_of(path), read_rows(path)
    except arrow_error as error:
        raise InputError(f"{path}: its rows cannot be read: {error}") from error


def rows_of_quantiles(about: dict[str, Any], rows: "pyarrow.Table") -> np.ndarray:
    """Return the rows of a study whose quantiles are meaningful for the varied parameters."""
    from .studies.analysis import design_of, drawn_rows, is_estimate

    design = design_of(about["design"])
    if not is_estimate(design):
        return np.zeros(0, int)
    return drawn_rows(design, rows["run"].to_numpy())


def with_unique_names(runs: Sequence[Recording], paths: Sequence[Path]) -> list[Recording]:
    """Return the runs under names that differ, longer where folders have the same name."""
    names = [run.name for run in runs]
    if len({*names}) < len(names):
        names = ["/".join(path.resolve().parts[-2:]) for path in paths]
    if len({*names}) < len(names):
        names = [f"{name} ({letter})" for name, letter in zip(names, "AB", strict=True)]
    return [run.named(name) for run, name in zip(runs, names, strict=True)]
