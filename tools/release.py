"""A release that is whole: make dist [HOME_URL=https://where/the/project/lies].

Source archive and wheel are made in dist/ of what is committed, the wheel with the libraries of the
solver that `rotor-fmu library` made, checked as an index checks them, installed into an environment
of their own, and used. With the address of the project's files, which an index page needs, the
README's pictures and links are pointed there.
"""

import re
import shutil
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).parents[1]
USE = """
import json, pathlib, subprocess, sys
bin = pathlib.Path(sys.executable).parent
subprocess.run([bin / "rotor-fmu", "run-down", "--stop", "1", "--out", "out"], check=True)
assert json.loads(pathlib.Path("out/summary.json").read_text())["status"] == "ok"
"""


def run(*command, cwd):
    """A command that must succeed."""
    subprocess.run([str(word) for word in command], cwd=cwd, check=True)


def committed(folder):
    """A copy of what is committed, without what git knows of it."""
    run("git", "clone", "--quiet", "--depth", "1", ROOT.as_uri(), folder, cwd=ROOT)
    shutil.rmtree(folder / ".git")


def point_at(home, page):
    """Make the relative links of a page absolute below an address."""
    text = page.read_text(encoding="utf-8")
    absolute = re.sub(r"\]\((?!https?:|#)([^)]+)\)", rf"]({home.rstrip('/')}/\1)", text)
    page.write_text(absolute, encoding="utf-8")


def release(home):
    """Make, check, install and use; fails at the first thing that does not hold."""
    with tempfile.TemporaryDirectory() as scratch:
        source = Path(scratch) / "source"
        committed(source)
        if home:
            point_at(home, source / "README.md")
        dist = ROOT / "dist"
        shutil.rmtree(dist, ignore_errors=True)
        run(sys.executable, "-m", "build", "--sdist", "--outdir", dist, ".", cwd=source)
        shutil.copytree(ROOT / "model" / "library", source / "model" / "library")
        run(sys.executable, "-m", "build", "--wheel", "--outdir", dist, ".", cwd=source)
        run(sys.executable, "-m", "twine", "check", "--strict", *dist.iterdir(), cwd=source)
        place = Path(scratch) / "installed"
        venv.create(place, with_pip=True)
        python = place / ("Scripts" if sys.platform == "win32" else "bin") / "python"
        (wheel,) = dist.glob("*.whl")
        run(python, "-m", "pip", "install", "--quiet", wheel, cwd=scratch)
        run(python, "-c", USE, cwd=scratch)
    for path in sorted(dist.iterdir()):
        print(f"{path.relative_to(ROOT)}  {path.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    release(*(sys.argv[1:] or [""]))
