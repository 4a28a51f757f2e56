"""`rotor-fmu run-down`, `variables` and `host-env`."""

import sys
import sysconfig
import time
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NamedTuple

import typer

from ..display import choose
from ..errors import InputError, writable_folder
from ..model.message_templates import Message
from ..model.settings import PRESETS
from ..output_options import with_options_of, with_output_options, write_json
from ..run_status import NOT_CONFIRMED, has_failed
from ..units import in_si
from .shared import Free, RotorFile, Units, one_of, settable

if TYPE_CHECKING:
    from ..runs.job import Job
    from ..runs.recording import Recording
    from ..runs.run_down import Run

# What a command calls is imported when it is called: its help needs none of it.


def _run(
    is_up: bool,
    preset: Annotated[
        str | None,
        typer.Option(
            help=f"Preset of the solver, one of {', '.join(PRESETS)}.",
            autocompletion=one_of(PRESETS),
        ),
    ] = None,
    sets: Annotated[list[str] | None, typer.Option("--set", autocompletion=settable)] = None,
    signals: Annotated[Path | None, typer.Option("--input")] = None,
    first: Annotated[str | None, typer.Option("--from", metavar="SPEED")] = None,
    last: Annotated[str | None, typer.Option("--to", metavar="SPEED")] = None,
    rate: Annotated[str | None, typer.Option(metavar="RATE")] = None,
    hold: Annotated[str | None, typer.Option(metavar="TIME")] = None,
    stop: Annotated[str | None, typer.Option(metavar="TIME")] = None,
    step: Annotated[str | None, typer.Option(metavar="TIME")] = None,
    direct: bool = False,
    verify: bool = False,
    rotor: RotorFile = None,
    units: Units = None,
    out: Path | None = None,
) -> dict[str, Any]:
    """Make a run, write its results and return its figures.

    sets: Set a parameter, or an input that stays constant: NAME=VALUE, with or without unit;
        repeatable.
    signals: CSV file with a column for the time and one for each input that it gives, in SI units
        or the unit in brackets after its name.
    first: Speed at which the change begins, such as 3000rpm or 50Hz; default: of a run-down the
        machine's highest, of a run-up 0.
    last: Speed at which the change ends; default: of a run-down 0, of a run-up the machine's
        highest continuous one.
    rate: Rate of the speed, without sign, such as 100rpm/s or 2Hz/s, or in rad/s2; default: the
        machine's.
    hold: Time at the highest speed, before a run-down or after a run-up; default: none.
    stop: End of the run, in s or such as 2min; default: the last time of --input, or when the speed
        has changed.
    step: Communication step, in s or such as 0.5ms.
    direct: Run the model directly, without an FMU.
    verify: Repeat the run with a tenth of the tolerance or half the step, and compare.
    out: Folder for the results; default: out/ and the command.
    """
    from ..runs import job as jobs
    from ..runs.input_signals import RampGiven
    from ..runs.run_files import clear
    from ..runs.verify_run import finer_job
    from ..saved_results import refuse_other
    from ..studies.study import STUDY

    begun = time.perf_counter()
    kind = "run-up" if is_up else "run-down"
    name = kind.replace("-", "_")
    out = out or Path("out") / name
    ramp = RampGiven(is_up, first, last, rate, hold)
    end = None if stop is None else in_si("--stop", stop, "s")
    interval = None if step is None else in_si("--step", step, "s")
    job = jobs.prepare(rotor, preset, sets or [], signals, end, interval, ramp)
    choose(units, job.rotor.units)
    if verify:
        finer_job(job)  # refused before anything is run
    refuse_other(out, STUDY)
    writable_folder(out)
    fmu = None
    if not direct:  # else nothing is needed that builds one
        from ..fmi.packing.machine_files import machine_of
        from ..fmi.packing.python_fmu import fmu_in

        fmu = fmu_in(out, machine_of(job.toml, reduction=job.settings.reduction))
    outcome = _carry_out(job, fmu, f"{kind}, {preset or 'default'}", verify)
    clear(out)  # the results of an earlier run stay until there are others
    report = _write(outcome, preset, out, name)
    report["stop_s"] = job.stop
    by_input = "the end of the ramp" if signals is None else f"the last time of {signals}"
    report["stop_by"] = by_input if stop is None else "--stop"
    report["wall_s"] = time.perf_counter() - begun
    write_json(report, out / "summary.json")
    if stop is None and signals is not None:
        typer.echo(f"The run was to end at {job.stop:g} s, {report['stop_by']}.")
    _print(outcome, report, out)
    return report | {"out": str(out)}


class _Outcome(NamedTuple):
    """A run that was carried out: its result, the recording of the run without the FMU, by how much
    the latter ends apart from the FMU's, as a share of full scale, None without an FMU, and what
    the FMU that holds inputs does otherwise, nothing where that does not matter."""

    job: "Job"
    result: "Run"
    recording: "Recording"
    apart: float | None
    otherwise: str


def _carry_out(job: "Job", fmu: Path | None, label: str, verify: bool) -> _Outcome:
    """Make the run through the FMU, if there is one, and recorded without it."""
    from ..runs import job as jobs
    from ..runs.verify_run import apart_from_fmu, doubted, verified

    driven = None if fmu is None else jobs.execute(job, fmu, label)
    what, is_silent = f"{label}, recorded", driven is not None
    recorded, recording = jobs.execute_recorded(job, what, is_silent=is_silent)
    # an FMU holds its loads between two communication points
    is_held = job.signals.is_held(job.stop)
    result = driven if driven is not None and is_held else recorded
    if verify:
        said = len(recorded.messages)
        recorded, recording = verified(job, recorded, recording, f"{label}, finer")
        if "verification" in recording.about:
            messages = (*result.messages, *recorded.messages[said:])
            result = replace(result, status=recorded.status, messages=messages)
    apart = None if driven is None else jobs.difference(driven, recorded)
    otherwise = "" if driven is None else apart_from_fmu(job, driven, recorded)
    if otherwise and is_held and not has_failed(result.status):
        why = f"not confirmed: the run through the FMU {otherwise}, though it is the same"
        result, recording = doubted(result, recording, Message(why, NOT_CONFIRMED))
    return _Outcome(job, result, recording, apart, "" if is_held else otherwise)


def _write(outcome: _Outcome, preset: str | None, out: Path, name: str) -> dict[str, Any]:
    """Write CSV file, recording, pictures and page, and return the figures of the run."""
    from ..report.run_page import write_report
    from ..run_pictures.run_folder import write_run_pictures
    from ..runs.recording import RECORDING
    from ..runs.run_files import write_points
    from ..runs.summary import summary

    job, result, recording, apart, _ = outcome
    report = summary(result, recording=recording) | {
        "recorded_steps": len(recording.t),
        "recorded_apart": apart,
        "verification": recording.about.get("verification"),
    }
    write_points(result, {v.name: v.unit for v in job.table}, out / f"{name}.csv")
    recording.save(out / RECORDING)
    title = f"{job.rotor.name}, preset {preset}" if preset else job.rotor.name
    is_adaptive = job.settings.mode == "adaptive"
    write_run_pictures(result, recording, report, title, is_adaptive, out, name)
    write_report(recording, report, out / "report.html")
    return report


def _print(outcome: _Outcome, report: Mapping[str, Any], out: Path) -> None:
    from ..machine_file.loading import to_screen
    from ..runs.conclusions import sentences
    from ..runs.verify_run import table_of

    if outcome.otherwise:
        to_screen(
            f"the FMU, which holds its inputs over a communication step, {outcome.otherwise}; all "
            "results are of the run without it, whose inputs are exact"
        )
    page = out / "report.html"
    for sentence in sentences(report, outcome.recording, page if page.exists() else out):
        typer.echo(sentence)
    if report["verification"]:
        typer.echo(table_of(report["verification"]).text())


@with_output_options
@with_options_of(_run)
def run_down(**options: Any) -> dict[str, Any]:
    """Run a machine down from its highest speed, and write a summary, a CSV file and pictures.

    The speed falls as the table `operation` of the machine file says, or as the options do. The run
    is made by the built FMU; the pictures are drawn from the same run without it, recorded at the
    solver's own steps. With --verify the run is compared with the same run, solved more finely: the
    command shows peaks and final state of both, and its conclusion.
    """
    return _run(False, **options)


@with_output_options
@with_options_of(_run)
def run_up(**options: Any) -> dict[str, Any]:
    """Run a machine up to its highest speed, and write what `run-down` writes."""
    return _run(True, **options)


@with_output_options
def variables(rotor: RotorFile = None, is_free: Free = False) -> dict[str, Any]:
    """Print the FMU's variables as a Markdown table."""
    from ..fmi.interface import interface
    from ..fmi.packing.documents import markdown
    from ..machine_file.loading import load_rotor

    table = interface(load_rotor(rotor)[1], is_free)
    typer.echo(markdown(table), nl=False)
    return {variable.name: asdict(variable) for variable in table}


def host_environment() -> dict[str, str]:
    """Return the environment variables for a plain program that loads the FMU into itself, by name.

    The wrapper does not link Python's library, so it must be loaded before; and Python finds the
    packages of this environment by the `python` that is first in PATH. Raises `InputError` where
    Python has no shared library, or on other systems than Linux.
    """
    if not sys.platform.startswith("linux"):
        raise InputError(f"host-env: platform {sys.platform}: must be linux")
    folder = sysconfig.get_config_var("LIBDIR") or ""
    library = Path(folder, sysconfig.get_config_var("INSTSONAME") or "")
    if ".so" not in library.name or not library.is_file():
        raise InputError(
            f"host-env: {sys.executable}: must be a Python with a shared library (libpython3.*.so)"
        )
    return {"LD_PRELOAD": str(library), "PATH": f"{Path(sys.executable).parent}:$PATH"}


def host_env() -> None:
    """Print the environment that a C host needs to run the FMU on this machine."""
    for name, value in host_environment().items():
        typer.echo(f'export {name}="{value}"')
