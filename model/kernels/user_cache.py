"""The folder where this user's machine keeps what can be made again. Standard library only."""

from __future__ import annotations

import os
import sys
from pathlib import Path

_chosen: list[Path] = []


def keep_in(folder: Path) -> None:
    """Keep it in `folder` from now on, not in the platform's usual place."""
    _chosen[:] = [Path(folder).absolute()]


def user_cache() -> Path:
    """Folder for what can be made again: the one chosen, or the platform's usual place.

    Raises `OSError` if there is neither, as for a user without a home.
    """
    if _chosen:
        return _chosen[0]
    variable, usual = (
        ("LOCALAPPDATA", ("AppData", "Local"))
        if sys.platform == "win32"
        else ("XDG_CACHE_HOME", (".cache",))
    )
    base = os.environ.get(variable)
    try:
        return Path(base or Path.home().joinpath(*usual)) / "rotor-fmu"
    except RuntimeError as error:
        raise FileNotFoundError("this user has no home folder") from error
