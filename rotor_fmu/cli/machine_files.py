"""`rotor-fmu schema`, `example` and `import-ross`: what machine files hold, and where to begin."""

import json
import shutil
import tomllib
from importlib.resources import as_file, files
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Annotated, Any

import typer

from ..errors import InputError, check_one_of, printable, writable_file, writable_folder
from ..files import write_text
from ..output_options import with_output_options


def schema_command(
    as_page: Annotated[bool, typer.Option("--page", help="Print a page in Markdown.")] = False,
) -> None:
    """Print all tables and keys of a machine file, as a JSON schema for editors or as a page."""
    from ..machine_file.reference_page import page
    from ..machine_file.schema import schema

    typer.echo(page() if as_page else json.dumps(schema(), indent=2))


def _known() -> dict[str, Traversable]:
    return {
        folder.name: folder
        for folder in sorted(files("rotor_fmu.examples").iterdir(), key=str)
        if folder.is_dir() and folder.joinpath("README.md").is_file()
    }


def _examples(incomplete: str) -> list[str]:
    return [name for name in _known() if name.startswith(incomplete)]


def example(
    name: Annotated[
        str | None,
        typer.Argument(
            help="Name of an example; without it the command lists all.", autocompletion=_examples
        ),
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Folder to which the whole example is copied.")
    ] = None,
) -> None:
    """List the examples, print the machine file of one, or copy its folder."""
    known = _known()
    if name is None:
        for folder in known.values():
            title = folder.joinpath("README.md").read_text("utf-8").splitlines()[0].lstrip("# ")
            typer.echo(f"{folder.name:20s} {title}")
        return
    check_one_of(f"example {name}", name, known)
    if out is not None:
        _copy(known[name], writable_folder(out) / name)
        return
    machines = [entry for entry in known[name].iterdir() if entry.name.endswith(".toml")]
    if not machines:
        raise InputError(f"example {name}: has no machine file of its own; copy it with --out DIR")
    typer.echo(_whole(known[name], max(entry.name for entry in machines)), nl=False)


def _whole(folder: Traversable, name: str) -> str:
    """Return a machine file as it stands, or, as it is printed alone, with what it extends."""
    from ..machine_file.loading import machine_text

    text = folder.joinpath(name).read_text("utf-8")
    if "extends" not in tomllib.loads(text):
        return text
    with as_file(folder) as files_of_it:
        return f"# {name}, with what it extends\n\n{machine_text(name, files_of_it / name)}"


def _copy(folder: Traversable, target: Path) -> None:
    if target.exists():
        raise InputError(f"--out {target.parent}: {target.name} is there already")
    part = target.with_name(f"{target.name}.part")
    with as_file(folder) as source:
        try:
            shutil.copytree(source, part, ignore=shutil.ignore_patterns("__pycache__"))
            part.replace(target)
        finally:
            shutil.rmtree(part, ignore_errors=True)
    typer.echo(f"written to {target}")


@with_output_options
def import_ross(
    file: Annotated[Path, typer.Argument()], out: Path = Path("machine.toml")
) -> dict[str, Any]:
    """Convert a rotor that ROSS saved into a machine file.

    file: Rotor saved by ROSS, as TOML or JSON.
    out: The machine file to write; a file with other contents is not overwritten.
    """
    from ..machine_file.loading import import_ross as read
    from ..model.machine.toml_text import toml_text

    result = read("FILE", file)
    writable_file(out, "the machine's")
    head = f"# From {printable(file.name)}, a rotor that ROSS saved.\n"
    head += "".join(f"# {note}\n" for note in result.notes)
    text = f"{head}\n{toml_text(result.tables)}"
    if out.is_file() and out.read_text("utf-8", "replace") != text:
        raise InputError(
            f"--out {out}: is there already, and holds something else; remove it, or name another"
        )
    write_text(text, out)
    for note in result.notes:
        typer.echo(note)
    typer.echo(f"written to {out}")
    return {"notes": result.notes, "out": str(out)}
