"""The linear critical speeds of a machine that ran, to compare its peaks with."""

from typing import Any, NamedTuple

import numpy as np

from ..display import current
from ..model.linear.campbell import campbell
from ..model.linear.linear_machine import LinearError, shared_machine
from ..model.linear.linearization import OPEN, PINNED
from ..model.linear.modes import count_up_to
from ..model.linear.static import lowest_speed
from ..model.machine.rotor import Rotor
from ..runs.recording import Recording
from ..vibration import TURN

_SPEEDS, _MODES, _MOST = 15, 8, 6
_ONE = 1e-6  # of a speed: critical speeds that lie closer are one
_LEAST = 0.02  # of the highest speed: below lie rigid-body motions


class Criticals(NamedTuple):
    """The lowest critical speeds [Hz], ascending, negative where the shaft turned backward;
    contacts: how the clearances were taken, empty without; found: how many there are."""

    hz: tuple[float, ...]
    contacts: str
    found: int = 0

    @property
    def sentence(self) -> str:
        """What is to be said of them."""
        if not self.hz:
            return ""
        in_unit = [hz * TURN * current().speed for hz in self.hz]
        digits = 1 if max(in_unit) < 1e3 else 0
        listed = " and ".join(f"{value:.{digits}f}" for value in in_unit)
        listed = listed.replace(" and ", ", ", len(self.hz) - 2)
        unit, what = current().speed_unit, "Linear critical speeds"
        if len(self.hz) < self.found:
            what = f"The lowest {len(self.hz)} linear critical speeds"
        if not self.contacts:
            return f"{what}, dotted: {listed} {unit}."
        why = {
            PINNED: "a journal that leaves its wall is held less than one that is pinned to it",
            OPEN: "a journal that touches is held more than one that is free",
        }[self.contacts]
        return (
            f"{what} with contacts {self.contacts}, dotted: {listed} {unit}. The run's peaks lie "
            f"elsewhere where contacts open and close: {why}."
        )


NO_CRITICALS = Criticals((), "")


def criticals_of(run: Recording) -> Criticals:
    """Return the critical speeds within a run's range of speeds; none of a machine that was not
    recorded, or that cannot be linearized."""
    speeds = run.w[np.isfinite(run.w)]
    sizes = np.abs(speeds)
    highest = float(sizes.max(initial=0.0))
    rotor = _as_run(run)
    if rotor is None or highest == 0.0 or np.ptp(sizes) < 0.05 * highest:
        return NO_CRITICALS
    lowest = max(float(sizes.min()), _LEAST * highest)
    ways = [way for way in (-1.0, 1.0) if (way * speeds).max() >= lowest]
    try:
        found = [speed for way in ways for speed in _within(rotor, way * lowest, way * highest)]
        machine = shared_machine(rotor)
    except (LinearError, np.linalg.LinAlgError):
        return NO_CRITICALS
    # forward and backward whirl without gyroscopic moments have one
    found = [a for i, a in enumerate(found) if not np.isclose(a, found[:i], rtol=_ONE).any()]
    nearest = sorted(found, key=abs)[:_MOST]
    hz = tuple(sorted(speed / TURN for speed in nearest))
    return Criticals(hz, machine.contacts if machine.has_contacts else "", len(found))


def _within(rotor: Rotor, lowest: float, highest: float) -> list[float]:
    """Return the critical speeds between two speeds of one sense of rotation [rad/s], but for those
    that are critically damped."""
    top = 1.05 * highest
    at = np.sort(np.linspace(lowest_speed(rotor, top), top, _SPEEDS))
    critical = campbell(rotor, at, count=count_up_to(rotor, top, _MODES)).critical
    inside = [c for c in critical if abs(lowest) <= abs(c.speed) <= abs(highest)]
    return [c.speed for c in inside if not c.is_critically_damped]


def _as_run(run: Recording) -> Rotor | None:
    if run.rotor is None:
        return None
    known = run.rotor.numbers()
    given: Any = run.about.get("parameters", {})
    return run.rotor.with_values({n: value for n, value in given.items() if n in known})
