"""Tables of bearings by themselves."""

from __future__ import annotations

import math

import numpy as np

from ..model.linear.bearing import BearingCurves
from ..model.linear.damper import DamperCurves
from ..model.linear.rolling import RollingCurves
from .linear_tables import Table


def bearing_table(result: BearingCurves) -> Table:
    """Return a table with one row for each speed; the threshold of stability in the heading."""
    heads = (
        *("speed [rad/s]", "load [N]", "e/c [1]", "attitude [deg]", "film [um]", "p max [MPa]"),
        *("kxx [N/m]", "kxy", "kyx", "kyy", "cxx [N.s/m]", "cxy", "cyx", "cyy"),
        *("torque [N.m]", "critical mass [kg]", "whirl [1]", "off 2D [%]"),
    )
    oil = {}
    if np.ptp(result.viscosity) > 0.0 or result.temperature is not None:
        oil["viscosity [mPa.s]"] = 1e3 * result.viscosity
    if result.temperature is not None:
        oil["oil [degC]"] = result.temperature
    rows = [
        (
            *(float(speed), float(np.hypot(*result.load[i])), float(result.eccentricity[i])),
            *(math.degrees(result.attitude[i]), float(result.film[i]) * 1e6),
            float(result.pressure[i]) / 1e6,
            *(float(value) for of in (result.K[i], result.C[i]) for value in of.ravel()),
            *(float(result.torque[i]), float(result.critical_mass[i])),
            float(result.whirl[i] / speed) if speed else 0.0,
            100 * float(result.plane_error[i]),
            *(float(values[i]) for values in oil.values()),
        )
        for i, speed in enumerate(result.speeds)
    ]
    return Table(f"{result.bearing}: {_stability(result)}", (*heads, *oil), rows)


def _stability(result: BearingCurves) -> str:
    """Return which mass whirls, and where."""
    if len(result.speeds) > 1 and result.speeds[0] == result.speeds[-1]:
        masses = np.hypot(*result.load.T) * (result.mass / np.hypot(*result.load[0]))
        whirls = bool(result.critical_mass[0] < masses[0])
        if result.threshold_load is None:
            return f"a mass that weighs its load {'whirls' if whirls else 'does not whirl'}"
        side = "below" if whirls else "above"
        return f"a mass that weighs its load whirls {side} {result.threshold_load:.6g} N"
    if result.threshold is None:
        return f"a mass of {result.mass:.4g} kg on it does not whirl"
    already = "already " if result.threshold == result.speeds[0] else ""
    at = f"{result.threshold:.6g} rad/s"
    return f"a mass of {result.mass:.4g} kg on it whirls {already}above {at}"


def damper_table(result: DamperCurves) -> Table:
    """Return a table with one row for each orbit; in the heading where the ring rests."""
    heads = (
        *("orbit e/c [1]", "film's stiffness [N/m]", "damping [N.s/m]", "p max [MPa]"),
        "power [W]",
    )
    rows = [
        (*(float(each) for each in (e, k, c)), float(p) / 1e6, float(power))
        for e, k, c, p, power in zip(
            *(result.orbit, result.stiffness, result.damping, result.pressure, result.power),
            strict=True,
        )
    ]
    (kxx, kxy), (kyx, kyy) = result.K
    (cxx, cxy), (cyx, cyy) = result.C
    title = (
        f"{result.bearing}: rests at e/c = {result.eccentricity:.4g} under "
        f"{np.hypot(*result.load):.4g} N; there kxx {kxx:.4g}, kxy {kxy:.4g}, kyx {kyx:.4g}, "
        f"kyy {kyy:.4g} N/m, cxx {cxx:.4g}, cxy {cxy:.4g}, cyx {cyx:.4g}, cyy {cyy:.4g} N.s/m\n"
        f"Centred circular orbits at {result.frequency:.6g} rad/s"
    )
    return Table(title, heads, rows)


def rolling_table(result: RollingCurves) -> Table:
    """Return a table with one row for each load; in the heading the cage's speed."""
    heads = (
        *("speed [rad/s]", "load [N]", "x [um]", "y [um]", "largest [N]", "loaded"),
        *("kxx [N/m]", "kxy", "kyx", "kyy", "cxx [N.s/m]", "cxy", "cyx", "cyy"),
        *("kxx passing [N/m]", "kyy passing [N/m]"),
    )
    rows = [
        (
            *(float(speed), float(np.hypot(*result.load[i]))),
            *(float(result.x[i]) * 1e6, float(result.y[i]) * 1e6),
            *(float(result.largest[i]), int(result.loaded[i])),
            *(float(value) for of in (result.K[i], result.C[i]) for value in of.ravel()),
            *(_span(result.K_passing[i, :, axis, axis]) for axis in range(2)),
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
    return f"{values.min():.4g} to {values.max():.4g}"
