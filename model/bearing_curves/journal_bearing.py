"""A bearing alone over speed or load: where its journal rests, its eight coefficients there, and
the mass that they carry without whirling."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import get_args

import numpy as np
from scipy.optimize import brentq

from ..arguments import check_one_of
from ..film.bearing_film import PAD
from ..laws_at_rest.oil import oil_of_both, with_oil
from ..linear.bearing_equilibrium import BearingAlone, critical_mass
from ..linear.modes import LEAST_GROWTH
from ..linear.static import Values, speeds_and_loads, under_its_weight, without_rounding
from ..linear.system_at_speed import LinearError
from ..machine.rotor import Rotor
from ..parts.floating_ring_bearing import FloatingRingBearing
from ..parts.journal_bearing import JournalBearing
from ..parts.load import Load
from ..parts.rolling_bearing import RollingBearing
from ..parts.speed_table import interpolant
from ..parts.squeeze_film_damper import SqueezeFilmDamper
from ..quantities import GRAVITY, STANDARD_GRAVITY
from .reynolds_2d import film_in_plane

AnyBearing = JournalBearing | SqueezeFilmDamper | RollingBearing | FloatingRingBearing
_HALVINGS = 30
_ROUNDING = 1e-12  # of the clearance, and of the largest coefficient
_NO_LOAD = 1e-7  # of a force of the film's size: left of pads' angles that are given to six digits
_ALONG = 1e-9  # rad: the attitude of a journal that moves along its load
# Of stiffness over speed squared: of these a whirl that pads follow is looked for.
_MASSES = np.geomspace(1e-6, 1e6, 145)
ANGLES = np.radians(np.arange(0.0, 361.0, 3.0))  # of `BearingCurves.around`


@dataclass(frozen=True)
class BearingCurves:
    """A journal bearing over n speeds [rad/s], or loads.

    bearing: its name; clearance, journal_radius [m]; load: on the journal, to the right and
    upwards, shape (n, 2) [N]; x, y [m], eccentricity [1], attitude [rad], film [m], pressure [Pa],
    torque [N.m], power [W], flow [m3/s], shape (n,); around: pressure in the middle of the length
    every 3 degrees from the right, anticlockwise, shape (n, 121) [Pa]; K [N/m], C [N.s/m], shape
    (n, 2, 2), at the frequency of rotation, which pads that tilt follow; mass: on the bearing
    [kg], which across the shaft weighs the first load unless the machine has constant forces;
    critical_mass [kg], whirl: frequency at that mass, which pads follow [rad/s]; turns: speeds
    [rad/s] at which `mass` begins or ends to whirl, from the slowest on, or loads [N] at which a
    mass that weighs the load does, if the loads vary, shape (k,);
    threshold: the slowest speed at which `mass` whirls [rad/s], None if it does at none or the
    loads vary; plane_error: of the load, against a two-dimensional solution [1], nan without a
    load; viscosity [Pa.s], temperature [degC]: of the lubricant, shape (n,), None where no heat
    balance gives it; pads: of m pads the first and last angle, the angle of the pivot [rad], the
    clearance and x, y of the journal from the pad's centre when it is in the bearing's, over the
    clearance [1], shape (m, 6); tilts: of pads that tilt, how far, and how far the pivot gives,
    shape (n, m, 2) [m]; pad_loads: what each bears, shape (n, m) [N].
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
    turns: np.ndarray
    threshold: float | None
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


def bearing_curves(
    rotor: Rotor, speeds: Values, *, bearing: str | None = None, load: float | Values | None = None
) -> BearingCurves:
    """Return a journal bearing's equilibrium and coefficients at each speed [rad/s] or load.

    bearing: its name, the first by default; load: along gravity [N], one or several, by default
    what the machine's weight and loads put on it. Raises `LinearError` if there is no such bearing
    or no equilibrium, or if there are several of both.
    """
    known = {name: p for name, p in rotor.named_parts() if isinstance(p, JournalBearing)}
    if not known:
        raise LinearError("the machine has no [[journal_bearing]]")
    name = bearing or next(iter(known))
    check_one_of(f"bearing = {name}", name, known, LinearError)
    is_over_load = load is not None and np.size(load) > 1
    part = with_oil(known[name], name, rotor.downwards)
    speeds, loads = speeds_and_loads(rotor, name, speeds, load)
    rows = []
    start = None
    for i, speed in enumerate(speeds):
        alone = BearingAlone(part, speed, name)
        if load is None and abs(loads[i]) <= _NO_LOAD * _viscous(alone):
            loads[i] = 0.0
        on = complex(loads[i])
        start = alone.rest(on, None if on == 0.0 else start)
        is_off = abs(start) > _ROUNDING * part.clearance
        rows.append(_row(alone, part, on, start if is_off else 0j))
    columns = {key: np.array([row[key] for row in rows]) for key in rows[0]}
    gravity = (rotor.gravity or GRAVITY) * abs(rotor.weight_share or 1.0)
    mass = float(abs(loads[0])) / gravity
    if load is None and rotor.of_kind(Load):
        weights = speeds_and_loads(under_its_weight(rotor), name, speeds[:1])[1]
        mass = float(abs(weights[0])) / STANDARD_GRAVITY
    masses = np.abs(loads) / gravity if is_over_load else np.full(len(loads), mass)
    stable = columns["critical_mass"] >= masses
    places = np.argsort(np.abs(loads)) if is_over_load else _from_slowest(speeds)
    courses = np.abs(loads) if is_over_load else speeds, speeds, loads, masses
    turns = [
        _turn(part, name, [of[[a, b]] for of in courses], bool(stable[a]))
        for a, b in pairwise(places)
        if stable[a] != stable[b]
    ]
    threshold = None
    if not is_over_load:
        threshold = next(iter(turns), None) if stable[places[0]] else float(speeds[places[0]])
    return BearingCurves(
        bearing=name,
        clearance=part.clearance,
        journal_radius=part.journal_radius,
        speeds=np.array(speeds),
        load=np.column_stack([loads.real, loads.imag]),
        mass=mass,
        turns=np.array(turns),
        threshold=threshold,
        temperature=_temperatures(known[name], np.array(speeds), rotor.downwards),
        pads=_pads(part),
        **columns,
    )


def _row(alone: BearingAlone, part: JournalBearing, load: complex, d: complex) -> dict[str, object]:
    K, C = (without_rounding(of, _ROUNDING * np.abs(of).max()) for of in alone.coefficients(d))
    mass, whirl = _critical_mass(alone, d, K, C)
    known = alone.outputs(d)
    names = ("eccentricity", "film", "pressure", "torque", "power", "flow")
    tilts = alone.tilts(d)
    in_plane = film_in_plane(part, alone.speed, d, tilts=tilts, viscosity=alone.viscosity)
    # without a load both are what is left where the forces of the pads cancel
    is_compared = load != 0.0 and in_plane != 0.0
    error = abs(alone.force(d) - in_plane) / abs(in_plane) if is_compared else math.nan
    return {name: known[name] for name in names} | {
        "attitude": known["attitude"] if abs(known["attitude"]) > _ALONG else 0.0,
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


def _critical_mass(
    alone: BearingAlone, d: complex, K: np.ndarray, C: np.ndarray
) -> tuple[float, float]:
    """Return `critical_mass` of a journal at rest at d [m]; K, C: at the frequency of rotation.

    Pads that tilt follow a whirl at its own frequency: looked for is the smallest mass of which a
    motion grows.
    """
    size = np.abs(K).max()
    if not len(alone.tilts(d)) or alone.speed == 0.0 or size == 0.0:
        return critical_mass(K, C)
    root = alone.root_of_mass(d)

    def growth(mass: float) -> float:
        return root(mass).real - LEAST_GROWTH * abs(alone.speed)

    masses = size / alone.speed**2 * _MASSES
    first = next((i for i, mass in enumerate(masses) if growth(mass) > 0.0), None)
    if not first:
        return (math.inf if first is None else 0.0), 0.0
    mass = brentq(growth, masses[first - 1], masses[first])
    return mass, abs(root(mass).imag)


def _viscous(alone: BearingAlone) -> float:
    """Return a force of the film's size [N]."""
    part = alone.part
    slender = part.journal_radius / part.clearance
    return alone.viscosity * abs(alone.speed) * slender**2 * part.journal_radius * part.length


def _temperatures(
    part: JournalBearing, speeds: np.ndarray, downwards: complex
) -> np.ndarray | None:
    """Return the temperature of the lubricant at each speed [degC], as its table over the speed has
    it; None without a heat balance."""
    if not part.temperature:
        return None
    positive, negative = (
        interpolant(oil.speed, oil.temperature)(
            np.clip(np.abs(speeds), oil.speed[0], oil.speed[-1])
        )
        for oil in oil_of_both(part, downwards)[:2]
    )
    return np.where(speeds < 0.0, negative, positive)


def _pads(part: JournalBearing) -> np.ndarray:
    """Return `BearingCurves.pads`."""
    rows = np.array(part.pad_rows())
    pivots = np.arctan2(rows[:, PAD.pivot_y], rows[:, PAD.pivot_x])
    shape = (PAD.first, PAD.last, PAD.clearance, PAD.x, PAD.y)
    return np.insert(rows[:, shape], 2, pivots, axis=1)


def _from_slowest(speeds: np.ndarray) -> np.ndarray:
    """Return the places of speeds from the slowest on; where some are of either sense of rotation,
    of those above 0."""
    order = np.argsort(speeds)
    ahead = order[speeds[order] >= 0.0]
    return ahead if len(ahead) else order[::-1]


def _turn(part: JournalBearing, name: str, ends: list[np.ndarray], is_first_stable: bool) -> float:
    """Return the value of what varies, the speed [rad/s] or the load [N], at which the mass that
    goes with it begins, or ends, to whirl; ends: what varies, speed, load and mass at both ends,
    between which they are linear."""
    varied, *others = ends
    low, high = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        speed, load, mass = (of[0] + middle * (of[1] - of[0]) for of in others)
        alone = BearingAlone(part, speed, name)
        d = alone.rest(load)
        is_stable = _critical_mass(alone, d, *alone.coefficients(d))[0] >= mass
        low, high = (middle, high) if is_stable == is_first_stable else (low, middle)
    return float(varied[0] + 0.5 * (low + high) * (varied[1] - varied[0]))
