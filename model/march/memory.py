"""What a run remembers besides the motion: time and rotation, counters, the ledger, the peaks."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..kernels.compiled import compiled
from ..step.excitation import spin_of
from ..structure.assembly import Structure
from .energy import FLOWS

RECORD = np.dtype(
    [
        (name, "f8")
        for name in (
            "t",  # time [s]
            "t_ref",  # since then the speed has been linear in time: [s], [rad/s], [rad/s2], [rad]
            "omega_ref",
            "alpha",
            "theta_ref",
            "omega",  # at t [rad/s]
            "theta",  # at t [rad]
            "h",  # wished step length [s]
            "h_last",
            "h_carried",  # to which the carried accelerations belong
            "damping",  # factor that the last step's fitting gave to the damping [1]
            "h_smallest",
            "h_largest",
            "error",  # of the last step, relative [1]
            "energy_at_start",  # of the machine [J]
            "torque",  # that the motion needs at t [N.m]
            "drive",  # torque on a free rotor [N.m]
            "turn",  # angle at which the present revolution began [rad]
            "trapped_at",  # time at which the false state was first seen [s], or NaN
            "failed_at",  # time of the step that failed [s], and its length [s]
            "failed_h",
        )
    ]
    + [(name, "i8") for name in ("steps", "rejected", "newton", "trapped", "continues", "is_free")]
)


class Memory(NamedTuple):
    """What a run remembers besides the motion; every array changes in place.

    record: shape (1,) of dtype `RECORD`; work, power: of `FLOWS`, shape (6,) [J], [W]; peaks: shape
    (3, 2, discs): largest |x| and |y - y_static| [m] of the present revolution, of the one before,
    and since the last communication point; bounce: shape (bearings, 4): direction of the last
    contact (cos, sin), steps since then, score of crossings; rest: heights of
    the discs at rest, shape (discs,) [m].
    """

    record: np.ndarray
    work: np.ndarray
    power: np.ndarray
    peaks: np.ndarray
    bounce: np.ndarray
    rest: np.ndarray


def new_memory(structure: Structure) -> Memory:
    """Memory of a run that has not begun."""
    memory = Memory(
        record=np.zeros(1, dtype=RECORD).view(np.recarray),
        work=np.zeros(len(FLOWS)),
        power=np.zeros(len(FLOWS)),
        peaks=np.zeros((3, 2, len(structure.disc_dof))),
        bounce=np.zeros((len(structure.contacts), 4)),
        rest=np.zeros(len(structure.disc_dof)),
    )
    memory.record[0].trapped_at = np.nan
    memory.record[0].damping = 1.0
    return memory


@compiled
def spin_at(record, t, alpha):
    """Rotation at time t [s]: the speed is linear in time, the angle its integral. A free rotor's
    rate is `alpha` [rad/s2] then; its speed and angle follow by the trapezoidal rule."""
    r = record[0]
    if r.is_free == 1:
        h = t - r.t
        omega = r.omega + 0.5 * h * (r.alpha + alpha)
        return spin_of(omega, alpha, r.theta + 0.5 * h * (r.omega + omega))
    since = t - r.t_ref
    return spin_of(
        r.omega_ref + r.alpha * since,
        r.alpha,
        r.theta_ref + since * (r.omega_ref + 0.5 * r.alpha * since),
    )


@compiled
def spin_now(record):
    """Rotation at the time reached."""
    r = record[0]
    return spin_of(r.omega, r.alpha, r.theta)
