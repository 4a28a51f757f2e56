"""A rolling bearing: balls or rollers between two races, one by one, each a Hertz contact.

Element i of Z is at the angle a = phi + 2 pi i / Z, compressed by

    delta = Re(exp(-i a) d) - clearance - (depth of the defects under it)

and carries n = max(0, k delta^exponent + c min(1, delta / delta_c) delta') along exp(i a), k of its
contacts with both races in series. The cage turns at a ratio of the rotor's speed, without slip

    ratio = (1 - element_diameter / pitch_diameter cos(contact_angle)) / 2

(Harris and Kotzalas 2006), and the inner race with the rotor: phi and the race's angle are the
law's states. An element that rolls on under load is compressed further, or released; the torque for
this brakes the rotor, so that only the contacts' damping dissipates.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from ..contact.wall import contact_quantity, elastic, pressed
from ..kernels.functions import direction
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import (
    ANGLE,
    ANY,
    NOT_NEGATIVE,
    SPEED,
    Output,
    QuantityError,
    Rule,
    check_all,
    places,
    quantity,
)
from .base import FORCE_OUTPUTS, GROUND, Element, InterfaceElement, Part, Shape
from .clearance_contact import LOSSES as CONTACT_LOSSES
from .clearance_contact import STORES
from .law import Law

_COUNT = Rule(3.0, False, "must be from 3 to 200", most=200.0)
_ARC = Rule(0.0, True, "must be > 0 and at most 2 pi", most=2.0 * math.pi)
_CONTACT_ANGLE = Rule(0.0, False, "must be from 0 to 1.5", most=1.5)
_RATIO = Rule(0.0, False, "must be from 0 to 1", most=1.0)
_PRESSED = 1e-3  # of its diameter: about how far a loaded element is pressed in


@dataclass(frozen=True, kw_only=True)
class RollingQuantities:
    """The quantities of a rolling bearing: count of its elements; pitch_diameter of their centres
    and element_diameter [m]; contact_angle [rad]; k of an element between both races
    [N/m^exponent] and the rest of a contact (`ContactQuantities`); radial clearance [m], negative
    of a preload; speed of the cage over the rotor's, 0: without slip; angle of the first element at
    the start [rad]; depth [m], arc and angle [rad] of a defect of the outer race, and of the inner
    race, which turns with the rotor."""

    count: float = quantity("1", "balls or rollers", _COUNT)
    pitch_diameter: float = quantity("m", "diameter of the circle of the elements' centres")
    element_diameter: float = quantity("m", "diameter of a ball or roller")
    contact_angle: float = quantity(
        "rad", "contact angle, for the speed of the cage", _CONTACT_ANGLE, 0.0
    )
    k: float = contact_quantity("k")
    c: float = contact_quantity("c", 100.0)
    delta_c: float = contact_quantity("delta_c", 2e-7)
    exponent: float = contact_quantity("exponent", 1.5)
    clearance: float = quantity(
        "m", "radial clearance; negative: preload", ANY, 0.0, is_tunable=True
    )
    cage_ratio: float = quantity(
        "1", "speed of the cage over the rotor's; 0: without slip", _RATIO, 0.0
    )
    cage_angle: float = quantity("rad", "angle of the first element at the start", ANGLE, 0.0)
    outer_depth: float = quantity("m", "depth of a defect of the outer race", NOT_NEGATIVE, 0.0)
    outer_arc: float = quantity("rad", "arc of it", _ARC, 0.1)
    outer_angle: float = quantity("rad", "angle of its middle", ANGLE, 1.5 * math.pi)
    inner_depth: float = quantity("m", "depth of a defect of the inner race", NOT_NEGATIVE, 0.0)
    inner_arc: float = quantity("rad", "arc of it", _ARC, 0.1)
    inner_angle: float = quantity("rad", "angle of its middle at the start", ANGLE, 1.5 * math.pi)


OUTPUTS = (
    *FORCE_OUTPUTS,
    Output(
        *("largest", "N", "force of the element that carries most"), nominal=10.0, reached_by=SPEED
    ),
    Output("loaded", "1", "elements that carry", nominal=1.0),
    Output("cage", "rad/s", "speed of the cage", True, 100.0, reached_by=SPEED),
    Output("cage_angle", "rad", "angle of the first element", nominal=1.0),
    Output(
        *("torque", "N.m", "torque opposing positive rotation: elements pressed in as they roll"),
        nominal=0.1,
        reached_by=SPEED,
    ),
    Output("x", "m", "inner race relative to the outer one, to the right", nominal=1e-5),
    Output("y", "m", "inner race relative to the outer one, upwards", nominal=1e-5),
)
LOSSES = tuple(loss for loss in CONTACT_LOSSES if loss.name == "contact")
_OUT, _LOSS, _STATE = places(OUTPUTS), places(LOSSES), places(("cage", "race"))


class ElementPosition(NamedTuple):
    """Position of an element: its penetration [m], its derivative by the angle of the rotor [m],
    and the direction of the element [1]."""

    penetration: float
    by_turn: float
    along: complex


class ElementContact(NamedTuple):
    """The contact of an element: its `ElementPosition`, the rate of the penetration [m/s], the
    force along it, its elastic part [N] and its derivatives by penetration and rate [N/m],
    [N.s/m]."""

    position: ElementPosition
    rate: float
    normal: float
    elastic: float
    stiffness: float
    damping: float


@jit
def cage_ratio(part):
    """Return the speed of the cage over the rotor's [1]."""
    if part.cage_ratio > 0.0:
        return part.cage_ratio
    cosine = direction(part.contact_angle).real
    return 0.5 * (1.0 - part.element_diameter / part.pitch_diameter * cosine)


@jit
def _defect(depth, arc, angle):
    """Return the depth of a defect at an angle from its middle [m], and its derivative [m]: a
    raised cosine over its arc."""
    if depth == 0.0:
        return 0.0, 0.0
    x = angle - 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
    if abs(x) >= 0.5 * arc:
        return 0.0, 0.0
    per = 2.0 * math.pi / arc
    at = direction(per * x)
    return 0.5 * depth * (1.0 + at.real), -0.5 * depth * per * at.imag


@jit_not_inlined
def _position(part, ratio, displacement, internal_state, i):
    """Return the `ElementPosition` of an element; ratio: `cage_ratio`, the same for all."""
    pitch = 2.0 * math.pi / part.count
    at = internal_state[_STATE.cage] + part.cage_angle + i * pitch
    along = direction(at)
    turned = along.conjugate() * displacement
    outer, outer_slope = _defect(part.outer_depth, part.outer_arc, at - part.outer_angle)
    from_race = at - internal_state[_STATE.race] - part.inner_angle
    inner, inner_slope = _defect(part.inner_depth, part.inner_arc, from_race)
    delta = turned.real - part.clearance - outer - inner
    by_turn = ratio * (turned.imag - outer_slope) - (ratio - 1.0) * inner_slope
    return ElementPosition(delta, by_turn, along)


@jit_not_inlined
def _contact(part, ratio, kinematics, internal_state, i):
    """Return the `ElementContact` of an element; ratio: `cage_ratio`."""
    position = _position(part, ratio, kinematics.displacement, internal_state, i)
    if position.penetration <= 0.0:
        return ElementContact(position, 0.0, 0.0, 0.0, 0.0, 0.0)
    rate = (position.along.conjugate() * kinematics.velocity).real
    rate += position.by_turn * kinematics.sliding_speed
    n, n_k, stiffness, damping = pressed(part, position.penetration, rate)
    return ElementContact(position, rate, n, n_k, stiffness, damping)


@jit_not_inlined
def _force(part, tables, kinematics, internal_state):
    force, ratio = 0.0j, cage_ratio(part)
    for i in range(int(part.count)):
        at = _contact(part, ratio, kinematics, internal_state, i)
        force -= at.normal * at.position.along
    return force


@jit_not_inlined
def _tangent(part, tables, kinematics, weights, free, internal_state):
    force = p = q = 0.0j
    ratio = cage_ratio(part)
    speed = kinematics.sliding_speed
    internal_state[_STATE.cage] = free[_STATE.cage] + weights.rate * ratio * speed
    internal_state[_STATE.race] = free[_STATE.race] + weights.rate * speed
    for i in range(int(part.count)):
        at = _contact(part, ratio, kinematics, internal_state, i)
        if at.normal <= 0.0:
            continue
        force -= at.normal * at.position.along
        # dn = Re(conj(a) along* z), the part across of the cage's turning past the displacement
        a = complex(
            at.stiffness * weights.displacement + at.damping * weights.velocity,
            at.damping * weights.displacement * ratio * speed,
        )
        p -= 0.5 * a.conjugate()
        q -= 0.5 * a * at.position.along * at.position.along
    return force, p, q


@jit
def _rates(part, tables, kinematics, internal_state, out):
    out[_STATE.cage] = cage_ratio(part) * kinematics.sliding_speed
    out[_STATE.race] = kinematics.sliding_speed


@jit_not_inlined
def _energy(part, tables, displacement, internal_state):
    energy, ratio = 0.0, cage_ratio(part)
    for i in range(int(part.count)):
        delta = _position(part, ratio, displacement, internal_state, i).penetration
        if delta > 0.0:
            energy += elastic(part, delta)[0] * delta / (part.exponent + 1.0)
    return (energy,)


@jit_not_inlined
def _dissipate(part, tables, kinematics, internal_state, out):
    torque = damped = 0.0
    ratio = cage_ratio(part)
    for i in range(int(part.count)):
        at = _contact(part, ratio, kinematics, internal_state, i)
        damped += (at.normal - at.elastic) * at.rate
        torque += at.normal * at.position.by_turn
    out[_LOSS.contact] = damped
    return torque


@jit_not_inlined
def _observe(part, tables, kinematics, internal_state, out):
    force, ratio = 0.0j, cage_ratio(part)
    largest = torque = loaded = 0.0
    for i in range(int(part.count)):
        at = _contact(part, ratio, kinematics, internal_state, i)
        force -= at.normal * at.position.along
        largest = max(largest, at.normal)
        loaded += 1.0 if at.normal > 0.0 else 0.0
        torque += at.normal * at.position.by_turn
    out[_OUT.fx] = force.real
    out[_OUT.fy] = force.imag
    out[_OUT.largest] = largest
    out[_OUT.loaded] = loaded
    out[_OUT.cage] = ratio * kinematics.sliding_speed
    out[_OUT.cage_angle] = internal_state[_STATE.cage] + part.cage_angle
    out[_OUT.torque] = torque
    out[_OUT.x] = kinematics.displacement.real
    out[_OUT.y] = kinematics.displacement.imag


@jit
def _length(part):
    return _PRESSED * part.element_diameter


ROLLING_BEARING = Law(
    name="rolling_bearing",
    kind=RollingQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    length=_length,
    rates=_rates,
    outputs=OUTPUTS,
    stores=STORES,
    losses=LOSSES,
    states=tuple(0.0 for _ in _STATE),
    seat=lambda part: (
        part.clearance / math.cos(math.pi / part.count) + _PRESSED * part.element_diameter
        if part.clearance >= 0.0  # between two elements it falls furthest
        else 0.0
    ),
)


@dataclass(frozen=True, kw_only=True)
class RollingBearing(RollingQuantities, Part):
    """A rolling bearing between a node (from 1) and the housing of that name or ground."""

    KIND: ClassVar[str] = "rolling_bearing"
    TEXT: ClassVar[str] = "balls or rollers between two races, one by one, with defects or none"
    LAWS: ClassVar[tuple[Law, ...]] = (ROLLING_BEARING,)

    node: int
    housing: str = GROUND

    def check(self, where: str) -> None:
        """Raise `QuantityError` for impossible quantities, or elements without room."""
        check_all(where, self)
        if float(self.count) != int(self.count):
            raise QuantityError(f"{where}.count = {self.count:g}: must be a whole number")
        most = self.pitch_diameter * math.sin(math.pi / self.count)
        if self.element_diameter > most:
            raise QuantityError(
                f"{where}.element_diameter = {self.element_diameter:g} m: must be at most "
                f"{most:.6g} m, for {self.count:g} elements on {where}.pitch_diameter"
            )

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one interface."""
        yield InterfaceElement(self.node, ROLLING_BEARING, self, self.housing)

    def outline(self) -> Iterator[Shape]:
        """Yield a bush of the elements' width about the shaft, on springs if it is a housing."""
        role = "stator" if self.housing == GROUND else "housing"
        width, radius = self.element_diameter, 0.5 * (self.pitch_diameter - self.element_diameter)
        yield Shape(-0.5 * width, width, radius, radius, role)
