"""A squeeze film damper alone: where its ring rests, its coefficients there, and what its film does
as the ring orbits about the middle of its clearance."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..machine.rotor import Rotor
from ..parts.law_probe import cleared
from ..parts.squeeze_film_damper import SqueezeFilmDamper
from .bearing_equilibrium import BearingAlone
from .static import speeds_and_loads
from .system_at_speed import LinearError

_ORBITS = np.linspace(0.05, 0.95, 19)


@dataclass(frozen=True)
class DamperCurves:
    """A squeeze film damper over n centred circular orbits of a frequency [rad/s].

    bearing: its name; clearance [m]; spring: stiffness of the centring spring [N/m]; load: on the
    ring, to the right and upwards [N]; x, y [m], eccentricity [1] of the ring at rest; K [N/m], C
    [N.s/m] there, shape (2, 2), of a ring that begins to sink; frequency [rad/s]; orbit: radius
    over the clearance [1]; stiffness [N/m]: of the film, negative where it pulls outwards; damping
    [N.s/m], pressure: the largest [Pa], power [W], shape (n,).
    """

    bearing: str
    clearance: float
    spring: float
    load: np.ndarray
    x: float
    y: float
    eccentricity: float
    K: np.ndarray
    C: np.ndarray
    frequency: float
    orbit: np.ndarray
    stiffness: np.ndarray
    damping: np.ndarray
    pressure: np.ndarray
    power: np.ndarray


def damper_curves(
    rotor: Rotor, frequency: float, *, bearing: str, load: float | None = None
) -> DamperCurves:
    """Return a squeeze film damper's equilibrium and coefficients, and those of the orbits of a
    frequency [rad/s] up to where its surfaces touch.

    bearing: its name; load: downwards [N], by default what the machine's weight puts on it. Raises
    `LinearError` if there is no equilibrium.
    """
    if not 0.0 < frequency < np.inf:
        raise LinearError(f"frequency of the orbit = {frequency:g} rad/s: must be > 0 and finite")
    part = dict(rotor.named_parts())[bearing]
    assert isinstance(part, SqueezeFilmDamper)
    on = complex(speeds_and_loads(rotor, bearing, [frequency], load)[1][0])
    alone = BearingAlone(part, 0.0, bearing)
    d = alone.rest(on)
    K, C = alone.coefficients(d)
    c = part.clearance
    orbit = _ORBITS[_ORBITS * c <= c - part.roughness]
    rows = [_orbit(alone, part.stiffness, e * c, frequency) for e in orbit]
    return DamperCurves(
        bearing=bearing,
        clearance=c,
        spring=part.stiffness,
        load=np.array([on.real, on.imag]),
        x=d.real,
        y=d.imag,
        eccentricity=abs(d) / c,
        K=cleared(K),
        C=cleared(C),
        frequency=float(frequency),
        orbit=orbit,
        **{name: np.array([row[name] for row in rows]) for name in rows[0]},
    )


def _orbit(alone: BearingAlone, spring: float, radius: float, frequency: float) -> dict[str, float]:
    """Return what the film does on a circular orbit of a radius [m]; spring [N/m]."""
    v = 1j * frequency * radius
    film = alone.force(radius, v) + spring * radius
    known = alone.outputs(radius, v)
    return {
        "stiffness": -film.real / radius,
        "damping": -film.imag / abs(v),
        "pressure": known["pressure"],
        "power": known["power"],
    }
