"""The example's magnetic bearings coupled with the rotor: displacements one way, forces the other.

With the controller's sample time as the communication step a Jacobi master does what a digital
controller does: it reads, computes for a sample, and holds what it found over the next.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..coupled.master import Side, march
from ..coupled.member import Member
from ..coupled.partner import build_partner, example_folder, partner_table
from ..fmi.packing.python_fmu import FREE_FMU_NAME, build, is_current
from ..fmi.variables import Variable
from ..model.spelling import Message

CONTROL_FMU, ROTOR_FMU = "MagneticBearing.fmu", FREE_FMU_NAME
SIDES, AXES = ("left", "right"), ("x", "y")
# What one FMU tells the other: output, input.
SENSED = tuple((f"{side}_sensor.{axis}", f"{side}_{axis}") for side in SIDES for axis in AXES)
IN_MAGNETS = tuple((f"{side}_magnet.{axis}", f"{side}_d{axis}") for side in SIDES for axis in AXES)
TO_CONTROL = (*SENSED, *IN_MAGNETS, ("w", "w"))
TO_ROTOR = (
    *((f"{side}_f{axis}", f"{side}_magnet.f{axis}") for side in SIDES for axis in AXES),
    ("tau", "tau_drive"),
)
# What is recorded besides.
OF_THE_CONTROL = ("left_ixa", "left_ixb", "left_iya", "left_iyb", "work")
OF_THE_ROTOR = (
    "energy.external_work", "energy.drive_work", "energy.kinetic", "energy.races",
    "energy.friction_loss", "energy.contact_loss", "energy.housing_loss", "energy.drag_loss",
    "energy.structure_loss", "energy.residual", "body[1].x_amp", "body[2].x_amp",
    "touchdown_bearing[1].x", "touchdown_bearing[1].y", "touchdown_bearing[1].fn",
    "touchdown_bearing[1].race", "touchdown_bearing[2].x", "touchdown_bearing[2].y",
    "touchdown_bearing[2].fn", "touchdown_bearing[2].race",
)  # fmt: skip


def example() -> Path:
    """Folder of the example: the control's source, the machine and the system files."""
    return example_folder("magnetic_bearing")


def control_table() -> tuple[Variable, ...]:
    """Variables of the control's FMU, as its source lists them."""
    return partner_table(example() / "magnetic_bearing.py")


def build_control(out: Path) -> Path:
    """Build `MagneticBearing.fmu` in the folder `out` and return its path; equal sources, equal
    bytes. Raises `OSError` if `out` cannot be written."""
    return build_partner(example() / "magnetic_bearing.py", out / CONTROL_FMU)


def rotor_in(out: Path) -> Path:
    """The compressor's FMU in the folder `out`, built if it is not there or not up to date."""
    toml = (example() / "compressor.toml").read_text(encoding="utf-8")
    fmu = out / ROTOR_FMU
    return fmu if is_current(fmu, toml, is_free=True) else build(out, toml, is_free=True)


@dataclass(frozen=True)
class Levitated:
    """A coupled run at its communication points.

    t, shape (n,) [s]; control, rotor: what either FMU told, by name, shape (n,).
    """

    t: np.ndarray
    control: Mapping[str, np.ndarray]
    rotor: Mapping[str, np.ndarray]

    @property
    def work_lost(self) -> np.ndarray:
        """What the magnets did less what the rotor took, at every sample but the last, shape
        (n - 1,) [J]."""
        return self.control["work"][1:] - self.rotor["energy.external_work"][:-1]


def couple(
    control_fmu: Path,
    rotor_fmu: Path,
    stop: float,
    step: float,
    control_parameters: Mapping[str, float],
    rotor_parameters: Mapping[str, float],
    progress: Callable[[float], None] = lambda t: None,
) -> Levitated:
    """Run both FMUs to `stop` [s] with the communication step `step` [s].

    The rotor starts at rest in its touchdown bearings. `progress` gets the time at each
    communication point; what it raises ends the run. Raises `RunFailed`.
    """
    messages: list[Message] = []
    with (
        Member(control_fmu, control_parameters, messages) as control,
        Member(rotor_fmu, {"w_start": 0.0, **rotor_parameters}, messages) as rotor,
    ):
        sensed = rotor.get(rotor.references(*(output for output, _ in TO_CONTROL)))
        control.set(control.references(*(name for _, name in TO_CONTROL)), sensed)
        return Levitated(
            *march(
                Side(control, TO_ROTOR, OF_THE_CONTROL),
                Side(rotor, TO_CONTROL, OF_THE_ROTOR),
                stop,
                step,
                progress,
            )
        )
