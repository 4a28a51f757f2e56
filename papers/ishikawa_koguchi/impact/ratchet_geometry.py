"""What a ratchet is, the closed form of its slide, and its TOML.

A wheel, rigid and unrolled into a rack that moves by R theta along x, and a pawl, an elastic plate
pinned at x = 0, whose nose at x = L slides down the back of a tooth, slope m.

With the pawl taken as rigid, moment of inertia I about its pin, and touching with the tip of its
nose, which lies d below the pin, the wheel turns the pawl by i = m R / (L + m d) a radian:

    (J + I i^2) theta'' = -(T + i L F)
"""

import math
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, fields
from functools import cached_property
from importlib.resources import files
from typing import Any, TypeVar

import numpy as np

from .plane import Solid, solid
from .stepping.failures import ImpactError


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


Part = TypeVar("Part", Wheel, Tooth, Pawl)


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
        pawl, m = self.pawl, self.tooth.slope
        below = pawl.height / 2 + m * pawl.nose_length
        i = m * self.wheel.radius / (pawl.length + m * below)
        torque = self.wheel.torque + i * pawl.length * pawl.force
        return -torque / (self.wheel.inertia + i**2 * self.pawl_inertia)

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
    if not isinstance(value, int | float) or not is_number or not math.isfinite(value):
        raise ImpactError(f"{name} = {value!r}: must be a finite number")
    if value < 0 or (value == 0 and not may_be_zero):
        raise ImpactError(f"{name} = {value:g}: must be {'>= 0' if may_be_zero else '> 0'}")


def ratchet_toml() -> str:
    """TOML text of the ratchet that comes with the package."""
    return files(__package__).joinpath("ratchet.toml").read_text(encoding="utf-8")


def parse_ratchet(text: str) -> Ratchet:
    """Read a ratchet from TOML text (SI units; `ratchet.toml` beside this file is the example).

    Raises `ImpactError` naming the key, its value and what is allowed.
    """
    try:
        data = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
        raise ImpactError(f"not valid TOML: {' '.join(str(error).split())}") from error
    _refuse_unknown("", data, ("name", "wheel", "tooth", "pawl"))
    name = data.get("name", "ratchet")
    if not isinstance(name, str):
        raise ImpactError(f"name = {name!r}: must be a string")
    wheel = _make(Wheel, "wheel", data.get("wheel"))
    tooth = _make(Tooth, "tooth", data.get("tooth"))
    return Ratchet(wheel, tooth, _make(Pawl, "pawl", data.get("pawl")), name=name)


def _make(kind: type[Part], where: str, table: object) -> Part:
    if not isinstance(table, Mapping):
        raise ImpactError(f"[{where}] is missing")
    _refuse_unknown(f"{where}.", table, tuple(field.name for field in fields(kind)))
    for field in fields(kind):
        if field.default is MISSING and field.name not in table:
            raise ImpactError(f"{where}.{field.name} is missing")
    values: dict[str, Any] = {
        key: tuple(v) if isinstance(v, list) else v for key, v in table.items()
    }
    return kind(**values)


def _refuse_unknown(where: str, table: Mapping[str, object], known: Sequence[str]) -> None:
    for key in table:
        if key not in known:
            raise ImpactError(f"{where}{key}: unknown key; known are {', '.join(known)}")
