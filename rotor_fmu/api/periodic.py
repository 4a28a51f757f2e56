"""Periodic answers: `rf.response`."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..model.machine.rotor import Rotor
from .machine import Machine

if TYPE_CHECKING:
    from ..periodic.result import ResponseResult


def response(machine: Machine | Rotor | Path | str, **options: Any) -> "ResponseResult":
    """Periodic motions of a machine with its contacts, over its speed or another parameter: see
    `rotor_fmu.periodic.request.answer` for the options.

    >>> import rotor_fmu as rf
    >>> found = rf.response("examples/jeffcott_rub/jeffcott.toml", speed=(60, 240))
    >>> [(b.kind, round(b.value, 2)) for b in found.bifurcations]
    [('fold', 202.21), ('grazing', 138.5)]
    """
    from ..periodic.request import answer  # with SciPy, which runs do without

    return answer(machine.rotor if isinstance(machine, Machine) else machine, **options)
