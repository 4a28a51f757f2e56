"""Files that are written whole or not at all."""

import csv
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from .errors import InputError

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


@contextmanager
def unfinished(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to, which takes its place when all is written; what ends the
    writing before, Ctrl-C too, leaves what was there and nothing else. An `OSError`, as of a full
    disk, is raised with the file's name, `InputError` where a folder, or a device, which a file
    would replace, has that name."""
    if path.exists() and not path.is_file():
        kind = "a folder" if path.is_dir() else "a device or a pipe"
        raise InputError(f"{path}: is {kind}, where a file of this name is to be written")
    # the suffix last: writers choose formats by it
    part = path.with_name(f"{path.stem}.part{path.suffix}")
    with named(path, str(part)):
        try:
            yield part
            part.replace(path)
        finally:
            part.unlink(missing_ok=True)


@contextmanager
def scratch_folder() -> Iterator[Path]:
    """A temporary folder; an `OSError` that names no file, as of a full disk, has its name."""
    with TemporaryDirectory(prefix="rotor_fmu_") as name, named(Path(name)):
        yield Path(name)


@contextmanager
def named(path: Path, *others: str) -> Iterator[None]:
    """Raise an `OSError` that names no file, or one of the others, with the name of a path."""
    try:
        yield
    except OSError as error:
        if error.filename in (None, *others):
            error.filename = str(path)
        raise


def write_csv(columns: Mapping[str, Iterable[float]], path: Path) -> None:
    """A CSV file of columns by their heads, whole or not at all."""
    with unfinished(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        for row in zip(*columns.values(), strict=True):
            writer.writerow([f"{value:.9g}" for value in row])


def write_text(text: str, path: Path) -> None:
    """A text file, whole or not at all."""
    with unfinished(path) as part:
        part.write_text(text, encoding="utf-8")


@contextmanager
def only_call(lock: Path) -> Iterator[None]:
    """Hold the lock of a folder, the file of this name in it, which ends with the process at the
    latest; raises `InputError` where another call holds it."""
    with lock.open("a") as file:
        try:
            if sys.platform == "win32":
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            else:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise InputError(f"--out {lock.parent}: another call is at work in it") from None
        yield
