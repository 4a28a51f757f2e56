"""A pawl in a ratchet wheel (paper B, section 3.2): matrices, contacts, and a run.

The wheel is rigid and unrolled into a rack that moves by R theta along x. The pawl is an elastic
plate, pinned at x = 0; its nose at x = L slides down the back of a tooth, slope m, until the
locking face of the next tooth meets it. Openings, frictionless and hard (u: nodes' displacements):

    back of the tooth   s = clearance + (u_y + m u_x - m R theta) / sqrt(1 + m^2)
    locking face        s = slip + R theta - u_x
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from rotor_fmu.model.schemes.family import Scheme
from scipy.sparse import coo_matrix

from .plane import to_band
from .ratchet_geometry import Ratchet, parse_ratchet, ratchet_toml
from .stepping.contacts import FlatStops
from .stepping.march import INCREMENT_CAP, Run, march
from .stepping.stepper import Instant, Stepper
from .stepping.structure import Elastic

__all__ = ["Ratchet", "RatchetRun", "build", "parse_ratchet", "ratchet_toml", "run_ratchet"]

T_END = 0.03  # [s]
DT = 1e-5  # [s]
_SMOOTH = 41  # samples of the moving mean that separates the fast part of a signal


@dataclass(frozen=True)
class Assembly:
    """A ratchet in matrices. nose: unknowns (x, y) of the pawl's end, from below, shape (ny + 1,
    2); free: the unknowns kept of the pawl's 2 N; the last unknown is the wheel's angle [rad]."""

    structure: Elastic
    nose: np.ndarray
    free: np.ndarray


def build(ratchet: Ratchet) -> Assembly:
    """The matrices of a ratchet."""
    pawl, tooth, wheel, plate = ratchet.pawl, ratchet.tooth, ratchet.wheel, ratchet.plate
    size = 2 * len(plate.points)
    pin = 2 * plate.columns[0, pawl.elements[1] // 2]
    retained = np.delete(np.arange(size + 1), [pin, pin + 1])
    place = np.full(size + 1, -1)
    place[retained] = np.arange(len(retained))
    angle = len(retained) - 1
    end = plate.columns[-1]
    bend = pawl.length - pawl.nose_length
    underside = plate.columns[plate.points[plate.columns[:, 0], 0] >= bend * (1 - 1e-9), 0]

    m = tooth.slope
    norm = math.hypot(1.0, m)
    B = np.zeros((len(retained), len(underside) + len(end)))
    for j, node in enumerate(underside):
        B[place[2 * node], j] = m / norm
        B[place[2 * node + 1], j] = 1 / norm
        B[angle, j] = -m * wheel.radius / norm
    for j, node in enumerate(end, len(underside)):
        B[place[2 * node], j] = -1.0
        B[angle, j] = wheel.radius
    opening = np.r_[np.full(len(underside), tooth.clearance), np.full(len(end), tooth.slip)]

    force = np.zeros(len(retained))
    force[place[2 * end + 1]] = -pawl.force / len(end)
    force[angle] = -wheel.torque
    structure = Elastic(
        to_band([plate.mass, coo_matrix([[wheel.inertia]])], retained),
        to_band([plate.stiffness, coo_matrix((1, 1))], retained),
        force,
        FlatStops(B, opening, np.zeros(len(opening))),
        energy_scale=ratchet.work,
    )
    nose = np.stack([place[2 * end], place[2 * end + 1]], axis=1)
    return Assembly(structure, nose, retained[:-1])


@dataclass(frozen=True)
class RatchetRun:
    """A run of a ratchet; run.seen has the columns angle [rad] and speed [rad/s] of the wheel and
    speed of the pawl [rad/s] (of its nose about the pin, downwards negative).

    shapes: displacements of the pawl's nodes [m], shape (frames, N, 2), at times shape_t [s] and
    wheel angles shape_angle [rad].
    """

    ratchet: Ratchet
    run: Run
    shape_t: np.ndarray
    shape_angle: np.ndarray
    shapes: np.ndarray

    @property
    def t(self) -> np.ndarray:
        """Times [s], one an increment, the start first."""
        return self.run.t

    @property
    def wheel_speed(self) -> np.ndarray:
        """Angular velocity of the wheel [rad/s]."""
        return self.run.seen[:, 1]

    @property
    def pawl_speed(self) -> np.ndarray:
        """Angular velocity of the pawl [rad/s]."""
        return self.run.seen[:, 2]

    @property
    def _sliding(self) -> np.ndarray:
        """From when the first bounces are over until shortly before the locking face."""
        t0 = self.ratchet.t_locking
        return (self.t > 0.2 * t0) & (self.t < 0.95 * t0)

    @property
    def slope(self) -> float:
        """Of the wheel's speed while the pawl slides, a straight line through it [rad/s2]; NaN if
        the run did not come that far."""
        inside = self._sliding
        if inside.sum() < 2 * _SMOOTH:
            return math.nan
        return float(np.polyfit(self.t[inside], self.wheel_speed[inside], 1)[0])

    @property
    def t_reversal(self) -> float:
        """When the wheel's speed first changes its sign at the locking face [s]; NaN if never."""
        later = np.flatnonzero((self.t > 0.5 * self.ratchet.t_locking) & (self.wheel_speed > 0))
        return float(self.t[later[0]]) if len(later) else math.nan

    @property
    def fast_content(self) -> float:
        """Root mean square of the pawl's speed about its moving mean, while sliding [rad/s]."""
        inside = self._sliding
        if inside.sum() < 2 * _SMOOTH:
            return math.nan
        kernel = np.full(_SMOOTH, 1 / _SMOOTH)
        signal = self.pawl_speed[inside]
        fast = signal[_SMOOTH // 2 : -(_SMOOTH // 2)] - np.convolve(signal, kernel, "valid")
        return float(np.sqrt(np.mean(fast**2)))

    @property
    def energy_sliding(self) -> float:
        """As `energy_change`, until shortly before the locking face [1]; what is made by then has
        no source but the integrator. NaN if the run did not come that far."""
        if self.t[-1] < 0.95 * self.ratchet.t_locking:
            return math.nan
        energy = self.run.energy[self.t < 0.95 * self.ratchet.t_locking]
        return float((energy[-1] - energy[0]) / self.ratchet.work)

    @property
    def energy_change(self) -> float:
        """Kinetic, elastic and potential energy at the end less that at the start, over
        `Ratchet.work` [1]: what the integrator made, or (negative) lost, impacts included."""
        return float((self.run.energy[-1] - self.run.energy[0]) / self.ratchet.work)


def run_ratchet(
    ratchet: Ratchet,
    scheme: Scheme,
    dt: float = DT,
    impact: str = "no",
    t_end: float = T_END,
    cap: int = INCREMENT_CAP,
    progress: Callable[[float], None] = lambda t: None,
    frame_time: float = math.inf,
) -> RatchetRun:
    """Let the wheel turn; dt, t_end [s]; frame_time: interval at which shapes are kept [s]; see
    `march` for the rest and for what it raises."""
    made = build(ratchet)
    zero = np.zeros(len(made.structure.force))
    start = Stepper(made.structure, scheme).start(0.0, zero, zero.copy())
    shapes: list[np.ndarray] = []
    shape_t: list[float] = []
    shape_angle: list[float] = []
    count = 2 * len(ratchet.plate.points)

    def observe(motion: Instant) -> tuple[float, ...]:
        """Angle [rad] and speed [rad/s] of the wheel, speed of the pawl [rad/s]."""
        if motion.t >= len(shape_t) * frame_time - 1e-12 and math.isfinite(frame_time):
            nodes = np.zeros(count)
            nodes[made.free] = motion.q[:-1]
            shapes.append(nodes.reshape(-1, 2))
            shape_t.append(motion.t)
            shape_angle.append(motion.q[-1])
        pawl_speed = motion.v[made.nose[:, 1]].mean() / ratchet.pawl.length
        return motion.q[-1], motion.v[-1], pawl_speed

    run = march(made.structure, scheme, start, dt, t_end, impact, observe, cap, progress)
    retained = (
        np.array(shape_t),
        np.array(shape_angle),
        np.array(shapes).reshape(-1, count // 2, 2),
    )
    return RatchetRun(ratchet, run, *retained)
