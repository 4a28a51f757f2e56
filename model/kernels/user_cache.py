"""Where this user's machine keeps what can be made again. Standard library only."""

from __future__ import annotations

import os
import sys
from pathlib import Path


def user_cache() -> Path:
    """Folder for what can be made again: $ROTOR_FMU_CACHE, or the platform's usual place."""
    chosen = os.environ.get("ROTOR_FMU_CACHE")
    if chosen:
        return Path(chosen)
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA") or str(Path.home() / "AppData" / "Local")
    else:
        base = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(base) / "rotor-fmu"
