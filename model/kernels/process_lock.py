"""A lock among processes, which the system lifts when its holder ends. Standard library only."""

from __future__ import annotations

import os
import sys
from pathlib import Path

if sys.platform == "win32":
    import msvcrt

    def _lock(number: int) -> None:
        msvcrt.locking(number, msvcrt.LK_NBLCK, 1)
else:
    import fcntl

    def _lock(number: int) -> None:
        fcntl.flock(number, fcntl.LOCK_EX | fcntl.LOCK_NB)


# What the system says when another process holds the lock.
_TAKEN = (BlockingIOError, PermissionError)


class ProcessLock:
    """A lock on a file, which is made if need be and stays."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._number: int | None = None

    @property
    def is_held(self) -> bool:
        """Whether this process holds it."""
        return self._number is not None

    def take(self) -> bool:
        """Take the lock if it is free, at once; False if another process holds it.

        Raises `OSError` where there can be no lock, as in a folder that cannot be written.
        """
        number = os.open(self._path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o600)
        try:
            _lock(number)
        except BaseException as error:
            os.close(number)
            if isinstance(error, _TAKEN):
                return False
            raise
        self._number = number
        return True

    def release(self) -> None:
        """Give the lock back; nothing happens if it is not held."""
        number, self._number = self._number, None
        if number is not None:
            os.close(number)
