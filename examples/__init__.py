"""Machines, runs and systems that the rotor is part of, a folder each."""

import shutil
from pathlib import Path

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
