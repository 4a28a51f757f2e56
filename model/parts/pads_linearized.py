"""A film between pads linearized: its force and the rates of its pads' states, by the journal's
motion and by the states themselves (`Law.linearize`).

The film of a pad, and its moment, depend on displacement and velocity of the journal, on tilt and
displacement of its pivot, and on the rates of these. The pivot's balance eliminates the pivot's
rate, and the moment's, of a pad without inertia, the tilt's; with inertia that rate is a state.
"""

from typing import NamedTuple

from ..film.bearing_film import film_slopes, pad_count
from ..film.rough_contact import wall_tangent
from ..film.tilting_pads import across_of
from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from .film_law import bearing_at
from .law import BY_D, BY_V
from .tilting_pads import mass_of_pad, pad_motion, pivot_damping, states_of_pad


class _Change(NamedTuple):
    """The change of a real number with displacement and velocity of the journal, by Re(conj(g) z),
    and with a pad's tilt, its rate, the pivot's displacement and the rate of that."""

    d: complex
    v: complex
    tilt: float
    rate: float
    pivot: float
    pivot_rate: float


@jit
def _with(a, share, b):
    """Return the change of a + share b."""
    return _Change(
        *(a.d + share * b.d, a.v + share * b.v, a.tilt + share * b.tilt, a.rate + share * b.rate),
        *(a.pivot + share * b.pivot, a.pivot_rate + share * b.pivot_rate),
    )


@jit
def _component(at, outwards, e):
    """Return the `_Change` of the component along e of a pad's force in a `Balance`."""
    back = outwards.conjugate()
    by_pivot = -(at.p_d * outwards + at.q_d * back)
    by_pivot_rate = -(at.p_v * outwards + at.q_v * back)
    along = e.conjugate()
    return _Change(
        e * at.p_d.conjugate() + along * at.q_d,
        e * at.p_v.conjugate() + along * at.q_v,
        (along * at.force_by_tilt).real,
        (along * at.force_by_rate).real,
        (along * by_pivot).real,
        (along * by_pivot_rate).real,
    )


@jit
def _moment(at, outwards):
    """Return the `_Change` of the moment of a `Balance`."""
    back = outwards.conjugate()
    by_pivot, by_pivot_rate = -(back * at.g_d).real, -(back * at.g_v).real
    return _Change(at.g_d, at.g_v, at.by_tilt, at.by_rate, by_pivot, by_pivot_rate)


@jit
def _unit(tilt, rate, pivot, pivot_rate):
    """Return a `_Change` with a pad's states or rates alone."""
    return _Change(0.0j, 0.0j, tilt, rate, pivot, pivot_rate)


@jit
def _store(slopes, place, first, rate, change, part):
    """Fill in the rate of a pad's state and its `_Change`; first: the pad's first state."""
    slopes.rates[place] = rate
    slopes.by_d[place] = change.d
    slopes.by_v[place] = change.v
    slopes.by_states[place, first] = change.tilt
    if part.pad_inertia > 0.0:
        slopes.by_states[place, first + 1] = change.rate
    if part.pivot_stiffness > 0.0:
        slopes.by_states[place, first + states_of_pad(part) - 1] = change.pivot


@jit_not_inlined
def _linearize_pad(part, bearing, tables, i, pad, internal_state, slopes):
    """Return p_d, q_d, p_v, q_v of a pad in its `PadMotion`, and fill in its `StateSlopes`."""
    at, outwards = pad.at, across_of(bearing, tables, i) * -1j
    stride = states_of_pad(part)
    first, last = stride * i, stride * (i + 1) - 1
    x, y = _component(at, outwards, 1.0 + 0.0j), _component(at, outwards, 1j)
    moment = _moment(at, outwards)
    pivot_rate, rate = _unit(0.0, 0.0, 0.0, 0.0), _unit(0.0, 1.0, 0.0, 0.0)
    if part.pivot_stiffness > 0.0:
        of_pivot = _unit(0.0, 0.0, -part.pivot_stiffness, -pivot_damping(bearing))
        balance = _with(of_pivot, -1.0, _component(at, outwards, outwards))
        pivot_rate = _with(pivot_rate, -1.0 / balance.pivot_rate, balance)
        x, y = _with(x, x.pivot_rate, pivot_rate), _with(y, y.pivot_rate, pivot_rate)
        moment = _with(moment, moment.pivot_rate, pivot_rate)
    if part.pad_inertia > 0.0:
        _store(slopes, first, first, internal_state[first + 1], rate, part)
        mass = mass_of_pad(part)
        moved = _with(_unit(0.0, 0.0, 0.0, 0.0), 1.0 / mass, moment)
        _store(slopes, first + 1, first, at.moment / mass, moved, part)
    else:
        rate = _unit(0.0, 0.0, 0.0, 0.0)
        # one on which nothing presses stays
        if moment.rate < 0.0 and (pad.y != 0.0 or modulus(at.force) > pad.search.negligible):
            rate = _with(rate, -1.0 / moment.rate, moment)
        x, y = _with(x, x.rate, rate), _with(y, y.rate, rate)
        pivot_rate = _with(pivot_rate, pivot_rate.rate, rate)
        _store(slopes, first, first, pad.y, rate, part)
    slopes.force[first] = complex(x.tilt, y.tilt)
    if part.pad_inertia > 0.0:
        slopes.force[first + 1] = complex(x.rate, y.rate)
    if part.pivot_stiffness > 0.0:
        _store(slopes, last, first, pad.pivot_velocity, pivot_rate, part)
        slopes.force[last] = complex(x.pivot, y.pivot)
        if internal_state[last] < 0.0:  # all else is as if it had returned
            slopes.force[last] = 0.0j
            for place in range(first, last):
                slopes.by_states[place, last] = 0.0
            slopes.by_states[first:last, last] = 0.0
            slopes.by_states[last, last] = -part.pivot_stiffness / pivot_damping(bearing)
    return (
        *(0.5 * (x.d.conjugate() + 1j * y.d.conjugate()), 0.5 * (x.d + 1j * y.d)),
        *(0.5 * (x.v.conjugate() + 1j * y.v.conjugate()), 0.5 * (x.v + 1j * y.v)),
    )


@jit_not_inlined
def linearize_film(part, tables, kinematics, internal_state, solved, slopes):
    """Return the force of a film between pads and its tangents: its `Law.linearize`."""
    bearing = bearing_at(part, tables, kinematics.speed)
    if part.tilting == 0.0:
        at = film_slopes(bearing, tables, kinematics)
        wall, p_d, q_d = wall_tangent(bearing, tables, kinematics, BY_D)
        _, p_v, q_v = wall_tangent(bearing, tables, kinematics, BY_V)
        return at.force + wall, at.p_d + p_d, at.q_d + q_d, at.p_v + p_v, at.q_v + q_v
    force = p_d = q_d = p_v = q_v = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad = pad_motion(part, bearing, tables, kinematics, i, internal_state, 0.0)
        by = _linearize_pad(part, bearing, tables, i, pad, internal_state, slopes)
        force += pad.at.force
        p_d += by[0]
        q_d += by[1]
        p_v += by[2]
        q_v += by[3]
    return force, p_d, q_d, p_v, q_v
