"""Pads of a journal bearing that tilt about their pivots, as its law has them.

A state a pad, its tilt [m] (`contact.tilting`), of a pad with inertia its rate [m/s] too. Where
equilibrium is sought pads are where they rest, and as the machine vibrates they follow at a
frequency. Of pads that stand nothing is done.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from ..contact.film import pad_count
from ..contact.tilting import (
    at_rest,
    find,
    following,
    free_of_inertia,
    pad_balance,
    put,
    vibrating,
    with_inertia,
)
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import NOT_NEGATIVE, Output, quantity, switch
from .film_law import FilmQuantities
from .law import Kinematics


@dataclass(frozen=True, kw_only=True)
class TiltingQuantities(FilmQuantities):
    """The quantities of a film, whether its pads tilt, and the moment of inertia of each about its
    pivot [kg.m2]."""

    tilting: bool = switch("whether each pad tilts about a pivot, at its offset", False)
    pad_inertia: float = quantity(
        "kg.m2", "moment of inertia of a pad that tilts, about its pivot", NOT_NEGATIVE, 0.0
    )


PADS = Output("pads", "J", "kinetic energy of pads that tilt", nominal=1e-6)


def tilts_of(part: Any) -> Iterator[Output]:
    """Return the outputs of the pads of a part."""
    for i in range(1, len(part.pads) + 1):
        text = f"angle by which pad {i} is tilted, anticlockwise"
        yield Output(f"tilt_{i}", "rad", text, nominal=1e-4)


@jit
def states_of_pad(part):
    """Return how many states a pad has."""
    return 2 if part.pad_inertia > 0.0 else 1


@jit
def _mass(part):
    """Return J / R^2 of a pad [kg]."""
    return part.pad_inertia / (part.journal_radius * part.journal_radius)


@jit_not_inlined
def put_pads(part, bearing, tables, kinematics, internal_state):
    """Put pads that tilt where they are, each at the rate at which it does."""
    if part.tilting == 0.0:
        return
    for i in range(pad_count(bearing, tables)):
        if part.pad_inertia > 0.0:
            put(bearing, tables, i, internal_state[2 * i], internal_state[2 * i + 1])
        else:
            search = free_of_inertia(bearing, kinematics, internal_state[i], 0.0)
            find(bearing, tables, kinematics, i, search)


@jit_not_inlined
def put_pads_still(part, bearing, tables, internal_state):
    """Put pads that tilt where they are, as if they did not move."""
    if part.tilting == 0.0:
        return
    stride = states_of_pad(part)
    for i in range(pad_count(bearing, tables)):
        put(bearing, tables, i, internal_state[stride * i], 0.0)


@jit_not_inlined
def pads_tangent(part, bearing, tables, kinematics, weights, free, internal_state):
    """Implement `tangent` of a law (see `parts.law`) for pads that tilt."""
    b = weights.rate
    by_d, by_v = weights.displacement, weights.velocity
    rests = kinematics.sliding_speed == 0.0 and b == 0.0
    has_inertia = part.pad_inertia > 0.0
    force = p = q = 0.0j
    for i in range(pad_count(bearing, tables)):
        first = 2 * i if has_inertia else i
        tilt, rate = free[first], free[first + 1] if has_inertia else 0.0
        if rests:
            search = at_rest(bearing, tables, kinematics, i)
        elif not has_inertia:
            search = free_of_inertia(bearing, kinematics, tilt, b)
        elif b > 0.0:
            search = with_inertia(bearing, kinematics, tilt, rate, b, _mass(part))
        else:
            put(bearing, tables, i, tilt, rate)
            at = pad_balance(bearing, tables, kinematics, i)
            internal_state[first], internal_state[first + 1] = tilt, rate
            force += at.force
            p += by_d * at.p_d + by_v * at.p_v
            q += by_d * at.q_d + by_v * at.q_v
            continue
        y, slope, at = find(bearing, tables, kinematics, i, search)
        internal_state[first] = search.tilt + search.by_tilt * y
        if has_inertia:
            internal_state[first + 1] = search.rate + search.by_rate * y
        force += at.force
        p_pad, q_pad = following(at, search, slope, by_d, by_v)
        p += p_pad
        q += q_pad
    return force, p, q


@jit_not_inlined
def pads_vibrate(part, bearing, tables, kinematics, frequency, free, internal_state):
    """Implement `vibrate` of a law (see `parts.law`) for pads that tilt."""
    stride = states_of_pad(part)
    still = Kinematics(
        kinematics.displacement, 0.0j, kinematics.speed, kinematics.sliding_speed, 0.0
    )
    force = p_d = q_d = p_v = q_v = 0.0j
    for i in range(pad_count(bearing, tables)):
        search = at_rest(bearing, tables, still, i)
        y, _, at = find(bearing, tables, still, i, search)
        internal_state[stride * i] = search.tilt + y
        if stride == 2:
            internal_state[stride * i + 1] = 0.0
        force += at.force
        by = vibrating(at, _mass(part), frequency)
        p_d += by[0]
        q_d += by[1]
        p_v += by[2]
        q_v += by[3]
    return force, p_d, q_d, p_v, q_v


@jit_not_inlined
def rates_of_pads(part, bearing, tables, kinematics, internal_state, out):
    """Implement `rates` of a law (see `parts.law`) for pads that tilt."""
    for i in range(pad_count(bearing, tables)):
        if part.pad_inertia > 0.0:
            rate = internal_state[2 * i + 1]
            put(bearing, tables, i, internal_state[2 * i], rate)
            out[2 * i] = rate
            moment = pad_balance(bearing, tables, kinematics, i).moment
            out[2 * i + 1] = moment / _mass(part)
        else:
            search = free_of_inertia(bearing, kinematics, internal_state[i], 0.0)
            out[i], _, _ = find(bearing, tables, kinematics, i, search)


@jit
def energy_of_pads(part, bearing, tables, internal_state):
    """Return the kinetic energy of pads that tilt [J]."""
    energy = 0.0
    if part.tilting > 0.0 and part.pad_inertia > 0.0:
        for i in range(pad_count(bearing, tables)):
            rate = internal_state[2 * i + 1]
            energy += 0.5 * _mass(part) * rate * rate
    return energy
