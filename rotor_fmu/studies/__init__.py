"""Studies: many runs of any subject, stored as rows, opened as one dataset."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray


def open(folder: Path | str) -> "xarray.Dataset":
    """Return the rows of a study's folder, finished or not, as one dataset along `run`; see
    `store.open_dataset`."""
    from .store import open_dataset

    return open_dataset(Path(folder))
