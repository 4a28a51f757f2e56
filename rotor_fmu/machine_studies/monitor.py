"""Sampling a run of a study: at the solver's own steps, and in turns at equal angles."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from ..model.simulation import Simulation, StepFailure

LEAST_TURNS = 16  # over which an exponent is a mean
_INTERFACES_PER_TURN = 512  # samples of the interfaces at least, of an exponent
RECORDER_ROWS = 16384  # steps that are recorded in a communication step


class Samples(NamedTuple):
    """Outputs at instants: t, shape (n,) [s]; columns by name, shape (n,)."""

    t: np.ndarray
    columns: Mapping[str, np.ndarray]


class Window(NamedTuple):
    """A part of a run that is looked at: at the solver's own steps, its ends among them; in whole
    turns at equal angles; the speed that is held [rad/s], nan where it varies; samples a turn, 0
    where they are none; the largest Lyapunov exponent [1/s], nan where it is not asked for.
    """

    steps: Samples
    turns: Samples
    speed: float
    per_turn: int
    exponent: float = math.nan


class Monitor:
    """The samples taken while a simulation advances: `names` at the solver's steps, which it must
    record, and `by_turns` at chosen instants; is_whole: whether samples between windows are stored
    too; has_exponent: whether the largest Lyapunov exponent of each window is computed."""

    def __init__(
        self,
        simulation: Simulation,
        names: Sequence[str],
        by_turns: Sequence[str] = (),
        is_whole: bool = False,
        has_exponent: bool = False,
    ) -> None:
        self._simulation, self._is_whole = simulation, is_whole
        self._has_exponent = has_exponent
        self._names, self._by_turns = names, by_turns
        self._at = [simulation.names.index(name) for name in by_turns]
        self._count = simulation.names.index("solver.steps")
        self._recordings: list[np.ndarray] = []
        self.begin()

    def begin(self) -> None:
        """Drop all samples but the present state."""
        self._times: list[float] = []
        self._rows: list[np.ndarray] = []
        self._interfaces: list[tuple] = []
        self.sample_interfaces()
        self._taken = self._simulation.observed[self._count]
        recordings = [*self._recordings, self._simulation.drain()] if self._names else []
        if self._recordings and not self._is_whole:
            now = [self._simulation.time, *map(self._simulation.read, self._names)]
            recordings = [np.array([now])]
        self._recordings = recordings

    def record(self, is_end: bool = False) -> None:
        """Take what was recorded, when there is much of it or at the end of a window; `StepFailure`
        where it is not every step."""
        taken = self._simulation.observed[self._count] - self._taken
        if not self._names or not (is_end or taken > RECORDER_ROWS / 64):
            return
        self._taken += taken
        self._recordings.append(self._simulation.drain())
        if len(self._recordings[-1]) < taken:
            raise StepFailure(
                f"t = {self._simulation.time:.6g} s: more than {RECORDER_ROWS} steps of the solver "
                "in a communication step, which are not all recorded; take a shorter run.step"
            )

    def sample(self) -> None:
        """Take a sample at this instant."""
        self._times.append(self._simulation.time)
        self._rows.append(self._simulation.observed[self._at])

    def parts(self, per_turn: int) -> int:
        """Return into how many advances the interval between two samples at equal angles goes."""
        return math.ceil(_INTERFACES_PER_TURN / per_turn) if self._has_exponent else 1

    def sample_interfaces(self) -> None:
        """Take what an exponent is computed of at this instant."""
        if self._has_exponent:
            from ..model.periodic.lyapunov import sample

            self._interfaces.append(sample(self._simulation))

    def window(self, speed: float = math.nan, per_turn: int = 0) -> Window:
        """Return the window since `begin`; `StepFailure` if steps are missing in it."""
        self.record(is_end=True)
        recorder = np.concatenate([np.zeros((0, 1 + len(self._names))), *self._recordings]).T
        steps = Samples(recorder[0], dict(zip(self._names, recorder[1:], strict=True)))
        rows = np.array(self._rows).reshape(len(self._rows), len(self._by_turns)).T
        turns = Samples(np.array(self._times), dict(zip(self._by_turns, rows, strict=True)))
        exponent = math.nan
        if self._has_exponent:
            from ..model.periodic.lyapunov import InterfaceSamples, largest_exponent

            seen = InterfaceSamples(*map(np.array, zip(*self._interfaces, strict=True)))
            each = per_turn * self.parts(per_turn)
            exponent = largest_exponent(self._simulation.rotor, seen, speed, each)
        return Window(steps, turns, speed, per_turn, exponent)
