"""The control of a machine on two radial magnetic bearings as an FMU of its own: PID controllers,
power amplifiers with their limits, electromagnets, and the drive's speed controller.

Of every axis (x, y of either bearing), displaced by s at the sensor and by d in the magnet:

    i_set = -(kp s_f + kd s_f' + integral of ki s),  within -i_bias..i_bias        controller
    i_a' = (i_bias + i_set - i_a) / T,  abs(i_a') <= u_max / L,  i_b with -i_set   amplifiers
    f = K ((i_a / (gap - d))^2 - (i_b / (gap + d))^2)                              magnets

s_f: s behind a low pass. The communication step is the controller's sample time: displacements are
read at its begin, forces follow at its end and are held over the next step, as a digital controller
with a sample's delay has it. A master that steps both FMUs side by side (Jacobi) adds nothing.

Standard library, pythonfmu and the slave that lies beside this file in the FMU only.
"""

import math

from pythonfmu import DefaultExperiment

try:
    from rotor_fmu_slave import BEGUN, Listed, Refused, TableSlave, hold  # beside it in the FMU
except ImportError:
    from rotor_fmu.cosimulation.partner_slave import (  # in the source
        BEGUN,
        Listed,
        Refused,
        TableSlave,
        hold,
    )

hold(globals())  # pythonfmu's wrapper drops a reference to them with each instance

AXES = tuple((side, axis) for side in ("left", "right") for axis in "xy")


def _inputs(side: str, axis: str) -> tuple[Listed, ...]:
    return (
        (f"{side}_{axis}", "input", "m", 0.0, None, f"{axis} at the {side} sensor"),
        (f"{side}_d{axis}", "input", "m", 0.0, None, f"{axis} in the {side} magnet"),
    )


def _outputs(side: str, axis: str) -> tuple[Listed, ...]:
    of = f"of the {side} bearing along {axis}"
    return (
        (f"{side}_f{axis}", "output", "N", None, None, f"force {of}"),
        (f"{side}_i{axis}a", "output", "A", None, None, f"current that pulls to + {of}"),
        (f"{side}_i{axis}b", "output", "A", None, None, f"current that pulls to - {of}"),
        (f"{side}_s{axis}", "local", "m", None, None, f"displacement behind the low pass {of}"),
        (f"{side}_w{axis}", "local", "A", None, None, f"integral part {of}"),
        (f"{side}_p{axis}", "local", "m", None, None, f"last sample in the magnet {of}"),
        (f"{side}_h{axis}", "local", "N", None, None, f"force held over the last step {of}"),
    )


# name, causality, unit, start, lowest value allowed, what it is
VARIABLES: tuple[Listed, ...] = (
    *(variable for of in AXES for variable in _inputs(*of)),
    ("w", "input", "rad/s", 0.0, None, "speed of the rotor"),
    ("w_target", "input", "rad/s", 1400.0, None, "speed that the drive is to reach"),
    ("kp", "parameter", "A/m", 12000.0, 0.0, "proportional gain"),
    ("ki", "parameter", "A/(m.s)", 1e5, 0.0, "integral gain"),
    ("kd", "parameter", "A.s/m", 16.0, 0.0, "derivative gain"),
    ("f_filter", "parameter", "Hz", 2000.0, 1e-3, "corner of the low pass behind the sensors"),
    ("i_bias", "parameter", "A", 3.0, 1e-9, "bias current; a coil carries at most twice as much"),
    ("T", "parameter", "s", 1e-4, 1e-9, "time constant of the amplifiers"),
    ("u_max", "parameter", "V", 150.0, 0.0, "voltage limit of the amplifiers"),
    ("L", "parameter", "H", 0.022, 1e-9, "inductance of a coil"),
    ("K", "parameter", "N.m2/A2", 5.5e-6, 1e-15, "force of a coil at 1 A and 1 m"),
    ("gap", "parameter", "m", 5e-4, 1e-9, "air gap of the magnets"),
    ("t_lift", "parameter", "s", 0.02, 0.0, "time at which the bearings are switched on"),
    ("t_run", "parameter", "s", 0.2, 0.0, "time at which the drive begins"),
    ("t_off", "parameter", "s", 3.4, 0.0, "time at which bearings and drive are switched off"),
    ("ramp", "parameter", "rad/s2", 500.0, 0.0, "rate at which the speed's reference rises"),
    ("kw", "parameter", "N.m.s/rad", 2.0, 0.0, "gain of the speed controller"),
    ("tau_max", "parameter", "N.m", 40.0, 0.0, "torque limit of the drive"),
    *(variable for of in AXES for variable in _outputs(*of)),
    ("tau", "output", "N.m", None, None, "torque of the drive"),
    ("work", "output", "J", None, None, "work of the magnets on the rotor, up to the last sample"),
    ("w_ref", "local", "rad/s", None, None, "reference of the speed controller"),
    BEGUN,
)
# What a master passes on at every communication point, and before the first: (output, input)
INITIAL = (
    *((f"rotor.{side}_sensor.{axis}", f"partner.{side}_{axis}") for side, axis in AXES),
    *((f"rotor.{side}_magnet.{axis}", f"partner.{side}_d{axis}") for side, axis in AXES),
    ("rotor.w", "partner.w"),
)
CONNECTIONS = (
    *INITIAL,
    *((f"partner.{side}_f{axis}", f"rotor.{side}_magnet.f{axis}") for side, axis in AXES),
    ("partner.tau", "rotor.tau_drive"),
)


def follow(i: float, target: float, t: float, T: float, fastest: float) -> float:
    """Current after t [s] of an amplifier that brings it to `target` with the time constant T [s],
    by at most `fastest` [A/s]: straight at that rate, then exponentially."""
    way = target - i
    linear = abs(way) - fastest * T  # what is left to the rate limit
    if linear > 0:
        straight = min(t, linear / fastest if fastest else t)
        i += math.copysign(fastest * straight, way)
        t -= straight
    return target + (i - target) * math.exp(-t / T) if t > 0 else i


class MagneticBearing(TableSlave):
    """Two magnetic bearings with their controllers and amplifiers, and a speed controller."""

    VARIABLES = VARIABLES
    description = "PID magnetic bearings with limited power amplifiers, and a speed controller"
    default_experiment = DefaultExperiment(start_time=0.0, stop_time=4.0, step_size=1e-4)

    def begin(self) -> None:
        """Begin with everything switched off."""
        v = self.__dict__
        for side, axis in AXES:
            v[f"{side}_s{axis}"] = v[f"{side}_{axis}"]
            v[f"{side}_p{axis}"] = v[f"{side}_d{axis}"]
        v["w_ref"] = v["w"]

    def step(self, t: float, h: float) -> None:
        """Take a sample at t [s], and give what comes of it h [s] later."""
        v = self.__dict__
        # half a step of slack for a master that sums its time up
        t += 0.5 * h
        is_on = v["t_lift"] < t < v["t_off"]
        for side, axis in AXES:
            self._axis(side, axis, h, is_on)
        self._drive(h, v["t_run"] < t < v["t_off"])

    def _axis(self, side: str, axis: str, h: float, is_on: bool) -> None:
        """A sample of one axis: the controller, its two amplifiers and magnets."""
        v = self.__dict__
        sensed, d = v[f"{side}_{axis}"], v[f"{side}_d{axis}"]
        if not abs(d) < v["gap"]:
            raise Refused(f"{side}_d{axis} = {d:g} m: must be smaller than the gap, {v['gap']:g} m")
        v["work"] += v[f"{side}_h{axis}"] * (d - v[f"{side}_p{axis}"])
        v[f"{side}_h{axis}"], v[f"{side}_p{axis}"] = v[f"{side}_f{axis}"], d

        bias = v["i_bias"]
        s = v[f"{side}_s{axis}"]
        change = (1 - math.exp(-2 * math.pi * v["f_filter"] * h)) * (sensed - s)
        s = v[f"{side}_s{axis}"] = s + change
        winding = v[f"{side}_w{axis}"] + v["ki"] * h * sensed
        asked = -(v["kp"] * s + v["kd"] * change / h + winding)
        i_set = min(max(asked, -bias), bias)
        # off, or at the limit: the integral stays what it is
        if is_on and i_set == asked:
            v[f"{side}_w{axis}"] = winding
        fastest = v["u_max"] / v["L"]
        a, b = (
            follow(v[coil], bias + sign * i_set if is_on else 0.0, h, v["T"], fastest)
            for coil, sign in ((f"{side}_i{axis}a", 1), (f"{side}_i{axis}b", -1))
        )
        v[f"{side}_i{axis}a"], v[f"{side}_i{axis}b"] = a, b
        pull = (a / (v["gap"] - d)) ** 2 - (b / (v["gap"] + d)) ** 2
        v[f"{side}_f{axis}"] = v["K"] * pull

    def _drive(self, h: float, is_on: bool) -> None:
        """Torque towards the reference, which nears the target at a rate."""
        v = self.__dict__
        if not is_on:
            v["tau"] = 0.0
            return
        way = v["w_target"] - v["w_ref"]
        v["w_ref"] += math.copysign(min(abs(way), v["ramp"] * h), way)
        v["tau"] = min(max(v["kw"] * (v["w_ref"] - v["w"]), -v["tau_max"]), v["tau_max"])
