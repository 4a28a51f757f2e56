"""A ring that floats between two films: the forces on it, and how it follows the journal.

The ring is at x, moves with v and turns with w; the journal, at d, turns with the speed omega:

    m v' = F_o - F_i + m g,    J w' = T_i - T_o

F_i: force of the inner film on the journal, at d - x from the ring's centre; F_o: of the outer one
on the ring. A film between two rotating surfaces carries as one whose journal turns with the sum of
their speeds, and is sheared by the difference: the torque that brakes the inner surface and the one
that drives the outer one are

    T = C (difference) -+ Im(z conj(F)) / 2,    C = 2 pi mu R^3 L / (c sqrt(1 - e^2))

for a film at z, full of lubricant all around (Petroff's drag of an eccentric journal).

Changes are pairs of amplitudes (a, b) of z = a exp(i t) + conj(b) exp(-i t), at any frequency; at
frequency 0 b is conj(a), and a matrix of them is the real-linear map p z + q conj(z), p, q its
first row.
"""

import math
from typing import NamedTuple

from ..kernels.functions import inverse, modulus
from ..kernels.jit import jit, jit_not_inlined
from .bearing_film import FilmSlopes, film_force, film_slopes
from .zone_pressure import floored

_TINY = 1e-300


class Sheared(NamedTuple):
    """A film between two rotating surfaces: the journal's position z [m]; force on it [N], p_d,
    q_d, p_v, q_v: see `bearing_film.FilmSlopes`; turned: derivative of the force by the sum of the
    speeds [N.s]; drag: C [N.m.s]; steep: its gradient, it changes by Re(conj(steep) z); difference:
    of the speeds [rad/s]."""

    z: complex
    force: complex
    p_d: complex
    q_d: complex
    p_v: complex
    q_v: complex
    turned: complex
    drag: float
    steep: complex
    difference: float


@jit_not_inlined
def sheared(bearing, tables, moving, has_slopes):
    """Return the `Sheared` film of a journal that is `moving` as `parts.law.Kinematics` say: speed:
    the sum of the speeds of both surfaces, sliding_speed: the difference [rad/s]; has_slopes:
    whether the derivatives of the force are needed, which are 0 without."""
    if has_slopes:
        at = film_slopes(bearing, tables, moving)
    else:
        at = FilmSlopes(film_force(bearing, tables, moving), 0.0j, 0.0j, 0.0j, 0.0j)
    z = moving.displacement
    c, R = bearing.clearance, bearing.journal_radius
    e = modulus(z) / c
    gap = floored(1.0 - e, bearing.roughness / c)
    off = 1.0 - gap.thickness
    inside = 1.0 / (1.0 - off * off)
    drag = 2.0 * math.pi * bearing.viscosity * R * R * R * bearing.length / c * math.sqrt(inside)
    steep = z * (drag * off * inside * gap.slope / (c * c * e)) if e > 0.0 else 0.0j
    half = -0.5j * z  # S = 2 V - i (sum) D
    turned = at.p_v * half + at.q_v * half.conjugate()
    return Sheared(
        *(z, at.force, at.p_d, at.q_d, at.p_v, at.q_v), *(turned, drag, steep, moving.sliding_speed)
    )


@jit
def torque_of(film, side):
    """Return the torque on a surface of a film [N.m]: side -1.0, braking the inner one; 1.0,
    driving the outer one."""
    return film.drag * film.difference + 0.5 * side * (film.z * film.force.conjugate()).imag


class AmplitudeMatrix(NamedTuple):
    """Derivative of a film's force by its position, for amplitudes (a, b)."""

    aa: complex
    ab: complex
    ba: complex
    bb: complex


@jit
def stiffness(film, by_d, by_v):
    """Return the `AmplitudeMatrix` of a film, for a displacement by_d z and a velocity by_v z."""
    return AmplitudeMatrix(
        by_d * film.p_d + by_v * film.p_v,
        by_d * film.q_d + by_v * film.q_v,
        by_d * film.q_d.conjugate() + by_v * film.q_v.conjugate(),
        by_d * film.p_d.conjugate() + by_v * film.p_v.conjugate(),
    )


@jit
def torque_by(film, side, matrix, by_d):
    """Return the derivatives of `torque_of` by the amplitudes a and b, of `stiffness`."""
    back = film.z.conjugate()
    quarter = complex(0.0, -0.25 * side)
    steep = film.steep * (0.5 * film.difference)
    by_a = by_d * (steep.conjugate() + quarter * film.force.conjugate())
    by_b = by_d * (steep - quarter * film.force)
    by_a += quarter * (film.z * matrix.ba - back * matrix.aa)
    by_b += quarter * (film.z * matrix.bb - back * matrix.ab)
    return by_a, by_b


class RingResponse(NamedTuple):
    """Response of a ring to the journal: the derivative of the inner film's force, and the change
    of this force, of the ring's position and of its speed that balances the residual forces on
    it."""

    matrix: AmplitudeMatrix
    force: complex
    moved: complex
    turned: float


@jit
def _solved(A, G, by_a, by_b, spun, over, r_a, r_b, r_w):
    """Return a, b and the change w of the ring's speed that balance the residual r."""
    g, back = G * spun, G.conjugate() * spun
    r_a -= g * r_w
    r_b -= back * r_w
    a = -(A.bb * r_a - A.ab * r_b) * over
    b = -(A.aa * r_b - A.ba * r_a) * over
    return a, b, -(r_w + by_a * a + by_b * b) * spun


@jit_not_inlined
def ring_response(
    inner, outer, by_d, by_v, ring_d, ring_v, mass, inertia, residual, residual_torque
):
    """Return the `RingResponse` of a ring between its films.

    The journal's displacement and velocity change by by_d z and by_v z, those of the ring by ring_d
    y and ring_v y, its inertia force by mass y, its torque by inertia times the change of its
    speed; residual, residual_torque: on the ring [N], [N.m]; all factors complex. The returned
    position y is for the residuals and a journal that does not move.
    """
    M = stiffness(inner, by_d, by_v)
    N, Q = stiffness(inner, ring_d, ring_v), stiffness(outer, ring_d, ring_v)
    of_inner, of_outer = torque_by(inner, 1.0, N, ring_d), torque_by(outer, -1.0, Q, ring_d)
    by_a, by_b = -of_inner[0] - of_outer[0], -of_inner[1] - of_outer[1]
    G = outer.turned - inner.turned
    spin = 0.5 * (inner.z * inner.turned.conjugate() + outer.z * outer.turned.conjugate()).imag
    spun = inverse(spin - inner.drag - outer.drag - inertia)
    g, back = G * spun, G.conjugate() * spun
    A = AmplitudeMatrix(
        N.aa + Q.aa - mass - g * by_a,
        N.ab + Q.ab - g * by_b,
        N.ba + Q.ba - back * by_a,
        N.bb + Q.bb - mass - back * by_b,
    )
    size = A.aa * A.bb - A.ab * A.ba
    square = size.real * size.real + size.imag * size.imag
    over = inverse(size) if square > _TINY else 0.0j
    e_a, e_b = torque_by(inner, 1.0, M, by_d)
    F, back = inner.turned, inner.turned.conjugate()
    a, b, w = _solved(A, G, by_a, by_b, spun, over, -M.aa, -M.ba, e_a)
    aa = M.aa - (N.aa * a + N.ab * b) + F * w
    ba = M.ba - (N.ba * a + N.bb * b) + back * w
    a, b, w = _solved(A, G, by_a, by_b, spun, over, -M.ab, -M.bb, e_b)
    ab = M.ab - (N.aa * a + N.ab * b) + F * w
    bb = M.bb - (N.ba * a + N.bb * b) + back * w
    a, b, w = _solved(
        A, G, by_a, by_b, spun, over, residual, residual.conjugate(), residual_torque + 0.0j
    )
    moved = F * w - (N.aa * a + N.ab * b)
    return RingResponse(AmplitudeMatrix(aa, ab, ba, bb), moved, a, w.real)
