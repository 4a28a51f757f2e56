"""The packages of the project, the imports between them, and the picture of ARCHITECTURE.md:
`python -m tools.architecture` prints the packages and writes `docs/figures/architecture.svg`."""

import ast
from collections import Counter
from functools import cache
from graphlib import TopologicalSorter
from html import escape
from pathlib import Path
from textwrap import shorten

ROOT = Path(__file__).parents[1]
PLACES = {"rotor_fmu.model": ROOT / "model", "rotor_fmu": ROOT / "rotor_fmu"}
PICTURE = ROOT / "docs" / "figures" / "architecture.svg"

# From the machine file to the FMU: functions in the order in which a build ends them, what each
# makes, and of what. A test follows a build and compares.
FLOW = (
    ("rotor_fmu.model.machine.toml", "parse_rotor", "machine: its parts", "machine.toml"),
    ("rotor_fmu.fmi.interface", "interface", "variables", "parts, settings"),
    ("rotor_fmu.library.build", "library", "solver library", "kernels, fmi/c"),
    ("rotor_fmu.fmi.description", "complete", "modelDescription.xml", "variables"),
    ("rotor_fmu.model.structure.reduction", "assembled", "matrices", "parts"),
    ("rotor_fmu.model.time_loop.block", "new_block", "block of memory", "matrices, settings"),
    ("rotor_fmu.fmi.machine_table", "table_bytes", "machine.table", "block, variables"),
    ("rotor_fmu.fmi.packing.archive", "write_archive", "RotorBearing.fmu", "all of these"),
)


@cache
def modules() -> dict[str, Path]:
    """Every module of the project by its name."""
    result = {}
    for name, folder in PLACES.items():
        for file in folder.rglob("*.py"):
            parts = file.relative_to(folder).with_suffix("").parts
            result[".".join((name, *parts)).removesuffix(".__init__")] = file
    return result


def imports(name: str, file: Path, known: dict[str, Path]) -> set[str]:
    """The modules of the project that a module imports; what is for type checkers alone too."""
    home = name if file.name == "__init__.py" else name.rpartition(".")[0]
    result = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            result |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = home.split(".")
                up = parts[: len(parts) + 1 - node.level]
                base = ".".join([*up, base]).strip(".")
            result |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return {module for module in result if module in known and module != name}


def package(name: str) -> str:
    """The package of a module: its folder, or itself where it stands between folders."""
    parts = name.split(".")
    depth = 3 if parts[:2] == ["rotor_fmu", "model"] else 2
    return ".".join(parts[:depth])


@cache
def arrows() -> Counter[tuple[str, str]]:
    """How many imports go from one package to another."""
    known = modules()
    counted: Counter[tuple[str, str]] = Counter()
    for name, file in known.items():
        for target in imports(name, file, known):
            pair = package(name), package(target)
            # a package's own name stands for what it holds
            if pair[0] != pair[1] and pair[1] not in ("rotor_fmu", "rotor_fmu.model"):
                counted[pair] += 1
    return counted


def order() -> list[str]:
    """The packages from the ground up; raises `graphlib.CycleError` where imports go round."""
    graph: dict[str, set[str]] = {}
    for above, below in sorted(arrows()):
        graph.setdefault(above, set()).add(below)
    return list(TopologicalSorter(graph).static_order())


def mentions(word: str) -> list[str]:
    """Files of the project in which a word stands."""
    return sorted(
        str(file.relative_to(ROOT))
        for file in modules().values()
        if word in file.read_text(encoding="utf-8")
    )


def summary(name: str) -> str:
    """The first sentence of a package's docstring."""
    text = ast.get_docstring(ast.parse(modules()[name].read_text(encoding="utf-8"))) or ""
    return " ".join(text.split("\n\n")[0].split())


_LEFT, _CELL, _WIDTH = 120, 19, 1120  # of the labels, of a cell of the matrix, of the picture
_TOP, _TEXT = 226, 90  # where the matrix begins; how many characters of a summary fit beside it
_STYLE = (
    "text{font:12px 'DejaVu Sans',sans-serif;fill:#222}.small{font-size:10px;fill:#555}"
    ".head{font-size:14px;font-weight:bold}"
    ".box{fill:#fff;stroke:#0072b2}.model{fill:#0072b2}.outer{fill:#d55e00}.grid{fill:#f0f0f0}"
    ".arrow{stroke:#777;fill:none;marker-end:url(#tip)}"
)


def picture() -> str:
    """The flow from machine file to FMU, and which package imports which, as SVG."""
    result, known = arrows(), modules()
    shown = [n for n in order() if known[n].name == "__init__.py"]
    shown.remove("rotor_fmu")
    shown.sort(key=lambda name: not name.startswith("rotor_fmu.model"))
    height = _TOP + _CELL * len(shown) + 20
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}">',
        f"<style>{_STYLE}</style>",
        '<defs><marker id="tip" viewBox="0 0 8 8" refX="8" refY="4" markerWidth="7" '
        'markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8z" fill="#777"/></marker></defs>',
        f'<rect width="{_WIDTH}" height="{height}" fill="#fff"/>',
        '<text class="head" x="10" y="20">From machine file to FMU</text>',
        *_drawn_flow(),
        f'<text class="head" x="10" y="{_TOP - 28}">Packages from the ground up, and which imports '
        "which</text>",
        f'<text class="small" x="10" y="{_TOP - 12}">Blue: model, orange: rotor_fmu. A dot: the '
        "row imports the package whose square stands in that column. Imports run one way: all dots "
        "lie to the left of their row's square.</text>",
    ]
    for row, name in enumerate(shown):
        y, x = _TOP + _CELL * row, _LEFT + _CELL * row
        label = name.rpartition(".")[2]
        lines += [
            f'<rect class="grid" x="{_LEFT}" y="{y}" width="{_CELL * row}" height="{_CELL - 1}"/>',
            f'<text text-anchor="end" x="{_LEFT - 6}" y="{y + 13}">{label}</text>',
            f'<rect class="{_colour(name)}" x="{x + 3}" y="{y + 3}" width="12" height="12"/>',
        ]
        lines += [
            f'<circle class="{_colour(below)}" cx="{_LEFT + _CELL * n + 9}" cy="{y + 9}" r="5"/>'
            for n, below in enumerate(shown)
            if (name, below) in result
        ]
        text = shorten(summary(name), _TEXT, placeholder=" ...")
        lines.append(
            f'<text class="small" x="{_LEFT + _CELL * len(shown) + 14}" y="{y + 13}">'
            f"{escape(text)}</text>"
        )
    return "\n".join([*lines, "</svg>"]) + "\n"


def _colour(name: str) -> str:
    """The class of a package's marks."""
    return "model" if name.startswith("rotor_fmu.model") else "outer"


def _drawn_flow() -> list[str]:
    """The steps of a build, in two lines from left to right."""
    lines, half, wide = [], len(FLOW) // 2, 210
    for n, (module, function, made, needs) in enumerate(FLOW):
        x, y = 115 + (n % half) * 270, 54 + 78 * (n // half)
        where = module.removeprefix("rotor_fmu.").replace(".", "/")
        lines += _box(x, y, wide, 52, (made, f"{where}: {function}", f"of {needs}"))
        if n % half:
            lines.append(
                f'<line class="arrow" x1="{x - 165}" y1="{y}" x2="{x - wide / 2 - 2:g}" y2="{y}"/>'
            )
        elif n:
            last = 115 + (half - 1) * 270
            lines.append(f'<path class="arrow" d="M{last} {y - 52}V{y - 39}H{x}V{y - 27}"/>')
    return lines


def _box(x: float, y: float, width: float, height: float, texts: tuple[str, ...]) -> list[str]:
    """A box about a point with lines of text in it."""
    left, top = x - width / 2, y - height / 2
    size = f'width="{width}" height="{height}"'
    lines = [f'<rect class="box" x="{left:g}" y="{top:g}" {size}/>']
    for n, text in enumerate(texts):
        at = y + 4 + 15 * (n - (len(texts) - 1) / 2)
        kind = ' class="small"' if n else ""
        lines.append(f'<text{kind} text-anchor="middle" x="{x:g}" y="{at:g}">{escape(text)}</text>')
    return lines


def main() -> None:
    """Print the packages from the ground up with what they import, and write the picture."""
    result = arrows()
    for name in order():
        below = sorted(b.removeprefix("rotor_fmu.") for a, b in result if a == name)
        print(f"{name.removeprefix('rotor_fmu.'):20s} {', '.join(below)}")
    PICTURE.write_text(picture(), encoding="utf-8")
    print(PICTURE)


if __name__ == "__main__":
    main()
