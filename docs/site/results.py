"""Make the page of all results as numbers from the docstrings of the classes that hold them."""

import inspect
import re
from collections.abc import Iterator
from functools import cached_property
from typing import Any, get_args, get_type_hints

from rotor_fmu.balancing.result import Balancing
from rotor_fmu.linear import acceptance, answers, bearing_answers, frequency_answers, inventory
from rotor_fmu.linear.linear_tables import names_of
from rotor_fmu.linear.mode_answers import Modes
from rotor_fmu.linear.stability_answers import StabilityLevel1, StabilityLevel2
from rotor_fmu.periodic.result import ResponseResult
from rotor_fmu.runs.summary import summary
from rotor_fmu.runs.verify_run import Verification
from rotor_fmu.studies.analysis import analyse

# the classes whose fields are the keys of what a command prints, each with what it holds
ANSWERS: dict[str, tuple[type, ...]] = {
    "modes": (Modes,),
    "campbell": (answers.Campbell,),
    "static": (answers.Static,),
    "show": (inventory.Inventory,),
    "critical-map": (acceptance.CriticalMap,),
    "unbalance": (answers.UnbalanceResponse, acceptance.CriticalPeaks, acceptance.UnbalanceCheck),
    "stability": (StabilityLevel1, StabilityLevel2),
    "balance": (Balancing,),
    "frequency-response": (frequency_answers.FrequencyResponse, frequency_answers.Sensitivity),
    "bearing": (
        bearing_answers.BearingCurves,
        bearing_answers.RingCurves,
        bearing_answers.DamperCurves,
        bearing_answers.RollingCurves,
    ),
}
# what is found under a key of another answer
UNDER = {acceptance.CriticalPeaks: "criticals", acceptance.UnbalanceCheck: "check"}
HEAD = """# Results as numbers

Made from the code (`make pages`). With `--json` a command prints its result as JSON, which it also
writes to its folder: `summary.json` of a run, `response.json`, `analysis.json` of a study, and
`modes.json` and so on of a linear analysis. Keys are the attributes of what Python returns for the
same call, such as `rf.load().modes(0.0)`. All is in SI units whatever `--units` says, except where
a key ends in another one. Complex numbers are pairs of real and imaginary part, arrays are nested
lists by the shapes below, and null stands for what is not finite or not there. Nodes count from 1,
as in tables; modes, which are places in the lists, from 0.
"""
# names at the beginning of what is said about them, with or without unit
_NAMED = r"\w+(?:, \w+)*(?=: | \[\S+\])"
OF_OPTIONS = """folds: of `--fold-over`: name of the second quantity, first and second: the
parameter and that quantity along the curve of folds, ends in words; check: of `--check`,
motions integrated in time: value of the parameter, whether the motion is stable and whether the
run stays on it, and its distance from it at the end, as a share of the orbit [1]."""
OF_A_COMMAND = """recorded_steps: rows of the recording; recorded_apart: by how much the run
without the FMU, of which the pictures are, ends apart, as a share of full scale [1], None
without an FMU; stop_s: end of the run [s]; stop_by: what set it; wall_s: time that the command
took [s]; out: its folder; verification: of `--verify`, else None, as below."""


def described(kind: type) -> list[str]:
    """Return the paragraphs about a class."""
    paragraphs = (inspect.getdoc(kind) or "").split("\n\n")
    return [_line(text) for text in paragraphs if not text.startswith("`model.")]


def derived(kind: type) -> dict[str, str]:
    """Return the keys of a class that are properties, each with its text."""
    values = {name: getattr(kind, name, None) for name in names_of(kind)}
    texts = {
        name: inspect.getdoc(value.fget if isinstance(value, property) else value.func) or ""
        for name, value in values.items()
        if isinstance(value, (property, cached_property))
    }
    return {name: text for name, text in texts.items() if text}


def within(kind: type) -> Iterator[type]:
    """Yield the classes of the fields of a class, and what these hold in turn."""
    for hint in get_type_hints(kind).values():
        for part in _parts(hint):
            if is_answer(part):
                yield part
                yield from within(part)


def is_answer(kind: Any) -> bool:
    """Whether a class has fields that are keys."""
    return hasattr(kind, "__dataclass_fields__") or hasattr(kind, "_fields")


def _parts(hint: Any) -> Iterator[Any]:
    yield hint
    for argument in get_args(hint):
        yield from _parts(argument)


def _entry(kind: type) -> list[str]:
    """Return the lines about a class: its keys, what is written about it, and its properties."""
    under = f", under `{UNDER[kind]}`" if kind in UNDER else ""
    keys = ", ".join(f"`{name}`" for name in names_of(kind))
    lines = [f"**{kind.__name__}**{under}: {keys}", ""]
    lines += [line for text in described(kind) for line in _listed(text)]
    properties = derived(kind).items()
    return [*lines, *(f"- `{name}`: {_line(text)}" for name, text in properties), ""]


def _line(text: str) -> str:
    return " ".join(text.split())


def _listed(text: str) -> list[str]:
    """Return the lines of a paragraph: a list where it is one of names and what they mean."""
    items = re.split(rf"; (?={_NAMED})", text)
    if not re.match(_NAMED, items[0]):
        return [text, ""]
    return [*(re.sub(_NAMED, _in_code, item, count=1) for item in items), ""]


def _in_code(match: re.Match[str]) -> str:
    return f"- {', '.join(f'`{name}`' for name in match[0].split(', '))}"


def _plain(heading: str, text: str | None, *more: str) -> list[str]:
    """Return a section of what a docstring says below its first sentence, and more."""
    paragraphs = [*inspect.cleandoc(text or "").split("\n\n")[1:], *more]
    return [heading, "", *(line for p in paragraphs for line in _listed(_line(p)))]


def page() -> str:
    """Return the whole page."""
    lines = [HEAD]
    lines += _plain("## `run-down` and `run-up`", summary.__doc__, OF_A_COMMAND)
    lines += _plain("**verification**", Verification.figures.__doc__)
    lines += _plain("## `response`", ResponseResult.summary.__doc__, OF_OPTIONS)
    lines += _plain("## `study --analyse`", analyse.__doc__)
    for command, kinds in ANSWERS.items():
        lines += [f"## `{command}`", ""]
        for kind in dict.fromkeys(k for top in kinds for k in (top, *within(top))):
            lines += _entry(kind)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).rstrip() + "\n"
