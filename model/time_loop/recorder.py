"""The recorder: signals of a run at the solver's own steps, written by the kernel into memory of a
fixed size.

The outputs of an FMU are those of its communication points, which may be many revolutions apart;
the steps between them are not visible. A recorder stores selected observed quantities, one row a
step, no closer than a least angle. When it is full, every second row is dropped and the angle
doubles.
"""

import math
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.jit import jit, jit_not_inlined
from ..machine.names import Name
from ..machine.rotor import Rotor
from ..near_names import near_names
from ..parts.base import VELOCITY_OUTPUTS, ProbeElement
from ..step.excitation import at_place
from .observe import Observed, energies_at, observe, observed, velocity_output

RECORDER = np.dtype(
    [
        ("least", "f8"),  # angle between rows that was asked for [rad], 0 for every step
        ("spacing", "f8"),  # and that it has become since the recorder was emptied
        ("since", "f8"),  # the last row
        ("covered", "f8"),  # since the recorder was emptied
        ("written", "i8"),  # rows
    ]
)
_VELOCITIES = len(VELOCITY_OUTPUTS)
_ROUNDING = 1e-9  # of sums of angles
ANGLE = 2.0 * math.pi / 64.0
ROWS = 4096


class Recorder(NamedTuple):
    """The recorder's arrays: head, of dtype `RECORDER`; channels: indices in `recordable`; rows:
    time [s] and the channels. Without rows nothing is recorded."""

    head: Annotated[np.recarray, RECORDER, "1"]
    channels: Annotated[np.ndarray, np.int64, "channels"]
    rows: Annotated[np.ndarray, float, "recorder_rows", "1 + channels"]


def recordable(rotor: Rotor) -> tuple[Observed, ...]:
    """Return all signals that can be recorded: those of `observed`, and then the
    `VELOCITY_OUTPUTS` of the probes."""
    velocities = [
        Observed(Name(*key, output.name), output)
        for key, element in rotor.indexed_elements()
        if isinstance(element, ProbeElement)
        for output in VELOCITY_OUTPUTS
    ]
    return (*observed(rotor), *velocities)


class Record(NamedTuple):
    """What to record of a run at the solver's own steps: names of `recordable`; the least angle of
    rotation between two rows [rad], 0 for every step; the most rows held until they are read."""

    names: Sequence[str]
    angle: float = ANGLE
    rows: int = ROWS


def channels_of(rotor: Rotor, record: Record) -> list[int]:
    """Return the indices in `recordable` of signals; `ValueError` for an unknown one."""
    if not 0.0 <= record.angle < math.inf:
        raise ValueError(f"record: angle = {record.angle} rad: must be >= 0 and finite")
    if record.rows < 2 or record.rows % 2:
        raise ValueError(f"record: rows = {record.rows}: must be an even number, at least 2")
    place = {str(entry.name): i for i, entry in enumerate(recordable(rotor))}
    for name in record.names:
        if name not in place:
            (near,) = near_names(name, place, least=0.0)
            raise ValueError(f"record: {name!r} is unknown; the nearest name is {near}")
    return [place[name] for name in record.names]


@jit
def is_due(structure, record, head):
    """Return whether the step just taken is to be recorded. The angle counted is that of the
    rotation, or of the lowest mode if this is faster: a rotor at rest still vibrates."""
    fastest = max(abs(record[0].omega), structure.numbers[0].lowest_omega)
    passed = fastest * record[0].h_last
    head[0].since += passed
    head[0].covered += passed
    return head[0].since >= head[0].spacing * (1.0 - _ROUNDING)


@jit
def rows_within(structure, record, head):
    """Return the number of equal parts of the step just taken at whose ends a row is due: 1 if the
    step turns by no more than the angle between rows."""
    spacing = head[0].spacing
    if spacing <= 0.0:
        return 1
    fastest = max(abs(record[0].omega), structure.numbers[0].lowest_omega)
    return max(1, math.ceil(fastest * record[0].h_last / spacing - _ROUNDING))


@jit_not_inlined
def write(structure, motion, memory, work, recorder, out):
    """Write the present state as a row; `out` is filled by `observe`."""
    head, rows = recorder.head[0], recorder.rows
    if head.written == len(rows):
        _thin(recorder)
        head.since = head.spacing
    head.since = min(head.since - head.spacing, head.spacing)
    low, has_energies = energies_at(structure, out), False
    for i in range(len(recorder.channels)):
        has_energies = has_energies or low <= recorder.channels[i] < len(out)
    observe(structure, motion, memory, work, out, has_energies)
    row = rows[head.written]
    row[0] = memory.record[0].t
    for i in range(len(recorder.channels)):
        channel = recorder.channels[i]
        if channel < len(out):
            row[1 + i] = out[channel]
        else:
            beyond = channel - len(out)
            v = at_place(structure.probes[beyond // _VELOCITIES], motion.v)
            row[1 + i] = velocity_output(v, beyond % _VELOCITIES)
    head.written += 1


@jit
def _thin(recorder):
    """Drop every second of an even number of rows, the last among them, and double the angle."""
    head, rows = recorder.head[0], recorder.rows
    retained = len(rows) // 2
    for i in range(1, retained):
        for k in range(rows.shape[1]):
            rows[i, k] = rows[2 * i, k]
    head.written = retained
    # where the steps are longer than the angle that was asked for it is theirs
    head.spacing = max(2.0 * head.spacing, head.covered / retained)


@jit
def start(structure, motion, memory, work, recorder, out):
    """Empty the recorder and write the state at the start."""
    head = recorder.head[0]
    head.spacing = head.least
    head.since = head.least
    head.covered = 0.0
    head.written = 0
    if len(recorder.rows) > 0:
        write(structure, motion, memory, work, recorder, out)
