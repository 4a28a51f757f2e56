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
_TEN_MINUTES = ("beginner", "compressor", "drive_train")
_HOW_TO = (
    *(
        "studies",
        "check_by_api_617",
        "native",
        "real_time",
        "page",
        "couple_an_fmu",
    ),
    *("choose_a_coupling", "from_ross", "from_xltrc2"),
)
SECTIONS = {
    "Tutorials": [
        *(f"docs/tutorials/{name}.md" for name in _TEN_MINUTES),
        *(f"docs/tutorials/{name}.ipynb" for name in _TUTORIALS),
    ],
    "How to": [f"docs/how_to/{name}.md" for name in _HOW_TO],
    "Examples": ["examples/*/README.md"],
    "Reference": ["docs/reference/*.md"],
    "Explanation": ["docs/explanation/*.md"],
    "Working on it": [
        *("CONTRIBUTING.md", "ARCHITECTURE.md"),
        *("docs/development/*.md", "docs/decisions/*.md"),
    ],
}
_COPIED = "copied"  # to the site as it is
# Machines that run on pages of the site: in words, the page's name, the machine file.
TRIED = (
    ("the rig that runs down", "rig", "examples/paper_rig/rig.toml", {}),
    (
        "a compressor that drops into its touchdown bearings",
        "drop",
        "examples/drop/compressor.toml",
        {"course.from": 400.0, "course.to": 380.0, "course.rate": 10.0},
    ),
)
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


def add_machines(tree: Path) -> None:
    """Add pages on which the rig and the drop run, and links to them on the first page."""
    from rotor_fmu.files import write_text
    from rotor_fmu.fmi.packing.machine_files import machine_of
    from rotor_fmu.live.live_page import solver_page

    folder = tree / _COPIED / "try"
    folder.mkdir(parents=True)
    for _, name, file, course in TRIED:
        toml = (ROOT / file).read_text(encoding="utf-8")
        write_text(solver_page(machine_of(toml, False, 0), course), folder / f"{name}.html")
    links = " or ".join(f'<a href="try/{name}.html">{title}</a>' for title, name, _, _ in TRIED)
    index = tree / "index.md"
    before, heading, after = index.read_text("utf-8").partition("\n## ")
    tried = (
        f"\n**Try it in your browser**: {links}; move a slider, and the run is computed again.\n"
    )
    index.write_text(before + tried + heading + after, encoding="utf-8")


def render(tree: Path, site: Path) -> int:
    """Make the site of a tree; returns Sphinx' status."""
    sphinx = [sys.executable, "-m", "sphinx", "--quiet", "--fail-on-warning", "--keep-going"]
    copied = ["-D", f"html_extra_path={_COPIED}"] if (tree / _COPIED).is_dir() else []
    return subprocess.run([*sphinx, *copied, str(tree), str(site)], check=False).returncode


if __name__ == "__main__":
    site = Path(sys.argv[1]) if sys.argv[1:] else ROOT / "build" / "site"
    with tempfile.TemporaryDirectory() as folder:
        assemble(Path(folder))
        add_machines(Path(folder))
        sys.exit(render(Path(folder), site))
