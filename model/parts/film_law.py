"""Common to all parts with an oil film: quantities, table and outputs.

The film is solved at every instant: Reynolds' equation pad by pad, ruptured where pressure and
pressure gradient vanish (`film.zone_pressure`), or Ocvirk's closed form. A film stores no energy:
the power of the rotor's torque and force is dissipated.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..contact.wall import contact_quantity
from ..film.bearing_film import PAD, STANDS, bearing_of, bearing_with
from ..film.rough_contact import breaks
from ..film.solved_zone import work_size
from ..kernels.jit import jit
from ..kernels.kernel import interpreted
from ..quantities import (
    NOT_NEGATIVE,
    SPEED,
    Output,
    QuantityError,
    Rule,
    quantities,
    quantity,
    switch,
)
from .base import FORCE_OUTPUTS
from .clearance_contact import LOSSES as CONTACT_LOSSES
from .law import Kinematics
from .speed_table import cubic, row_at

POINTS = Rule(8.0, False, "must be from 8 to 1024", most=1024.0)
_LONGEST = 2.0  # length over diameter
_WIDTH = 5  # of a row of the viscosity's `speed_table`


class Rough:
    """What has oil films between surfaces of the same roughness [m]."""

    roughness: float

    def rule_of(self, name: str) -> Rule:
        """Return which values a quantity may have: `Part.rule_of`; see `check_film`."""
        if not name.endswith("clearance"):
            return quantities(self)[name].rule
        least = 2.0 * self.roughness
        return Rule(least, True, f"must be > {least:g} m, twice the roughness")


@dataclass(frozen=True, kw_only=True)
class FilmQuantities(Rough):
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
    points: float = quantity("1", "elements of the film of a pad", POINTS, 48.0)
    k: float = contact_quantity("k", 0.0, NOT_NEGATIVE)
    c: float = contact_quantity("c", 100.0)
    delta_c: float = contact_quantity("delta_c", 2e-7)
    exponent: float = contact_quantity("exponent", 1.0)
    mu: float = contact_quantity("mu", 0.1)
    v_s: float = contact_quantity("v_s", 1e-3)
    mu_rise: float = contact_quantity("mu_rise", 0.0)
    v_stribeck: float = contact_quantity("v_stribeck", 0.01)


# Of what a film bears, a journal or a ring.
PLACE_OUTPUTS = (
    Output("x", "m", "displacement in the bearing, to the right", nominal=1e-5),
    Output("y", "m", "displacement in the bearing, upwards", nominal=1e-5),
)
OUTPUTS = (
    *FORCE_OUTPUTS,
    *PLACE_OUTPUTS,
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
        *("torque", "N.m", "torque of the film and of friction opposing positive rotation"),
        nominal=0.1,
        reached_by=SPEED,
    ),
    Output("power", "W", "dissipated in the film", nominal=10.0, reached_by=SPEED),
    Output("flow", "m3/s", "lubricant that leaves at both sides", nominal=1e-6, reached_by=SPEED),
    Output("fn", "N", "normal force of journal and pads that touch", nominal=10.0),
    Output("contact", "1", "whether journal and pads touch", kind="Boolean"),
)
LOSSES = (Output("film", "J", "dissipated in oil films", nominal=10.0), *CONTACT_LOSSES)


@jit
def film_breaks(part, tables, displacement, internal_state):
    """Return whether the journal touches in a film without contact stiffness: `Law.breaks`."""
    return breaks(bearing_of(part), tables, Kinematics(displacement, 0.0j, 0.0, 0.0, 0.0))


@jit
def viscosity_at(part, tables, speed):
    """Return the viscosity of a part at a speed [rad/s] [Pa.s]: from the `speed_table` of its sense
    of rotation behind the film's table, if there is one."""
    first = part.table + 1 + int(tables[part.table]) * (len(PAD) + work_size(part.points))
    rows = (part.table + part.rows - first) // (2 * _WIDTH)  # of each sense
    if rows == 0:
        return part.viscosity
    if speed < 0.0:
        first += rows * _WIDTH
    fast = abs(speed)
    at = row_at(tables, first, rows, _WIDTH, fast)
    return cubic(tables, at + 1, max(0.0, fast - tables[at]))


@jit
def bearing_at(part, tables, speed):
    """Return the `FilmBearing` of a journal bearing at a speed [rad/s]."""
    return bearing_with(part, viscosity_at(part, tables, speed), part.supply_pressure)


@jit
def film_length(part):
    """Return the clearance [m]: `Law.length` of a film."""
    return part.clearance


def film_table(
    rows: Sequence[Sequence[float]], points: float, viscosity: Sequence[np.ndarray] = ()
) -> np.ndarray:
    """Return rows of `film.bearing_film.PAD` as a table, with work space for the films, and the
    `speed_table`s of the viscosity, over the sizes of positive and of negative speeds."""
    room = np.zeros(len(rows) * interpreted(work_size)(points))
    return np.concatenate([[len(rows)], np.ravel(rows), room, np.ravel(viscosity)])


def whole_circle(is_full: float = False, is_sealed: bool = False) -> list[float]:
    """Return the row of `film.bearing_film.PAD` of a plain circle."""
    return [0.0, 2.0 * math.pi, 0.0, 0.0, 1.0, 1.0, float(is_full), float(is_sealed), *STANDS]


def check_film(where: str, film: Any, prefix: str = "", radius: str = "journal_radius") -> None:
    """Raise `QuantityError` for incompatible quantities of a film; prefix: of the names of its
    length and clearance, radius: name of its radius."""
    if float(film.points) != int(film.points):
        raise QuantityError(f"{where}.points = {film.points:g}: must be a whole number")
    length, clearance = getattr(film, f"{prefix}length"), getattr(film, f"{prefix}clearance")
    longest = 2.0 * _LONGEST * getattr(film, radius)
    if length > longest:
        raise QuantityError(
            f"{where}.{prefix}length = {length:g} m: must be at most {_LONGEST:g} diameters, "
            f"{longest:g} m"
        )
    if not film.rule_of(f"{prefix}clearance").allows(clearance):
        raise QuantityError(
            f"{where}.roughness = {film.roughness:g} m: must be below half the "
            f"{prefix.replace('_', ' ')}clearance, {0.5 * clearance:g} m"
        )
