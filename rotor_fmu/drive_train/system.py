"""The example's drive train coupled with the rotor: two FMUs that exchange speed and torque."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..coupled.master import Side, march
from ..coupled.member import Member
from ..coupled.partner import build_partner, example_folder, partner_table
from ..files import unfinished
from ..fmi.variables import Variable
from ..model.spelling import Message

DRIVE_TRAIN_FMU = "DriveTrain.fmu"
# What one FMU tells the other: output, input.
TO_ROTOR = (("w", "speed"),)
TO_DRIVE = (("tau_load", "tau_load"),)
# What is recorded besides.
OF_THE_DRIVE = ("phi", "w_motor", "tau_motor", "tau_coupling", "work_motor", "work_out")
OF_THE_ROTOR = ("tau", "energy.drive_work", "disc[3].x_amp", "disc[3].y_amp")


def example() -> Path:
    """Folder of the example: the drive train's source and the system files."""
    return example_folder("drive_train")


def drive_train_table() -> tuple[Variable, ...]:
    """Variables of the drive train's FMU, as its source lists them."""
    return partner_table(example() / "drive_train.py")


def build_drive_train(out: Path) -> Path:
    """Build `DriveTrain.fmu` in the folder `out` and return its path; equal sources, equal bytes.

    Raises `OSError` if `out` cannot be written.
    """
    return build_partner(example() / "drive_train.py", out / DRIVE_TRAIN_FMU)


@dataclass(frozen=True)
class Coupled:
    """A coupled run at its communication points.

    t, shape (n,) [s]; drive, rotor: what either FMU told, by name, shape (n,); J: the rotor's
    moment of inertia [kg.m2].
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
    messages: list[Message] = []
    with (
        Member(drive_fmu, drive_parameters, messages) as drive,
        Member(rotor_fmu, rotor_parameters, messages) as rotor,
    ):
        acquaint(drive, rotor)
        t, of_drive, of_rotor = march(
            Side(drive, TO_ROTOR, OF_THE_DRIVE),
            Side(rotor, TO_DRIVE, OF_THE_ROTOR),
            stop,
            step,
            progress,
        )
        inertia = rotor.read("J")
    return Coupled(t, of_drive, of_rotor, inertia)


def acquaint(drive: Member, rotor: Member) -> None:
    """Give the drive train the rotor's moment of inertia, and each the other's output at the
    start; both in the initialization mode."""
    drive.set(drive.references("J_rotor"), [rotor.read("J")])
    rotor.set(rotor.references("speed"), drive.get(drive.references("w_start")))
    drive.set(drive.references("tau_load"), rotor.get(rotor.references("tau_load")))


def save_coupled(run: Coupled, path: Path) -> None:
    """Write a run to a .npz file, whole or not at all."""
    columns: dict[str, Any] = {f"drive {name}": column for name, column in run.drive.items()}
    columns |= {f"rotor {name}": column for name, column in run.rotor.items()}
    with unfinished(path) as part:
        np.savez_compressed(part, t=run.t, J=run.J, **columns)


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
