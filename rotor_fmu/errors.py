"""How the command line ends: one line on standard error and a status."""

import os
import re
import shutil
import sys
import tomllib
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any, NoReturn

from .model.arguments import check_integer as check_integer
from .model.arguments import check_one_of as check_one_of
from .model.arguments import check_positive as check_positive
from .model.arguments import is_one_of as is_one_of
from .model.arguments import listed as listed
from .model.arguments import mapped as mapped
from .model.arguments import number as number
from .model.arguments import numbers as numbers
from .model.arguments import path_of as path_of
from .model.arguments import shown_value as shown_value
from .model.arguments import switch as switch
from .model.errors import InputError as InputError
from .model.errors import printable as printable
from .model.near_names import meant as meant

if TYPE_CHECKING:
    import typer

FAILED, BAD_INPUT, INTERRUPTED = 1, 2, 130
NO_OTHERS: Mapping[str, str] = {}
_made: list[Path] = []  # folders that were not there before, the deepest of each first


class RunFailed(RuntimeError):
    """A run that failed and left nothing to return.

    >>> import rotor_fmu as rf
    >>> try:
    ...     raise rf.RunFailed("the FMU cannot be instantiated")
    ... except rf.RunFailed as error:
    ...     print(error)
    the FMU cannot be instantiated
    """


def run(app: Callable[..., int | None]) -> None:
    """Run a typer application; end the process with a status and, if it failed, one line."""
    import typer  # which takes longer than the first step of a run

    try:
        status = app(standalone_mode=False) or 0
    except typer.Exit as error:
        status = error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        status = INTERRUPTED
    except RunFailed as error:
        _end(str(error), FAILED)
    except typer.TyperException as error:
        if not error.format_message():  # the help was printed, nothing being asked
            sys.exit(0)
        _end(_one_line(error), BAD_INPUT)
    except InputError as error:
        _end(_as_typed(str(error)), BAD_INPUT)
    except OSError as error:
        _end(_unreachable(error), FAILED)
    if status == INTERRUPTED:  # which typer may have made of Ctrl-C by itself
        end_stopped()
    sys.exit(status)


def end_stopped() -> NoReturn:
    """End the process after Ctrl-C."""
    _end("stopped; nothing unfinished was written", INTERRUPTED)


def _one_line(error: "typer.TyperException") -> str:
    """Return the parser's error in one line: of a value that cannot be read the option once, with
    what was typed behind it; of a missing argument its name as the help shows it; of one too many
    what a machine file follows; of an option before the command where it belongs."""
    param: Any = getattr(error, "param", None)
    if getattr(param, "param_type_name", "") == "argument" and hasattr(error, "param_type"):
        return f"{param.metavar or param.name.upper()}: must be given"
    for option in getattr(param, "opts", ()):
        if values := _typed().get(option):
            reason = " ".join(str(getattr(error, "message", error)).split())
            said = re.sub(r"^Input should (.*?)(, unable .*)?$", r"must \1", reason)
            return printable(f"{option} {', '.join(values)}: {said}")
    command: Any = getattr(getattr(error, "ctx", None), "command", None)
    options = [option for of in getattr(command, "params", ()) for option in of.opts]
    is_extra = "extra argument" in error.format_message() and "--rotor" in options
    hint = ["a machine file follows --rotor"] if is_extra else []
    if hasattr(command, "commands") and not getattr(error, "possibilities", True):
        hint = ["options follow the command"]
    return "; ".join([" ".join(error.format_message().split()), *hint])


def _typed() -> dict[str, list[str]]:
    """Return the options of the command line with the values behind each, in its order."""
    typed: dict[str, list[str]] = {}
    for word, after in zip(sys.argv[1:], [*sys.argv[2:], ""], strict=True):
        if word.startswith("-"):
            option, equals, value = word.partition("=")
            typed.setdefault(option, []).append(value if equals else after)
    return typed


def _as_typed(message: str) -> str:
    """Return an error message with the option that was typed for the argument of Python in it:
    `--contacts x: ...` of `contacts = x: ...`, `--load: ...` of `loads: ...`, `--pp: ...` of
    `is_pp: ...`."""
    if match := re.match(r"(\w+)(?: (=) |: )", message):
        name, equals = match.groups()
        for word in (name.replace("_", "-"), name.removesuffix("s"), name.removeprefix("is_")):
            if (option := f"--{word}") in _typed():
                return f"{option}{' ' if equals else ': '}{message[match.end() :]}"
    return message


def _unreachable(error: OSError) -> str:
    """Return in one line what cannot be read or written, and why, such as a full disk."""
    if isinstance(error, shutil.Error):  # of a folder: a file each
        _, file, reason = error.args[0][0]
    else:
        file, reason = error.filename, error.strerror or str(error)
    if number := re.search(r"\[Errno (\d+)\]", reason):  # as of another process
        reason = os.strerror(int(number[1]))
    return f"{file or 'a file or the output'}: cannot be read or written: {reason}"


def _end(message: str, status: int) -> NoReturn:
    for folder in _made:  # what failed leaves none behind that it wrote nothing into
        with suppress(OSError):
            folder.rmdir()
    print(f"rotor-fmu: {message}", file=sys.stderr)
    sys.exit(status)


def optional(module: str, extra: str, what: str) -> Any:
    """Return a module that an extra of this package brings; `InputError` without it."""
    try:
        return import_module(module)
    except ImportError:
        package = module.partition(".")[0]
        raise InputError(
            f"{what}: {package} is not installed: pip install 'rotor-fmu[{extra}]'"
        ) from None


def known_name(
    where: str,
    name: str,
    known: Iterable[str],
    others: Mapping[str, str] = NO_OTHERS,
    why_not: Callable[[str], str] = lambda _: "",
) -> str:
    """Return the name itself if it is known, else `InputError` with what may be meant; where: what
    it is of; others: the known names by what they are called elsewhere; why_not: returns why a name
    is not among them, empty of one that is nowhere."""
    known = tuple(known)
    if name not in known:
        right = others.get(name)
        hint = f"did you mean {right}?" if right in known else meant(name, known)
        reason = why_not(name) or f"unknown name; {hint}"
        raise InputError(f"{where} {name}: {reason}".strip())
    return name


_FILES = (".csv", ".fmu", ".html", ".json", ".pdf", ".png", ".svg", ".toml")


def writable_folder(path: Path, option: str = "--out") -> Path:
    """Return the folder, made if need be; `InputError` with the option that gave it if it cannot be
    written to, or is new and called like a file. A command that fails removes what it made so, if
    nothing was written there."""
    if path.suffix.lower() in _FILES and not path.exists():
        raise InputError(f"{option} {path}: is a folder for files, and is called like one of them")
    if "\0" in str(path):
        raise InputError(f"{option} {path}: cannot be written to: has a NUL in its name")
    try:
        _made.extend(folder for folder in (path, *path.parents) if not folder.exists())
        path.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=path):
            pass
    except OSError as error:
        reason = error.strerror or str(error)
        raise InputError(f"{option} {path}: cannot be written to: {reason}") from error
    return path


def writable_file(path: Path, what: str, option: str = "--out") -> None:
    """Make the folder of a file that is to be written; `InputError` with the option that gave it if
    that cannot be, or if a folder, a device or a pipe is there, which a file would replace; what:
    whose name it is, such as `the page's`."""
    writable_folder(path.parent, option)
    if path.is_dir():
        raise InputError(f"{option} {path}: is a folder; give {what} name in it")
    if path.exists() and not path.is_file():
        raise InputError(f"{option} {path}: is a device or a pipe, not a file")


MOST_ROWS = 2e6  # of a run at its communication points, all of which are in memory
_MOST_BYTES = 64_000_000  # of a text file that a user may name


def read_text(option: str, path: Path) -> str:
    """Return a text file that a user named, by an option or alone; `InputError` if it cannot be
    read, or is a device or a pipe, which might have no end."""
    given = f"{option} {path}".lstrip().replace("\0", "\\0")
    try:
        if not path.is_file():
            path.stat()  # says why there is none
            kind = "is a folder" if path.is_dir() else "is not a file"
            raise InputError(f"{given}: cannot be read: {kind}")
        size = path.stat().st_size
        if size > _MOST_BYTES:
            raise InputError(f"{given}: has {size} bytes; must have at most {_MOST_BYTES}")
        return path.read_text(encoding="utf-8-sig")  # some editors begin with a mark of it
    except OSError as error:
        reason = error.strerror or str(error)
    except UnicodeDecodeError:
        reason = "not UTF-8 text"
    except ValueError as error:  # a NUL in the path
        if isinstance(error, InputError):
            raise
        reason = str(error)
    raise InputError(f"{given}: cannot be read: {reason}")


def toml_tables(where: str, text: str) -> dict[str, Any]:
    """Return the tables of a TOML text that a user wrote; `InputError`, which begins with `where`,
    for anything else."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # also a number of thousands of digits
        raise InputError(f"{where}: is not valid TOML: {error}") from error
