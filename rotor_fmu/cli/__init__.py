"""`rotor-fmu`: the command line, of which only the command that is called is imported."""

import ast
import os
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from ..about import __version__
from ..errors import run
from ..threads import ONE_THREAD

_PACKAGE = Path(__file__).parent
# command: module beside this one and the function in it
_RUNS, _FMU, _LINEAR = "Runs", "FMUs", "Machines"
COMMANDS = {
    _RUNS: {
        "run-down": "runs:run_down",
        "run-up": "runs:run_up",
        "study": "studies:study",
        "plot": "plotting:plot",
        "report": "plotting:report",
        "page": "plotting:page",
    },
    _FMU: {
        "build": "fmus:build",
        "ssp": "fmus:ssp",
        "library": "fmus:libraries",
        "variables": "runs:variables",
        "host-env": "runs:host_env",
    },
    _LINEAR: {
        "show": "linear:show",
        "modes": "linear:modes",
        "campbell": "linear:campbell",
        "critical-map": "api_617:critical_map",
        "unbalance": "api_617:unbalance",
        "stability": "api_617:stability",
        "balance": "api_617:balance",
        "frequency-response": "linear:frequency_response",
        "static": "linear:static",
        "bearing": "bearings:bearing",
        "response": "periodic:response",
        "import-ross": "machine_files:import_ross",
        "example": "machine_files:example",
        "schema": "machine_files:schema_command",
    },
}
_PLACES = {name: place for panel in COMMANDS.values() for name, place in panel.items()}


class _Flags:
    """A command whose help shows no type beside a flag, which takes no value."""

    def get_params(self, ctx: Any) -> list[Any]:
        params: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if getattr(param, "is_flag", False):
                param.__dict__["display_type_rich"] = lambda ctx: None
        return params


class _Commands(_Flags, TyperGroup):
    """Commands that are known by name and by the first sentence of their docstring until called."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        for panel, places in COMMANDS.items():
            for name, place in places.items():
                # a stand-in, which the help lists
                self.add_command(TyperCommand(name, help=place, rich_help_panel=panel))

    def format_help(self, ctx: Any, formatter: Any) -> None:
        for name, command in self.commands.items():
            command.help = _summary(_PLACES[name])
        super().format_help(ctx, formatter)

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        name, command, rest = super().resolve_command(ctx, args)
        return name, name and command and _loaded(name), rest


class _Command(_Flags, TyperCommand):
    """A command that was loaded."""


def _summary(place: str) -> str:
    """Return the first sentence of a command's docstring without importing its module."""
    module, _, attribute = place.partition(":")
    tree = ast.parse(_PACKAGE.joinpath(*module.split(".")).with_suffix(".py").read_text("utf-8"))
    functions = (node for node in tree.body if isinstance(node, ast.FunctionDef))
    text = ast.get_docstring(next(f for f in functions if f.name == attribute)) or ""
    return " ".join(text.split("\n\n")[0].split())


def _loaded(name: str) -> Any:
    module, _, attribute = _PLACES[name].partition(":")
    alone = typer.Typer(add_completion=False)
    alone.command(name, cls=_Command)(getattr(import_module(f".{module}", __package__), attribute))
    command = typer.main.get_command(alone)
    command.name = name
    paragraphs = (command.help or "").split("\n\n")
    command.help = "\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs)
    return command


app = typer.Typer(cls=_Commands, no_args_is_help=True, pretty_exceptions_enable=False)


def main() -> None:
    """Entry point of the command `rotor-fmu`."""
    for name, count in ONE_THREAD.items():  # read when NumPy is imported
        os.environ.setdefault(name, count)
    run(app)


def _show_version(is_asked: bool) -> None:
    if is_asked:
        typer.echo(f"rotor-fmu {__version__}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Flexible rotors that rub in clearance bearings, as FMI co-simulation components."""
