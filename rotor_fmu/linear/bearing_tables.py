"""Tables of bearings by themselves."""

from __future__ import annotations

import math

import numpy as np

from ..display import current, speed_with_unit
from ..model.linear.damper_curves import DamperCurves
from ..model.linear.floating_ring_curves import RingCurves
from ..model.linear.journal_bearing_curves import BearingCurves
from ..model.linear.rolling_bearing_curves import RollingCurves
from .linear_tables import Table


def bearing_table(result: BearingCurves) -> Table:
    """Return a table with one row for each speed; the threshold of stability in the heading."""
    d = current()
    heads = (
        *(f"speed [{d.speed_unit}]", f"load [{d.force_unit}]", "e/c [1]", "attitude [deg]"),
        *(f"film [{d.small_word}]", f"p max [{d.pressure_unit}]"),
        *_coefficient_heads(),
        *(f"torque [{d.torque_unit}]", f"critical mass [{d.mass_unit}]", "whirl [1]"),
        "off 2D [%]",
    )
    oil = {}
    if np.ptp(result.viscosity) > 0.0 or result.temperature is not None:
        oil["viscosity [mPa.s]"] = 1e3 * result.viscosity
    if result.temperature is not None:
        oil["oil [degC]"] = result.temperature
    rows = [
        (
            *(float(speed) * d.speed, float(np.hypot(*result.load[i])) * d.force),
            *(float(result.eccentricity[i]), math.degrees(result.attitude[i])),
            *(float(result.film[i]) * d.small, float(result.pressure[i]) * d.pressure),
            *_coefficients(result.K[i], result.C[i]),
            *(float(result.torque[i]) * d.torque, float(result.critical_mass[i]) * d.mass),
            float(result.whirl[i] / speed) if speed else 0.0,
            100 * float(result.plane_error[i]),
            *(float(values[i]) for values in oil.values()),
        )
        for i, speed in enumerate(result.speeds)
    ]
    return Table(f"{result.bearing}: {_stability(result)}", (*heads, *oil), rows)


def _coefficient_heads() -> tuple[str, ...]:
    d = current()
    return (
        *(f"kxx [{d.stiffness_unit}]", "kxy", "kyx", "kyy"),
        *(f"cxx [{d.damping_unit}]", "cxy", "cyx", "cyy"),
    )


def _coefficients(K: np.ndarray, C: np.ndarray) -> list[float]:
    d = current()
    return [float(value) for of in (K * d.stiffness, C * d.damping) for value in of.ravel()]


def _stability(result: BearingCurves) -> str:
    """Return which mass whirls, and where."""
    d = current()
    if len(result.speeds) > 1 and result.speeds[0] == result.speeds[-1]:
        masses = np.hypot(*result.load.T) * (result.mass / np.hypot(*result.load[0]))
        whirls = bool(result.critical_mass[0] < masses[0])
        if result.threshold_load is None:
            return f"a mass that weighs its load {'whirls' if whirls else 'does not whirl'}"
        side, load = "below" if whirls else "above", result.threshold_load * d.force
        return f"a mass that weighs its load whirls {side} {load:.6g} {d.force_unit}"
    mass = f"a mass of {result.mass * d.mass:.4g} {d.mass_unit} on it"
    if result.threshold is None:
        return f"{mass} does not whirl"
    already = "already " if result.threshold == result.speeds[0] else ""
    at = f"{speed_with_unit(result.threshold)} ({result.threshold:.6g} rad/s)"
    return f"{mass} whirls {already}above {at}"


def damper_table(result: DamperCurves) -> Table:
    """Return a table with one row for each orbit; in the heading where the ring rests."""
    d = current()
    heads = (
        *("orbit e/c [1]", f"film's stiffness [{d.stiffness_unit}]"),
        *(f"damping [{d.damping_unit}]", f"p max [{d.pressure_unit}]", "power [W]"),
    )
    rows = [
        (
            *(float(e), float(k) * d.stiffness, float(c) * d.damping),
            *(float(p) * d.pressure, float(power)),
        )
        for e, k, c, p, power in zip(
            *(result.orbit, result.stiffness, result.damping, result.pressure, result.power),
            strict=True,
        )
    ]
    (kxx, kxy), (kyx, kyy) = result.K * d.stiffness
    (cxx, cxy), (cyx, cyy) = result.C * d.damping
    title = (
        f"{result.bearing}: rests at e/c = {result.eccentricity:.4g} under "
        f"{np.hypot(*result.load) * d.force:.4g} {d.force_unit}; there kxx {kxx:.4g}, "
        f"kxy {kxy:.4g}, kyx {kyx:.4g}, kyy {kyy:.4g} {d.stiffness_unit}, "
        f"cxx {cxx:.4g}, cxy {cxy:.4g}, cyx {cyx:.4g}, cyy {cyy:.4g} {d.damping_unit}\n"
        f"Centred circular orbits at {speed_with_unit(result.frequency)}"
    )
    return Table(title, heads, rows)


def ring_table(result: RingCurves) -> Table:
    """Return a table with one row for each speed or load."""
    d = current()
    heads = (
        *(f"speed [{d.speed_unit}]", f"load [{d.force_unit}]", f"ring [{d.speed_unit}]"),
        *("ratio [1]", "e/c [1]", "outer e/c [1]", *_coefficient_heads()),
        *(f"torque [{d.torque_unit}]", "power [W]", "outer [W]"),
    )
    rows = [
        (
            *(float(speed) * d.speed, float(np.hypot(*result.load[i])) * d.force),
            *(float(result.ring_speed[i]) * d.speed, float(result.ratio[i])),
            *(float(result.eccentricity[i]), float(result.outer_eccentricity[i])),
            *_coefficients(result.K[i], result.C[i]),
            *(float(result.torque[i]) * d.torque, float(result.power[i])),
            float(result.outer_power[i]),
        )
        for i, speed in enumerate(result.speeds)
    ]
    title = f"{result.bearing}: the ring turns at {_span(result.ratio)} of the rotor's speed"
    return Table(title, heads, rows)


def rolling_table(result: RollingCurves) -> Table:
    """Return a table with one row for each load; in the heading the cage's speed."""
    d = current()
    small, force = d.small_word, d.force_unit
    heads = (
        *(f"speed [{d.speed_unit}]", f"load [{force}]", f"x [{small}]", f"y [{small}]"),
        *(f"largest [{force}]", "loaded"),
        *_coefficient_heads(),
        *(f"{name} passing [{d.stiffness_unit}]" for name in ("kxx", "kyy")),
    )
    rows = [
        (
            *(float(speed) * d.speed, float(np.hypot(*result.load[i])) * d.force),
            *(float(result.x[i]) * d.small, float(result.y[i]) * d.small),
            *(float(result.largest[i]) * d.force, int(result.loaded[i])),
            *_coefficients(result.K[i], result.C[i]),
            *(_span(result.K_passing[i, :, axis, axis] * d.stiffness) for axis in range(2)),
        )
        for i, speed in enumerate(result.speeds)
    ]
    count = len(result.angles)
    return Table(
        f"{result.bearing}: {count} elements, as they stand at the start; one passes "
        f"{count * result.ratio:.5g} times in a revolution",
        heads,
        rows,
    )


def _span(values: np.ndarray) -> str:
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    return low if low == high else f"{low} to {high}"
