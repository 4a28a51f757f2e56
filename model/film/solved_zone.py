"""The pressure of a film of finite length between two ends, solved once for all that ask for it.

A pad's work array holds the pressure at its nodes and, at its end, the zone that the pressure is
of.
"""

from ..kernels.jit import jit, jit_not_inlined
from ..quantities import places
from .full_film import full_load, full_tangent, solve_full
from .load_derivatives import zone_tangent
from .zone_pressure import VECTORS, Zone, solve_zone, zone_load

# What a zone follows from, its ends, whether they are free, and its load.
SOLVED = places(
    (
        *("D_x", "D_y", "S_x", "S_y", "a", "floor", "ambient", "begin"),
        *("first", "last", "is_first_free", "is_last_free", "load_x", "load_y"),
    )
)


@jit
def work_size(points):
    """Return how many numbers the work array of a pad has."""
    return VECTORS * (int(points) + 1) + len(SOLVED)


@jit
def _is_solved(film, bound, at):
    """Return whether the zone in a work array, whose `SOLVED` is `at`, is that within a `Bound`."""
    is_same = at[SOLVED.D_x] == film.D.real and at[SOLVED.D_y] == film.D.imag
    is_same = is_same and at[SOLVED.S_x] == film.S.real and at[SOLVED.S_y] == film.S.imag
    is_same = is_same and at[SOLVED.a] == film.a and at[SOLVED.floor] == film.floor
    return is_same and at[SOLVED.ambient] == film.ambient and at[SOLVED.begin] == bound.low[1]


@jit_not_inlined
def solved(film, bound, work):
    """Return the `Zone` within a `Bound`, its pressure filled into `work`, and the integral of P
    exp(i theta) over it [1/s]; of a full film only of the pressure above rupture. After a step
    rates, powers and outputs ask for the same zone one after the other: it is solved once."""
    at = work[VECTORS * (film.n + 1) :]
    if _is_solved(film, bound, at):
        is_first_free, is_last_free = at[SOLVED.is_first_free] > 0.0, at[SOLVED.is_last_free] > 0.0
        zone = Zone(at[SOLVED.first], at[SOLVED.last], is_first_free, is_last_free)
        return zone, complex(at[SOLVED.load_x], at[SOLVED.load_y])
    if film.is_full:
        zone = solve_full(film, work)
        load = full_load(film, zone, work)
    else:
        zone = solve_zone(film, bound, work)
        load = zone_load(film, zone, work)
    at[SOLVED.D_x], at[SOLVED.D_y] = film.D.real, film.D.imag
    at[SOLVED.S_x], at[SOLVED.S_y] = film.S.real, film.S.imag
    at[SOLVED.a], at[SOLVED.floor], at[SOLVED.ambient] = film.a, film.floor, film.ambient
    at[SOLVED.begin] = bound.low[1]
    at[SOLVED.first], at[SOLVED.last] = zone.first, zone.last
    at[SOLVED.is_first_free] = 1.0 if zone.is_first_free else 0.0
    at[SOLVED.is_last_free] = 1.0 if zone.is_last_free else 0.0
    at[SOLVED.load_x], at[SOLVED.load_y] = load.real, load.imag
    return zone, load


@jit_not_inlined
def finite_load(film, bound, work):
    """Return the integral of P exp(i theta) over the zone within a `Bound` [1/s] and its
    derivative, as `short_load`."""
    zone, load = solved(film, bound, work)
    if film.is_full:
        p_D, q_D, p_S, q_S = full_tangent(film, zone, work)
    else:
        p_D, q_D, p_S, q_S = zone_tangent(film, zone, work)
    return load, p_D, q_D, p_S, q_S
