"""A run, through the built FMU with FMPy or directly through the model."""

import math
import shutil
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import chdir
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import RunFailed
from ..fmi.binding import build_simulation, changed_rotor, load_names
from ..fmi.log import read_message
from ..fmi.plain_path import check_plain_path
from ..fmi.variables import Variable, start_values
from ..interrupts import interrupts_noted
from ..model.machine.rotor import Rotor
from ..model.message_templates import Message
from ..model.settings import Settings
from ..model.simulation import StepFailure
from ..model.structure.reduction_offer import reduction_offer
from ..model.time_loop.recorder import Record, recordable
from ..run_status import FAILED, messages_and_codes, status_of
from ..short_repr import ShortRepr
from .input_signals import Driver, Signals
from .progress import ReportProgress, silent
from .recording import Recording

RECORDER_ROWS = 16384  # that a communication step may have: some 250 turns
_USUAL = {("", name) for name in ("phi", "w", "tau")}
_USUAL |= {("solver", name) for name in ("h_last", "error", "error_last")}
_NO_PARTS = ("", "solver", "energy")
_USUAL_OF_PARTS = ("x", "y", "vx", "vy", "psi", "fn", "ft", "fn_peak")


@dataclass(frozen=True)
class Job:
    """A run that was checked and can begin: the FMU's variables, values of its parameters by name,
    its inputs, its end [s] and its communication step [s]; the rotor, also as TOML, and the
    settings."""

    table: Sequence[Variable]
    parameters: Mapping[str, float]
    signals: Signals
    stop: float
    step: float
    toml: str
    rotor: Rotor
    settings: Settings

    @property
    def changed_rotor(self) -> Rotor:
        """The rotor with the values that the parameters give it."""
        values = start_values(self.table) | dict(self.parameters)
        return changed_rotor(self.rotor, self.table, values)

    def about(self, run: "Run") -> dict[str, Any]:
        """Return what a recording says of the run that was made."""
        return {
            "machine": self.rotor.name,
            "toml": self.toml,
            "parameters": dict(self.parameters),
            "loads": self.signals.loads(self.stop),
            "stop": self.stop,
            "step": self.step,
            "status": run.status,
            **messages_and_codes(run.messages),
        }


@dataclass(frozen=True, repr=False)
class Run(ShortRepr):
    """A run at its communication points.

    t, shape (n,) [s]; columns: everything the model computes, by name, shape (n,); status: see
    `status`; messages: of the solver; wall_s: wall-clock time from the end of the first
    communication step, when all code is compiled, to the end of the run [s].
    """

    t: np.ndarray
    columns: Mapping[str, np.ndarray]
    status: str
    messages: tuple[Message, ...]
    wall_s: float

    @property
    def hz(self) -> np.ndarray:
        """Speed of rotation [Hz], shape (n,)."""
        return self.columns["w"] / (2 * math.pi)


def run_fmu(fmu: Path, job: Job, progress: ReportProgress = silent) -> Run:
    """Drive a built FMU with FMPy.

    A run that fails is returned up to its last good communication point, with the reason.
    """
    import fmpy

    recorded = [v.name for v in job.table if v.is_observed]
    messages: list[Message] = []
    discards: list[Message] = []
    recorder = None
    begun = time.perf_counter()

    def log(*logged: Any) -> None:
        *_, status, _, text = logged  # FMI 2.0 has the instance's name before them
        if status != fmpy.fmi2.fmi2OK:
            messages.append(read_message(text))
        if status == fmpy.fmi2.fmi2Discard:
            discards.append(messages[-1])

    def step_finished(t: float, its_recorder: Any) -> bool:
        """Report a communication step; return whether FMPy goes on."""
        nonlocal recorder, begun
        if recorder is None:  # whatever had to be compiled now is
            begun = time.perf_counter()
        recorder = its_recorder
        if discards:  # FMPy has a row where the step ended early, at the time where it began
            recorder.rows.pop()
            return False
        last = dict(zip((name for name, *_ in recorder.cols), recorder.rows[-1], strict=True))
        progress(t, lambda: last)
        return not interrupts

    folder = fmpy.extract(str(fmu))
    failure = None
    interrupts: list[int] = []
    try:
        description = fmpy.read_model_description(folder)
        with interrupts_noted() as interrupts:
            fmpy.simulate_fmu(
                folder,
                fmu_instance=_instantiate(fmu, folder, description, log),
                model_description=description,
                validate=False,
                start_time=0.0,
                stop_time=job.stop,
                output_interval=job.step,
                start_values=dict(job.parameters),
                input=job.signals.as_structured(),
                output=recorded,
                step_finished=step_finished,
            )
    except fmpy.fmi1.FMICallException as error:
        failure = messages[-1] if messages else str(error)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    if interrupts:
        raise KeyboardInterrupt
    if discards:
        failure = discards[0]
    wall = time.perf_counter() - begun
    if recorder is None:
        empty = {name: np.zeros(0) for name in recorded}
        return Run(np.zeros(0), empty, f"{FAILED}{failure}", tuple(messages), wall)
    rows = recorder.result()
    columns = {name: np.asarray(rows[name], dtype=float) for name in recorded}
    status = status_of(messages, failure)
    return Run(np.asarray(rows["time"]), columns, status, tuple(messages), wall)


def _instantiate(fmu: Path, folder: str, description: Any, log: Callable[..., None]) -> Any:
    import fmpy

    check_plain_path(Path(folder))
    try:
        options = {"debug_logging": True, "logger": log}
        with chdir("."):  # FMPy stays at a library that cannot be loaded
            return fmpy.instantiate_fmu(folder, description, "CoSimulation", **options)
    except Exception as error:  # FMPy raises nothing more specific
        raise RunFailed(f"{fmu}: cannot be instantiated: {error}") from error


def run_direct(job: Job, progress: ReportProgress = silent, is_silent: bool = False) -> Run:
    """Return the run without an FMU: same steps and numbers where the inputs are linear and the
    loads constant; else exact, where an FMU holds its loads between two communication points."""
    return _time_loop(job, (), progress, is_silent)[0]


def run_recorded(
    job: Job,
    record: Record | None = None,
    progress: ReportProgress = silent,
    is_silent: bool = False,
) -> tuple[Run, Recording]:
    """Make the run as `run_direct` does, bit for bit, and record it at the solver's own steps.

    record: names of `recordable`; by default `usual`. phi and w are always recorded. is_silent:
    warnings go to the run's messages alone. Raises `ValueError` for what cannot be recorded.
    """
    taped = record or Record(usual(job.rotor), rows=RECORDER_ROWS)
    taped = taped._replace(names=tuple(dict.fromkeys(("phi", "w", *taped.names))))
    run, rows = _time_loop(job, taped, progress, is_silent)
    units = {str(entry.name): entry.output.unit for entry in recordable(job.rotor)}
    # a column each, so that one can be kept without the others
    t, *columns = (column.copy() for column in rows.T)
    # at standstill a peak is since the last communication point, maybe between two rows
    after = np.minimum(np.searchsorted(t, run.t), len(t) - 1)
    for name, column in zip(taped.names, columns, strict=True):
        if name.endswith(".fn_peak"):
            np.maximum.at(column, after, run.columns[name])
    return run, Recording(
        t,
        dict(zip(taped.names, columns, strict=True)),
        {name: units[name] for name in taped.names},
        job.about(run) | {"angle": taped.angle},
    )


def usual(rotor: Rotor) -> tuple[str, ...]:
    """Return the signals that are recorded by default of any machine: rotation and torque,
    displacement and velocity of whatever has them, contact angles and forces, step lengths and
    their errors, losses."""
    names = (entry.name for entry in recordable(rotor))
    return tuple(
        str(name)
        for name in names
        if (name.kind, name.quantity) in _USUAL
        or (name.kind not in _NO_PARTS and name.quantity in _USUAL_OF_PARTS)
        or (name.kind == "energy" and name.quantity.endswith("_loss"))
    )


def _time_loop(
    job: Job, record: Record | Sequence[str], progress: ReportProgress, is_silent: bool
) -> tuple[Run, np.ndarray]:
    signals, stop = job.signals, job.stop
    values = start_values(job.table) | dict(job.parameters)
    values |= {name: signals.at(name, 0.0) for name in signals.values}
    messages: list[Message] = []

    def warn(message: Message) -> None:
        messages.append(message)
        if not is_silent:
            level = "note" if message.is_note else "warning"
            print(f"rotor-fmu: {level}: {message}", file=sys.stderr, flush=True)

    simulation = build_simulation(job.rotor, job.table, values, warn, record=record)
    if simulation.settings.reduction == 0:
        fastest = float(np.abs(signals.values.get("speed", values["speed"])).max())
        offer = reduction_offer(simulation.rotor, simulation.structure, fastest)
        if offer is not None:
            warn(offer.note)
    driver = Driver(signals, load_names(job.rotor), values["speed_continuation"] != 0)

    failure = None
    t, n = 0.0, 0
    times, rows = [t], [simulation.observed.copy()]
    begun = time.perf_counter()
    taped = [simulation.drain()]
    while t < stop and not math.isclose(t, stop):
        target = min((n + 1) * job.step, stop)
        try:
            driver.advance(simulation, t, target)
        except StepFailure as error:
            failure = str(error)
            messages.append(Message(failure, ""))
            break
        finally:
            taped.append(simulation.drain())
        t, n = target, n + 1
        if n == 1:  # whatever had to be compiled now is
            begun = time.perf_counter()
        times.append(t)
        rows.append(simulation.observed.copy())
        progress(t, lambda: dict(zip(simulation.names, simulation.observed.tolist(), strict=True)))
    wall = time.perf_counter() - begun
    recorded_to = [part[-1, 0] for part in taped if len(part)]
    if recorded_to and recorded_to[-1] < simulation.time:  # no row was due at the end
        simulation.record_now()
        taped.append(simulation.drain())
    columns = dict(zip(simulation.names, np.array(rows).T, strict=True))
    status = status_of(messages, failure)
    run = Run(np.array(times), columns, status, tuple(messages), wall)
    return run, np.concatenate(taped)
