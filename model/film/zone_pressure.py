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

import math
from typing import NamedTuple

from ..kernels.functions import direction
from ..kernels.jit import jit, jit_not_inlined

SOURCE = 1.25  # factor of f in Reynolds' equation, of the parabola across the length
VECTORS = 11  # vectors of n + 1 numbers in the work array of a zone: `Vectors`
_ITERATIONS = 600  # a few as a rule; hundreds where elements are few and the film thin
_CONVERGED = 1e-10  # of the ends [rad]
_FEW, _NEAR = 8, 1e-2  # elements of the first search for the ends, and its accuracy [rad]
_ONWARD = 1.35  # factor on the correction of an error of second order in the element
_SECANT = 1e-8  # move of an end from which a slope may be taken [rad]
_SHORTEST = 1e-9  # shorter zones at a pad's edge bear no load [rad]
_PI = math.pi


class Gap(NamedTuple):
    """The film's thickness over the clearance [1], which is bounded below where the surfaces are
    rough, and its first and second derivative by the geometric one."""

    thickness: float
    slope: float
    bend: float


@jit
def floored(h, floor):
    """Return the `Gap` of a geometric thickness h: h above twice the floor, and below it a
    transition to 0.8 floor at h = 0, H = 2 floor (1 + x) / (1 + 2 x + 2 x^2) with x = 1 - h / (2
    floor). It is twice continuously differentiable: where the second derivative jumped, the force
    of coarse elements had kinks at which Newton's method cycles."""
    if h >= 2.0 * floor:
        return Gap(h, 1.0, 0.0)
    x = 1.0 - 0.5 * h / floor
    inverse = 1.0 / (1.0 + 2.0 * x * (1.0 + x))
    square = inverse * inverse
    slope = (1.0 + 2.0 * x * (2.0 + x)) * square
    bend = 2.0 * x * (3.0 + 2.0 * x * (3.0 + x)) * square * inverse / floor
    return Gap(2.0 * floor * (1.0 + x) * inverse, slope, bend)


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
    """A piece of a film with pressure: its ends [rad], and whether each is free (a rupture)."""

    first: float
    last: float
    is_first_free: bool
    is_last_free: bool


class Bound(NamedTuple):
    """Bounds of the ends of a zone [rad]; low: the least and most of the first end, high: of the
    last."""

    low: tuple
    high: tuple


@jit
def zone_bound(film, sense, turn):
    """Return whether pressure builds up in the pad in the half circle about the angle `sense`
    [rad], `turn` turns further, and the `Bound` of that zone."""
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
    first and second derivative (`Gap`), pressure, inverses of the pivots; and four adjoints, those
    of a node one after the other."""

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
        *(work[4 * m : 5 * m], work[5 * m : 6 * m], work[6 * m : 7 * m], work[7 * m : 11 * m]),
    )


@jit
def conductance(low, high):
    """Return the flow that a unit gradient drives between films of two thicknesses [1]."""
    mean = 0.5 * (low + high)
    return mean * mean * mean


@jit
def _fill_node(film, nodes, i, along):
    """Fill in the coefficients of Reynolds' equation at a node in the direction `along`."""
    at = floored(1.0 - (along.real * film.D.real + along.imag * film.D.imag), film.floor)
    nodes.cosine[i] = along.real
    nodes.sine[i] = along.imag
    nodes.thickness[i] = at.thickness
    nodes.slope[i] = at.slope
    nodes.bend[i] = at.bend


@jit
def _eliminate(film, nodes, weights, i, offset, before):
    """Eliminate the pressure at node i, next to node i + offset; weights: of a difference, of the
    outflow by the pressure itself, of the source; before, of the node before: the conductance from
    there, the share of this node's pressure in its, and the pressure without that share. Return
    these of this node, for the next one."""
    flow, passed, P = before
    per, mass, source = weights
    ahead = per * conductance(nodes.thickness[i], nodes.thickness[i + offset])
    cube = nodes.thickness[i] * nodes.thickness[i] * nodes.thickness[i]
    nodes.inverse[i] = 1.0 / (flow + ahead + mass * cube - flow * passed)
    f = nodes.cosine[i] * film.S.real + nodes.sine[i] * film.S.imag
    P = (source * nodes.slope[i] * f + flow * P) * nodes.inverse[i]
    nodes.P[i] = P
    return ahead, ahead * nodes.inverse[i], P


@jit_not_inlined
def fill_pressure(film, first, last, work):
    """Fill in the pressure between two angles, 0 at both [1/s]; returns P' and P'' there. The
    elimination goes from both ends to the middle, and back. While it waits for its divisions, the
    processor fills in the coefficients of the next nodes."""
    n, S = film.n, film.S
    nodes = vectors(film, work)
    cosine, sine, thickness, slope, _, P, inverse, _ = nodes
    step = (last - first) / n
    turn = direction(step)
    back = turn.conjugate()
    ahead, behind = direction(first), direction(last)
    for i in range(2):
        _fill_node(film, nodes, i, ahead)
        _fill_node(film, nodes, n - i, behind)
        ahead = ahead * turn
        behind = behind * back
    per, mass, source = weights = (1.0 / step, film.a * step, SOURCE * step)
    P[0] = 0.0
    P[n] = 0.0
    middle = n // 2
    left = (per * conductance(thickness[0], thickness[1]), 0.0, 0.0)
    right = (per * conductance(thickness[n - 1], thickness[n]), 0.0, 0.0)
    for i in range(1, n - middle):
        if i < middle:
            _fill_node(film, nodes, i + 1, ahead)
            _fill_node(film, nodes, n - i - 1, behind)
            ahead = ahead * turn
            behind = behind * back
            left = _eliminate(film, nodes, weights, i, 1, left)
        right = _eliminate(film, nodes, weights, n - i, -1, right)
    h = thickness[middle]
    (flow, above, P_above), (back_flow, below, P_below) = left, right
    inverse[middle] = 1.0 / (
        flow + back_flow + mass * (h * h * h) - flow * above - back_flow * below
    )
    f = cosine[middle] * S.real + sine[middle] * S.imag
    P_above = source * slope[middle] * f + flow * P_above + back_flow * P_below
    P_above *= inverse[middle]
    P_below = P[middle] = P_above
    for i in range(middle + 1, n):
        onward = per * conductance(thickness[i - 1], thickness[i])
        P_above = P[i] + onward * inverse[i] * P_above
        P[i] = P_above
        k = 2 * middle - i
        if k > 0:
            onward = per * conductance(thickness[k], thickness[k + 1])
            P_below = P[k] + onward * inverse[k] * P_below
            P[k] = P_below
    f_0 = slope[0] * (cosine[0] * S.real + sine[0] * S.imag)
    f_n = slope[n] * (cosine[n] * S.real + sine[n] * S.imag)
    rise = per * conductance(thickness[0], thickness[1]) * P[1] + 0.5 * source * f_0
    fall = per * conductance(thickness[n - 1], thickness[n]) * P[n - 1] + 0.5 * source * f_n
    by_0 = 1.0 / (thickness[0] * thickness[0] * thickness[0])
    by_n = 1.0 / (thickness[n] * thickness[n] * thickness[n])
    return rise * by_0, -SOURCE * f_0 * by_0, -fall * by_n, -SOURCE * f_n * by_n


@jit
def _slope(rate, steep, across, moved, change):
    """Return the derivative of P' at an end by its position: P'' once P' is 0, that of the last
    step where it is plausible. across: of P' by a pressure there [1/rad]; moved: the end by the
    last step [rad]; change: of P' by that."""
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
        is_near = max(abs(moved_first), abs(moved_last)) <= most
        if is_near and most <= _CONVERGED:
            break
        first, last = begin, end
        if is_near:  # of a start the pressure is not needed
            break
        rise_before, fall_before = rise, fall
    return Zone(first, last, is_first_free, is_last_free)


@jit
def _with_elements(film, n):
    return Film(
        *(film.D, film.S, film.a, film.floor, film.first, film.last, film.is_whole),
        *(film.is_full, n, film.ambient),
    )


@jit_not_inlined
def solve_zone(film, bound, work):
    """Return the `Zone` within a `Bound`, its pressure filled into `work`: on a few elements first,
    on some more, then on all, from ends extrapolated for an error of second order in the
    element."""
    few = max(_FEW, film.n // 8)
    some = max(2 * few, film.n // 4)
    at = _ruptured(_with_elements(film, few), bound, bound.low[1], bound.high[0], _NEAR, work)
    first, last = at.first, at.last
    if some < film.n:
        at = _ruptured(_with_elements(film, some), bound, first, last, _NEAR, work)
        coarse, fine, finest = 1.0 / (few * few), 1.0 / (some * some), 1.0 / (film.n * film.n)
        onward = _ONWARD * (fine - finest) / (coarse - fine)
        first = at.first + onward * (at.first - first)
        last = at.last + onward * (at.last - last)
        first = min(bound.low[1], max(bound.low[0], first))
        last = min(bound.high[1], max(bound.high[0], last))
    return _ruptured(film, bound, first, last, _CONVERGED, work)


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
