"""Build RotorBearing.fmu or, with --free, RotorBearingFree.fmu; with --native those that need no
Python: python build_fmu.py [--rotor FILE.toml] [--free] [--native [--fmi 3]] [--out DIR]."""

import typer

from rotor_fmu.cli.fmus import build
from rotor_fmu.errors import run

if __name__ == "__main__":
    app = typer.Typer(add_completion=False, pretty_exceptions_enable=False)
    app.command()(build)
    run(app)
