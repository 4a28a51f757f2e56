"""The rooms of the project and the imports between them: `python -m tests.house` prints them."""

from __future__ import annotations

import ast
import sys
from collections import Counter
from graphlib import TopologicalSorter
from pathlib import Path

ROOT = Path(__file__).parents[1]
PLACES = {"rotor_fmu.model": ROOT / "model", "rotor_fmu": ROOT / "rotor_fmu"}
MOST = 12  # modules in a folder


def modules() -> dict[str, Path]:
    """Every module of the project by its name."""
    found = {}
    for name, folder in PLACES.items():
        for file in folder.rglob("*.py"):
            parts = file.relative_to(folder).with_suffix("").parts
            found[".".join((name, *parts)).removesuffix(".__init__")] = file
    return found


def imports(name: str, file: Path, known: dict[str, Path]) -> set[str]:
    """The modules of the project that a module imports; what is for type checkers alone too."""
    package = name if file.name == "__init__.py" else name.rpartition(".")[0]
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                parts = package.split(".")
                up = parts[: len(parts) + 1 - node.level]
                base = ".".join([*up, base]).strip(".")
            found |= {base, *(f"{base}.{alias.name}" for alias in node.names)}
    return {module for module in found if module in known and module != name}


def room(name: str) -> str:
    """The room of a module: its folder, or itself where it stands between folders."""
    parts = name.split(".")
    depth = 3 if parts[:2] == ["rotor_fmu", "model"] else 2
    return ".".join(parts[:depth])


def arrows() -> Counter[tuple[str, str]]:
    """How many imports go from one room to another."""
    known = modules()
    counted: Counter[tuple[str, str]] = Counter()
    for name, file in known.items():
        for target in imports(name, file, known):
            pair = room(name), room(target)
            # a package's own name stands for what it holds
            if pair[0] != pair[1] and pair[1] not in ("rotor_fmu", "rotor_fmu.model"):
                counted[pair] += 1
    return counted


def order() -> list[str]:
    """The rooms from the ground up; raises `graphlib.CycleError` where arrows go round."""
    graph: dict[str, set[str]] = {}
    for above, below in arrows():
        graph.setdefault(above, set()).add(below)
    return list(TopologicalSorter(graph).static_order())


def sizes() -> dict[str, int]:
    """Modules in every folder, without their `__init__`."""
    counted: Counter[str] = Counter()
    for name, file in modules().items():
        if file.name != "__init__.py":
            counted[name.rpartition(".")[0]] += 1
    return dict(counted)


def mentions(word: str) -> list[str]:
    """Files of the project in which a word stands."""
    return sorted(
        str(file.relative_to(ROOT))
        for file in modules().values()
        if word in file.read_text(encoding="utf-8")
    )


def main() -> None:
    """Print rooms, arrows, and who mentions contacts by name."""
    for name, count in sorted(sizes().items()):
        print(f"{count:4d} modules  {name}")
    found = arrows()
    for side in ("rotor_fmu.model.", "rotor_fmu."):
        pairs = [(a, b) for a, b in found if a.startswith(side)]
        if side == "rotor_fmu.":
            pairs = [(a, b) for a, b in pairs if not a.startswith("rotor_fmu.model.")]
        print(
            f"{len(pairs):4d} arrows between rooms, {sum(found[p] for p in pairs)} imports: {side}"
        )
    print("from the ground up:", ", ".join(name.removeprefix("rotor_fmu.") for name in order()))
    for word in sys.argv[1:] or ["contacts"]:
        print(f"{len(mentions(word)):4d} files mention {word!r}: {', '.join(mentions(word))}")


if __name__ == "__main__":
    main()
