"""A run of a machine, recorded at the solver's own steps."""

import math
import warnings
from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any, cast

import numpy as np

from ..errors import InputError, known_name, shown_value
from ..fmi.interface import interface
from ..fmi.solver_parameters import PREFIX
from ..fmi.variables import Variable
from ..machine_file.loading import warn_of_changes
from ..model.arguments import check_one_of, check_positive, listed, mapped, number, switch
from ..model.settings import PRESETS
from ..model.simulation import RotorWarning, warn
from ..model.time_loop.recorder import Record
from ..runs.input_signals import Signals
from ..runs.job import Job, make_job
from ..runs.run_down import RECORDER_ROWS, run_recorded, usual
from ..runs.settings_text import parse_settings
from ..runs.verify_run import finer_job, verified
from .machine import Machine, check_machine
from .result import Result

Signal = float | tuple[Sequence[float] | np.ndarray, Sequence[float] | np.ndarray]
_PER_TURN = 64


def simulate(
    machine: Machine,
    *,
    speed: Signal,
    loads: Mapping[str, Signal] | None = None,
    stop: float | None = None,
    preset: str | None = None,
    tolerance: float | None = None,
    parameters: Mapping[str, float | str] | None = None,
    record: Sequence[str] | None = None,
    per_turn: float | None = _PER_TURN,
    step: float | None = None,
    verify: bool = False,
) -> Result:
    """Simulate a machine from its rest under gravity and loads, and record the run.

    Parameters
    ----------
    machine : Machine
        The machine, as `load` or `parse` returns it.
    speed : float or (times, values)
        Speed of rotation [rad/s], constant, or values at times [s] between which it is linear.
    loads : mapping of str to float or (times, values), optional
        External forces on ports, such as `disc[2].fy` [N], given as the speed is.
    stop : float, optional
        End of the run [s]. By default the last time given.
    preset : str, optional
        Preset of the solver.
    tolerance : float, optional
        Relative error tolerated by the solver [1].
    parameters : mapping of str to float or str, optional
        Other values of parameters of the machine or the solver, such as `bearing[1].mu`, in SI
        units.
    record : sequence of str, optional
        Names of `machine.units` to record. By default the usual ones.
    per_turn : float or None
        Rows of the recording in a turn [1]; None records every step.
    step : float, optional
        Communication step [s], at whose ends `Result.points` has its rows. The speed and the loads
        are followed exactly, whatever it is.
    verify : bool
        Whether to run again with a tenth of the tolerance, or half of the step, and compare both
        runs: `Result.verification`.

    Returns
    -------
    Result
        The run. Of a run that failed it holds what came before, and its status the reason.

    Raises
    ------
    InputError
        If an argument cannot be; the message names it, its value and what is allowed.

    Warns
    -----
    RotorWarning
        If something makes the run doubtful, or it fails.
    RotorNote
        If there is something to say that leaves the run as good as any, such as a machine that is
        unstable by itself.

    Examples
    --------
    >>> import rotor_fmu as rf
    >>> result = rf.simulate(rf.load(), speed=185.0, stop=0.2)
    >>> result.status
    'ok'
    >>> f"{1e6 * abs(result['disc[3].x']).max():.0f} µm"
    '331 µm'
    >>> result = rf.simulate(rf.load(), speed=([0, 0.2], [400, 390]), preset="robust")
    >>> f"{result.speed[-1]:.1f} {result.units['w']}"
    '390.0 rad/s'
    """
    job = plan(machine, speed, loads, stop, preset, tolerance, parameters, step)
    if switch("verify", verify):
        finer_job(job)  # refused before anything is run
    recorded = _record(machine, record, per_turn)
    try:
        run, recording = run_recorded(job, recorded, is_silent=True)
    except ValueError as error:  # a signal that there is not
        raise InputError(str(error)) from error
    if verify:
        run, recording = verified(job, run, recording, "finer")
    for message in run.messages:
        warn(message)
    return Result(recording, run, machine)


def _record(machine: Machine, names: Sequence[str] | None, per_turn: float | None) -> Record:
    """Return what is recorded, of the arguments of `simulate`."""
    per_turn = None if per_turn is None else number("per_turn", per_turn)
    if per_turn is not None and not 0 < per_turn < math.inf:
        raise InputError(f"per_turn = {per_turn:g}: must be > 0 and finite, or None for every step")
    chosen = usual(machine.rotor) if names is None else listed("record", names, "names")
    for name in chosen:
        if not isinstance(name, str):
            raise InputError(f"record: {shown_value('name', name)}: must be text")
    angle = 0.0 if per_turn is None else 2 * math.pi / per_turn
    return Record(tuple(chosen), angle, RECORDER_ROWS)


def plan(
    machine: Machine,
    speed: Signal,
    loads: Mapping[str, Signal] | None,
    stop: float | None,
    preset: str | None,
    tolerance: float | None,
    parameters: Mapping[str, float | str] | None,
    step: float | None,
) -> Job:
    """Return the run that the arguments of `simulate` mean, checked."""
    check_machine(machine)
    table = interface(machine.rotor)
    stop = None if stop is None else number("stop", stop)
    step = None if step is None else number("step", step)
    loads, parameters = mapped("loads", loads), mapped("parameters", parameters)
    if "speed" in loads:
        raise InputError("loads: speed is not a load: give it as speed")
    signals = _signals(table, {"speed": speed, **loads}, stop)
    stop = float(signals.t[-1]) if stop is None else float(stop)
    if step is not None and not 0 < step <= stop:
        raise InputError(f"step = {step} s: must be > 0 and at most stop = {stop:g} s")
    given: dict[str, float | str] = parameters
    if preset is not None:
        check_one_of(f"preset = {preset!r}", preset, PRESETS)
    options = (("preset", preset), ("tolerance", tolerance))
    arguments = {f"{PREFIX}{option}": chosen for option, chosen in options if chosen is not None}
    for name, chosen in arguments.items():
        if name in given:
            option = name.removeprefix(PREFIX)
            raise InputError(f"{option} = {chosen!r}: parameters give {name} too")
        given[name] = chosen
    inputs = {v.name for v in table if v.causality == "input"}
    for name in given.keys() & inputs:
        raise InputError(f"parameters: {name} is an input: give it as speed or among loads")
    try:
        texts = [f"{name}={value}" for name, value in given.items()]
        values = parse_settings(machine.rotor, table, texts)
        job = make_job(machine.toml, machine.rotor, values, signals, stop, step)
    except ValueError as error:
        said = str(error).removeprefix("--set ")
        is_argument = said.partition(" ")[0] in arguments
        raise InputError(said.removeprefix(PREFIX) if is_argument else said) from error
    at_call = partial(warnings.warn, category=RotorWarning, stacklevel=4)
    warn_of_changes("parameters:", job.rotor, job.changed_rotor, warn=at_call)
    return job


def _signals(table: Sequence[Variable], given: Mapping[str, Signal], stop: float | None) -> Signals:
    """Return all inputs over the times of all that are given: each is linear between its own."""
    known = [v for v in table if v.causality == "input"]
    names = [v.name for v in known]
    for name in given:
        known_name("loads:", name, names)
    courses = {name: _course(name, value) for name, value in given.items()}
    ends = [t[-1] for t, _ in courses.values() if len(t) > 1]
    if stop is None and not ends:
        raise InputError("stop: must be given where the speed and the loads are constant")
    end = max(ends) if stop is None else float(stop)
    check_positive("stop", end, "s")
    t = np.unique(np.concatenate([[0.0, end], *(times for times, _ in courses.values())]))
    constant = {v.name: np.full(len(t), float(v.start or 0.0)) for v in known}
    return Signals(t, constant | {name: np.interp(t, *course) for name, course in courses.items()})


def _course(name: str, value: Signal) -> tuple[np.ndarray, np.ndarray]:
    """Return the times [s] and values of an input."""
    try:
        t, values = np.zeros(1), np.array([number(name, value)])
    except InputError as error:
        try:
            t, values = (np.asarray(part, dtype=float) for part in cast(Any, value))
        except (TypeError, ValueError, OverflowError):
            raise InputError(f"{error}, or times and values") from None
        if 0 in (t.ndim, values.ndim):  # as FROM and TO, of which neither is a time
            raise InputError(f"{error}, or times and values") from None
    else:
        if not math.isfinite(values[0]):
            raise InputError(f"{name} = {value}: must be finite")
    if t.shape != values.shape or t.ndim != 1 or len(t) == 0:
        raise InputError(f"{name}: {t.size} times and {values.size} values: must be as many")
    if not (np.isfinite(t).all() and np.isfinite(values).all()):
        raise InputError(f"{name}: all of its times and values must be finite")
    if not (np.diff(t) > 0).all() or t[0] < 0:
        raise InputError(f"{name}: its times must increase and not lie before 0 s")
    return t, values
