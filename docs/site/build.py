"""Make the site: python docs/site/build.py [FOLDER]; default: build/site.

README, ARCHITECTURE, CONTRIBUTING, CHANGELOG, docs/ and the examples' pages are copied into a tree
with the repository's layout, so that their links hold, and Sphinx makes HTML from it. A warning,
such as a broken link, is an error.
"""

import shutil
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).parents[2]
# the order to read them in
_TUTORIALS = ("beginner.md", "compressor.md", "drive_train.md")
_NOTEBOOKS = ("run_down.ipynb", "own_machine.ipynb", "coupling.ipynb", "study.ipynb")
_HOW_TO = (
    *("studies.md", "check_by_api_617.md", "from_ross.md", "from_xltrc2.md", "page.md"),
    *("native.md", "webassembly.md", "real_time.md", "couple_an_fmu.md", "choose_a_coupling.md"),
)
_EXPLANATION = (
    *("limitations.md", "validation.md", "performance.md", "integrators.md", "response.md"),
    *("signals.md", "oil_films.md", "rolling_bearings.md", "thermal_bow.md", "rub_laws.md"),
    "six_studies.md",
)
_PAPERS = ("reproduction.md", "impact.md")
SECTIONS = {
    "Tutorials": [f"docs/tutorials/{name}" for name in (*_TUTORIALS, *_NOTEBOOKS)],
    "How to": [f"docs/how_to/{name}" for name in _HOW_TO],
    "Examples": ["examples/*/README.md"],
    "Reference": ["docs/reference/*.md"],
    "Explanation": [f"docs/explanation/{name}" for name in _EXPLANATION],
    "Reproduced papers": [f"docs/explanation/{name}" for name in _PAPERS],
    "Development": [
        *("CONTRIBUTING.md", "ARCHITECTURE.md", "CHANGELOG.md"),
        *("docs/development/*.md", "docs/decisions/*.md"),
    ],
}
_COPIED = "copied"  # folder whose contents are copied to the site unchanged
# Machines that run on pages of the site: title, page name, machine file, run.
TRIED: tuple[tuple[str, str, str, dict[str, float]], ...] = (
    ("the run-down of the rig", "rig", "examples/paper_rig/rig.toml", {}),
    (
        "the drop of a compressor into its touchdown bearings",
        "drop",
        "examples/drop/compressor.toml",
        {"course.from": 400.0, "course.to": 380.0, "course.rate": 10.0},
    ),
)
_SHOWN = (".png", ".gif", ".svg", ".csv.gz", ".html")


def pages() -> list[Path]:
    """Return every page of the site except the first, in the order of its sections."""
    return [
        page for globs in SECTIONS.values() for glob in globs for page in sorted(ROOT.glob(glob))
    ]


def assemble(tree: Path) -> None:
    """Copy the pages and their figures into a tree with the repository's layout; add an index."""
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
    """Add pages that simulate the rig and the drop, and links to them on the first page."""
    from rotor_fmu.files import write_text
    from rotor_fmu.fmi.packing.machine_files import machine_of
    from rotor_fmu.live.live_page import solver_page

    folder = tree / _COPIED / "try"
    folder.mkdir(parents=True)
    for _, name, file, course in TRIED:
        toml = (ROOT / file).read_text(encoding="utf-8")
        write_text(solver_page(machine_of(toml), course), folder / f"{name}.html")
    links = " or ".join(f'<a href="try/{name}.html">{title}</a>' for title, name, _, _ in TRIED)
    index = tree / "index.md"
    before, heading, after = index.read_text("utf-8").partition("\n## ")
    tried = (
        f"\n**Try it in your browser**: {links}. Move a slider, and the run is computed again.\n"
    )
    index.write_text(before + tried + heading + after, encoding="utf-8")


def render(tree: Path, site: Path) -> int:
    """Make the site from a tree; return Sphinx' exit status."""
    from sphinx.cmd.build import build_main

    copied = ["-D", f"html_extra_path={_COPIED}"] if (tree / _COPIED).is_dir() else []
    options = ["--quiet", "--fail-on-warning", "--keep-going", *copied]
    return build_main([*options, str(tree), str(site)])


if __name__ == "__main__":
    site = Path(sys.argv[1]) if sys.argv[1:] else ROOT / "build" / "site"
    with tempfile.TemporaryDirectory() as folder:
        assemble(Path(folder))
        add_machines(Path(folder))
        sys.exit(render(Path(folder), site))
