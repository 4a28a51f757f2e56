"""A drive train as an FMU of its own: a speed-controlled motor with a torque limit, and a flexible
coupling to the rotor, whose moment of inertia it holds.

    J_motor w_motor' = tau_motor - tau_coupling
    J_rotor w'       = tau_coupling - tau_load
    tau_coupling     = k (phi_motor - phi) + c (w_motor - w)
    tau_motor        = kp (w_ref - w_motor) + integral, within -tau_max..tau_max

The rotor's FMU takes the speed `w` and answers with `tau_load`: what friction, whirl and unbalance
put on the shaft. The rotor's own inertia is integrated here, so that no torque J w' has to go
around the loop, late by a communication step: that would be unstable whenever J_rotor > J_motor.

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

# name, causality, unit, start, lowest value allowed, what it is
VARIABLES: tuple[Listed, ...] = (
    ("tau_load", "input", "N.m", 0.0, None, "load of the rotor beside its inertia"),
    ("w_target", "input", "rad/s", 400.0, None, "speed that the controller is to reach"),
    ("J_motor", "parameter", "kg.m2", 1e-3, 1e-9, "moment of inertia of the motor"),
    ("J_rotor", "parameter", "kg.m2", 0.00953935374681161, 1e-9, "moment of inertia of the rotor"),
    ("k", "parameter", "N.m/rad", 400.0, 0.0, "torsional stiffness of the coupling"),
    ("c", "parameter", "N.m.s/rad", 0.03, 0.0, "torsional damping of the coupling"),
    ("tau_max", "parameter", "N.m", 0.2, 0.0, "torque limit of the motor"),
    ("kp", "parameter", "N.m.s/rad", 0.1, 1e-9, "proportional gain of the speed controller"),
    ("ki", "parameter", "N.m/rad", 0.2, 0.0, "integral gain of the speed controller"),
    ("ramp", "parameter", "rad/s2", 10.0, 0.0, "rate at which the reference nears the target"),
    ("w_start", "parameter", "rad/s", 0.0, None, "speed at the start"),
    ("continuation", "parameter", "1", 0.0, 0.0, "load between two instants: 0 held, 1 linear"),
    ("h", "parameter", "s", 5e-4, 1e-9, "longest step of the integration"),
    ("w", "output", "rad/s", None, None, "speed of the rotor's end of the coupling"),
    ("phi", "output", "rad", None, None, "angle of the rotor's end"),
    ("w_motor", "output", "rad/s", None, None, "speed of the motor"),
    ("tau_motor", "output", "N.m", None, None, "torque of the motor"),
    ("tau_coupling", "output", "N.m", None, None, "torque in the coupling"),
    ("work_motor", "output", "J", None, None, "work of the motor since the start"),
    ("work_out", "output", "J", None, None, "work that left the coupling for the rotor"),
    ("w_ref", "local", "rad/s", None, None, "reference of the controller"),
    ("phi_motor", "local", "rad", None, None, "angle of the motor"),
    ("integral", "local", "N.m", None, None, "integral part of the controller"),
    ("loss", "local", "J", None, None, "dissipated in the coupling since the start"),
    ("load_before", "local", "N.m", None, None, "load at the last instant but one"),
    ("step_before", "local", "s", None, None, "length of the last communication step"),
    BEGUN,
)
# (output, input): what a master passes on at each communication point; INITIAL before, in turn
CONNECTIONS = (("partner.w", "rotor.speed"), ("rotor.tau_load", "partner.tau_load"))
INITIAL = (
    ("partner.w_start", "rotor.speed"),  # before the rotor is asked for anything
    ("rotor.J", "partner.J_rotor"),
    ("rotor.tau_load", "partner.tau_load"),
)
# What is integrated, in this order.
STATES = ("phi_motor", "w_motor", "phi", "w", "integral", "work_motor", "work_out", "loss")


def _along(y: Sequence[float], h: float, rates: Sequence[float]) -> list[float]:
    return [a + h * b for a, b in zip(y, rates, strict=True)]


class DriveTrain(TableSlave):
    """A speed-controlled motor with a torque limit, on a flexible coupling."""

    VARIABLES = VARIABLES
    description = "Motor with torque limit and speed controller, flexible coupling"
    default_experiment = DefaultExperiment(start_time=0.0, stop_time=60.0, step_size=0.001)

    step_before: float

    def begin(self) -> None:
        """Begin at the speed `w_start`, the coupling untwisted."""
        self.w = self.w_motor = self.w_ref = self.w_start
        self.load_before = self.tau_load
        self._see()

    def step(self, t: float, length: float) -> None:
        """Integrate over a communication step by Runge and Kutta's fourth-order rule."""
        rate = 0.0
        if self.continuation and self.step_before:
            rate = (self.tau_load - self.load_before) / self.step_before
        start, target, load = self.w_ref, self.w_target, self.tau_load

        def reference(t: float) -> float:
            way = target - start
            return start + math.copysign(min(abs(way), self.ramp * t), way)

        steps = max(1, math.ceil(length / self.h - 1e-9))
        h = length / steps
        y = [getattr(self, name) for name in STATES]
        for i in range(steps):
            t = i * h
            half, end = t + 0.5 * h, t + h
            middle = reference(half), load + rate * half
            k1 = self._rates(y, reference(t), load + rate * t)
            k2 = self._rates(_along(y, 0.5 * h, k1), *middle)
            k3 = self._rates(_along(y, 0.5 * h, k2), *middle)
            k4 = self._rates(_along(y, h, k3), reference(end), load + rate * end)
            slopes = zip(k1, k2, k3, k4, strict=True)
            y = _along(y, h / 6, [a + 2 * (b + c) + d for a, b, c, d in slopes])
        for name, value in zip(STATES, y, strict=True):
            setattr(self, name, value)
        self.w_ref = reference(length)
        self.load_before, self.step_before = load, length
        self._see()

    def _motor(self, w_ref: float, w_motor: float, integral: float) -> tuple[float, float]:
        """Torque of the motor, and what the controller asks for [N.m]."""
        asked = self.kp * (w_ref - w_motor) + integral
        return min(max(asked, -self.tau_max), self.tau_max), asked

    def _rates(self, y: Sequence[float], w_ref: float, load: float) -> tuple[float, ...]:
        """Time derivatives of `STATES`."""
        phi_motor, w_motor, phi, w, integral, *_ = y
        tau, asked = self._motor(w_ref, w_motor, integral)
        slip = w_motor - w
        coupling = self.k * (phi_motor - phi) + self.c * slip
        # at the limit the integral follows the torque that there is (back-calculation)
        winding = self.ki * (w_ref - w_motor + (tau - asked) / self.kp)
        return (
            w_motor,
            (tau - coupling) / self.J_motor,
            w,
            (coupling - load) / self.J_rotor,
            winding,
            tau * w_motor,
            coupling * w,
            self.c * slip * slip,
        )

    def _see(self) -> None:
        self.tau_motor, _ = self._motor(self.w_ref, self.w_motor, self.integral)
        slip = self.w_motor - self.w
        self.tau_coupling = self.k * (self.phi_motor - self.phi) + self.c * slip
