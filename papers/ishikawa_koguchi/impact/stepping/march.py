"""From the start to the end of an experiment, one increment after another.

How an impact is treated, by the names of Abaqus' IMPACT option:

no            the contacts are solved at the end of each increment, and that is all
average-time  the increment in which a contact would open or close is cut back to the mean time of
              these events, where an impulse makes the velocities of the closed contacts compatible
current-time  no cutback; the velocities and accelerations of contacts that have just closed are
              made compatible at the end of the increment
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from rotor_fmu.model.schemes.family import Scheme

from .average_time import PENETRATION, RESTART, average_time
from .failures import ImpactError
from .impulse import compatible_accelerations
from .increments import current_time, solved
from .state import Line, State, openings_of
from .stepper import Instant, Stepper
from .structure import Structure

_INCREMENT = {"no": solved, "average-time": average_time, "current-time": current_time}
IMPACTS = tuple(_INCREMENT)
INCREMENT_CAP = 10_000  # paper B's, section 3.2
_EXPLOSION = 1e6


@dataclass(frozen=True)
class Run:
    """What came out, one row an increment, the start first.

    t: times [s], shape (k,); seen: what the observer returned, shape (k, columns); force: of the
    contacts [N], shape (k, m); energy: kinetic, elastic and potential, shape (k,) [J].
    status: `done`, or why it ended early; solves: linear solutions made, attempts included.
    """

    t: np.ndarray
    seen: np.ndarray
    force: np.ndarray
    energy: np.ndarray
    log: Sequence[Line]
    cutbacks: int
    solves: int
    status: str = "done"

    @property
    def increments(self) -> int:
        """Increments made."""
        return len(self.t) - 1

    @property
    def is_done(self) -> bool:
        """Whether the run reached its end."""
        return self.status == "done"

    @property
    def is_capped(self) -> bool:
        """Whether the run used up its increments."""
        return self.status.startswith("gave up")


def march(
    structure: Structure,
    scheme: Scheme,
    start: Instant,
    dt: float,
    t_end: float,
    impact: str = "no",
    observe: Callable[[Instant], Sequence[float]] = lambda motion: (),
    cap: int = INCREMENT_CAP,
    progress: Callable[[float], None] = lambda t: None,
) -> Run:
    """Run from `start` to t_end [s] in increments of dt [s].

    impact: one of `IMPACTS`; observe: what is to be kept of each increment; cap: increments after
    which the run is given up; progress: called with the time reached [s].
    A run that is given up, or that diverged (its energy past a million times the system's), says
    so in its status. Raises `ImpactError` for what cannot be.
    """
    if not 0 < dt < math.inf:
        raise ImpactError(f"dt = {dt:g} s: must be > 0 and finite")
    if not start.t < t_end < math.inf:
        raise ImpactError(f"end = {t_end:g} s: must be after the start and finite")
    if impact not in IMPACTS:
        raise ImpactError(f"impact = {impact}: must be one of {', '.join(IMPACTS)}")
    if impact != "no" and structure.contacts.compliance.any():
        raise ImpactError(f"impact = {impact}: needs hard contacts, a penalty law has no impulse")
    stepper = Stepper(structure, scheme)
    state = _at_start(stepper, start)
    retained: list[tuple] = []
    _keep(retained, structure, observe, state.motion)
    status = "done"
    tiny = 0.5 * RESTART * dt
    while state.motion.t < t_end - tiny and status == "done":
        if len(retained) > cap:
            status = f"gave up after {cap} increments at t = {state.motion.t:.6g} s"
            break
        k = math.floor((state.motion.t - start.t + tiny) / dt) + 1
        target = min(start.t + k * dt, t_end)
        try:
            for motion in _INCREMENT[impact](stepper, state, dt, target, len(retained), cap):
                energy = _keep(retained, structure, observe, motion)
                if not abs(energy) <= _EXPLOSION * structure.energy_scale:
                    status = (
                        f"diverged at t = {motion.t:.6g} s, increment {len(retained) - 1}, "
                        f"energy {energy:.4g} J (the system's: {structure.energy_scale:.4g} J)"
                    )
                    break
        except ArithmeticError as error:
            status = f"stopped at t = {state.motion.t:.6g} s, increment {len(retained)}: {error}"
        progress(state.motion.t)
    t, seen, force, energies = (np.array(column) for column in zip(*retained, strict=True))
    return Run(t, seen, force, energies, state.log, state.cutbacks, state.solves, status)


def _at_start(stepper: Stepper, start: Instant) -> State:
    """Contacts that touch and do not approach each other are closed from the start."""
    contacts = stepper.structure.contacts
    openings = openings_of(stepper, start)
    rates = contacts.gradient(contacts.B.T @ start.q).T @ (contacts.B.T @ start.v)
    closed = (openings <= PENETRATION) & (rates >= 0)
    state = State(start, closed, np.where(closed, openings, 0.0))
    if closed.any():
        state.motion = compatible_accelerations(stepper, state, start)
        state.largest_force = float(state.motion.force.max())
    return state


def _keep(retained, structure, observe, motion) -> float:
    energy = structure.energy(motion.q, motion.v)
    retained.append((motion.t, tuple(observe(motion)), motion.force, energy))
    return energy
