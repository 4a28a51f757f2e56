"""Values that are probably meant in another unit: warned about, not refused."""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

from ..model.machine.rotor import Rotor
from ..model.machine.speed_ranges import RIM
from ..model.parts.base import GROUND, BodyElement
from ..model.parts.film_law import POINTS
from ..model.parts.linear_bearing import LinearBearing
from ..model.parts.squeeze_film_damper import SqueezeFilmDamper
from ..model.parts.support import Support
from ..model.quantities import quantities


class Usual(NamedTuple):
    """The range in which a number usually lies, and units that are mistaken for its own: their
    names with what one is in it."""

    low: float
    high: float
    mistaken: tuple[tuple[str, float], ...]


_LENGTHS = (("mm", 1e-3), ("um", 1e-6))
_VISCOSITIES = (("mPa.s", 1e-3),)
_DEGREES = (("deg", math.pi / 180),)
_MATERIAL = {
    "young": Usual(1e8, 2e12, (("GPa", 1e9), ("MPa", 1e6), ("psi", 6894.757))),
    "density": Usual(500.0, 25e3, (("g/cm3", 1e3), ("lb/in3", 27679.9))),
}
_OF_PARTS = {
    "diameter": Usual(1e-4, 20.0, _LENGTHS),
    "width": Usual(1e-4, 20.0, _LENGTHS),
    "journal_radius": Usual(1e-4, 5.0, _LENGTHS),
    "pitch_diameter": Usual(1e-3, 20.0, _LENGTHS),
    "element_diameter": Usual(1e-4, 1.0, _LENGTHS),
    "clearance": Usual(1e-8, 0.05, _LENGTHS),
    "e": Usual(0.0, 0.02, _LENGTHS),
    "amplitude": Usual(0.0, 0.02, _LENGTHS),
    "mass": Usual(0.0, 1e6, (("g", 1e-3),)),
    "added_mass": Usual(0.0, 1e4, (("g", 1e-3),)),
    "amount": Usual(0.0, 10.0, (("g.mm", 1e-6), ("g.m", 1e-3))),
    "phase": Usual(-2 * math.pi, 2 * math.pi, _DEGREES),
    "wear_angle": Usual(-2 * math.pi, 2 * math.pi, _DEGREES),
    "mu": Usual(0.0, 2.0, (("percent", 0.01),)),
    "viscosity": Usual(1e-6, 2.0, _VISCOSITIES),
    "outer_viscosity": Usual(1e-6, 2.0, _VISCOSITIES),
}
_OF_THE_MACHINE = {
    "inclination": Usual(-math.pi, math.pi, _DEGREES),
    "gravity_angle": Usual(-2 * math.pi, 2 * math.pi, _DEGREES),
}
_SOFT = (1e8, 5e10)  # of no metal [Pa]: a model's shaft, which may be as light as it likes
_SHAFT = Usual(1e-3, 100.0, _LENGTHS)
_HEAVY = 5e5  # kg of a disc: heavier than any that runs
_THINNEST = 2.02  # I_p over I_d: that of a disc without width, to two digits
_RPM = math.pi / 30
_ACROSS = 3.0  # elements of a film that are as wide as it is under a ring that lies on its wall


def implausible_values(rotor: Rotor) -> list[str]:
    """Return a sentence for each value of a machine that is probably meant in another unit, or that
    does not fit the machine's other values."""
    return [*_ranges(rotor), *_relations(rotor)]


def implausible_number(shown: str, name: str, value: float, unit: str) -> list[str]:
    """Return the sentence about a number, in an SI unit, that stands for a part's quantity of this
    name, if it is probably meant in another unit; shown: what the number is called."""
    return [*_warning(shown, value, unit, _OF_PARTS[name])]


def _ranges(rotor: Rotor) -> Iterator[str]:
    of_model = _SOFT[0] <= rotor.material.young < _SOFT[1]
    known = {n: usual for n, usual in _MATERIAL.items() if not (of_model and n == "density")}
    yield from _implausible("material", rotor.material, known)
    yield from _implausible("", rotor, _OF_THE_MACHINE)
    yield from _warning("shaft: its length", rotor.length, "m", _SHAFT)
    for i, section in enumerate(rotor.sections, 1):
        for side in ("outer_left", "outer_right"):
            where = f"shaft.element[{i}].{side}"
            warnings = [*_warning(where, getattr(section, side), "m", _OF_PARTS["diameter"])]
            yield from warnings
            if warnings:
                return  # the others are as large
    for where, part in rotor.named_parts():
        yield from _implausible(where, part, _OF_PARTS)


def _implausible(where: str, item: Any, usual: dict[str, Usual]) -> Iterator[str]:
    for name, declared in quantities(item).items():
        value = getattr(item, name)
        if isinstance(value, tuple) and name in usual:  # over the speed, say
            value = max(value, key=abs)
        if name in usual and isinstance(value, (int, float)):
            shown = f"{where}.{name}" if where else name
            usually = usual[name]
            if declared.rule.least < 0.0 <= usually.low:  # of either sign
                usually = usually._replace(low=-usually.high)
            yield from _warning(shown, value, declared.unit, usually)


def _warning(shown: str, value: float, unit: str, usual: Usual) -> Iterator[str]:
    """Yield the warning about a value that is unusual."""
    if not usual.low <= value <= usual.high:
        with_unit = f"{value:g}" if unit == "1" else f"{value:g} {unit}"
        likely = [name for name, one in usual.mistaken if usual.low <= value * one <= usual.high]
        meant = f"; {value:g} {likely[0]}?" if likely else "?"
        yield f"{shown} = {with_unit}: is that what is meant{meant}"


def _relations(rotor: Rotor) -> Iterator[str]:
    density = rotor.material.density
    for where, part in rotor.named_parts():
        radius, clearance = (getattr(part, n, None) for n in ("journal_radius", "clearance"))
        is_usual = clearance is not None and clearance <= _OF_PARTS["clearance"].high
        if radius and clearance and is_usual and clearance > radius:
            yield (
                f"{where}.clearance = {clearance:g} m: is larger than the journal, whose radius is "
                f"{radius:g} m{_smaller(clearance, radius)}"
            )
        for element in part.elements(where, density):
            is_stated = getattr(part, "mass", None) == getattr(element, "mass", 0.0)
            if not isinstance(element, BodyElement):
                continue
            if element.mass > _HEAVY and not is_stated:
                yield f"{where}: has a mass of {element.mass / 1e3:.4g} t; are its lengths in m?"
            if element.polar > _THINNEST * element.diametral:
                yield (
                    f"{where}.I_p = {element.polar:g} kg.m2: no body has more than twice its I_d, "
                    f"which is {element.diametral:g} kg.m2; are they exchanged?"
                )
        if isinstance(part, SqueezeFilmDamper):
            yield from _points(where, part, rotor)
    yield from _speed(rotor)


def _points(where: str, damper: SqueezeFilmDamper, rotor: Rotor) -> Iterator[str]:
    """Yield the warning about a film that is narrower than its elements where the ring lies: as
    thin as its roughness over an angle of sqrt(2 roughness / clearance) [rad]."""
    held = {each.node for each in rotor.of_kind(Support)}
    held |= {each.node for each in rotor.of_kind(LinearBearing)}
    is_held = damper.stiffness > 0.0 or damper.ring != GROUND or damper.node in held
    if is_held or damper.k == 0.0 or damper.short or damper.full or damper.sealed:
        return
    width = math.sqrt(2.0 * damper.roughness / damper.clearance)
    needed = min(math.ceil(_ACROSS * math.pi / width), int(POINTS.most))
    if damper.points < needed:
        yield (
            f"{where}.points = {damper.points:g}: no spring holds the ring, and where it lies on "
            f"its wall the film is narrower than an element, so that steps are very short; take "
            f"{needed}"
        )


def _smaller(value: float, largest: float) -> str:
    likely = [name for name, one in _LENGTHS if value * one < 0.1 * largest]
    return f"; {value:g} {likely[0]}?" if likely else ""


def _speed(rotor: Rotor) -> Iterator[str]:
    """Yield the warning about a speed at which the largest disc would burst."""
    radii = [disc.diameter / 2 for disc in rotor.discs]
    radius = max(radii, default=0.0)
    if not rotor.operation.speeds or radius > _OF_PARTS["diameter"].high / 2:
        return
    name, speed = list(rotor.operation.speeds.items())[-1]  # the highest
    if speed * radius > RIM:
        meant = f"; {speed:g} rpm?" if speed * _RPM * radius < RIM else ""
        yield (
            f"operation.{name} = {speed:g} rad/s: moves the rim of the largest disc at "
            f"{speed * radius:.4g} m/s{meant}"
        )
