"""Tilting pads of a journal bearing, as states of its law.

States of each pad: its tilt [m] (`film.tilting_pads`), of a pad with inertia its rate [m/s], and of
a pad on a flexible pivot the pivot's displacement [m]. In an equilibrium the pads are at rest; in a
vibration they follow at the frequency. Fixed pads need nothing of this.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

from ..film.bearing_film import pad_count
from ..film.pads_at_rest import search_at_rest
from ..film.tilting_pads import (
    CONVERGED,
    ITERATIONS,
    REACH,
    Balance,
    PadSearch,
    across_of,
    following,
    if_bearing,
    negligible_force,
    next_iterate,
    on_pivot,
    pad_balance,
    search_with_inertia,
    search_without_inertia,
    set_pivot_displacement,
    set_tilt,
    solve_pad,
    speed_of,
    vibrating,
    with_force_change,
)
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import NOT_NEGATIVE, Output, quantity, switch
from .film_law import FilmQuantities
from .law import Kinematics

_OF_PIVOT = 1e-6  # damping of a pivot, as a share of that of a film as thick as the clearance


@dataclass(frozen=True, kw_only=True)
class TiltingQuantities(FilmQuantities):
    """The quantities of a film, whose viscosity may be a list over the speed; whether its pads
    tilt, the moment of inertia of each about its pivot [kg.m2], the radial stiffness of the pivot
    [N/m], 0: rigid; and the pressure around the film above that of rupture [Pa]."""

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
        *("Pa", "pressure around the film, above that at which it ruptures", NOT_NEGATIVE, 0.0)
    )


PADS = Output(
    "pads", "J", "kinetic energy of pads that tilt, elastic energy of their pivots", nominal=1e-6
)


def tilts_of(part: Any) -> Iterator[Output]:
    """Yield the outputs of the pads of a part."""
    for i in range(1, len(part.pads) + 1):
        text = f"angle by which pad {i} is tilted, anticlockwise"
        yield Output(f"tilt_{i}", "rad", text, nominal=1e-4)
    if part.pivot_stiffness > 0.0:
        for i in range(1, len(part.pads) + 1):
            yield Output(f"pivot_{i}", "m", f"how far the pivot of pad {i} gives", nominal=1e-5)


@jit
def states_of_pad(part):
    """Return the number of states of a pad."""
    inertial = 1 if part.pad_inertia > 0.0 else 0
    return 1 + inertial + (1 if part.pivot_stiffness > 0.0 else 0)


def units_of_pad(part: Any) -> tuple[str, ...]:
    """Return the units of the states of a pad."""
    rate = ("m/s",) if part.pad_inertia > 0.0 else ()
    return "m", *rate, *(("m",) if part.pivot_stiffness > 0.0 else ())


@jit
def mass_of_pad(part):
    """Return J / R^2 of a pad [kg]."""
    return part.pad_inertia / (part.journal_radius * part.journal_radius)


class PadMotion(NamedTuple):
    """A pad that follows its journal: its `PadSearch`, the solution y, the derivative of the
    residual by y, the `Balance` there; displacement [m] and velocity [m/s] of its pivot."""

    search: PadSearch
    y: float
    slope: float
    at: Balance
    pivot_displacement: float
    pivot_velocity: float


@jit_not_inlined
def _on_fixed_pivot(part, bearing, tables, kinematics, i, tilt, rate, b):
    """Return the `PadSearch`, y, slope and `Balance` of a pad, its pivot at the present
    displacement."""
    if b == math.inf:
        search = search_at_rest(bearing, tables, kinematics, i)
    elif part.pad_inertia == 0.0:
        search = search_without_inertia(bearing, kinematics, tilt, b)
    elif b > 0.0:
        search = search_with_inertia(bearing, kinematics, tilt, rate, b, mass_of_pad(part))
    else:
        set_tilt(bearing, tables, i, tilt, rate)
        negligible = negligible_force(bearing, speed_of(bearing, kinematics))
        still = PadSearch(tilt, 0.0, rate, 0.0, 0.0, 0.0, 0.0, 0.0, negligible)
        at = pad_balance(bearing, tables, kinematics, i)
        return still, 0.0, 0.0, if_bearing(at, negligible)
    y, slope, at = solve_pad(bearing, tables, kinematics, i, search)
    return search, y, slope, at


@jit
def _by_pivot(at, search, slope, outwards, by_displacement, by_velocity):
    """Return minus the change of a pad's force with the displacement of its pivot."""
    p, q = following(at, search, slope, by_displacement, by_velocity)
    return p * outwards + q * outwards.conjugate()


@jit
def pivot_damping(bearing):
    """Return the damping of a pivot [N.s/m]. Beside a film it is next to nothing; where none bears,
    it has the pivot return, nearly at once."""
    slender = bearing.journal_radius / bearing.clearance
    return _OF_PIVOT * bearing.viscosity * bearing.length * slender * slender * slender


@jit
def _slope_of_pivot(part, bearing, outwards, by, by_displacement, by_velocity):
    """Return the derivative of the balance of a pad's pivot; by: see `_by_pivot`."""
    stiffness = part.pivot_stiffness * by_displacement
    damping = pivot_damping(bearing) * by_velocity
    return (outwards.conjugate() * by).real - stiffness - damping


@jit_not_inlined
def pad_motion(part, bearing, tables, kinematics, i, free, b):
    """Return the `PadMotion` of a pad, and move the pad there; free: the states at the end of a
    step without their rates, of weight b [s]; infinite for a pad at rest."""
    is_at_rest = b == math.inf
    first = states_of_pad(part) * i
    tilt, rate = free[first], free[first + 1] if part.pad_inertia > 0.0 else 0.0
    k, c = part.pivot_stiffness, pivot_damping(bearing)
    if k == 0.0:
        search, y, slope, at = _on_fixed_pivot(part, bearing, tables, kinematics, i, tilt, rate, b)
        return PadMotion(search, y, slope, at, 0.0, 0.0)
    outwards = across_of(bearing, tables, i) * -1j
    before, returning = free[first + states_of_pad(part) - 1], 0.0
    if b == 0.0 and before < 0.0:  # no film holds it, and that of one back already acts
        before, returning = 0.0, -before * k / c
    # the unknown is the displacement of the pivot, or its rate at the end of the step
    base, by_displacement, by_velocity = (0.0, 1.0, 0.0) if is_at_rest else (before, b, 1.0)
    z = before if is_at_rest else 0.0
    negligible = negligible_force(bearing, speed_of(bearing, kinematics))
    scale = bearing.clearance if is_at_rest else speed_of(bearing, kinematics)
    reach = REACH * bearing.clearance if is_at_rest else scale
    if by_displacement > 0.0:
        reach = min(reach, REACH * bearing.clearance / by_displacement)
    low, high = -math.inf, math.inf
    is_found = False
    for _ in range(ITERATIONS):
        set_pivot_displacement(bearing, tables, i, base + by_displacement * z, by_velocity * z)
        search, y, slope, at = _on_fixed_pivot(part, bearing, tables, kinematics, i, tilt, rate, b)
        residual = -(outwards.conjugate() * at.force).real - k * (base + by_displacement * z)
        residual -= c * by_velocity * z
        if is_found or abs(residual) <= negligible:
            break
        by = _by_pivot(at, search, slope, outwards, by_displacement, by_velocity)
        slope_of_pivot = _slope_of_pivot(part, bearing, outwards, by, by_displacement, by_velocity)
        ahead, low, high, reach = next_iterate(z, residual, slope_of_pivot, low, high, reach, scale)
        is_narrow = high - low <= CONVERGED * scale
        is_found = is_narrow or abs(ahead - z) <= CONVERGED * scale
        z = low if is_narrow else ahead
    if is_at_rest:  # it may bear at `low`, and nothing further on: its pivot says how much it does
        at = with_force_change(at, residual * outwards)
    velocity = by_velocity * z + returning
    return PadMotion(search, y, slope, at, base + by_displacement * z, velocity)


@jit
def _tangent_of_pad(part, bearing, tables, i, pad, by_d, by_v, by_displacement, by_velocity):
    """Return the pair p, q of a pad's force for `Weights` of displacement and velocity."""
    p, q = following(pad.at, pad.search, pad.slope, by_d, by_v)
    if part.pivot_stiffness > 0.0:
        outwards = across_of(bearing, tables, i) * -1j
        back = outwards.conjugate()
        by = _by_pivot(pad.at, pad.search, pad.slope, outwards, by_displacement, by_velocity)
        slope_of_pivot = _slope_of_pivot(part, bearing, outwards, by, by_displacement, by_velocity)
        if slope_of_pivot < 0.0:
            g = outwards * p.conjugate() + back * q
            by *= 0.5 / slope_of_pivot
            p -= by * g.conjugate()
            q -= by * g
    return p, q


@jit_not_inlined
def set_pads(part, bearing, tables, kinematics, internal_state):
    """Move tilting pads to their states, each with its rate."""
    if part.tilting == 0.0:
        return
    for i in range(pad_count(bearing, tables)):
        if part.pad_inertia > 0.0 and part.pivot_stiffness == 0.0:
            set_tilt(bearing, tables, i, internal_state[2 * i], internal_state[2 * i + 1])
        else:
            pad_motion(part, bearing, tables, kinematics, i, internal_state, 0.0)


@jit_not_inlined
def set_pads_at_rest(part, bearing, tables, internal_state):
    """Move tilting pads to their states, without rates."""
    if part.tilting == 0.0:
        return
    stride = states_of_pad(part)
    for i in range(pad_count(bearing, tables)):
        set_tilt(bearing, tables, i, internal_state[stride * i], 0.0)
        if part.pivot_stiffness > 0.0:
            set_pivot_displacement(bearing, tables, i, internal_state[stride * (i + 1) - 1], 0.0)


@jit_not_inlined
def pads_tangent(part, bearing, tables, kinematics, weights, free, internal_state):
    """Return force and tangent of tilting pads: their `Law.tangent`."""
    b = weights.rate
    is_at_rest = kinematics.sliding_speed == 0.0 and b == 0.0
    by_displacement, by_velocity = (1.0, 0.0) if is_at_rest else (b, 1.0)
    force = p = q = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad = pad_motion(part, bearing, tables, kinematics, i, free, math.inf if is_at_rest else b)
        _store_pad(part, i, pad, internal_state)
        force += pad.at.force
        p_pad, q_pad = _tangent_of_pad(
            *(part, bearing, tables, i, pad),
            *(weights.displacement, weights.velocity, by_displacement, by_velocity),
        )
        p += p_pad
        q += q_pad
    return force, p, q


@jit
def _store_pad(part, i, pad, internal_state):
    """Fill in the states of a pad."""
    stride, search = states_of_pad(part), pad.search
    internal_state[stride * i] = search.tilt + search.by_tilt * pad.y
    if part.pad_inertia > 0.0:
        internal_state[stride * i + 1] = search.rate + search.by_rate * pad.y
    if part.pivot_stiffness > 0.0:
        internal_state[stride * (i + 1) - 1] = pad.pivot_displacement


@jit_not_inlined
def pads_vibrate(part, bearing, tables, kinematics, frequency, free, internal_state):
    """Return force and tangents of vibrating tilting pads: their `Law.vibrate`."""
    still = Kinematics(
        kinematics.displacement, 0.0j, kinematics.speed, kinematics.sliding_speed, 0.0
    )
    force = p_d = q_d = p_v = q_v = 0.0j
    for i in range(pad_count(bearing, tables)):
        pad = pad_motion(part, bearing, tables, still, i, free, math.inf)
        _store_pad(part, i, pad, internal_state)
        force += pad.at.force
        by = vibrating(pad.at, mass_of_pad(part), frequency)
        if part.pivot_stiffness > 0.0:
            outwards = across_of(bearing, tables, i) * -1j
            by = on_pivot(by, outwards, part.pivot_stiffness, pivot_damping(bearing), frequency)
        p_d += by[0]
        q_d += by[1]
        p_v += by[2]
        q_v += by[3]
    return force, p_d, q_d, p_v, q_v


@jit_not_inlined
def rates_of_pads(part, bearing, tables, kinematics, internal_state, out):
    """Fill in the rates of tilting pads: their `Law.rates`."""
    stride = states_of_pad(part)
    for i in range(pad_count(bearing, tables)):
        pad = pad_motion(part, bearing, tables, kinematics, i, internal_state, 0.0)
        if part.pad_inertia > 0.0:
            out[stride * i] = internal_state[stride * i + 1]
            out[stride * i + 1] = pad.at.moment / mass_of_pad(part)
        else:
            out[stride * i] = pad.y
        if part.pivot_stiffness > 0.0:
            out[stride * (i + 1) - 1] = pad.pivot_velocity


@jit
def energy_of_pads(part, bearing, tables, internal_state):
    """Return the energy of tilting pads, kinetic and elastic of their pivots [J]."""
    energy = 0.0
    if part.tilting > 0.0 and (part.pad_inertia > 0.0 or part.pivot_stiffness > 0.0):
        stride = states_of_pad(part)
        for i in range(pad_count(bearing, tables)):
            if part.pad_inertia > 0.0:
                rate = internal_state[stride * i + 1]
                energy += 0.5 * mass_of_pad(part) * rate * rate
            if part.pivot_stiffness > 0.0:
                pivot_displacement = internal_state[stride * (i + 1) - 1]
                energy += 0.5 * part.pivot_stiffness * pivot_displacement * pivot_displacement
    return energy
