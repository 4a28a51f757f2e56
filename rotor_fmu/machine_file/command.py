"""`rotor-fmu schema`: what a machine file may say."""

from __future__ import annotations

import json
from typing import Annotated

import typer

from .page import page
from .schema import schema


def schema_command(
    as_page: Annotated[bool, typer.Option("--page", help="as a page in Markdown")] = False,
) -> None:
    """Print what a machine file may say, as a JSON schema for editors or as a page."""
    print(page() if as_page else json.dumps(schema(), indent=2))
