"""Derivatives of a zone's load: one adjoint solution each for its x, its y and the flows at its
free ends, with the factors of the pressure's own matrix (`film_zone`)."""

from __future__ import annotations

from typing import NamedTuple

from ..kernels.jit import jit, jit_not_inlined
from .film_zone import conductance, vectors


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
