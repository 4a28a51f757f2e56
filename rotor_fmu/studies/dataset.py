"""A study's folder as one xarray.Dataset."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from .store import read_rows
from .study import read_about

if TYPE_CHECKING:
    import pyarrow
    import xarray


def open_dataset(folder: Path) -> "xarray.Dataset":
    """Return the rows of a study, finished or not, along the dimension `run` in the order of the
    runs.

    Coordinates: `run`, the number; `id`; what is varied, each along `run`. Variables: `status`, and
    each column that is kept, lists along a dimension of their own; nan where a run failed.
    Attributes of these: `units` and `long_name`; of the whole: name, version, and the study's
    file. Raises `InputError` for a folder without a study.
    """
    import xarray

    about = about_of(folder)
    table = read_rows(folder)
    coordinates: dict[str, Any] = {
        "run": table["run"].to_numpy(),
        "id": ("run", table["id"].to_numpy(zero_copy_only=False).astype(str)),
    }
    for axis in about["design"]["axes"]:
        described = {"units": axis.get("unit", ""), "long_name": ", ".join(axis["targets"])}
        coordinates[axis["name"]] = ("run", table[axis["name"]].to_numpy(), described)
    status = table["status"].to_numpy(zero_copy_only=False).astype(str)
    variables: dict[str, Any] = {"status": ("run", status)}
    for column in about["columns"]:
        described = {"units": column["unit"], "long_name": column["text"]}
        name, dimension = column["name"], column["dimension"]
        if not dimension:
            variables[name] = ("run", table[name].to_numpy(), described)
            continue
        variables[name] = (
            ("run", dimension),
            _matrix(table[name], column["coordinate"]),
            described,
        )
        if column["coordinate"]:
            unit = {"units": column["coordinate_unit"]}
            coordinates[dimension] = (dimension, np.array(column["coordinate"]), unit)
    attributes = {key: about[key] for key in ("name", "version", "identity", "runs", "text")}
    return xarray.Dataset(variables, coordinates, attributes)


def about_of(folder: Path) -> dict[str, Any]:
    """Return the description of a folder's study; `InputError` if it holds none."""
    about = read_about(folder)
    if about is None:
        raise InputError(f"{folder}: holds no study")
    return about


def _matrix(column: "pyarrow.ChunkedArray", coordinate: list[float]) -> np.ndarray:
    """Return lists as rows, shape (runs, longest); nan where a run failed."""
    import pyarrow.compute as pc

    lengths = np.array([length or 0 for length in pc.list_value_length(column).to_pylist()])
    width = len(coordinate) or int(lengths.max(initial=0))
    matrix = np.full((len(column), width), np.nan)
    flat = column.combine_chunks().flatten().to_numpy(zero_copy_only=False)
    matrix[np.arange(width) < lengths[:, None]] = flat
    return matrix
