"""A journal bearing: a journal in an oil film between pads, which it may press through.

The film is solved at every instant: Reynolds' equation pad by pad, with the rupture where its
pressure and its gradient vanish (`contact.film_zone`), or Ocvirk's closed form. Nothing is stored
in it: what the rotor puts into it, the torque's power and that of the force, is dissipated.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from ..contact.film import (
    PAD,
    bearing_of,
    film_force,
    film_state,
    film_tangent,
)
from ..contact.film_wall import breaks, wall_energy, wall_state, wall_tangent
from ..contact.film_zone import VECTORS
from ..contact.wall import contact_quantity
from ..kernels.functions import angle, modulus
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import (
    ANY,
    NOT_NEGATIVE,
    SPEED,
    Output,
    QuantityError,
    Rule,
    check_all,
    places,
    quantity,
    switch,
)
from .base import GROUND, Element, Interface, Part, Shape
from .clearance_contact import LOSSES as CONTACT_LOSSES
from .clearance_contact import STORES
from .law import Kinematics, Law

_PRELOAD = Rule(0.0, False, "must be from 0 to 0.99", most=0.99)
_OFFSET = Rule(0.0, False, "must be from 0 to 1", most=1.0)
_POINTS = Rule(8.0, False, "must be from 8 to 1024", most=1024.0)
_ARC = Rule(0.0, True, "must be > 0 and at most 2 pi", most=2.0 * math.pi)
_LONGEST = 2.0  # length over diameter
_OVERLAP = 1e-9  # rad


@dataclass(frozen=True, kw_only=True)
class FilmQuantities:
    """The quantities of an oil film and of the contact behind it: radius of the journal, length and
    radial clearance [m], viscosity [Pa.s]; roughness, the film at which the surfaces touch [m];
    contact stiffness [N/m^exponent], 0: none, and the rest of `ContactQuantities`."""

    journal_radius: float = quantity("m", "radius of the journal")
    length: float = quantity("m", "length of the bearing along the shaft")
    clearance: float = quantity("m", "radial clearance of the bearing", is_parameter=True)
    viscosity: float = quantity("Pa.s", "dynamic viscosity of the lubricant", is_tunable=True)
    roughness: float = quantity(
        "m", "film thickness at which the surfaces touch: their roughness", default=1e-6
    )
    short: bool = switch("Ocvirk's film in the place of one of finite length", False)
    points: float = quantity("1", "elements of the film of a pad", _POINTS, 48.0)
    k: float = contact_quantity("k", 0.0, NOT_NEGATIVE)
    c: float = contact_quantity("c", 100.0)
    delta_c: float = contact_quantity("delta_c", 2e-7)
    exponent: float = contact_quantity("exponent", 1.0)
    mu: float = contact_quantity("mu", 0.1)
    v_s: float = contact_quantity("v_s", 1e-3)
    mu_rise: float = contact_quantity("mu_rise", 0.0)
    v_stribeck: float = contact_quantity("v_stribeck", 0.01)


OUTPUTS = (
    Output("fx", "N", "force on the rotor, to the right", True, 10.0, reached_by=SPEED),
    Output("fy", "N", "force on the rotor, upwards", True, 10.0, reached_by=SPEED),
    Output("eccentricity", "1", "of the journal, over the clearance", True, 1.0),
    Output(
        *("attitude", "rad", "angle from the direction of the film's load to the journal's"),
        nominal=1.0,
        reached_by=SPEED,
    ),
    Output("film", "m", "thinnest film; below the roughness the surfaces touch", True, 1e-5),
    Output("film_angle", "rad", "where the film is thinnest", nominal=1.0),
    Output("pressure", "Pa", "largest pressure in the film", nominal=1e6, reached_by=SPEED),
    Output(
        *("torque", "N.m", "torque of the film and of friction that brakes the rotor"),
        nominal=0.1,
        reached_by=SPEED,
    ),
    Output("power", "W", "dissipated in the film", nominal=10.0, reached_by=SPEED),
    Output("flow", "m3/s", "lubricant that leaves at both sides", nominal=1e-6, reached_by=SPEED),
    Output("fn", "N", "normal force of journal and pads that touch", nominal=10.0),
    Output("contact", "1", "whether journal and pads touch", kind="Boolean"),
)
LOSSES = (Output("film", "J", "dissipated in oil films", nominal=10.0), *CONTACT_LOSSES)
_OUT, _LOSS = places(OUTPUTS), places(LOSSES)


@jit_not_inlined
def _force(part, tables, kinematics, internal_state):
    """Implement this function of a law; see `parts.law`."""
    bearing = bearing_of(part)
    wall = wall_state(bearing, tables, kinematics)
    return film_force(bearing, tables, kinematics) + wall.force


@jit_not_inlined
def _tangent(part, tables, kinematics, weights, free, internal_state):
    """Implement this function of a law; see `parts.law`."""
    bearing = bearing_of(part)
    force, p, q = film_tangent(bearing, tables, kinematics, weights)
    by_wall, p_wall, q_wall = wall_tangent(bearing, tables, kinematics, weights)
    return force + by_wall, p + p_wall, q + q_wall


@jit_not_inlined
def _energy(part, tables, displacement, internal_state):
    """Implement this function of a law; see `parts.law`."""
    return (wall_energy(bearing_of(part), tables, Kinematics(displacement, 0.0j, 0.0, 0.0, 0.0)),)


@jit
def _film_power(film, kinematics):
    """Return the power that goes into the film [W]."""
    pushed = (film.force * kinematics.velocity.conjugate()).real
    return film.torque * kinematics.speed - pushed


@jit_not_inlined
def _dissipate(part, tables, kinematics, internal_state, out):
    """Implement this function of a law (see `parts.law`): film, contact damping, friction."""
    bearing = bearing_of(part)
    film = film_state(bearing, tables, kinematics)
    wall = wall_state(bearing, tables, kinematics)
    out[_LOSS.film] = _film_power(film, kinematics)
    out[_LOSS.contact] = wall.damped
    out[_LOSS.friction] = wall.rubbed
    return film.torque + part.journal_radius * wall.friction


@jit_not_inlined
def _observe(part, tables, kinematics, internal_state, out):
    """Implement this function of a law; see `parts.law`."""
    bearing = bearing_of(part)
    film = film_state(bearing, tables, kinematics)
    wall = wall_state(bearing, tables, kinematics)
    d = kinematics.displacement
    force = film.force + wall.force
    out[_OUT.fx] = force.real
    out[_OUT.fy] = force.imag
    out[_OUT.eccentricity] = modulus(d) / part.clearance
    out[_OUT.attitude] = angle(-d * film.force.conjugate())
    out[_OUT.film] = film.thinnest
    out[_OUT.film_angle] = film.where
    out[_OUT.pressure] = film.largest
    out[_OUT.torque] = film.torque + part.journal_radius * wall.friction
    out[_OUT.power] = _film_power(film, kinematics)
    out[_OUT.flow] = film.flow
    out[_OUT.fn] = wall.normal
    out[_OUT.contact] = 1.0 if wall.normal > 0.0 else 0.0


@jit
def film_breaks(part, tables, displacement):
    """Implement this function of a law; see `parts.law`."""
    return breaks(bearing_of(part), tables, Kinematics(displacement, 0.0j, 0.0, 0.0, 0.0))


@jit
def film_length(part):
    """Implement this function of a law; see `parts.law`."""
    return part.clearance


def film_table(rows: Sequence[Sequence[float]], points: float) -> np.ndarray:
    """Return rows of `contact.film.PAD` as a table, with the room in which the films are solved."""
    room = np.zeros(VECTORS * (int(points) + 1))
    return np.concatenate([[len(rows)], np.ravel(rows), room])


def whole_circle(is_full: bool = False) -> list[float]:
    """Return the row of `contact.film.PAD` of a plain circle."""
    return [0.0, 2.0 * math.pi, 0.0, 0.0, 1.0, 1.0, float(is_full)]


JOURNAL_BEARING = Law(
    name="journal_bearing",
    kind=FilmQuantities,
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
    table=lambda part: film_table(part.pad_rows(), part.points),
)


def check_film(where: str, film: FilmQuantities) -> None:
    """Raise `QuantityError` for a film whose quantities do not go together."""
    if float(film.points) != int(film.points):
        raise QuantityError(f"{where}.points = {film.points:g}: must be a whole number")
    ratio = film.length / (2.0 * film.journal_radius)
    if ratio > _LONGEST:
        raise QuantityError(
            f"{where}.length = {film.length:g} m: must be at most {_LONGEST:g} diameters, "
            f"{2.0 * _LONGEST * film.journal_radius:g} m"
        )
    if film.roughness >= 0.5 * film.clearance:
        raise QuantityError(
            f"{where}.roughness = {film.roughness:g} m: must be below half the clearance, "
            f"{0.5 * film.clearance:g} m"
        )


def _per_pad(unit: str, text: str, rule: Rule, default: float) -> Any:
    return quantity(unit, f"{text}; of all pads, or a list", rule, default, may_be_list=True)


@dataclass(frozen=True, kw_only=True)
class JournalBearing(FilmQuantities, Part):
    """A journal bearing with an oil film, between a node (from 1) and the housing of that name or
    ground.

    Without pads it is a plain, whole circle. A pad has the angle of its middle [rad], anticlockwise
    from the right; an arc [rad]; a preload, 1 less the bearing's clearance over the pad's; and an
    offset, the share of its arc from its first angle to where its preload brings it closest.
    """

    KIND: ClassVar[str] = "journal_bearing"
    TEXT: ClassVar[str] = "a journal in an oil film, given by the geometry of its bearing"
    LAWS: ClassVar[tuple[Law, ...]] = (JOURNAL_BEARING,)

    node: int
    housing: str = GROUND
    pads: tuple[float, ...] = quantity(
        "rad", "angle of the middle of each pad; none: a plain circle", ANY, (), may_be_list=True
    )
    arc: float | tuple[float, ...] = _per_pad("rad", "arc", _ARC, 2.0 * math.pi)
    preload: float | tuple[float, ...] = _per_pad("1", "preload", _PRELOAD, 0.0)
    offset: float | tuple[float, ...] = _per_pad("1", "offset", _OFFSET, 0.5)

    def check(self, where: str) -> None:
        """Raise `QuantityError`, for impossible pads too."""
        check_all(where, self)
        if not isinstance(self.pads, tuple):
            raise QuantityError(f"{where}.pads = {self.pads!r}: must be a list of numbers")
        check_film(where, self)
        for name in ("arc", "preload", "offset"):
            value = getattr(self, name)
            if isinstance(value, tuple) and len(value) != len(self.pads):
                raise QuantityError(
                    f"{where}.{name}: {len(value)} given, {len(self.pads)} needed, as many as "
                    f"{where}.pads has"
                )
        if not self.pads and (self.arc, self.preload) != (2.0 * math.pi, 0.0):
            raise QuantityError(f"{where}.pads: none is given for an arc or a preload")
        self._check_overlap(where)

    def _check_overlap(self, where: str) -> None:
        if not self.pads:
            return
        spans = sorted(
            (row[PAD.first], row[PAD.last], i) for i, row in enumerate(self.pad_rows(), 1)
        )
        first, _, number = spans[0]
        for (_, end, i), (begin, _, j) in pairwise([*spans, (first + 2.0 * math.pi, 0.0, number)]):
            if begin < end - _OVERLAP:
                low, high = sorted((i, j))
                raise QuantityError(f"{where}.pads: pads {low} and {high} overlap")

    def pad_rows(self) -> list[list[float]]:
        """Return a row of `contact.film.PAD` for each pad."""
        if not self.pads:
            return [whole_circle()]
        rows = []
        for i, middle in enumerate(self.pads):
            arc, preload, offset = (
                value[i] if isinstance(value, tuple) else value
                for value in (self.arc, self.preload, self.offset)
            )
            first = (middle - 0.5 * arc) % (2.0 * math.pi)
            clearance = 1.0 / (1.0 - preload)
            centre = (clearance - 1.0) * cmath.exp(1j * (first + offset * arc))
            rows.append([first, first + arc, centre.real, centre.imag, clearance, 0.0, 0.0])
        return rows

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """One interface."""
        yield Interface(self.node, JOURNAL_BEARING, self, self.housing)

    def outline(self) -> Iterator[Shape]:
        """A bush about the journal, on springs where it is a housing."""
        role = "stator" if self.housing == GROUND else "housing"
        yield Shape(-0.5 * self.length, self.length, self.journal_radius, self.journal_radius, role)
