"""A bearing with a floating ring alone over speed or load: where journal and ring rest, how fast
the ring turns, and the coefficients of both films in series."""

from dataclasses import dataclass

import numpy as np

from ..linear.bearing_equilibrium import RingAlone
from ..linear.static import Values, speeds_and_loads
from ..linear.system_at_speed import LinearError
from ..machine.rotor import Rotor
from ..parts.floating_ring_bearing import FloatingRingBearing


@dataclass(frozen=True)
class RingCurves:
    """A floating ring bearing over n speeds [rad/s], or loads.

    bearing: its name; clearance, outer_clearance: of both films [m]; load: on the journal, to the
    right and upwards, shape (n, 2) [N]; x, y: of the journal [m], ring_x, ring_y [m], ring_speed
    [rad/s], ratio: of the ring's speed to the journal's [1], eccentricity of the journal in the
    ring, outer_eccentricity of the ring, over their clearances [1], torque that brakes the rotor
    [N.m], power, outer_power: dissipated in both films [W], shape (n,); K [N/m], C [N.s/m], of the
    journal as it vibrates at the frequency of rotation and the ring follows, shape (n, 2, 2).
    """

    bearing: str
    clearance: float
    outer_clearance: float
    speeds: np.ndarray
    load: np.ndarray
    x: np.ndarray
    y: np.ndarray
    ring_x: np.ndarray
    ring_y: np.ndarray
    ring_speed: np.ndarray
    ratio: np.ndarray
    eccentricity: np.ndarray
    outer_eccentricity: np.ndarray
    torque: np.ndarray
    power: np.ndarray
    outer_power: np.ndarray
    K: np.ndarray
    C: np.ndarray


_OUTPUTS = ("ring_x", "ring_y", "ring_speed", "ratio", "eccentricity", "outer_eccentricity")
_LOSSES = ("torque", "power", "outer_power")


def ring_curves(
    rotor: Rotor, speeds: Values, *, bearing: str, load: float | Values | None = None
) -> RingCurves:
    """Return a floating ring bearing's equilibrium and coefficients at each speed [rad/s], or under
    each load at one.

    bearing: its name; load: along gravity [N], one or several, by default what weight and loads put
    on it. Raises `LinearError` if there is no equilibrium, a speed is 0, or several of both.
    """
    part = dict(rotor.named_parts())[bearing]
    assert isinstance(part, FloatingRingBearing)
    if not np.all(speeds):
        raise LinearError(f"{bearing}: speed = 0 rad/s: must not be 0, where no film carries")
    speeds, loads = speeds_and_loads(rotor, bearing, speeds, load)
    rows, d = [], None
    for speed, on in zip(speeds, loads, strict=True):
        alone = RingAlone(part, speed, bearing, rotor.gravity * rotor.down)
        d = alone.rest(complex(on), None if on == 0.0 else d)
        known = alone.outputs(d)
        K, C = alone.coefficients(d)
        rows.append(
            {"x": d.real, "y": d.imag, "K": K, "C": C}
            | {name: known[name] for name in (*_OUTPUTS, *_LOSSES)}
        )
    return RingCurves(
        bearing=bearing,
        clearance=part.clearance,
        outer_clearance=part.outer_clearance,
        speeds=np.array(speeds),
        load=np.column_stack([loads.real, loads.imag]),
        **{name: np.array([row[name] for row in rows]) for name in rows[0]},
    )
