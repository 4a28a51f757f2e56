"""Options that several commands share."""

from __future__ import annotations

from typing import Annotated

import typer

Units = Annotated[
    str | None,
    typer.Option(
        help="Units shown: us, or words such as rpm,mil,pp; default: those of the machine file."
    ),
]
