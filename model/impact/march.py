"""From the start to the end of an experiment, one increment after another.

How an impact is treated, by the names of Abaqus' IMPACT option:

no            the contacts are solved at the end of each increment, and that is all
average-time  the increment in which a contact would open or close is cut back to the mean time of
              these events, where an impulse makes the velocities of the closed contacts compatible
current-time  no cutback; the velocities and accelerations of contacts that have just closed are
              made compatible at the end of the increment
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from ..schemes import Scheme
from .failures import ImpactError
from .hard_stop import complementarity, held, unilateral
from .stepper import Motion, Stepper
from .structure import Structure

IMPACTS = ("no", "average-time", "current-time")
INCREMENT_CAP = 10_000  # paper B's, section 3.2
RESTART = 1e-6  # increment after an impact, of the time increment
PENETRATION = 1e-10  # of an open contact, from which it counts as closing [m]
TENSION = 1e-6  # of a closed contact, of the largest force so far, from which it opens
SHORT = 1e-3  # steps shorter than this share of the increment hold accelerations
_AT_ONCE = 1e-9  # events sooner than this share of an increment are at its start
_EXPLOSION = 1e6


class Line(NamedTuple):
    """A line of the status log: increment, attempt, iterations, time reached [s], increment of
    time tried [s]; an attempt that is cut back does not advance the time."""

    increment: int
    attempt: int
    iterations: int
    t: float
    h: float
    is_cut_back: bool

    def __str__(self) -> str:
        """As in Figure 8: step, increment, attempt, three counts of iterations, total time, time in
        the step, increment of time."""
        t = f"{float(f'{self.t:.8g}'):#.3g}"
        mantissa, exponent = f"{self.h:.3e}".split("e")
        h = f"{mantissa}e{exponent[0]}{exponent[1:]:0>3}"
        counts = f"0\t{self.iterations}\t{self.iterations}"
        return f"1\t{self.increment}\t{self.attempt}\t{counts}\t{t}\t{t}\t{h}"


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


@dataclass
class _State:
    """What one increment hands to the next."""

    motion: Motion
    closed: np.ndarray
    rest: np.ndarray
    largest_force: float = 0.0
    cutbacks: int = 0
    solves: int = 0
    log: list[Line] = field(default_factory=list)


def march(
    structure: Structure,
    scheme: Scheme,
    start: Motion,
    dt: float,
    t_end: float,
    impact: str = "no",
    observe: Callable[[Motion], Sequence[float]] = lambda motion: (),
    cap: int = INCREMENT_CAP,
    progress: Callable[[float], None] = lambda t: None,
) -> Run:
    """Run from `start` to t_end [s] in increments of dt [s].

    impact: one of `IMPACTS`; observe: what is to be kept of each increment; cap: increments after
    which the run is given up; progress: told the time reached [s].
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
    increment = {"no": _solved, "average-time": _average_time, "current-time": _current_time}
    kept: list[tuple] = []
    _keep(kept, structure, observe, state.motion)
    status = "done"
    tiny = 0.5 * RESTART * dt
    while state.motion.t < t_end - tiny and status == "done":
        if len(kept) > cap:
            status = f"gave up after {cap} increments at t = {state.motion.t:.6g} s"
            break
        k = math.floor((state.motion.t - start.t + tiny) / dt) + 1
        target = min(start.t + k * dt, t_end)
        try:
            for motion in increment[impact](stepper, state, dt, target, len(kept), cap):
                energy = _keep(kept, structure, observe, motion)
                if not abs(energy) <= _EXPLOSION * structure.energy_scale:
                    status = (
                        f"diverged at t = {motion.t:.6g} s, increment {len(kept) - 1}, "
                        f"energy {energy:.4g} J (the system's: {structure.energy_scale:.4g} J)"
                    )
                    break
        except ArithmeticError as error:
            status = f"stopped at t = {state.motion.t:.6g} s, increment {len(kept)}: {error}"
        progress(state.motion.t)
    t, seen, force, energy = zip(*kept, strict=True)
    columns = (np.array(t), np.array(seen), np.array(force), np.array(energy))
    return Run(*columns, state.log, state.cutbacks, state.solves, status)


def _at_start(stepper: Stepper, start: Motion) -> _State:
    """Contacts that touch and do not approach each other are closed from the start."""
    contacts = stepper.structure.contacts
    openings = _openings(stepper, start)
    rates = contacts.gradient(contacts.B.T @ start.q).T @ (contacts.B.T @ start.v)
    closed = (openings <= PENETRATION) & (rates >= 0)
    state = _State(start, closed, np.where(closed, openings, 0.0))
    if closed.any():
        state.motion = _compatible_accelerations(stepper, state, start)
        state.largest_force = float(state.motion.force.max())
    return state


def _keep(kept, structure, observe, motion) -> float:
    energy = structure.energy(motion.q, motion.v)
    kept.append((motion.t, tuple(observe(motion)), motion.force, energy))
    return energy


def _accept(state: _State, motion: Motion, line: Line) -> Motion:
    state.motion = motion
    state.log.append(line)
    state.largest_force = max(state.largest_force, float(np.abs(motion.force).max(initial=0.0)))
    return motion


def _solved(stepper, state, dt, target, number, cap):
    """IMPACT=NO: the contacts are solved at the end of the increment."""
    h = _length(state, dt, target)
    free = stepper.free(state.motion, h)
    N, force = unilateral(free, stepper.structure.contacts, state.closed)
    state.solves += 1
    state.closed = force > 0
    motion = stepper.finish(free, N, force)._replace(t=target)
    yield _accept(state, motion, Line(number, 1, 1, target, h, False))


def _current_time(stepper, state, dt, target, number, cap):
    """IMPACT=CURRENT TIME: as IMPACT=NO, then compatible velocities and accelerations."""
    before = state.closed
    (motion,) = _solved(stepper, state, dt, target, number, cap)
    if (state.closed & ~before).any():
        here = _Here(stepper, motion)
        impulse = np.zeros(len(before))
        part = here.flexibility[np.ix_(state.closed, state.closed)]
        impulse[state.closed] = np.linalg.solve(part, -here.rates(motion.v)[state.closed])
        motion = motion._replace(v=motion.v + here.columns @ impulse)
    if (state.closed != before).any():
        motion = _compatible_accelerations(stepper, state, motion)
    state.motion = motion
    yield motion


def _average_time(stepper, state, dt, target, number, cap):
    """IMPACT=AVERAGE TIME: see `march`'s module; one to three increments (Abaqus Theory 2.4.2)."""
    h = _length(state, dt, target)
    old, attempt = state.motion, 1
    motion, changing = _frozen(stepper, state, h, dt)
    if not changing.any():
        motion = motion._replace(t=target)
        yield _accept(state, motion, Line(number, 1, 1, target, h, False))
        return
    state.cutbacks += 1
    state.log.append(Line(number, attempt, 1, old.t, h, True))
    share = _mean_event(stepper, state, motion, changing)
    if share > _AT_ONCE:
        attempt += 1
        motion, _ = _frozen(stepper, state, share * h, dt)
        yield _accept(state, motion, Line(number, attempt, 1, motion.t, share * h, False))
        number += 1
        attempt = 0
    state.motion = _impact(stepper, state, changing, dt)
    if number > cap:
        return
    motion, _ = _frozen(stepper, state, RESTART * dt, dt)
    yield _accept(state, motion, Line(number, attempt + 1, 0, motion.t, RESTART * dt, False))


def _length(state: _State, dt: float, target: float) -> float:
    """To the target [s]; exactly dt for a whole increment, so that its factors are found again."""
    h = target - state.motion.t
    return dt if abs(h - dt) < _AT_ONCE * dt else h


def _frozen(stepper, state, h, dt) -> tuple[Motion, np.ndarray]:
    """The motion after h with the contacts as they are, and which of them should have changed."""
    contacts = stepper.structure.contacts
    free = stepper.free(state.motion, h)
    N, force = held(free, contacts, state.closed, state.rest, by_acceleration=h < SHORT * dt)
    state.solves += 1
    motion = stepper.finish(free, N, force)
    opens = state.closed & (force < -TENSION * state.largest_force)
    closes = ~state.closed & (_openings(stepper, motion) - state.rest < -PENETRATION)
    return motion, opens | closes


def _openings(stepper, motion) -> np.ndarray:
    contacts = stepper.structure.contacts
    return contacts.openings(contacts.B.T @ motion.q)


def _mean_event(stepper, state, motion, changing) -> float:
    """Mean of the times at which contacts change, linear in openings and forces, over h."""
    before, after = (
        np.where(state.closed, at.force, _openings(stepper, at) - state.rest)[changing]
        for at in (state.motion, motion)
    )
    before = np.maximum(before, 0.0)
    return float(np.mean(before / (before - after)))


class _Here:
    """What the contacts do to the masses at one instant, when nothing has time to move."""

    def __init__(self, stepper: Stepper, motion: Motion) -> None:
        contacts = stepper.structure.contacts
        p, self._B = contacts.B.T @ motion.q, contacts.B
        self.N = contacts.gradient(p)
        self.bend = contacts.bend(p, contacts.B.T @ motion.v)
        self.columns = stepper.mass_columns @ self.N
        self.flexibility = self.N.T @ stepper.mass_flexibility @ self.N

    def rates(self, v: np.ndarray) -> np.ndarray:
        """Of the openings, for velocities or accelerations (these without `bend`)."""
        return self.N.T @ (self._B.T @ v)


def _impact(stepper, state, changing, dt) -> Motion:
    """Change the contacts; impulse and compatible accelerations, at no cost of time."""
    motion = state.motion
    closes = changing & ~state.closed
    state.closed = state.closed ^ changing
    state.rest = np.where(closes, _openings(stepper, motion), state.rest)
    if closes.any():
        here = _Here(stepper, motion)
        rates = here.rates(motion.v)
        impulse = _pushing(here, state, rates, TENSION * float(np.abs(rates).max()))
        # what stops a contact point within an increment: the first measure of the forces to come
        state.largest_force = max(state.largest_force, float(impulse.max()) / dt)
        motion = motion._replace(v=motion.v + here.columns @ impulse)
    return _compatible_accelerations(stepper, state, motion)


def _compatible_accelerations(stepper, state, motion: Motion) -> Motion:
    """Accelerations of the equation of motion with which no closed contact penetrates."""
    here = _Here(stepper, motion)
    r = stepper.residual(motion.t, motion.q, motion.v)
    a = stepper.free_acceleration(r)
    loose = TENSION * state.largest_force * float(here.flexibility.max())
    force = _pushing(here, state, here.rates(a) + here.bend, loose)
    return motion._replace(a=a + here.columns @ force, r=r, force=force)


def _pushing(here, state, rates: np.ndarray, loose: float) -> np.ndarray:
    """Impulses or forces on the closed contacts, none of them pulling, that leave no negative rate
    of theirs; contacts whose rate is above `loose` then open."""
    pushing = np.zeros(len(rates))
    closed = np.flatnonzero(state.closed)
    part = here.flexibility[np.ix_(closed, closed)]
    pushing[closed], _ = complementarity(part, rates[closed], np.ones(len(closed), dtype=bool))
    after = rates + here.flexibility @ pushing
    state.closed = state.closed & ((pushing > 0) | (after <= loose))
    return pushing
