"""A squeeze film damper: a ring that does not rotate, in an oil film that its motion squeezes.

The film is that of a journal bearing without rotation (`film.zone_pressure`), open at both sides. A
sealed film cannot draw in lubricant, so that Reynolds' rupture would leave it full: its pressures
below ambient are neglected (the pi film, or half-Sommerfeld condition).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..film.bearing_film import NEVER, bearing_of, film_force, film_tangent
from ..film.film_outputs import film_state
from ..film.rough_contact import wall_energy, wall_state, wall_tangent
from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import NOT_NEGATIVE, Output, QuantityError, check_all, places, quantity, switch
from .base import GROUND, Element, InterfaceElement, Part, Shape
from .clearance_contact import STORES as CONTACT_STORES
from .film_law import (
    LOSSES,
    PLACE_OUTPUTS,
    FilmQuantities,
    check_film,
    film_breaks,
    film_length,
    film_table,
    whole_circle,
)
from .law import Kinematics, Law


@dataclass(frozen=True, kw_only=True)
class DamperQuantities(FilmQuantities):
    """The quantities of a film, and the stiffness of the centring spring [N/m]."""

    stiffness: float = quantity(
        "N/m", "stiffness of the centring spring", NOT_NEGATIVE, 0.0, is_parameter=True
    )


OUTPUTS = (
    Output("fx", "N", "force on the ring, to the right", True, 10.0),
    Output("fy", "N", "force on the ring, upwards", True, 10.0),
    *PLACE_OUTPUTS,
    Output("eccentricity", "1", "of the ring, over the clearance", True, 1.0),
    Output("film", "m", "thinnest film; below the roughness the surfaces touch", True, 1e-5),
    Output("pressure", "Pa", "largest pressure in the film", nominal=1e6),
    Output("power", "W", "dissipated in the film", nominal=10.0),
    Output("fn", "N", "normal force of ring and wall that touch", nominal=10.0),
    Output("contact", "1", "whether ring and wall touch", kind="Boolean"),
)
STORES = (
    *CONTACT_STORES,
    Output("centring", "J", "elastic energy of centring springs", nominal=0.01),
)
_OUT, _LOSS = places(OUTPUTS), places(LOSSES)


@jit
def _resting(kinematics):
    """Return the kinematics of a ring that does not turn with the rotor."""
    return Kinematics(kinematics.displacement, kinematics.velocity, 0.0, 0.0, 0.0)


@jit_not_inlined
def _force(part, tables, kinematics, internal_state):
    bearing, moving = bearing_of(part), _resting(kinematics)
    force = film_force(bearing, tables, moving) + wall_state(bearing, tables, moving).force
    return force - part.stiffness * moving.displacement


@jit_not_inlined
def _tangent(part, tables, kinematics, weights, free, internal_state):
    bearing, moving = bearing_of(part), _resting(kinematics)
    force, p, q = film_tangent(bearing, tables, moving, weights)
    by_wall, p_wall, q_wall = wall_tangent(bearing, tables, moving, weights)
    spring = part.stiffness * moving.displacement
    p_all = p + p_wall - weights.displacement * part.stiffness
    return force + by_wall - spring, p_all, q + q_wall


@jit_not_inlined
def _energy(part, tables, displacement, internal_state):
    square = displacement.real * displacement.real + displacement.imag * displacement.imag
    moving = Kinematics(displacement, 0.0j, 0.0, 0.0, 0.0)
    return wall_energy(bearing_of(part), tables, moving), 0.5 * part.stiffness * square


@jit_not_inlined
def _dissipate(part, tables, kinematics, internal_state, out):
    bearing, moving = bearing_of(part), _resting(kinematics)
    film = film_force(bearing, tables, moving)
    wall = wall_state(bearing, tables, moving)
    out[_LOSS.film] = -(film * moving.velocity.conjugate()).real
    out[_LOSS.contact] = wall.damped
    out[_LOSS.friction] = wall.rubbed
    return 0.0


@jit_not_inlined
def _observe(part, tables, kinematics, internal_state, out):
    bearing, moving = bearing_of(part), _resting(kinematics)
    film = film_state(bearing, tables, moving, True)
    wall = wall_state(bearing, tables, moving)
    force = film.force + wall.force - part.stiffness * moving.displacement
    out[_OUT.fx] = force.real
    out[_OUT.fy] = force.imag
    out[_OUT.x] = moving.displacement.real
    out[_OUT.y] = moving.displacement.imag
    out[_OUT.eccentricity] = modulus(moving.displacement) / part.clearance
    out[_OUT.film] = film.thinnest
    out[_OUT.pressure] = film.largest
    out[_OUT.power] = -(film.force * moving.velocity.conjugate()).real
    out[_OUT.fn] = wall.normal
    out[_OUT.contact] = 1.0 if wall.normal > 0.0 else 0.0


SQUEEZE_FILM_DAMPER = Law(
    name="squeeze_film_damper",
    kind=DamperQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    length=film_length,
    breaks=film_breaks,
    outputs=OUTPUTS,
    stores=STORES,
    losses=LOSSES,
    table=lambda part: film_table([part.circle()], part.points),
    stiffness=lambda part: part.stiffness,
)


@dataclass(frozen=True, kw_only=True)
class SqueezeFilmDamper(DamperQuantities, Part):
    """A squeeze film damper between a node (from 1), whose ring does not rotate, and the housing of
    that name or ground; or between another housing there, `ring`, such as the outer ring of the
    node's rolling bearing, and these."""

    KIND: ClassVar[str] = "squeeze_film_damper"
    TEXT: ClassVar[str] = "a ring that does not turn in an oil film, with a centring spring or none"
    LAWS: ClassVar[tuple[Law, ...]] = (SQUEEZE_FILM_DAMPER,)

    node: int
    housing: str = GROUND
    ring: str = GROUND
    full: bool = switch("whether the film never ruptures", False)
    sealed: bool = switch("whether nothing leaves at the film's sides: a long film", False)

    def check(self, where: str) -> None:
        """Raise `QuantityError` for impossible quantities or incompatible options of the film."""
        check_all(where, self)
        check_film(where, self)
        if self.sealed and self.short:
            raise QuantityError(f"{where}.sealed = true: needs {where}.short = false")
        if self.ring != GROUND and self.ring == self.housing:
            raise QuantityError(f"{where}.ring = {self.ring!r}: must differ from {where}.housing")

    def circle(self) -> list[float]:
        """Return the row of `film.bearing_film.PAD` of the film."""
        return whole_circle(NEVER if self.full else self.sealed, self.sealed)

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one interface."""
        yield InterfaceElement(self.node, SQUEEZE_FILM_DAMPER, self, self.housing, self.ring)

    def outline(self) -> Iterator[Shape]:
        """Yield a bush about the ring, on springs if it is a housing."""
        role = "stator" if self.housing == GROUND else "housing"
        yield Shape(-0.5 * self.length, self.length, self.journal_radius, self.journal_radius, role)
