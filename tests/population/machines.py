"""Machines drawn at random: every kind of part that CVODE's equations know, responses of all sizes,
constant speeds, ramps."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rotor_fmu.model.linear import unbalance_response
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.message_templates import Message
from rotor_fmu.model.parts.base import BASE
from rotor_fmu.model.settings import Settings
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.interface import ports

from ..toml_text import table

GRAVITY = 9.81
SAMPLES = 401


@dataclass(frozen=True)
class Case:
    """A machine that turns at speed + rate t [rad/s] until `stop` [s]; kind: of its contact or
    bearing; node: whose motion is looked at; base: acceleration of the foundation [m/s2], complex,
    at times evenly from 0 to `stop`, linear in between, empty where it stands."""

    name: str
    kind: str
    rotor: Rotor
    speed: float
    rate: float
    stop: float
    node: int
    base: np.ndarray

    @property
    def times(self) -> np.ndarray:
        """The times at which it is looked at [s]."""
        return np.linspace(0.0, self.stop, SAMPLES + 1)

    def simulation(self, *settings: Settings, warn: Callable[[Message], None]) -> Simulation:
        """This project's run at its start."""
        loads = self._loads(self.base[0]) if len(self.base) else None
        return Simulation(
            self.rotor, *settings, speed=self.speed, rate=self.rate, loads=loads, warn=warn
        )

    def advance(self, simulation: Simulation, to: int) -> None:
        """Go on to a number of `times`, from the one before."""
        interval, speed = self.stop / SAMPLES, self.speed + self.rate * simulation.time
        loads = rates = None
        if len(self.base):
            loads = self._loads(self.base[to - 1])
            rates = (self._loads(self.base[to]) - loads) / interval
        simulation.advance(self.times[to], speed, loads, rate=self.rate, load_rates=rates)

    def _loads(self, acceleration: complex) -> np.ndarray:
        """What acts on the machine's ports: on the base alone."""
        return np.array(
            [acceleration if port.node == BASE else 0.0 for _, port in ports(self.rotor)], complex
        )


class Draw:
    """Random numbers of one machine."""

    def __init__(self, seed: int) -> None:
        self.rng = np.random.default_rng([20261122, seed])

    def log(self, low: float, high: float) -> float:
        """Between two positive numbers, even in the logarithm."""
        return math.exp(self.rng.uniform(math.log(low), math.log(high)))

    def between(self, low: float, high: float) -> float:
        """Between two numbers."""
        return float(self.rng.uniform(low, high))

    def one(self, *choices: float) -> float:
        """One of some numbers."""
        return float(self.rng.choice(choices))


@dataclass(frozen=True)
class Shaft:
    """What every machine has: a shaft of four to seven elements with one or two discs."""

    text: str
    nodes: int
    disc: int
    length: float
    diameter: float
    mass: float

    @property
    def stiffness(self) -> float:
        """Between its ends, about [N/m]."""
        return 48 * 2.1e11 * math.pi / 64 * self.diameter**4 / self.length**3

    @property
    def near(self) -> int:
        """The node beside the disc."""
        return max(2, min(self.nodes - 1, self.disc + 1))


def bar(draw: Draw, eta_v: float, others: str = "") -> Shaft:
    nodes = int(draw.rng.integers(5, 9))
    length, diameter = draw.log(0.3, 1.5), draw.log(0.012, 0.04)
    z = np.linspace(0.0, length, nodes)
    z[1:-1] += draw.rng.uniform(-0.2, 0.2, nodes - 2) * length / (nodes - 1)
    outer = [diameter * draw.between(0.9, 1.3) for _ in range(nodes - 1)]
    sections = ""
    for i, d in enumerate(outer):
        shape: dict[str, object] = {"length": float(z[i + 1] - z[i])}
        if draw.between(0, 1) < 0.25:
            shape |= {"outer_left": d, "outer_right": d * draw.between(0.8, 1.2)}
        else:
            shape |= {"outer": d}
        if draw.between(0, 1) < 0.25:
            shape |= {"bore": 0.3 * d}
        sections += table("[section]", **shape)
    disc = int(draw.rng.integers(2, nodes))
    width, disc_diameter = draw.between(0.02, 0.05), diameter * draw.between(5, 10)
    mass = 7800.0 * math.pi / 4 * disc_diameter**2 * width
    text = (
        f'name = "drawn"\n{others}\n[material]\nyoung = 2.1e11\ndensity = 7800.0\n'
        f"[shaft]\neta_v = {eta_v!r}\n{sections}"
        + table("[disc]", node=disc, diameter=disc_diameter, width=width, e=1e-5, phase=0.4)
    )
    if draw.between(0, 1) < 0.4:
        other = 1 + disc % (nodes - 1)
        text += table(
            "[disc]", node=other, diameter=0.6 * disc_diameter, width=width, e=5e-6, phase=2.0
        )
    return Shaft(text, nodes, disc, length, diameter, mass)


def contact(draw: Draw, stiffness: float, clearance: float, **more: object) -> dict[str, object]:
    """What a clearance contact is; stiffness: of the shaft, that of the contact is some of it."""
    return {
        "journal_radius": 0.01,
        "clearance": clearance,
        "mu": draw.log(0.02, 0.3),
        "k": stiffness * draw.log(3.0, 100.0),
        "c": draw.log(10.0, 300.0),
        **more,
    }


def held(draw: Draw, shaft: Shaft) -> str:
    """Supports at both ends, or linear bearings."""
    text = ""
    for node in (1, shaft.nodes):
        k = shaft.stiffness * draw.log(1.0, 10.0)
        c = 2 * draw.log(0.03, 0.3) * math.sqrt(k * shaft.mass)
        if draw.between(0, 1) < 0.5:
            text += table("[support]", node=node, stiffness=k, damping=c)
        else:
            other = k * draw.between(0.5, 1.0)
            text += table("[linear_bearing]", node=node, kxx=k, kyy=other, cxx=c, cyy=0.7 * c)
    return text


def _tabulated(draw: Draw, kind: str, shaft: Shaft, k: float, crossed: float, top: float) -> str:
    """A bearing whose coefficients follow the speed, cross coupled by `crossed` [N/m] at the top
    speed [rad/s]."""
    speeds = [0.1 * top, 0.4 * top, 0.7 * top, 1.1 * top]
    rise = [0.2, 0.5, 0.8, 1.2]
    c = 2 * draw.log(0.02, 0.1) * math.sqrt(k * shaft.mass)
    return table(
        f"[{kind}]",
        node=shaft.disc if kind == "seal" else 1,
        speed=speeds,
        kxx=[k * (1 + 0.2 * r) for r in rise],
        kyy=[k * (1 + 0.1 * r) for r in rise],
        kxy=[crossed * r for r in rise],
        kyx=[-crossed * r for r in rise],
        cxx=[c] * 4,
        cyy=[c] * 4,
    )


def _around(kind: str, draw: Draw, shaft: Shaft, clearance: float) -> str:
    """What the kind adds to the shaft: how it is held, and what it touches."""
    k = shaft.stiffness
    if kind == "bearing":
        return "".join(
            table(
                "[bearing]",
                node=node,
                **contact(draw, k, clearance),
                mass=0.2 * shaft.mass * draw.between(0.3, 1.0),
                kx=k * draw.log(3, 30),
                ky=k * draw.log(30, 1000),
                cx=0.1 * math.sqrt(k * shaft.mass),
                cy=0.1 * math.sqrt(k * shaft.mass),
            )
            for node in (1, shaft.nodes)
        )
    if kind == "touchdown":
        return "".join(
            table(
                "[touchdown_bearing]",
                node=node,
                **contact(draw, k, clearance),
                race_inertia=draw.log(1e-5, 1e-3),
                race_drag=draw.log(1e-4, 1e-2),
            )
            for node in (1, shaft.nodes)
        ) + table("start", y=0.0)
    if kind == "housing":
        mass, stiff = 0.3 * shaft.mass, k * draw.log(3, 30)
        text = table(
            "[housing]", name="pedestal", mass=mass, mass_ratio=1.3, kx=stiff, ky=2 * stiff,
            cx=0.1 * math.sqrt(stiff * mass), cy=0.1 * math.sqrt(stiff * mass),
        )  # fmt: skip
        text += table(
            "[linear_bearing]", node=1, housing="pedestal", kxx=2 * k, kyy=3 * k,
            cxx=0.1 * math.sqrt(k * shaft.mass), cyy=0.1 * math.sqrt(k * shaft.mass),
        )  # fmt: skip
        text += table("[support]", node=shaft.nodes, stiffness=3 * k, damping=20.0)
        return text + table(
            "[contact]", node=shaft.near, housing="pedestal", **contact(draw, k, clearance)
        )
    more: dict[str, object] = {}
    if kind == "hertz":
        # as stiff as a linear contact at a tenth of the clearance
        more = {"exponent": 1.5, "k": 10 * k / math.sqrt(0.1 * clearance)}
    if kind == "stribeck":
        more = {"mu_rise": draw.between(0.05, 0.3), "v_stribeck": draw.log(0.01, 0.3)}
    if kind == "worn":
        more = {"wear": clearance * draw.between(0.1, 1.0), "wear_angle": draw.between(0, 6)}
    text = held(draw, shaft)
    return text + table("[contact]", node=shaft.near, **(contact(draw, k, clearance) | more))


KINDS = (
    *("stator", "bearing", "hertz", "stribeck", "worn", "touchdown"),
    *("housing", "table", "seal", "rotating", "tilted", "base"),
)
# A machine of a number from this on is that of the number less this, turning at up to thirty times
# its lowest natural frequency instead of at up to 2.5 times.
FAST = 1000 * len(KINDS)


def drawn(seed: int) -> Case:
    """The machine of this number."""
    draw = Draw(seed % FAST)
    kind = KINDS[seed % len(KINDS)]
    gravity = draw.one(0.0, GRAVITY) if kind not in ("touchdown", "bearing") else GRAVITY
    others = f"gravity = {gravity}\n"
    if kind == "tilted":
        others = (
            f"gravity = {GRAVITY}\ngravity_angle = {draw.between(-1, 1)!r}\n"
            f"inclination = {draw.between(0, 1.2)!r}\n"
        )
    eta_v = draw.log(1e-6, 3e-5) if kind != "rotating" else draw.log(1e-5, 1e-4)
    shaft = bar(draw, eta_v, others)
    text = shaft.text
    if kind == "rotating":
        text = text.replace("[shaft]\n", "[shaft]\nrotating_damping = true\n")
    k = shaft.stiffness
    lowest = math.sqrt(k / (shaft.mass * 1.3))
    top = lowest * (draw.between(0.4, 2.5) if seed < FAST else draw.log(5.0, 30.0))
    if kind == "table":
        text += _tabulated(draw, "linear_bearing", shaft, 3 * k, k * draw.log(0.02, 0.3), top)
    if kind == "seal":
        text += _tabulated(draw, "seal", shaft, 0.05 * k, k * draw.log(0.01, 0.1), top)
    ramp = draw.one(0.0, 1.0, -1.0)
    stop = 40 * 2 * math.pi / lowest
    speed, rate = top, 0.0
    if ramp:
        other = top * draw.between(0.3, 0.7)
        first, last = (other, top) if ramp > 0 else (top, other)
        speed, rate = first, (last - first) / stop
    clearance = _clearance(kind, draw, shaft, text, (speed, speed + rate * stop))
    text += _around(kind, draw, shaft, clearance)
    base = np.zeros(0, complex)
    if kind == "base":
        text += "[base]\n"
        base = _shaken(draw, lowest * stop, GRAVITY * draw.log(1e-3, 1.0))
    rotor = parse_rotor(text)
    return Case(f"{kind} {seed}", kind, rotor, speed, rate, stop, shaft.disc, base)


def _shaken(draw: Draw, radians: float, size: float) -> np.ndarray:
    """A foundation's acceleration [m/s2]: two oscillations of this size at `radians` of the lowest
    mode until the end, times a factor each."""
    at = np.linspace(0.0, radians, SAMPLES + 1)
    x, y = (np.sin(draw.between(0.2, 0.9) * at + draw.between(0, 6)) for _ in "xy")
    return size * (x + 1j * draw.between(0.3, 1.0) * y)


def _clearance(
    kind: str, draw: Draw, shaft: Shaft, text: str, speeds: tuple[float, float]
) -> float:
    """A clearance that the linear response to unbalance is a thousandth to a hundred times of."""
    if kind in ("bearing", "touchdown"):
        return draw.log(2e-5, 3e-4)
    machine = parse_rotor(text + held(Draw(0), shaft))
    low, high = sorted(speeds)
    at = np.linspace(low, high, 30) if high > low else [low]
    response = unbalance_response(machine, at, contacts="open")
    size = float(response.major[:, shaft.near - 1].max())
    return size / draw.log(1e-3, 1e2)
