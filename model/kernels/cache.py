"""The user's cache folder, for libraries and for code compiled by numba."""

import logging
import os
import stat
from pathlib import Path

_log = logging.getLogger(__name__)
_said: set[str] = set()


def user_cache() -> Path:
    """Return the folder that the environment's ROTOR_FMU_CACHE names, or the platform's usual one.

    Raises `OSError` if there is neither, as for a user without a home, and `ImportError` without
    platformdirs.
    """
    chosen = os.environ.get("ROTOR_FMU_CACHE")
    if chosen:
        return Path(chosen).absolute()
    from platformdirs import user_cache_path

    try:
        return user_cache_path("rotor-fmu", appauthor=False)
    except RuntimeError as error:
        raise FileNotFoundError("this user has no home folder") from error


def private_folder(folder: Path) -> Path:
    """Make a folder for this user alone, or check that nobody else can write to the existing one:
    its files are run as machine code.

    Raises `OSError` if it cannot be made or written to, belongs to another user or is open to
    others.
    """
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    check_private(folder)
    if not os.access(folder, os.W_OK | os.X_OK):
        raise PermissionError(f"{folder} cannot be written to")
    return folder


def check_private(folder: Path) -> None:
    """Raise `PermissionError` unless only this user or root can write to a folder."""
    about = folder.lstat()
    if not stat.S_ISDIR(about.st_mode):
        raise PermissionError(f"{folder} is not a folder")
    if not hasattr(os, "geteuid"):
        return  # Windows: a user's folders are private by their access lists
    if about.st_uid not in (0, os.geteuid()):
        raise PermissionError(f"{folder} belongs to another user")
    if about.st_mode & (stat.S_IWGRP | stat.S_IWOTH):
        mode = stat.S_IMODE(about.st_mode)
        raise PermissionError(f"{folder} can be written by other users (mode {mode:o})")


def warn_once(subject: str, sentence: str) -> None:
    """Log the first warning about a subject, and ignore further ones."""
    if subject not in _said:
        _said.add(subject)
        _log.warning(sentence)
