"""The rotor's FMU, turned by that of the example `drive_train`, as the subject of a study.

Metrics are taken at the communication points: of the rotor by its variables' names, of the drive
train as `drive.NAME`.
"""

from __future__ import annotations

import json
import math
import os
import shutil
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError, RunFailed, optional
from ..fmi.packing.python_fmu import package_name
from ..model.kernels.cache import private_folder, user_cache
from ..model.message_templates import Message
from ..run_status import FAILED, messages_and_codes, status_of
from ..runs.recording import Recording
from ..studies.study import Result
from .machine_runs import RUN, MachineRuns, machine_of
from .metric_cells import cells
from .monitor import Samples, Window
from .run_excitation import Excitation

if TYPE_CHECKING:
    from ..cosimulation.coupling import Coupling

DRIVE = "drive."
# The numbers of a run by the names of the drive train's FMU.
_OF_THE_DRIVE = {
    "tau_max": "torque",
    "w_target": "target",
    "ramp": "ramp",
    "kp": "gain",
    "ki": "integral",
    "J_motor": "inertia",
    "k": "stiffness",
    "c": "damping",
    "w_start": "from",
}
_KEPT_MACHINES = 8  # whose FMUs are kept


@lru_cache
def drive_train() -> Coupling:
    """Return the coupling of the example `drive_train`."""
    from ..cosimulation.coupling import example_coupling

    return example_coupling("drive_train")


@dataclass(frozen=True)
class CoupledRuns(MachineRuns):
    """Runs of a machine's `RotorBearing.fmu` coupled with `DriveTrain.fmu`."""

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of a run by name, with their units: the Reals of both FMUs."""
        table = machine_of(self.toml, False).table
        rotor = {v.name: v.unit for v in table if v.is_observed and v.kind == "Real"}
        outputs = [v for v in drive_train().variables if v.causality == "output"]
        return rotor | {f"{DRIVE}{v.name}": v.unit for v in outputs}

    @cached_property
    def identity(self) -> str:
        """The machine, the run, what is kept, and the drive train's source, as text."""
        source = drive_train().source.read_bytes().replace(b"\r\n", b"\n")
        return json.dumps([super().identity, sha256(source).hexdigest()])

    def warm(self) -> None:
        """Build both FMUs and load them, by a start."""
        with suppress(InputError, RunFailed), self._coupled({}, ()) as (rows, *_):
            next(rows)

    def run(self, values: Mapping[str, float]) -> Result:
        """Make one run; a failure in it, impossible values included, is its status."""
        try:
            with self._coupled(values, self._needs(False)) as (rows, how, messages):
                window = _window(list(rows), self._needs(False))
                row_cells = {metric.name: cells(metric, [window], how) for metric in self.metrics}
                return Result(status_of(messages), row_cells)
        except (InputError, RunFailed) as error:
            return Result(f"{FAILED}{error}", {})

    def record(self, values: Mapping[str, float]) -> Recording:
        """Record one run at its communication points, up to its end or failure; the same run as its
        row's."""
        from ..runs.run_down import usual

        machine, units = machine_of(self.toml, False), self.units
        of_drive = (name for name in units if name.startswith(DRIVE))
        proposed = ("phi", "w", *usual(machine.rotor), *self._needs(False), *of_drive)
        names = tuple(dict.fromkeys(name for name in proposed if name in units))
        seen: list[tuple[float, ...]] = []
        messages: list[Message] = []
        failure = None
        try:
            with self._coupled(values, names) as (rows, _, messages):
                seen.extend(rows)
        except (InputError, RunFailed) as error:
            failure = str(error)
        about = {
            "machine": machine.rotor.name,
            "toml": self.toml,
            "parameters": {**self.values, **values},
            "run": {"kind": self.how.kind, **self.how.numbers},
            "status": status_of(messages, failure),
            **messages_and_codes(messages),
        }
        shown = _window(seen, names).steps
        return Recording(shown.t, shown.columns, {n: units[n] for n in names}, about)

    @contextmanager
    def _coupled(
        self, values: Mapping[str, float], names: Sequence[str]
    ) -> Iterator[tuple[Iterator[tuple[float, ...]], Excitation, list[Message]]]:
        """Two FMUs that are ready to run: the points of the run, each its time and what is named;
        how it is driven; and what they have said."""
        from ..cosimulation.master import points

        own = {name.removeprefix(RUN): v for name, v in values.items() if name.startswith(RUN)}
        of_machine = {name: v for name, v in values.items() if not name.startswith(RUN)}
        how = self.how.changed(own)
        drive_fmu, rotor_fmu = fmus(self.toml)
        of_drive = {name: how.numbers[number] for name, number in _OF_THE_DRIVE.items()}
        with drive_train().open(
            drive_fmu,
            rotor_fmu,
            {"continuation": 1.0, **of_drive},
            {**self.values, **of_machine},
            [name.removeprefix(DRIVE) for name in names if name.startswith(DRIVE)],
            [name for name in names if not name.startswith(DRIVE)],
        ) as (one, other):
            outputs = [*(f"{DRIVE}{name}" for name in one.outputs), *other.outputs]
            at = [outputs.index(name) for name in names]

            def rows() -> Iterator[tuple[float, ...]]:
                for point in points(one, other, how.numbers["stop"], how.numbers["step"]):
                    seen = (*point.one, *point.other)
                    yield point.t, *(seen[i] for i in at)

            yield rows(), how, other.member.messages


def _window(points: Sequence[tuple[float, ...]], names: Sequence[str]) -> Window:
    """Treat the values at the communication points as the solver's steps."""
    columns = np.array(points, dtype=float).reshape(len(points), 1 + len(names)).T
    steps = Samples(columns[0], dict(zip(names, columns[1:], strict=True)))
    return Window(steps, Samples(np.zeros(0), {}), math.nan, 0)


@lru_cache(maxsize=_KEPT_MACHINES)
def fmus(toml: str) -> tuple[Path, Path]:
    """Return the drive train's FMU and that of a machine as folders, built and extracted once for
    all processes of this user.

    They lie in the user's cache, so that workers on another machine build their own. Raises
    `OSError` where there is no such folder.
    """
    from ..runs.job import fmu_in

    key = sha256(f"{package_name()} {toml}".encode()).hexdigest()[:16]
    row_cells = user_cache() / "coupled"
    home = row_cells / key
    for folder in (user_cache(), row_cells, home):
        private_folder(folder)
    with optional("filelock", "study", "study").FileLock(home / "lock"):
        built = _extracted(drive_train().build(home)), _extracted(fmu_in(home, toml))
        os.utime(home)
    by_age = sorted(row_cells.iterdir(), key=lambda folder: folder.stat().st_mtime, reverse=True)
    for old in by_age[_KEPT_MACHINES:]:
        shutil.rmtree(old, ignore_errors=True)
    return built


def _extracted(fmu: Path) -> Path:
    """Return the folder with an FMU's content, beside it, under a name that follows the content."""
    folder = fmu.parent / sha256(fmu.read_bytes()).hexdigest()[:16] / fmu.name
    if not folder.is_dir():
        folder.parent.mkdir(exist_ok=True)
        unfinished = Path(tempfile.mkdtemp(dir=folder.parent))
        with zipfile.ZipFile(fmu) as archive:
            archive.extractall(unfinished)
        unfinished.rename(folder)
    return folder
