"""The table of a machine that the instance in C reads (`c/instance.h`): the variables and their
places in the run, limits and messages, and the initial block of memory, before the parameters are
set.
"""

import math
import re
import struct
from collections.abc import Sequence

import numpy as np

from ..model.laws_at_rest.oil import machine_with_oil
from ..model.machine.rotor import HYSTERETIC_AT_REST, Rotor
from ..model.message_templates import choice
from ..model.messages import CODES, SENTENCES, closed_at
from ..model.quantities import ANY, LARGEST, Quantity
from ..model.settings import settings_messages as of_settings
from ..model.settings.table import NAMES, SETTINGS, Number
from ..model.simulation import HYSTERETIC_AS_SLOWER
from ..model.structure.assembly import interface_names
from ..model.structure.parameter_locations import parameter_locations
from ..model.structure.reduction import assembled
from ..model.time_loop.block import LAYOUT, new_block
from ..model.time_loop.memory import RECORD
from ..model.time_loop.observe import observed, observed_names
from .binding import load_names
from .coupling_parameters import coupling_parameters
from .log import with_code
from .solver_parameters import GIVEN, PREFIX, REDUCTION, meaning
from .variables import Variable

MAGIC, FILE = b"ROTORFMU", "machine.table"
KINDS = ("Real", "Integer", "Boolean", "Enumeration")
(
    DRIVE,
    LOAD,
    RATE,
    HOLD,
    START_SPEED,
    MACHINE,
    SETTING,
    REDUCED,
    READ,
    REMEMBERED,
    INSTANT,
    TIME,
) = range(12)
_ROLES = {
    "speed": DRIVE,
    "tau_drive": DRIVE,
    "speed_rate": RATE,
    "speed_continuation": HOLD,
    "w_start": START_SPEED,
    REDUCTION.name: REDUCED,
    "solver.trapped_at": INSTANT,
    "solver.overdamped_at": INSTANT,
    "time": TIME,
}
_SETTINGS = {variable.name: at for at, variable in enumerate(GIVEN)}
_SETTING_RULES = {
    variable.name: of.rule
    for variable, of in zip(GIVEN[1:], SETTINGS, strict=True)
    if isinstance(of, Number)
}
# (variable, what it asks for, why): what parameters ask of each other.
_NEEDS = (("shaft.eta_h", "shaft.rotating_damping", HYSTERETIC_AT_REST),)
# As in c/instance.h.
_HEAD = struct.Struct("<8s16s40s d Q 6q 6q 3q 17q 6q")
HEAD_SIZE, CHECKSUM_AT = _HEAD.size, struct.calcsize("<8s16s40s d")
_VARIABLE = struct.Struct("<3q 4q 7d")
_ROW = struct.Struct("<3q")
_SPAN = struct.Struct("<5q3d")


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


def table_bytes(
    rotor: Rotor, table: Sequence[Variable], is_free: bool, sources: str, guid: str
) -> bytes:
    """Return the file's content; table: the FMU's variables in the order of their references;
    sources: its library's digest, 16 characters; guid: the FMU's.

    Raises `QuantityError` for a machine with a parameter that changes a matrix.
    """
    index = {variable.name: i for i, variable in enumerate(table)}
    structure, beyond = assembled(
        machine_with_oil(rotor), int(table[index[REDUCTION.name]].start or 0)
    )
    block = new_block(structure, len(observed_names(rotor)))
    where = {field.path: _offset(block, i) for i, field in enumerate(LAYOUT.fields)}
    record = where["memory.record"]
    texts = _Texts()
    observed_at = next(i for i, v in enumerate(table) if v.is_observed)
    variables = b"".join(_rows(rotor, table, is_free, texts, observed_at))
    writes = b"".join([*_writes(rotor, index, where), *_record_writes(is_free, index, record)])
    needs = [
        _ROW.pack(index[a], index[b], _HEAD.size + texts.place(why))
        for a, b, why in _NEEDS
        if a in index
    ]
    warnings = [re.sub(r"\{\w+:", "{", of.beyond) for of in beyond]
    interfaces = interface_names(rotor)
    closed = closed_at(interfaces, LAYOUT.view_in_python(block).structure.interfaces)
    known = (*of_settings.prefixed(PREFIX), *SENTENCES[len(of_settings.SENTENCES) :])
    names = choice(interfaces)
    own = [text.replace("{where}", closed).replace("{names}", names) for text in known]
    codes = (*CODES, *(each.code for each in beyond), HYSTERETIC_AS_SLOWER.code)
    said = (
        with_code(text, code)
        for text, code in zip((*own, *warnings, HYSTERETIC_AS_SLOWER), codes, strict=True)
    )
    sentences = [_HEAD.size + texts.place(text) for text in said]
    spans = b"".join(
        _SPAN.pack(
            *(code, of.is_of_size, -1),
            *(index.get(f"{of.film}.{name}", -1) for name in ("viscosity", "clearance")),
            *(of.low, of.high, of.reynolds),
        )
        for code, of in enumerate(beyond, len(SENTENCES))
    )
    spans += _SPAN.pack(len(sentences) - 1, 0, index["shaft.eta_h"], -1, -1, 0.0, 0.0, math.nan)
    # texts stand behind the head, so that their places are known first
    parts = [texts.bytes + bytes(-len(texts.bytes) % 8)]
    begins = []
    for part in (
        variables,
        writes,
        b"".join(needs),
        struct.pack(f"<{len(sentences)}q", *sentences),
        spans,
        block.tobytes(),
    ):
        begins.append(_HEAD.size + sum(map(len, parts)))
        parts.append(part)
    body = b"".join(parts)
    inputs = sum(v.causality == "input" for v in table)
    assert all(v.causality == "input" for v in table[:inputs])

    def in_record(*names: str) -> list[int]:
        """Return the places of fields of the record in the block."""
        return [record + _field(RECORD, name)[1] for name in names]

    head = _HEAD.pack(
        *(MAGIC, sources.encode(), guid.encode(), LARGEST, 0),
        *(_HEAD.size + len(body), len(table), observed_at, inputs),
        *(index["tau_drive" if is_free else "speed"], is_free),
        *(len(GIVEN), 1 + NAMES.index("tolerance")),
        *(len(writes) // _ROW.size, len(needs), len(sentences), len(spans) // _SPAN.size),
        *(len(block), *(LAYOUT.extent(block, group).stop for group in ("memory", "tangent"))),
        *in_record("is_free", "continues", "stops_at_contact", "has_sensitivities"),
        *in_record("is_past_limit"),
        *(where[f"memory.{name}"] for name in ("loads", "load_rates")),
        *(where["outputs.observed"], where["outputs.derivatives"]),
        *in_record("t", "t_of_host", "omega", "alpha", "drive"),
        *in_record("surveyed_at", "surveyed_from", "surveyed_to"),
        *begins,
    )
    sum_of_all = struct.pack("<Q", checksum(head + body, CHECKSUM_AT))
    return head[:CHECKSUM_AT] + sum_of_all + head[CHECKSUM_AT + len(sum_of_all) :] + body


def checksum(content: bytes, but: int) -> int:
    """Return the checksum of all but the 8 bytes at the place `but`, as `checksum` in c/table.c."""
    total = 0xCBF29CE484222325
    for at, (word,) in enumerate(struct.iter_unpack("<Q", content)):
        if 8 * at != but:
            total = ((total ^ word) * 0x9E3779B97F4A7C15) % 2**64
            total ^= total >> 29
    return total


def _field(record: np.dtype, name: str) -> tuple[np.dtype, int]:
    """Return the type and the offset of a field of a record."""
    assert record.fields is not None
    kind, at = record.fields[name][:2]
    return kind, at


def _offset(block: np.ndarray, i: int) -> int:
    """Return where an array of the layout begins in a block [bytes]."""
    header = block[: 8 * LAYOUT.header_length].view(np.int64)
    return int(header[1 + len(LAYOUT.size_names) + i])


def _rows(
    rotor: Rotor, table: Sequence[Variable], is_free: bool, texts: _Texts, observed_at: int
) -> list[bytes]:
    quantities = {name: of.quantity for name, of in rotor.parameters().items()}
    quantities |= {name: of for name, _, of, _ in coupling_parameters(is_free)}
    outputs = {str(name): output for name, output in observed(rotor)}
    loads = [name for pair in load_names(rotor) for name in pair]
    rows = []
    for i, v in enumerate(table):
        role, at, unset, shift = MACHINE, 0, math.nan, 0.0
        if v.name in _ROLES:
            role = _ROLES[v.name]
        elif v.causality == "input":
            role, at = LOAD, loads.index(v.name)
        elif v.name in _SETTINGS:
            role, at, (unset, shift) = SETTING, _SETTINGS[v.name], meaning(v)
        elif v.is_observed:
            role = READ if outputs[v.name].is_of_now else REMEMBERED
        if v.is_observed:
            at = i - observed_at
        elif role == MACHINE:
            at = int(v.is_tunable)
        rows.append(_row(texts, v, quantities.get(v.name), (role, at), (unset, shift)))
    return rows


def _row(
    texts: _Texts,
    v: Variable,
    quantity: Quantity | None,
    role: tuple[int, int],
    setting: tuple[float, float],
) -> bytes:
    rule = quantity.rule if quantity else _SETTING_RULES.get(v.name, ANY)
    unit = f" {quantity.unit}" if quantity and quantity.unit != "1" else ""
    return _VARIABLE.pack(
        *(_HEAD.size + texts.place(t) for t in (v.name, unit, rule.words)),
        *(KINDS.index(v.kind), *role, rule.is_strict),
        float(v.start or 0.0),
        -math.inf if v.low is None else v.low,
        math.inf if v.high is None else v.high,
        *setting,
        rule.least,
        rule.most,
    )


def _record_writes(is_free: bool, index: dict[str, int], record: int) -> list[bytes]:
    """Return each parameter of the coupling with its place in the block."""
    rows = []
    for name, field, _, _ in coupling_parameters(is_free):
        kind, at = _field(RECORD, field)
        rows.append(_ROW.pack(index[name], record + at, kind.kind == "i"))
    return rows


def _writes(rotor: Rotor, index: dict[str, int], where: dict[str, int]) -> list[bytes]:
    """Return each parameter of the machine with its places in the block."""
    fields = {field.path: field.dtype for field in LAYOUT.fields}
    rows = []
    for name, of in parameter_locations(rotor).items():
        for place in of:
            path = f"structure.{place.member}"
            kind, at = _field(fields[path], place.field)
            byte = where[path] + place.row * fields[path].itemsize + at
            rows.append(_ROW.pack(index[str(name)], byte, kind.kind == "i"))
    return rows
