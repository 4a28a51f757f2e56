"""A film that fills all of a pad, whose pressures below rupture are neglected (Guembel's
condition).

Reynolds' equation of `zone_pressure` holds from edge to edge, or all around a whole circle; then
pressures below that of rupture are neglected (the half-Sommerfeld solution of a long plain bearing
that is fed at the pressure of rupture). Between nodes the pressure is linear, so that the load
changes smoothly when it changes its sign. In a film that is fed at a higher pressure, which
ruptures in the middle of its length first, the part below rupture is cut off across the length.
"""

import math

from ..kernels.jit import jit, jit_not_inlined
from .load_derivatives import ADJOINTS, OF_X, OF_Y, clear_ends, gradients, pairs_of, solve_adjoints
from .zone_pressure import SOURCE, Zone, conductance, fill_pressure, vectors


@jit_not_inlined
def solve_full(film, work):
    """Return the `Zone` of a film that fills its pad, its pressure filled into `work`."""
    zone = Zone(film.first, film.last, False, False)
    fill_pressure(film, film.first, film.last, work)
    if film.is_whole:
        _close(film, zone, work)
    return zone


@jit
def _ends(film, zone, work):
    """Return the flows from the first and the last node but one, for a unit pressure each."""
    h, per = vectors(film, work).thickness, film.n / (zone.last - zone.first)
    return per * conductance(h[0], h[1]), per * conductance(h[film.n - 1], h[film.n])


@jit_not_inlined
def _close(film, zone, work):
    """Make the pressure periodic: add a multiple of the solution that is 1 at both ends such that
    the flows balance there. inverse[0]: inverse of the flow of that solution."""
    n = film.n
    at = vectors(film, work)
    step = (zone.last - zone.first) / n
    for i in range(ADJOINTS * (n + 1)):
        at.adjoint[i] = 0.0
    at.adjoint[0] = at.adjoint[ADJOINTS * n] = 1.0
    solve_adjoints(film, zone, work)
    first, last = _ends(film, zone, work)
    cube = at.thickness[0] * at.thickness[0] * at.thickness[0]
    out = first * (1.0 - at.adjoint[ADJOINTS]) + last * (1.0 - at.adjoint[ADJOINTS * (n - 1)])
    at.inverse[0] = 1.0 / (out + film.a * step * cube)
    f = at.slope[0] * (at.cosine[0] * film.S.real + at.sine[0] * film.S.imag)
    joint = first * at.P[1] + last * at.P[n - 1] + SOURCE * step * f
    joint *= at.inverse[0]
    for i in range(n + 1):
        at.P[i] += joint * at.adjoint[ADJOINTS * i]


@jit
def _share(before, after, along, along_after):
    """Return the integral over an element, of length 1, of the positive part of a pressure times a
    direction, both linear, and its derivatives by the pressures at both ends."""
    if before <= 0.0 and after <= 0.0:
        return 0.0, 0.0, 0.0
    if before >= 0.0 and after >= 0.0:
        by_before = (2.0 * along + along_after) / 6.0
        by_after = (along + 2.0 * along_after) / 6.0
        return before * by_before + after * by_after, by_before, by_after
    if before < 0.0:
        total, by_after, by_before = _falling(after, before, along_after, along)
        return total, by_before, by_after
    return _falling(before, after, along, along_after)


@jit
def _falling(high, low, along, along_low):
    """Return `_share` of a pressure that falls from above 0 to below it."""
    t = high / (high - low)
    change = (along_low - along) / 6.0
    total = t * high * (0.5 * along + t * change)
    by_high = t * (2.0 - t) * 0.5 * along + t * t * (3.0 - 2.0 * t) * change
    return total, by_high, t * t * (0.5 * along + 2.0 * t * change)


@jit
def _along_the_length(P, ambient):
    """Return 3/2 of the mean along the length of a parabola of the middle P that is cut off at
    -ambient, and its derivative by P."""
    if -ambient <= P:
        return P, 1.0
    cut = math.sqrt(1.0 + ambient / P)  # so far from the middle, of half the length
    slope = 1.0 - 1.5 * cut + 0.5 * cut * cut * cut
    return P * slope - 1.5 * ambient * cut, slope


@jit_not_inlined
def full_load(film, zone, work):
    """Return the integral of P exp(i theta) over the solved film [1/s], P limited to that of
    rupture from below."""
    at, ambient = vectors(film, work), film.ambient
    x = y = 0.0
    for i in range(film.n):
        if ambient > 0.0:
            P = _along_the_length(at.P[i], ambient)[0]  # of a pad 0 at both edges
            x += P * at.cosine[i]
            y += P * at.sine[i]
        else:
            P, after = at.P[i], at.P[i + 1]
            x += _share(P, after, at.cosine[i], at.cosine[i + 1])[0]
            y += _share(P, after, at.sine[i], at.sine[i + 1])[0]
    step = (zone.last - zone.first) / film.n
    return complex(x * step, y * step)


@jit_not_inlined
def _weigh(film, zone, work):
    """Fill in the derivatives of the load's x and y by the pressures."""
    at, ambient = vectors(film, work), film.ambient
    adjoint = at.adjoint
    step = (zone.last - zone.first) / film.n
    for column in (OF_X, OF_Y):
        along = at.sine if column == OF_Y else at.cosine
        adjoint[column] = 0.0
        for i in range(film.n):
            k = ADJOINTS * i + column
            if ambient > 0.0:
                adjoint[k] = step * _along_the_length(at.P[i], ambient)[1] * along[i]
                adjoint[k + ADJOINTS] = 0.0
            else:
                _, by, by_after = _share(at.P[i], at.P[i + 1], along[i], along[i + 1])
                adjoint[k] += step * by
                adjoint[k + ADJOINTS] = step * by_after


@jit_not_inlined
def full_tangent(film, zone, work):
    """Return the derivative of `full_load`, as `load_derivatives.zone_tangent`."""
    n, at = film.n, vectors(film, work)
    adjoint = at.adjoint
    for i in range(ADJOINTS * (n + 1)):
        adjoint[i] = 0.0
    _weigh(film, zone, work)
    joint_x = joint_y = 0.0
    if film.is_whole:
        end = ADJOINTS * n
        x, y = adjoint[OF_X] + adjoint[end + OF_X], adjoint[OF_Y] + adjoint[end + OF_Y]
        clear_ends(film, work)
        solve_adjoints(film, zone, work)
        first, last = _ends(film, zone, work)
        near, far = ADJOINTS, ADJOINTS * (n - 1)
        joint_x = x + first * adjoint[near + OF_X] + last * adjoint[far + OF_X]
        joint_y = y + first * adjoint[near + OF_Y] + last * adjoint[far + OF_Y]
        joint_x *= at.inverse[0]
        joint_y *= at.inverse[0]
        _weigh(film, zone, work)
    clear_ends(film, work)
    adjoint[OF_X] = adjoint[ADJOINTS * n + OF_X] = joint_x
    adjoint[OF_Y] = adjoint[ADJOINTS * n + OF_Y] = joint_y
    solve_adjoints(film, zone, work)
    x, y = gradients(film, zone, work, OF_X)
    return pairs_of(x.by_D, x.by_S, y.by_D, y.by_S)
