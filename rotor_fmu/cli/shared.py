"""Options that several commands share."""

from pathlib import Path
from typing import Annotated

import typer

from ..errors import InputError, writable_folder

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


def check_count(count: int, most: int) -> None:
    """Raise `InputError` for a number of modes that cannot be."""
    if not 1 <= count <= most:
        raise InputError(f"--count {count}: must be from 1 to {most}")


def check_page(out: Path) -> None:
    """Raise `InputError` where no page can be written."""
    writable_folder(out.parent)
    if out.is_dir():
        raise InputError(f"--out {out}: is a folder; give the page's name in it")
