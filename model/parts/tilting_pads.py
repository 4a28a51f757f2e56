"""Pads of a journal bearing that tilt about their pivots, as its law has them.

States of each pad: its tilt [m] (`contact.tilting`), of a pad with inertia the rate of that [m/s],
and of one whose pivot gives how far that does [m]. Where equilibrium is sought pads are where they
rest, and as the machine vibrates they follow at a frequency. Of pads that stand nothing is done.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from ..film.bearing_film import pad_count
from ..film.tilting_pads import (
    CONVERGED,
    ITERATIONS,
    REACH,
    Balance,
    Search,
    across_of,
    ahead_of,
    at_rest,
    find,
    following,
    free_of_inertia,
    none_of,
    on_pivot,
    pad_balance,
    put,
    put_pivot,
    speed_of,
    vibrating,
    with_inertia,
)
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import NOT_NEGATIVE, Output, quantity, switch
from .film_law import FilmQuantities
from .law import Kinematics


@dataclass(frozen=True, kw_only=True)
class TiltingQuantities(FilmQuantities):
    """The quantities of a film, whose viscosity may be a list over the speed; whether its pads
    tilt, the moment of inertia of each about its pivot [kg.m2], the radial stiffness of that [N/m],
    0: rigid; and by how much the pressure around the film is above that of rupture [Pa]."""

    # a damper's may be no list
    viscosity: float | tuple[float, ...] = quantity(  # type: ignore[assignment]
        *("Pa.s", "dynamic viscosity of the lubricant; or a list over speed or temperature"),
        is_tunable=True,
        may_be_list=True,
    )
    tilting: bool = switch("whether each pad tilts about a pivot, at its offset", False)
    pad_inertia: float = quantity(
        "kg.m2", "moment of inertia of a pad that tilts, about its pivot", NOT_NEGATIVE, 0.0
    )
    pivot_stiffness: float = quantity(
        *("N/m", "radial stiffness of the pivot of each pad that tilts; 0: rigid", NOT_NEGATIVE),
        *(0.0,),
    )
    supply_pressure: float = quantity(
        *("Pa", "pressure around the film, above that at which it ruptures", NOT_NEGATIVE, 0.0),
    )


PADS = Output(
    "pads", "J", "kinetic energy of pads that tilt, elastic energy of their pivots", nominal=1e-6
)


def tilts_of(part: Any) -> Iterator[Output]:
    """Return the outputs of the pads of a part."""
    for i in range(1, len(part.pads) + 1):
        text = f"angle by which pad {i} is tilted, anticlockwise"
        yield Output(f"tilt_{i}", "rad", text, nominal=1e-4)
    if part.pivot_stiffness > 0.0:
        for i in range(1, len(part.pads) + 1):
            yield Output(f"pivot_{i}", "m", f"how far the pivot of pad {i} gives", nominal=1e-5)


@jit
def states_of_pad(part):
    """Return how many states a pad has."""
    inertial = 1 if part.pad_inertia > 0.0 else 0
    return 1 + inertial + (1 if part.pivot_stiffness > 0.0 else 0)


@jit
def _mass(part):
    """Return J / R^2 of a pad [kg]."""
    return part.pad_inertia / (part.journal_radius * part.journal_radius)


class Followed(NamedTuple):
    """A pad that follows its journal: its `Search`, the result y, how what that looks for changes
    by y, and the `Balance` there; give [m], giving [m/s]: of its pivot."""

    search: Search
    y: float
    slope: float
    at: Balance
    give: float
    giving: float


@jit_not_inlined
def _on_fixed_pivot(part, bearing, tables, kinematics, i, tilt, rate, b):
    """Return the `Search`, y, slope and `Balance` of a pad, its pivot as it was put last."""
    if b == math.inf:
        search = at_rest(bearing, tables, kinematics, i)
    elif part.pad_inertia == 0.0:
        search = free_of_inertia(bearing, kinematics, tilt, b)
    elif b > 0.0:
        search = with_inertia(bearing, kinematics, tilt, rate, b, _mass(part))
    else:
        put(bearing, tables, i, tilt, rate)
        still = Search(tilt, 0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        return still, 0.0, 0.0, pad_balance(bearing, tables, kinematics, i)
    y, slope, at = find(bearing, tables, kinematics, i, search)
    return search, y, slope, at


@jit
def _by_give(at, search, slope, outwards, by_give, by_giving):
    """Return minus the change of a pad's force as its pivot gives."""
    p, q = following(at, search, slope, by_give, by_giving)
    return p * outwards + q * outwards.conjugate()


@jit_not_inlined
def _follow(part, bearing, tables, kinematics, i, free, b):
    """Return the `Followed` of a pad, which is put there; free: the states at the end of a step
    without their rates, of weight b [s]; infinite where it rests."""
    rests = b == math.inf
    first = states_of_pad(part) * i
    tilt, rate = free[first], free[first + 1] if part.pad_inertia > 0.0 else 0.0
    k = part.pivot_stiffness
    if k == 0.0:
        search, y, slope, at = _on_fixed_pivot(part, bearing, tables, kinematics, i, tilt, rate, b)
        return Followed(search, y, slope, at, 0.0, 0.0)
    outwards = across_of(bearing, tables, i) * -1j
    begun = free[first + states_of_pad(part) - 1]
    # what is sought is how far the pivot gives, or its rate at the end of the step
    base, by_give, by_giving = (0.0, 1.0, 0.0) if rests else (begun, b, 1.0)
    z = begun if rests else 0.0
    none = none_of(bearing, speed_of(bearing, kinematics))
    scale = bearing.clearance if rests else speed_of(bearing, kinematics)
    reach = REACH * bearing.clearance if rests else scale
    if by_give > 0.0:
        reach = min(reach, REACH * bearing.clearance / by_give)
    low, high = -math.inf, math.inf
    is_found = False
    for _ in range(ITERATIONS):
        put_pivot(bearing, tables, i, base + by_give * z, by_giving * z)
        search, y, slope, at = _on_fixed_pivot(part, bearing, tables, kinematics, i, tilt, rate, b)
        left = -(outwards.conjugate() * at.force).real - k * (base + by_give * z)
        if is_found or abs(left) <= none:
            break
        by = _by_give(at, search, slope, outwards, by_give, by_giving)
        steep = (outwards.conjugate() * by).real - k * by_give
        ahead, low, high, reach = ahead_of(z, left, steep, low, high, reach, scale)
        is_found = abs(ahead - z) <= CONVERGED * scale
        z = ahead
    return Followed(search, y, slope, at, base + by_give * z, by_giving * z)


@jit
def _pair_of(part, bearing, tables, i, pad, by_d, by_v, by_give, by_giving):
    """Return the pair p, q of a pad's force for `Weights` of displacement and velocity."""
    p, q = following(pad.at, pad.search, pad.slope, by_d, by_v)
    k = part.pivot_stiffness
    if k > 0.0:
        outwards = across_of(bearing, tables, i) * -1j
        back = outwards.conjugate()
        by = _by_give(pad.at, pad.search, pad.slope, outwards, by_give, by_giving)
        steep = (back * by).real - k * by_give
        if steep < 0.0:
            g = outwards * p.conjugate() + back * q
            by *= 0.5 / steep
            p -= by * g.conjugate()
            q -= by * g
    return p, q


@jit_not_inlined
def put_pads(part, bearing, tables, kinematics, internal_state):
    """Put pads that tilt where they are, each at the rate at which it does."""
    if part.tilting == 0.0:
        return
    for i in range(pad_count(bearing, tables)):
        if part.pad_inertia > 0.0 and part.pivot_stiffness == 0.0:
            put(bearing, tables, i, internal_state[2 * i], internal_state[2 * i + 1])
        else:
            _follow(part, bearing, tables, kinematics, i, internal_state, 0.0)


@jit_not_inlined
def put_pads_still(part, bearing, tables, internal_state):
    """Put pads that tilt where they are, as if they did not move."""
    if part.tilting == 0.0:
        return
    stride = states_of_pad(part)
    for i in range(pad_count(bearing, tables)):
        put(bearing, tables, i, internal_state[stride * i], 0.0)
        if part.pivot_stiffness > 0.0:
            put_pivot(bearing, tables, i, internal_state[stride * (i + 1) - 1], 0.0)


@jit_not_inlined
def pads_tangent(part, bearing, tables, kinematics, weights, free, internal_state):
    """Implement `tangent` of a law (see `parts.law`) for pads that tilt."""
    b = weights.rate
    rests = kinematics.sliding_speed == 0.0 and b == 0.0
    by_give, by_giving = (1.0, 0.0) if rests else (b, 1.0)
    force = p = q = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad = _follow(part, bearing, tables, kinematics, i, free, math.inf if rests else b)
        _keep(part, i, pad, internal_state)
        force += pad.at.force
        p_pad, q_pad = _pair_of(
            *(part, bearing, tables, i, pad),
            *(weights.displacement, weights.velocity, by_give, by_giving),
        )
        p += p_pad
        q += q_pad
    return force, p, q


@jit
def _keep(part, i, pad, internal_state):
    """Fill in the states of a pad."""
    stride, search = states_of_pad(part), pad.search
    internal_state[stride * i] = search.tilt + search.by_tilt * pad.y
    if part.pad_inertia > 0.0:
        internal_state[stride * i + 1] = search.rate + search.by_rate * pad.y
    if part.pivot_stiffness > 0.0:
        internal_state[stride * (i + 1) - 1] = pad.give


@jit_not_inlined
def pads_vibrate(part, bearing, tables, kinematics, frequency, free, internal_state):
    """Implement `vibrate` of a law (see `parts.law`) for pads that tilt."""
    still = Kinematics(
        kinematics.displacement, 0.0j, kinematics.speed, kinematics.sliding_speed, 0.0
    )
    force = p_d = q_d = p_v = q_v = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad = _follow(part, bearing, tables, still, i, free, math.inf)
        _keep(part, i, pad, internal_state)
        force += pad.at.force
        by = vibrating(pad.at, _mass(part), frequency)
        if part.pivot_stiffness > 0.0:
            outwards = across_of(bearing, tables, i) * -1j
            by = on_pivot(by, outwards, part.pivot_stiffness, frequency)
        p_d += by[0]
        q_d += by[1]
        p_v += by[2]
        q_v += by[3]
    return force, p_d, q_d, p_v, q_v


@jit_not_inlined
def rates_of_pads(part, bearing, tables, kinematics, internal_state, out):
    """Implement `rates` of a law (see `parts.law`) for pads that tilt."""
    stride = states_of_pad(part)
    for i in range(pad_count(bearing, tables)):
        pad = _follow(part, bearing, tables, kinematics, i, internal_state, 0.0)
        if part.pad_inertia > 0.0:
            out[stride * i] = internal_state[stride * i + 1]
            out[stride * i + 1] = pad.at.moment / _mass(part)
        else:
            out[stride * i] = pad.y
        if part.pivot_stiffness > 0.0:
            out[stride * (i + 1) - 1] = pad.giving


@jit
def energy_of_pads(part, bearing, tables, internal_state):
    """Return the energy of pads that tilt, kinetic and elastic of their pivots [J]."""
    energy = 0.0
    if part.tilting > 0.0 and (part.pad_inertia > 0.0 or part.pivot_stiffness > 0.0):
        stride = states_of_pad(part)
        for i in range(pad_count(bearing, tables)):
            if part.pad_inertia > 0.0:
                rate = internal_state[stride * i + 1]
                energy += 0.5 * _mass(part) * rate * rate
            if part.pivot_stiffness > 0.0:
                give = internal_state[stride * (i + 1) - 1]
                energy += 0.5 * part.pivot_stiffness * give * give
    return energy
