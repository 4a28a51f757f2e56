"""Recorded signals by name, with their units, as arrays, tables and a file."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import meant, optional, path_of, writable_folder
from ..runs.recording import RECORDING, Recording

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]
    import xarray as xr


@dataclass(frozen=True, repr=False)
class RecordedSignals:
    """Signals by name, at the solver's own steps, with what the solver said of the run.

    Attributes
    ----------
    recording : Recording
        The signals, with their units and a description of the run.
    """

    recording: Recording

    @property
    def t(self) -> np.ndarray:
        """Times of the rows [s], shape (n,)."""
        return self.recording.t

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the recorded signals, in their order."""
        return tuple(self.recording.columns)

    @property
    def units(self) -> dict[str, str]:
        """Units of the recorded signals, by name."""
        return {name: self.recording.units[name] for name in self.names}

    @property
    def speed(self) -> np.ndarray:
        """Speed of rotation [rad/s], shape (n,)."""
        return self.recording.w

    @property
    def status(self) -> str:
        """Status of the run: `ok`, `doubtful` and its warnings' codes, or `failed` and why."""
        return self.recording.status

    @property
    def messages(self) -> tuple[str, ...]:
        """Messages of the solver, in their order."""
        return tuple(self.recording.about.get("messages", ()))

    @property
    def codes(self) -> tuple[str, ...]:
        """Code of each of `messages`, for programs, such as `overdamped`; empty without one."""
        return tuple(self.recording.about.get("codes", ()))

    @property
    def verification(self) -> dict[str, Any] | None:
        """Comparison with the same run, solved more finely; None where it was not asked for.

        Its `conclusion` is `confirmed`, `sensitive` where the amplitudes agree and the places at
        the end do not, or `not confirmed`; `peaks` and `final` are those of both runs.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> run = rf.simulate(rf.load(), speed=185.0, stop=0.2, verify=True)
        >>> run.verification["conclusion"], run.verification["finer"]
        ('confirmed', {'solver.tolerance': 0.0001})
        """
        return self.recording.about.get("verification")

    def __getitem__(self, name: str) -> np.ndarray:
        """Return a signal by its name.

        Parameters
        ----------
        name : str
            One of `names`.

        Returns
        -------
        numpy.ndarray
            The signal in SI units, shape (n,).

        Raises
        ------
        KeyError
            If it was not recorded; the message says what may be meant.
        """
        if name not in self.recording.columns:
            raise KeyError(f"{name!r} was not recorded; {meant(name, self.names)}")
        return self.recording.columns[name]

    def dataframe(self) -> "pd.DataFrame":
        """Return the signals as a table over the time.

        Returns
        -------
        pandas.DataFrame
            A column a signal, indexed by the time [s]; the units are in its `attrs`.

        Raises
        ------
        InputError
            If pandas is not installed.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> table = rf.simulate(rf.load(), speed=100.0, stop=0.1).dataframe()
        >>> table.index.name, table.attrs["units"]["disc[1].x"]
        ('t', 'm')
        """
        pd = optional("pandas", "study", "dataframe")
        table = pd.DataFrame(dict(self.recording.columns), pd.Index(self.t, name="t"))
        table.attrs["units"] = {"t": "s", **self.units}
        return table

    def dataset(self) -> "xr.Dataset":
        """Return the signals as variables over the time.

        Returns
        -------
        xarray.Dataset
            A variable a signal, each with its unit, and a description of the run in `attrs`.

        Raises
        ------
        InputError
            If xarray is not installed.

        Examples
        --------
        >>> import rotor_fmu as rf
        >>> data = rf.simulate(rf.load(), speed=100.0, stop=0.1).dataset()
        >>> data["disc[1].x"].attrs["units"], data.attrs["machine"]
        ('m', 'zigulic2003')
        """
        xr = optional("xarray", "study", "dataset")
        variables = {
            name: ("t", column, {"units": self.units[name]})
            for name, column in self.recording.columns.items()
        }
        about = {k: v for k, v in self.recording.about.items() if isinstance(v, (str, float, int))}
        return xr.Dataset(variables, {"t": ("t", self.t, {"units": "s"})}, about)

    def save(self, folder: Path | str) -> Path:
        """Write `recording.npz` into a folder, for `read_run`, `rotor-fmu plot` and reports.

        Parameters
        ----------
        folder : Path or str
            The folder; it is made if need be.

        Returns
        -------
        Path
            The file written.
        """
        path = writable_folder(path_of("folder", folder), "folder =") / RECORDING
        self.recording.save(path)
        return path
