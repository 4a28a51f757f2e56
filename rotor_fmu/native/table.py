"""The table of a machine that the C skin reads from the FMU's resources (`skin/instance.h`): the
variables and what they are to the run, limits and sentences, and the block of memory itself as it
is before the parameters are set.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..fmu.interface import ports
from ..fmu.variables import Variable
from ..model.machine.rotor import Rotor
from ..model.march.block import LAYOUT, new_block
from ..model.march.memory import RECORD
from ..model.march.observe import observed_names
from ..model.quantities import ANY, NOT_NEGATIVE, POSITIVE, Quantity
from ..model.structure.assembly import interface_names
from ..model.structure.places import places
from ..model.structure.reduction import assembled
from .sentences import SENTENCES, closed_at
from .settle import CHOICES, SLOTS

MAGIC, FILE = b"ROTORFMU", "machine.table"
KINDS = ("Real", "Integer", "Boolean")
(DRIVE, LOAD, RATE, HOLD, START_SPEED, MACHINE, SETTING, REDUCTION, READ, INSTANT, TIME) = range(11)
REDUCTION_NAME = "solver.reduction"
_ROLES = {
    "speed": DRIVE,
    "tau_drive": DRIVE,
    "speed_rate": RATE,
    "speed_continuation": HOLD,
    "w_start": START_SPEED,
    REDUCTION_NAME: REDUCTION,
    "solver.trapped_at": INSTANT,
    "solver.overdamped_at": INSTANT,
    "time": TIME,
}
_SOLVER = "solver."
# What the FMU calls otherwise than the settings do.
_SETTINGS = {"adaptive": "mode"}
# What a rule allows: more than this, or this too.
_LEAST = {POSITIVE: (0.0, True), NOT_NEGATIVE: (0.0, False), ANY: (-math.inf, False)}
# (variable, what it asks for, why): what parameters ask of each other.
_NEEDS = (
    (
        "shaft.eta_h",
        "shaft.rotating_damping",
        "shaft.eta_h = {g}: must be 0 unless shaft.rotating_damping is true "
        "(hysteretic damping has no stationary form in the time domain)",
    ),
)
# As in skin/instance.h.
_HEAD = struct.Struct("<8s16s40s 5q 5q 2q 4q 4q 6q")
_VARIABLE = struct.Struct("<3q 4q 6d")
_ROW = struct.Struct("<3q")
_SPAN = struct.Struct("<q2d")


class Face(NamedTuple):
    """What an FMU is made of: the machine, and its variables in the order of their references."""

    rotor: Rotor
    table: Sequence[Variable]
    is_free: bool


class _Texts:
    """Texts, each once, by their place in what follows."""

    def __init__(self) -> None:
        self.bytes = b""
        self._places: dict[str, int] = {}

    def place(self, text: str) -> int:
        if text not in self._places:
            self._places[text] = len(self.bytes)
            self.bytes += text.encode() + b"\0"
        return self._places[text]


def table_bytes(face: Face, core: str, guid: str) -> bytes:
    """The file's content; core: of the library that reads it, 16 characters; guid: the FMU's.

    Raises `QuantityError` for a machine with a parameter that changes a matrix.
    """
    index = {variable.name: i for i, variable in enumerate(face.table)}
    structure, beyond = assembled(face.rotor, int(face.table[index[REDUCTION_NAME]].start or 0))
    block = new_block(structure, len(observed_names(face.rotor)))
    where = {field.path: _offset(block, i) for i, field in enumerate(LAYOUT.fields)}
    record = where["memory.record"]
    texts = _Texts()
    observed_at = next(i for i, v in enumerate(face.table) if v.is_observed)
    variables = b"".join(_rows(face, texts, observed_at))
    writes = b"".join(_writes(face.rotor, index, where))
    needs = [
        _ROW.pack(index[a], index[b], _HEAD.size + texts.place(why))
        for a, b, why in _NEEDS
        if a in index
    ]
    warnings = [text.beyond.replace("{speed:.4g}", "{.4g}") for text in beyond]
    where_closed = _closed_at(face.rotor, block)
    own = [text.replace("{where}", where_closed) for text in SENTENCES]
    sentences = [_HEAD.size + texts.place(text) for text in (*own, *warnings)]
    spans = b"".join(
        _SPAN.pack(code, table.low, table.high) for code, table in enumerate(beyond, len(SENTENCES))
    )
    # texts stand behind the head, so that their places are known first
    parts = [_padded(texts.bytes)]
    begins = []
    for part in (
        variables,
        writes,
        b"".join(needs),
        struct.pack(f"<{len(sentences)}q", *sentences),
        spans,
    ):
        begins.append(_HEAD.size + sum(map(len, parts)))
        parts.append(part)
    begins.append(_HEAD.size + sum(map(len, parts)))
    parts.append(block.tobytes())
    body = b"".join(parts)
    head = _HEAD.pack(
        *(MAGIC, core.encode(), guid.encode()),
        *(_HEAD.size + len(body), len(face.table), observed_at),
        *(index["tau_drive" if face.is_free else "speed"], face.is_free),
        *(1 + len(SLOTS), 1 + SLOTS.index("tolerance")),
        *(len(writes) // _ROW.size, len(needs), len(sentences)),
        *(len(block), LAYOUT.extent(block, "memory").stop),
        *(record + _field(RECORD, "is_free")[1], record + _field(RECORD, "continues")[1]),
        *(where["memory.loads"], where["reading.observed"]),
        *(len(beyond), record + _field(RECORD, "omega")[1]),
        *(record + _field(RECORD, name)[1] for name in ("surveyed_at", "surveyed_to")),
        *begins,
    )
    return head + body


def _field(record: np.dtype, name: str) -> tuple[np.dtype, int]:
    """Type and offset of a field of a record."""
    assert record.fields is not None
    kind, at = record.fields[name][:2]
    return kind, at


def _padded(data: bytes) -> bytes:
    return data + bytes(-len(data) % 8)


def _closed_at(rotor: Rotor, block: np.ndarray) -> str:
    """Which contacts are closed, in words."""
    interfaces = LAYOUT.look(block).structure.interfaces
    walls = np.flatnonzero(interfaces.slips == 1).tolist()
    return closed_at(interface_names(rotor), walls)


def _offset(block: np.ndarray, i: int) -> int:
    """Where an array of the layout begins in a block [bytes]."""
    header = block[: 8 * LAYOUT.header_length].view(np.int64)
    return int(header[1 + len(LAYOUT.size_names) + i])


def _rows(face: Face, texts: _Texts, observed_at: int) -> list[bytes]:
    quantities = {str(name): told for name, told, _ in face.rotor.parameters()}
    loads = [f"{name}.f{axis}" for name, _ in ports(face.rotor) for axis in "xy"]
    rows = []
    for i, v in enumerate(face.table):
        role, at, unset, shift = MACHINE, 0, math.nan, 0.0
        if v.name in _ROLES:
            role = _ROLES[v.name]
        elif v.causality == "input":
            role, at = LOAD, loads.index(v.name)
        elif v.name.startswith(_SOLVER) and not v.is_observed:
            role, at, unset, shift = _setting(v)
        elif v.is_observed:
            role = READ
        if v.is_observed:
            at = i - observed_at
        rows.append(_row(texts, v, quantities.get(v.name), (role, at), (unset, shift)))
    return rows


def _row(
    texts: _Texts,
    v: Variable,
    told: Quantity | None,
    role: tuple[int, int],
    setting: tuple[float, float],
) -> bytes:
    least, is_strict = _LEAST[told.rule] if told else (-math.inf, False)
    unit = f" {told.unit}" if told and told.unit != "1" else ""
    return _VARIABLE.pack(
        *(_HEAD.size + texts.place(t) for t in (v.name, unit, told.rule.words if told else "")),
        *(KINDS.index(v.kind), *role, is_strict),
        float(v.start or 0.0),
        -math.inf if v.low is None else v.low,
        math.inf if v.high is None else v.high,
        *setting,
        least,
    )


def _setting(v: Variable) -> tuple[int, int, float, float]:
    """Role, place among the given settings, value that leaves it to the preset, and what counts
    before the first name of a choice."""
    name = v.name.removeprefix(_SOLVER)
    if name == "preset":
        return SETTING, 0, math.nan, 0.0
    name = _SETTINGS.get(name, name)
    unset = float(v.start or 0.0) if v.is_unset_at_start else math.nan
    return SETTING, 1 + SLOTS.index(name), unset, 1.0 if name in CHOICES else 0.0


def _writes(rotor: Rotor, index: dict[str, int], where: dict[str, int]) -> list[bytes]:
    """Each parameter of the machine with its places in the block."""
    fields = {field.path: field.dtype for field in LAYOUT.fields}
    rows = []
    for name, of in places(rotor).items():
        for place in of:
            path = f"structure.{place.member}"
            kind, at = _field(fields[path], place.field)
            byte = where[path] + place.row * fields[path].itemsize + at
            rows.append(_ROW.pack(index[str(name)], byte, kind.kind == "i"))
    return rows
