"""Frequency response of displacements to a force or to the base's acceleration, and the sensitivity
of the control loops of magnetic bearings (ISO 14839-3).

At a speed, displacements u exp(i omega t) answer forces f exp(i omega t) by
(K + i omega D - omega^2 M) u = f, where tilting pads and floating rings follow at omega. An
acceleration of the base acts as -M r, r its motion as a rigid body, on displacements relative to
it. A control
loop reads the displacement at a sensor and acts with the force -H(s) at a magnet, beside the
magnet's own negative stiffness; with the matrix G of the sensors' displacements by the magnets'
forces, that stiffness included, the sensitivity of loop j is the j-th diagonal element of
(1 + G H)^-1: what remains of a disturbance that is added to its sensor while all loops are closed.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sp

from ..arguments import listed, numbers
from ..machine.rotor import Rotor
from ..quantities import NOT_NEGATIVE, quantity
from .amplification import with_peaks
from .linear_machine import LinearError, shared_machine
from .modes import checked_speed, modes_up_to
from .places import MOVED, AnyPlace, as_place
from .static import check_node
from .system_at_speed import Linear

_PADE = 12  # order of the approximation of a delay, for poles alone, of up to 2.5 of their periods
_UNSTABLE = 1e-6  # share of growth of a pole that is more than rounding


@dataclass(frozen=True)
class FrequencyResponse:
    """Displacements of n places by a force on one, at f frequencies [rad/s] and one speed [rad/s].

    contacts: `open` or `pinned`; force: its node (from 1), or `base`: an acceleration of the base;
    nodes: from 1; force_offset, offsets: how far beyond their nodes the places lie [m]; receptance:
    complex of shape (f, n, 2, 2) [m/N], displacement in x, y by the force in x, y, or, relative to
    the base, by its acceleration in x, y [m/(m/s2)].
    """

    speed: float
    contacts: str
    frequencies: np.ndarray
    force: int | str
    force_offset: float
    nodes: tuple[int, ...]
    offsets: tuple[float, ...]
    receptance: np.ndarray


@dataclass(frozen=True)
class ControlLoop:
    """The control of a magnetic bearing, alike in x and y; sensor, magnet: nodes (from 1) or
    places."""

    name: str
    sensor: AnyPlace
    magnet: AnyPlace
    kp: float = quantity("A/m", "gain of the displacement", NOT_NEGATIVE)
    kd: float = quantity("A.s/m", "gain of the velocity", NOT_NEGATIVE)
    force_per_current: float = quantity("N/A", "of the magnet", NOT_NEGATIVE)
    ki: float = quantity("A/(m.s)", "gain of the integral of the displacement", NOT_NEGATIVE, 0.0)
    negative_stiffness: float = quantity("N/m", "of the magnet, positive", NOT_NEGATIVE, 0.0)
    filter_frequency: float = quantity(
        "Hz", "corner of the low pass of first order before kp and kd, 0: none", NOT_NEGATIVE, 0.0
    )
    amplifier_time: float = quantity("s", "time constant of the amplifier", NOT_NEGATIVE, 0.0)
    delay: float = quantity("s", "of the controller", NOT_NEGATIVE, 0.0)

    def rational(self) -> tuple[np.ndarray, np.ndarray]:
        """Return numerator and denominator of the force by the displacement [N/m] without the
        delay, highest power of s first."""
        pass_time = 1 / (2 * math.pi * self.filter_frequency) if self.filter_frequency else 0.0
        low_pass = np.array([pass_time, 1.0])
        numerator = np.array([self.kd, self.kp])
        denominator = np.polymul(low_pass, [self.amplifier_time, 1.0])
        if self.ki:
            numerator = np.polyadd(np.append(numerator, 0.0), self.ki * low_pass)
            denominator = np.append(denominator, 0.0)
        force = self.force_per_current * numerator
        return np.trim_zeros(force, "f"), np.trim_zeros(denominator, "f")

    def __call__(self, s: complex) -> complex:
        """Return the force by the displacement at s [N/m]."""
        numerator, denominator = self.rational()
        ratio = np.polyval(numerator, s) / np.polyval(denominator, s)
        return complex(ratio * np.exp(-s * self.delay))


@dataclass(frozen=True)
class Sensitivity:
    """Sensitivity of control loops, in x and y, at f ascending frequencies and a speed [rad/s].

    frequencies: those that were asked for, with those of all peaks between them; loops: names, with
    the axis; sensitivity: complex of shape (f, loops) [1]; is_stable: whether all poles of the
    closed loops decay.
    """

    speed: float
    frequencies: np.ndarray
    loops: tuple[str, ...]
    sensitivity: np.ndarray
    is_stable: bool

    @property
    def largest(self) -> np.ndarray:
        """The largest size of each loop's sensitivity, shape (loops,) [1]."""
        return np.abs(self.sensitivity).max(axis=0)


def frequency_response(
    rotor: Rotor,
    frequencies: Sequence[float] | np.ndarray,
    force: AnyPlace | str,
    nodes: Sequence[AnyPlace],
    *,
    speed: float = 0.0,
    contacts: str | None = None,
    peaks: bool = False,
) -> FrequencyResponse:
    """Return the displacements of nodes (from 1), or places, by a force on one, or by an
    acceleration of the base, `base`, at frequencies [rad/s] above 0 and a speed [rad/s].

    contacts: `open` or `pinned`; None: open where the machine is held without them; peaks: whether
    the frequencies of all peaks between those asked for are added. Raises `LinearError`.
    """
    at = _checked(frequencies)
    nodes = listed("nodes", nodes, "nodes or places")
    if not nodes:
        raise LinearError("nodes: at least one must be given")
    plant = _Plant(rotor, speed, contacts)
    places = [as_place(node) for node in nodes]
    read = plant.selection(places)
    at_force: tuple[int | str, float]
    if isinstance(force, str):
        if force != MOVED:
            raise LinearError(f"force = {force!r}: must be a node, a place, or {MOVED!r}")
        at_force, push = (force, 0.0), plant.base_motion()
    else:
        at_force, push = as_place(force), plant.selection([as_place(force)])

    def answer(w: float) -> np.ndarray:
        return plant(1j * w, push, read).reshape(-1, 2, 2)

    if peaks:
        at, receptance = with_peaks(answer, at, plant.poles(at.max()))
    else:
        receptance = np.array([answer(w) for w in at])
    return FrequencyResponse(
        speed=plant.linear.speed,
        contacts=plant.machine.contacts,
        frequencies=at,
        force=at_force[0],
        force_offset=at_force[1],
        nodes=tuple(place.node for place in places),
        offsets=tuple(place.offset for place in places),
        receptance=receptance,
    )


def sensitivity(
    rotor: Rotor,
    frequencies: Sequence[float] | np.ndarray,
    loops: Sequence[ControlLoop],
    *,
    speed: float = 0.0,
    contacts: str | None = "open",
) -> Sensitivity:
    """Return the sensitivity of control loops at frequencies [rad/s] above 0, and at those of its
    peaks between them, and at a speed [rad/s].

    Raises `LinearError` without a loop, and for a node that the machine does not have.
    """
    at = _checked(frequencies)
    if not loops:
        raise LinearError("loops: at least one must be given")
    plant = _Plant(rotor, speed, contacts)
    magnets, sensors = [loop.magnet for loop in loops], [loop.sensor for loop in loops]
    negative = np.kron(np.diag([loop.negative_stiffness for loop in loops]), np.eye(2))
    size = 2 * len(loops)
    push, read = plant.selection(magnets), plant.selection([*magnets, *sensors])

    def answer(w: float) -> np.ndarray:
        both = plant(1j * w, push, read)
        of_magnets, of_sensors = both[:size], both[size:]
        closed = np.linalg.inv(np.eye(size) - negative @ of_magnets)
        H = np.kron(np.diag([loop(1j * w) for loop in loops]), np.eye(2))
        return np.diag(np.linalg.inv(np.eye(size) + of_sensors @ closed @ H))

    poles = _closed_poles(plant, loops)
    at, rows = with_peaks(answer, at, poles)
    scale = np.maximum(np.abs(poles), plant.machine.structure.numbers[0].lowest_omega)
    return Sensitivity(
        speed=plant.linear.speed,
        frequencies=at,
        loops=tuple(f"{loop.name} {axis}" for loop in loops for axis in "xy"),
        sensitivity=rows,
        is_stable=bool((poles.real <= _UNSTABLE * scale).all()),
    )


def _checked(frequencies: Sequence[float] | np.ndarray) -> np.ndarray:
    at = np.array(numbers("frequencies", frequencies))
    if len(at) < 1 or not (np.isfinite(at) & (at > 0)).all():
        raise LinearError("frequencies: must be above 0 and finite, at least one")
    return at


class _Plant:
    """The machine at a speed: displacements of places by forces on places."""

    def __init__(self, rotor: Rotor, speed: float, contacts: str | None) -> None:
        self.machine = shared_machine(rotor, contacts)
        self.linear = self.machine.at(checked_speed(speed))

    def selection(self, places: Sequence[AnyPlace]) -> np.ndarray:
        """Return x, y of places by the unknowns, shape (2 n, N)."""
        expand = self.machine.expand.tocsr()
        rows = []
        for node, offset in map(as_place, places):
            at = 4 * (check_node(self.machine, node) - 1)
            rows.append(expand[at : at + 2] + offset * expand[at + 2 : at + 4])
        return sp.vstack(rows).toarray()

    def base_motion(self) -> np.ndarray:
        """Return what pushes the unknowns where the base is accelerated in x, y, shape (2, N)
        [kg]."""
        return np.asarray(self.machine.base_load @ self.machine.expand)

    def __call__(self, s: complex, push: np.ndarray, read: np.ndarray) -> np.ndarray:
        """Return x, y of places by forces in x, y on places, shape (2 places, 2 forces) [m/N];
        push, read: `selection` of the forces' places, or `base_motion`, and of the others."""
        there = self.machine.vibrating(self.linear, abs(s))
        return read @ there.factorized(s)(push.T.astype(complex))[0]

    def poles(self, top: float) -> np.ndarray:
        """Return the oscillating poles up to a frequency at least [1/s], each followed by pads."""
        return modes_up_to(self.machine, self.linear, top, pads_whirl=True).eigenvalues


def _closed_poles(plant: _Plant, loops: Sequence[ControlLoop]) -> np.ndarray:
    """Return the poles of the machine with its closed loops [1/s], states of laws, such as tilts of
    pads, being unknowns beside its own, and delays approximated by Pade's rational functions."""
    linear = plant.machine.with_own_states(plant.linear, of_all=True)
    strain, speed = linear.strain, abs(linear.speed)
    poles = _poles_of(plant, loops, linear, strain.by_d)
    if strain.kappa_h == 0.0:
        return poles
    fast = _poles_of(plant, loops, linear, strain.by_d_if_fast)  # hysteresis is another one there
    return np.concatenate([poles[np.abs(poles.imag) <= speed], fast[fast.imag > speed]])


def _poles_of(
    plant: _Plant, loops: Sequence[ControlLoop], linear: Linear, turned: np.ndarray
) -> np.ndarray:
    """Return `_closed_poles` with Z = turned of the shaft's strain (`Strain`)."""
    from scipy.signal import tf2ss  # which takes longer than most analyses

    strained = linear.system.matrix(linear.own_K, turned)
    M, D, K = (matrix.toarray() for matrix in (linear.M, linear.D, strained))
    for loop in loops:
        at = plant.selection([loop.magnet])
        K = K - loop.negative_stiffness * at.T @ at
    size = len(M)
    inverse = np.linalg.inv(M)
    rotor = np.block([[np.zeros((size, size)), np.eye(size)], [-inverse @ K, -inverse @ D]])
    if (own := linear.own_states) is not None:
        forces = np.vstack([np.zeros((size, len(own.tangents.by_states))), inverse @ own.forces()])
        rotor = np.block([[rotor, forces], [own.rates(), own.tangents.by_states]])
    whole, read, push = [rotor], [], []
    for loop in loops:
        numerator, denominator = loop.rational()
        if not len(numerator):  # all gains are 0
            continue
        if loop.delay:
            late, early = _pade(loop.delay)
            numerator, denominator = np.polymul(numerator, late), np.polymul(denominator, early)
        if len(numerator) > len(denominator):
            raise LinearError(
                f"loop {loop.name}: filter_frequency or amplifier_time is required; otherwise the "
                "loop gain is unbounded at high frequency"
            )
        system = tf2ss(numerator, denominator)
        for axis in (0, 1):
            whole.append(system[0])
            read.append((plant.selection([loop.sensor])[axis], system))
            push.append(inverse @ plant.selection([loop.magnet])[axis])
    A = scipy.linalg.block_diag(*whole)
    begin = len(rotor)
    for (sensor, (a, b, c, d)), force in zip(read, push, strict=True):
        end = begin + len(a)
        A[begin:end, :size] += b @ sensor[None, :]
        A[size : 2 * size, begin:end] -= force[:, None] @ c
        A[size : 2 * size, :size] -= d[0, 0] * np.outer(force, sensor)
        begin = end
    return np.linalg.eigvals(A)


def _pade(delay: float) -> tuple[np.ndarray, np.ndarray]:
    """Return numerator and denominator of a rational function near to exp(-s delay)."""
    n = _PADE
    powers = range(n, -1, -1)
    terms = np.array([math.comb(n, k) / math.perm(2 * n, k) * delay**k for k in powers])
    return terms * [(-1.0) ** k for k in powers], terms
