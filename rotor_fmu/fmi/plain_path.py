"""From where FMUs in Python can be run."""

from pathlib import Path

from ..errors import InputError


def check_plain_path(folder: Path) -> None:
    """Raise `InputError` for a folder with an extracted FMU in Python whose path pythonfmu's
    wrapper would take for another, which ends the process: of all that a URI encodes it decodes
    blanks alone."""
    is_of_pythonfmu = (folder / "resources" / "slavemodule.txt").exists()
    if is_of_pythonfmu and "%" in folder.absolute().as_uri().replace("%20", ""):
        raise InputError(
            f"{folder}: an FMU in Python is run from a path of plain letters, digits and spaces "
            "alone; temporary folders lie in the one that the environment variable TMPDIR names"
        )
