"""A run as the user specified it: checked before anything is written, then carried out."""

from __future__ import annotations

import csv
import difflib
import math
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ..errors import InputError
from ..files import unfinished, write_text
from ..fmi.binding import build_simulation
from ..fmi.interface import interface
from ..fmi.solver_parameters import (
    AS_PRESET,
    PREFIX,
    REDUCTION,
    chosen_at_build,
    settings_of,
)
from ..fmi.variables import Variable
from ..machine_file.loading import machine_text
from ..machine_file.plausibility import questions
from ..model.machine.rotor import Rotor
from ..model.machine.toml import parse_rotor, rig_toml
from ..model.quantities import QuantityError
from ..model.settings import PRESETS, Settings, SettingsError
from ..model.simulation import EquilibriumError
from ..output_options import json_text
from ..run_status import FAILED, with_doubt
from ..units import in_si, split
from . import PLOTS
from .input_signals import Signals, make_signals, read_signals
from .progress import shown
from .ramp import RampGiven
from .recording import Recording
from .run_down import Plan, Run, run_direct, run_fmu, run_recorded

# What a run leaves in its folder.
RESULTS = (
    *("summary.json", "recording.npz", "report.html"),
    *(f"run_{way}{rest}" for way in ("down", "up") for rest in (".csv", "_*.png")),
)
_MOST_ROWS = 2e6


def _to_screen(question: str) -> None:
    print(f"rotor-fmu: warning: {question}", file=sys.stderr, flush=True)


def load_rotor(path: Path | None, ask: Callable[[str], None] = _to_screen) -> tuple[str, Rotor]:
    """Return TOML text and rotor of a file, or of the paper's rig; `InputError` for an impossible
    one; ask: takes the questions about values that nobody means."""
    text = rig_toml() if path is None else machine_text("--rotor", path)
    try:
        rotor = parse_rotor(text)
        asked = questions(rotor)
    except QuantityError as error:
        raise InputError(f"{path}: {error}" if path else str(error)) from error
    for question in asked:
        ask(f"{path}: {question}" if path else question)
    return text, rotor


def parse_settings(table: Sequence[Variable], settings: Sequence[str]) -> dict[str, float]:
    """Return the values by name from `NAME=VALUE` texts; choices may be given by number or by name.

    Raises `InputError` for an unknown name and for a value that the variable cannot have.
    """
    known = {v.name: v for v in table if not v.is_observed}
    values = {}
    for text in settings:
        name, equals, value = (part.strip() for part in text.partition("="))
        if not equals:
            raise InputError(f"--set {text}: must be NAME=VALUE")
        observed = next((v for v in table if v.is_observed and v.name == name), None)
        if observed is not None:
            raise InputError(f"--set {name}: is an output, which the model computes")
        if name not in known:
            near = difflib.get_close_matches(name, known, 3, 0.5) or sorted(known)[:3]
            raise InputError(f"--set {name}: unknown name; did you mean {', '.join(near)}?")
        variable = known[name]
        values[name] = _parse_value(variable, value)
        if variable.is_unset_at_start and values[name] == variable.start:
            raise InputError(
                f"--set {name} = {value}: means {AS_PRESET} and changes nothing; leave it out"
            )
    return values


def parse_starts(rotor: Rotor, is_free: bool, settings: Sequence[str]) -> dict[str, float]:
    """Return the start values of the solver's parameters, and of the FMU's other choices, from
    `NAME=VALUE` texts.

    Raises `InputError` for another parameter, and for settings that cannot be together.
    """
    if not settings:
        return {}
    table = [v for v in interface(rotor, is_free) if v.choices or v.name.startswith(PREFIX)]
    values = parse_settings(table, settings)
    if REDUCTION.name in values:
        raise InputError(f"--set {REDUCTION.name}: is chosen by --reduction")
    try:
        chosen_at_build(table, 0, None, values)
    except SettingsError as error:
        raise InputError(f"--set {error}") from error
    return values


def _parse_value(variable: Variable, text: str) -> float:
    if variable.kind == "Boolean":
        allowed = {"true": True, "false": False, "1": True, "0": False}
        if text.lower() not in allowed:
            raise InputError(f"--set {variable.name} = {text}: must be true or false")
        return allowed[text.lower()]
    if variable.choices:
        if text in variable.choices:
            return variable.choices.index(text)
        if text.isdecimal() and int(text) < len(variable.choices):
            return int(text)
        listed = ", ".join(f"{i} {name}" for i, name in enumerate(variable.choices))
        raise InputError(f"--set {variable.name} = {text}: must be one of {listed}")
    parts = split(text)
    if parts and parts[1]:
        value = in_si(f"--set {variable.name} =", text, variable.unit)
        text = f"{value:g}"
    else:
        try:
            value = float(text)
        except ValueError:
            raise InputError(f"--set {variable.name} = {text}: must be a number") from None
    low = float("-inf") if variable.low is None else variable.low
    high = float("inf") if variable.high is None else variable.high
    if not low <= value <= high or value in (float("inf"), float("-inf")):
        unit = "" if variable.unit == "1" else f" {variable.unit}"
        limit = f" from {low:g} to {high:g}{unit}" if variable.high is not None else f" >= {low:g}"
        bound = "finite" if variable.low is None else f"a finite number{limit}"
        raise InputError(f"--set {variable.name} = {text}{unit}: must be {bound}")
    return value


@dataclass(frozen=True)
class Job(Plan):
    """A run that was checked and can begin: a plan, the rotor (also as TOML) and its settings."""

    toml: str
    rotor: Rotor
    settings: Settings


def prepare(
    rotor_file: Path | None,
    preset: str | None,
    sets: Sequence[str],
    signal_file: Path | None,
    stop: float | None,
    step: float | None,
    ramp: RampGiven | None = None,
) -> Job:
    """Check everything that a user gave before anything is written or run; stop: by default the
    ramp's end; ramp: by default the machine's run-down."""
    toml, rotor = load_rotor(rotor_file)
    table = interface(rotor)
    followed = (ramp or RampGiven()).on(rotor)
    if stop is None:
        stop = followed.end
    if not 0 < stop < float("inf"):
        raise InputError(f"--stop {stop:g} s: must be > 0 and finite")
    if step is not None and not 0 < step <= stop:
        raise InputError(f"--step {step:g} s: must be > 0 and at most --stop = {stop:g} s")
    if preset is not None:
        if preset not in PRESETS:
            near = difflib.get_close_matches(preset, PRESETS, 1)
            meant = f"; did you mean {near[0]}?" if near else ""
            raise InputError(f"--preset {preset}: must be one of {', '.join(PRESETS)}{meant}")
        sets = [f"solver.preset={preset}", *sets]
    _check_rows(stop, step, len(table))
    values = parse_settings(table, sets)
    inputs = {v.name for v in table if v.causality == "input"}
    constants = {name: value for name, value in values.items() if name in inputs}
    recorded = read_signals(signal_file, table) if signal_file else None
    if recorded is not None and recorded.t[-1] < stop:
        from rich.console import Console

        Console(stderr=True).print(
            f"rotor-fmu: warning: {signal_file} ends at {recorded.t[-1]:g} s; its last values are "
            f"held until --stop = {stop:g} s",
            highlight=False,
            soft_wrap=True,
        )
    for name in constants:
        if recorded is not None and name in recorded.values:
            raise InputError(f"--set {name}: {signal_file} gives it too")
    for option in (ramp or RampGiven()).options if recorded or "speed" in constants else ():
        other = f"--input {signal_file}" if recorded else "--set speed"
        raise InputError(f"{option}: {other} gives the speed too")
    signals = make_signals(table, stop, constants, followed, recorded)
    parameters = {name: value for name, value in values.items() if name not in inputs}
    return make_job(toml, rotor, parameters, signals, stop, step)


def make_job(
    toml: str,
    rotor: Rotor,
    parameters: Mapping[str, float],
    signals: Signals,
    stop: float,
    step: float | None,
) -> Job:
    """Return a run of a machine, its parameters and inputs checked together; step: communication
    step [s], None for one that suits the solver. Raises `InputError`, `QuantityError`,
    `SettingsError`."""
    table = interface(rotor)
    parameters = {"speed_rate": signals.first_rate} | dict(parameters)
    everything = {v.name: v.start for v in table if v.start is not None} | parameters
    everything |= {name: signals.at(name, 0.0) for name in signals.values}
    settings = settings_of(everything)
    try:
        build_simulation(rotor, table, everything, lambda message: None)
    except EquilibriumError as error:
        raise InputError(str(error)) from error
    step = step or min(_step_of(settings), stop)
    return Job(table, parameters, signals, stop, step, toml, rotor, settings)


def _check_rows(stop: float, step: float | None, columns: int) -> None:
    rows = stop / step if step else 0.0
    if rows > _MOST_ROWS:
        size = rows * columns * 8 / 1e9
        raise InputError(
            f"--step {step:g} s: would give {rows:.3g} rows, {size:.3g} GB, until --stop = "
            f"{stop:g} s; at most {_MOST_ROWS:g} rows"
        )


def _step_of(settings: Settings) -> float:
    """Return the communication step of a run-down [s]: fine enough for pictures, but no finer than
    the steps that an adaptive mode is to choose by itself."""
    return {"adaptive": 0.04, "controlled": 0.004}.get(settings.mode, max(settings.h, 0.002))


def execute(job: Job, fmu: Path | None, label: str) -> Run:
    """Carry out a run with a progress bar: through the FMU, or directly where `fmu` is None."""
    with shown(label, job.stop, job.step, job.settings) as progress:
        return run_direct(job.rotor, job, progress) if fmu is None else run_fmu(fmu, job, progress)


def execute_recorded(job: Job, label: str, is_silent: bool = False) -> tuple[Run, Recording]:
    """Carry out a run directly, with a progress bar, and record the default signals at its
    steps."""
    with shown(label, job.stop, job.step, job.settings) as progress:
        about = {"toml": job.toml}
        return run_recorded(job.rotor, job, progress=progress, about=about, is_silent=is_silent)


def verified(job: Job, run: Run, recording: Recording, label: str) -> tuple[Run, Recording]:
    """Make a run and compare it with the same run, solved more finely; the comparison is added to
    the recording, and the run is doubtful if it is not confirmed. Raises `InputError` if there is
    no finer run."""
    from .verify_run import NOT_CONFIRMED, NOT_CONFIRMED_CODE, compare, finer_job

    if run.status.startswith(FAILED):
        return run, recording
    finer = finer_job(job)
    with shown(label, finer.stop, finer.step, finer.settings) as progress:
        other = run_direct(finer.rotor, finer, progress, is_silent=True)
    verification = compare(run, other, job.settings)
    status = run.status
    if verification.conclusion == NOT_CONFIRMED:
        status = with_doubt(status, NOT_CONFIRMED_CODE)
    about = {**recording.about, "status": status, "verification": verification.figures}
    return replace(run, status=status), replace(recording, about=about)


def clear(out: Path, results: Sequence[str] = RESULTS) -> None:
    """Remove what an earlier run left in its folder, its own files alone; results: patterns of
    their names. Pictures are of the recording that lies beside them."""
    if (out / "recording.npz").exists():
        results = (*results, *(f"{kind}.png" for kind in PLOTS))
    for pattern in results:
        for path in out.glob(pattern):
            path.unlink()


def difference(one: Run, other: Run) -> float:
    """Return the largest difference of two runs at their ends, relative to the scale of each column
    [1]; infinite if one ends before the other."""
    if len(one.t) != len(other.t):
        return math.inf
    apart = [
        abs(float(column[-1] - other.columns[name][-1])) / (float(np.abs(column).max()) or 1.0)
        for name, column in one.columns.items()
        if len(column)
    ]
    return max(apart, default=0.0)


def fmu_in(out: Path, toml: str, reduction: int = 0) -> Path:
    """Return the FMU of this rotor in the folder `out`, built if it is not there or not up to date;
    reduction: component modes kept of the shaft."""
    # no run without an FMU needs what builds one
    from ..fmi.packing.machine_files import fmu_identifier
    from ..fmi.packing.python_fmu import build, is_current

    fmu = out / f"{fmu_identifier(parse_rotor(toml))}.fmu"
    if is_current(fmu, toml, reduction=reduction):
        return fmu
    return build(out, toml, reduction=reduction)


def write_csv(run: Run, units: Mapping[str, str], path: Path) -> None:
    """Every communication point: `time [s]`, then all that the model computes, with units."""
    heads = (f"{name} [{units[name]}]" if units[name] != "1" else name for name in run.columns)
    with unfinished(path) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time [s]", *heads])
        for row in zip(run.t.tolist(), *(c.tolist() for c in run.columns.values()), strict=True):
            writer.writerow([f"{value:.9g}" for value in row])


def write_json(data: Mapping[str, object], path: Path) -> None:
    """A JSON file, whole or not at all."""
    write_text(json_text(data), path)
