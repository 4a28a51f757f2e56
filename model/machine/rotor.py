"""The definition of a machine: frozen data classes in SI units, checked when they are made.

Lateral motion is written in complex coordinates, z = x + i y (x horizontal, y vertical and up), as
for any axisymmetric rotor (Genta, Dynamics of Rotating Systems, 2005, ch. 4).
"""

import cmath
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import accumulate
from typing import Any, NamedTuple, TypeVar

from ..message_templates import fill_template
from ..near_names import meant, suggestion
from ..parts.base import (
    BASE,
    GROUND,
    BowElement,
    Element,
    InterfaceElement,
    MountElement,
    Part,
    PortElement,
    ReleaseElement,
)
from ..parts.bearing import Bearing
from ..parts.disc import Disc
from ..parts.law import weighs_nothing
from ..parts.shaft import Material, Section
from ..quantities import (
    ANGLE,
    ANY,
    GRAVITY,
    NOT_NEGATIVE,
    Quantity,
    QuantityError,
    check,
    quantities,
    quantity,
    switch,
)
from .names import IDENTIFIER, Name, check_names, spelled
from .operating_speeds import Operation

AnyPart = TypeVar("AnyPart", bound=Part)
AnyElement = TypeVar("AnyElement", bound=Element)
# See `message_templates`.
HYSTERETIC_AT_REST = (
    "shaft.eta_h = {g}: must be 0 unless shaft.rotating_damping is true (hysteretic damping has no "
    "stationary form in the time domain)"
)


class Parameter(NamedTuple):
    """A number of a machine: its name, its declaration and its value."""

    name: Name
    quantity: Quantity
    value: float


_VERTICAL = 1e-5  # rad of the vertical: pi / 2 with the digits that are usually given


def _is_base(element: Element) -> bool:
    return isinstance(element, PortElement) and element.node == BASE


# The quantities of the machine itself, and the heading under which they stand.
OF_SHAFT = "eta_v", "eta_h", "rotating_damping", "mass_damping"
OWN = dict.fromkeys(OF_SHAFT, "shaft") | {"gravity": ""}


@dataclass(frozen=True)
class Rotor:
    """A shaft of sections with parts on it and beside it.

    material: of discs, and of the sections unless they have their own; sections: from left to
    right; parts: see `parts`; eta_v: viscous [s] and eta_h: hysteretic [1] internal damping;
    rotating_damping: whether the internal damping turns with the shaft (Zorzi and Nelson 1977);
    mass_damping: external damping by the shaft's mass, Rayleigh's alpha [1/s];
    gravity [m/s2], downwards, unless gravity_angle turns it about the shaft [rad], multiplied by
    the cosine of the inclination of the shaft [rad]; start: position of the first node along the
    shaft [m]; operation: operating speeds; identifier: model identifier of its FMU, made from the
    name if empty; units: display units.

    Raises `QuantityError` for an impossible value.
    """

    material: Material
    sections: tuple[Section, ...]
    parts: tuple[Part, ...]
    eta_v: float = quantity(
        "s", "viscous internal damping of the shaft", NOT_NEGATIVE, 0.0, is_parameter=True
    )
    eta_h: float = quantity(
        "1", "hysteretic internal damping of the shaft", NOT_NEGATIVE, 0.0, is_parameter=True
    )
    rotating_damping: bool = switch(
        "whether the internal damping turns with the shaft (Zorzi and Nelson)",
        False,
        is_parameter=True,
    )
    mass_damping: float = quantity(
        "1/s",
        "external damping in proportion to the mass of the shaft (Rayleigh's alpha)",
        NOT_NEGATIVE,
        0.0,
        is_parameter=True,
    )
    gravity: float = quantity(
        "m/s2", "gravity, downwards (-y)", NOT_NEGATIVE, GRAVITY, is_parameter=True
    )
    gravity_angle: float = quantity(
        "rad", "angle of gravity from downwards (-y), x towards y", ANGLE, 0.0
    )
    inclination: float = quantity(
        "rad",
        "angle of the shaft to the horizontal; within 1e-5 of pi / 2: a vertical machine",
        ANGLE,
        0.0,
    )
    name: str = "rotor"
    start: float = quantity("m", "position of the first node", ANY, 0.0)
    operation: Operation = field(default_factory=Operation)
    identifier: str = ""
    units: str = ""

    def __post_init__(self) -> None:
        self._check_shaft()
        is_text = isinstance(self.name, str) and self.name.isprintable()
        if not is_text or not self.name.strip():
            raise QuantityError(
                f"name = {self.name!r}: must be text, not empty, without control characters"
            )
        if not isinstance(self.identifier, str) or not IDENTIFIER.fullmatch(self.identifier):
            raise QuantityError(
                f"identifier = {self.identifier!r}: must be a word of letters, digits and _ that "
                "does not begin with a digit"
            )
        if not isinstance(self.units, str):
            raise QuantityError(f"units = {self.units!r}: must be text, such as 'rpm, mil, pp'")
        self._check_singles()
        check_names(self.parts)
        housings = {GROUND: "the ground"}
        for where, part in self.named_parts():
            part.check(where)
            for element in part.elements(where, self.material.density):
                if isinstance(element, MountElement):
                    if element.name in housings:
                        whose = housings[element.name]
                        raise QuantityError(f"{where}: {whose} has the name {element.name} already")
                    housings[element.name] = where
                elif not isinstance(element, ReleaseElement) and not _is_base(element):
                    self._check_node(where, element)
        self._check_housings(set(housings))
        self._check_base()
        for name, heading in OWN.items():
            shown = str(Name(heading, 0, name))
            check(shown, quantities(self)[name], getattr(self, name))
        for name in ("gravity_angle", "inclination"):
            check(name, quantities(self)[name], getattr(self, name))
        if self.eta_h > 0 and not self.rotating_damping:
            raise QuantityError(fill_template(HYSTERETIC_AT_REST, [self.eta_h]))

    def _check_shaft(self) -> None:
        if not self.sections:
            raise QuantityError("shaft: no section given, at least 1 is needed")
        check("shaft.start", quantities(self)["start"], self.start)
        for i, section in enumerate(self.sections, 1):
            where = f"shaft.element[{i}]"
            if not section.length > 0:
                raise QuantityError(
                    f"{where}.length = {section.length:g} m: must be > 0 (nodes must ascend)"
                )
            section.check(where)

    def _check_node(self, where: str, element: Any) -> None:
        node, highest = element.node, len(self.sections) + 1
        if isinstance(node, bool) or not isinstance(node, int) or not 1 <= node <= highest:
            raise QuantityError(f"{where}.node = {node!r}: must be an integer from 1 to {highest}")
        is_heated = isinstance(element, InterfaceElement) and element.law.bow is not None
        if (is_heated or isinstance(element, BowElement)) and not 1 < node < highest:
            raise QuantityError(
                f"{where}.node = {node}: must be between nodes 1 and {highest}, the ends of the "
                "shaft, where it cannot bow"
            )

    def _check_singles(self) -> None:
        for kind in {type(part) for part in self.parts if part.IS_SINGLE}:
            if len(self.of_kind(kind)) > 1:
                raise QuantityError(f"{kind.KIND}: {len(self.of_kind(kind))} given, 1 may be")

    def _check_housings(self, housings: set[str]) -> None:
        interfaces = self.elements_of_kind(InterfaceElement)
        held = {(e.node, e.housing) for _, e in interfaces if e.ring == GROUND}
        for where, element in interfaces:
            for key in ("housing", "ring"):
                name = getattr(element, key)
                if name not in housings:
                    known = ", ".join(sorted(housings - {GROUND})) or "none"
                    hint = suggestion(name, sorted(housings - {GROUND}))
                    raise QuantityError(
                        f"{where}.{key} = {name!r}: no housing of that name; there is {known}{hint}"
                    )
            if element.ring != GROUND and (element.node, element.ring) not in held:
                raise QuantityError(
                    f"{where}.ring = {element.ring!r}: must be the housing of a bearing at node "
                    f"{element.node}"
                )

    def _check_base(self) -> None:
        elements = list(self.named_elements())
        is_moved = any(_is_base(element) for _, element in elements)
        for where, element in elements:
            if (
                is_moved
                and isinstance(element, InterfaceElement)
                and element.law.weigh is not weighs_nothing
            ):
                raise QuantityError(
                    f"{where}: is not compatible with [base]: its own mass would not be "
                    "accelerated; remove one of them"
                )

    def indexed_parts(self) -> Iterator[tuple[tuple[str, int], Part]]:
        """Yield every part with its kind and its number from 1 (0 if a machine has only one), or
        with its own name and 0, in the order of `parts`."""
        seen: dict[str, int] = {}
        for part in self.parts:
            seen[part.KIND] = seen.get(part.KIND, 0) + 1
            if part.label:
                yield (part.label, 0), part
            else:
                yield (part.KIND, 0 if part.IS_SINGLE else seen[part.KIND]), part

    def named_parts(self) -> Iterator[tuple[str, Part]]:
        """Yield every part with its name, `disc[1]`, in the order of `parts`."""
        for key, part in self.indexed_parts():
            yield spelled(*key), part

    def indexed_elements(self) -> Iterator[tuple[tuple[str, int], Element]]:
        """Yield every element with the kind and the number of its part, in the order of `parts`."""
        for key, part in self.indexed_parts():
            for element in part.elements(spelled(*key), self.material.density):
                yield key, element

    def named_elements(self) -> Iterator[tuple[str, Element]]:
        """Yield every element with the name of its part, in the order of `parts`."""
        yield from ((spelled(*key), element) for key, element in self.indexed_elements())

    def elements_of_kind(self, kind: type[AnyElement]) -> list[tuple[str, AnyElement]]:
        """Return the elements of a kind with the names of their parts."""
        return [(where, e) for where, e in self.named_elements() if isinstance(e, kind)]

    def of_kind(self, kind: type[AnyPart]) -> tuple[AnyPart, ...]:
        """Return the parts of exactly this kind, in their order."""
        return tuple(part for part in self.parts if type(part) is kind)

    @property
    def discs(self) -> tuple[Disc, ...]:
        """The discs."""
        return self.of_kind(Disc)

    @property
    def bearings(self) -> tuple[Bearing, ...]:
        """The bearings with a housing of their own."""
        return self.of_kind(Bearing)

    @property
    def nodes(self) -> tuple[float, ...]:
        """The positions of the nodes along the shaft [m]."""
        return tuple(accumulate((s.length for s in self.sections), initial=self.start))

    @property
    def weight_share(self) -> float:
        """The share of gravity that acts across the shaft [1]; 0 for a vertical one."""
        share = math.cos(self.inclination)
        return share if abs(share) > _VERTICAL else 0.0

    @property
    def down(self) -> complex:
        """The direction of gravity across the shaft, its length the share that acts there [1]."""
        return self.downwards * self.weight_share

    @property
    def downwards(self) -> complex:
        """The direction of gravity across the shaft, of length 1, even of a vertical machine."""
        return -1j * cmath.exp(1j * self.gravity_angle)

    @property
    def length(self) -> float:
        """The length of the shaft [m]."""
        return sum(section.length for section in self.sections)

    def with_parts(self, kind: type[Part], *parts: Part) -> "Rotor":
        """Return the machine with these parts in the place of all of a kind."""
        at = next((i for i, p in enumerate(self.parts) if type(p) is kind), len(self.parts))
        behind = (p for p in self.parts[at:] if type(p) is not kind)
        return replace(self, parts=(*self.parts[:at], *parts, *behind))

    def parameters(self) -> dict[str, Parameter]:
        """Return the `numbers` that an FMU takes as parameters, by their names in it."""
        return {name: of for name, of in self.numbers().items() if of.quantity.is_parameter}

    def numbers(self) -> dict[str, Parameter]:
        """Return the single numbers of the parts, of the shaft, and gravity, by their names; of
        switches those that an FMU takes."""
        found = [
            Parameter(
                Name(*name, own), replace(declared, rule=part.rule_of(own)), getattr(part, own)
            )
            for name, part in self.indexed_parts()
            for own, declared in quantities(part).items()
            if declared.is_parameter or not declared.is_switch
            if not isinstance(getattr(part, own), tuple)
        ]
        of_all = quantities(self)
        found += [Parameter(Name(of, 0, q), of_all[q], getattr(self, q)) for q, of in OWN.items()]
        return {str(number.name): number for number in found}

    def with_values(self, values: Mapping[str, float | bool]) -> "Rotor":
        """Return the machine with some quantities replaced, all at once.

        values: by their names as the FMU spells them: `bearing[1].clearance`, `shaft.eta_v`,
        `gravity`; of switches 1 and 0 will do. Raises `QuantityError` if a name is unknown or the
        machine impossible.
        """
        own = {str(Name(heading, 0, q)): q for q, heading in OWN.items()}
        switches = {n for n, known in self.parameters().items() if known.quantity.is_switch}
        left = {n: bool(v) if n in switches and v in (0, 1) else v for n, v in values.items()}
        changed: dict[str, Any] = {q: left.pop(n) for n, q in own.items() if n in left}
        parts, known = [], [*own]
        for (kind, index), part in self.indexed_parts():
            names = {str(Name(kind, index, q)): q for q in quantities(part)}
            known += names
            new: dict[str, Any] = {q: left.pop(n) for n, q in names.items() if n in left}
            parts.append(replace(part, **new) if new else part)
        for name in left:
            raise QuantityError(f"{name}: unknown quantity; {meant(name, known)}")
        return replace(self, parts=tuple(parts), **changed)

    def with_value(self, name: str, value: float | bool) -> "Rotor":
        """Return the machine with one number replaced; see `with_values`."""
        return self.with_values({name: value})
