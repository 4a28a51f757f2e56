"""Machines, runs and systems that the rotor is part of, a folder each."""

import re
import shutil
import sys
from pathlib import Path

from rotor_fmu.errors import InputError, writable_folder

_FOLDER = Path(__file__).resolve().parent


def example_folder(name: str = "") -> Path:
    """Return the folder of an example; without a name that of all examples."""
    return _FOLDER / name


def copy_system_files(folder: Path, out: Path) -> None:
    """Copy into the folder `out` the files that other masters need to run the system of an example
    in `folder`: its system files and the scripts that run them."""
    systems = [
        file for file in folder.iterdir() if file.suffix in (".xml", ".ssd", ".json", ".toml")
    ]
    for file in (*systems, *folder.glob("with_*.py"), *_FOLDER.glob("with_*.py")):
        shutil.copyfile(file, out / file.name)


def script_arguments(needed: int = 0) -> list[str]:
    """Return the arguments of the script that runs: as many as needed, and then, where it is given,
    the folder for its pictures, which is made. At others the script ends with its usage, the line
    of its text that begins with `python`, and status 2."""
    given, text = sys.argv[1:], sys.modules["__main__"].__doc__ or ""
    (line,) = re.findall(r"^python .*", text, re.MULTILINE)
    if needed <= len(given) <= needed + 1 and not any(each.startswith("-") for each in given):
        try:
            for folder in given[needed:]:
                writable_folder(Path(folder), "FOLDER")
            return given
        except InputError as error:
            line = str(error)
    print(f"usage: {line}" if line.startswith("python") else line, file=sys.stderr)
    sys.exit(2)
