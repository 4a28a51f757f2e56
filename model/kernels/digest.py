"""Digests of the kernels' sources, by which a library is identified.

A digest follows the syntax trees, without docstrings, of a module and of all modules of `model`
that it imports, directly or not. Comments, docstrings and layout change nothing. Parsing them takes
a quarter of a second, so each is parsed once, and a record beside each library stores the digest of
its files.
"""

import ast
import hashlib
import os
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from importlib.util import resolve_name
from pathlib import Path
from typing import Any, NamedTuple

from .cache import check_private, user_cache, warn_once

_MODEL = Path(__file__).parents[1]
_NAME = __name__.removesuffix(".kernels.digest")
# The modules of a library's functions.
_ENTRIES = ("time_loop", "periodic")
# The folder of libraries that a wheel contains, or that were made in a source tree.
CARRIED = _MODEL / "library"
_RECORD = "kernels.digest"
_DIGITS = 16
# Modules that locate compiled code without changing it.
_NO_KERNELS = (Path(__file__), Path(__file__).with_name("cache.py"))


def kernels_digest() -> str:
    """Return the digest of a run's kernels, sixteen characters, as they were at the first call."""
    return _digests()[1]


@cache
def _digests() -> tuple[str, str]:
    """Return the digests of the bytes of all files and of the syntax of the kernels."""
    files = files_digest()
    for folder in folders():
        with suppress(OSError, ValueError):
            of_files, of_kernels = (folder / _RECORD).read_text(encoding="ascii").split()
            if of_files == files:
                return files, of_kernels
    kernels = {
        file
        for package in _ENTRIES
        for file in imported(_MODEL / package / "entry_points.py", f"{_NAME}.{package}")
    }
    return files, syntax_digest(sorted(kernels, key=_path))


def made_here() -> Path:
    """Return the folder in the user's cache for libraries. Raises what `user_cache` raises."""
    return user_cache() / "native"


def folders() -> Iterator[Path]:
    """Yield the folders of libraries and their records."""
    yield CARRIED
    try:
        folder = made_here()
        if folder.is_dir():
            check_private(folder)
            yield folder
    except ImportError:
        return  # without platformdirs, which the extra that makes libraries brings, none was made
    except OSError as error:
        warn_once("library", f"libraries of the solver are not looked for: {error}")


def record(folder: Path) -> None:
    """Write the digest of the kernels into a folder, if it can be written to."""
    file = folder / _RECORD
    content = "{} {}\n".format(*_digests())
    with suppress(OSError):
        if not file.is_file() or file.read_text(encoding="ascii") != content:
            unfinished = file.with_suffix(f".{os.getpid()}.part")
            unfinished.write_text(content, encoding="ascii")
            unfinished.replace(file)


def files_digest() -> str:
    """Return the digest, sixteen characters, of every byte of the model's modules."""
    digest = hashlib.sha256()
    for file in sorted(_MODEL.rglob("*.py")):
        digest.update(_path(file) + b"\0" + file.read_bytes().replace(b"\r\n", b"\n") + b"\0")
    return digest.hexdigest()[:_DIGITS]


def syntax_digest(files: list[Path], before: str = "") -> str:
    """Return the digest, sixteen characters, of the syntax trees of modules."""
    digest = hashlib.sha256(before.encode())
    for file in files:
        digest.update(_path(file) + b"\0" + _parsed(file.read_bytes()).text + b"\0")
    return digest.hexdigest()[:_DIGITS]


class _Parsed(NamedTuple):
    """What a module's syntax tree says, as text without docstrings, and what it imports."""

    text: bytes
    imports: list[ast.Import | ast.ImportFrom]


@cache
def _parsed(source: bytes) -> _Parsed:
    tree = ast.parse(source)
    return _Parsed(_text(tree).encode(), [*_imports(tree)])


def _path(file: Path) -> bytes:
    """Return the path of a module within the package, wherever it is installed."""
    inside = file.is_relative_to(_MODEL)
    return (file.relative_to(_MODEL).as_posix() if inside else f"../{file.name}").encode()


def _text(node: object) -> str:
    """Return a syntax tree as text, the same in every version of Python: `ast.dump` shows fields
    that are empty in some."""
    if isinstance(node, ast.AST):
        fields = []
        for name in node._fields:
            value: Any = getattr(node, name, None)
            if name == "body" and isinstance(node, _DOCUMENTED) and ast.get_docstring(node, False):
                value = value[1:]
            if value is not None and value != []:
                fields.append(f"{name}={_text(value)}")
        return f"{type(node).__name__}({','.join(fields)})"
    if isinstance(node, list):
        return f"[{','.join(map(_text, node))}]"
    return repr(node)


_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


def imported(start: Path, package: str) -> list[Path]:
    """Return a module of `package` and those of the model that it imports, directly or not."""
    result, seen = {start}, set[str]()
    left = [(start, package)]
    while left:
        file, package = left.pop()
        names = {*_names(_parsed(file.read_bytes()).imports, package)} - seen
        seen |= names
        for module in {module for name in names for module in _modules(name)} - result:
            result.add(module)
            inside = module.parent.relative_to(_MODEL).parts
            left.append((module, ".".join((_NAME, *inside))))
    return sorted(result, key=_path)


def _imports(tree: ast.Module) -> Iterator[ast.Import | ast.ImportFrom]:
    """Yield a module's imports, also within functions, but not of types for type checkers alone."""
    nodes: list[ast.AST] = [tree]
    while nodes:
        node = nodes.pop()
        if isinstance(node, ast.expr):
            continue
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            nodes += node.orelse
            continue
        nodes += ast.iter_child_nodes(node)
        if isinstance(node, ast.Import | ast.ImportFrom):
            yield node


def _names(imports: list[ast.Import | ast.ImportFrom], package: str) -> Iterator[str]:
    """Yield the full names that are imported by a module of a package."""
    for node in imports:
        if isinstance(node, ast.ImportFrom):
            relative = "." * node.level + (node.module or "")
            name = resolve_name(relative, package) if node.level else relative
            yield name
            yield from (f"{name}.{alias.name}" for alias in node.names)
        else:
            yield from (alias.name for alias in node.names)


def _modules(name: str) -> Iterator[Path]:
    """Yield the model's files that run when a name is imported: its packages', and its own."""
    if name != _NAME and not name.startswith(f"{_NAME}."):
        return
    place = _MODEL
    parts = name.removeprefix(_NAME).split(".")[1:]
    for part in parts:
        if (place / "__init__.py").is_file():
            yield place / "__init__.py"
        place /= part
    for file in (place / "__init__.py", place.with_suffix(".py")):
        if file.is_file() and file not in _NO_KERNELS:
            yield file
