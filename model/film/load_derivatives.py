"""Derivatives of a zone's load: one adjoint solution each for its x, its y and the flows at its
free ends, all four at once, with the factors of the pressure's own matrix (`zone_pressure`)."""

from typing import NamedTuple

from ..kernels.functions import scaled
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
def gradients(film, zone, work, column):
    """Return two `Gradient`s, of the sum of the residuals, weighted with minus the adjoint `column`
    and the next one, at constant pressure; the adjoints' ends are weights too. The two are the
    parts of complex numbers, which a processor computes at once."""
    n, D, S = film.n, film.D, film.S
    cosine, sine, thickness, slope, bend, P, _, adjoint = vectors(film, work)
    step = (zone.last - zone.first) / n
    share, per = 1.0 / n, 1.0 / step
    D_x = D_y = S_x = S_y = by_first = by_last = stretched = before = 0.0j
    by_next = complex(adjoint[column], adjoint[column + 1])
    for i in range(n + 1):
        h, by_residual = thickness[i], by_next
        after, weight = 0.0j, 0.5 * step
        if i < n:
            mean, next_one = 0.5 * (h + thickness[i + 1]), ADJOINTS * (i + 1) + column
            by_next = complex(adjoint[next_one], adjoint[next_one + 1])
            after = scaled(per, scaled(P[i + 1] - P[i], by_next - by_residual))
            after = scaled(mean, scaled(mean, after))
            stretched -= scaled(mean, after)
            after = scaled(1.5, after)
            weight = 0.5 * step if i == 0 else step
        f = cosine[i] * S.real + sine[i] * S.imag
        loaded = scaled(weight, by_residual)
        stretched += scaled(film.a * h * h * h * P[i] - SOURCE * slope[i] * f, loaded)
        of_f = scaled(-SOURCE, loaded)
        by_h = scaled(h, scaled(h, scaled(film.a, scaled(3.0, loaded))))
        of_h = scaled(slope[i], before + after + scaled(P[i], by_h))
        of_h += scaled(f, scaled(bend[i], of_f))
        of_f = scaled(slope[i], of_f)
        before = after
        D_x += scaled(cosine[i], of_h)
        D_y += scaled(sine[i], of_h)
        S_x -= scaled(cosine[i], of_f)
        S_y -= scaled(sine[i], of_f)
        turned = scaled(D.real * sine[i] - D.imag * cosine[i], of_h)
        turned += scaled(S.imag * cosine[i] - S.real * sine[i], of_f)
        by_first -= scaled(1.0 - i * share, turned)
        by_last -= scaled(share, scaled(float(i), turned))
    stretched = scaled(share / step, stretched)
    by_first, by_last = by_first + stretched, by_last - stretched
    return (
        Gradient(
            *(complex(D_x.real, D_y.real), complex(S_x.real, S_y.real)),
            *(by_first.real, by_last.real),
        ),
        Gradient(
            *(complex(D_x.imag, D_y.imag), complex(S_x.imag, S_y.imag)),
            *(by_first.imag, by_last.imag),
        ),
    )


@jit_not_inlined
def solve_adjoints(film, zone, work):
    """Overwrite the adjoints by solutions with the pressure's matrix; their ends are given."""
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
def _of_load(film, zone, work):
    """Return the `Gradient`s of the load's x and y."""
    n = film.n
    cosine, sine, _, _, _, P, _, _ = vectors(film, work)
    step = (zone.last - zone.first) / n
    total = by_first = by_last = 0.0j  # of x and y
    for i in range(1, n):
        along = complex(cosine[i], sine[i])
        turned = scaled(P[i] * step, complex(-sine[i], cosine[i]))
        total += scaled(P[i], along)
        by_first += scaled(1.0 - i / n, turned)
        by_last += scaled(i / n, turned)
    x, y = gradients(film, zone, work, OF_X)
    stretched = complex(total.real / n, total.imag / n)
    return (
        Gradient(
            *(x.by_D, x.by_S, x.by_first + by_first.real - stretched.real),
            x.by_last + by_last.real + stretched.real,
        ),
        Gradient(
            *(y.by_D, y.by_S, y.by_first + by_first.imag - stretched.imag),
            y.by_last + by_last.imag + stretched.imag,
        ),
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
    if zone.is_first_free or zone.is_last_free:
        of_first, of_last = gradients(film, zone, work, OF_FIRST)
    x, y = _of_load(film, zone, work)
    x_D, x_S = _with_free_ends(x, of_first, of_last, zone)
    y_D, y_S = _with_free_ends(y, of_first, of_last, zone)
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
