"""What a user chooses about the integration, with the named presets."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

from .march.control import ADAPTIVE, CONTROLLED, FIXED, Control
from .march.paper_control import (
    INCREMENT_NORM,
    LI_ZENG_WIBERG,
    MIXED_NORM,
    ZIENKIEWICZ_XIE,
)
from .refusal import Refusal
from .schemes import family as schemes

# The parameters that each method takes.
METHODS = {
    "newmark": (),
    "hht": ("alpha_f",),
    "wbz": ("alpha_m",),
    "generalized-alpha": ("alpha_f", "alpha_m"),
    "chung-hulbert": ("rho",),
}
MODES = {"fixed": FIXED, "adaptive": ADAPTIVE, "controlled": CONTROLLED}
# name: (indicator, whether with the constant that is right for generalized-alpha)
INDICATORS = {
    "zienkiewicz-xie": (ZIENKIEWICZ_XIE, False),
    "zienkiewicz-xie-corrected": (ZIENKIEWICZ_XIE, True),
    "li-zeng-wiberg": (LI_ZENG_WIBERG, False),
    "li-zeng-wiberg-corrected": (LI_ZENG_WIBERG, True),
}
NORMS = {"increment": INCREMENT_NORM, "mixed": MIXED_NORM}


# What decides the step length in each mode, besides h.
_OF_MODE = {
    "fixed": (),
    "adaptive": ("h_min", "h_max", "eps_min", "eps_max", "indicator", "norm"),
    "controlled": ("h_min", "h_max", "tolerance"),
}
# Whatever any mode looks at; the last two only where the norm is mixed.
_STEP_CONTROL = tuple(dict.fromkeys(chain(*_OF_MODE.values(), ("atol", "rtol"))))


class SettingsError(Refusal, ValueError):
    """Settings that no run can have; names the setting, its value and what is allowed."""


@dataclass(frozen=True)
class Settings:
    """Integrator and step control.

    method: one of `METHODS`, with the parameters that it takes of alpha_f, alpha_m, rho [1];
    mode: `fixed`, `adaptive` (paper A's) or `controlled`; h: step length, where it varies the first
    [s]; h_min, h_max: where it varies [s]. Of the adaptive mode: eps_min, eps_max, limits of the
    relative error [1]; indicator, one of `INDICATORS`; norm, `increment` or `mixed`, the latter
    with atol [m] and rtol [1]. Of the controlled mode: tolerance, relative, at most 1 [1].
    fitted: whether the method is fitted to the pace of the motion (`fitting`).
    reduction: component modes to keep of the shaft (`reduction`); 0: the whole shaft.

    Raises `SettingsError`.
    """

    method: str = "chung-hulbert"
    alpha_f: float = 0.0
    alpha_m: float = 0.0
    rho: float = 0.2
    mode: str = "fixed"
    h: float = 5e-4
    h_min: float = 0.004
    h_max: float = 0.02
    eps_min: float = 0.1
    eps_max: float = 0.3
    indicator: str = "zienkiewicz-xie"
    norm: str = "increment"
    atol: float = 1e-6
    rtol: float = 1e-3
    tolerance: float = 1e-3
    fitted: bool = False
    reduction: int = 0

    def __post_init__(self) -> None:
        for name, allowed in (
            ("method", METHODS),
            ("mode", MODES),
            ("indicator", INDICATORS),
            ("norm", NORMS),
        ):
            if getattr(self, name) not in allowed:
                raise SettingsError(
                    f"{name} = {getattr(self, name)!r}: must be one of {', '.join(allowed)}"
                )
        if not isinstance(self.fitted, bool):
            raise SettingsError(f"fitted = {self.fitted!r}: must be true or false")
        for name in ("h", "h_min", "h_max", "eps_min", "eps_max", "atol", "rtol", "tolerance"):
            value = getattr(self, name)
            if isinstance(value, bool) or not isinstance(value, (int, float)):
                raise SettingsError(f"{name} = {value!r}: must be a number")
            most = 1.0 if name == "tolerance" else math.inf
            if not math.isfinite(value) or not 0 < value <= most:
                bound = "finite" if most == math.inf else f"at most {most:g}"
                raise SettingsError(f"{name} = {value:g}: must be > 0 and {bound}")
        if self.mode != "fixed" and not self.h_min <= self.h <= self.h_max:
            raise SettingsError(
                f"h = {self.h:g} s: must lie between h_min = {self.h_min:g} s "
                f"and h_max = {self.h_max:g} s"
            )
        if self.mode == "adaptive" and not self.eps_min < self.eps_max:
            raise SettingsError(
                f"eps_min = {self.eps_min:g}: must be below eps_max = {self.eps_max:g}"
            )
        if self.reduction != int(self.reduction) or self.reduction < 0:
            raise SettingsError(f"reduction = {self.reduction}: must be an integer >= 0")
        try:
            self.scheme()
        except schemes.SchemeError as error:
            raise SettingsError(str(error)) from error

    def scheme(self) -> schemes.Scheme:
        """The integrator's parameters; raises `schemes.SchemeError` for impossible ones."""
        if self.method == "newmark":
            return schemes.newmark()
        if self.method == "hht":
            return schemes.hht(self.alpha_f)
        if self.method == "wbz":
            return schemes.wbz(self.alpha_m)
        if self.method == "generalized-alpha":
            return schemes.generalized_alpha(self.alpha_f, self.alpha_m)
        return schemes.chung_hulbert(self.rho)

    def control(self) -> Control:
        """The step control, in the form that the compiled loop takes."""
        scheme = self.scheme()
        indicator, is_corrected = INDICATORS[self.indicator]
        shift = (scheme.alpha_m - scheme.alpha_f) / 2
        return Control(
            mode=MODES[self.mode],
            h_min=self.h_min,
            h_max=self.h_max,
            eps_min=self.eps_min,
            eps_max=1.0 if self.mode == "controlled" else self.eps_max,
            indicator=indicator,
            beta_error=scheme.beta + (shift if is_corrected else 0.0),
            norm=NORMS[self.norm],
            atol=self.atol,
            rtol=self.rtol,
            tolerance=self.tolerance,
            error_constant=scheme.beta + shift - 1 / 6,
            is_fitted=self.fitted,
        )


PRESETS = {
    # Chung and Hulbert with strong high-frequency damping: no run fell into the false state.
    "robust": Settings(method="chung-hulbert", rho=0.2, h=5e-4),
    # Paper A's run: Figs 3 to 6.
    "paper": Settings(method="generalized-alpha", alpha_f=0.1, alpha_m=0.08, h=0.004),
    # Paper A's run with variable step: Figs 11 to 15. It gives no limits; with these the run-down
    # takes some 8000 steps at the accuracy of the fixed step (docs/reproduction.md).
    "paper-adaptive": Settings(
        method="generalized-alpha",
        alpha_f=0.1,
        alpha_m=0.08,
        mode="adaptive",
        h=0.004,
        h_min=0.004,
        h_max=0.02,
        eps_min=0.5,
        eps_max=1.0,
    ),
    # Paper B's moderate dissipation, Abaqus' default for contact.
    "moderate": Settings(method="hht", alpha_f=math.sqrt(2) - 1, h=5e-4),
    # Steps as long as the tolerance allows; no run fell into the false state.
    "controlled": Settings(
        method="chung-hulbert",
        rho=0.3,
        mode="controlled",
        h=1e-5,
        h_min=1e-9,
        h_max=5e-3,
        fitted=True,
    ),
}
DEFAULT_PRESET = "controlled"


def choose(preset: str = DEFAULT_PRESET, **changes: Any) -> Settings:
    """A preset with some settings changed.

    Raises `SettingsError` for impossible ones, for a method without the parameters that it takes,
    and for a parameter that the method does not take.
    """
    if preset not in PRESETS:
        raise SettingsError(f"preset = {preset!r}: must be one of {', '.join(PRESETS)}")
    base = PRESETS[preset]
    method = changes.get("method", base.method)
    if method in METHODS:
        for name in ("alpha_f", "alpha_m", "rho"):
            if name in changes and name not in METHODS[method]:
                raise SettingsError(
                    f"{name} = {changes[name]:g}: {method} does not take it; set the method too"
                )
            if name in METHODS[method] and method != base.method and name not in changes:
                raise SettingsError(f"method = {method}: needs {name} too")
    return replace(base, **changes)


def without_effect(settings: Settings, names: Iterable[str]) -> list[str]:
    """A sentence for each of these settings that changes nothing in the mode of step control."""
    looked_at = _OF_MODE[settings.mode]
    if "norm" in looked_at and settings.norm == "mixed":
        looked_at += ("atol", "rtol")
    idle = [name for name in names if name in _STEP_CONTROL and name not in looked_at]
    why = f"has no effect in the mode {settings.mode}"
    if settings.mode == "adaptive":
        why += f" with the norm {settings.norm}"
    return [f"{name} = {_shown(getattr(settings, name))}: {why}" for name in idle]


def _shown(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:g}"
