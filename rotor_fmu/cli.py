"""`rotor-fmu`: the command line."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Annotated

import typer

from .about import __version__
from .drive_train.command import drive_train
from .errors import InputError, RunFailed, run, writable_folder
from .fmu.interface import interface
from .impact import command as impact_command
from .linear.command import COMMANDS as LINEAR
from .machine_file.command import schema_command
from .model.settings import PRESETS
from .native.command import Fmi, Native, Platforms, build_without_python, core
from .packing.bundle import build
from .packing.variable_table import markdown
from .packing.warm import warm
from .report.command import plot
from .runs.figures import write_run_down
from .runs.host_env import host_environment
from .runs.job import execute, fmu_in, load_rotor, prepare, write_csv, write_json
from .runs.reproduce import reproduce
from .runs.run_down import summary
from .runs.signals import RUN_DOWN_STOP
from .schemes.command import schemes
from .survey.command import survey

app = typer.Typer(
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
)

RotorFile = Annotated[
    Path | None, typer.Option("--rotor", help="Rotor as TOML; default: the paper's rig.")
]
Free = Annotated[
    bool, typer.Option("--free", help="The FMU that a torque drives, RotorBearingFree.fmu.")
]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", help="NAME=VALUE of a parameter, or of an input held constant."),
]


def main() -> None:
    """Entry point of the command `rotor-fmu`."""
    run(app)


def _tell_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"rotor-fmu {__version__}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_tell_version, is_eager=True, help="Which this is."),
    ] = False,
) -> None:
    """A flexible rotor that rubs in clearance bearings, as an FMI 2.0 co-simulation component."""


@app.command("run-down")
def run_down(
    preset: Annotated[str | None, typer.Option(help=f"One of {', '.join(PRESETS)}.")] = None,
    sets: Sets = None,
    signals: Annotated[
        Path | None, typer.Option("--input", help="CSV: time and inputs, SI units.")
    ] = None,
    stop: Annotated[float, typer.Option(help="End of the run, in seconds.")] = RUN_DOWN_STOP,
    step: Annotated[float | None, typer.Option(help="Communication step, in seconds.")] = None,
    direct: Annotated[bool, typer.Option("--direct", help="Without an FMU.")] = False,
    rotor: RotorFile = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/run_down"),
) -> None:
    """Drive the built FMU over the paper's run-down and write figures and pictures."""
    job = prepare(rotor, preset, sets or [], signals, stop, step)
    writable_folder(out)
    fmu = None if direct else fmu_in(out, job.toml)
    name = preset or "default"
    result = execute(job, fmu, f"run-down, {name}")
    report = summary(result)
    write_csv(result, out / "run_down.csv")
    write_run_down(result, report, name, job.settings.mode == "adaptive", out)
    write_json(report, out / "summary.json")
    for key, value in report.items():
        if key != "messages":
            typer.echo(f"{key:20s} {_shown(value)}")
    typer.echo(f"{'written to':20s} {out}")
    if result.status.startswith("failed"):
        raise RunFailed(f"the run stopped before its end: {result.status.removeprefix('failed: ')}")


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.5g}"
    if isinstance(value, list):
        return " .. ".join(_shown(item) for item in value)
    return "-" if value is None else str(value)


@app.command("reproduce")
def reproduce_command(
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/reproduce"),
) -> None:
    """Run what paper A ran, through the FMU: figures 3 to 6 and 9 to 15 and a table.

    Runs that an earlier, stopped call finished are taken from the folder.
    """
    reproduce(writable_folder(out), typer.echo)
    typer.echo((out / "table.md").read_text(encoding="utf-8"))


app.command("schemes")(schemes)
app.command("survey")(survey)
app.add_typer(impact_command.app, name="impact")
app.command("drive-train")(drive_train)
for answer in LINEAR:
    app.command(answer.__name__.replace("_", "-"))(answer)


@app.command("variables")
def variables(rotor: RotorFile = None, is_free: Free = False) -> None:
    """Print the FMU's variables as a Markdown table."""
    typer.echo(markdown(interface(load_rotor(rotor)[1], is_free)), nl=False)


@app.command("host-env")
def host_env() -> None:
    """Print the environment that a C host needs to run the FMU on this machine."""
    for name, value in host_environment().items():
        typer.echo(f'export {name}="{value}"')


@app.command("warm")
def warm_command(
    fmus: Annotated[
        list[Path] | None, typer.Argument(help="FMUs; default: one built from this version.")
    ] = None,
) -> None:
    """Compile the FMU's solver ahead of its first use on this machine."""
    with tempfile.TemporaryDirectory() as folder:
        for fmu in fmus or [build(Path(folder))]:
            seconds = warm(fmu)
            typer.echo(f"{fmu.name}: ready; a step from instantiation took {seconds:.1f} s")


app.command("plot")(plot)
app.command("core")(core)
app.command("schema")(schema_command)


@app.command("build")
def build_command(
    rotor: RotorFile = None,
    is_free: Free = False,
    is_native: Native = False,
    fmi: Fmi = 2,
    platforms: Platforms = None,
    out: Annotated[Path, typer.Option(help="Folder for the FMU.")] = Path(),
) -> None:
    """Build RotorBearing.fmu, RotorBearingFree.fmu, or one of both that needs no Python."""
    toml, _ = load_rotor(rotor)
    folder = writable_folder(out)
    if is_native:
        typer.echo(build_without_python(toml, is_free, fmi, platforms, folder))
    elif fmi != 2 or platforms:
        raise InputError("--fmi and --platform: only with --native")
    else:
        typer.echo(build(folder, toml, is_free))
