"""The settings of the integration, with the named presets."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..errors import InputError
from ..kernels.kernel import interpreted
from ..message_templates import MOST_ARGUMENTS, Message, fill_template
from ..time_loop.block import METHOD
from . import settings_messages, table
from .resolver import COUNT, encoded, resolve, warning
from .table import DEFAULT_PRESET, DEFAULTS, METHODS, NAMES, SETTINGS, SHAPES, Number


class SettingsError(InputError):
    """Impossible settings; the message names the setting, its value and what is allowed."""


@dataclass(frozen=True)
class Settings:
    """Integrator and step control.

    method: one of `METHODS`, with the parameters that it takes of alpha_f, alpha_m, rho [1];
    mode: `fixed`, `adaptive` (paper A's), `controlled` or `realtime`; h: step length, where it
    varies the first [s]; h_min, h_max: where it varies [s]. Of the adaptive mode: eps_min, eps_max,
    limits of the relative error [1]; indicator, one of `INDICATORS`; norm, `increment` or `mixed`,
    the latter with atol [m] and rtol [1]. Of the controlled mode: tolerance, relative [1]. Of the
    realtime mode: newton_limit, the most iterations of the interfaces' problem in a step.
    max_iterations: of the interfaces' problem in one call of `Simulation.advance`.
    fitted: whether the method is fitted to the characteristic frequency of the motion (`fitting`).
    reduction: component modes to keep of the shaft (`reduction`); 0: the whole shaft.

    Ranges and defaults are those of `table.SETTINGS`. Raises `SettingsError`.
    """

    method: str = DEFAULTS["method"]
    alpha_f: float = DEFAULTS["alpha_f"]
    alpha_m: float = DEFAULTS["alpha_m"]
    rho: float = DEFAULTS["rho"]
    mode: str = DEFAULTS["mode"]
    h: float = DEFAULTS["h"]
    h_min: float = DEFAULTS["h_min"]
    h_max: float = DEFAULTS["h_max"]
    eps_min: float = DEFAULTS["eps_min"]
    eps_max: float = DEFAULTS["eps_max"]
    indicator: str = DEFAULTS["indicator"]
    norm: str = DEFAULTS["norm"]
    atol: float = DEFAULTS["atol"]
    rtol: float = DEFAULTS["rtol"]
    tolerance: float = DEFAULTS["tolerance"]
    fitted: bool = DEFAULTS["fitted"]
    max_iterations: int = DEFAULTS["max_iterations"]
    newton_limit: int = DEFAULTS["newton_limit"]
    reduction: int = 0

    def __post_init__(self) -> None:
        if self.reduction != int(self.reduction) or self.reduction < 0:
            raise SettingsError(f"reduction = {self.reduction}: must be an integer >= 0")
        _ = self.numbers

    @cached_property
    def _given(self) -> np.ndarray:
        values = {name: getattr(self, name) for name in NAMES}
        taken = METHODS.get(values["method"], ())
        return _given(0, {n: v for n, v in values.items() if n not in SHAPES or n in taken})

    @cached_property
    def numbers(self) -> np.record:
        """The record of integrator and step control (`block.METHOD`)."""
        return _resolved(self._given)

    @property
    def warnings(self) -> list[Message]:
        """The warnings that hold for every run with these settings, such as an unstable method."""
        return _warnings(self._given, self._given, self.numbers, [COUNT])


def _given(preset: int, changes: Mapping[str, Any]) -> np.ndarray:
    """Return the settings in the form that the resolver takes."""
    given = np.full(1 + COUNT, np.nan)
    given[0] = preset
    for name, value in changes.items():
        try:
            given[1 + NAMES.index(name)] = encoded(name, value)
        except ValueError as error:
            raise SettingsError(str(error)) from error
    return given


def _resolved(given: np.ndarray) -> np.record:
    """Return the record that the settings resolve to, and fill in `given`; raises
    `SettingsError`."""
    numbers, arguments = np.zeros(1, METHOD).view(np.recarray), np.zeros(MOST_ARGUMENTS)
    code = interpreted(resolve)(given, numbers[0], arguments)
    if code != settings_messages.GOOD:
        raise SettingsError(fill_template(settings_messages.SENTENCES[code], arguments))
    return numbers[0]


def _chosen(given: np.ndarray, reduction: int) -> Settings:
    """Return the settings that the resolver filled in."""
    values: dict[str, Any] = {}
    for setting, number in zip(SETTINGS, given[1:].tolist(), strict=True):
        if isinstance(setting, Number):
            values[setting.name] = int(number) if setting.is_whole else number
        else:
            names = list(setting.values)
            is_switch = isinstance(setting, table.Switch)
            values[setting.name] = bool(number) if is_switch else names[int(number)]
    return Settings(**values, reduction=reduction)


PRESETS = {name: Settings(**of) for name, of in table.PRESETS.items()}


def choose(preset: str = DEFAULT_PRESET, **changes: Any) -> Settings:
    """Return a preset with some settings changed.

    Raises `SettingsError` for impossible ones, for a method without the parameters that it takes,
    and for a parameter that the method does not take.
    """
    if preset not in PRESETS:
        raise SettingsError(f"preset = {preset!r}: must be one of {', '.join(PRESETS)}")
    reduction = changes.pop("reduction", 0)
    unknown = changes.keys() - {*NAMES}
    if unknown:
        raise TypeError(f"choose: there is no setting {', '.join(sorted(unknown))}")
    given = _given(list(PRESETS).index(preset), changes)
    _resolved(given)
    return _chosen(given, reduction)


def settings_of_given(given: np.ndarray, reduction: int) -> tuple[Settings, list[Message]]:
    """Return the settings that an FMU's parameters stand for, in the form that `resolver.resolve`
    takes, and a message for each parameter without effect. Raises `SettingsError`."""
    own = given.copy()
    numbers = _resolved(given)
    return _chosen(given, reduction), _warnings(given, own, numbers, range(COUNT))


def _warnings(
    given: np.ndarray, own: np.ndarray, numbers: np.record, slots: Iterable[int]
) -> list[Message]:
    """Return the warnings of `resolver.warning` about some of the settings."""
    arguments, result = np.zeros(MOST_ARGUMENTS), []
    for slot in slots:
        code = interpreted(warning)(given, own, numbers, arguments, slot)
        if code:
            text = fill_template(settings_messages.SENTENCES[code], arguments)
            result.append(Message(text, settings_messages.CODES[code]))
    return result
