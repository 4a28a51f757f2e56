"""A motor and the stiff shaft that joins it to a rotor, as an FMU: the speed of the rotor comes in,
the torque of the shaft goes out.

    J w_motor' = torque - tau,    tau = k twist + c twist',    twist' = w_motor - w

Between two communication points w is held (`continuation` 0) or continued by its last change (1).

Standard library, pythonfmu and the slave that lies beside this file in the FMU only.
"""

import math
from collections.abc import Sequence

from pythonfmu import DefaultExperiment

try:
    from rotor_fmu_slave import BEGUN, Listed, TableSlave, hold  # beside it in the FMU
except ImportError:
    from rotor_fmu.cosimulation.partner_slave import (  # in the source
        BEGUN,
        Listed,
        TableSlave,
        hold,
    )

hold(globals())  # pythonfmu's wrapper drops a reference to them with each instance

State = tuple[float, float, float]  # twist, speed of the motor, work

# name, causality, unit, start, lowest value allowed, what it is
VARIABLES: tuple[Listed, ...] = (
    ("w", "input", "rad/s", 60.0, None, "speed of the rotor"),
    ("torque", "parameter", "N.m", 0.4, None, "torque of the motor"),
    ("J", "parameter", "kg.m2", 1e-3, 1e-9, "moment of inertia of the motor"),
    ("k", "parameter", "N.m/rad", 400.0, 0.0, "torsional stiffness of the shaft"),
    ("c", "parameter", "N.m.s/rad", 0.03, 0.0, "torsional damping of the shaft"),
    ("w_start", "parameter", "rad/s", 60.0, None, "speed at the start"),
    ("continuation", "parameter", "1", 1.0, 0.0, "speed between two instants: 0 held, 1 linear"),
    ("h", "parameter", "s", 5e-5, 1e-9, "longest step of the integration"),
    ("tau", "output", "N.m", None, None, "torque of the shaft on the rotor"),
    ("w_motor", "output", "rad/s", None, None, "speed of the motor"),
    ("work_out", "output", "J", None, None, "work that left the shaft for the rotor"),
    ("twist", "local", "rad", None, None, "angle of the motor less that of the rotor"),
    ("w_before", "local", "rad/s", None, None, "speed at the last instant but one"),
    ("step_before", "local", "s", None, None, "length of the last communication step"),
    BEGUN,
)
# (output, input): what a master passes on at each communication point; INITIAL before, in turn
CONNECTIONS = (("partner.tau", "rotor.tau_drive"), ("rotor.w", "partner.w"))
INITIAL = (
    ("partner.w_start", "rotor.w_start"),
    ("rotor.w", "partner.w"),
)


class MotorOnShaft(TableSlave):
    """A motor with a constant torque on a stiff shaft."""

    VARIABLES = VARIABLES
    description = "Motor with constant torque on a stiff shaft"
    default_experiment = DefaultExperiment(start_time=0.0, stop_time=4.0, step_size=1e-4)

    twist: float
    w_before: float
    step_before: float
    work_out: float

    def begin(self) -> None:
        """Begin at the speed `w_start`, the shaft untwisted."""
        self.w_motor = self.w_start
        self.tau = self.c * (self.w_motor - self.w)

    def step(self, t: float, length: float) -> None:
        """Integrate over a communication step by Runge and Kutta's fourth-order rule."""
        rate = 0.0
        if self.continuation and self.step_before:
            rate = (self.w - self.w_before) / self.step_before
        steps = max(1, math.ceil(length / self.h - 1e-9))
        h = length / steps
        y = (self.twist, self.w_motor, self.work_out)
        for i in range(steps):
            t = i * h
            k1 = self._rates(y, self.w + rate * t)
            k2 = self._rates(_along(y, 0.5 * h, k1), self.w + rate * (t + 0.5 * h))
            k3 = self._rates(_along(y, 0.5 * h, k2), self.w + rate * (t + 0.5 * h))
            k4 = self._rates(_along(y, h, k3), self.w + rate * (t + h))
            slopes = [a + 2.0 * (b + c) + d for a, b, c, d in zip(k1, k2, k3, k4, strict=True)]
            y = _along(y, h / 6.0, slopes)
        self.twist, self.w_motor, self.work_out = y
        self.tau = self._torque(y, self.w + rate * length)
        self.w_before, self.step_before = self.w, length

    def _torque(self, y: State, w: float) -> float:
        return self.k * y[0] + self.c * (y[1] - w)

    def _rates(self, y: State, w: float) -> State:
        tau = self._torque(y, w)
        return y[1] - w, (self.torque - tau) / self.J, tau * w


def _along(y: State, h: float, rates: Sequence[float]) -> State:
    a, b, c = y
    return a + h * rates[0], b + h * rates[1], c + h * rates[2]
