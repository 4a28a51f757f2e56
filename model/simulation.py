"""A run of one rotor: its state, `advance(to)`, `snapshot()` and `restore()`."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable

import numpy as np

from . import march
from .assembly import assemble
from .band import solve
from .compiled import INTERPRETED_WARNING, IS_COMPILED, compiled
from .energy import STORES, powers
from .equilibrium import static_equilibrium
from .excitation import Spin
from .observe import observe, observed_names, total_energy
from .rotor import Rotor
from .schemes import is_unconditionally_stable
from .settings import DEFAULT_PRESET, PRESETS, Settings
from .step import Motion, new_motion, new_workspace, residual


class StepFailure(RuntimeError):
    """A step that could not be made; says when, where, and what to try."""


class RotorWarning(UserWarning):
    """Something that makes a run doubtful: an unstable scheme, the integrator's false state."""


_has_said_interpreted = False


def _warn(message: str) -> None:
    warnings.warn(message, RotorWarning, stacklevel=3)


@compiled
def _turn_over(structure, spin, loads, is_start, motion, memory, work):
    """Carry the state into an interval with new speed or loads: residual, accelerations and powers
    as they are right after the jump. At the start the accelerations are those of the equation."""
    n = structure.M.shape[1]
    nb = len(structure.contacts)
    before = work.free
    for i in range(n):
        before[i, 0] = 0.0 if is_start else motion.r[i]
    for j in range(nb):
        work.problem.w[j] = 0.0 if is_start else motion.r[n + j]
    residual(structure, spin, loads, motion)
    for i in range(n):
        before[i, 0] = motion.r[i] - before[i, 0]
    solve(structure.M_factors, before)
    for i in range(n):
        motion.a[i] = -before[i, 0] if is_start else motion.a[i] - before[i, 0]
    for j in range(nb):
        change = (motion.r[n + j] - work.problem.w[j]) / structure.contacts[j].mass
        motion.a[n + j] = -change if is_start else motion.a[n + j] - change
    memory.record[0].torque = powers(
        structure, spin, loads, motion, work.scratch, work.free, memory.power
    )


class Simulation:
    """One rotor in motion.

    The rotor starts at rest in its static equilibrium at time t [s], turning at `speed` [rad/s].
    `rate` [rad/s2] is the rate of the speed over the first interval; later ones continue the speed
    linearly from the last two values given. What makes a run doubtful goes to `warn` (default: a
    `RotorWarning`): settings that make oscillations grow, the false state, a missing compiler.
    Raises `EquilibriumError`.
    """

    def __init__(
        self,
        rotor: Rotor,
        settings: Settings = PRESETS[DEFAULT_PRESET],
        *,
        t: float = 0.0,
        speed: float = 0.0,
        rate: float = 0.0,
        warn: Callable[[str], None] = _warn,
    ) -> None:
        self._warn = warn
        self._warn_if_interpreted()
        self.rotor = rotor
        self.settings = settings
        self.structure = assemble(rotor)
        self.names = observed_names(self.structure)
        self._scheme = settings.scheme()
        self._control = settings.control()
        if not is_unconditionally_stable(self._scheme):
            self._warn(
                f"{settings.method} with alpha_f = {self._scheme.alpha_f:g}, alpha_m = "
                f"{self._scheme.alpha_m:g} is unstable: its spectral radius for fast oscillations "
                f"is {self._scheme.rho_infinity:.4g}, above 1; the run will diverge"
            )
        self._loads = np.zeros(len(self.structure.load_dof), dtype=complex)
        self._motion = new_motion(self.structure)
        self._trial = new_motion(self.structure)
        self._work = new_workspace(self.structure)
        self._memory = march.new_memory(self.structure)
        self._stores = np.zeros(len(STORES))
        self._observed = np.zeros(len(self.names))
        self._is_fresh = False
        self._has_warned = False

        q = static_equilibrium(self.structure)
        self._motion.q[:] = q
        self.static = q[self.structure.disc_dof].imag.copy()
        record = self._memory.record[0]
        record.t = record.t_ref = t
        record.h = settings.h
        record.omega = record.omega_ref = speed
        record.alpha = rate
        self._begin_interval(speed, rate, is_start=True)
        self._energy_at_start = self._energy()

    @property
    def time(self) -> float:
        """Time reached [s]."""
        return float(self._memory.record[0].t)

    @property
    def motion(self) -> Motion:
        """The present state (live arrays, not to be written to)."""
        return self._motion

    @property
    def observed(self) -> np.ndarray:
        """Everything that can be read, in the order of `names` (a live array)."""
        if not self._is_fresh:
            observe(
                self.structure,
                self.static,
                self._energy_at_start,
                self._motion,
                self._memory,
                self._work.scratch,
                self._stores,
                self._observed,
            )
            self._is_fresh = True
        return self._observed

    def read(self, name: str) -> float:
        """One observed quantity by its name, as in `observed_names`."""
        return float(self.observed[self.names.index(name)])

    def advance(self, to: float, speed: float, loads: np.ndarray | None = None) -> None:
        """March to time `to` [s].

        speed: at the present time [rad/s]; loads: complex forces x + i y on the discs and, last, on
        the coupling, shape (bodies,) [N], constant until `to`. Raises `StepFailure`, the state then
        being that after the last good step.
        """
        record = self._memory.record[0]
        since = record.t - record.t_ref
        rate = (speed - record.omega_ref) / since if since > 0 else record.alpha
        new_loads = self._loads if loads is None else loads
        self._loads[:] = new_loads
        self._begin_interval(speed, rate, is_start=False)
        status = march.advance(
            self.structure,
            self._scheme,
            self._control,
            self.static,
            to,
            self._loads,
            self._motion,
            self._trial,
            self._memory,
            self._work,
        )
        self._is_fresh = False
        if status != march.DONE:
            raise StepFailure(self._failure(status))
        if record.trapped and not self._has_warned:
            self._has_warned = True
            self._warn(
                f"false state since t = {record.trapped_at:.4g} s: a journal jumps from wall to "
                "wall of its clearance every step or two, which is the integrator's doing; do not trust "
                "this run: take the preset robust, or a smaller solver.h"
            )

    def snapshot(self) -> tuple[np.ndarray, ...]:
        """A copy of everything that `restore` needs to go on from here, bit for bit."""
        return tuple(array.copy() for array in self._state())

    def restore(self, snapshot: tuple[np.ndarray, ...]) -> None:
        """Go back to a snapshot of this or of an equal simulation."""
        for array, saved in zip(self._state(), snapshot, strict=True):
            array[...] = saved
        self._is_fresh = False

    def _state(self) -> tuple[np.ndarray, ...]:
        return (*self._motion, *self._memory, self._loads)

    def _warn_if_interpreted(self) -> None:
        global _has_said_interpreted
        if not IS_COMPILED and not _has_said_interpreted:
            _has_said_interpreted = True
            self._warn(INTERPRETED_WARNING)

    def _spin(self) -> Spin:
        record = self._memory.record[0]
        return Spin(float(record.omega), float(record.alpha), float(record.theta))

    def _energy(self) -> float:
        return total_energy(
            self.structure, self._spin(), self._motion, self._work.scratch, self._stores
        )

    def _begin_interval(self, speed: float, rate: float, is_start: bool) -> None:
        record = self._memory.record[0]
        before = self._energy()
        record.t_ref = record.t
        record.theta_ref = record.theta
        record.omega = record.omega_ref = speed
        record.alpha = rate
        _turn_over(
            self.structure,
            self._spin(),
            self._loads,
            is_start,
            self._motion,
            self._memory,
            self._work,
        )
        # A jump of the prescribed speed is work that the drive does in no time.
        self._memory.work[0] += 0.0 if is_start else self._energy() - before

    def _failure(self, status: int) -> str:
        record = self._memory.record[0]
        where = (
            f"t = {record.failed_at:.6g} s, speed {record.omega:.4g} rad/s, "
            f"step {record.failed_h:.3g} s"
        )
        if status == march.NOT_CONVERGED:
            reason = "the contact forces did not converge"
            advice = "try a smaller solver.h, or the preset robust"
        else:
            q = np.abs(self._motion.q[: self.structure.M.shape[1] : 2])
            node = int(np.argmax(np.where(np.isfinite(q), q, math.inf))) + 1
            reason = (
                f"the solution diverged (node {node} past {self.structure.bound:.3g} m "
                "or not finite)"
            )
            advice = "try the preset robust, or a smaller solver.h"
            if not is_unconditionally_stable(self._scheme):
                advice = (
                    "the scheme is unstable (spectral radius "
                    f"{self._scheme.rho_infinity:.4g} > 1): "
                    "take alpha_m <= alpha_f <= 0.5"
                )
        return f"{where}: {reason}; {advice}"
