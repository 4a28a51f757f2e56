"""What a rotor is: frozen data classes in SI units, checked when they are made.

Lateral motion is written in complex coordinates, z = x + i y (x horizontal, y vertical and up),
as for any axisymmetric rotor (Genta, Dynamics of Rotating Systems, 2005, ch. 4).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

STEEL_POISSON = 0.3


class RotorError(ValueError):
    """A rotor that cannot exist; the message names the quantity, its value and what is allowed."""


# What a number may be, by the field's metadata: (test, words for the message).
_RULES = {
    "positive": (lambda v: v > 0, "must be > 0 and finite"),
    "not negative": (lambda v: v >= 0, "must be >= 0 and finite"),
    "any": (lambda v: True, "must be a finite number"),
}

# The rule of every numeric field, by its name; one home for all classes below.
_FIELD_RULES = {
    "young": "positive",
    "density": "positive",
    "poisson": "not negative",
    "z": "any",
    "diameter": "positive",
    "width": "positive",
    "journal_radius": "positive",
    "clearance": "positive",
    "k": "positive",
    "c": "not negative",
    "delta_c": "positive",
    "mu": "not negative",
    "v_s": "positive",
    "mass": "positive",
    "kx": "positive",
    "ky": "positive",
    "cx": "not negative",
    "cy": "not negative",
    "e": "not negative",
    "phase": "any",
    "stiffness": "not negative",
    "damping": "not negative",
    "eta_v": "not negative",
    "eta_h": "not negative",
    "gravity": "not negative",
}

# Quantities of the rotor itself, and the part under which the FMU lists them.
_OWN_QUANTITIES = {
    "eta_v": "shaft",
    "eta_h": "shaft",
    "rotating_damping": "shaft",
    "gravity": "",
}

# Parts of which a rotor may have several.
_REPEATED = ("disc", "bearing", "support")

_HUGE = 1e30  # beyond it, products of such numbers overflow

_UNITS = {
    "young": "Pa",
    "density": "kg/m3",
    "poisson": "",
    "z": "m",
    "diameter": "m",
    "width": "m",
    "journal_radius": "m",
    "clearance": "m",
    "k": "N/m",
    "c": "N.s/m",
    "delta_c": "m",
    "mu": "",
    "v_s": "m/s",
    "mass": "kg",
    "kx": "N/m",
    "ky": "N/m",
    "cx": "N.s/m",
    "cy": "N.s/m",
    "e": "m",
    "phase": "rad",
    "stiffness": "N/m",
    "damping": "N.s/m",
    "eta_v": "s",
    "eta_h": "",
    "gravity": "m/s2",
}


def check_value(shown: str, name: str, value: float) -> None:
    """Raise `RotorError`, calling it `shown`, unless `value` may be that of the quantity `name`."""
    rule, words = _RULES[_FIELD_RULES[name]]
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise RotorError(f"{shown} = {value!r}: must be a number")
    is_finite = isinstance(value, int) or math.isfinite(value)
    if is_finite and abs(value) > _HUGE:
        raise RotorError(f"{shown}: must not exceed {_HUGE:g} in size")
    if not is_finite or not rule(value):
        unit = f" {_UNITS[name]}" if _UNITS[name] else ""
        raise RotorError(f"{shown} = {value:g}{unit}: {words}")


def _check_numbers(where: str, item: object) -> None:
    for field in fields(item):
        if field.name in _FIELD_RULES:
            check_value(f"{where}.{field.name}", field.name, getattr(item, field.name))


@dataclass(frozen=True)
class Material:
    """An elastic material: Young's modulus [Pa], density [kg/m3], Poisson's ratio [1]."""

    young: float
    density: float
    poisson: float = STEEL_POISSON

    def __post_init__(self) -> None:
        _check_numbers("material", self)
        if self.poisson >= 0.5:
            raise RotorError(f"material.poisson = {self.poisson:g}: must be below 0.5")

    @property
    def shear(self) -> float:
        """Shear modulus [Pa]."""
        return self.young / (2 * (1 + self.poisson))


@dataclass(frozen=True)
class Disc:
    """A rigid solid cylinder on the shaft: node (from 1), diameter and width [m]; eccentricity of
    its mass centre e [m] at the angle `phase` [rad] from the shaft's mark."""

    node: int
    diameter: float
    width: float
    e: float = 0.0
    phase: float = 0.0

    def mass(self, material: Material) -> float:
        """Mass [kg]."""
        return material.density * math.pi / 4 * self.diameter**2 * self.width

    def polar_inertia(self, material: Material) -> float:
        """Moment of inertia about the shaft [kg.m2]."""
        return self.mass(material) * self.diameter**2 / 8

    def diametral_inertia(self, material: Material) -> float:
        """Moment of inertia about a diameter [kg.m2]."""
        return self.mass(material) * (self.diameter**2 / 16 + self.width**2 / 12)


@dataclass(frozen=True)
class Bearing:
    """A journal in the clearance of a housing that moves on springs and dampers (paper A, Fig. 2).

    node (from 1); journal_radius, radial clearance [m]; contact stiffness k [N/m], contact damping
    c [N.s/m] that is fully there at the penetration delta_c [m]; friction coefficient mu, smoothed
    below the sliding speed v_s [m/s]; housing mass [kg], its springs kx, ky [N/m] and dampers
    cx, cy [N.s/m] to ground.
    """

    node: int
    journal_radius: float
    clearance: float
    k: float
    mu: float
    mass: float
    kx: float
    ky: float
    cx: float
    cy: float
    c: float = 100.0
    delta_c: float = 2e-7
    v_s: float = 1e-3


@dataclass(frozen=True)
class Support:
    """A linear isotropic spring [N/m] and damper [N.s/m] from a node to ground."""

    node: int
    stiffness: float
    damping: float = 0.0


@dataclass(frozen=True)
class Rotor:
    """A shaft of circular elements with discs, one optional coupling, bearings and supports.

    nodes: positions along the shaft [m], ascending; diameters: of the elements between them [m];
    eta_v: viscous [s] and eta_h: hysteretic [1] internal damping; rotating_damping: whether the
    internal damping turns with the shaft (Zorzi and Nelson 1977); gravity [m/s2], downwards.

    Raises `RotorError` for anything that no rotor can be.
    """

    material: Material
    nodes: tuple[float, ...]
    diameters: tuple[float, ...]
    discs: tuple[Disc, ...]
    bearings: tuple[Bearing, ...]
    coupling: Disc | None = None
    supports: tuple[Support, ...] = ()
    eta_v: float = 0.0
    eta_h: float = 0.0
    rotating_damping: bool = False
    gravity: float = 9.81
    name: str = "rotor"

    def __post_init__(self) -> None:
        self._check_shaft()
        for where, item in self._parts():
            _check_numbers(where, item)
            self._check_node(where, item.node)
        for kind in (self.bearings, self.supports):
            nodes = [item.node for item in kind]
            if len(set(nodes)) != len(nodes):
                raise RotorError(
                    f"{type(kind[0]).__name__.lower()} nodes {nodes}: each must differ"
                )
        for name in ("eta_v", "eta_h"):
            check_value(f"shaft.{name}", name, getattr(self, name))
        check_value("gravity", "gravity", self.gravity)
        if not isinstance(self.rotating_damping, bool):
            raise RotorError(
                f"shaft.rotating_damping = {self.rotating_damping!r}: must be true or false"
            )
        if self.eta_h > 0 and not self.rotating_damping:
            raise RotorError(
                f"shaft.eta_h = {self.eta_h:g}: must be 0 unless shaft.rotating_damping is true "
                "(hysteretic damping has no stationary form in the time domain)"
            )

    def _parts(self) -> list[tuple[str, Disc | Bearing | Support]]:
        parts = [(f"disc[{i}]", d) for i, d in enumerate(self.discs, 1)]
        parts += [(f"bearing[{i}]", b) for i, b in enumerate(self.bearings, 1)]
        parts += [(f"support[{i}]", s) for i, s in enumerate(self.supports, 1)]
        if self.coupling is not None:
            parts.append(("coupling", self.coupling))
        return parts

    def _check_shaft(self) -> None:
        if len(self.nodes) < 2:
            raise RotorError(f"shaft.nodes: {len(self.nodes)} given, at least 2 are needed")
        if len(self.diameters) != len(self.nodes) - 1:
            raise RotorError(
                f"shaft.diameters: {len(self.diameters)} given, {len(self.nodes) - 1} needed "
                "(one for each element between two nodes)"
            )
        for i, diameter in enumerate(self.diameters, 1):
            check_value(f"shaft.element[{i}].diameter", "diameter", diameter)
        for i, z in enumerate(self.nodes, 1):
            check_value(f"shaft.nodes[{i}]", "z", z)
        for i in range(1, len(self.nodes)):
            length = self.nodes[i] - self.nodes[i - 1]
            if length <= 0:
                raise RotorError(
                    f"shaft.element[{i}].length = {length:g} m: must be > 0 (nodes must ascend)"
                )
        if not self.discs:
            raise RotorError("discs: none given, at least 1 is needed")
        if not self.bearings and not self.supports:
            raise RotorError("bearings: none given, at least 1 (or a support) is needed")

    def _check_node(self, where: str, node: int) -> None:
        if isinstance(node, bool) or not isinstance(node, int) or not 1 <= node <= len(self.nodes):
            raise RotorError(
                f"{where}.node = {node!r}: must be an integer from 1 to {len(self.nodes)}"
            )

    @property
    def length(self) -> float:
        """Length of the shaft [m]."""
        return self.nodes[-1] - self.nodes[0]

    def with_value(self, name: str, value: float | bool) -> Rotor:
        """`with_values` of one quantity."""
        return self.with_values({name: value})

    def with_values(self, values: Mapping[str, float | bool]) -> Rotor:
        """The rotor with some quantities replaced, all at once: the rotor between two of them may
        be impossible.

        values: by names as the FMU spells them: `bearing[1].clearance`, `disc[2].e`,
        `shaft.eta_v`, `gravity`. Raises `RotorError` if a name is unknown or a value impossible.
        """
        changed: dict[str, object] = {}
        parts = {f"{kind}s": list(getattr(self, f"{kind}s")) for kind in _REPEATED}
        for name, value in values.items():
            part, _, attribute = name.rpartition(".")
            if attribute in _OWN_QUANTITIES and part == _OWN_QUANTITIES[attribute]:
                changed[attribute] = value
                continue
            kind, _, index = part.rstrip("]").partition("[")
            items = parts[f"{kind}s"] if kind in _REPEATED else []
            is_there = index in map(str, range(1, len(items) + 1)) and attribute in _FIELD_RULES
            if not is_there or attribute not in {f.name for f in fields(items[int(index) - 1])}:
                raise RotorError(f"{name}: unknown quantity")
            items[int(index) - 1] = replace(items[int(index) - 1], **{attribute: value})
        changed |= {kind: tuple(items) for kind, items in parts.items()}
        return replace(self, **changed)
