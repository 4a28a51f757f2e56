"""Options that several commands share, and what the shell offers to complete a word."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import InputError, writable_file

if TYPE_CHECKING:
    from ..model.machine.rotor import Rotor

_PAGE = b"<!doctype html>"  # with which every page begins

RotorFile = Annotated[
    Path | None, typer.Option("--rotor", help="Machine file; default: the rig of paper A.")
]
Free = Annotated[
    bool,
    typer.Option("--free", help="Use the FMU that is driven by a torque instead of its speed."),
]
Units = Annotated[
    str | None,
    typer.Option(
        help="Units shown: us, or words such as rpm,mil,pp; default: those of the machine file."
    ),
]
Contacts = Annotated[
    str | None,
    typer.Option(
        help="State of clearance contacts: open or pinned; default: open where other supports hold "
        "the machine, else pinned."
    ),
]
PictureFolder = Annotated[Path, typer.Option(help="Folder for the picture.")]
Page = Annotated[Path, typer.Option(help="The page to write.")]


def warned(machine: "Rotor", is_free: bool = False) -> list[str]:
    """Print and return the warnings about a packed machine; is_free: whether a torque drives it."""
    from ..linear.machine_warnings import machine_warnings

    warnings = machine_warnings(machine, is_free)
    for warning in warnings:
        typer.echo(f"warning: {warning}", err=True)
    return warnings


def check_count(count: int, most: int) -> None:
    """Raise `InputError` for a number of modes that cannot be."""
    if not 1 <= count <= most:
        raise InputError(f"--count {count}: must be from 1 to {most}")


def check_page(out: Path) -> None:
    """Raise `InputError` where no page can be written, or what is there is none."""
    writable_file(out, "the page's")
    if out.is_file():
        with out.open("rb") as file:
            begins = file.read(len(_PAGE))
        if begins and begins.lower() != _PAGE:
            raise InputError(f"--out {out}: is there already, and is no page; name another file")


def one_of(names: Iterable[str]) -> Callable[[str], list[str]]:
    """Return what completes a word to one of these names."""
    known = list(names)

    def complete(incomplete: str) -> list[str]:
        return [name for name in known if name.startswith(incomplete)]

    return complete


def settable(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the parameters and inputs of the machine that `--rotor` names, with what follows."""
    table = _table(ctx)
    return [f"{v.name}=" for v in table if not v.is_observed and v.name.startswith(incomplete)]


def _table(ctx: typer.Context) -> Any:
    from ..fmi.interface import interface
    from ..machine_file.loading import load_rotor

    given = ctx.params.get("rotor")
    try:
        return interface(load_rotor(Path(given) if given else None, lambda warning: None)[1])
    except InputError:
        return ()


def places(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the parts whose motion the run's recording holds."""
    from ..saved_results import read_run

    # what stands before an option without its value is not sorted into parameters yet
    run = ctx.params.get("run") or (ctx.args or ["."])[-1]
    try:
        names = [place.name for place in read_run(Path(run)).places]
    except InputError:
        return []
    return [name for name in names if name.startswith(incomplete)]
