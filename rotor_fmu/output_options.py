"""The output options of commands: text, the same figures as JSON, or nothing."""

import inspect
import io
import math
import re
from collections.abc import Callable, Mapping
from contextlib import ExitStack, redirect_stderr, redirect_stdout
from functools import wraps
from json import dumps
from numbers import Integral
from pathlib import Path
from typing import Annotated, Any, get_origin, get_type_hints

from .display import restored
from .errors import RunFailed
from .files import write_text
from .run_status import FAILED, has_failed


def with_output_options(command: Callable[..., Mapping[str, Any]]) -> Callable[..., None]:
    """Give a command that returns its figures the options `--json` and `--quiet`; a `status` among
    the figures that begins with `failed: ` raises `RunFailed` once they are printed."""

    @wraps(command)
    def run_command(*, as_json: bool = False, is_quiet: bool = False, **options: Any) -> None:
        """Call the command and print what it returns."""
        with ExitStack() as stack:
            stack.enter_context(restored())
            if as_json or is_quiet:
                stack.enter_context(redirect_stdout(io.StringIO()))
            if is_quiet:
                stack.enter_context(redirect_stderr(io.StringIO()))
            figures = command(**options)
        if as_json:
            print(json_text(figures), end="")
        status = str(figures.get("status", ""))
        if has_failed(status):
            raise RunFailed(f"the run stopped before its end: {status.removeprefix(FAILED)}")

    options = _options()
    hints, run_command.__doc__ = _documented(command)
    hints |= options
    own = inspect.signature(command).parameters.values()
    added = [inspect.Parameter(n, inspect.Parameter.KEYWORD_ONLY, default=False) for n in options]
    run_command.__annotations__ = hints
    run_command.__signature__ = inspect.Signature(  # type: ignore[attr-defined]
        [parameter.replace(annotation=hints[parameter.name]) for parameter in (*own, *added)]
    )
    return run_command


def with_options_of(shared: Callable[..., Any]) -> Callable[[Callable[..., Any]], Any]:
    """Give a command the options of a function that several share, after its first argument."""

    def decorate(command: Callable[..., Any]) -> Callable[..., Any]:
        _, *options = inspect.signature(shared).parameters.values()
        hints, _ = _documented(shared)
        command.__annotations__ = {o.name: hints[o.name] for o in options}
        command.__signature__ = inspect.Signature(options)  # type: ignore[attr-defined]
        return command

    return decorate


def _documented(command: Callable[..., Any]) -> tuple[dict[str, Any], str]:
    """Return the annotations of a command with the help that its docstring gives each option, in a
    line `name: help`, and the docstring without these lines."""
    import typer

    hints = get_type_hints(command, include_extras=True)
    text, *helps = re.split(rf"^({'|'.join(hints)}): ", inspect.getdoc(command) or "", flags=re.M)
    for name, words in zip(helps[::2], helps[1::2], strict=True):
        if get_origin(hints[name]) is not Annotated:
            # of its own a flag would have a second one that denies it
            flag = [f"--{name.replace('_', '-')}"] if hints[name] is bool else []
            hints[name] = Annotated[hints[name], typer.Option(*flag)]
        hints[name].__metadata__[0].help = " ".join(words.split())
    return hints, text.rstrip()


def _options() -> dict[str, Any]:
    import typer  # which no run in Python needs

    return {
        "as_json": Annotated[
            bool, typer.Option("--json", help="Print the summary as JSON to standard output.")
        ],
        "is_quiet": Annotated[
            bool, typer.Option("--quiet", help="Print nothing but errors and the output of --json.")
        ],
    }


def json_text(figures: Mapping[str, Any]) -> str:
    """Return figures as JSON, which has no infinity: null where a number is not finite."""
    return dumps(as_json_value(figures), indent=2, allow_nan=False) + "\n"


def write_json(figures: Mapping[str, Any], path: Path) -> None:
    """Write figures as a JSON file, whole or not at all."""
    write_text(json_text(figures), path)


def as_json_value(value: Any) -> Any:
    """Return figures as JSON values: None where a number is not finite."""
    if isinstance(value, float):  # first: most are
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): as_json_value(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [as_json_value(item) for item in value]
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Integral) and not isinstance(value, bool):
        return int(value)
    return value
