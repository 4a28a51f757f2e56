"""The project's files as they are checked out."""

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[1]


def names():
    """Of the project's files, as they are now: what git knows or would take."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return [name for name in listed.stdout.split("\0") if name and (ROOT / name).is_file()]


def lay_out(folder, but=()):
    """Copy what belongs to the project, but for names that begin as one of `but`."""
    for name in names():
        if not name.startswith(tuple(but)):
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, target)
