"""A squeeze film damper alone: where its ring rests, its coefficients there, and what its film does
as the ring orbits about the middle of its clearance."""

from dataclasses import dataclass

import numpy as np

from ..arguments import check_positive
from ..linear.bearing_equilibrium import NO_CAGE, BearingAlone, cage_of
from ..linear.static import speeds_and_loads, static
from ..linear.system_at_speed import LinearError
from ..machine.rotor import Rotor
from ..parts.base import GROUND, MountElement
from ..parts.law_probe import cleared
from ..parts.squeeze_film_damper import SqueezeFilmDamper

_ORBITS = np.linspace(0.05, 0.95, 19)


@dataclass(frozen=True)
class DamperCurves:
    """A squeeze film damper over n centred circular orbits of a frequency [rad/s].

    bearing: its name; clearance [m]; spring: stiffness of the centring spring [N/m]; cage: that of
    the housing that is the ring, in x and y, 0 without, shape (2,) [N/m]; load: on the ring, to the
    right and upwards [N]; x, y [m], eccentricity [1] of the ring at rest; K [N/m], C [N.s/m] there,
    the cage's included, shape (2, 2), of a small vibration; frequency [rad/s]; orbit:
    radius over the clearance [1]; stiffness [N/m]: of the film, negative where it pulls outwards;
    damping [N.s/m], pressure: the largest [Pa], power [W], shape (n,).
    """

    bearing: str
    clearance: float
    spring: float
    cage: np.ndarray
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

    bearing: its name; load: along gravity on the ring, which its cage bears too [N], the damper's
    own housing being fixed; by default what weight and loads put on it. Raises `LinearError`
    if there is no equilibrium.
    """
    check_positive("frequency of the orbit", frequency, "rad/s", LinearError)
    part = dict(rotor.named_parts())[bearing]
    assert isinstance(part, SqueezeFilmDamper)
    alone, hung = (BearingAlone(part, 0.0, bearing, c) for c in (NO_CAGE, cage_of(rotor, part)))
    if part.ring and load is None:
        on, d = _ring_at_rest(rotor, part, bearing, frequency, hung)
    else:
        on = complex(speeds_and_loads(rotor, bearing, [frequency], load)[1][0])
        d = hung.rest(on)
    K, C = hung.coefficients(d)
    c = part.clearance
    orbit = _ORBITS[_ORBITS * c <= c - part.roughness]
    rows = [_orbit(alone, part.stiffness, e * c, frequency) for e in orbit]
    return DamperCurves(
        bearing=bearing,
        clearance=c,
        spring=part.stiffness,
        cage=hung.cage.stiffness,
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


def _ring_at_rest(
    rotor: Rotor, part: SqueezeFilmDamper, name: str, speed: float, hung: BearingAlone
) -> tuple[complex, complex]:
    """Return the load on the housing that is the ring, to the right and upwards [N], and its
    displacement from the damper's housing [m], at rest under gravity at a speed [rad/s]."""
    whole = static(rotor, speed)
    names = [mount.name for _, mount in rotor.elements_of_kind(MountElement)]
    moved = whole.housing_x + 1j * whole.housing_y
    places = {GROUND: 0j} | dict(zip(names, moved.tolist(), strict=True))
    at = places[part.ring]
    (kx, ky), i = hung.cage.stiffness, whole.supports.index(name)
    of_film = complex(whole.load_x[i], whole.load_y[i])
    return of_film + complex(kx * at.real, ky * at.imag), at - places[part.housing]


def _orbit(alone: BearingAlone, spring: float, radius: float, frequency: float) -> dict[str, float]:
    """Return what the film does on a circular orbit of a radius [m]; spring [N/m]."""
    v = 1j * frequency * radius
    of_spring = spring * radius
    film = alone.force(radius, v) + of_spring
    along, across, _ = cleared(np.array([film.real, film.imag, of_spring]))
    known = alone.outputs(radius, v)
    return {
        "stiffness": 0.0 - along / radius,
        "damping": 0.0 - across / abs(v),
        "pressure": known["pressure"],
        "power": known["power"],
    }
