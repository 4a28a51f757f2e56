"""A film's pressure between two angles: the quasi-one-dimensional Reynolds equation.

With the profile p(theta, z) = p(theta) (1 - (2 z / L)^2), Galerkin's method across the length gives

    (H^3 P')' - a H^3 P = -1.25 f,    f = Re(exp(-i theta) S),    S = 2 V - i omega D

of the clearance c, D and V = D' the displacement and velocity of the journal over c, the film
H = 1 - Re(exp(-i theta) D), a = 2.5 (2 R / L)^2 and p = 6 mu (R / c)^2 P; P in 1/s. It is exact as
L goes to 0.

Where the film ruptures, P = P' = 0 (Reynolds). f is positive on one half of the circle, so that the
film is in one piece there, and its ends are unknowns of their own: `n` equal elements lie between
them and move with them. So force and tangent have no jump, wherever the ends are.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ..kernels.functions import direction
from ..kernels.jit import jit, jit_not_inlined

VECTORS = 8  # of n + 1 numbers, that the work array of a zone holds: `Vectors`
_ITERATIONS = 600  # a few as a rule; hundreds where elements are few and the film thin
_CONVERGED = 1e-10  # of the ends [rad]
_FEW, _NEAR = 8, 1e-3  # elements that the ends are first looked for with, and how well [rad]
_SECANT = 1e-8  # move of an end from which a slope may be taken [rad]
_SHORTEST = 1e-9  # a zone of a pad's edge [rad]: what is less bears nothing
_PI = math.pi


class Gap(NamedTuple):
    """The film's thickness over the clearance [1], of which something remains where the
    surfaces are rough, and its first and second derivative by the geometric one."""

    thickness: float
    slope: float
    bend: float


@jit
def floored(h, floor):
    """Return the `Gap` of a geometric thickness: h from twice the floor on; less and less follows
    below, the floor itself at 0."""
    if h >= 2.0 * floor:
        return Gap(h, 1.0, 0.0)
    inverse = 1.0 / (4.0 * floor - h)
    slope = 4.0 * floor * floor * inverse * inverse
    return Gap(4.0 * floor * floor * inverse, slope, 2.0 * slope * inverse)


class Film(NamedTuple):
    """A pad's film, over the clearance: D [1], S [1/s], a [1], floor: the least thickness [1]; the
    pad's first and last angle [rad], whether it is a whole circle, and whether the film fills it
    (`full_film`); n: elements of a zone; ambient: the pressure around the film above that at which
    a full one ruptures, as P [1/s]."""

    D: complex
    S: complex
    a: float
    floor: float
    first: float
    last: float
    is_whole: bool
    is_full: bool
    n: int
    ambient: float


class Zone(NamedTuple):
    """A piece of a film with pressure: its ends [rad], and whether each is free (a rupture) or the
    pad's edge."""

    first: float
    last: float
    is_first_free: bool
    is_last_free: bool


class Bound(NamedTuple):
    """Where the ends of a zone may lie [rad]; low: the least and most of the first, high: of the
    last."""

    low: tuple
    high: tuple


@jit
def zone_bound(film, sense, turn):
    """Return whether pressure builds up in the pad in the half circle about the angle `sense`
    [rad], `turn` times turned on, and the `Bound` of that zone."""
    middle = sense + 2.0 * _PI * turn
    begin, end = middle - 0.5 * _PI, middle + 0.5 * _PI
    if film.is_full:
        return turn == 0, Bound((film.first, film.first), (film.last, film.last))
    if film.is_whole:
        return turn == 0, Bound((middle - _PI, begin), (end, middle + _PI))
    low = (max(film.first, middle - _PI), max(film.first, begin))
    high = (min(film.last, end), min(film.last, middle + _PI))
    return high[0] - low[1] > _SHORTEST, Bound(low, high)


class Vectors(NamedTuple):
    """The work array's vectors of n + 1 nodes: cosine and sine of their angles, thickness, its
    first and second derivative (`Gap`), pressure, inverses of the pivots, and an adjoint."""

    cosine: object
    sine: object
    thickness: object
    slope: object
    bend: object
    P: object
    inverse: object
    adjoint: object


@jit
def vectors(film, work):
    """Return the `Vectors` of a work array."""
    m = film.n + 1
    return Vectors(
        *(work[:m], work[m : 2 * m], work[2 * m : 3 * m], work[3 * m : 4 * m]),
        *(work[4 * m : 5 * m], work[5 * m : 6 * m], work[6 * m : 7 * m], work[7 * m : 8 * m]),
    )


@jit
def conductance(low, high):
    """Return the flow that a unit gradient drives between films of two thicknesses [1]."""
    mean = 0.5 * (low + high)
    return mean * mean * mean


@jit_not_inlined
def fill_pressure(film, first, last, work):
    """Fill in the pressure between two angles, 0 at both [1/s]; returns P' and P'' there."""
    n, S = film.n, film.S
    cosine, sine, thickness, slope, bend, P, inverse, _ = vectors(film, work)
    step = (last - first) / n
    e, turn = direction(first), direction(step)
    for i in range(n + 1):
        cosine[i] = e.real
        sine[i] = e.imag
        at = floored(1.0 - (e.real * film.D.real + e.imag * film.D.imag), film.floor)
        thickness[i] = at.thickness
        slope[i] = at.slope
        bend[i] = at.bend
        e = e * turn
    per, mass, source = 1.0 / step, film.a * step, 1.25 * step
    P[0] = 0.0
    P[n] = 0.0
    above = 0.0
    left = per * conductance(thickness[0], thickness[1])
    for i in range(1, n):
        right = per * conductance(thickness[i], thickness[i + 1])
        cube = thickness[i] * thickness[i] * thickness[i]
        inverse[i] = 1.0 / (left + right + mass * cube - left * above)
        f = cosine[i] * S.real + sine[i] * S.imag
        P[i] = (source * slope[i] * f + left * P[i - 1]) * inverse[i]
        above = right * inverse[i]
        left = right
    for i in range(n - 1, 0, -1):
        right = per * conductance(thickness[i], thickness[i + 1])
        P[i] += right * inverse[i] * P[i + 1]
    f_0 = slope[0] * (cosine[0] * S.real + sine[0] * S.imag)
    f_n = slope[n] * (cosine[n] * S.real + sine[n] * S.imag)
    rise = per * conductance(thickness[0], thickness[1]) * P[1] + 0.5 * source * f_0
    fall = per * conductance(thickness[n - 1], thickness[n]) * P[n - 1] + 0.5 * source * f_n
    by_0 = 1.0 / (thickness[0] * thickness[0] * thickness[0])
    by_n = 1.0 / (thickness[n] * thickness[n] * thickness[n])
    return rise * by_0, -1.25 * f_0 * by_0, -fall * by_n, -1.25 * f_n * by_n


@jit
def _slope(rate, steep, across, moved, change):
    """Return the derivative of P' at an end by its place: P'' once P' is 0, that of the last step
    where it may be believed. across: of P' by a pressure there [1/rad]; moved: the end by the last
    step [rad]; change: of P' by that."""
    expected = max(0.0, steep) + abs(rate) * across
    if abs(moved) > _SECANT:
        seen = change / moved
        if 0.2 * expected < seen < 50.0 * expected:
            return seen
    return expected


@jit_not_inlined
def _ruptured(film, bound, first, last, most, work):
    """Return the `Zone` within a `Bound` by steps of Newton's method from two ends on, until none
    of them is above `most` [rad]; its pressure is filled into `work`."""
    stiff = math.sqrt(film.a) + 1.0
    is_first_free = is_last_free = False
    moved_first = moved_last = rise_before = fall_before = 0.0
    for _ in range(_ITERATIONS):
        rise, rise_steep, fall, fall_steep = fill_pressure(film, first, last, work)
        across = stiff + 2.0 / (last - first)
        by_first = _slope(rise, rise_steep, across, moved_first, rise - rise_before)
        by_last = _slope(fall, fall_steep, across, moved_last, fall - fall_before)
        begin = first - rise / by_first if by_first > 0.0 else first
        end = last - fall / by_last if by_last > 0.0 else last
        is_first_free = bound.low[0] < begin < bound.low[1]
        is_last_free = bound.high[0] < end < bound.high[1]
        begin = min(bound.low[1], max(bound.low[0], begin))
        end = min(bound.high[1], max(bound.high[0], end))
        moved_first, moved_last = begin - first, end - last
        if max(abs(moved_first), abs(moved_last)) <= most:
            break
        first, last = begin, end
        rise_before, fall_before = rise, fall
    return Zone(first, last, is_first_free, is_last_free)


@jit_not_inlined
def solve_zone(film, bound, work):
    """Return the `Zone` within a `Bound`, its pressure filled into `work`: on a few elements first,
    then on all."""
    few = Film(
        *(film.D, film.S, film.a, film.floor, film.first, film.last, film.is_whole),
        *(film.is_full, max(_FEW, film.n // 4), film.ambient),
    )
    near = _ruptured(few, bound, bound.low[1], bound.high[0], _NEAR, work)
    return _ruptured(film, bound, near.first, near.last, _CONVERGED, work)


@jit_not_inlined
def zone_load(film, zone, work):
    """Return the integral of P exp(i theta) over the solved zone [1/s]."""
    at = vectors(film, work)
    x = y = 0.0
    for i in range(1, film.n):
        x += at.P[i] * at.cosine[i]
        y += at.P[i] * at.sine[i]
    step = (zone.last - zone.first) / film.n
    return complex(x * step, y * step)


class Gradient(NamedTuple):
    """Of a real number: g such that it changes by Re(conj(g) dD), likewise by dS, and its
    derivatives by the ends of the zone."""

    by_D: complex
    by_S: complex
    by_first: float
    by_last: float


@jit_not_inlined
def gradient(film, zone, work):
    """Return the `Gradient` of the residuals' sum, weighted with minus the adjoint, the pressure
    kept; the adjoint's ends are weights too."""
    n, D, S = film.n, film.D, film.S
    cosine, sine, thickness, slope, bend, P, _, adjoint = vectors(film, work)
    step = (zone.last - zone.first) / n
    share = 1.0 / n
    D_x = D_y = S_x = S_y = by_first = by_last = stretched = 0.0
    before = 0.0
    for i in range(n + 1):
        h = thickness[i]
        after, weight = 0.0, 0.5 * step
        if i < n:
            mean = 0.5 * (h + thickness[i + 1])
            after = (P[i + 1] - P[i]) * (adjoint[i + 1] - adjoint[i]) / step * mean * mean
            stretched -= after * mean
            after *= 1.5
            weight = 0.5 * step if i == 0 else step
        f = cosine[i] * S.real + sine[i] * S.imag
        loaded = weight * adjoint[i]
        stretched += loaded * (film.a * h * h * h * P[i] - 1.25 * slope[i] * f)
        of_f = -1.25 * loaded
        of_h = (before + after + 3.0 * loaded * film.a * h * h * P[i]) * slope[i]
        of_h += of_f * bend[i] * f
        of_f *= slope[i]
        before = after
        D_x += of_h * cosine[i]
        D_y += of_h * sine[i]
        S_x -= of_f * cosine[i]
        S_y -= of_f * sine[i]
        turned = of_h * (D.real * sine[i] - D.imag * cosine[i])
        turned += of_f * (S.imag * cosine[i] - S.real * sine[i])
        by_first -= turned * (1.0 - i * share)
        by_last -= turned * i * share
    stretched *= share / step
    return Gradient(complex(D_x, D_y), complex(S_x, S_y), by_first + stretched, by_last - stretched)


@jit_not_inlined
def solve_adjoint(film, zone, work):
    """Overwrite the adjoint by what the matrix of the pressure makes of it; its ends stay."""
    n = film.n
    at = vectors(film, work)
    thickness, inverse, adjoint = at.thickness, at.inverse, at.adjoint
    per = n / (zone.last - zone.first)
    left = per * conductance(thickness[0], thickness[1])
    for i in range(1, n):
        adjoint[i] = (adjoint[i] + left * adjoint[i - 1]) * inverse[i]
        left = per * conductance(thickness[i], thickness[i + 1])
    for i in range(n - 1, 0, -1):
        right = per * conductance(thickness[i], thickness[i + 1])
        adjoint[i] += right * inverse[i] * adjoint[i + 1]


@jit_not_inlined
def _of_load(film, zone, work, is_y):
    """Return the `Gradient` of the load's x or y."""
    n = film.n
    cosine, sine, _, _, _, P, _, adjoint = vectors(film, work)
    step = (zone.last - zone.first) / n
    total = by_first = by_last = 0.0
    adjoint[0] = 0.0
    adjoint[n] = 0.0
    for i in range(1, n):
        along = sine[i] if is_y else cosine[i]
        turned = P[i] * step * (cosine[i] if is_y else -sine[i])
        adjoint[i] = step * along
        total += P[i] * along
        by_first += turned * (1.0 - i / n)
        by_last += turned * (i / n)
    solve_adjoint(film, zone, work)
    g = gradient(film, zone, work)
    stretched = total / n
    return Gradient(
        g.by_D, g.by_S, g.by_first + by_first - stretched, g.by_last + by_last + stretched
    )


@jit_not_inlined
def _of_end(film, zone, work, is_last):
    """Return the `Gradient` of the flow at a free end, which is 0 there."""
    n = film.n
    adjoint = vectors(film, work).adjoint
    for i in range(n + 1):
        adjoint[i] = 0.0
    adjoint[n if is_last else 0] = -1.0
    solve_adjoint(film, zone, work)
    return gradient(film, zone, work)


@jit
def _follow(g, of_first, of_last, zone):
    """Return the gradient by D and S of a number whose own is g, the free ends following so that
    their flows remain 0."""
    first = last = 0.0  # weights of the flows' gradients
    if zone.is_first_free and zone.is_last_free:
        scale = 1.0 / (of_first.by_first * of_last.by_last - of_first.by_last * of_last.by_first)
        first = (g.by_first * of_last.by_last - g.by_last * of_last.by_first) * scale
        last = (g.by_last * of_first.by_first - g.by_first * of_first.by_last) * scale
    elif zone.is_first_free:
        first = g.by_first / of_first.by_first
    elif zone.is_last_free:
        last = g.by_last / of_last.by_last
    by_D = g.by_D - first * of_first.by_D - last * of_last.by_D
    return by_D, g.by_S - first * of_first.by_S - last * of_last.by_S


@jit_not_inlined
def zone_tangent(film, zone, work):
    """Return the derivative of `zone_load` as pairs p z + q conj(z), by D and by S: p_D, q_D, p_S,
    q_S."""
    none = Gradient(0.0j, 0.0j, 0.0, 0.0)
    of_first = of_last = none
    if zone.is_first_free:
        of_first = _of_end(film, zone, work, False)
    if zone.is_last_free:
        of_last = _of_end(film, zone, work, True)
    x_D, x_S = _follow(_of_load(film, zone, work, False), of_first, of_last, zone)
    y_D, y_S = _follow(_of_load(film, zone, work, True), of_first, of_last, zone)
    return pairs_of(x_D, x_S, y_D, y_S)


@jit
def pairs_of(x_D, x_S, y_D, y_S):
    """Return gradients of the load's x and y by D and S as pairs p z + q conj(z): p_D, q_D, p_S,
    q_S."""
    return (
        0.5 * (x_D.conjugate() + 1j * y_D.conjugate()),
        0.5 * (x_D + 1j * y_D),
        0.5 * (x_S.conjugate() + 1j * y_S.conjugate()),
        0.5 * (x_S + 1j * y_S),
    )
