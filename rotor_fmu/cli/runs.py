"""`rotor-fmu run-down`, `variables` and `host-env`."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import writable_folder
from ..model.settings import PRESETS
from ..output_options import with_output_options
from ..runs.signals import RUN_DOWN_STOP

# What a command calls is imported when it is called: its help needs none of it.
RotorFile = Annotated[
    Path | None, typer.Option("--rotor", help="Machine file; default: the rig of paper A.")
]
Free = Annotated[
    bool,
    typer.Option("--free", help="Use the FMU that is driven by a torque, RotorBearingFree.fmu."),
]
Sets = Annotated[
    list[str] | None,
    typer.Option(
        "--set", help="Set a parameter, or an input that stays constant: NAME=VALUE; repeatable."
    ),
]


@with_output_options
def run_down(
    preset: Annotated[
        str | None, typer.Option(help=f"Preset of the solver, one of {', '.join(PRESETS)}.")
    ] = None,
    sets: Sets = None,
    signals: Annotated[
        Path | None,
        typer.Option(
            "--input",
            help="CSV file with a column for the time and one for each input, in SI units.",
        ),
    ] = None,
    stop: Annotated[float, typer.Option(help="End of the run, in seconds.")] = RUN_DOWN_STOP,
    step: Annotated[float | None, typer.Option(help="Communication step, in seconds.")] = None,
    direct: Annotated[
        bool, typer.Option("--direct", help="Run the model directly, without an FMU.")
    ] = False,
    verify: Annotated[
        bool,
        typer.Option(
            "--verify",
            help="Repeat the run with a tenth of the tolerance or half the step, and compare.",
        ),
    ] = False,
    rotor: RotorFile = None,
    out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/run_down"),
) -> dict[str, Any]:
    """Run down the built FMU as in paper A, and write a summary, a CSV file and pictures.

    The pictures are drawn from the same run without the FMU, recorded at the solver's own steps.
    With --verify the run is compared with the same run, solved more finely: the command shows peaks
    and final state of both, and its conclusion.
    """
    from ..report.page import write_report
    from ..report.verification import text_of
    from ..runs import job as jobs
    from ..runs.run_plots import write_run_down
    from ..runs.summary import summary
    from ..runs.verification import finer_job

    job = jobs.prepare(rotor, preset, sets or [], signals, stop, step)
    if verify:
        finer_job(job)  # refused before anything is run
    writable_folder(out)
    fmu = None if direct else jobs.fmu_in(out, job.toml, job.settings.reduction)
    jobs.clear(out)
    label = f"run-down, {preset or 'default'}"
    driven = None if fmu is None else jobs.execute(job, fmu, label)
    recorded, recording = jobs.execute_recorded(
        job, f"{label}, recorded", is_silent=driven is not None
    )
    # an FMU holds its loads between two communication points
    result = driven if driven is not None and job.signals.is_held else recorded
    if verify:
        recorded, recording = jobs.verified(job, recorded, recording, f"{label}, finer")
        if "verification" in recording.about:
            result = replace(result, status=recorded.status)
    report = summary(result) | {
        "recorded_steps": len(recording.t),
        "recorded_apart": driven and jobs.difference(driven, recorded),
        "verification": recording.about.get("verification"),
    }
    jobs.write_csv(result, out / "run_down.csv")
    recording.save(out / "recording.npz")
    name = f"Preset {preset}" if preset else "Default solver"
    write_run_down(result, recording, report, name, job.settings.mode == "adaptive", out)
    jobs.write_json(report, out / "summary.json")
    write_report(recording, report, out / "report.html")
    if apart := report["recorded_apart"]:
        why = "" if job.signals.is_held else ", which holds its inputs over a communication step"
        typer.echo(
            f"rotor-fmu: warning: the run recorded without the FMU ends {apart:.2g} of full scale "
            f"apart from the FMU's{why}; the pictures are of the recorded one",
            err=True,
        )
    for key, value in report.items():
        if key not in ("messages", "codes", "verification"):
            typer.echo(f"{key:20s} {_value_text(value)}")
    if report["verification"]:
        typer.echo(text_of(report["verification"]), nl=False)
    typer.echo(f"{'written to':20s} {out}")
    return report | {"out": str(out)}


def _value_text(value: object) -> str:
    if isinstance(value, float):
        return f"{value:.5g}"
    if isinstance(value, list):
        return " .. ".join(_value_text(item) for item in value)
    return "-" if value is None else str(value)


@with_output_options
def variables(rotor: RotorFile = None, is_free: Free = False) -> dict[str, Any]:
    """Print the FMU's variables as a Markdown table."""
    from ..fmi.interface import interface
    from ..fmi.packing.variable_table import markdown
    from ..runs.job import load_rotor

    table = interface(load_rotor(rotor)[1], is_free)
    typer.echo(markdown(table), nl=False)
    return {variable.name: asdict(variable) for variable in table}


def host_env() -> None:
    """Print the environment that a C host needs to run the FMU on this machine."""
    from ..runs.host_env import host_environment

    for name, value in host_environment().items():
        typer.echo(f'export {name}="{value}"')
