"""The project's files as they are checked out, laid into another folder."""

import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[1]


def lay_out(folder, but=()):
    """Copy what belongs to the project, but for names that begin as one of `but`."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for name in filter(None, listed.stdout.split("\0")):
        if (ROOT / name).is_file() and not name.startswith(tuple(but)):
            target = folder / name
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(ROOT / name, target)
