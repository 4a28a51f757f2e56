"""A bearing's oil film: the force of all its pads on the journal, and its tangent.

A pad is an arc of a circle of the radius R + c_p, whose centre lies c_p - c beyond the bearing's,
away from the pad's pivot: c_p = c / (1 - preload). So the journal's displacement from the pad's
centre is d + (c_p - c) exp(i pivot), and the film is that of `zone_pressure`.

A table of numbers, `Law.table`: the count of pads, a row of `PAD` for each, and a work array for
each.
"""

import math
from typing import NamedTuple

from ..kernels.functions import angle, direction, modulus
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import places
from .short_film import short_load
from .solved_zone import finite_load, solved, work_size
from .zone_pressure import Film, zone_bound

# first and last angle [rad]; the journal's displacement from the pad's centre when it is in the
# bearing's, over the clearance; the pad's clearance over the bearing's; whether it is a circle and
# whether its film fills it (a short one never ruptures then; of another what is below rupture of
# its pressure does not count, or, where it is `NEVER`, all does); whether nothing leaves at its
# sides; the direction of its pivot, whether it tilts about that, and, as it was put last, its tilt
# [m] and the rate of that [m/s]: how far the pad's centre moves across its pivot; and how far it
# moves outwards, with its pivot [m], [m/s]
PAD = places(
    (
        *("first", "last", "x", "y", "clearance", "is_whole", "is_full", "is_sealed"),
        *("pivot_x", "pivot_y", "is_tilting", "tilt", "rate"),
        *("pivot_displacement", "pivot_velocity"),
    )
)
NEVER = 2.0  # ruptures a film that fills its pad
TILTS = (1.0, 0.0, 0.0, 0.0, 0.0)  # how the row of a pad that tilts ends
STANDS = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # and that of one that stands, its pivot too
_SEALED = 1e-4  # a of `film_zone` of a film from which nothing flows; it fixes a full one's level
TURNS = (-1, 0, 1, 2)  # half circles that a pad, whose first angle is in [0, 2 pi), may meet


class FilmBearing(NamedTuple):
    """Data of a part's film and of the contact behind it: the index of its table, quantities of
    `parts.film_law.FilmQuantities`, and the pressure around the film above that at which it
    ruptures [Pa]."""

    table: int
    journal_radius: float
    length: float
    clearance: float
    viscosity: float
    roughness: float
    short: float
    points: float
    k: float
    c: float
    delta_c: float
    exponent: float
    mu: float
    v_s: float
    mu_rise: float
    v_stribeck: float
    ambient: float


@jit
def bearing_with(part, viscosity, ambient):
    """Return the `FilmBearing` of a part with a viscosity [Pa.s] and an ambient pressure [Pa]."""
    return FilmBearing(
        *(part.table, part.journal_radius, part.length, part.clearance, viscosity),
        *(part.roughness, part.short, part.points, part.k, part.c, part.delta_c, part.exponent),
        *(part.mu, part.v_s, part.mu_rise, part.v_stribeck, ambient),
    )


@jit
def bearing_of(part):
    """Return the `FilmBearing` of a part of constant viscosity."""
    return bearing_with(part, part.viscosity, 0.0)


class Pad(NamedTuple):
    """A pad's `Film`; clearance [m]; the journal relative to its centre [m], and its velocity
    [m/s]; turning: share of this due to the tilting pad [m/s]; load: factor of the integral of P
    exp(i theta) [N.s]; pressure: factor of P [Pa.s]."""

    film: Film
    clearance: float
    displacement: complex
    velocity: complex
    turning: float
    load: float
    pressure: float


@jit
def pad_count(bearing, tables):
    """Return the number of pads of a bearing."""
    return int(tables[bearing.table])


@jit
def pad_of(bearing, tables, kinematics, i):
    """Return the `Pad` number i, and its work array."""
    at = bearing.table + 1 + len(PAD) * i
    c = bearing.clearance * tables[at + PAD.clearance]
    d = kinematics.displacement + bearing.clearance * complex(
        tables[at + PAD.x], tables[at + PAD.y]
    )
    v, turning = kinematics.velocity, 0.0
    if tables[at + PAD.is_tilting] > 0.0:
        across = complex(-tables[at + PAD.pivot_y], tables[at + PAD.pivot_x])
        turning = tables[at + PAD.rate]
        d += tables[at + PAD.tilt] * across
        v += turning * across
        pivot_displacement, pivot_velocity = (
            tables[at + PAD.pivot_displacement],
            tables[at + PAD.pivot_velocity],
        )
        if pivot_displacement != 0.0 or pivot_velocity != 0.0:
            outwards = complex(across.imag, -across.real)
            d -= pivot_displacement * outwards
            v -= pivot_velocity * outwards
    inverse = 1.0 / c
    D, V = d * inverse, v * inverse
    S = 2.0 * V + complex(kinematics.speed * D.imag, -kinematics.speed * D.real)
    R, L = bearing.journal_radius, bearing.length
    ratio = 2.0 * R / L
    pressure = 6.0 * bearing.viscosity * (R * inverse) * (R * inverse)
    a, mean = 2.5 * ratio * ratio, 2.0 / 3.0
    if tables[at + PAD.is_sealed] > 0.0:  # the same all along its length
        a, mean, pressure = _SEALED, 1.0, 0.8 * pressure
    ambient = bearing.ambient / pressure if bearing.ambient > 0.0 else 0.0
    if tables[at + PAD.is_full] == NEVER:
        ambient = math.inf
    film = Film(
        *(D, S, a, bearing.roughness * inverse),
        *(tables[at + PAD.first], tables[at + PAD.last], tables[at + PAD.is_whole] > 0.0),
        *(tables[at + PAD.is_full] > 0.0, int(bearing.points), ambient),
    )
    size = work_size(bearing.points)
    work = bearing.table + 1 + len(PAD) * pad_count(bearing, tables) + size * i
    load = mean * L * R * pressure
    return Pad(film, c, d, v, turning, load, pressure), tables[work : work + size]


@jit
def short_share(bearing):
    """Return P over f / H^3 of Ocvirk's film [1]."""
    ratio = bearing.length / bearing.journal_radius
    return 0.125 * ratio * ratio


@jit_not_inlined
def _pad_load(bearing, film, work):
    """Return the integral of P exp(i theta) over a pad's film [1/s], of Ocvirk's less its
    `short_share`."""
    total = 0.0j
    if film.S == 0.0:
        return total
    sense = angle(film.S)
    for turn in TURNS:
        acts, bound = zone_bound(film, sense, turn)
        if not acts:
            continue
        if bearing.short > 0.0:
            load, _, _, _, _ = short_load(film.D, film.S, film.floor, bound.low[1], bound.high[0])
        else:
            _, load = solved(film, bound, work)
        total += load
    return total


@jit_not_inlined
def film_force(bearing, tables, kinematics):
    """Return the film's force on the journal [N]."""
    force = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad, work = pad_of(bearing, tables, kinematics, i)
        scale = pad.load * short_share(bearing) if bearing.short > 0.0 else pad.load
        force -= scale * _pad_load(bearing, pad.film, work)
    return force


@jit
def _moving(film, S):
    """Return a film with other surfaces' motion S [1/s]."""
    return Film(
        *(film.D, S, film.a, film.floor, film.first, film.last, film.is_whole),
        *(film.is_full, film.n, film.ambient),
    )


@jit
def _odd_load(bearing, film, along, work):
    """Return the mean of what a film's load is to surfaces that move with 1/s in a direction, and
    minus what it is to those that move back."""
    ahead = _pad_load(bearing, _moving(film, along), work)
    return 0.5 * (ahead - _pad_load(bearing, _moving(film, -along), work))


@jit_not_inlined
def _slopes_at_rest(bearing, film, work):
    """Return the derivative of the load of a film at rest by S as a pair p_S, q_S. A film that
    ruptures resists a motion towards its thin side more than one away from it, so that the load has
    a kink there; in a small vibration about it, what has the vibration's frequency is the mean of
    both."""
    e = modulus(film.D)
    along = film.D * (1.0 / e) if e > 0.0 else 1.0 + 0.0j
    of_along, of_across = (
        _odd_load(bearing, film, along, work),
        _odd_load(bearing, film, 1j * along, work),
    )
    p = 0.5 * (of_along - 1j * of_across) * along.conjugate()
    return p, 0.5 * (of_along + 1j * of_across) * along


class FilmSlopes(NamedTuple):
    """A film's force on its journal [N], and its derivatives by the journal's displacement, p_d,
    q_d, and velocity, p_v, q_v, as pairs p z + q conj(z)."""

    force: complex
    p_d: complex
    q_d: complex
    p_v: complex
    q_v: complex


@jit_not_inlined
def pad_slopes(bearing, pad, work, speed):
    """Return the `FilmSlopes` of a pad, its journal turning at a speed [rad/s]."""
    load = p_D = q_D = p_S = q_S = 0.0j
    film = pad.film
    if film.S == 0.0:
        p_S, q_S = _slopes_at_rest(bearing, film, work)
    else:
        sense = angle(film.S)
        for turn in TURNS:
            acts, bound = zone_bound(film, sense, turn)
            if not acts:
                continue
            if bearing.short > 0.0:
                of_zone = short_load(film.D, film.S, film.floor, bound.low[1], bound.high[0])
            else:
                of_zone = finite_load(film, bound, work)
            load += of_zone[0]
            p_D += of_zone[1]
            q_D += of_zone[2]
            p_S += of_zone[3]
            q_S += of_zone[4]
    scale = pad.load * short_share(bearing) if bearing.short > 0.0 else pad.load
    force = -scale * load
    # dS = 2 dV - i omega dD
    scale /= pad.clearance
    turn_d = complex(0.0, speed)
    p_d, q_d = -scale * (p_D - p_S * turn_d), -scale * (q_D + q_S * turn_d)
    return FilmSlopes(force, p_d, q_d, -2.0 * scale * p_S, -2.0 * scale * q_S)


@jit_not_inlined
def film_slopes(bearing, tables, kinematics):
    """Return the `FilmSlopes` of a bearing."""
    force = p_d = q_d = p_v = q_v = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad, work = pad_of(bearing, tables, kinematics, i)
        of_pad = pad_slopes(bearing, pad, work, kinematics.speed)
        force += of_pad.force
        p_d += of_pad.p_d
        q_d += of_pad.q_d
        p_v += of_pad.p_v
        q_v += of_pad.q_v
    return FilmSlopes(force, p_d, q_d, p_v, q_v)


@jit
def film_tangent(bearing, tables, kinematics, weights):
    """Return the film's force on the journal [N] and its tangent p, q; see `parts.law`."""
    at = film_slopes(bearing, tables, kinematics)
    by_d, by_v = weights.displacement, weights.velocity
    return at.force, by_d * at.p_d + by_v * at.p_v, by_d * at.q_d + by_v * at.q_v


@jit_not_inlined
def thinnest(pad):
    """Return the smallest film thickness of a pad, of smooth surfaces [m], its direction, and the
    rotation of that by a displacement across it [1/m]: none at the pad's edge."""
    film = pad.film
    e = modulus(film.D)
    along = film.D * (1.0 / e) if e > 0.0 else 1.0 + 0.0j
    curvature = 1.0 / (pad.clearance * e) if e > 0.0 else 0.0
    if film.is_whole:
        return pad.clearance * (1.0 - e), along, curvature
    middle = direction(0.5 * (film.first + film.last))
    if abs(angle(along * middle.conjugate())) < 0.5 * (film.last - film.first):
        return pad.clearance * (1.0 - e), along, curvature
    first, last = direction(film.first), direction(film.last)
    near, far = (film.D.conjugate() * first).real, (film.D.conjugate() * last).real
    if near > far:
        return pad.clearance * (1.0 - near), first, 0.0
    return pad.clearance * (1.0 - far), last, 0.0
