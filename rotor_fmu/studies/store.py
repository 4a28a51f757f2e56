"""Rows of a study as Parquet parts in its folder, written aside and moved, so that each is whole;
read again as one xarray.Dataset.

FOLDER/study.json          what the study is
FOLDER/study.lock          held by the call that is at work
FOLDER/rows/*.parquet      rows, in no order; one that stands in two parts counts once
"""

import contextlib
import os
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError, RunFailed, writable_folder
from ..files import only_call
from ..output_options import write_json
from .study import STUDY, Result, Study, read_about

if TYPE_CHECKING:
    import pyarrow
    import xarray

_SMALL = 4 << 20  # parts below this are merged [bytes]
_MOST_SMALL = 64


def parts(folder: Path) -> list[Path]:
    """Return the parts that are there, in the order of their names."""
    return sorted((folder / "rows").glob("*.parquet"))


def read_part(path: Path, **options: Any) -> "pyarrow.Table":
    """Return the rows of a part; options: of `pyarrow.parquet.read_table`. Raises `InputError` for
    one that is damaged."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        return pq.read_table(path, **options)
    except pa.ArrowInvalid as error:
        raise InputError(
            f"{path}: is damaged; without it, the study makes its rows again"
        ) from error


def read_parts(folder: Path, **options: Any) -> "list[pyarrow.Table]":
    """Return the rows of all parts; options: of `pyarrow.parquet.read_table`. Where a call at work
    merges some of them meanwhile, they are listed again."""
    while True:
        with contextlib.suppress(FileNotFoundError):
            return [read_part(path, **options) for path in parts(folder)]


class Store:
    """The folder of a study, open to be written to; a context that holds its lock.

    Raises `InputError` for a folder of another study or one that another call is at work in, and
    `RunFailed` where a part cannot be written.
    """

    def __init__(self, folder: Path, study: Study) -> None:
        self._folder = folder
        self._study = study
        self._schema = schema_of(study)
        self._refuse_another()

    def __enter__(self) -> "Store":
        writable_folder(self._folder / "rows")
        with contextlib.ExitStack() as stack:
            stack.enter_context(only_call(self._folder / "study.lock"))
            self._begin()
            self._lock = stack.pop_all()
        return self

    def __exit__(self, *reason: object) -> None:
        self._lock.close()

    def _begin(self) -> None:
        self._refuse_another()
        try:
            write_json(self._study.about, self._folder / STUDY)
        except OSError as error:
            raise self._full(error) from error
        for left in (self._folder / "rows").glob("*.unfinished"):
            left.unlink()

    def _refuse_another(self) -> None:
        there = read_about(self._folder, "--out ")
        if there is None or there.get("identity") == self._study.identity:
            return
        theirs = f"{there.get('name')!r} by version {there.get('version')}"
        raise InputError(
            f"--out {self._folder}: holds another study, {theirs}; its machine, run, design or "
            "columns differ; name another folder"
        )

    def done(self) -> np.ndarray:
        """Return whether each run has its row, shape (runs,)."""
        is_done = np.zeros(len(self._study.design), dtype=bool)
        for part in read_parts(self._folder, columns=["run"]):
            is_done[part["run"].to_numpy()] = True
        return is_done

    def write(self, results: Mapping[int, Result]) -> None:
        """Write the rows of runs as a part of their own; results: by the runs' numbers."""
        import pyarrow as pa

        rows = []
        for number, result in results.items():
            point = self._study.design.point(number)
            run_id = self._study.row_id(self._study.design.settings(point))
            head = {"run": number, "id": run_id, "status": result.status}
            rows.append({**head, **point, **result.cells})
        self._put(pa.Table.from_pylist(rows, schema=self._schema))

    def merge_small(self, least: int = _MOST_SMALL) -> None:
        """Make one part of the small ones once there are `least`; a merge that is cut short leaves
        rows twice, never none."""
        import pyarrow as pa

        small = [path for path in parts(self._folder) if path.stat().st_size < _SMALL]
        if len(small) < least:
            return
        self._put(pa.concat_tables([read_part(path, schema=self._schema) for path in small]))
        for path in small:
            path.unlink()

    def _put(self, table: "pyarrow.Table") -> None:
        path = self._folder / "rows" / f"{uuid.uuid4().hex}.parquet"
        unfinished = path.with_suffix(".unfinished")
        try:
            write_part(table, unfinished)
            unfinished.replace(path)
        except OSError as error:
            with contextlib.suppress(OSError):
                unfinished.unlink(missing_ok=True)
            raise self._full(error) from error

    def _full(self, error: OSError) -> RunFailed:
        reason = error.strerror or str(error)
        return RunFailed(
            f"{self._folder}: cannot be written to: {reason}; what was written before is whole, "
            "and the same call goes on from there"
        )


def write_part(table: "pyarrow.Table", path: Path) -> None:
    """Write a table and wait until it is on the disk."""
    import pyarrow.parquet as pq

    with path.open("wb") as file:
        pq.write_table(table, file, compression="zstd")
        file.flush()
        os.fsync(file.fileno())


def schema_of(study: Study) -> "pyarrow.Schema":
    """Return the columns of the parts; cells of a failed run are null."""
    import pyarrow as pa

    fields = [pa.field("run", pa.int64()), pa.field("id", pa.string())]
    fields.append(pa.field("status", pa.string()))
    fields += [pa.field(axis.name, pa.float64()) for axis in study.design.axes]
    for column in study.model.columns:
        kind = pa.list_(pa.float64()) if column.dimension else pa.float64()
        fields.append(pa.field(column.name, kind))
    return pa.schema(fields)


def read_rows(folder: Path) -> "pyarrow.Table":
    """Return all rows, each once, in the order of the runs; `InputError` without a study."""
    import pyarrow as pa

    result = read_parts(folder)
    if not result:
        raise InputError(f"{folder}: holds no rows of a study")
    table = pa.concat_tables(result)
    _, first = np.unique(table["run"].to_numpy(), return_index=True)
    return table.take(pa.array(first))


def open_dataset(folder: Path) -> "xarray.Dataset":
    """Return the rows of a study, finished or not, along the dimension `run`, in order.

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
        variables[name] = (("run", dimension), matrix(table[name], column["coordinate"]), described)
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


def matrix(column: "pyarrow.ChunkedArray", coordinate: list[float]) -> np.ndarray:
    """Return lists as rows, shape (runs, longest); nan where a run failed."""
    import pyarrow.compute as pc

    lengths = np.array([length or 0 for length in pc.list_value_length(column).to_pylist()])
    width = len(coordinate) or int(lengths.max(initial=0))
    result = np.full((len(column), width), np.nan)
    flat = column.combine_chunks().flatten().to_numpy(zero_copy_only=False)
    result[np.arange(width) < lengths[:, None]] = flat
    return result
