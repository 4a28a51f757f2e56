"""`python -m papers.ishikawa_koguchi`: paper B's experiments, its impact option on bearings."""

import math
from pathlib import Path
from typing import Annotated, Any

import typer

from rotor_fmu.errors import InputError, check_one_of, read_text, run
from rotor_fmu.output_options import with_output_options

from .cases import IMPACTS, PAPER_BARS, PAPER_RATCHET, cases, positive

# The experiments themselves are imported where they run: finite elements and pictures load slowly,
# and a user with bad input should not wait for them.

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    help="Paper B: two elastic bars, a ratchet, and its impact option on a rotor's bearings.",
)

BEARINGS = ("moderate-dissipation", "transient-fidelity", "newmark", "chung-hulbert=0.2")
BARS_DT, BARS_OPENING, BEARINGS_DT = (5e-5, 8e-4), (0.01, 0.02), (1e-3, 2.5e-4)

Schemes = Annotated[
    list[str] | None,
    typer.Option(
        "--scheme", help="NAME=PARAMETERS as in `papers.integrators schemes`, repeatable."
    ),
]
Steps = Annotated[
    list[float] | None, typer.Option("--dt", help="Time increment in seconds, repeatable.")
]
Impact = Annotated[
    str | None,
    typer.Option(
        help=f"One of {', '.join(IMPACTS)}; default: average-time for transient-fidelity, "
        "no for all others."
    ),
]
Cap = Annotated[int, typer.Option(help="Increments after which a run is given up.")]


@app.command("bars")
@with_output_options
def bars(
    scheme: Schemes = None,
    dt: Steps = None,
    opening: Annotated[
        list[float] | None, typer.Option(help="Between the bars in metres, repeatable.")
    ] = None,
    impact: Impact = None,
    mass: Annotated[str, typer.Option(help="lumped or consistent.")] = "lumped",
    penalty: Annotated[
        float | None,
        typer.Option(help="Stiffness of a node pair in N/m, in the place of the hard contact."),
    ] = None,
    elements: Annotated[tuple[int, int], typer.Option(help="Of each bar, along and across.")] = (
        40,
        4,
    ),
    density: Annotated[float, typer.Option(help="Of the bars in kg/m3.")] = 0.001,
    stop: Annotated[float, typer.Option(help="End of the run in seconds.")] = 0.04,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/bars"),
) -> dict[str, Any]:
    """Two elastic bars meet (paper B, 3.1): Figures 3 to 8 and the table of errors."""
    from .bars_cases import present

    if penalty is not None:
        if impact not in (None, "no"):
            raise InputError(f"--penalty {penalty:g}: needs --impact no; a penalty has no impulse")
        impact = "no"
    chosen = cases(scheme or PAPER_BARS, impact)
    steps = positive("--dt", dt or BARS_DT)
    positive("--stop", [stop])
    check_one_of(f"--mass {mass}", mass, ("lumped", "consistent"))
    options = {"is_lumped": mass == "lumped", "penalty": penalty, "density": density}
    options |= {"nx": elements[0], "ny": elements[1]}
    wants_figure_8 = scheme is None and dt is None and opening is None and penalty is None
    return present(chosen, steps, opening or BARS_OPENING, options, stop, wants_figure_8, out)


@app.command("ratchet")
@with_output_options
def ratchet(
    scheme: Schemes = None,
    dt: Annotated[float, typer.Option(help="Time increment in seconds.")] = 1e-5,
    impact: Impact = None,
    geometry: Annotated[
        Path | None, typer.Option(help="Ratchet as TOML; default: the one that comes with it.")
    ] = None,
    stop: Annotated[float, typer.Option(help="End of the run in seconds.")] = 0.03,
    cap: Cap = 10_000,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/ratchet"),
) -> dict[str, Any]:
    """A pawl in a ratchet wheel (paper B, 3.2): Figures 10 to 12, a drawing and an animation."""
    from .ratchet_cases import present

    chosen = cases(scheme or PAPER_RATCHET, impact)
    positive("--dt", [dt])
    positive("--stop", [stop])
    positive("--cap", [cap], "increments")
    text = None if geometry is None else read_text("--geometry", geometry)
    return present(chosen, dt, text, stop, cap, out)


@app.command("bearings")
@with_output_options
def bearings(
    scheme: Schemes = None,
    dt: Steps = None,
    rotor: Annotated[
        Path | None, typer.Option("--rotor", help="Machine file; default: the rig of paper A.")
    ] = None,
    speed: Annotated[float, typer.Option(help="At the start, in rad/s.")] = 200.0,
    rate: Annotated[float, typer.Option(help="Of the speed, in rad/s2.")] = -10.0,
    stop: Annotated[float, typer.Option(help="End of the run in seconds.")] = 0.3,
    cap: Cap = 10_000,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/bearings"),
) -> dict[str, Any]:
    """Paper B's impact option on a rotor whose bearings are hard stops."""
    from rotor_fmu.machine_file.loading import load_rotor

    from .bearings_cases import present

    chosen = cases(scheme or BEARINGS, "no")
    steps = positive("--dt", dt or BEARINGS_DT)
    positive("--stop", [stop])
    positive("--cap", [cap], "increments")
    for option, value in (("--speed", speed), ("--rate", rate)):
        if not math.isfinite(value):
            raise InputError(f"{option} {value:g}: must be finite")
    return present(chosen, steps, load_rotor(rotor)[1], (speed, rate), stop, cap, out)


if __name__ == "__main__":
    run(app)
