"""`rotor-fmu page`."""

from pathlib import Path
from typing import Any

import typer

from ..display import choose
from ..files import write_text
from ..output_options import with_output_options
from .shared import Page, RotorFile, Units, check_page


@with_output_options
def page(
    rotor: RotorFile = None,
    units: Units = None,
    out: Page = Path("page.html"),
) -> dict[str, Any]:
    """Write a page on which the machine runs: its solver, sliders and pictures in one file, which
    needs no network."""
    # imported when it is called: the help needs none of it
    from ..fmi.packing.machine_files import machine_of
    from ..linear.machine_warnings import machine_warnings
    from ..live.live_page import solver_page
    from ..machine_file.loading import load_rotor

    toml, machine = load_rotor(rotor)
    choose(units, machine.units, rotor or "")
    check_page(out)
    warnings = machine_warnings(machine)
    for warning in warnings:
        typer.echo(f"warning: {warning}", err=True)
    write_text(solver_page(machine_of(toml, False, 0)), out)
    typer.echo(out)
    return {"out": out, "bytes": out.stat().st_size, "warnings": warnings}
