"""The solver as a WebAssembly component, experimental: the draft of FMI's layered standard for
WebAssembly has it among an FMU's binaries. Made once for each version of the sources, in the user's
cache; a machine's table is put into its memory when an FMU is built.
"""

import hashlib
import shutil
import subprocess
import sys
from pathlib import Path

from ..errors import InputError
from ..files import scratch_folder
from ..model.kernels.digest import syntax_digest
from .build import (
    C_SOURCES,
    WASM,
    LibraryError,
    fmi_headers,
    kernels,
    link_module,
    made_once,
    missing_tool,
    objects,
    sources_digest,
)
from .platforms import COMPONENT
from .wasm_memory import with_data

_FOLDER = C_SOURCES.parent / "c_component"
_INTERFACES, _WORLD = _FOLDER / "fmi3.wit", "co-simulation-fmu"
_PACKAGE = "@bytecodealliance/jco"
# `component.c` includes FMI 3.0's functions; what asks a system for something is left out.
_LEFT_OUT = ("fmi2.c", "fmi3.c", "from_page.c", "system.c")
_FILE = f"library{COMPONENT.suffix}"


def component(table: bytes) -> bytes:
    """Return the component for the machine of a table. Raises what `empty_component` does."""
    return with_data(empty_component(), table)


def empty_component() -> bytes:
    """Return the component without a machine, made if there is none.

    Raises `InputError` where a tool that makes components is not there, and `LibraryError` where
    one fails.
    """
    digest = hashlib.sha256(sources_digest().encode())
    for file in sorted(_FOLDER.iterdir()):
        digest.update(file.name.encode() + b"\0" + file.read_bytes().replace(b"\r\n", b"\n"))
    version = syntax_digest([Path(__file__)], digest.hexdigest())
    return (made_once("component", version, lambda work: make(work / _FILE)) / _FILE).read_bytes()


def make(target: Path) -> None:
    """Write the component without a machine. Raises what `empty_component` does."""
    command = _tools()
    print(f"making the component for {COMPONENT.name}", file=sys.stderr, flush=True)
    emitted = kernels()
    with scratch_folder() as work:
        module = work / "module.wasm"
        sources = [file for file in C_SOURCES.glob("*.c") if file.name not in _LEFT_OUT]
        parts = [*sorted(sources), *sorted(_FOLDER.glob("*.c")), *objects(WASM, emitted, work)]
        folders = (f"-I{C_SOURCES}", f"-I{fmi_headers()}")
        options = (*folders, f'-DSOURCES="{sources_digest()}"')
        link_module(parts, module, options, f"the module for {COMPONENT.name}")
        done = subprocess.run(
            [*command, module, _INTERFACES, _WORLD, target],
            capture_output=True,
            text=True,
            check=False,
        )
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "rror" in line]
        reason = lines[0].strip() if lines else "no reason given"
        raise LibraryError(f"jco cannot make a component for {COMPONENT.name}: {reason}")


def _tools() -> list[str]:
    """Return the command that makes a component, without its arguments. Raises `InputError` where
    a tool is missing."""
    asked = f"--platform {COMPONENT.name}"
    node, jco = shutil.which("node"), _jco()
    if node is None or jco is None:
        tool = "jco" if jco is None else "node"
        raise InputError(
            f"{asked}: {tool}, which makes components, is not there: install Node.js and "
            f"npm install -g {_PACKAGE}"
        )
    if missing := missing_tool():
        raise InputError(f"{asked}: {missing} is not installed: pip install 'rotor-fmu[build]'")
    return [node, str(_FOLDER / "make_component.mjs"), jco]


def _jco() -> str | None:
    """Return the path of `jco`: on PATH, or installed by npm in this folder or one above it."""
    here = Path.cwd()
    local = [str(folder / "node_modules" / ".bin") for folder in (here, *here.parents)]
    places = (None, *local)
    return next((found for path in places if (found := shutil.which("jco", path=path))), None)
