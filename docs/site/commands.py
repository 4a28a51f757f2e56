"""Make the page of all commands from the commands themselves."""

import inspect
from collections.abc import Callable, Iterator
from importlib import import_module
from typing import Annotated, Any, get_args, get_origin, get_type_hints

import typer

from rotor_fmu.cli import COMMANDS

HEAD = """# Commands

Made from the commands themselves (`make pages`); `rotor-fmu COMMAND --help` shows the same.
Invalid input is refused in one line, with exit status 2. Status 1 is a failed run, 130 a run
interrupted by Ctrl-C; neither leaves incomplete files.

Presets of the solver: `controlled` (the default: Chung-Hulbert, spectral radius 0.3, fitted to
the motion, steps by tolerance), `robust` (spectral radius 0.2, 0.5 ms), `paper` (0.1 / 0.08, 4
ms), `paper-adaptive` (4 to 20 ms), `moderate` (HHT, sqrt(2) - 1, 0.5 ms), `realtime` (0.2, 0.05
ms, at most 4 iterations). Change single settings with `--set solver.tolerance=1e-4`, or `--preset
robust --set solver.h=1e-4`. `--set solver.reduction=4` keeps four component modes of the shaft,
which saves time for a shaft of many elements; a warning names the modes that too few of them
would shift.
"""


def _functions(name: str, place: str) -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yield a command, or those of a group, with their functions."""
    module, _, attribute = place.partition(":")
    result = getattr(import_module(f"rotor_fmu.cli.{module}"), attribute)
    if isinstance(result, typer.Typer):
        for command in result.registered_commands:
            assert command.callback is not None
            yield f"{name} {command.name}", command.callback
    else:
        yield name, result


def _entry(name: str, function: Callable[..., Any]) -> list[str]:
    """Return the section of a command, with its options."""
    paragraphs = inspect.cleandoc(function.__doc__ or "").split("\n\n")
    lines = [f"### `rotor-fmu {name}`", ""]
    lines += [line for text in paragraphs for line in (" ".join(text.split()), "")]
    hints = get_type_hints(function, include_extras=True)
    rows = [
        _row(parameter, hints[parameter.name])
        for parameter in inspect.signature(function).parameters.values()
    ]
    return [*lines, "| | | |", "| --- | --- | --- |", *rows, ""] if rows else lines


def _row(parameter: inspect.Parameter, hint: Any) -> str:
    """Return the table row of an option or an argument: name, type, help with default."""
    kind, about = get_args(hint) if get_origin(hint) is Annotated else (hint, None)
    is_argument = isinstance(about, typer.models.ArgumentInfo)
    # typer stores an annotated option's first name in place of its default
    names = [n for n in (about.default, *(about.param_decls or ())) if str(n).startswith("--")]
    option = names[0] if names else f"--{parameter.name.replace('_', '-')}"
    name = (about.metavar or parameter.name.upper()) if is_argument else option
    kinds = [k for k in (get_args(kind) or (kind,)) if k is not type(None)]
    spoken = {bool: "", str: "text", float: "number", int: "integer"}
    inner = (get_args(kinds[0]) or kinds)[0]
    text = " ".join((about.help or "").split())
    if kind is not bool and parameter.default not in (None, "", inspect.Parameter.empty):
        text += f" Default: `{parameter.default}`."
    return f"| `{name}` | {spoken.get(inner, inner.__name__.lower())} | {_cell(text)} |"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


def page() -> str:
    """Return the whole page."""
    lines = [HEAD]
    for panel, places in COMMANDS.items():
        lines += [f"## {panel}", ""]
        for name, place in places.items():
            for command, function in _functions(name, place):
                lines += _entry(command, function)
    return "\n".join(lines).rstrip() + "\n"
