"""Files that are read back exactly as this user wrote them, or not at all. Standard library only.

What is kept here is run as machine code, so a file counts only if its checksum holds, if it was
written under the name that it has, and if nobody but its owner, this user or root, may write to it.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import stat
import tempfile
import time
from pathlib import Path

_MAGIC = b"sealed 1\n"
_SEAL = len(_MAGIC) + hashlib.sha256().digest_size
# Neither what a link names nor a pipe, which would wait for its writer.
_READ = os.O_RDONLY
for _flag in ("O_NOFOLLOW", "O_NONBLOCK", "O_BINARY"):
    _READ |= getattr(os, _flag, 0)
# A file that a killed process left unfinished is taken away after this time [s].
_UNFINISHED_AGE = 86400.0


def make_private(folder: Path) -> None:
    """Make `folder` for this user alone, or see that nobody else can write to the one there is.

    Raises `OSError` if it cannot be made, belongs to another user or is open to others.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    check_folder(folder)


def check_folder(folder: Path) -> None:
    """Raise `PermissionError` unless this user or root alone can write to a folder."""
    _check_owner(folder, folder.lstat(), stat.S_ISDIR)


def _check_owner(path: Path, about: os.stat_result, is_kind) -> None:
    """Raise `PermissionError` unless this user or root alone can write to `path`."""
    if not is_kind(about.st_mode):
        raise PermissionError(f"{path} is not a plain file or folder")
    if not hasattr(os, "geteuid"):
        return  # Windows: a user's folders are private by their access lists
    if about.st_uid not in (0, os.geteuid()):
        raise PermissionError(f"{path} belongs to another user")
    if about.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        mode = stat.S_IMODE(about.st_mode)
        raise PermissionError(f"{path} can be written by other users (mode {mode:o})")


class SealedFolder:
    """A private folder of sealed files.

    Raises `OSError` as `make_private` does.
    """

    def __init__(self, path: Path) -> None:
        make_private(path)
        self.path = path
        with contextlib.suppress(OSError):
            for unfinished in path.glob("*.part"):
                if time.time() - unfinished.stat().st_mtime > _UNFINISHED_AGE:
                    unfinished.unlink()

    def names(self, beginning: str) -> list[str]:
        """Names of the files that begin with `beginning`."""
        with contextlib.suppress(OSError):
            return sorted(p.name for p in self.path.iterdir() if p.name.startswith(beginning))
        return []

    def read(self, name: str) -> bytes | None:
        """Content of a file; None if it is not there or not to be trusted. A damaged one is taken
        away."""
        path = self.path / name
        try:
            with os.fdopen(os.open(path, _READ), "rb") as file:
                _check_owner(path, os.fstat(file.fileno()), stat.S_ISREG)
                data = file.read()
        except OSError:
            return None
        content = data[_SEAL:]
        if data[:_SEAL] != _seal(name, content):
            self.discard(name)
            return None
        return content

    def write(self, name: str, content: bytes) -> None:
        """Write a file whole or not at all; raises `OSError`."""
        number, unfinished = tempfile.mkstemp(suffix=".part", dir=self.path)
        try:
            with os.fdopen(number, "wb") as file:
                file.write(_seal(name, content))
                file.write(content)
            Path(unfinished).replace(self.path / name)
        except BaseException:
            with contextlib.suppress(OSError):
                Path(unfinished).unlink()
            raise

    def discard(self, name: str) -> None:
        """Take a file away if it is there and can be."""
        with contextlib.suppress(OSError):
            (self.path / name).unlink()


def _seal(name: str, content: bytes) -> bytes:
    return _MAGIC + hashlib.sha256(name.encode() + b"\0" + content).digest()
