"""The example's drive train coupled with the rotor: two FMUs that exchange speed and torque.

A Jacobi master in its plainest form, through FMPy's API: at each communication point either FMU
gets the other's last output, then both step.
"""

from __future__ import annotations

import runpy
import shutil
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import fmpy
import numpy as np

from ..about import RELEASED
from ..errors import RunFailed
from ..fmu import wrapper
from ..fmu.description import complete
from ..fmu.variables import Variable
from ..packing.bundle import repack, wrap

DRIVE_TRAIN_FMU = "DriveTrain.fmu"
SYSTEM_FILES = ("OspSystemStructure.xml", "SystemStructure.ssd", "cofmpy.json")
# What is recorded of either FMU.
OF_THE_DRIVE = ("w", "phi", "w_motor", "tau_motor", "tau_coupling", "work_motor", "work_out")
OF_THE_ROTOR = ("tau", "tau_load", "energy.drive_work", "disc[3].x_amp", "disc[3].y_amp")


def example() -> Path:
    """Folder of the example: the drive train's source and the system files."""
    return Path(str(files("rotor_fmu.examples") / "drive_train"))


def drive_train_table() -> tuple[Variable, ...]:
    """Variables of the drive train's FMU, as its source lists them."""
    listed = runpy.run_path(str(example() / "drive_train.py"))["VARIABLES"]
    return tuple(
        Variable(name, "Real", causality, text, unit, start, low=low)
        for name, causality, unit, start, low, text in listed
    )


def build_drive_train(out: Path) -> Path:
    """Build `DriveTrain.fmu` in the folder `out` and return its path; equal sources, equal bytes.

    Raises `OSError` if `out` cannot be written.
    """
    source = (example() / "drive_train.py").read_text(encoding="utf-8")
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="rotor_fmu_") as name:
        folder = Path(name)
        # named after its content, so that two versions can live in one process
        script = folder / f"drive_train_{sha256(source.encode()).hexdigest()[:12]}.py"
        script.write_text(source, encoding="utf-8")
        protection = folder / "rotor_fmu_wrapper.py"
        shutil.copyfile(wrapper.__file__, protection)
        wrap(script, [protection], folder / "raw.fmu")
        table = drive_train_table()
        return repack(
            folder / "raw.fmu",
            out / DRIVE_TRAIN_FMU,
            {},
            lambda root: complete(root, table, RELEASED),
        )


@dataclass(frozen=True)
class Coupled:
    """A coupled run at its communication points.

    t, shape (n,) [s]; drive, rotor: what `OF_THE_DRIVE` and `OF_THE_ROTOR` name, shape (n,);
    J: the rotor's moment of inertia [kg.m2].
    """

    t: np.ndarray
    drive: Mapping[str, np.ndarray]
    rotor: Mapping[str, np.ndarray]
    J: float

    @property
    def hz(self) -> np.ndarray:
        """Speed of the rotor [Hz], shape (n,)."""
        return self.drive["w"] / (2 * np.pi)

    @property
    def residual(self) -> np.ndarray:
        """Energy that the coupling lost between the FMUs: what left the drive train less what the
        rotor took, shape (n,) [J]."""
        return self.drive["work_out"] - self.rotor["energy.drive_work"]


class Member:
    """One FMU of a coupled system, extracted and instantiated; a context that tidies up.

    parameters: values by name; messages: of all FMUs together, since FMPy hands those of every FMU
    to the logger made last. Raises `RunFailed` with the FMU's own words when a call fails.
    """

    def __init__(self, fmu: Path, parameters: Mapping[str, float], messages: list[str]) -> None:
        self._messages = messages
        self._name = fmu.name
        self._folder = fmpy.extract(str(fmu))
        description = fmpy.read_model_description(self._folder)
        self._variables = {v.name: v for v in description.modelVariables}
        self._fmu = fmpy.instantiate_fmu(
            self._folder, description, "CoSimulation", debug_logging=True, logger=self._log
        )
        self._parameters = parameters

    def __enter__(self) -> Member:
        self._call(self._fmu.setupExperiment, startTime=0.0)
        for name, value in self._parameters.items():
            kind = self._variables[name].type
            setter = getattr(self._fmu, f"set{kind}")
            self._call(setter, self.references(name), [int(value) if kind != "Real" else value])
        self._call(self._fmu.enterInitializationMode)
        return self

    def __exit__(self, *reason: object) -> None:
        self._fmu.freeInstance()
        shutil.rmtree(self._folder, ignore_errors=True)

    def references(self, *names: str) -> list[int]:
        """Value references of variables."""
        return [self._variables[name].valueReference for name in names]

    def begin(self) -> None:
        """Leave the initialization mode."""
        self._call(self._fmu.exitInitializationMode)

    def get(self, references: list[int]) -> list[float]:
        """Values of Reals."""
        return self._call(self._fmu.getReal, references)

    def set(self, references: list[int], values: list[float]) -> None:
        """Set Reals."""
        self._call(self._fmu.setReal, references, values)

    def step(self, t: float, h: float) -> None:
        """Step from t [s] over h [s]."""
        self._call(self._fmu.doStep, t, h)

    def _call(self, call: Callable[..., object], *arguments: object, **named: object) -> Any:
        try:
            return call(*arguments, **named)
        except fmpy.fmi1.FMICallException as error:
            reason = self._messages[-1] if self._messages else str(error)
            raise RunFailed(f"{self._name}: {reason}") from error

    def _log(self, environment: object, name: bytes, status: int, category: bytes, text: bytes):
        if status != fmpy.fmi2.fmi2OK:
            self._messages.append(text.decode("utf-8", "replace").splitlines()[-1])


def couple(
    drive_fmu: Path,
    rotor_fmu: Path,
    stop: float,
    step: float,
    drive_parameters: Mapping[str, float],
    rotor_parameters: Mapping[str, float],
    progress: Callable[[float], None] = lambda t: None,
) -> Coupled:
    """Run both FMUs to `stop` [s] with the communication step `step` [s].

    The drive train gets the rotor's moment of inertia. `progress` gets the time at each
    communication point; what it raises ends the run. Raises `RunFailed`.
    """
    messages: list[str] = []
    with (
        Member(drive_fmu, drive_parameters, messages) as drive,
        Member(rotor_fmu, rotor_parameters, messages) as rotor,
    ):
        from_drive, from_rotor = drive.references(*OF_THE_DRIVE), rotor.references(*OF_THE_ROTOR)
        load, speed = drive.references("tau_load"), rotor.references("speed")
        at_load = OF_THE_ROTOR.index("tau_load")
        (inertia,) = rotor.get(rotor.references("J"))
        drive.set(drive.references("J_rotor"), [inertia])
        rotor.set(speed, drive.get(drive.references("w_start")))
        drive.set(load, rotor.get(rotor.references("tau_load")))
        drive.begin()
        rotor.begin()
        rows = [drive.get(from_drive) + rotor.get(from_rotor)]
        count = round(stop / step)
        for n in range(count):
            t, last = n * step, rows[-1]
            drive.set(load, [last[len(OF_THE_DRIVE) + at_load]])
            rotor.set(speed, [last[0]])
            drive.step(t, step)
            rotor.step(t, step)
            rows.append(drive.get(from_drive) + rotor.get(from_rotor))
            progress(t + step)
    columns = np.array(rows).T
    return Coupled(
        np.arange(count + 1) * step,
        dict(zip(OF_THE_DRIVE, columns, strict=False)),
        dict(zip(OF_THE_ROTOR, columns[len(OF_THE_DRIVE) :], strict=True)),
        inertia,
    )


def save_coupled(run: Coupled, path: Path) -> None:
    """Write a run to a .npz file, whole or not at all."""
    columns: dict[str, Any] = {f"drive {name}": column for name, column in run.drive.items()}
    columns |= {f"rotor {name}": column for name, column in run.rotor.items()}
    unfinished = path.with_suffix(".part.npz")
    np.savez_compressed(unfinished, t=run.t, J=run.J, **columns)
    unfinished.replace(path)


def load_coupled(path: Path) -> Coupled:
    """Read a run that `save_coupled` wrote."""
    with np.load(path) as data:
        sides = {
            side: {
                name.removeprefix(f"{side} "): data[name]
                for name in data.files
                if name.startswith(f"{side} ")
            }
            for side in ("drive", "rotor")
        }
        return Coupled(data["t"], sides["drive"], sides["rotor"], float(data["J"]))
