"""The page of a study: a map whose points are runs, with what is known of each."""

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np

from ..display import Shown, current
from ..files import write_text
from ..run_status import OK
from ..runs.recording import RECORDING
from ..saved_results import read_run, read_summary
from ..studies.analysis import about_their_mean
from .packed import COARSE, packed
from .report_tables import notices_html, table
from .run_page import page, runs_page, template

if TYPE_CHECKING:
    import pyarrow

_MOST_RUNS = 20_000
_MOST_OF_CURVES = 1_500_000  # values
_MOST_REASONS = 5


def study_page(
    about: Mapping[str, Any],
    rows: "pyarrow.Table",
    pages: Mapping[str, str] | None = None,
    drawn: np.ndarray | None = None,
) -> str:
    """Return the page of a study as HTML.

    about: what its folder says of it (name, runs, design with its axes, columns); rows: a run each,
    with run, id, status, what was varied, and the metrics, each a number or a list; pages: of runs
    that were made again with their signals, addresses by id; drawn: the rows whose quantiles say
    something, none where the points were placed to be compared.
    """
    shown = np.unique(np.linspace(0, len(rows) - 1, min(len(rows), _MOST_RUNS)).astype(int))
    axes = [axis["name"] for axis in about["design"]["axes"]]
    retained = [column for column in about["columns"] if not column["dimension"]]
    varied = [
        {"name": axis["name"], "unit": axis.get("unit", ""), "text": "varied"}
        for axis in about["design"]["axes"]
    ]
    columns = [_head(column) for column in (*varied, *retained)]
    scales = {column["name"]: _shown_in(column["unit"]).factor for column in (*varied, *retained)}
    values = {n: np.asarray(rows[n].to_numpy(), float) for n in scales}
    for column in retained:
        if column.get("is_direction"):
            values[column["name"]] = about_their_mean(values[column["name"]])
    values = {n: scale * values[n] for n, scale in scales.items()}
    status = rows["status"].to_pylist()
    data = {
        "axes": axes,
        "columns": columns,
        "ids": [str(rows["id"][int(i)]) for i in shown],
        "status": [status[i] for i in shown],
        "pages": dict(pages or {}),
        "again": about.get("can_be_selected", True),
        "runs": rows["run"].to_numpy()[shown].tolist(),
        "values": {name: packed(column[shown]) for name, column in values.items()},
        "curves": _curves(about["columns"], rows, shown),
    }
    lists = [column["name"] for column in about["columns"] if column["dimension"]]
    left_out = [name for name in lists if name not in {curve["name"] for curve in data["curves"]}]
    body = template("study.html").substitute(
        notices=_notices(about, status, len(shown), left_out, _beyond(about, rows)),
        tables=_ranges(columns, values, np.arange(len(rows)) if drawn is None else drawn),
        hidden="" if data["curves"] else " hidden",
    )
    return page(
        title=str(about.get("name", "study")),
        about=f"{len(rows)} of {about.get('runs', len(rows))} runs, varied: {', '.join(axes)}",
        body=body,
        data=data,
        scripts=("study.js",),
    )


def _shown_in(unit: str) -> Shown:
    return Shown(1.0, "-") if unit == "1" else current().of_si(unit)


def _head(column: Mapping[str, Any]) -> dict[str, str]:
    unit = _shown_in(column["unit"]).unit
    return {"name": column["name"], "unit": unit, "text": column["text"]}


def _curves(
    columns: Sequence[Mapping[str, Any]], rows: "pyarrow.Table", shown: np.ndarray
) -> list[dict[str, Any]]:
    """Return lists along their coordinates, or counted from 1, as long as there is room."""
    from ..studies.store import matrix

    result, room = [], _MOST_OF_CURVES
    for column in columns:
        if not column["dimension"]:
            continue
        values = matrix(rows[column["name"]].take(shown), column["coordinate"])
        if not 0 < values.size <= room:
            continue
        room -= values.size
        # what is counted has no unit, such as held speeds that differ from run to run
        is_counted = not column["coordinate"]
        across, unit = _shown_in("1" if is_counted else column["coordinate_unit"])
        head: dict[str, Any] = _head(column)
        head |= {"dimension": column["dimension"], "coordinate_unit": unit}
        places = column["coordinate"] or range(1, values.shape[1] + 1)
        head["coordinate"] = [across * at for at in places]
        scale = _shown_in(column["unit"]).factor
        result.append(head | {"values": packed(scale * values, COARSE)})
    return result


def _beyond(about: Mapping[str, Any], rows: "pyarrow.Table") -> list[str]:
    """Return a sentence for each limit of the study that runs pass."""
    units, said = {column["name"]: column["unit"] for column in about["columns"]}, []
    for name, limit in about.get("limits", {}).items():
        values, shown = np.asarray(rows[name].to_numpy(), float), current().of_si(units[name])
        is_beyond = values < limit["value"] if limit["is_least"] else values > limit["value"]
        if count := int(is_beyond.sum()):
            sign = "<" if limit["is_least"] else ">"
            end = f"{shown.factor * limit['value']:.5g} {shown.unit if shown.unit != '1' else ''}"
            runs = "run" if count == 1 else "runs"
            said.append(f"{count} {runs} beyond a limit: {name} {sign} {end.rstrip()}")
    return said


def _notices(
    about: Mapping[str, Any],
    status: Sequence[str],
    shown: int,
    left_out: Sequence[str],
    beyond: Sequence[str] = (),
) -> str:
    said = [*beyond]
    whole = int(about.get("runs", len(status)))
    if len(status) < whole:
        said.append(f"The study goes on: {len(status)} of {whole} runs have their rows.")
    if shown < len(status):
        said.append(f"The map shows {shown} of {len(status)} runs, evenly taken.")
    if left_out:
        said.append(
            f"Without {', '.join(left_out)}: there are no values, or more than the page has room "
            "for."
        )
    reasons = Counter(text for text in status if text != OK)
    for text, count in reasons.most_common(_MOST_REASONS):
        said.append(f"{count} {'run' if count == 1 else 'runs'}: {text}")
    if len(reasons) > _MOST_REASONS:
        more = len(reasons) - _MOST_REASONS
        said.append(
            f"... and {more} more {'reason' if more == 1 else 'reasons'}; the map shows each."
        )
    return notices_html(said)


def _ranges(
    columns: Sequence[Mapping[str, str]], values: Mapping[str, np.ndarray], drawn: np.ndarray
) -> str:
    lines: list[list[object]] = []
    for column in columns:
        of_all = values[column["name"]]
        least, largest = _quantiles(of_all, [0, 1])
        between = _quantiles(of_all[drawn], [0.05, 0.5, 0.95])
        spread = [least, *between, largest]
        lines.append([column["name"], column["unit"] or "", *spread, column["text"]])
    heads = ["", "unit", "least", "5 %", "median", "95 %", "largest", ""]
    alone = f"; quantiles of the {len(drawn)} that are draws of their own"
    is_part = 0 < len(drawn) < max(map(len, values.values()))
    return table(f"all runs that have the value{alone if is_part else ''}", heads, lines)


def _quantiles(values: np.ndarray, shares: list[float]) -> list[float | None]:
    known = values[np.isfinite(values)]
    return np.quantile(known, shares).tolist() if len(known) else [None] * len(shares)


def pages_of_runs(study: Path, beside: Path) -> dict[str, str]:
    """Return the addresses of their pages by id, relative to the folder `beside`; a page older than
    its recording, or not there, is written."""
    result = {}
    for recording in sorted(study.glob(f"runs/*/{RECORDING}")):
        folder = recording.parent
        page = folder / "report.html"
        if not page.exists() or page.stat().st_mtime < recording.stat().st_mtime:
            write_text(runs_page([read_run(folder)], [read_summary(folder)]), page)
        result[folder.name] = quote(Path(os.path.relpath(page, beside)).as_posix())
    return result
