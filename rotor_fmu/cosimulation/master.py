"""A Jacobi master: at each communication point every FMU gets the others' last outputs, then all
step."""

import math
import re
import reprlib
from array import array
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..errors import (
    MOST_ROWS,
    InputError,
    RunFailed,
    check_positive,
    known_name,
    listed,
    mapped,
    path_of,
)
from ..files import unfinished
from ..fmi.variables import are_alike
from ..interrupts import interrupts_noted
from ..model.message_templates import Message
from ..model.simulation import warn
from ..run_status import OK, status_of
from . import MOST_STEPS, check_steps
from .member import EndedEarly, Member

_WHOLE = 1e-6  # of a step, by which a run of whole steps may miss its end
# Of initial values: how often they are passed on at most, and the change that is none [1].
_PASSES, _SETTLED = 100, 1e-9
_SAME = 1e-6  # difference of an input from its output at the start that is none [1]
NONE: Mapping[str, Any] = {}


class Connection(NamedTuple):
    """An output and the input that takes its value, each by the name of its FMU and its own."""

    sender: str
    output: str
    receiver: str
    input: str


class Point(NamedTuple):
    """A communication point t [s], and the values there of each FMU by name."""

    t: float
    values: Mapping[str, Mapping[str, float]]


@dataclass(frozen=True)
class CoupledRun:
    """A coupled run at its communication points t [s]: `run[FMU][VARIABLE]` is what was read of an
    FMU; each of shape (n,). status: see `run_status`; `failed: ` and why where the run ended
    early; messages: what was said, of which FMU."""

    t: np.ndarray
    values: Mapping[str, Mapping[str, np.ndarray]]
    status: str = OK
    messages: Sequence[str] = ()

    def __getitem__(self, fmu: str) -> Mapping[str, np.ndarray]:
        return self.values[fmu]

    def save(self, path: Path) -> None:
        """Write the run to a .npz file, whole or not at all."""
        columns: dict[str, Any] = {
            f"{fmu} {name}": column
            for fmu, recorded in self.values.items()
            for name, column in recorded.items()
        }
        with unfinished(path) as part:
            said = np.array(self.messages, dtype=str)
            np.savez_compressed(part, t=self.t, status=self.status, messages=said, **columns)

    @classmethod
    def load(cls, path: Path) -> "CoupledRun":
        """Read a run that `save` wrote."""
        values: dict[str, dict[str, np.ndarray]] = {}
        with np.load(path) as data:
            for key in data.files:
                fmu, _, name = key.partition(" ")
                if name:
                    values.setdefault(fmu, {})[name] = data[key]
            messages = tuple(map(str, data.get("messages", ())))
            return cls(data["t"], values, str(data.get("status", OK)), messages)


@dataclass(frozen=True)
class CoupledFmus:
    """FMUs in the initialization mode by name, their connections, the names of the variables to
    read of each, what has been said of the run so far, and the end of the run [s]."""

    members: Mapping[str, Member]
    connections: Sequence[Connection]
    read: Mapping[str, Sequence[str]]
    messages: list[Message]
    stop: float

    def points(self, step: float, most: float = MOST_STEPS) -> Iterator[Point]:
        """Yield the communication points, `step` [s] apart, the last after what is left of a step;
        all FMUs leave the initialization mode at the first. Raises `RunFailed`, which is
        `EndedEarly` where an FMU has not failed but ends the run, and `InputError` for a step that
        is not positive and finite, or so short that there are more than `most`, or that leaves a
        shorter one at the end to an FMU that takes equal steps only."""
        check_positive("step", step, "s")
        stop = self.stop
        check_steps(f"step = {step:g} s", f"stop = {stop:g} s", stop / step, most)
        is_whole = step >= stop or abs(stop - round(stop / step) * step) <= _WHOLE * step
        for name, member in self.members.items():
            if not (is_whole or member.takes_any_step):
                reason = f"{name} takes equal steps only"
                raise InputError(f"step = {step:g} s: must divide stop = {stop:g} s: {reason}")
        inputs = {to: [c for c in self.connections if c.receiver == to] for to in self.members}
        for member in self.members.values():
            member.begin()
        point = self._at(0.0)
        self._warn_of_jumps(point)
        yield point
        for n in count():
            for name, member in self.members.items():
                passed = {c.input: point.values[c.sender][c.output] for c in inputs[name]}
                outputs = [f"{c.sender}.{c.output}" for c in inputs[name]]
                with _said_where(f"with {', '.join(outputs)} at t = {point.t:g} s"):
                    member.set(passed)
            end = (n + 1) * step
            is_cut = end > stop + _WHOLE * step
            for member in self.members.values():
                with _said_where(f"in the step from t = {point.t:g} s"):
                    member.step(n * step, stop - n * step if is_cut else step)
            point = self._at(stop if is_cut else end)
            yield point
            if end >= stop - _WHOLE * step:
                return

    def run(self, step: float, progress: Callable[[float], None] = lambda t: None) -> CoupledRun:
        """Run with the communication step `step` [s], and return what was read; up to the last
        communication point that all FMUs have reached where one of them ends the run early.

        progress: called with the time [s] at each communication point, ends the run by raising.
        Errors are those of `points`; Ctrl-C ends the run between two steps.
        """
        rows, failure = [], None
        try:
            with interrupts_noted() as interrupts:
                for point in self.points(step, MOST_ROWS):
                    seen = (point.values[fmu][name] for fmu in self.read for name in self.read[fmu])
                    rows.append(array("d", (point.t, *seen)))
                    progress(point.t)
                    if interrupts:
                        raise KeyboardInterrupt
        except EndedEarly as error:
            failure = str(error)
        t, *columns = np.array(rows).T
        left = iter(columns)
        values = {fmu: {name: next(left) for name in names} for fmu, names in self.read.items()}
        said = tuple(map(str, self.messages))
        return CoupledRun(t, values, status_of(self.messages, failure), said)

    def _warn_of_jumps(self, start: Point) -> None:
        """Warn of inputs that do not start with the values of their outputs."""
        for c in self.connections:
            output = start.values[c.sender][c.output]
            taken = self.members[c.receiver].get([c.input])[c.input]
            if not math.isclose(taken, output, rel_tol=_SAME, abs_tol=_SETTLED):
                text = (
                    f"{c.receiver}.{c.input} = {taken:.6g} at the start, where {c.sender}."
                    f"{c.output} = {output:.6g}: it jumps in the first step"
                )
                self.messages.append(Message(text, "start-jump"))
                warn(self.messages[-1])

    def _at(self, t: float) -> Point:
        with _said_where(f"read at t = {t:g} s"):
            return Point(t, {of: self.members[of].get(read) for of, read in self.read.items()})


@contextmanager
def coupled(
    fmus: Mapping[str, Path],
    connections: Any,
    initial: Any = (),
    parameters: Mapping[str, Mapping[str, Any]] = NONE,
    recorded: Mapping[str, Sequence[str]] = NONE,
    tables: tuple[str, str] = ("connections", "initial"),
    *,
    stop: float,
    tolerance: float | None = None,
) -> Iterator[CoupledFmus]:
    """Yield FMUs in the initialization mode, with their initial values exchanged.

    fmus: files of FMUs, or the folders into which they were extracted, by name, a word without a
    dot; connections: pairs (output, input), each `FMU.VARIABLE`, passed on at every communication
    point, and now what is an output, unless `initial` or `parameters` give the input a value;
    initial: pairs passed on now, one after another and before those; parameters: of each FMU by
    name, set before the initialization; recorded: variables of each FMU to read beside those that
    are passed on; tables: how messages call the two lists of pairs; stop: end of the run [s];
    tolerance: relative, of the run [1], by default each FMU's own. Raises `RunFailed` where a call
    of one of the FMUs fails, and `InputError`, before any of them is loaded, for an unknown name,
    several of an FMU of which there can be one, a pair that connects other units, an input that has
    its value from another pair, and a stop or tolerance that is not positive and finite; then for
    initial values that do not settle.
    """
    check_positive("stop", stop, "s")
    if tolerance is not None:
        check_positive("tolerance", tolerance)
    fmus = {
        _word(name): path_of(f"fmus: {name}", fmu) for name, fmu in mapped("fmus", fmus).items()
    }
    parameters, recorded = mapped("parameters", parameters), mapped("recorded", recorded)
    for what, given in (("parameters:", parameters), ("recorded:", recorded)):
        for name in given:
            known_name(what, name, fmus)
    parameters = {name: mapped(f"parameters: {name}", of) for name, of in parameters.items()}
    recorded = {name: listed(f"recorded: {name}", of, "names") for name, of in recorded.items()}
    always, first = (
        [_connection(table, row, fmus) for row in check_rows(table, rows, "output", "input")]
        for table, rows in zip(tables, (connections, initial), strict=True)
    )
    messages: list[Message] = []
    members = {
        name: Member(fmu, parameters.get(name, {}), messages, stop, tolerance, name)
        for name, fmu in fmus.items()
    }
    for table, passed, settable in (
        (tables[1], first, ("input", "parameter")),
        (tables[0], always, ("input",)),
    ):
        for connection in passed:
            _check(table, connection, members, settable)
    for taken, outputs in Counter((c.receiver, c.input) for c in always).items():
        if outputs > 1:
            raise InputError(
                f"{tables[0]}: {'.'.join(taken)}: has {outputs} outputs; must have one"
            )
    for single, instances in Counter(m.single for m in members.values() if m.single).items():
        if instances > 1:
            of_one = ", ".join(name for name, m in members.items() if m.single == single)
            raise InputError(f"fmus: {of_one}: are of one FMU, which can be there only once")
    read = {name: dict.fromkeys(c.output for c in always if c.sender == name) for name in fmus}
    for name, names in recorded.items():
        read[name] |= {members[name].readable(variable).name: None for variable in names}
    with ExitStack() as open_members:
        for member in members.values():
            open_members.enter_context(member)
        has_value = {(c.receiver, c.input) for c in first}
        has_value |= {(name, of) for name, values in parameters.items() for of in values}
        of_all = [
            c
            for c in always
            # of what else may be asked for in the initialization FMI 2.0 says nothing
            if members[c.sender].variable(c.output).causality == "output"
            and (c.receiver, c.input) not in has_value
        ]
        _exchange_initially(members, [*first, *of_all])
        seen = {name: tuple(names) for name, names in read.items()}
        yield CoupledFmus(members, always, seen, messages, stop)


@contextmanager
def _said_where(where: str) -> Iterator[None]:
    """Add to the message of a call that fails where it did: few FMUs say it themselves."""
    try:
        yield
    except EndedEarly:
        raise
    except RunFailed as error:
        raise RunFailed(f"{error}; {where}") from error


def _exchange_initially(members: Mapping[str, Member], connections: Sequence[Connection]) -> None:
    """Pass initial values on, one after another, and again until none changes: those of a chain
    settle in whatever order, those of a loop if it weakens what goes around it."""
    passed: dict[Connection, float] = {}
    changed: list[Connection] = []
    for _ in range(_PASSES):
        changed = []
        for c in connections:
            value = members[c.sender].get([c.output])[c.output]
            if not math.isclose(passed.get(c, math.nan), value, rel_tol=_SETTLED):
                members[c.receiver].set({c.input: value})
                passed[c] = value
                changed.append(c)
        if not changed:
            return
    c = changed[0]
    raise InputError(
        f"{c.sender}.{c.output}, {c.receiver}.{c.input}: the initial values do not settle, "
        f"{passed[c]:g} is the last; give {c.receiver}.{c.input} one in parameters"
    )


def _word(name: Any) -> str:
    """Return the name of an FMU; `InputError` for one that could not be told from a variable's in
    `FMU.VARIABLE`, or in a saved run, which has a space between the two."""
    if not (isinstance(name, str) and name.isprintable() and re.fullmatch(r"[^\s.]+", name)):
        raise InputError(f"fmus: {reprlib.repr(name)}: must be a word without a dot")
    return name


def check_rows(table: str, rows: Any, *columns: str) -> list[Any]:
    """Return the rows of a table, which begin with two words; `InputError` for others."""
    for row in rows if isinstance(rows, (list, tuple)) else [rows]:
        is_row = isinstance(row, (list, tuple)) and len(row) == len(columns)
        if not is_row or not all(isinstance(word, str) for word in row[:2]):
            raise InputError(f"{table}: {reprlib.repr(row)}: each must be ({', '.join(columns)})")
    return list(rows)


def _connection(table: str, row: Sequence[str], fmus: Mapping[str, Path]) -> Connection:
    """Return a pair as a connection; `InputError` unless it connects two of the FMUs."""
    (sender, _, output), (receiver, _, taken) = (end.partition(".") for end in row)
    if sender not in fmus or receiver not in fmus or sender == receiver:
        raise InputError(
            f"{table}: {row[0]!r}, {row[1]!r}: each must be FMU.VARIABLE, of different FMUs among "
            f"{', '.join(fmus)}"
        )
    return Connection(sender, output, receiver, taken)


def _check(
    table: str, c: Connection, members: Mapping[str, Member], settable: Sequence[str]
) -> None:
    """Raise `InputError` for a connection whose units differ, or that ends where nothing can be
    set."""
    sender, receiver = members[c.sender], members[c.receiver]
    output, taken = sender.readable(c.output), receiver.readable(c.input)
    is_tunable = (taken.causality, taken.variability) == ("parameter", "tunable")
    if taken.causality not in settable and not is_tunable:
        raise InputError(
            f"{table}: {c.receiver}.{c.input}: is of causality {taken.causality}; must be "
            f"{' or '.join(settable)}"
        )
    (one, is_one), (other, is_other) = sender.unit(output), receiver.unit(taken)
    is_same = are_alike(one, other) or (is_one is not None and is_one == is_other)
    if one and other and not is_same:
        raise InputError(
            f"{table}: {c.sender}.{c.output} [{one}], {c.receiver}.{c.input} "
            f"[{other}]: must have the same unit"
        )
