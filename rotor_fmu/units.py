"""Units that users may write besides SI units; inside, everything is in SI units."""

from __future__ import annotations

import math

# what one of it is in the SI unit above it
_OTHERS = {
    "rad/s": {"rpm": math.pi / 30.0, "Hz": 2.0 * math.pi},
    "s": {"ms": 1e-3, "min": 60.0},
    "N": {"mN": 1e-3, "kN": 1e3},
    "N.m": {"mN.m": 1e-3, "kN.m": 1e3},
    "m/s2": {"g": 9.80665},
}


def units_for(si: str) -> dict[str, float]:
    """Return the units in which a quantity may be given, and the factor of each to the SI unit
    [1]."""
    return {si: 1.0, **_OTHERS.get(si, {})}
