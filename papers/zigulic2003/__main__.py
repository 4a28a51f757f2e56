"""`python -m papers.zigulic2003`: what paper A ran, through the FMU."""

from pathlib import Path
from typing import Annotated, Any

import typer

from rotor_fmu.errors import run, writable_folder
from rotor_fmu.output_options import with_output_options

from .figures import write_figures
from .reproduce import figures_of
from .reproduce import reproduce as run_again

app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)


@app.command()
@with_output_options
def reproduce(
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/reproduce"),
) -> dict[str, Any]:
    """Run what paper A ran, through the FMU: figures 3 to 6 and 9 to 15 and a table.

    Runs that an earlier, stopped call finished are taken from the folder.
    """
    results = run_again(writable_folder(out), typer.echo)
    write_figures(results, out)
    typer.echo((out / "table.md").read_text(encoding="utf-8"))
    return {**figures_of(results), "out": str(out)}


if __name__ == "__main__":
    run(app)
