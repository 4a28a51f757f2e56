"""The solver's settings, each declared once with its unit, range, default and description; the
settings that each method and each mode uses; the presets. Everything else about settings is made
from this table.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..quantities import Rule, between
from ..time_loop.adaptive_control import INCREMENT_NORM, LI_ZENG_WIBERG, MIXED_NORM, ZIENKIEWICZ_XIE
from ..time_loop.control import ADAPTIVE, CONTROLLED, FIXED, REALTIME

# The parameters that each method takes.
METHODS = {
    "newmark": (),
    "hht": ("alpha_f",),
    "wbz": ("alpha_m",),
    "generalized-alpha": ("alpha_f", "alpha_m"),
    "chung-hulbert": ("rho",),
    "radau5": (),
}
IN_STAGES = "radau5"  # the method that is no member of the family
MODES = {
    "fixed": FIXED,
    "adaptive": ADAPTIVE,
    "controlled": CONTROLLED,
    "realtime": REALTIME,
}
# name: (indicator, whether with the constant that is right for generalized-alpha)
INDICATORS = {
    "zienkiewicz-xie": (ZIENKIEWICZ_XIE, False),
    "zienkiewicz-xie-corrected": (ZIENKIEWICZ_XIE, True),
    "li-zeng-wiberg": (LI_ZENG_WIBERG, False),
    "li-zeng-wiberg-corrected": (LI_ZENG_WIBERG, True),
}
NORMS = {"increment": INCREMENT_NORM, "mixed": MIXED_NORM}


@dataclass(frozen=True)
class Choice:
    """A setting with names for its values; variable: its name in the FMU, if different."""

    name: str
    values: Mapping[str, Any]
    default: Any
    text: str
    variable: str = ""

    def encoded(self, value: Any) -> float:
        """Return the index of a value among the names."""
        if value not in self.values:
            raise ValueError(f"{self.name} = {value!r}: must be one of {', '.join(self.values)}")
        return float(list(self.values).index(value))


@dataclass(frozen=True)
class Switch(Choice):
    """A setting that is false or true."""

    def encoded(self, value: Any) -> float:
        """Return 0 or 1."""
        if not isinstance(value, bool):
            raise ValueError(f"{self.name} = {value!r}: must be true or false")
        return float(value)


@dataclass(frozen=True)
class Number:
    """A setting that is a number within a range.

    unset: the number, outside the range, that stands for "as the preset" in an FMU, where a host
    may set every start value; is_whole: whether it is an integer.
    """

    name: str
    unit: str
    rule: Rule
    default: float
    unset: float
    text: str
    variable: str = ""
    is_whole: bool = False

    def encoded(self, value: Any) -> float:
        """Return the number itself."""
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise ValueError(f"{self.name} = {value!r}: must be a number")
        if math.isnan(value):
            raise ValueError(f"{self.name} = nan: {self.rule.words}")
        if self.is_whole and value != math.inf and value != int(value):
            raise ValueError(f"{self.name} = {value:g}: must be an integer")
        return float(value)


def _positive(most: float, unit: str = "") -> Rule:
    return between(0.0, most, unit, is_strict=True)


_BIG = 1e9
_STEP = _positive(1.0, " s")
_SHARE = between(0.0, 1.0)
_ALPHA = between(-1.0, 1.0, is_below=True)  # 1 leaves no implicit equation
SETTINGS: tuple[Choice | Number, ...] = (
    Choice("method", METHODS, "chung-hulbert", "integrator"),
    Number("alpha_f", "1", _ALPHA, 0.0, 1.0, "alpha_f of hht and generalized-alpha"),
    Number("alpha_m", "1", _ALPHA, 0.0, 1.0, "alpha_m of wbz and generalized-alpha"),
    Number("rho", "1", _SHARE, 0.2, -1.0, "spectral radius at infinity of chung-hulbert"),
    Choice("mode", MODES, "fixed", "step-length control", "adaptive"),
    Switch(
        "fitted",
        {"no": False, "yes": True},
        False,
        "whether the method is fitted to the frequency of the motion",
    ),
    Number(
        "tolerance",
        "1",
        between(1e-9, 1.0),  # below it rounding dominates the error of a step
        1e-3,
        0.0,
        "relative tolerance of the controlled mode",
    ),
    Number("h", "s", _STEP, 5e-4, 0.0, "step length, the first one if it varies"),
    Number("h_min", "s", _STEP, 0.004, 0.0, "shortest step if the step length varies"),
    Number("h_max", "s", _STEP, 0.02, 0.0, "longest step if the step length varies"),
    Number(
        "eps_min", "1", _positive(_BIG), 0.1, 0.0, "adaptive mode: error below which the step grows"
    ),
    Number(
        "eps_max",
        "1",
        _positive(_BIG),
        0.3,
        0.0,
        "adaptive mode: error above which the step is repeated",
    ),
    Choice("indicator", INDICATORS, "zienkiewicz-xie", "error indicator of the adaptive mode"),
    Choice("norm", NORMS, "increment", "norm of the error in the adaptive mode"),
    Number("atol", "m", _positive(1.0, " m"), 1e-6, 0.0, "absolute part of the mixed norm"),
    Number("rtol", "1", _positive(1.0), 1e-3, 0.0, "relative part of the mixed norm"),
    Number(
        "max_iterations",
        "1",
        between(1, 2e9),
        10_000_000,
        0,
        "largest number of iterations of the interface problem in a communication step, which then "
        "ends early, and in the search for the rest at the start; each step counts at least one",
        is_whole=True,
    ),
    Number(
        "newton_limit",
        "1",
        between(1, 1000),
        4,
        0,
        "realtime mode: largest number of iterations of the interface problem in a step, which "
        "then takes what they have reached",
        is_whole=True,
    ),
)
NAMES = tuple(setting.name for setting in SETTINGS)
BY_NAME = dict(zip(NAMES, SETTINGS, strict=True))
DEFAULTS: dict[str, Any] = {setting.name: setting.default for setting in SETTINGS}
# The parameters of the methods.
SHAPES = ("alpha_f", "alpha_m", "rho")
MOST_MODES = 10_000  # of a reduction

# What decides the step length in each mode, besides h; the last two only where the norm is mixed.
_OF_MODE = {
    "fixed": (),
    "adaptive": ("h_min", "h_max", "eps_min", "eps_max", "indicator", "norm"),
    "controlled": ("h_min", "h_max", "tolerance"),
    "realtime": ("newton_limit",),
}
_OF_MIXED = ("atol", "rtol")


def is_idle(name: str, mode: str, norm: str) -> bool:
    """Return whether a setting has no effect in a mode with a norm."""
    used = _OF_MODE[mode] + (_OF_MIXED if mode == "adaptive" and norm == "mixed" else ())
    return name not in used and any(name in of for of in (*_OF_MODE.values(), _OF_MIXED))


PRESETS: dict[str, dict[str, Any]] = {
    # Chung and Hulbert with strong high-frequency damping: no run fell into the false state.
    "robust": {"method": "chung-hulbert", "rho": 0.2, "h": 5e-4},
    # Paper A's run: Figs 3 to 6.
    "paper": {"method": "generalized-alpha", "alpha_f": 0.1, "alpha_m": 0.08, "h": 0.004},
    # Paper A's run with variable step: Figs 11 to 15. It gives no limits; with these the run-down
    # takes some 8000 steps at the accuracy of the fixed step (docs/explanation/reproduction.md).
    "paper-adaptive": {
        "method": "generalized-alpha",
        "alpha_f": 0.1,
        "alpha_m": 0.08,
        "mode": "adaptive",
        "h": 0.004,
        "h_min": 0.004,
        "h_max": 0.02,
        "eps_min": 0.5,
        "eps_max": 1.0,
    },
    # Paper B's moderate dissipation, Abaqus' default for contact.
    "moderate": {"method": "hht", "alpha_f": math.sqrt(2) - 1, "h": 5e-4},
    # Steps as long as the tolerance allows; no run fell into the false state.
    "controlled": {
        "method": "chung-hulbert",
        "rho": 0.3,
        "mode": "controlled",
        "h": 1e-5,
        "h_min": 1e-9,
        "h_max": 5e-3,
        "fitted": True,
    },
    # A controller at 20 kHz in the loop.
    "realtime": {"method": "chung-hulbert", "rho": 0.2, "mode": "realtime", "h": 5e-5},
}
DEFAULT_PRESET = "controlled"
