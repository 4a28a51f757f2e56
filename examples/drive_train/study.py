"""The drive train and the rotor as the subject of a study: `kind = "drive-train"` in its file.

A study names this module: `module = "rotor_fmu.examples.drive_train.study"`. A run is two FMUs,
`DriveTrain.fmu` and `RotorBearing.fmu`; metrics are taken at the communication points: of the
rotor by its variables' names, of the drive train as `drive.NAME`.
"""

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
from typing import ClassVar

import numpy as np
from rotor_fmu.model.kernels.cache import private_folder, user_cache
from rotor_fmu.model.message_templates import Message
from rotor_fmu.model.quantities import NOT_NEGATIVE, POSITIVE

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.errors import InputError, RunFailed, optional
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import fmu_in, package_name
from rotor_fmu.fmi.variables import Variable
from rotor_fmu.machine_studies.machine_runs import MachineRuns
from rotor_fmu.machine_studies.machine_tables import KINDS, MachineSubject, read_machine
from rotor_fmu.machine_studies.metric import Metric
from rotor_fmu.machine_studies.run_excitation import Excitation, Samples, Window
from rotor_fmu.machine_studies.run_kinds import MOTOR, Number, RunKind
from rotor_fmu.run_status import FAILED, status_of
from rotor_fmu.runs.recording import Recording
from rotor_fmu.runs.run_down import usual
from rotor_fmu.studies.study import Result, Tables

DRIVE = "drive."  # before the names of the drive train's variables
COUPLING = Coupling(Path(__file__).with_name("drive_train.py"))
_KIND = RunKind(
    "drive-train",
    {
        **{name: MOTOR[name] for name in ("torque", "target", "ramp", "gain")},
        "integral": Number("N.m/rad", 0.2, "torque per angle error", NOT_NEGATIVE),
        "inertia": Number("kg.m2", 1e-3, "moment of inertia of the motor", POSITIVE),
        "stiffness": Number("N.m/rad", 400.0, "of the coupling to the rotor", POSITIVE),
        "damping": Number("N.m.s/rad", 0.03, "of the coupling to the rotor", NOT_NEGATIVE),
        "from": MOTOR["from"],
        "stop": MOTOR["stop"],
        "step": Number("s", 2e-3, "communication step of the two FMUs", POSITIVE),
    },
)
# Numbers of a run by the names of the drive train's variables.
NUMBERS = {
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
_KEPT_MACHINES = 8  # whose FMUs stay in the user's cache


def read_subject(tables: Tables, folder: Path) -> MachineSubject:
    """Return the subject of a study from the tables of its file; folder: of the file."""
    return read_machine(tables, folder, {**KINDS, _KIND.name: (_KIND, CoupledRuns)})


@dataclass(frozen=True)
class CoupledRuns(MachineRuns):
    """Runs of a machine's `RotorBearing.fmu` coupled with `DriveTrain.fmu`."""

    can_be_verified: ClassVar[bool] = False

    @property
    def units(self) -> dict[str, str]:
        """Return the quantities of a run by name, with their units: the Reals of both FMUs."""
        rotor = {v.name: v.unit for v in self.machine.table if v.is_observed and v.kind == "Real"}
        outputs = [v for v in COUPLING.variables if v.causality == "output"]
        return rotor | {f"{DRIVE}{v.name}": v.unit for v in outputs}

    @property
    def settable(self) -> dict[str, Variable]:
        """Return the FMU's parameters that may be set or varied, by name."""
        known = {v.name for v in self.machine.table}
        return {name: v for name, v in super().settable.items() if name in known}

    def check_metric(self, metric: Metric, how: Excitation) -> None:
        """Raise `InputError` for a metric that does not suit the runs."""
        if metric.kind.is_fine:
            raise metric.error(
                f"{metric.kind.said} needs the solver's own steps, which are not available through "
                "an FMU"
            )
        super().check_metric(metric, how)

    @cached_property
    def identity(self) -> str:
        """The machine, the run, what is kept, and the drive train's source, as text."""
        source = COUPLING.source.read_bytes().replace(b"\r\n", b"\n")
        return json.dumps([super().identity, sha256(source).hexdigest()])

    def warm(self) -> None:
        """Build both FMUs and load them, by a start."""
        with suppress(InputError, RunFailed), self._coupled({}, ()) as (rows, *_):
            next(rows)

    def run(self, values: Mapping[str, float]) -> Result:
        """Make one run; a failure in it, impossible values included, is its status."""
        try:
            with self._coupled(values, self.samples(False)) as (rows, how, messages):
                window = _window(list(rows), self.samples(False))
                return Result(status_of(messages), self.cells_of([window], how))
        except (InputError, RunFailed) as error:
            return Result(f"{FAILED}{error}", {})

    def record(self, values: Mapping[str, float]) -> Recording:
        """Record one run at its communication points, up to its end or failure; the same run as its
        row's."""
        units = self.units
        of_drive = (name for name in units if name.startswith(DRIVE))
        proposed = ("phi", "w", *usual(self.machine.rotor), *self.samples(False), *of_drive)
        names = tuple(dict.fromkeys(name for name in proposed if name in units))
        seen: list[tuple[float, ...]] = []
        messages: Sequence[Message] = []
        how, failure = self.how, None
        try:
            with self._coupled(values, names) as (rows, how, messages):
                seen.extend(rows)
        except (InputError, RunFailed) as error:
            failure = str(error)
        about = self.description(values, how, messages, failure)
        shown = _window(seen, names).steps
        return Recording(shown.t, shown.columns, {n: units[n] for n in names}, about)

    @contextmanager
    def _coupled(
        self, values: Mapping[str, float], names: Sequence[str]
    ) -> Iterator[tuple[Iterator[tuple[float, ...]], Excitation, Sequence[Message]]]:
        """Yield two FMUs that are ready to run: the points of the run, each its time and the named
        values; the excitation; and the FMUs' messages."""
        how, of_machine = self.split(values)
        of_drive = {name: how.numbers[number] for name, number in NUMBERS.items()}
        at = [
            ("partner", name.removeprefix(DRIVE)) if name.startswith(DRIVE) else ("rotor", name)
            for name in names
        ]
        with COUPLING.open(
            dict(zip(("partner", "rotor"), fmus(self.toml), strict=True)),
            how.numbers["stop"],
            {"partner": {"continuation": 1.0, **of_drive}, "rotor": of_machine},
            {side: [name for of, name in at if of == side] for side in ("partner", "rotor")},
        ) as coupled:

            def rows() -> Iterator[tuple[float, ...]]:
                for point in coupled.points(how.numbers["step"]):
                    yield point.t, *(point.values[side][name] for side, name in at)

            yield rows(), how, coupled.messages


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
    key = sha256(f"{package_name()} {toml}".encode()).hexdigest()[:16]
    cache = user_cache() / "coupled"
    home = cache / key
    for folder in (user_cache(), cache, home):
        private_folder(folder)
    with optional("filelock", "study", "study").FileLock(home / "lock"):
        built = _extracted(COUPLING.build(home)), _extracted(fmu_in(home, machine_of(toml)))
        os.utime(home)
    by_age = sorted(cache.iterdir(), key=lambda folder: folder.stat().st_mtime, reverse=True)
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
