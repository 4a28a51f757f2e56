"""The Python interface, whose names `rotor_fmu.__all__` lists: `import rotor_fmu as rf`."""

from ..errors import InputError, RunFailed
from .fmus import build_fmu, simulate_fmu
from .machine import Machine, load, parse
from .result import Peak, Result, read_run
from .simulate import simulate

__all__ = [
    "InputError",
    "Machine",
    "Peak",
    "Result",
    "RunFailed",
    "build_fmu",
    "load",
    "parse",
    "read_run",
    "simulate",
    "simulate_fmu",
]
