"""Files that are written whole or not at all."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def unfinished(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to, which takes its place when all is written; what ends the
    writing before, Ctrl-C too, leaves what was there and nothing else. An `OSError`, as of a full
    disk, is raised with the file's name."""
    # the suffix last: writers choose formats by it
    part = path.with_name(f"{path.stem}.part{path.suffix}")
    try:
        try:
            yield part
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        if error.filename in (None, str(part)):
            error.filename = str(path)
        raise


def write_text(text: str, path: Path) -> None:
    """A text file, whole or not at all."""
    with unfinished(path) as part:
        part.write_text(text, encoding="utf-8")
