"""The version of what a module computes: its source and that of all it imports of this project."""

import ast
import hashlib
import importlib.util
from functools import cache
from pathlib import Path

_OURS = ("rotor_fmu", "papers")


@cache
def source_digest(*modules: str) -> str:
    """Digest of the sources of these modules and, through their imports, of all they depend on."""
    digest = hashlib.sha256()
    for name, text in sorted(closure(modules).items()):
        digest.update(f"{name}\0{text}\0".encode())
    return digest.hexdigest()[:16]


@cache
def file_digest(path: str) -> str:
    """Digest of one file alone."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()[:16]


def closure(modules: tuple[str, ...]) -> dict[str, str]:
    """Sources of these modules and of all of this project's that they import, by name."""
    result: dict[str, str] = {}
    left, seen = list(modules), set[str]()
    while left:
        name = left.pop()
        if name in seen or name.split(".")[0] not in _OURS:
            continue
        seen.add(name)
        module = _module(name)
        if module is not None:
            result[name], imported = module
            left += imported
    return result


@cache
def _module(name: str) -> tuple[str, list[str]] | None:
    """Source of a module and what it imports; None of a name that is none, but of one in it."""
    try:
        spec = importlib.util.find_spec(name)
    except ModuleNotFoundError:
        return None
    if spec is None or spec.origin is None:
        return None
    text = Path(spec.origin).read_text(encoding="utf-8")
    package = name if spec.submodule_search_locations else name.rpartition(".")[0]
    return text, _imported(text, package)


def _imported(text: str, package: str) -> list[str]:
    names = []
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            parts = package.split(".")[: len(package.split(".")) + 1 - node.level]
            named = node.module or ""
            base = ".".join([*parts, named]).strip(".") if node.level else named
            names += [base, *(f"{base}.{alias.name}" for alias in node.names)]
    return names
