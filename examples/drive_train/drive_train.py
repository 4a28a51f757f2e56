"""A drive train as an FMU of its own: a speed-controlled motor with a torque limit, and a flexible
coupling to the rotor, whose moment of inertia it holds.

    J_motor w_motor' = tau_motor - tau_coupling
    J_rotor w'       = tau_coupling - tau_load
    tau_coupling     = k (phi_motor - phi) + c (w_motor - w)
    tau_motor        = kp (w_ref - w_motor) + integral, within -tau_max..tau_max

The rotor's FMU takes the speed `w` and answers with `tau_load`: what friction, whirl and unbalance
put on the shaft. The rotor's own inertia is integrated here, so that no torque J w' has to go
around the loop, late by a communication step: that would be unstable whenever J_rotor > J_motor.

Standard library and pythonfmu only.
"""

import ctypes
import math
import uuid
from collections.abc import Sequence

from pythonfmu import DefaultExperiment, Fmi2Causality, Fmi2Initial, Fmi2Slave, Fmi2Variability
from pythonfmu import Real as FmiReal

try:
    from rotor_fmu_wrapper import hold, settle_exit  # beside this file in the FMU
except ImportError:
    from rotor_fmu.fmu.wrapper import hold, settle_exit  # in the source tree

# For each instance pythonfmu's wrapper drops a reference to these globals that it never took.
ctypes.pythonapi.Py_IncRef(ctypes.py_object(globals()))

# name, causality, unit, start, lowest value allowed, what it is
VARIABLES = (
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
)
# What is integrated, in this order.
STATES = ("phi_motor", "w_motor", "phi", "w", "integral", "work_motor", "work_out", "loss")


class DriveTrainError(ValueError):
    """An input, a parameter or a step that cannot be; names it and says what is allowed."""

    def __repr__(self) -> str:
        """The sentence alone, which pythonfmu's wrapper logs."""
        return str(self)


def _along(y: Sequence[float], h: float, rates: Sequence[float]) -> list[float]:
    return [a + h * b for a, b in zip(y, rates, strict=True)]


class DriveTrain(Fmi2Slave):
    """A speed-controlled motor with a torque limit, on a flexible coupling."""

    description = "Motor with torque limit and speed controller, flexible coupling"
    author = "The rotor-fmu authors"
    license = "MIT"
    default_experiment = DefaultExperiment(start_time=0.0, stop_time=60.0, step_size=0.001)

    step_before: float

    def __init__(self, **kwargs: object) -> None:
        super().__init__(**kwargs)
        settle_exit(self.resources, self.modelName)
        self.guid = uuid.uuid5(uuid.NAMESPACE_URL, __name__)  # in the FMU it follows the content
        for name, causality, _, start, _, text in VARIABLES:
            setattr(self, name, start or 0.0)
            is_parameter = causality == "parameter"
            initial = {"parameter": Fmi2Initial.exact, "input": None}
            variable = FmiReal(
                name,
                causality=Fmi2Causality[causality],
                variability=Fmi2Variability.fixed if is_parameter else Fmi2Variability.continuous,
                initial=initial.get(causality, Fmi2Initial.calculated),
                description=text,
            )
            self.register_variable(variable)

    def exit_initialization_mode(self) -> None:
        """Begin at the speed `w_start`, the coupling untwisted."""
        try:
            self._check(("input", "parameter"))
        except DriveTrainError:
            hold(self, self.log_queue, type(self))  # the wrapper drops them on any exception
            raise
        self.w = self.w_motor = self.w_ref = self.w_start
        self.load_before = self.tau_load
        self._see()

    def do_step(self, current_time: float, step_size: float) -> bool:
        """Integrate over a communication step by Runge and Kutta's fourth-order rule."""
        try:
            self._check(("input",))
            if not (step_size > 0 and math.isfinite(step_size)):
                raise DriveTrainError(f"doStep over {step_size:g} s: the step must be > 0")
        except DriveTrainError:
            hold(self, self.log_queue, type(self))
            raise
        rate = 0.0
        if self.continuation and self.step_before:
            rate = (self.tau_load - self.load_before) / self.step_before
        start, target, load = self.w_ref, self.w_target, self.tau_load

        def reference(t: float) -> float:
            way = target - start
            return start + math.copysign(min(abs(way), self.ramp * t), way)

        steps = max(1, math.ceil(step_size / self.h - 1e-9))
        h = step_size / steps
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
        self.w_ref = reference(step_size)
        self.load_before, self.step_before = load, step_size
        self._see()
        return True

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

    def _check(self, causalities: tuple[str, ...]) -> None:
        for name, causality, unit, _, low, _ in VARIABLES:
            value = getattr(self, name)
            if causality in causalities and not math.isfinite(value):
                raise DriveTrainError(f"{name} = {value} {unit}: must be a finite number")
            if causality in causalities and low is not None and value < low:
                raise DriveTrainError(f"{name} = {value:g} {unit}: must be >= {low:g}")
