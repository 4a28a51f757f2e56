"""Verification: a run compared with the same run, solved more finely.

Where both agree in the amplitudes and in where the parts are at the end, the run is confirmed.
Where the amplitudes alone agree it is sensitive: small errors change when things happen, as in
chaos, long transients and limit cycles, but not how large the motion is.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from ..display import current
from ..errors import InputError
from ..fmi.solver_parameters import PREFIX, settings_of
from ..fmi.variables import start_values
from ..model.message_templates import Message
from ..model.settings import Settings, SettingsError
from ..run_status import NOT_CONFIRMED as CODE
from ..run_status import OK, has_failed, messages_and_codes, status_of
from ..tables import Table
from .job import execute
from .recording import Recording
from .run_down import Job, Run

CONFIRMED, SENSITIVE, NOT_CONFIRMED = "confirmed", "sensitive", "not confirmed"
# Amplitudes agree that differ by less than this share, or by the larger one that a coarse tolerance
# promises, in tolerances.
AGREES, AGREES_IN_TOLERANCES = 0.02, 10.0
# Places at the end agree that differ by less than so many times that.
_PLACES = 5.0
_FINER, _SHORTER = 0.1, 0.5
_STEPS = ("h", "h_min", "h_max")
_SMALL = 1e-3  # share of a part's largest motion below which its motion at the end is none
# Share of the shaft's length below which there is no motion, about as in a run's error control.
STILL = 1e-8


class Comparison(NamedTuple):
    """A quantity of a run and its finer twin [m]; difference: relative to the part's motion [1]."""

    name: str
    value: float
    finer: float
    difference: float


@dataclass(frozen=True)
class Verification:
    """The result of comparing a run with a finer one.

    changed: the finer run's settings that differ; status: of the finer run; peaks: the largest
    amplitudes 0-p of each part; final: the amplitudes over the last revolution and the
    displacements at the end; allowed: largest difference of amplitudes that agree [1].
    """

    changed: Mapping[str, float]
    status: str
    peaks: tuple[Comparison, ...]
    final: tuple[Comparison, ...]
    allowed: float

    @property
    def conclusion(self) -> str:
        """`CONFIRMED`, `SENSITIVE` or `NOT_CONFIRMED`."""
        if self.status != OK or self.differing:
            return NOT_CONFIRMED
        is_same = all(c.difference <= _PLACES * self.allowed for c in self.final)
        return CONFIRMED if is_same else SENSITIVE

    @property
    def differing(self) -> Comparison | None:
        """The amplitude that differs most, None where all agree."""
        amplitudes = (*self.peaks, *(c for c in self.final if c.name.endswith("_amp")))
        apart = [c for c in amplitudes if not c.difference <= self.allowed]
        return max(apart, key=lambda c: c.difference, default=None)

    @property
    def message(self) -> Message:
        """Return in one sentence why it is not confirmed."""
        changed = ", ".join(f"{name} = {value:g}" for name, value in self.changed.items())
        worst = self.differing
        if self.status != OK or worst is None:
            why = f"is itself {self.status}"
        else:
            why = f"gives {worst.name} = {worst.finer:.3g} m instead of {worst.value:.3g} m"
        return Message(f"not confirmed: the same run with {changed} {why}", CODE)

    @property
    def figures(self) -> dict[str, Any]:
        """The comparison.

        conclusion: confirmed, sensitive or not confirmed; finer: the finer run's settings that
        differ; finer_status: its status; allowed: largest difference of amplitudes that agree [1];
        peaks: the largest amplitudes of each part; final: those over the last revolution and the
        displacements at the end, each with its name, value and that of the finer run [m], and the
        difference, relative to the part's motion [1].
        """
        return {
            "conclusion": self.conclusion,
            "finer": dict(self.changed),
            "finer_status": self.status,
            "allowed": self.allowed,
            "peaks": [c._asdict() for c in self.peaks],
            "final": [c._asdict() for c in self.final],
        }


def finer(settings: Settings) -> dict[str, float]:
    """Return a finer run's settings that differ: a tenth of the tolerance, or half the steps."""
    if settings.mode == "controlled":
        changed = {"tolerance": _FINER * settings.tolerance}
    elif settings.mode == "adaptive":
        changed = {name: _SHORTER * getattr(settings, name) for name in _STEPS}
        changed |= {name: _FINER * getattr(settings, name) for name in ("eps_min", "eps_max")}
    else:
        changed = {"h": _SHORTER * settings.h}
    return {f"{PREFIX}{name}": value for name, value in changed.items()}


def finer_job(job: Job) -> Job:
    """Return the same run, finer. Raises `InputError` where there is none."""
    parameters = {**job.parameters, **finer(job.settings)}
    values = start_values(job.table) | parameters
    try:
        return replace(job, parameters=parameters, settings=settings_of(values))
    except SettingsError as error:
        raise InputError(f"a finer run to verify this one with: {error}") from error


def allowed(settings: Settings) -> float:
    """Return the largest relative difference of amplitudes that agree [1]."""
    of_tolerance = AGREES_IN_TOLERANCES * settings.tolerance
    return max(AGREES, of_tolerance if settings.mode == "controlled" else 0.0)


def compare(run: Run, other: Run, settings: Settings, length: float) -> Verification:
    """Compare a run with a finer one, `other`; settings: of the run; length: of the shaft [m]."""
    peaks, final = [], []
    still = STILL * length
    for part in (n.removesuffix(".x_amp") for n in run.columns if n.endswith(".x_amp")):
        names = [f"{part}.{axis}_amp" for axis in "xy"]
        largest = [(name, _largest(run, name), _largest(other, name)) for name in names]
        size = max(still, *(value for _, _, value in largest))
        peaks += [_compared(*each, size) for each in largest]
        ends = [(n, _last(run, n), _last(other, n)) for n in (*names, f"{part}.x", f"{part}.y")]
        size = max(still, _SMALL * size, *(value for _, _, value in ends[:2]))
        final += [_compared(*each, size) for each in ends]
    both = tuple(peaks), tuple(final)
    return Verification(finer(settings), other.status, *both, allowed(settings))


def apart_from_fmu(job: Job, driven: Run, recorded: Run) -> str:
    """Return in words that the run through the FMU has other amplitudes than the one without it,
    beyond what agrees by `allowed`, or another end; else nothing."""
    if len(driven.t) and len(driven.t) != len(recorded.t):
        return f"ends at t = {driven.t[-1]:g} s, without it at t = {recorded.t[-1]:g} s"
    compared = compare(recorded, driven, job.settings, job.rotor.length)
    worst = compared.differing
    if worst is None:
        return ""
    d = current()
    here, there = (f"{float(f'{x * d.small:.3g}'):g} {d.small_word}" for x in worst[1:3])
    when = "at most" if worst in compared.peaks else "in the last turn"
    return f"gives {worst.name} = {there} {when}, without it {here}"


def verified(job: Job, run: Run, recording: Recording, label: str) -> tuple[Run, Recording]:
    """Make a run and compare it with the same run, solved more finely; the comparison is added to
    the recording, and the run is doubtful if it is not confirmed. Raises `InputError` if there is
    no finer run."""
    if has_failed(run.status):
        return run, recording
    finer = finer_job(job)
    other = execute(finer, None, label, is_silent=True)
    verification = compare(run, other, job.settings, job.rotor.length)
    about = {**recording.about, "verification": verification.figures}
    recording = replace(recording, about=about)
    is_doubted = verification.conclusion == NOT_CONFIRMED
    return doubted(run, recording, verification.message) if is_doubted else (run, recording)


def doubted(run: Run, recording: Recording, why: Message) -> tuple[Run, Recording]:
    """Return a run that has not failed, and its recording, with a message that doubts it."""
    messages = (*run.messages, why)
    status = status_of(messages)
    about = {**recording.about, "status": status, **messages_and_codes(messages)}
    return replace(run, status=status, messages=messages), replace(recording, about=about)


def _compared(name: str, value: float, other: float, size: float) -> Comparison:
    return Comparison(name, value, other, abs(value - other) / size)


def _largest(run: Run, name: str) -> float:
    return float(np.max(run.columns[name], initial=0.0))


def _last(run: Run, name: str) -> float:
    return float(run.columns[name][-1]) if len(run.t) else 0.0


def table_of(figures: Mapping[str, Any]) -> Table:
    """Return the conclusion, and the run and the finer one side by side, displacements in the unit
    that is shown; figures: `Verification.figures`."""
    small, unit = current().small, current().small_unit
    changed = ", ".join(f"{name} = {value:g}" for name, value in figures["finer"].items())
    by = f"by the same run with {changed}: {figures['finer_status']}"
    heads = ("", f"this run [{unit}]", f"finer run [{unit}]", "difference [%]")
    rows = [
        (f"{c['name']}, {title}", small * c["value"], small * c["finer"], 100 * c["difference"])
        for title, compared in (("largest", figures["peaks"]), ("at the end", figures["final"]))
        for c in compared
    ]
    return Table(f"Verification: {figures['conclusion']}, {by}", heads, rows)
