"""`rotor-fmu build` and `rotor-fmu core`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import InputError, RunFailed, writable_folder
from ..linear.doubts import doubts
from ..model.kernels.library import here
from ..packing.bundle import build as pack
from ..runs.command import Free, RotorFile
from ..runs.job import load_rotor
from ..telling import tells
from .core import PLATFORMS, CoreError, library
from .pack import build_native

Platforms = Annotated[
    list[str] | None,
    typer.Option(
        "--platform", help=f"One of {', '.join(PLATFORMS)}, or here: this machine's; default: all."
    ),
]

Native = Annotated[
    bool, typer.Option("--native", help="The FMU that needs no Python, RotorBearingNative.fmu.")
]
Fmi = Annotated[int, typer.Option("--fmi", help="With --native: the version of FMI, 2 or 3.")]
Reduction = Annotated[
    int,
    typer.Option(
        "--reduction",
        min=0,
        help="With --native: solver.reduction of the FMU, which a host cannot change.",
    ),
]


@tells
def build(
    rotor: RotorFile = None,
    is_free: Free = False,
    is_native: Native = False,
    fmi: Fmi = 2,
    platforms: Platforms = None,
    reduction: Reduction = 0,
    out: Annotated[Path, typer.Option(help="Folder for the FMU.")] = Path(),
) -> dict[str, Any]:
    """Build RotorBearing.fmu, RotorBearingFree.fmu, or one of both that needs no Python."""
    toml, machine = load_rotor(rotor)
    if not is_native and (fmi != 2 or platforms or reduction):
        raise InputError("--fmi, --platform and --reduction: only with --native")
    folder, found = writable_folder(out), doubts(machine)
    for doubt in found:
        typer.echo(f"warning: {doubt}", err=True)
    if is_native:
        fmu = build_without_python(toml, is_free, fmi, platforms, folder, reduction)
    else:
        fmu = pack(folder, toml, is_free)
    typer.echo(fmu)
    return {"fmu": fmu, "bytes": fmu.stat().st_size, "warnings": found}


@tells
def core(platforms: Platforms = None) -> dict[str, Any]:
    """Make the libraries of the solver, with which nothing has to be compiled to run or to build.

    Where they are missing a run compiles the solver, and a build of a native FMU makes them.
    """
    made = {name: _made(name) for name in _known(platforms)}
    for library_file in made.values():
        typer.echo(library_file)
    return made


def build_without_python(
    toml: str,
    is_free: bool,
    fmi: int,
    platforms: list[str] | None,
    out: Path,
    reduction: int = 0,
) -> Path:
    """`build_native`, with one line a library that has to be made first."""
    if fmi not in (2, 3):
        raise InputError(f"--fmi {fmi}: must be 2 or 3")
    names = _known(platforms)
    for name in names:
        _made(name)
    return build_native(out, toml, is_free, fmi, names, reduction)


def _known(platforms: list[str] | None) -> list[str]:
    mine = here()
    if platforms and "here" in platforms and mine is None:
        raise InputError("--platform here: there is no library for this machine")
    platforms = [mine if name == "here" and mine else name for name in platforms or ()]
    for name in platforms:
        if name not in PLATFORMS:
            raise InputError(f"--platform {name}: must be one of {', '.join(PLATFORMS)}")
    return platforms or list(PLATFORMS)


def _made(name: str) -> Path:
    try:
        return library(
            PLATFORMS[name], lambda: typer.echo(f"making the library for {name}", err=True)
        )
    except CoreError as error:
        raise RunFailed(str(error)) from error
