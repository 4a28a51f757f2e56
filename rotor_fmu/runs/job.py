"""A run as the user specified it: checked before anything is written, then carried out."""

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from ..errors import MOST_ROWS, InputError, check_one_of
from ..fmi.binding import build_simulation
from ..fmi.interface import interface
from ..fmi.solver_parameters import PREFIX, settings_of
from ..fmi.variables import start_values
from ..machine_file.loading import load_rotor, to_screen, warn_of_changes
from ..model.machine.rotor import Rotor
from ..model.quantities import check_size
from ..model.settings import PRESETS, Settings
from ..model.simulation import EquilibriumError
from ..operating_speeds import operating_speeds
from .input_signals import RampGiven, Signals, make_signals, read_signals
from .progress import shown
from .recording import Recording
from .run_down import Job, Run, run_direct, run_fmu, run_recorded
from .settings_text import parse_settings

_USUAL_ROWS = 1e4
_SHORTEST = 1e-15  # communication step of an FMU [s]


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
    last time of the file, or the ramp's end; ramp: by default the machine's run-down."""
    toml, rotor = load_rotor(rotor_file)
    table = interface(rotor)
    followed = (ramp or RampGiven()).on(rotor)
    recorded = read_signals(signal_file, table) if signal_file else None
    if stop is None and recorded is not None:
        stop = float(recorded.t[-1])
        if not stop > 0:
            raise InputError(
                f"{signal_file}: ends at {stop:g} s; give the end of the run as --stop"
            )
    elif stop is None:
        stop = followed.end
    if not 0 < stop < float("inf"):
        raise InputError(f"--stop {stop:g} s: must be > 0 and finite")
    if step is not None and not 0 < step <= stop:
        raise InputError(f"--step {step:g} s: must be > 0 and at most --stop = {stop:g} s")
    if preset is not None:
        check_one_of(f"--preset {preset}", preset, PRESETS)
        if any(text.partition("=")[0].strip() == "solver.preset" for text in sets):
            raise InputError(f"--preset {preset}: --set solver.preset gives it too")
        sets = [f"solver.preset={preset}", *sets]
    _check_rows(stop, step, len(table))
    values = parse_settings(rotor, table, sets)
    inputs = {v.name for v in table if v.causality == "input"}
    constants = {name: value for name, value in values.items() if name in inputs}
    for warning in _beyond(recorded, stop) if recorded is not None else ():
        to_screen(f"{signal_file} {warning}")
    for name in constants:
        if recorded is not None and name in recorded.values:
            raise InputError(f"--set {name}: {signal_file} gives it too")
    speed_by = "--set speed" if "speed" in constants else ""
    if recorded is not None and "speed" in recorded.values:
        speed_by = f"--input {signal_file}"
    for option in (ramp or RampGiven()).options if speed_by else ():
        raise InputError(f"{option}: {speed_by} gives the speed too")
    signals = make_signals(table, stop, constants, followed, recorded)
    parameters = {name: value for name, value in values.items() if name not in inputs}
    try:
        job = make_job(toml, rotor, parameters, signals, stop, step)
    except InputError as error:
        is_from_rest = followed.first == 0 and not speed_by
        if not is_from_rest or not isinstance(error.__cause__, EquilibriumError):
            raise
        raise InputError(f"{error}; or let it begin at a speed that carries it, --from") from error
    warn_of_changes("--set", rotor, job.changed_rotor)
    return job


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
    units = {v.name: v.unit for v in table}
    for name, column in signals.values.items():
        largest = float(max(column, key=abs))
        check_size(f"{name} = {largest:g} {units[name]}", largest)
    check_size(f"speed_rate = {signals.first_rate:g} rad/s2", signals.first_rate)
    parameters = {"speed_rate": signals.first_rate} | dict(parameters)
    everything = start_values(table) | parameters
    everything |= {name: signals.at(name, 0.0) for name in signals.values}
    settings = settings_of(everything)
    try:
        build_simulation(rotor, table, everything, lambda message: None)
    except EquilibriumError as error:
        raise InputError(str(error)) from error
    fastest = max(operating_speeds(rotor).trip, float(np.abs(signals.values["speed"]).max()))
    step = step or min(_step_of(settings, stop, fastest), stop)
    if step < _SHORTEST:
        name = "stop" if step == stop else "step"
        raise InputError(f"{name} = {step:g} s: must be at least {_SHORTEST:g} s")
    if stop / step > MOST_ROWS:
        raise InputError(
            f"stop = {stop:g} s: would give {stop / step:.3g} rows at the communication step of "
            f"{step:g} s; at most {MOST_ROWS:g} rows: take a longer step or an earlier end"
        )
    return Job(table, parameters, signals, stop, step, toml, rotor, settings)


def _beyond(recorded: Signals, stop: float) -> Iterator[str]:
    """Yield what becomes of a run where a file's signals do not last from 0 s to its end."""
    first, last = recorded.t[0], recorded.t[-1]
    if first < 0.0:
        yield f"begins at {first:g} s; a run begins at 0 s, and what lies before is left out"
    elif first > 0.0:
        yield f"begins at {first:g} s; its first values are held from 0 s until then"
    if last < stop:
        yield f"ends at {last:g} s; its last values are held until --stop = {stop:g} s"


def _check_rows(stop: float, step: float | None, columns: int) -> None:
    rows = stop / step if step else 0.0
    if rows > MOST_ROWS:
        size = rows * columns * 8 / 1e9
        raise InputError(
            f"--step {step:g} s: would give {rows:.3g} rows, {size:.3g} GB, until --stop = "
            f"{stop:g} s; at most {MOST_ROWS:g} rows"
        )


def _step_of(settings: Settings, stop: float, fastest: float) -> float:
    """Return the communication step of a run [s]: fine enough for pictures, but no finer than the
    steps that an adaptive mode is to choose by itself. A machine that turns in less, at its fastest
    [rad/s], has a row a turn, of `_USUAL_ROWS` at most."""
    if settings.mode == "adaptive":
        return 0.04
    turn = max(math.tau / fastest, stop / _USUAL_ROWS)
    is_controlled = settings.mode == "controlled"
    return min(0.004, turn) if is_controlled else max(settings.h, min(0.002, turn))


def execute(job: Job, fmu: Path | None, label: str, is_silent: bool = False) -> Run:
    """Carry out a run with a progress bar: through the FMU, or directly where `fmu` is None; then
    without the lines of its warnings if is_silent."""
    with shown(label, job.stop, job.step, job.settings) as progress:
        if fmu is None:
            return run_direct(job, progress, is_silent)
        return run_fmu(fmu, job, progress)


def execute_recorded(job: Job, label: str, is_silent: bool = False) -> tuple[Run, Recording]:
    """Carry out a run directly, with a progress bar, and record the usual signals."""
    with shown(label, job.stop, job.step, job.settings) as progress:
        return run_recorded(job, progress=progress, is_silent=is_silent)


def difference(one: Run, other: Run) -> float:
    """Return the largest difference of two runs at their ends, relative to the scale of each column
    [1], but for the solver's own, such as its counts of steps; infinite if one ends before the
    other. `one`, through an FMU, has no row, not even of the start, if its first step failed."""
    if (len(one.t) or 1) != len(other.t):
        return math.inf
    apart = [
        abs(float(column[-1] - other.columns[name][-1])) / (float(np.abs(column).max()) or 1.0)
        for name, column in one.columns.items()
        if len(column) and not name.startswith(PREFIX)
    ]
    return max(apart, default=0.0)
