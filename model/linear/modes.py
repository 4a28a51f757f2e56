"""Modes of the linearized machine at a speed: eigenvalues nearest to rest, and their shapes.

With lambda = -zeta omega_n + i omega_d the motion is Re(shape exp(lambda t)). States of laws that
whirl by themselves, as rings that float do, are unknowns with the machine's; others follow.
"""

import math
from dataclasses import dataclass

import numpy as np

from ..arguments import check_integer, number
from ..machine.rotor import Rotor
from ..one_thread import on_one_thread
from ..quantities import check_size
from .fast_growth import with_fast_growth
from .linear_machine import LinearMachine, shared_machine
from .orbit import AT_REST, backward_part, forward_part, lengths_of_nodes, semi_axes
from .shifted_inverse import DOUBTFUL, Lowest, ShiftedInverse, lowest
from .system_at_speed import Linear, LinearError

FORWARD, BACKWARD, PLANAR, MIXED = "forward", "backward", "planar", "mixed"
_DEGENERATE = 1e-7  # relative distance of two eigenvalues that are one
_PLANAR = 1e-3  # forwardness below which an orbit is a line
LEAST_GROWTH = 1e-9  # a share of growth that is more than rounding
_ERRORS = 10.0  # residuals of a mode, below which its growth may be rounding
DEFAULT_COUNT = 8


class Spectrum:
    """A result with complex `eigenvalues` lambda [rad/s] of any shape; what follows has it too."""

    eigenvalues: np.ndarray

    @property
    def damped(self) -> np.ndarray:
        """Frequencies at which the modes vibrate, omega_d [rad/s]."""
        return self.eigenvalues.imag

    @property
    def natural(self) -> np.ndarray:
        """omega_n = |lambda| [rad/s]."""
        return np.abs(self.eigenvalues)

    @property
    def damping_ratio(self) -> np.ndarray:
        """zeta [1]; negative: the mode grows."""
        return -self.eigenvalues.real / self.natural

    @property
    def has_peak(self) -> np.ndarray:
        """Whether a mode answers a force of its frequency with a peak: zeta below 1 / sqrt(2)."""
        return self.damping_ratio < 0.5**0.5

    @property
    def log_dec(self) -> np.ndarray:
        """Logarithmic decrement 2 pi zeta / sqrt(1 - zeta^2) [1]."""
        return -2 * np.pi * self.eigenvalues.real / self.eigenvalues.imag


@dataclass(frozen=True)
class Modes(Spectrum):
    """The lowest modes of a machine at a speed [rad/s], by natural frequency; m modes, n nodes.

    contacts: `open` or `pinned`; z: positions of the nodes [m], shape (n,); eigenvalues [1/s],
    complex of shape (m,); x, y: shapes, complex of shape (m, n), the largest semi-axis 1, all 0
    where housings move alone, the largest of which is 1 then; slope_x, slope_y [1/m], alike;
    housing_x, housing_y: shape (m, housings); is_degenerate: shape (m,), whether a mode shares its
    eigenvalue, so that it may whirl either way; decays: eigenvalues of modes that do not oscillate
    [1/s], slowest first; residuals: the residual of each mode's equation, shape (m,) [1], about the
    relative error of its eigenvalue; is_held: whether no motion has frequency 0, as one that
    nothing holds; such motions are not among the modes.
    """

    speed: float
    contacts: str
    z: np.ndarray
    eigenvalues: np.ndarray
    x: np.ndarray
    y: np.ndarray
    slope_x: np.ndarray
    slope_y: np.ndarray
    housing_x: np.ndarray
    housing_y: np.ndarray
    is_degenerate: np.ndarray
    decays: np.ndarray
    residuals: np.ndarray
    is_held: bool

    @property
    def sharing(self) -> np.ndarray:
        """Which modes have the same eigenvalue as each mode, itself among them; shape (m, m)."""
        return _sharing(self.eigenvalues)

    @property
    def is_sound(self) -> np.ndarray:
        """Which modes satisfy their equations within `DOUBTFUL`; others are rounding."""
        return self.residuals <= DOUBTFUL

    @property
    def is_of_housings(self) -> np.ndarray:
        """Which modes are motions of housings alone, while the rotor rests; shape (m,)."""
        return np.asarray(~np.hstack([self.x, self.y]).any(axis=1))

    @property
    def growing(self) -> np.ndarray:
        """Those of `decays` that grow [1/s]: motions away from equilibrium that do not oscillate,
        as with a negative stiffness."""
        return self.decays[self.decays > 0.0]

    @property
    def growth(self) -> float:
        """The largest share of growth of a mode, Re lambda / |lambda|, less what may be rounding;
        of what does not oscillate, its sign; -1 of none [1]."""
        shares = (-self.damping_ratio - _ERRORS * self.residuals)[self.is_sound]
        return max([*shares, *([1.0] if len(self.growing) else [])], default=-1.0)

    @property
    def forwardness(self) -> np.ndarray:
        """1 of a circle with the spin, -1 against it, 0 of a line: (|f|^2 - |b|^2) / (|f|^2 +
        |b|^2), summed along the shaft, with f, b the parts that turn with and against the spin."""
        weight = np.append(lengths_of_nodes(self.z), np.ones(self.housing_x.shape[1]))
        forward, backward = (np.abs(part) ** 2 @ weight for part in self._parts())
        sense = -1.0 if self.speed < 0 else 1.0
        return sense * (forward - backward) / (forward + backward)

    @property
    def whirl(self) -> tuple[str, ...]:
        """`forward`, `backward`, `planar`, or `mixed` where nodes whirl either way."""
        forward, backward = (np.abs(p) ** 2 for p in self._parts())
        each = (forward - backward) / (forward + backward).max(axis=1, keepdims=True)
        seen = zip(each, self.forwardness, self.is_degenerate, strict=True)
        return tuple(PLANAR if is_any else _word(nodes, whole) for nodes, whole, is_any in seen)

    def _parts(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the parts of the nodes, and of the housings where no node moves."""
        is_alone = self.is_of_housings[:, None]
        x = np.hstack([self.x, self.housing_x * is_alone])
        y = np.hstack([self.y, self.housing_y * is_alone])
        return forward_part(x, y), backward_part(x, y)


def _sharing(values: np.ndarray) -> np.ndarray:
    return np.abs(values[:, None] - values) <= _DEGENERATE * np.abs(values)


def _word(nodes: np.ndarray, whole: float) -> str:
    if nodes.max() > _PLANAR and nodes.min() < -_PLANAR:
        return MIXED
    if abs(whole) < _PLANAR:
        return PLANAR
    return FORWARD if whole > 0 else BACKWARD


def modes(
    rotor: Rotor, speed: float = 0.0, *, count: int = DEFAULT_COUNT, contacts: str | None = None
) -> Modes:
    """Return the `count` lowest modes at a speed [rad/s], fewer where there are fewer.

    contacts: `open`, `pinned` or None: open where that holds the machine. Both shapes of a double
    eigenvalue are motions in a plane, one in x and one in y, where they can be. Raises
    `LinearError`.
    """
    return machine_modes(shared_machine(rotor, contacts), speed, count, in_planes=True)


def machine_modes(
    machine: LinearMachine, speed: float, count: int, *, in_planes: bool = False
) -> Modes:
    """Return `modes` of a machine that is linear already; in_planes: whether shapes of a double
    eigenvalue are rather motions in a plane than circles."""
    check_count(count)
    return modes_of(machine, machine.at(checked_speed(speed)), count, in_planes=in_planes)


@on_one_thread
def modes_of(
    machine: LinearMachine,
    linear: Linear,
    count: int,
    *,
    pads_whirl: bool = False,
    in_planes: bool = False,
) -> Modes:
    """Return `machine_modes` at a speed, by the machine's matrices there; pads_whirl: whether pads
    that tilt follow each mode, not a vibration at the frequency that they follow in `linear`."""
    linear = machine.with_own_states(linear, of_all=pads_whirl)
    scale, strain = float(machine.structure.numbers[0].lowest_omega), linear.strain
    more = count + in_planes  # the last one may share its eigenvalue with the next
    found = lowest(ShiftedInverse(linear, scale, strain.by_d), more)
    values, shapes, residuals, decays, is_held = found
    if strain.kappa_h > 0.0:
        # hysteresis is another one in modes faster than the rotation; both lists are of the same
        # modes, by ascending frequency, but for decays, which it makes oscillate a little: a double
        # one, of critical damping, with a share of about the root of kappa_h / 2
        fast = lowest(ShiftedInverse(linear, scale, strain.by_d_if_fast), more + len(decays))
        decay = [v.imag <= strain.kappa_h**0.5 * np.abs(v) for v in (values, fast.values)]
        slow = values.imag <= abs(linear.speed)
        rest = np.flatnonzero(~decay[1])[int(np.sum(slow & ~decay[0])) :]
        slow |= decay[0]
        values = np.concatenate([values[slow], fast.values[rest]])
        shapes = np.hstack([shapes[:, slow], fast.shapes[:, rest]])
        residuals = np.concatenate([residuals[slow], fast.residuals[rest]])
    slowest = Lowest(values, shapes, residuals, decays, is_held)
    found = with_fast_growth(slowest, linear, scale, strain.by_d)
    values, shapes, residuals, decays, is_held = found
    # what grows faster than it whirls is not left out for its high frequency
    first = np.argsort(np.where(values.real > values.imag, 0.0, np.abs(values)))[:more]
    values, shapes = values[first], shapes[:, first]
    _untangle(values, shapes, machine, in_planes)
    is_degenerate = _sharing(values).sum(axis=1) > 1
    result = np.argsort(np.abs(values[:count]), kind="stable")
    values, shapes = values[result], shapes[:, result]
    n = 2 * len(machine.nodes)
    x, y = _scaled((machine.expand @ shapes).T, n)
    return Modes(
        speed=linear.speed,
        contacts=machine.contacts,
        z=machine.nodes,
        eigenvalues=values,
        x=x[:, :n:2],
        y=y[:, :n:2],
        slope_x=x[:, 1:n:2],
        slope_y=y[:, 1:n:2],
        housing_x=x[:, n:-1],
        housing_y=y[:, n:-1],
        is_degenerate=is_degenerate[result],
        decays=decays,
        residuals=residuals[first[result]],
        is_held=is_held,
    )


def modes_up_to(
    machine: LinearMachine,
    linear: Linear,
    frequency: float,
    least: int = DEFAULT_COUNT,
    *,
    pads_whirl: bool = False,
) -> Modes:
    """Return `modes_of` with all modes up to a natural frequency [rad/s], at least the `least`
    lowest where there are so many: of a long shaft there may be any number."""
    count = least
    while True:
        found = modes_of(machine, linear, count, pads_whirl=pads_whirl)
        whirls = found.eigenvalues.real <= found.eigenvalues.imag  # what grows faster is added
        if len(whirls) < count or found.natural[whirls].max(initial=0.0) > frequency:
            return found
        count *= 2


def count_up_to(rotor: Rotor, speed: float, least: int, contacts: str | None = None) -> int:
    """Return how many modes at a speed [rad/s] have a natural frequency up to that of rotation, or
    `least`: among them are those that meet it up to there."""
    machine = shared_machine(rotor, contacts)
    found = modes_up_to(machine, machine.at(speed), abs(speed), least)
    return max(least, int(np.sum(found.natural <= abs(speed))))


def checked_speed(speed: float, name: str = "speed") -> float:
    """Return a speed [rad/s] that may be of any type of number; `LinearError` unless it is finite,
    and of a size with which one can calculate."""
    result = number(name, speed)
    if not math.isfinite(result):
        raise LinearError(f"{name} = {speed}: must be finite")
    check_size(f"{name} = {result:g} rad/s", result)
    return result


def check_count(count: int) -> None:
    """Raise `LinearError` unless a number of modes or lines is an integer above 0."""
    check_integer("count", count, 1, error=LinearError)


def _untangle(
    values: np.ndarray, shapes: np.ndarray, machine: LinearMachine, in_planes: bool
) -> None:
    """Make both shapes of a double eigenvalue one in x and one in y, where in_planes, or else a
    backward and a forward circle, if they can be."""
    paired = -1
    for i in range(len(values) - 1):
        if i == paired or abs(values[i + 1] - values[i]) > _DEGENERATE * abs(values[i]):
            continue
        pair = shapes[:, i : i + 2]
        paired = i + 1
        whole = machine.expand @ pair
        x, y = whole[::2], whole[1::2]
        # in x: the null space of y; backward, y = i x: that of y - i x; forward: of y + i x
        circles = y - 1j * x, y + 1j * x
        for vanishing in ((y, x), circles) if in_planes else (circles,):
            parts = [np.linalg.svd(part, full_matrices=False)[1:] for part in vanishing]
            if all(sizes[1] < 1e-3 * sizes[0] for sizes, _ in parts):
                shapes[:, i : i + 2] = pair @ np.array([mixed[1].conj() for _, mixed in parts]).T
                break


def _scaled(whole: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y of shapes, each with the largest orbit of a node, among the first n rows, of
    size 1; where nodes move by rounding alone they rest, and it is that of a housing."""
    x, y = whole[:, ::2].copy(), whole[:, 1::2].copy()
    axis, _ = semi_axes(x, y)
    axis[:, 1:n:2] = 0.0  # slopes
    is_alone = axis[:, :n].max(axis=1) < AT_REST * axis[:, n:].max(axis=1)
    x[is_alone, :n] = y[is_alone, :n] = axis[is_alone, :n] = 0.0
    axis[~is_alone, n:] = 0.0
    each, at = np.arange(len(whole)), np.argmax(axis, axis=1)
    # phase: x at the largest orbit real, or y where there is no x
    lead = np.where(np.abs(x[each, at]) >= np.abs(y[each, at]), x[each, at], 0)
    lead = np.where(lead == 0, y[each, at], lead)
    factor = (np.abs(lead) / (lead * axis[each, at]))[:, None]
    return x * factor, y * factor
