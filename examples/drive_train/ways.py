"""Ways to couple a motor with the rotor's FMU through a stiff shaft, one communication step each.

J_motor w_motor' = torque - tau,    tau = k (phi_motor - phi) + c (w_motor - w)
"""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from fmpy.fmi1 import FMICallException

from rotor_fmu.cosimulation.member import Member

START, TORQUE = 60.0, 0.4  # speed [rad/s] and torque of the motor [N.m]
J_MOTOR, STIFFNESS, DAMPING = 1e-3, 400.0, 0.03  # [kg.m2], [N.m/rad], [N.m.s/rad]
REFERENCE, FINE = 2e-5, 1e-3  # step of the monolithic run, and how often its speed is noted [s]
ITERATIONS, CONVERGED = 20, 1e-9
LINE_INERTIA = 0.1  # largest inertia of a line, of the motor's
READ = ("phi", "w", "step_work", "dphi_ddrive", "dw_ddrive")  # of the rotor
TERMS = 8  # of the motor's series: the line takes a tenth of its speed at most in a step
WILD = 1e3  # a torque or a speed that says that the coupling has diverged [N.m, rad/s]


@dataclass(frozen=True)
class Motor:
    """The motor's end of the shaft: angle [rad] and speed [rad/s]."""

    phi: float = 0.0
    w: float = START

    def stepped(self, h: float, tau: float, slope: float = 0.0) -> "Motor":
        """Return it after h [s] under the shaft's torque [N.m] with its slope [N.m/s]."""
        rate = (TORQUE - tau) / J_MOTOR
        jerk = -slope / J_MOTOR
        return Motor(
            self.phi + h * (self.w + 0.5 * h * (rate + h * jerk / 3.0)),
            self.w + h * (rate + 0.5 * h * jerk),
        )


class Rotor:
    """The rotor's FMU, driven by a torque."""

    def __init__(self, member: Member) -> None:
        member.begin()
        self.fmu = member.instance
        self.refs = {name: member.variable(name).valueReference for name in (*READ, "tau_drive")}
        self.advances = 0

    def read(self, *names: str) -> list[float]:
        """Return values of Reals."""
        values: list[float] = self.fmu.getReal([self.refs[name] for name in names])
        return values

    def rates(self, *names: str) -> list[float]:
        """Return first derivatives of outputs."""
        refs = [self.refs[name] for name in names]
        values: list[float] = self.fmu.getRealOutputDerivatives(refs, [1] * len(refs))
        return values

    def step(self, t: float, h: float, tau: float, slope: float | None = None) -> None:
        """Step under a torque [N.m], with its slope [N.m/s]."""
        ref = [self.refs["tau_drive"]]
        self.fmu.setReal(ref, [tau])
        if slope is not None:
            self.fmu.setRealInputDerivatives(ref, [1], [slope])
        self.fmu.doStep(t, h)
        self.advances += 1


def _shaft(motor: Motor, phi: float, w: float) -> float:
    """Return the torque of the shaft [N.m]."""
    return STIFFNESS * (motor.phi - phi) + DAMPING * (motor.w - w)


@dataclass(frozen=True)
class Point:
    """The motor, the shaft's torque over the last step, or the mean of what its ends sent each
    other, `tau` to the rotor and `back` [N.m], with slopes [N.m/s], and the energy that left the
    motor, entered the rotor, and that its damper took [J]."""

    motor: Motor
    tau: float = 0.0
    back: float = 0.0
    tau_slope: float = 0.0
    back_slope: float = 0.0
    out: float = 0.0
    entered: float = 0.0
    damped: float = 0.0


def explicit(rotor: Rotor, t: float, h: float, at: Point) -> Point:
    """Take a step of both with the torque that the shaft has at its beginning."""
    phi, w = rotor.read("phi", "w")
    tau = _shaft(at.motor, phi, w)
    return _passed(rotor, t, h, at, tau)


def with_derivatives(rotor: Rotor, t: float, h: float, at: Point) -> Point:
    """Take a step with the torque continued by its slope, from the output derivatives of the
    rotor."""
    phi, w = rotor.read("phi", "w")
    (rate,) = rotor.rates("w")
    tau = _shaft(at.motor, phi, w)
    slope = STIFFNESS * (at.motor.w - w) + DAMPING * ((TORQUE - tau) / J_MOTOR - rate)
    return _passed(rotor, t, h, at, tau, slope)


def iterated(rotor: Rotor, t: float, h: float, at: Point) -> Point:
    """Repeat a step from its state until the torque at its end is that over it."""
    state = rotor.fmu.getFMUstate()
    tau = at.tau
    for _ in range(ITERATIONS):
        end = _passed(rotor, t, h, at, tau)
        phi, w = rotor.read("phi", "w")
        found = _shaft(end.motor, phi, w)
        if abs(found - tau) <= 1e-6 * (1.0 + abs(tau)) or not abs(found) < WILD:
            break
        tau = found
        rotor.fmu.setFMUstate(state)
    else:
        end = _passed(rotor, t, h, at, tau)
    rotor.fmu.freeFMUstate(state)
    return end


def newton(rotor: Rotor, t: float, h: float, at: Point) -> Point:
    """Repeat a step once, with the torque that the sensitivities say the shaft has at its end."""
    state = rotor.fmu.getFMUstate()
    end = _passed(rotor, t, h, at, at.tau)
    phi, w, by_phi, by_w = rotor.read("phi", "w", "dphi_ddrive", "dw_ddrive")
    own = STIFFNESS * 0.5 * h * h / J_MOTOR + DAMPING * h / J_MOTOR
    slope = -own - STIFFNESS * by_phi - DAMPING * by_w
    tau = at.tau + (_shaft(end.motor, phi, w) - at.tau) / (1.0 - slope)
    rotor.fmu.setFMUstate(state)
    rotor.fmu.freeFMUstate(state)
    return _passed(rotor, t, h, at, tau)


def monolithic(rotor: Rotor, t: float, h: float, at: Point) -> Point:
    """Take a step over which the torque goes linearly from what the shaft's law asks for at its
    beginning to what it asks for at its end."""
    state = rotor.fmu.getFMUstate()
    last = at.tau
    for _ in range(ITERATIONS):
        end = _passed(rotor, t, h, at, at.tau, (last - at.tau) / h)
        phi, w, by_phi, by_w = rotor.read("phi", "w", "dphi_ddrive", "dw_ddrive")
        lacking = _shaft(end.motor, phi, w) - last
        if abs(lacking) <= CONVERGED * (1.0 + abs(last)):
            break
        # of a torque that grows over the step the angle has a third, the speed a half
        by_angle = h * h / (6.0 * J_MOTOR) + by_phi / 3.0
        last += lacking / (1.0 + STIFFNESS * by_angle + DAMPING * 0.5 * (h / J_MOTOR + by_w))
        rotor.fmu.setFMUstate(state)
    else:
        end = _passed(rotor, t, h, at, at.tau, (last - at.tau) / h)
    rotor.fmu.freeFMUstate(state)
    return replace(end, tau=last)


def _impedance(h: float) -> float:
    """Return that of a line which takes h [s] to cross and stands for the shaft [N.m.s/rad]: of the
    shaft's stiffness, or of less where the line's inertia would be more than a share of the
    motor's."""
    return min(STIFFNESS * h, LINE_INERTIA * J_MOTOR / h)


def line(rotor: Rotor, t: float, h: float, at: Point) -> Point:
    """Replace the shaft by a line that takes one step to cross: what one end sent over a step, its
    mean and slope, arrives at the other a step later. The damping stays out."""
    impedance = _impedance(h)
    phi_before, w_before = rotor.read("phi", "w")
    rotor.step(t, h, at.tau - 0.5 * h * at.tau_slope, at.tau_slope)
    phi, w, entered = rotor.read("phi", "w", "step_work")
    # at the motor: J w' = torque - b - Z w, with b that arrives; w as a series of powers of t
    forces = [TORQUE - at.back + 0.5 * h * at.back_slope, -at.back_slope] + [0.0] * TERMS
    series = [at.motor.w]
    for n in range(TERMS):
        series.append((forces[n] - impedance * series[n]) / (J_MOTOR * (n + 1)))
    end = sum(c * h**n for n, c in enumerate(series))
    turned = sum(c * h ** (n + 1) / (n + 1) for n, c in enumerate(series))
    # the moment of w about the middle of the step
    moment = sum(0.5 * n * c * h ** (n + 2) / ((n + 1) * (n + 2)) for n, c in enumerate(series))
    return replace(
        at,
        motor=Motor(at.motor.phi + turned, end),
        tau=at.back + 2.0 * impedance * turned / h,
        tau_slope=at.back_slope + 24.0 * impedance * moment / h**3,
        back=at.tau - 2.0 * impedance * (phi - phi_before) / h,
        back_slope=at.tau_slope - 2.0 * impedance * (w - w_before) / h,
        out=at.out + TORQUE * turned - 0.5 * J_MOTOR * (end**2 - at.motor.w**2),
        entered=at.entered + entered,
    )


def _passed(
    rotor: Rotor, t: float, h: float, at: Point, tau: float, slope: float | None = None
) -> Point:
    motor = at.motor.stepped(h, tau, slope or 0.0)
    (before,) = rotor.read("phi")
    rotor.step(t, h, tau, slope)
    phi, entered = rotor.read("phi", "step_work")
    turned = motor.phi - at.motor.phi
    twisted = turned - (phi - before)
    mean = tau + 0.5 * h * (slope or 0.0)
    return replace(
        at,
        motor=motor,
        tau=tau,
        out=at.out + mean * turned,
        entered=at.entered + entered,
        damped=at.damped + DAMPING * twisted * twisted / h,
    )


Method = Callable[[Rotor, float, float, Point], Point]
METHODS: dict[str, Method] = {
    "explicit": explicit,
    "explicit with derivatives": with_derivatives,
    "iterated": iterated,
    "one Newton iteration": newton,
    "transmission line": line,
}
_WITH_SENSITIVITIES = (newton, monolithic)


def _stored(at: Point, phi: float, h: float, is_line: bool) -> float:
    """Return the energy in the shaft, or on its way in the line [J]."""
    if is_line:
        slopes = (at.tau_slope**2 + at.back_slope**2) * h * h / 12.0
        return (at.tau**2 + at.back**2 + slopes) * h / (4.0 * _impedance(h))
    return 0.5 * STIFFNESS * (at.motor.phi - phi) ** 2


@dataclass(frozen=True)
class Result:
    """Speed of the rotor at common instants [rad/s], energy lost at the joint relative to what
    passed [1], steps of the rotor, and CPU seconds that they took."""

    w: np.ndarray
    lost: float
    advances: int
    seconds: float


def couple(
    folder: str, method: Method | str, h: float, stop: float, every: float = 1.5e-2
) -> Result:
    """Run motor and rotor to `stop` [s] with the communication step h [s]; every: how often the
    speed is noted, a multiple of h."""
    step = METHODS[method] if isinstance(method, str) else method
    is_line = step is line
    parameters: dict[str, Any] = {"w_start": START}
    if step in _WITH_SENSITIVITIES:
        parameters["solver.sensitivities"] = True
    if is_line:
        parameters["tau_impedance"] = _impedance(h)
    at, speeds = Point(Motor()), []
    if is_line:
        at = replace(at, tau=_impedance(h) * START, back=-_impedance(h) * START)
    stored = _stored(at, 0.0, h, is_line)
    steps = round(every / h)
    with Member(Path(folder), parameters, [], name="rotor") as member:
        rotor = Rotor(member)
        begin = time.process_time()
        for i in range(round(stop / h)):
            try:
                at = step(rotor, i * h, h, at)
            except FMICallException:
                at = replace(at, motor=Motor(math.nan, math.nan))
            if not (abs(at.motor.w) < WILD and abs(at.tau) < WILD):
                break
            if (i + 1) % steps == 0:
                speeds += rotor.read("w")
        seconds = time.process_time() - begin
        (phi,) = rotor.read("phi")
    short = round(stop / every) - len(speeds)
    kept = _stored(at, phi, h, is_line) - stored
    lost = abs(at.out - at.entered - at.damped - kept) / max(abs(at.entered), 1e-12)
    lost = math.inf if short else lost
    return Result(np.array(speeds + [math.nan] * short), lost, rotor.advances, seconds)


def reference(folder: str, stop: float) -> np.ndarray:
    """Return the speed of the monolithic run at every multiple of `FINE` up to `stop` [s]."""
    return couple(folder, monolithic, REFERENCE, stop, FINE).w
