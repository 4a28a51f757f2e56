"""The events of a response in a file, so that the same call goes on where an earlier one stopped.

FOLDER/points.jsonl     first what the response is of, then an event a line, whole or not counted
"""

import base64
import json
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..about import __version__
from ..files import named, only_call, write_text
from ..model.message_templates import Message
from ..model.periodic.arclength import CurvePoint
from ..model.periodic.balance import Orbit
from ..model.periodic.branch import NO_MOTION, Bifurcation, Solution
from ..model.periodic.checkpoint import BranchStart, EndEvent, Event, EventLog, StartEvent
from ..model.periodic.problem import Note
from ..model.periodic.tracer import TracedPoint, TracerState

FILE, LOCK = "points.jsonl", "points.lock"
_OF_CURVES = (Orbit, CurvePoint, TracerState, Solution, Bifurcation, TracedPoint)
_KINDS: Mapping[str, Callable[..., Any]] = {
    kind.__name__: kind for kind in (*_OF_CURVES, BranchStart, StartEvent, EndEvent)
}


class Saved(NamedTuple):
    """An event log that is saved, and how many points an earlier call had come to."""

    log: EventLog
    before: int


@contextmanager
def saved_log(folder: Path, toml: str, options: Mapping[str, Any]) -> Iterator[Saved]:
    """The event log of a response in a folder; one of another machine, options or version is begun
    anew. A line that an earlier call did not finish is dropped. Raises `InputError` while another
    call writes one there; an `OSError`, as of a full disk, has the file's name."""
    path = folder / FILE
    given = json.dumps([__version__, toml, options], sort_keys=True, default=str)
    head = json.dumps({"response": sha256(given.encode()).hexdigest()})
    events: list[Event] = []
    with only_call(folder / LOCK), named(path):
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True) if path.exists() else []
        whole = [head + "\n"]
        if lines and lines[0] == whole[0]:
            for line in lines[1:]:
                try:
                    events.append(_decoded(json.loads(line)))
                except (ValueError, KeyError, TypeError):
                    break
                whole.append(line)
        write_text("".join(whole), path)
        with path.open("a", encoding="utf-8") as file:

            def write(event: Event) -> None:
                file.write(json.dumps(_encoded(event)) + "\n")
                file.flush()

            before = sum(isinstance(event, TracedPoint) for event in events)
            yield Saved(EventLog(events, write), before)


def _encoded(thing: Any) -> Any:
    if isinstance(thing, Note):
        return {"note": thing.__getnewargs__()}
    if isinstance(thing, Message):
        return {"message": [str(thing), thing.code]}
    if isinstance(thing, (Solution, Bifurcation)):  # the motion follows from the orbit
        thing = thing._replace(motion=NO_MOTION)
    if isinstance(thing, tuple) and type(thing).__name__ in _KINDS:
        return {type(thing).__name__: [_encoded(field) for field in thing]}
    if isinstance(thing, np.ndarray):
        data = base64.b64encode(np.ascontiguousarray(thing).tobytes()).decode("ascii")
        return {"array": [thing.dtype.str, thing.shape, data]}
    if isinstance(thing, (list, tuple)):
        return [_encoded(each) for each in thing]
    if isinstance(thing, complex):
        return {"complex": [thing.real, thing.imag]}
    return thing.item() if isinstance(thing, np.generic) else thing


def _decoded(thing: Any) -> Any:
    if isinstance(thing, list):
        return [_decoded(each) for each in thing]
    if not isinstance(thing, dict):
        return thing
    ((kind, value),) = thing.items()
    if kind == "note":
        return Note(*value)
    if kind == "message":
        return Message(*value)
    if kind == "array":
        dtype, shape, data = value
        return np.frombuffer(base64.b64decode(data), np.dtype(dtype)).reshape(shape).copy()
    if kind == "complex":
        return complex(*value)
    return _KINDS[kind](*_decoded(value))
