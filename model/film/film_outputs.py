"""Torque, flow and maximum pressure of an oil film at an instant."""

import math
from typing import NamedTuple

from ..kernels.functions import angle, direction
from ..kernels.jit import jit, jit_not_inlined
from .bearing_film import TURNS, pad_count, pad_of, short_share, thinnest
from .short_film import blunted, shear, short_load, sommerfeld
from .solved_zone import solved
from .zone_pressure import SOURCE, conductance, floored, vectors, zone_bound

_PEAK_STEPS = 96  # for 1e-3 of the largest pressure
_SHORTEST = 1e-9  # arc that differs from none by more than rounding [rad]


class FilmState(NamedTuple):
    """State of a film at an instant: force on the journal [N], torque that brakes it [N.m], the
    smallest film thickness [m] and its angle [rad], largest pressure [Pa] and side flow [m3/s], if
    they were asked for, and the power with which it tilts its pads [W]."""

    force: complex
    torque: float
    thinnest: float
    where: float
    largest: float
    flow: float
    tilted: float


@jit_not_inlined
def _sheared(D, upstream, first, last):
    """Return the integral of the shear over a ruptured arc [1], whose film consists of strips as
    wide as at the angle `upstream`, and as the gap where that is thinner."""
    if last - first <= _SHORTEST:
        return 0.0
    at = direction(upstream)
    thickness = 1.0 - (at.conjugate() * D).real
    sheared = thickness * shear(D, first, last)[1]
    thinner = abs(angle(at.conjugate() * D))
    for turn in range(2):
        middle = first + angle(direction(-first) * D) + 2.0 * math.pi * turn
        begin, end = max(first, middle - thinner), min(last, middle + thinner)
        if end - begin > _SHORTEST:
            full, strips = shear(D, begin, end)
            sheared += full - thickness * strips
    return sheared


@jit
def _short_pressure(film, share, e):
    """Return the pressure P of Ocvirk's film in a direction e [1/s]."""
    h = floored(1.0 - (e.conjugate() * film.D).real, film.floor).thickness
    return share * (e.conjugate() * film.S).real / (h * h * h)


@jit_not_inlined
def _short_peak(film, share, D, first, last):
    """Return the largest pressure P of Ocvirk's film between two angles [1/s], 0 at least; D: of
    the film no thinner than its floor. It is looked for in equal steps of Sommerfeld's angle, which
    are short where the film is thin."""
    span, peak = sommerfeld(D, first, last), 0.0
    for j in range(_PEAK_STEPS + 1):
        gamma = complex(span.cosine_0, span.sine_0) * direction(span.swept * j / _PEAK_STEPS)
        thinness = 1.0 / (1.0 + span.e * gamma.real)
        at = complex((gamma.real + span.e) * thinness, span.root * gamma.imag * thinness)
        peak = max(peak, _short_pressure(film, share, span.along * at))
    return peak


@jit
def _driven(film, at, inner, outer, step):
    """Return the flow H^3 P' at a node without pressure [1/s], out of the film that ends there:
    that between the nodes, and half a cell of the source 1.25 f (`zone_pressure`)."""
    f = at.cosine[outer] * film.S.real + at.sine[outer] * film.S.imag
    passes = conductance(at.thickness[inner], at.thickness[outer])
    return passes * (at.P[inner] - at.P[outer]) / step + 0.5 * SOURCE * step * at.slope[outer] * f


@jit
def _passed_on(film, at, j, step):
    """Return what the ends of a film beside node j, if there are, add to the integral of H^3 P that
    gives its side flow [1/s]. A parabola is too flat at the sides of a film that its ends cut off;
    what leaves there is what enters less what the ends pass on."""
    driven = 0.0
    if j > 0 and at.P[j - 1] <= 0.0:
        driven += _driven(film, at, j, j - 1, step)
    if at.P[j + 1] <= 0.0:
        driven += _driven(film, at, j, j + 1, step)
    return driven / (6.0 * film.a)


@jit_not_inlined
def film_state(bearing, tables, kinematics, with_pressure):
    """Return the `FilmState` of a bearing; with_pressure: with pressure and flow, which only
    outputs need and which take most of the time."""
    force = 0.0j
    torque = flow = largest = tilted = 0.0
    least, where = math.inf, 1.0 + 0.0j
    R, L, speed = bearing.journal_radius, bearing.length, kinematics.speed
    share = short_share(bearing)
    for i in range(pad_count(bearing, tables)):
        pad, work = pad_of(bearing, tables, kinematics, i)
        film = pad.film
        gap, direct, _ = thinnest(pad)
        if gap < least:
            least, where = gap, direct
        D, _, _ = blunted(film.D, film.floor)
        volume = pad.clearance * pad.clearance * pad.clearance
        sheared, load = 0.0, 0.0j
        reached, begun = film.first, film.last
        upstream = reached if speed >= 0.0 else begun
        if film.S != 0.0:
            sense = angle(film.S)
            for turn in TURNS:
                acts, bound = zone_bound(film, sense, turn)
                if not acts:
                    continue
                first, last = bound.low[1], bound.high[0]
                if bearing.short > 0.0:
                    load += share * short_load(film.D, film.S, film.floor, first, last)[0]
                else:
                    zone, borne = solved(film, bound, work)
                    load += borne
                    first, last = zone.first, zone.last
                if with_pressure and bearing.short > 0.0:
                    peak = _short_peak(film, share, D, first, last)
                    largest = max(largest, pad.pressure * peak)
                    # h^3 P is a cosine, which does not vanish at the edges of a pad
                    ends = direction(last) - direction(first)
                    flow += volume * pad.pressure * share * (1j * film.S * ends.conjugate()).real
                elif with_pressure:
                    step = (last - first) / film.n
                    at = vectors(film, work)
                    for j in range(0 if film.is_full else 1, film.n):
                        P, h = pad.pressure * at.P[j], at.thickness[j]
                        if film.is_full:
                            P = max(P, 0.0)
                        largest = max(largest, P)
                        flow += volume * P * h * h * h * step
                        if P > 0.0:
                            flow += volume * pad.pressure * _passed_on(film, at, j, step)
                sheared += shear(D, first, last)[0]
                if film.is_whole:
                    reached, begun = last, first + 2.0 * math.pi
                    # lubricant leaves where the film is thinner: at the other end in a fast whirl
                    ends = direction(last) - direction(first)
                    upstream = last if (ends.conjugate() * D).real >= 0.0 else begun
                else:
                    sheared += _sheared(D, reached if speed >= 0.0 else first, reached, first)
                    reached = last
                    upstream = last if speed >= 0.0 else begun
        sheared += _sheared(D, upstream, reached, begun)
        load *= pad.load
        force -= load
        tilted -= (load * (pad.velocity - kinematics.velocity).conjugate()).real
        torque += bearing.viscosity * R * R * R * L / pad.clearance * speed * sheared
        torque += 0.5 * (pad.displacement * load.conjugate()).imag
    # the side flow is 2 / 3 R / (mu L) times the integral of h^3 p
    flow *= 2.0 * R / (3.0 * bearing.viscosity * L)
    return FilmState(force, torque, least, angle(where), largest, flow, tilted)
