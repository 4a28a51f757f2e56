"""The state of a run beside the motion: time and rotation, counters, the ledger, the peaks."""

from typing import Annotated, NamedTuple

import numpy as np

from ..kernels.jit import jit
from ..quantities import places
from ..step.excitation import spin_of
from ..warnings import RUN_WARNINGS

RECORD = np.dtype(
    [
        (name, "f8")
        for name in (
            "t",  # time since the start [s], and the host's time then [s]
            "t_of_host",
            "t_ref",  # since then the speed has been linear in time: [s], [rad/s], [rad/s2], [rad]
            "omega_ref",
            "alpha",
            "theta_ref",
            "t_earlier",  # an instant at which the speed was given before that, the speed [rad/s],
            "omega_earlier",  # its mean rate before [rad/s2], and the longest interval since [s],
            "alpha_earlier",  # see `communication_interval`
            "longest_since",
            "omega",  # at t [rad/s]
            "theta",  # at t [rad]
            "h",  # proposed step length [s]
            "h_last",
            "h_carried",  # to which the carried accelerations belong, and since when they were kept
            "carried_since",  # through slivers of steps [s]
            "characteristic_frequency_squared",  # of the motion, see `fitting` [rad2/s2]
            "motion_size",  # see `error_control.update_size` [m]
            "turns_remembered",  # by it [1]
            "damping",  # factor that the last step's fitting gave to the damping [1]
            "h_smallest",
            "h_largest",
            "error",  # of the last step in the terms of the mode, see `control.step_error` [1]
            "error_largest",  # local error of a step, in tolerances [1]: the largest in the present
            "error_largest_before",  # revolution and in the last, the angle swept of the present
            "error_swept",  # one [rad], the integral of the square over it [rad], and the root mean
            "error_square",  # square over the last
            "error_rms",
            "error_peak",  # see `error_control.steady_length` [1]
            "energy_at_start",  # of the machine [J]
            "torque",  # that the motion needs at t [N.m]
            "drive",  # torque on a free rotor at t [N.m]
            "drive_ref",  # and at t_ref, since when it has been linear in time: [N.m], [N.m/s]
            "drive_rate",
            "turn",  # angle at which the present revolution began [rad]
            "swept",  # of the present revolution, negative where the angle falls [rad]
            *(warning.since for warning in RUN_WARNINGS),  # time of each [s], or NaN
            "cycle_end",  # when the work of a cycle is counted anew [s]
            "touched_at",  # time of the first touch in the window of the losses looked at, or NaN
            "window_end",  # when they are looked at next [s]
            "window_residual",  # of the ledger, what was dissipated, and that without friction [J]
            "window_losses",
            "window_vibration",
            "leaky_taken",  # by the integrator, by all that dissipates, by that without friction:
            "leaky_losses",  # sums over windows that fade [J]
            "leaky_vibration",
            "failed_at",  # time of the step that failed [s], and its length [s]
            "failed_h",
            "energy_before",  # of the machine before parameters change [J]
            "failed_value",  # of what ended an advance early, see `early_return`
            "h_in_contact",  # see `Control`
            "h_in_the_open",
            "overdamping",
            "surveyed_at",  # speed at which growing whirls were looked for [rad/s], and the sizes
            "surveyed_from",  # of speed below and above which they are looked for anew
            "surveyed_to",
            "max_iterations",  # that an advance, or the search for the rest, may take
            "drive_work_ref",  # of the ledger at t_ref [J]
            "drive_impedance",  # of the line that drives a free rotor [N.m.s/rad]
            "limit_displacement",  # of a probe from the axis [m] and of an interface's force [N] at
            "limit_force",  # which an advance ends early, 0 for none; see `early_return`
            "residual",  # largest of a step with a limited number of iterations [N]
        )
    ]
    + [
        (name, "i8")
        for name in (
            *("steps", "rejected", "newton", "trapped", "continues", "is_free"),
            "error_touched",  # whether a wall was touched in the present revolution
            "varies",  # whether loads or the torque on a free rotor change between t_ref and later
            "cycle_newton",  # iterations when the present cycle began
            "stops_at_contact",  # whether an advance ends early when a contact closes or opens
            "is_past_limit",  # whether a limit is passed that an advance has ended early at
            "has_sensitivities",  # whether tangents are propagated (`sensitivities`)
        )
    ]
)


# Places in `Memory.peaks` and `Memory.wall_peaks`, `Memory.once` and `Memory.bounce`.
PEAK = places(("this_revolution", "last_revolution", "since_communication"))
AXIS = places(("x", "y", "squared_distance"))
ONCE = places(("now", "integral", "mean"))
SENSE = places(("forward", "backward"))
BOUNCE = places(("x", "y", "steps", "score"))


class Memory(NamedTuple):
    """The state of a run beside the motion; every array changes in place.

    record: of dtype `RECORD`; work, power: of `ledger.FLOWS` [J], [W]; peaks: largest |x|, |y| [m]
    and squared distance [m2] of the probes from rest in the present revolution, in the one before,
    and since the last communication point; wall_peaks: largest squared normal force of each
    interface with a wall in these spans [N2]; once: of their z from rest, z exp(-i theta) and z
    exp(i theta) now [m], integrated over the present revolution [m.rad], and their means over the
    one before, by the angle turned [m]; bounce: of each interface the displacement at the last
    contact (x, y) [m], steps since then, score of crossings; rest: the probes under the loads at
    the start [m]; seats: displacement then at each wall that carries the machine [m], 0 at the
    others; center: the mean position of the last revolutions [m]; loads: on the ports at t [N], of
    the base its acceleration [m/s2]; load_refs, load_rates: at t_ref, since when they have been
    linear in time [N, N/s]; load_work, load_power: of each load since t_ref [J] and now [W].
    """

    record: Annotated[np.recarray, RECORD, "1"]
    work: Annotated[np.ndarray, float, "flows"]
    power: Annotated[np.ndarray, float, "flows"]
    peaks: Annotated[np.ndarray, float, str(len(PEAK)), str(len(AXIS)), "probes"]
    wall_peaks: Annotated[np.ndarray, float, str(len(PEAK)), "interfaces"]
    once: Annotated[np.ndarray, complex, str(len(ONCE)), str(len(SENSE)), "probes"]
    bounce: Annotated[np.ndarray, float, "interfaces", str(len(BOUNCE))]
    rest: Annotated[np.ndarray, complex, "probes"]
    seats: Annotated[np.ndarray, complex, "interfaces"]
    center: Annotated[np.ndarray, complex, "n"]
    loads: Annotated[np.ndarray, complex, "loads"]
    load_refs: Annotated[np.ndarray, complex, "loads"]
    load_rates: Annotated[np.ndarray, complex, "loads"]
    load_work: Annotated[np.ndarray, float, "loads"]
    load_power: Annotated[np.ndarray, float, "loads"]


@jit
def spin_at(record, t, alpha):
    """Return the rotation at time t [s]: the speed is linear in time, the angle its integral. A
    free rotor's rate is `alpha` [rad/s2] then; its speed and angle follow by the trapezoidal
    rule."""
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


@jit
def take_loads(memory, drive, rate):
    """Make loads and the torque on a free rotor, now `drive` [N.m] with its rate [N.m/s], linear in
    time from now on."""
    r = memory.record[0]
    r.varies = 0
    for i in range(len(memory.loads)):
        memory.load_refs[i] = memory.loads[i]
        if memory.load_rates[i] != 0.0:
            r.varies = 1
    if r.is_free == 1:
        r.drive = drive
        r.drive_ref = drive
        r.drive_rate = rate
        if rate != 0.0:
            r.varies = 1


@jit
def move_loads(memory, t):
    """Set loads and torque to those at time t [s]."""
    r = memory.record[0]
    if r.varies == 1:
        since = t - r.t_ref
        for i in range(len(memory.loads)):
            memory.loads[i] = memory.load_refs[i] + since * memory.load_rates[i]
        if r.is_free == 1:
            r.drive = r.drive_ref + since * r.drive_rate


@jit
def spin_now(record):
    """Return the rotation at the present time."""
    r = record[0]
    return spin_of(r.omega, r.alpha, r.theta)
