"""Derivatives of a zone's load: one adjoint solution each for its x, its y and the flows at its
free ends, all four at once, with the factors of the pressure's own matrix (`zone_pressure`)."""

from typing import NamedTuple

from ..kernels.jit import jit, jit_not_inlined
from .zone_pressure import SOURCE, conductance, vectors

ADJOINTS = 4  # of the load's x and y, and of the flows at the first and the last end
OF_X, OF_Y, OF_FIRST, OF_LAST = range(ADJOINTS)


class Gradient(NamedTuple):
    """Gradient g of a real number, which changes by Re(conj(g) dD), likewise by dS, and its
    derivatives by the ends of the zone."""

    by_D: complex
    by_S: complex
    by_first: float
    by_last: float


@jit_not_inlined
def gradient(film, zone, work, column):
    """Return the `Gradient` of the sum of the residuals, weighted with minus the adjoint `column`,
    at constant pressure; the adjoint's ends are weights too."""
    n, D, S = film.n, film.D, film.S
    cosine, sine, thickness, slope, bend, P, _, adjoint = vectors(film, work)
    step = (zone.last - zone.first) / n
    share, per = 1.0 / n, 1.0 / step
    D_x = D_y = S_x = S_y = by_first = by_last = stretched = 0.0
    before = 0.0
    for i in range(n + 1):
        h = thickness[i]
        by_residual = adjoint[ADJOINTS * i + column]
        after, weight = 0.0, 0.5 * step
        if i < n:
            mean = 0.5 * (h + thickness[i + 1])
            change = adjoint[ADJOINTS * (i + 1) + column] - by_residual
            after = (P[i + 1] - P[i]) * change * per * mean * mean
            stretched -= after * mean
            after *= 1.5
            weight = 0.5 * step if i == 0 else step
        f = cosine[i] * S.real + sine[i] * S.imag
        loaded = weight * by_residual
        stretched += loaded * (film.a * h * h * h * P[i] - SOURCE * slope[i] * f)
        of_f = -SOURCE * loaded
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
def solve_adjoints(film, zone, work):
    """Overwrite the adjoints by the solutions with the pressure's matrix; their ends are boundary
    values."""
    n = film.n
    at = vectors(film, work)
    thickness, inverse, adjoint = at.thickness, at.inverse, at.adjoint
    per = n / (zone.last - zone.first)
    middle = n // 2
    left = per * conductance(thickness[0], thickness[1])
    right = per * conductance(thickness[n - 1], thickness[n])
    for i in range(1, n - middle):
        k = n - i
        if i < middle:
            _eliminate_node(adjoint, i, i - 1, left, inverse[i])
            left = per * conductance(thickness[i], thickness[i + 1])
        _eliminate_node(adjoint, k, k + 1, right, inverse[k])
        right = per * conductance(thickness[k - 1], thickness[k])
    for column in range(ADJOINTS):
        at_middle = ADJOINTS * middle + column
        total = adjoint[at_middle] + left * adjoint[at_middle - ADJOINTS]
        adjoint[at_middle] = (total + right * adjoint[at_middle + ADJOINTS]) * inverse[middle]
    for i in range(middle + 1, n):
        share = per * conductance(thickness[i - 1], thickness[i]) * inverse[i]
        _substitute_back(adjoint, i, i - 1, share)
        k = 2 * middle - i
        if k > 0:
            share = per * conductance(thickness[k], thickness[k + 1]) * inverse[k]
            _substitute_back(adjoint, k, k + 1, share)


@jit
def _eliminate_node(adjoint, i, before, flow, inverse):
    """Eliminate the node `before` from the adjoints' equations at node i."""
    for column in range(ADJOINTS):
        at = ADJOINTS * i + column
        adjoint[at] = (adjoint[at] + flow * adjoint[ADJOINTS * before + column]) * inverse


@jit
def _substitute_back(adjoint, i, after, share):
    """Add to the adjoints at node i the contribution of the node `after`."""
    for column in range(ADJOINTS):
        adjoint[ADJOINTS * i + column] += share * adjoint[ADJOINTS * after + column]


@jit
def clear_ends(film, work):
    """Set the adjoints to 0 at both ends."""
    adjoint = vectors(film, work).adjoint
    for column in range(ADJOINTS):
        adjoint[column] = adjoint[ADJOINTS * film.n + column] = 0.0


@jit_not_inlined
def _fill_adjoints(film, zone, work):
    """Fill in the adjoints of a solved zone."""
    n = film.n
    cosine, sine, _, _, _, _, _, adjoint = vectors(film, work)
    step = (zone.last - zone.first) / n
    clear_ends(film, work)
    adjoint[OF_FIRST] = adjoint[ADJOINTS * n + OF_LAST] = -1.0
    for i in range(1, n):
        at = ADJOINTS * i
        adjoint[at + OF_X] = step * cosine[i]
        adjoint[at + OF_Y] = step * sine[i]
        adjoint[at + OF_FIRST] = 0.0
        adjoint[at + OF_LAST] = 0.0
    solve_adjoints(film, zone, work)


@jit_not_inlined
def _of_load(film, zone, work, column):
    """Return the `Gradient` of the load's x or y."""
    n = film.n
    cosine, sine, _, _, _, P, _, _ = vectors(film, work)
    step = (zone.last - zone.first) / n
    total = by_first = by_last = 0.0
    for i in range(1, n):
        along = sine[i] if column == OF_Y else cosine[i]
        turned = P[i] * step * (cosine[i] if column == OF_Y else -sine[i])
        total += P[i] * along
        by_first += turned * (1.0 - i / n)
        by_last += turned * (i / n)
    g = gradient(film, zone, work, column)
    stretched = total / n
    return Gradient(
        g.by_D, g.by_S, g.by_first + by_first - stretched, g.by_last + by_last + stretched
    )


@jit
def _with_free_ends(g, of_first, of_last, zone):
    """Return the gradient by D and S of a number with the gradient g, the free ends moving so that
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
    _fill_adjoints(film, zone, work)
    if zone.is_first_free:
        of_first = gradient(film, zone, work, OF_FIRST)
    if zone.is_last_free:
        of_last = gradient(film, zone, work, OF_LAST)
    x_D, x_S = _with_free_ends(_of_load(film, zone, work, OF_X), of_first, of_last, zone)
    y_D, y_S = _with_free_ends(_of_load(film, zone, work, OF_Y), of_first, of_last, zone)
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
