"""Where the parameters of a machine are stored in its `Structure`.

Each part maps its quantities to its elements; to find where a parameter is stored, it is perturbed,
and the field with the changed value is looked up.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from ..machine.names import Name
from ..machine.rotor import OWN, Rotor
from ..parts import LAWS
from ..parts.base import (
    BowElement,
    Element,
    ForceElement,
    InterfaceElement,
    MountElement,
    Part,
    ReleaseElement,
    UnbalanceElement,
)
from ..parts.housing import HousingQuantities
from ..quantities import QuantityError, quantities

_CHANGE = 2.0**-10


class ParameterLocation(NamedTuple):
    """A number of a `Structure`: the member, as named in the block of a run (`laws[0]`: the records
    of the first law), the record's index in it, and the field."""

    member: str
    row: int
    field: str


def parameter_locations(rotor: Rotor) -> dict[Name, tuple[ParameterLocation, ...]]:
    """Return the locations of every parameter, in the order of `Rotor.parameters`.

    Raises `QuantityError` for a parameter that changes a matrix, which is fixed at assembly.
    """
    density = rotor.material.density
    rows: dict[str, int] = {}
    result: dict[Name, tuple[ParameterLocation, ...]] = {}
    for key, part in rotor.indexed_parts():
        rows_before = dict(rows)
        for element in part.elements(str(key), density):
            member = _member(element)
            rows[member] = rows.get(member, 0) + 1
        for name, quantity in quantities(part).items():
            if quantity.is_parameter and not isinstance(getattr(part, name), tuple):
                result[Name(*key, name)] = tuple(
                    _locations_in_part(str(key), part, name, density, rows_before)
                )
    for name, heading in OWN.items():
        if quantities(rotor)[name].is_parameter:
            result[Name(heading, 0, name)] = (ParameterLocation("numbers", 0, name),)
    return result


def _locations_in_part(
    where: str, part: Part, name: str, density: float, rows_before: Mapping[str, int]
) -> Iterator[ParameterLocation]:
    """Yield the locations of a quantity of one part; rows_before: the number of records of the
    parts before it."""
    value = getattr(part, name)
    changed_value: Any = value * (1.0 + _CHANGE) if value else _CHANGE
    changed = replace(part, **{name: changed_value})
    rows = dict(rows_before)
    pairs = zip(part.elements(where, density), changed.elements(where, density), strict=True)
    for old, new in pairs:
        member = _member(old)
        row = rows.get(member, 0)
        rows[member] = row + 1
        before, after = _numbers(old), _numbers(new)
        for field in before:
            if before[field] == after[field]:
                continue
            if not member or after[field] != changed_value:
                raise QuantityError(
                    f"{where}.{name}: cannot be changed after assembly, because {field} is "
                    "derived from it"
                )
            yield ParameterLocation(member, row, field)


def _member(element: Element) -> str:
    """Return the member that holds an element's record, or "" if assembly puts it into matrices."""
    if isinstance(element, InterfaceElement):
        return f"laws[{LAWS.index(element.law)}]"
    if isinstance(element, MountElement):
        return "housings"
    if isinstance(element, ReleaseElement):
        return "releases"
    if isinstance(element, ForceElement):
        return "forces"
    if isinstance(element, BowElement):
        return "bows"
    return "unbalances" if isinstance(element, UnbalanceElement) else ""


def _numbers(element: Element) -> dict[str, Any]:
    """Return the numbers of an element, by the fields of its record."""
    if isinstance(element, (InterfaceElement, MountElement)):
        kind = element.law.kind if isinstance(element, InterfaceElement) else HousingQuantities
        return {name: getattr(element.source, name) for name in quantities(kind)}
    return element._asdict()
