"""A journal bearing: a journal in an oil film between pads, which it may touch.

The film is solved at every instant (`film_law`). Pads are fixed, or tilt about pivots
(`tilting_pads`).
"""

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, ClassVar

import numpy as np

from ..film.bearing_film import PAD, STANDS, TILTS, film_force, film_tangent, pad_count
from ..film.film_outputs import film_state
from ..film.rough_contact import wall_energy, wall_state, wall_tangent
from ..kernels.functions import angle, modulus
from ..kernels.jit import jit, jit_not_inlined
from ..kernels.kernel import interpreted
from ..quantities import ANGLE, QuantityError, Rule, check_all, places, quantity
from .base import GROUND, Element, InterfaceElement, Part, Shape
from .clearance_contact import STORES
from .film_law import (
    LOSSES,
    OUTPUTS,
    bearing_at,
    check_film,
    film_breaks,
    film_length,
    film_table,
    whole_circle,
)
from .film_viscosity import HeatQuantities, check_viscosity
from .law import BY_D, BY_V, Kinematics, Law
from .pads_linearized import linearize_film
from .speed_table import speed_table
from .tilting_pads import (
    PADS,
    TiltingQuantities,
    energy_of_pads,
    pads_tangent,
    pads_vibrate,
    rates_of_pads,
    set_pads,
    set_pads_at_rest,
    states_of_pad,
    tilts_of,
    units_of_pad,
)

_PRELOAD = Rule(0.0, False, "must be from 0 to 0.99", most=0.99)
_OFFSET = Rule(0.0, False, "must be from 0 to 1", most=1.0)
_ARC = Rule(0.0, True, "must be > 0 and at most 2 pi", most=2.0 * math.pi)
_OVERLAP = 1e-9  # rad
# where the pressure and its gradient vanish, and where that of a full film becomes negative
RUPTURES = ("reynolds", "guembel")
GUEMBEL = RUPTURES[1]
_OUT, _LOSS = places(OUTPUTS), places(LOSSES)
_TILTS = len(OUTPUTS)


@jit_not_inlined
def _force(part, tables, kinematics, internal_state):
    bearing = bearing_at(part, tables, kinematics.speed)
    set_pads(part, bearing, tables, kinematics, internal_state)
    wall = wall_state(bearing, tables, kinematics)
    return film_force(bearing, tables, kinematics) + wall.force


@jit_not_inlined
def _tangent(part, tables, kinematics, weights, free, internal_state):
    bearing = bearing_at(part, tables, kinematics.speed)
    if part.tilting > 0.0:
        return pads_tangent(part, bearing, tables, kinematics, weights, free, internal_state)
    force, p, q = film_tangent(bearing, tables, kinematics, weights)
    by_wall, p_wall, q_wall = wall_tangent(bearing, tables, kinematics, weights)
    return force + by_wall, p + p_wall, q + q_wall


@jit_not_inlined
def _energy(part, tables, displacement, internal_state):
    bearing = bearing_at(part, tables, 0.0)
    set_pads_at_rest(part, bearing, tables, internal_state)
    still = Kinematics(displacement, 0.0j, 0.0, 0.0, 0.0)
    return wall_energy(bearing, tables, still), energy_of_pads(
        part, bearing, tables, internal_state
    )


@jit
def _film_power(film, kinematics):
    """Return the power dissipated in the film [W]."""
    pushed = (film.force * kinematics.velocity.conjugate()).real
    return film.torque * kinematics.speed - pushed - film.tilted


@jit_not_inlined
def _dissipate(part, tables, kinematics, internal_state, out):
    bearing = bearing_at(part, tables, kinematics.speed)
    set_pads(part, bearing, tables, kinematics, internal_state)
    film = film_state(bearing, tables, kinematics, False)
    wall = wall_state(bearing, tables, kinematics)
    out[_LOSS.film] = _film_power(film, kinematics)
    out[_LOSS.contact] = wall.damped
    out[_LOSS.friction] = wall.rubbed
    return film.torque + part.journal_radius * wall.friction


@jit_not_inlined
def _observe(part, tables, kinematics, internal_state, out):
    bearing = bearing_at(part, tables, kinematics.speed)
    set_pads(part, bearing, tables, kinematics, internal_state)
    film = film_state(bearing, tables, kinematics, True)
    wall = wall_state(bearing, tables, kinematics)
    d = kinematics.displacement
    force = film.force + wall.force
    out[_OUT.fx] = force.real
    out[_OUT.fy] = force.imag
    out[_OUT.x] = d.real
    out[_OUT.y] = d.imag
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
    if part.tilting > 0.0:
        stride, count = states_of_pad(part), pad_count(bearing, tables)
        for i in range(count):
            out[_TILTS + i] = internal_state[stride * i] / part.journal_radius
            if part.pivot_stiffness > 0.0:
                out[_TILTS + count + i] = internal_state[stride * (i + 1) - 1]


@jit_not_inlined
def _rates(part, tables, kinematics, internal_state, out):
    if part.tilting > 0.0:
        bearing = bearing_at(part, tables, kinematics.speed)
        rates_of_pads(part, bearing, tables, kinematics, internal_state, out)


@jit_not_inlined
def _vibrate(part, tables, kinematics, frequency, free, internal_state):
    if part.tilting > 0.0:
        bearing = bearing_at(part, tables, kinematics.speed)
        return pads_vibrate(part, bearing, tables, kinematics, frequency, free, internal_state)
    _, p_d, q_d = _tangent(part, tables, kinematics, BY_D, free, internal_state)
    force, p_v, q_v = _tangent(part, tables, kinematics, BY_V, free, internal_state)
    return force, p_d, q_d, p_v, q_v


@jit_not_inlined
def _breaks(part, tables, displacement, internal_state):
    set_pads_at_rest(part, bearing_at(part, tables, 0.0), tables, internal_state)
    return film_breaks(part, tables, displacement, internal_state)


JOURNAL_BEARING = Law(
    name="journal_bearing",
    kind=TiltingQuantities,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    length=film_length,
    breaks=_breaks,
    outputs=OUTPUTS,
    stores=STORES,
    losses=LOSSES,
    table=lambda part: film_table(part.pad_rows(), part.points, part.viscosity_tables()),
)
# with states of each pad, outputs and energy more; the kernels are the same
TILTING_PADS = replace(
    JOURNAL_BEARING,
    rates=_rates,
    vibrate=_vibrate,
    linearize=linearize_film,
    stores=(*STORES, PADS),
    of_part=lambda part: (
        interpreted(states_of_pad)(part) * len(part.pads),
        (*OUTPUTS, *tilts_of(part)),
    ),
    state_units=units_of_pad,
)


def _per_pad(unit: str, text: str, rule: Rule, default: float) -> Any:
    return quantity(unit, f"{text}; of all pads, or a list", rule, default, may_be_list=True)


@dataclass(frozen=True, kw_only=True)
class JournalBearing(HeatQuantities, TiltingQuantities, Part):
    """A journal bearing with an oil film, between a node (from 1) and a housing or ground.

    Without pads it is a plain, whole circle. A pad has the angle of its middle [rad], anticlockwise
    from the right; an arc [rad]; a preload, 1 less the bearing's clearance over the pad's; and an
    offset, the share of its arc from its first angle to where its preload brings it closest, which
    is the pivot of a pad that tilts. rupture: of the film, one of `RUPTURES`.
    """

    KIND: ClassVar[str] = "journal_bearing"
    TEXT: ClassVar[str] = "a journal in an oil film, given by the geometry of its bearing"
    LAWS: ClassVar[tuple[Law, ...]] = (JOURNAL_BEARING, TILTING_PADS)

    node: int
    housing: str = GROUND
    pads: tuple[float, ...] = quantity(
        "rad", "angle of the middle of each pad; none: a plain circle", ANGLE, (), may_be_list=True
    )
    arc: float | tuple[float, ...] = _per_pad("rad", "arc", _ARC, 2.0 * math.pi)
    preload: float | tuple[float, ...] = _per_pad("1", "preload", _PRELOAD, 0.0)
    offset: float | tuple[float, ...] = _per_pad("1", "offset", _OFFSET, 0.5)

    rupture: str = RUPTURES[0]

    @property
    def law(self) -> Law:
        """The law of this bearing, one of `LAWS`."""
        return TILTING_PADS if self.tilting else JOURNAL_BEARING

    def check(self, where: str) -> None:
        """Raise `QuantityError` for impossible quantities or pads."""
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
        if not self.pads and (self.arc, self.preload, self.offset) != (2.0 * math.pi, 0.0, 0.5):
            raise QuantityError(f"{where}.pads: is missing; arc, preload and offset need pads")
        self._check_overlap(where)
        self._check_tilting(where)
        self._check_rupture(where)
        check_viscosity(where, self)

    def _check_rupture(self, where: str) -> None:
        if self.rupture not in RUPTURES:
            raise QuantityError(
                f"{where}.rupture = {self.rupture}: must be one of {', '.join(RUPTURES)}"
            )
        if self.supply_pressure > 0.0 and not self._is_full:
            raise QuantityError(
                f"{where}.supply_pressure = {self.supply_pressure:g} Pa: needs {where}.rupture = "
                f"{GUEMBEL} and {where}.short = false, a film that fills its pads"
            )

    def _check_tilting(self, where: str) -> None:
        if not self.tilting:
            for name, unit in (("pad_inertia", "kg.m2"), ("pivot_stiffness", "N/m")):
                if getattr(self, name) > 0.0:
                    raise QuantityError(
                        f"{where}.{name} = {getattr(self, name):g} {unit}: needs {where}.tilting = "
                        "true"
                    )
            return
        if not self.pads:
            raise QuantityError(f"{where}.tilting = true: needs {where}.pads, which tilt")
        if self.short:
            raise QuantityError(
                f"{where}.tilting = true: needs {where}.short = false, a film of finite length"
            )
        for i in range(len(self.pads)):
            arc, _, offset = self._shape(i)
            if arc > math.pi:
                raise QuantityError(
                    f"{where}.arc = {arc:g} rad: must be at most pi of a pad that tilts"
                )
            if not 0.0 < offset < 1.0:
                raise QuantityError(
                    f"{where}.offset = {offset:g}: must be between 0 and 1 of a pad that tilts, "
                    "whose pivot it is"
                )

    @property
    def _is_full(self) -> bool:
        """Whether films fill their pads; a short film is the same with either rupture."""
        return self.rupture == GUEMBEL and not self.short

    def _shape(self, i: int) -> tuple[float, ...]:
        """Return arc, preload and offset of a pad."""
        return tuple(
            value[i] if isinstance(value, tuple) else value
            for value in (self.arc, self.preload, self.offset)
        )

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
        """Return a row of `film.bearing_film.PAD` for each pad."""
        if not self.pads:
            return [whole_circle(self._is_full)]
        rows = []
        for i, middle in enumerate(self.pads):
            arc, preload, offset = self._shape(i)
            first = (middle - 0.5 * arc) % (2.0 * math.pi)
            clearance = 1.0 / (1.0 - preload)
            pivot = cmath.exp(1j * (first + offset * arc))
            centre = (clearance - 1.0) * pivot
            motion = (pivot.real, pivot.imag, *TILTS) if self.tilting else STANDS
            shape = (
                first,
                first + arc,
                centre.real,
                centre.imag,
                clearance,
                0.0,
                float(self._is_full),
                0.0,
            )
            rows.append([*shape, *motion])
        return rows

    def viscosity_tables(self) -> list[np.ndarray]:
        """Return the `speed_table`s of the viscosity at positive and at negative speeds, none if it
        is constant."""
        if not isinstance(self.viscosity, tuple):
            return []
        if self.temperature:  # no numbers before there is a heat balance (`laws_at_rest.oil`)
            return 2 * [math.nan * speed_table(self.speed, ("viscosity",), {})]
        return 2 * [speed_table(self.speed, ("viscosity",), {"viscosity": self.viscosity})]

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one interface."""
        yield InterfaceElement(self.node, self.law, self, self.housing)

    def outline(self) -> Iterator[Shape]:
        """Yield a bush about the journal, on springs if it is a housing."""
        role = "stator" if self.housing == GROUND else "housing"
        yield Shape(-0.5 * self.length, self.length, self.journal_radius, self.journal_radius, role)
