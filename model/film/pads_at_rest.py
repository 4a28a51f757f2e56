"""Where a tilting pad rests: where its film bears, or, unheld, at a tilt at which it idles.

The journal is at x_r from the pad's centre towards the pivot, and at x_t across, from the pivot
towards the end at which the journal's surface leaves the pad. Of a given x_r, and over x_t, which
is the tilt, the moment G on the pad is

    0                below some x_t: nothing converges above the pad; it has no pressure
    negative         of x_r < 0, as the film converges behind the pivot only
    positive         as the film converges above the whole pad, if the pad bears at all
    negative         as the film's end becomes thin and the pressure moves there

The pad bears at the last of its roots, on the falling side of the maximum. There G is concave, so
that Newton's method comes to the root from a thin end on, without ever passing it, or it passes the
maximum where there is none. For x_r > 0 there always is one. A pad without is unheld: its film, if
any, turns it back to where nothing converges, x_t = x_r tan(beta), beta being the angle from the
pivot to that end; there it idles.
"""

from ..kernels.functions import direction
from ..kernels.jit import jit, jit_not_inlined
from .bearing_film import PAD
from .tilting_pads import (
    CONVERGED,
    ITERATIONS,
    REACH,
    PadSearch,
    across_of,
    negligible_force,
    pad_balance,
    row_of,
    set_tilt,
    speed_of,
)

_THIN = 0.1  # of a pad's clearance: a film at its end that turns the pad back
_NARROWEST = 0.17  # cos(beta) of a pad that idles


@jit
def _search_from(bearing, negligible, tilt):
    """Return the `PadSearch` for an equilibrium from a tilt on [m]; negligible: G that counts as 0
    [N]."""
    c = bearing.clearance
    return PadSearch(tilt, 1.0, 0.0, 0.0, 0.0, 0.0, c, REACH * c, negligible)


@jit_not_inlined
def search_at_rest(bearing, tables, kinematics, i):
    """Return the `PadSearch` for the equilibrium of a pad, its pivot at the present displacement,
    from where its film bears, or where it idles. At standstill there is no film: from the tilt at
    which the journal is opposite the pivot."""
    at = row_of(bearing, i)
    across = across_of(bearing, tables, i)
    opposite = -(across.conjugate() * kinematics.displacement).real
    negligible = negligible_force(bearing, speed_of(bearing, kinematics))
    if kinematics.speed == 0.0:
        return _search_from(bearing, negligible, opposite)
    outwards = complex(tables[at + PAD.pivot_x], tables[at + PAD.pivot_y])
    clearance = bearing.clearance * tables[at + PAD.clearance]
    radial = (outwards.conjugate() * kinematics.displacement).real
    radial += clearance - bearing.clearance - tables[at + PAD.pivot_displacement]
    sense = 1.0 if kinematics.speed > 0.0 else -1.0
    end = tables[at + PAD.last] if sense > 0.0 else tables[at + PAD.first]
    to_end = direction(end) * outwards.conjugate()
    cosine, sine = to_end.real, abs(to_end.imag)
    least = min(0.0, radial) * sine / max(cosine, _NARROWEST)
    idle = opposite + sense * least
    ahead = max(0.0, ((1.0 - _THIN) * clearance - radial * cosine) / sine)
    for _ in range(ITERATIONS):
        tilt = opposite + sense * ahead
        set_tilt(bearing, tables, i, tilt, 0.0)
        here = pad_balance(bearing, tables, kinematics, i)
        moment = sense * here.moment
        if moment > negligible:
            return _search_from(bearing, negligible, tilt)
        if here.by_tilt >= 0.0:
            break
        step = moment / here.by_tilt
        if step <= CONVERGED * bearing.clearance:
            return _search_from(bearing, negligible, tilt)
        ahead -= step
        if radial < 0.0 and ahead < least:  # past the maximum, perhaps to a wall at the other end
            break
    return _search_from(bearing, negligible, idle)
