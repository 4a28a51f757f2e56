"""A bearing alone over speed or load: where its journal rests, its eight coefficients there, and
the mass that they carry without whirling."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

import numpy as np

from ..film.bearing_film import PAD
from ..machine.rotor import Rotor
from ..parts.film_viscosity import oil_of
from ..parts.floating_ring_bearing import FloatingRingBearing
from ..parts.journal_bearing import JournalBearing
from ..parts.rolling_bearing import RollingBearing
from ..parts.speed_table import interpolant
from ..parts.squeeze_film_damper import SqueezeFilmDamper
from ..quantities import GRAVITY
from .bearing_equilibrium import BearingAlone, critical_mass
from .reynolds_2d import film_in_plane
from .static import speeds_and_loads
from .system_at_speed import LinearError

AnyBearing = JournalBearing | SqueezeFilmDamper | RollingBearing | FloatingRingBearing
_HALVINGS = 30
ANGLES = np.radians(np.arange(0.0, 361.0, 3.0))  # of `BearingCurves.around`


@dataclass(frozen=True)
class BearingCurves:
    """A journal bearing over n speeds [rad/s], or loads.

    bearing: its name; clearance, journal_radius [m]; load: on the journal, to the right and
    upwards, shape (n, 2) [N]; x, y [m], eccentricity [1], attitude [rad], film [m], pressure [Pa],
    torque [N.m], power [W], flow [m3/s], shape (n,); around: pressure in the middle of the length
    every 3 degrees from the right, anticlockwise, shape (n, 121) [Pa]; K [N/m], C [N.s/m], shape
    (n, 2, 2); mass: that the first load weighs [kg]; critical_mass [kg], whirl: frequency at that
    mass [rad/s]; threshold: speed above which `mass` whirls [rad/s], None if it does at none or the
    loads vary; threshold_load: on either side of it a mass that weighs the load whirls, or does not
    [N], None if the speeds vary or there is none; plane_error: of the load, against a two-
    dimensional solution [1]; viscosity [Pa.s], temperature [degC]: of the lubricant, shape (n,),
    None where no heat balance gives it; pads: of m pads the first and last angle, the angle of the
    pivot [rad], the clearance and x, y of the journal from the pad's centre when it is in the
    bearing's, over the clearance [1], shape (m, 6); tilts: of pads that tilt, how far, and how far
    the pivot gives, shape (n, m, 2) [m]; pad_loads: what each bears, shape (n, m) [N].
    """

    bearing: str
    clearance: float
    journal_radius: float
    speeds: np.ndarray
    load: np.ndarray
    x: np.ndarray
    y: np.ndarray
    eccentricity: np.ndarray
    attitude: np.ndarray
    film: np.ndarray
    pressure: np.ndarray
    torque: np.ndarray
    power: np.ndarray
    flow: np.ndarray
    around: np.ndarray
    K: np.ndarray
    C: np.ndarray
    mass: float
    critical_mass: np.ndarray
    whirl: np.ndarray
    threshold: float | None
    threshold_load: float | None
    plane_error: np.ndarray
    viscosity: np.ndarray
    temperature: np.ndarray | None
    pads: np.ndarray
    tilts: np.ndarray
    pad_loads: np.ndarray


def bearings(rotor: Rotor) -> dict[str, AnyBearing]:
    """Return journal bearings, then squeeze film dampers, rolling bearings and those with floating
    rings of a machine by their names."""
    kinds = get_args(AnyBearing)
    return {name: p for kind in kinds for name, p in rotor.named_parts() if isinstance(p, kind)}


def journal_bearings(rotor: Rotor) -> dict[str, JournalBearing]:
    """Return the journal bearings of a machine by their names."""
    return {where: p for where, p in rotor.named_parts() if isinstance(p, JournalBearing)}


def bearing_curves(
    rotor: Rotor,
    speeds: Sequence[float] | np.ndarray,
    *,
    bearing: str | None = None,
    load: float | Sequence[float] | np.ndarray | None = None,
) -> BearingCurves:
    """Return a journal bearing's equilibrium and coefficients at each speed [rad/s], or under each
    load at one.

    bearing: its name, the first by default; load: downwards [N], one or several, by default what
    the machine's weight puts on it. Raises `LinearError` if there is no such bearing or no
    equilibrium, or if there are several of both.
    """
    known = journal_bearings(rotor)
    if not known:
        raise LinearError("the machine has no [[journal_bearing]]")
    name = bearing or next(iter(known))
    if name not in known:
        raise LinearError(f"bearing = {name}: must be one of {', '.join(known)}")
    is_over_load = load is not None and np.size(load) > 1
    speeds, loads = speeds_and_loads(rotor, name, speeds, load)
    rows = []
    start = None
    for speed, on in zip(speeds, loads, strict=True):
        alone = BearingAlone(known[name], speed, name)
        start = alone.rest(on, None if on == 0.0 else start)
        rows.append(_row(alone, known[name], start))
    columns = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    gravity = rotor.gravity or GRAVITY
    mass = float(abs(loads[0])) / gravity
    masses = np.abs(loads) / gravity if is_over_load else np.full(len(loads), mass)
    stable = columns["critical_mass"] >= masses
    threshold = threshold_load = None
    turns = np.flatnonzero(stable[1:] != stable[:-1])
    if not is_over_load and not stable[0]:
        threshold = float(speeds[0])
    elif len(turns):
        ends = slice(int(turns[0]), int(turns[0]) + 2)
        of_ends = (speeds[ends], loads[ends], masses[ends], stable[ends])
        if is_over_load:
            threshold_load = _threshold(known[name], name, np.abs(loads[ends]), *of_ends)
        else:
            threshold = _threshold(known[name], name, of_ends[0], *of_ends)
    return BearingCurves(
        bearing=name,
        clearance=known[name].clearance,
        journal_radius=known[name].journal_radius,
        speeds=np.array(speeds),
        load=np.column_stack([loads.real, loads.imag]),
        mass=mass,
        threshold=threshold,
        threshold_load=threshold_load,
        temperature=_temperatures(known[name], np.array(speeds)),
        pads=_pads(known[name]),
        **columns,
    )


def _row(alone: BearingAlone, part: JournalBearing, d: complex) -> dict[str, object]:
    K, C = alone.coefficients(d)
    mass, whirl = critical_mass(K, C)
    known = alone.outputs(d)
    names = ("eccentricity", "attitude", "film", "pressure", "torque", "power", "flow")
    tilts = alone.tilts(d)
    in_plane = film_in_plane(part, alone.speed, d, tilts=tilts, viscosity=alone.viscosity)
    error = abs(alone.force(d) - in_plane) / abs(in_plane) if in_plane != 0.0 else math.nan
    return {name: known[name] for name in names} | {
        "x": d.real,
        "y": d.imag,
        "around": alone.pressure(d, ANGLES),
        "K": K,
        "C": C,
        "critical_mass": mass,
        "whirl": whirl,
        "plane_error": error,
        "viscosity": alone.viscosity,
        "tilts": np.column_stack([tilts.real, tilts.imag]),
        "pad_loads": alone.pad_loads(d) if part.tilting else np.zeros(0),
    }


def _temperatures(part: JournalBearing, speeds: np.ndarray) -> np.ndarray | None:
    """Return the temperature of the lubricant at each speed [degC], as its table over the speed has
    it; None without a heat balance."""
    oil = oil_of(part) if part.temperature else None
    if oil is None:
        return None
    fast = np.clip(np.abs(speeds), oil.speed[0], oil.speed[-1])
    return np.asarray(interpolant(oil.speed, oil.temperature)(fast))


def _pads(part: JournalBearing) -> np.ndarray:
    """Return `BearingCurves.pads`."""
    rows = np.array(part.pad_rows())
    pivots = np.arctan2(rows[:, PAD.pivot_y], rows[:, PAD.pivot_x])
    shape = (PAD.first, PAD.last, PAD.clearance, PAD.x, PAD.y)
    return np.insert(rows[:, shape], 2, pivots, axis=1)


def _threshold(
    part: JournalBearing,
    name: str,
    varied: np.ndarray,
    speeds: np.ndarray,
    loads: np.ndarray,
    masses: np.ndarray,
    stable: np.ndarray,
) -> float:
    """Return the value of what varies, the speed [rad/s] or the load [N], at which the mass that
    goes with it begins, or ends, to whirl; all arguments of both ends, between which they are
    linear."""
    low, high = (float(end) for end in varied)
    begin, span = low, high - low
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        share = (middle - begin) / span
        speed = middle if varied is speeds else float(speeds[0])
        load = loads[0] + share * (loads[1] - loads[0])
        alone = BearingAlone(part, speed, name)
        mass = masses[0] + share * (masses[1] - masses[0])
        is_stable = critical_mass(*alone.coefficients(alone.rest(load)))[0] >= mass
        low, high = (middle, high) if is_stable == stable[0] else (low, middle)
    return 0.5 * (low + high)
