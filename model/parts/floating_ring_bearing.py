"""A bearing with a floating ring: two oil films in series, and the ring between them.

The ring's position, velocity and speed of rotation are states of the law. Over a step they follow
the journal by one system of equations in the ring's velocity and speed, solved by Newton's method
(`floating_ring_states`). In an equilibrium the ring is at rest; in a vibration it follows at the
frequency. Its weight, mass times the machine's gravity, is in the law's table (`Law.weigh`), its
potential energy is in the ledger with its kinetic energy.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from ..film.floating_ring import ring_response, stiffness, torque_of
from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import SPEED, Output, QuantityError, check_all, places, quantity, switch
from .base import FORCE_OUTPUTS, GROUND, Element, InterfaceElement, Part, Shape
from .film_law import LOSSES as FILM_LOSSES
from .film_law import POINTS, Rough, check_film, film_length, film_table, whole_circle
from .floating_ring_states import (
    STATE,
    WEIGHT,
    linearize_ring,
    ring_at_rest,
    ring_of_states,
    ring_over_step,
    ring_rates,
    store_ring,
)
from .law import Law

_SLOW = 1e-4  # of the speed: the least frequency of a vibration


@dataclass(frozen=True, kw_only=True)
class RingQuantities(Rough):
    """The quantities of a floating ring: radius [m], length [m], radial clearance [m] and viscosity
    [Pa.s] of the inner film, `outer_` those of the outer one; mass [kg] and polar moment of inertia
    [kg.m2] of the ring; roughness of all surfaces [m]."""

    journal_radius: float = quantity("m", "radius of the journal")
    length: float = quantity("m", "length of the inner film along the shaft")
    clearance: float = quantity("m", "radial clearance of the inner film", is_parameter=True)
    viscosity: float = quantity(
        "Pa.s", "dynamic viscosity of the lubricant in the inner film", is_tunable=True
    )
    outer_radius: float = quantity("m", "outer radius of the ring")
    outer_length: float = quantity("m", "length of the outer film along the shaft")
    outer_clearance: float = quantity("m", "radial clearance of the outer film", is_parameter=True)
    outer_viscosity: float = quantity(
        "Pa.s", "dynamic viscosity of the lubricant in the outer film", is_tunable=True
    )
    ring_mass: float = quantity("kg", "mass of the ring")
    ring_inertia: float = quantity("kg.m2", "polar moment of inertia of the ring")
    roughness: float = quantity(
        "m", "film thickness at which surfaces touch: their roughness", default=2e-7
    )
    short: bool = switch("Ocvirk's films in the place of those of finite length", False)
    points: float = quantity("1", "elements of each film", POINTS, 48.0)


OUTPUTS = (
    *FORCE_OUTPUTS,
    Output("ring_x", "m", "displacement of the ring to the right", True, 1e-5),
    Output("ring_y", "m", "displacement of the ring upwards", True, 1e-5),
    Output("ring_speed", "rad/s", "speed at which the ring turns", True, 1000.0),
    Output(
        *("ratio", "1", "speed of the ring over that of the rotor; 0 at standstill", True, 1.0),
        reached_by=SPEED,
    ),
    Output("eccentricity", "1", "of the journal in the ring, over the clearance", True, 1.0),
    Output("outer_eccentricity", "1", "of the ring, over the outer clearance", True, 1.0),
    Output(
        *("torque", "N.m", "torque of the inner film opposing positive rotation"),
        nominal=0.01,
        reached_by=SPEED,
    ),
    Output("power", "W", "dissipated in the inner film", nominal=10.0, reached_by=SPEED),
    Output("outer_power", "W", "dissipated in the outer film", nominal=10.0),
)
STORES = (
    Output(
        "rings",
        "J",
        "energy of floating rings: kinetic, and potential of gravity from the middle on",
        nominal=1e-3,
    ),
)
LOSSES = FILM_LOSSES[:1]
_OUT, _LOSS = places(OUTPUTS), places(LOSSES)


@jit_not_inlined
def _force(part, tables, kinematics, internal_state):
    return ring_of_states(part, tables, kinematics, internal_state, False).inner.force


@jit_not_inlined
def _tangent(part, tables, kinematics, weights, free, internal_state):
    b = weights.rate
    by_d, by_v = complex(weights.displacement, 0.0), complex(weights.velocity, 0.0)
    if b == 0.0 and kinematics.sliding_speed == 0.0:
        at = ring_at_rest(part, tables, kinematics, internal_state)
        none = 0.0j
        seen = ring_response(
            *(at.inner, at.outer, by_d, by_v, 1.0 + 0.0j, none, none, none, none, 0.0)
        ).matrix
        return at.inner.force, seen.aa, seen.ab
    if b == 0.0:
        at = ring_of_states(part, tables, kinematics, free, True)
        store_ring(internal_state, at.outer.z, at.velocity, at.speed)
        seen = stiffness(at.inner, by_d, by_v)
        return at.inner.force, seen.aa, seen.ab
    return ring_over_step(part, tables, kinematics, weights, free, internal_state)


@jit_not_inlined
def _rates(part, tables, kinematics, internal_state, out):
    ring_rates(part, ring_of_states(part, tables, kinematics, internal_state, False), out)


@jit
def _energy(part, tables, displacement, internal_state):
    vx, vy, w = internal_state[STATE.vx], internal_state[STATE.vy], internal_state[STATE.speed]
    fallen = tables[part.table] * internal_state[STATE.x]
    fallen += tables[part.table + 1] * internal_state[STATE.y]
    kinetic = 0.5 * part.ring_mass * (vx * vx + vy * vy) + 0.5 * part.ring_inertia * w * w
    return (kinetic - part.ring_mass * fallen,)


@jit
def _powers(at, omega):
    """Return the powers dissipated in the inner and the outer film [W], and the torque that brakes
    the rotor [N.m]."""
    torque = torque_of(at.inner, -1.0)
    inner = torque * omega - torque_of(at.inner, 1.0) * at.speed
    inner -= (at.inner.force * at.relative_velocity.conjugate()).real
    outer = torque_of(at.outer, -1.0) * at.speed
    outer -= (at.outer.force * at.velocity.conjugate()).real
    return inner, outer, torque


@jit_not_inlined
def _dissipate(part, tables, kinematics, internal_state, out):
    at = ring_of_states(part, tables, kinematics, internal_state, False)
    inner, outer, torque = _powers(at, kinematics.speed)
    out[_LOSS.film] = inner + outer
    return torque


@jit_not_inlined
def _observe(part, tables, kinematics, internal_state, out):
    at = ring_of_states(part, tables, kinematics, internal_state, False)
    inner, outer, torque = _powers(at, kinematics.speed)
    out[_OUT.fx] = at.inner.force.real
    out[_OUT.fy] = at.inner.force.imag
    out[_OUT.ring_x] = internal_state[STATE.x]
    out[_OUT.ring_y] = internal_state[STATE.y]
    out[_OUT.ring_speed] = at.speed
    out[_OUT.ratio] = at.speed / kinematics.speed if kinematics.speed != 0.0 else 0.0
    out[_OUT.eccentricity] = modulus(at.inner.z) / part.clearance
    out[_OUT.outer_eccentricity] = modulus(at.outer.z) / part.outer_clearance
    out[_OUT.torque] = torque
    out[_OUT.power] = inner
    out[_OUT.outer_power] = outer


@jit_not_inlined
def _vibrate(part, tables, kinematics, frequency, free, internal_state):
    for i in range(len(STATE)):
        internal_state[i] = free[i]
    at = ring_at_rest(part, tables, kinematics, internal_state)
    w = max(frequency, _SLOW * abs(kinematics.speed), 1e-6)
    by_v = complex(0.0, w)
    seen = ring_response(
        *(at.inner, at.outer, 1.0 + 0.0j, by_v, 1.0 + 0.0j, by_v),
        *(complex(-w * w * part.ring_mass, 0.0), by_v * part.ring_inertia, 0.0j, 0.0),
    ).matrix
    # aa = p_d + i w p_v, bb = conj(p_d) + i w conj(p_v), and so ab and ba of q
    half = complex(0.0, -0.5 / w)
    return (
        at.inner.force,
        0.5 * (seen.aa + seen.bb.conjugate()),
        0.5 * (seen.ab + seen.ba.conjugate()),
        half * (seen.aa - seen.bb.conjugate()),
        half * (seen.ab - seen.ba.conjugate()),
    )


@jit
def _weigh(part, tables, gravity):
    tables[part.table] = gravity.real
    tables[part.table + 1] = gravity.imag


@jit
def _breaks(part, tables, displacement, internal_state):
    x = complex(internal_state[STATE.x], internal_state[STATE.y])
    inner = part.clearance - modulus(displacement - x)
    return min(inner, part.outer_clearance - modulus(x)) < part.roughness


FLOATING_RING_BEARING = Law(
    name="floating_ring_bearing",
    kind=RingQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    length=film_length,
    rates=_rates,
    breaks=_breaks,
    vibrate=_vibrate,
    linearize=linearize_ring,
    weigh=_weigh,
    whirls=True,
    outputs=OUTPUTS,
    stores=STORES,
    losses=LOSSES,
    states=tuple(0.0 for _ in STATE),
    state_units=lambda part: ("m", "m", "m/s", "m/s", "rad/s"),
    table=lambda part: np.concatenate(
        [np.zeros(len(WEIGHT)), *2 * [film_table([whole_circle()], part.points)]]
    ),
)


@dataclass(frozen=True, kw_only=True)
class FloatingRingBearing(RingQuantities, Part):
    """A bearing with a floating ring between a node (from 1) and ground, in equilibrium in its
    films at the start."""

    KIND: ClassVar[str] = "floating_ring_bearing"
    TEXT: ClassVar[str] = "a journal in an oil film, in a ring that floats and turns in another one"
    LAWS: ClassVar[tuple[Law, ...]] = (FLOATING_RING_BEARING,)

    node: int

    def check(self, where: str) -> None:
        """Raise `QuantityError` for impossible quantities, films or rings."""
        check_all(where, self)
        check_film(where, self)
        check_film(where, self, "outer_", "outer_radius")
        bore = self.journal_radius + self.clearance
        if self.outer_radius <= bore:
            raise QuantityError(
                f"{where}.outer_radius = {self.outer_radius:g} m: must be above {bore:g} m, the "
                "inner radius of the ring"
            )
        largest = self.ring_mass * self.outer_radius * self.outer_radius
        if self.ring_inertia > largest:
            raise QuantityError(
                f"{where}.ring_inertia = {self.ring_inertia:g} kg.m2: must be at most {largest:g} "
                "kg.m2, that of its mass at its outer radius"
            )

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one interface."""
        yield InterfaceElement(self.node, FLOATING_RING_BEARING, self, GROUND)

    def outline(self) -> Iterator[Shape]:
        """Yield the ring about the journal, and a bush about it."""
        bore, outer = self.journal_radius, self.outer_radius
        yield Shape(-0.5 * self.length, self.length, bore, outer, "body")
        yield Shape(-0.5 * self.outer_length, self.outer_length, outer, outer, "stator")
