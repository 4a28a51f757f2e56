"""Where the parameters of a machine stand in its `Structure`.

What a part makes of a quantity only the part knows. So each quantity is changed a little: where the
part's elements then show the new value, there it stands.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from ..machine.rotor import OWN, Name, Rotor
from ..parts import LAWS
from ..parts.base import Element, Interface, Mount, Part, Release, Unbalance
from ..parts.housing import HousingQuantities
from ..quantities import QuantityError, quantities

_CHANGE = 2.0**-10


class ParameterLocation(NamedTuple):
    """A number of a `Structure`: the member, as the block of a run spells it (`laws[0]` the records
    of the first law), the record's place in it, and the field."""

    member: str
    row: int
    field: str


def parameter_locations(rotor: Rotor) -> dict[Name, tuple[ParameterLocation, ...]]:
    """The places of every parameter, in the order of `Rotor.parameters`.

    Raises `QuantityError` for one that changes a matrix, which is made at assembly.
    """
    density = rotor.material.density
    rows: dict[str, int] = {}
    result: dict[Name, tuple[ParameterLocation, ...]] = {}
    for key, part in rotor.indexed_parts():
        begin = dict(rows)
        for element in part.elements(str(key), density):
            member = _member(element)
            rows[member] = rows.get(member, 0) + 1
        for name, quantity in quantities(part).items():
            if quantity.is_parameter and not isinstance(getattr(part, name), tuple):
                result[Name(*key, name)] = tuple(_of_part(str(key), part, name, density, begin))
    for name, heading in OWN.items():
        if quantities(rotor)[name].is_parameter:
            result[Name(heading, 0, name)] = (ParameterLocation("numbers", 0, name),)
    return result


def _of_part(
    where: str, part: Part, name: str, density: float, begin: Mapping[str, int]
) -> Iterator[ParameterLocation]:
    """Where a quantity of one part stands; begin: how many records the parts before it have."""
    value = getattr(part, name)
    probe: Any = value * (1.0 + _CHANGE) if value else _CHANGE
    changed = replace(part, **{name: probe})
    rows = dict(begin)
    pairs = zip(part.elements(where, density), changed.elements(where, density), strict=True)
    for old, new in pairs:
        member = _member(old)
        row = rows.get(member, 0)
        rows[member] = row + 1
        before, after = _numbers(old), _numbers(new)
        for field in before:
            if before[field] == after[field]:
                continue
            if not member or after[field] != probe:
                raise QuantityError(
                    f"{where}.{name}: is no parameter of an assembled machine, since {field} is "
                    "made of it"
                )
            yield ParameterLocation(member, row, field)


def _member(element: Element) -> str:
    """Where an element's record stands, or "" of what assembly makes matrices of."""
    if isinstance(element, Interface):
        return f"laws[{LAWS.index(element.law)}]"
    if isinstance(element, Mount):
        return "housings"
    if isinstance(element, Release):
        return "releases"
    return "unbalances" if isinstance(element, Unbalance) else ""


def _numbers(element: Element) -> dict[str, Any]:
    """The numbers of an element, by the fields of its record."""
    if isinstance(element, (Interface, Mount)):
        kind = element.law.kind if isinstance(element, Interface) else HousingQuantities
        return {name: getattr(element.source, name) for name in quantities(kind)}
    return element._asdict()
