"""Integrals over a film in closed form, between any two angles: Ocvirk's film, and its shear.

In Sommerfeld's angle gamma about the thinnest film, cos(theta) = (e + cos(gamma)) / (1 + e
cos(gamma)), the integrands over H = 1 - e cos(theta) are polynomials of cos(gamma) and sin(gamma).
"""

import math
from typing import NamedTuple

from ..kernels.functions import angle, direction, modulus
from ..kernels.jit import jit, jit_not_inlined
from .zone_pressure import floored

_ROUND = 2.0 * math.pi - 1e-9


class Sommerfeld(NamedTuple):
    """Two angles of a film in Sommerfeld's substitution: eccentricity e [1], sqrt(1 - e^2), the
    direction of the thinnest film, sine and cosine of both angles gamma, and their difference
    [rad]."""

    e: float
    root: float
    along: complex
    sine_0: float
    cosine_0: float
    sine_1: float
    cosine_1: float
    swept: float


@jit_not_inlined
def sommerfeld(D, first, last):
    """Return the `Sommerfeld` of a displacement D over the clearance, below 1 in size, and of the
    angles `first` and `last` [rad]."""
    e = modulus(D)
    along = D * (1.0 / e) if e > 0.0 else 1.0 + 0.0j
    root = math.sqrt(1.0 - e * e)
    low, high = along.conjugate() * direction(first), along.conjugate() * direction(last)
    h_0, h_1 = 1.0 / (1.0 - e * low.real), 1.0 / (1.0 - e * high.real)
    c_0, s_0 = (low.real - e) * h_0, root * low.imag * h_0
    c_1, s_1 = (high.real - e) * h_1, root * high.imag * h_1
    swept = angle(complex(c_1, s_1) * complex(c_0, -s_0))
    if swept < 0.0:
        swept += 2.0 * math.pi
    if last - first > _ROUND:
        swept = 2.0 * math.pi
    return Sommerfeld(e, root, along, s_0, c_0, s_1, c_1, swept)


@jit
def blunted(D, floor):
    """Return D shortened so that a film of the thickness `floor` remains, and the factors of its
    changes along D and across it."""
    e = modulus(D)
    at = floored(1.0 - e, floor)
    if at.slope == 1.0:
        return D, 1.0, 1.0
    share = (1.0 - at.thickness) / e
    return D * share, at.slope, share


@jit
def shear(D, first, last):
    """Return the integrals of 1 / H and of 1 / H^2 between two angles [1]."""
    g = sommerfeld(D, first, last)
    square = (g.swept + g.e * (g.sine_1 - g.sine_0)) / (g.root * g.root * g.root)
    return g.swept / g.root, square


@jit_not_inlined
def short_load(D, S, floor, first, last):
    """Return the integral of f exp(i theta) / H^3 between two angles [1/s], see `zone_pressure`,
    and its derivative as pairs p z + q conj(z), by D and by S: load, p_D, q_D, p_S, q_S. The angles
    are constant, or f is 0 there."""
    D, radially, across = blunted(D, floor)
    g = sommerfeld(D, first, last)
    e, s_0, c_0, s_1, c_1 = g.e, g.sine_0, g.cosine_0, g.sine_1, g.cosine_1
    sines = s_1 - s_0
    cubes = (s_1 * s_1 * s_1 - s_0 * s_0 * s_0) / 3.0
    cosine_square = 0.5 * (g.swept + (s_1 * c_1 - s_0 * c_0))
    sine_square = g.swept - cosine_square
    b_0, b_1 = e + c_0, e + c_1
    r = g.root
    third = 1.0 / (r * r * r * r * r * r)
    fourth = third / (r * r)
    cc = r * third * (e * e * g.swept + 2.0 * e * sines + cosine_square)
    cs = 0.5 * r * r * third * (b_0 * b_0 - b_1 * b_1)
    ss = r * r * r * third * sine_square
    ccc = e * e * e * g.swept + 3.0 * e * e * sines + 3.0 * e * cosine_square + (sines - cubes)
    ccc *= 3.0 * r * fourth
    ccs = r * r * fourth * (b_0 * b_0 * b_0 - b_1 * b_1 * b_1)
    css = 3.0 * r * r * r * fourth * (e * sine_square + cubes)
    sss = r * r * r * r * fourth * (3.0 * (c_0 - c_1) + (c_1 * c_1 * c_1 - c_0 * c_0 * c_0))
    f = g.along.conjugate() * S
    a, b = f.real, f.imag
    load = g.along * complex(a * cc + b * cs, a * cs + b * ss)
    xx, xy = (a * ccc + b * ccs) * radially, (a * ccs + b * css) * across
    yx, yy = (a * ccs + b * css) * radially, (a * css + b * sss) * across
    turn = g.along * g.along
    return (
        load,
        0.5 * complex(xx + yy, yx - xy),
        0.5 * complex(xx - yy, yx + xy) * turn,
        0.5 * complex(cc + ss, 0.0),
        complex(0.5 * (cc - ss), cs) * turn,
    )
