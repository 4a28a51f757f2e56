"""Make the site: python docs/site/build.py [FOLDER]; default: build/site.

README, ARCHITECTURE, CONTRIBUTING, docs/ and the examples' pages are copied into a tree as the
repository's, so that their links hold; Sphinx makes HTML of it. A warning, such as a link to
nothing, is an error.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
_TUTORIALS = ("run_down", "own_machine", "coupling", "study")  # in the order to read them
SECTIONS = {
    "Tutorials": [f"docs/tutorials/{name}.ipynb" for name in _TUTORIALS],
    "How to": [
        f"docs/how_to/{name}.md" for name in ("studies", "oil_films", "native", "couple_an_fmu")
    ],
    "Examples": ["examples/*/README.md"],
    "Reference": ["docs/reference/*.md"],
    "Explanation": ["docs/explanation/*.md"],
    "Working on it": [
        *("CONTRIBUTING.md", "ARCHITECTURE.md", "docs/how_to/add_*.md"),
        *("docs/how_to/debug_a_kernel.md", "docs/decisions/*.md"),
    ],
}
_SHOWN = (".png", ".gif", ".svg", ".csv.gz", ".html")


def pages() -> list[Path]:
    """Every page of the site but the first, in the order of its sections."""
    return [
        page for globs in SECTIONS.values() for glob in globs for page in sorted(ROOT.glob(glob))
    ]


def assemble(tree: Path) -> None:
    """Copy pages and what they show into a tree as the repository's, with an index."""
    shown = [
        path
        for folder in ("docs", "examples", "benchmarks")
        for path in (ROOT / folder).rglob("*")
        if path.name.endswith(_SHOWN)
    ]
    for path in (*pages(), *shown):
        target = tree / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(path, target)
    shutil.copyfile(Path(__file__).with_name("conf.py"), tree / "conf.py")
    shutil.copyfile(ROOT / "README.md", tree / "index.md")
    with (tree / "index.md").open("a", encoding="utf-8") as index:
        for title, globs in SECTIONS.items():
            listed = [p for glob in globs for p in sorted(ROOT.glob(glob))]
            names = "\n".join(p.relative_to(ROOT).with_suffix("").as_posix() for p in listed)
            index.write(f"\n```{{toctree}}\n:hidden:\n:caption: {title}\n\n{names}\n```\n")


def render(tree: Path, site: Path) -> int:
    """Make the site of a tree; returns Sphinx' status."""
    sphinx = [sys.executable, "-m", "sphinx", "--quiet", "--fail-on-warning", "--keep-going"]
    return subprocess.run([*sphinx, str(tree), str(site)], check=False).returncode


if __name__ == "__main__":
    site = Path(sys.argv[1]) if sys.argv[1:] else ROOT / "build" / "site"
    with tempfile.TemporaryDirectory() as folder:
        assemble(Path(folder))
        sys.exit(render(Path(folder), site))
