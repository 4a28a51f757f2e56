"""The beginning of a communication interval: the drive and the loads until its end."""

from ..kernels.jit import jit
from ..step.step import accelerate
from .energy import FLOW, has_power, port_power, powers, total_energy
from .memory import spin_now, take_loads
from .monitors import open_window
from .step_with_rotation import SPIN_ITERATIONS, imbalance

# Relative accuracy of a free rotor's rate at the start of an interval, which no contact disturbs.
_BALANCED = 1e-14


@jit
def begin_interval(structure, drive, rate, is_start, motion, memory, work):
    """Take up drive and loads [N] of a new interval: the speed [rad/s] and its rate [rad/s2], or
    the torque on a free rotor [N.m] and its rate [N.m/s]; the rates of the loads are
    memory.load_rates.

    Carry accelerations and powers over the jump; at the start the accelerations are those of the
    equation of motion. A jump of the speed is instantaneous work of the drive.
    """
    r = memory.record[0]
    loads = memory.loads
    before = total_energy(structure, spin_now(memory.record), motion, work.stores)
    _remember_speed(r)
    r.t_ref = r.t
    r.theta_ref = r.theta
    r.drive_work_ref = memory.work[FLOW.drive]
    take_loads(memory, drive, rate)
    if r.is_free == 0:
        r.omega = drive
        r.omega_ref = drive
        r.alpha = rate
        if is_start:
            r.omega_earlier = drive
            r.alpha_earlier = rate
    after = total_energy(structure, spin_now(memory.record), motion, work.stores)
    if is_start:
        r.energy_at_start = after
        r.carried_since = r.t
        open_window(structure, memory)
    else:
        memory.work[FLOW.drive] += after - before
    for i in range(len(loads)):
        memory.load_work[i] = 0.0
        memory.load_power[i] = 0.0
        if has_power(structure, i, loads[i]):
            spin = spin_now(memory.record)
            memory.load_power[i] = port_power(structure, spin, i, loads[i], motion.v)
    for i in range(len(motion.a)):
        motion.a[i] -= motion.v_dot[i]
    for i in range(len(motion.internal_state)):
        motion.internal_rate_carried[i] -= motion.internal_rate[i]
    for _ in range(SPIN_ITERATIONS):
        spin = spin_now(memory.record)
        accelerate(structure, spin, r.damping, loads, motion, work)
        r.torque = powers(structure, spin, loads, motion, work.losses, memory.power)
        change = imbalance(structure, memory.record, r.omega, r.torque, 0.0)
        if abs(change) <= _BALANCED * (1.0 + abs(r.alpha)):
            break
        r.alpha += change
    for i in range(len(motion.a)):
        motion.a[i] = motion.v_dot[i] + (0.0 if is_start else motion.a[i])
    for i in range(len(motion.internal_state)):
        motion.internal_rate_carried[i] = motion.internal_rate[i] + (
            0.0 if is_start else motion.internal_rate_carried[i]
        )


@jit
def continued_rate(record, drive, duration):
    """Return the rate [rad/s2] at which a speed that is `drive` [rad/s] now is continued over an
    interval of this duration [s], and the derivative of that rate with respect to the speed [1/s].

    The rate is the mean over the interval before, or over half the duration if that is longer, so
    that a jump is overshot by at most twice its size, however unequal the intervals are. Both are 0
    if the speed is held, and for a torque.
    """
    r = record[0]
    if r.is_free == 1 or r.continues == 0:
        return 0.0, 0.0
    since, before = r.t - r.t_ref, r.omega_ref
    if not since > 0.0:
        return r.alpha, 0.0
    if since < 0.5 * duration:
        since, before = r.t - r.t_earlier, r.omega_earlier
        if since < 0.5 * duration:  # nothing is known of so long ago but the rate then
            # which counts up to twice the rate since: beyond that it is of a jump that is over
            most = 2.0 * (drive - before) / since
            earlier = min(max(r.alpha_earlier, min(most, 0.0)), max(most, 0.0))
            before -= earlier * (0.5 * duration - since)
            since = 0.5 * duration
    return (drive - before) / since, 1.0 / since


@jit
def _remember_speed(r):
    """Keep a speed given earlier, at least as long ago as the longest interval since then, with the
    mean rate before it."""
    since = r.t - r.t_ref
    r.longest_since = max(r.longest_since, since)
    if r.t - r.t_earlier >= 2.0 * r.longest_since:
        if r.t_ref > r.t_earlier:
            r.alpha_earlier = (r.omega_ref - r.omega_earlier) / (r.t_ref - r.t_earlier)
        r.t_earlier = r.t_ref
        r.omega_earlier = r.omega_ref
        r.longest_since = since
