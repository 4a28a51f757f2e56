"""Runs of a study that were made again with their signals: a page each, beside their recording."""

import os
from pathlib import Path
from urllib.parse import quote

from ..files import write_text
from ..report.run_page import runs_page
from .folders import RUN, read_run, read_summary


def pages_of_runs(study: Path, beside: Path) -> dict[str, str]:
    """Return the addresses of their pages by id, relative to the folder `beside`; a page older than
    its recording, or not there, is written."""
    result = {}
    for recording in sorted(study.glob(f"runs/*/{RUN}")):
        folder = recording.parent
        page = folder / "report.html"
        if not page.exists() or page.stat().st_mtime < recording.stat().st_mtime:
            write_text(runs_page([read_run(folder)], [read_summary(folder)]), page)
        result[folder.name] = quote(Path(os.path.relpath(page, beside)).as_posix())
    return result
