"""What the shell offers when a word is completed."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import typer


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
    from ..errors import InputError
    from ..fmi.interface import interface
    from ..machine_file.loading import load_rotor

    given = ctx.params.get("rotor")
    try:
        return interface(load_rotor(Path(given) if given else None, lambda question: None)[1])
    except InputError:
        return ()


def places(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the parts whose motion the run's recording holds."""
    from ..errors import InputError
    from ..saved_results.folders import read_run

    try:
        names = [place.name for place in read_run(Path(ctx.params.get("run") or ".")).places]
    except InputError:
        return []
    return [name for name in names if name.startswith(incomplete)]
