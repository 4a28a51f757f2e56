"""The settings of a recorded run, for the controls of the page."""

import numpy as np

from ..errors import InputError
from ..fmi.packing.machine_files import Machine, machine_of
from ..fmi.solver_parameters import REDUCTION
from ..runs.recording import Recording
from .controls import NO_CONTROLS

_STRAIGHT = 1e-6  # of the largest speed: how far a ramp may be from a straight line


def machine_of_run(run: Recording) -> Machine:
    """Return the machine of a run. Raises `InputError` if the recording holds none."""
    if run.rotor is None:
        raise InputError(f"{run.name}: its recording holds no machine")
    parameters = run.about.get("parameters", {})
    return machine_of(str(run.about["toml"]), False, int(parameters.get(REDUCTION.name, 0)))


def settings_of_run(run: Recording, machine: Machine) -> dict[str, float]:
    """Return the values of controls, SI units, under which a page repeats a run: its parameters and
    the course of its speed.

    Raises `InputError` for a speed that is neither constant nor changes at one rate.
    """
    starts = {v.name: v.start for v in machine.table if v.causality == "parameter"}
    parameters = {
        name: float(value)
        for name, value in run.about.get("parameters", {}).items()
        if name in starts and name not in NO_CONTROLS and value != starts[name]
    }
    return parameters | _course(run)


def _course(run: Recording) -> dict[str, float]:
    t, w = run.t - run.t[0], run.w
    duration, first, last = float(t[-1]), float(w[0]), float(w[-1])
    line = first + (last - first) * t / (duration or 1.0)
    if np.abs(w - line).max() > _STRAIGHT * np.abs(w).max():
        raise InputError(
            f"{run.name}: its speed does not change at one rate; a page has no other course"
        )
    if abs(last - first) <= _STRAIGHT * abs(first):
        return {"course.from": first, "course.to": first, "course.hold": duration}
    return {"course.from": first, "course.to": last, "course.rate": abs(last - first) / duration}
