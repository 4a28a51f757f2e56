"""A pawl in a ratchet wheel (paper B, section 3.2), and its geometry as TOML.

The wheel is rigid and unrolled into a rack that moves by R theta along x. The pawl is an elastic
plate, pinned at x = 0; its nose at x = L slides down the back of a tooth, slope m, until the
locking face of the next tooth meets it. Openings, frictionless and hard (u: nodes' displacements):

    back of the tooth   s = clearance + (u_y + m u_x - m R theta) / sqrt(1 + m^2)
    locking face        s = slip + R theta - u_x

With the pawl taken as rigid, moment of inertia I about its pin, the wheel accelerates by

    (J + I (m R / L)^2) theta'' = -(T + m R F)
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from functools import cached_property
from importlib.resources import files

import numpy as np
from scipy.sparse import coo_matrix

from ..schemes import Scheme
from .contacts import FlatStops
from .failures import ImpactError
from .march import INCREMENT_CAP, Run, march
from .plane import Solid, solid, to_band
from .stepper import Motion, Stepper
from .structure import Elastic

T_END = 0.03  # [s]
DT = 1e-5  # [s]
_SMOOTH = 41  # samples of the moving mean that separates the fast part of a signal


@dataclass(frozen=True)
class Wheel:
    """Radius [m], moment of inertia [kg m2], torque [N m], number of teeth."""

    radius: float
    inertia: float
    torque: float
    teeth: int


@dataclass(frozen=True)
class Tooth:
    """Slope of its back [1], way of the nose to the locking face [m], clearance at first [m]."""

    slope: float
    slip: float
    clearance: float


@dataclass(frozen=True)
class Pawl:
    """Sizes [m], material [Pa, 1, kg/m3], elements along and across, force on the nose [N]."""

    length: float
    height: float
    nose_length: float
    thickness: float
    E: float
    nu: float
    density: float
    elements: tuple[int, int]
    force: float


_MAY_BE_ZERO = ("force", "slope", "clearance", "nose_length", "nu")


@dataclass(frozen=True)
class Ratchet:
    """A wheel, its teeth and the pawl. Raises `ImpactError` for what cannot be."""

    wheel: Wheel
    tooth: Tooth
    pawl: Pawl
    name: str = "ratchet"

    def __post_init__(self) -> None:
        for part in ("wheel", "tooth", "pawl"):
            table = getattr(self, part)
            for field in fields(table):
                value = getattr(table, field.name)
                if field.name != "elements":
                    _check(f"{part}.{field.name}", value, field.name in _MAY_BE_ZERO)
        elements = self.pawl.elements
        is_pair = isinstance(elements, tuple) and len(elements) == 2
        is_mesh = is_pair and all(type(n) is int and n >= 1 for n in elements)
        if not is_mesh or elements[1] % 2:
            shown = list(elements) if isinstance(elements, tuple) else elements
            raise ImpactError(
                f"pawl.elements = {shown}: must be two numbers, at least [1, 2], "
                "the second even (the pin is at mid-height)"
            )
        if self.pawl.nose_length >= self.pawl.length:
            raise ImpactError(
                f"pawl.nose_length = {self.pawl.nose_length:g} m: must be below pawl.length = "
                f"{self.pawl.length:g} m"
            )

    @property
    def pitch(self) -> float:
        """Of the teeth [m]."""
        return 2 * math.pi * self.wheel.radius / self.wheel.teeth

    @cached_property
    def plate(self) -> Solid:
        """The pawl's mesh and matrices."""
        pawl = self.pawl
        nx, ny = pawl.elements
        bend = pawl.length - pawl.nose_length

        def nose(x: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            from_top = 0.5 - y / pawl.height
            return x, y - from_top * self.tooth.slope * np.maximum(x - bend, 0.0)

        x = np.linspace(0, pawl.length, nx + 1)
        y = np.linspace(-pawl.height / 2, pawl.height / 2, ny + 1)
        return solid(x, y, pawl.E, pawl.nu, pawl.density, pawl.thickness, nose)

    @property
    def pawl_inertia(self) -> float:
        """Of the pawl about its pin [kg m2]."""
        mass = self.plate.mass.diagonal()[::2]
        return float(mass @ (self.plate.points**2).sum(axis=1))

    @property
    def acceleration(self) -> float:
        """Of the wheel while a rigid pawl slides [rad/s2]; negative."""
        arm = self.tooth.slope * self.wheel.radius
        inertia = self.wheel.inertia + self.pawl_inertia * (arm / self.pawl.length) ** 2
        return -(self.wheel.torque + arm * self.pawl.force) / inertia

    @property
    def work(self) -> float:
        """Of the torque and of the force on the nose, as far as the locking face [J]."""
        wheel, tooth = self.wheel, self.tooth
        return (wheel.torque / wheel.radius + tooth.slope * self.pawl.force) * tooth.slip

    @property
    def t_locking(self) -> float:
        """When a rigid pawl has slid to the locking face [s]."""
        return math.sqrt(2 * self.tooth.slip / self.wheel.radius / -self.acceleration)


def _check(name: str, value: object, may_be_zero: bool) -> None:
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value):
        raise ImpactError(f"{name} = {value!r}: must be a finite number")
    if value < 0 or (value == 0 and not may_be_zero):
        raise ImpactError(f"{name} = {value:g}: must be {'>= 0' if may_be_zero else '> 0'}")


def ratchet_toml() -> str:
    """TOML text of the ratchet that comes with the package."""
    return files(__package__).joinpath("ratchet.toml").read_text(encoding="utf-8")


def parse_ratchet(text: str) -> Ratchet:
    """Read a ratchet from TOML text (SI units; `model/impact/ratchet.toml` is the example).

    Raises `ImpactError` naming the key, its value and what is allowed.
    """
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise ImpactError(f"not valid TOML: {' '.join(str(error).split())}") from error
    parts = {"wheel": Wheel, "tooth": Tooth, "pawl": Pawl}
    _refuse_unknown("", data, ("name", *parts))
    name = data.get("name", "ratchet")
    if not isinstance(name, str):
        raise ImpactError(f"name = {name!r}: must be a string")
    made = {part: _make(kind, part, data.get(part)) for part, kind in parts.items()}
    return Ratchet(**made, name=name)


def _make(kind: type, where: str, table: object) -> object:
    if not isinstance(table, Mapping):
        raise ImpactError(f"[{where}] is missing")
    _refuse_unknown(f"{where}.", table, tuple(field.name for field in fields(kind)))
    for field in fields(kind):
        if field.default is MISSING and field.name not in table:
            raise ImpactError(f"{where}.{field.name} is missing")
    values = {key: tuple(v) if isinstance(v, list) else v for key, v in table.items()}
    return kind(**values)


def _refuse_unknown(where: str, table: Mapping[str, object], known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            raise ImpactError(f"{where}{key}: unknown key; known are {', '.join(known)}")


@dataclass(frozen=True)
class Assembly:
    """A ratchet in matrices. nose: unknowns (x, y) of the pawl's end, from below, shape (ny + 1,
    2); free: the unknowns kept of the pawl's 2 N; the last unknown is the wheel's angle [rad]."""

    structure: Elastic
    nose: np.ndarray
    free: np.ndarray


def build(ratchet: Ratchet) -> Assembly:
    """The matrices of a ratchet."""
    pawl, tooth, wheel, plate = ratchet.pawl, ratchet.tooth, ratchet.wheel, ratchet.plate
    size = 2 * len(plate.points)
    pin = 2 * plate.columns[0, pawl.elements[1] // 2]
    kept = np.delete(np.arange(size + 1), [pin, pin + 1])
    place = np.full(size + 1, -1)
    place[kept] = np.arange(len(kept))
    angle = len(kept) - 1
    end = plate.columns[-1]
    bend = pawl.length - pawl.nose_length
    underside = plate.columns[plate.points[plate.columns[:, 0], 0] >= bend * (1 - 1e-9), 0]

    m = tooth.slope
    norm = math.hypot(1.0, m)
    B = np.zeros((len(kept), len(underside) + len(end)))
    for j, node in enumerate(underside):
        B[place[2 * node], j] = m / norm
        B[place[2 * node + 1], j] = 1 / norm
        B[angle, j] = -m * wheel.radius / norm
    for j, node in enumerate(end, len(underside)):
        B[place[2 * node], j] = -1.0
        B[angle, j] = wheel.radius
    opening = np.r_[np.full(len(underside), tooth.clearance), np.full(len(end), tooth.slip)]

    force = np.zeros(len(kept))
    force[place[2 * end + 1]] = -pawl.force / len(end)
    force[angle] = -wheel.torque
    structure = Elastic(
        to_band([plate.mass, coo_matrix([[wheel.inertia]])], kept),
        to_band([plate.stiffness, coo_matrix((1, 1))], kept),
        force,
        FlatStops(B, opening, np.zeros(len(opening))),
        energy_scale=ratchet.work,
    )
    nose = np.stack([place[2 * end], place[2 * end + 1]], axis=1)
    return Assembly(structure, nose, kept[:-1])


@dataclass(frozen=True)
class RatchetRun:
    """A run of a ratchet; run.seen has the columns angle [rad] and speed [rad/s] of the wheel and
    speed of the pawl [rad/s] (of its nose about the pin, downwards negative).

    shapes: displacements of the pawl's nodes [m], shape (frames, N, 2), at times shape_t [s] and
    wheel angles shape_angle [rad].
    """

    ratchet: Ratchet
    run: Run
    shape_t: np.ndarray
    shape_angle: np.ndarray
    shapes: np.ndarray

    @property
    def t(self) -> np.ndarray:
        """Times [s], one an increment, the start first."""
        return self.run.t

    @property
    def wheel_speed(self) -> np.ndarray:
        """Angular velocity of the wheel [rad/s]."""
        return self.run.seen[:, 1]

    @property
    def pawl_speed(self) -> np.ndarray:
        """Angular velocity of the pawl [rad/s]."""
        return self.run.seen[:, 2]

    @property
    def _sliding(self) -> np.ndarray:
        """From when the first bounces are over until shortly before the locking face."""
        t0 = self.ratchet.t_locking
        return (self.t > 0.2 * t0) & (self.t < 0.95 * t0)

    @property
    def slope(self) -> float:
        """Of the wheel's speed while the pawl slides, a straight line through it [rad/s2]; NaN if
        the run did not come that far."""
        inside = self._sliding
        if inside.sum() < 2 * _SMOOTH:
            return math.nan
        return float(np.polyfit(self.t[inside], self.wheel_speed[inside], 1)[0])

    @property
    def t_reversal(self) -> float:
        """When the wheel's speed first changes its sign at the locking face [s]; NaN if never."""
        later = np.flatnonzero((self.t > 0.5 * self.ratchet.t_locking) & (self.wheel_speed > 0))
        return float(self.t[later[0]]) if len(later) else math.nan

    @property
    def fast_content(self) -> float:
        """Root mean square of the pawl's speed about its moving mean, while sliding [rad/s]."""
        inside = self._sliding
        if inside.sum() < 2 * _SMOOTH:
            return math.nan
        kernel = np.full(_SMOOTH, 1 / _SMOOTH)
        signal = self.pawl_speed[inside]
        fast = signal[_SMOOTH // 2 : -(_SMOOTH // 2)] - np.convolve(signal, kernel, "valid")
        return float(np.sqrt(np.mean(fast**2)))

    @property
    def energy_sliding(self) -> float:
        """As `energy_change`, until shortly before the locking face [1]; what is made by then has
        no source but the integrator. NaN if the run did not come that far."""
        if self.t[-1] < 0.95 * self.ratchet.t_locking:
            return math.nan
        energy = self.run.energy[self.t < 0.95 * self.ratchet.t_locking]
        return float((energy[-1] - energy[0]) / self.ratchet.work)

    @property
    def energy_change(self) -> float:
        """Kinetic, elastic and potential energy at the end less that at the start, over
        `Ratchet.work` [1]: what the integrator made, or (negative) lost, impacts included."""
        return float((self.run.energy[-1] - self.run.energy[0]) / self.ratchet.work)


def run_ratchet(
    ratchet: Ratchet,
    scheme: Scheme,
    dt: float = DT,
    impact: str = "no",
    t_end: float = T_END,
    cap: int = INCREMENT_CAP,
    progress: Callable[[float], None] = lambda t: None,
    frame_time: float = math.inf,
) -> RatchetRun:
    """Let the wheel turn; dt, t_end [s]; frame_time: interval at which shapes are kept [s]; see
    `march` for the rest and for what it raises."""
    made = build(ratchet)
    zero = np.zeros(len(made.structure.force))
    start = Stepper(made.structure, scheme).start(0.0, zero, zero.copy())
    shapes, shape_t, shape_angle = [], [], []
    count = 2 * len(ratchet.plate.points)

    def observe(motion: Motion) -> tuple[float, ...]:
        if motion.t >= len(shape_t) * frame_time - 1e-12 and math.isfinite(frame_time):
            nodes = np.zeros(count)
            nodes[made.free] = motion.q[:-1]
            shapes.append(nodes.reshape(-1, 2))
            shape_t.append(motion.t)
            shape_angle.append(motion.q[-1])
        pawl_speed = motion.v[made.nose[:, 1]].mean() / ratchet.pawl.length
        return motion.q[-1], motion.v[-1], pawl_speed

    run = march(made.structure, scheme, start, dt, t_end, impact, observe, cap, progress)
    kept = (np.array(shape_t), np.array(shape_angle), np.array(shapes).reshape(-1, count // 2, 2))
    return RatchetRun(ratchet, run, *kept)
