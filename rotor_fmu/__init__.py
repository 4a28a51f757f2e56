"""Flexible rotors that rub in clearance bearings: machines, runs, and FMI co-simulation components.

    import rotor_fmu as rf

    result = rf.simulate(rf.load("machine.toml"), speed=([0, 40], [400, 0]))
    result.peaks, result.plot("bode"), result.dataframe()

The names of `__all__` are stable; each is imported where it is used first.
"""

from typing import TYPE_CHECKING as _TYPE_CHECKING
from typing import Any as _Any

from .about import __version__

if _TYPE_CHECKING:
    from .api import *  # noqa: F403

__all__ = [
    "InputError",
    "Machine",
    "Peak",
    "Result",
    "RunFailed",
    "__version__",
    "build_fmu",
    "load",
    "parse",
    "read_run",
    "response",
    "simulate",
    "simulate_fmu",
]


def __getattr__(name: str) -> _Any:
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import api

    return getattr(api, name)


def __dir__() -> list[str]:
    return sorted(__all__)
