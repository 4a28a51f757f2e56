"""Unbalances placed by a mode shape, so that the response shows that mode, as API 617 and 684 place
them, and the limit of vibration at the probes.

The residual unbalance of a plane that bears the mass W is 4 W / N oz.in (W in lb, N in rev/min),
in SI units 6350 W / N g.mm (W in kg), and W / 3.937 g.mm from 25 000 rev/min on (API 617, 7th
edition, part 1, 2.6.2 and 2.6.8); the analysis takes twice as much in all:

- bending to one side between the bearings: one unbalance where that is largest, W the static load
  of all bearings together: their sum as forces, in which a bearing that an overhung end lifts up
  counts downwards, so that it is the weight of the rotor;
- several lobes between the bearings: an unbalance in each, against each other as the lobes are, W
  the size of the static load of the bearing next to it;
- more kinetic energy beyond the bearings than between them: an unbalance where each overhung end
  moves most, also at the centre of a body beyond its node, W its mass.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ..arguments import check_integer, check_positive
from ..machine.rotor import Rotor
from ..parts.base import BodyElement
from ..parts.shaft import Section
from ..quantities import STANDARD_GRAVITY
from ..structure.assembly import assemble
from ..structure.beam import shaft_element
from .linear_machine import LinearError
from .places import Place, PlacedAmount
from .static import static, under_its_weight
from .undamped import UndampedMachine, without_seals

FACTOR = 2.0  # of the residual unbalance, for the analysis
_RESIDUAL = 6350e-6 * math.pi / 30  # kg.m rad/s per kg
_FASTEST = 25_000 * 2 * math.pi / 60  # speed above which the eccentricity no longer falls [rad/s]
_LOBE = 0.25  # of the largest amplitude: what is smaller gets no unbalance


class PlacedUnbalance(NamedTuple):
    """An unbalance: node (from 1), amount [kg.m], angle from the shaft's mark [rad], the mass W
    from which the amount follows [kg], and how far beyond the node it stands [m]."""

    node: int
    amount: float
    phase: float
    mass: float
    offset: float = 0.0

    @property
    def acting(self) -> PlacedAmount:
        """The unbalance as `unbalance_response` takes it."""
        return Place(self.node, self.offset) if self.offset else self.node, self.amount, self.phase


class _Point(NamedTuple):
    """A mass [kg] at a place, at z [m], that moves by w in a mode [1]."""

    place: Place
    z: float
    mass: float
    w: float


def residual_unbalance(mass: float, speed: float) -> float:
    """Return the residual unbalance [kg.m] that API 617 allows in a plane that bears a mass [kg]
    at the maximum continuous speed [rad/s]."""
    return _RESIDUAL * mass / min(speed, _FASTEST)


def vibration_limit(speed: float) -> float:
    """Return the limit of vibration at a probe [m], peak-to-peak: 25.4 um sqrt(12000 / N), at most
    25.4 um (API 617, 7th edition, part 1, 2.6.8); N: maximum continuous speed [rad/s]."""
    rpm = speed * 60 / (2 * math.pi)
    return 25.4e-6 * min(1.0, math.sqrt(12_000 / rpm))


def placed_unbalances(
    rotor: Rotor, mode: int, speed: float, *, factor: float = FACTOR, contacts: str | None = None
) -> list[PlacedUnbalance]:
    """Return the unbalances that excite a mode.

    mode: from 1, of the undamped machine at standstill in one plane; speed: the maximum continuous
    speed [rad/s]; factor: multiple of the residual unbalance; contacts: `open` or `pinned`. Raises
    `LinearError` for a mode that is not there, and for a factor that is none.
    """
    check_positive("factor", factor, error=LinearError)
    check_positive("maximum continuous speed", speed, "rad/s", LinearError)
    undamped = UndampedMachine(rotor, contacts, rigid_pedestals=False)
    shapes = undamped.planar_shapes(speed)
    check_integer("mode", mode, 1, len(shapes), LinearError)
    bearings = _bearing_masses(under_its_weight(rotor), undamped, speed)
    return [
        PlacedUnbalance(at.node, factor * residual_unbalance(mass, speed), phase, mass, at.offset)
        for at, phase, mass in _places(rotor, shapes[mode - 1], bearings)
    ]


def _bearing_masses(rotor: Rotor, undamped: UndampedMachine, speed: float) -> dict[int, complex]:
    """Return what rests on the bearings of each node at a speed [rad/s], seals aside: the load to
    the right and upwards as a complex number, over gravity [kg]."""
    loads = static(without_seals(rotor), speed, contacts=undamped.contacts)
    result: dict[int, complex] = {}
    for name, x, y in zip(loads.supports, loads.load_x, loads.load_y, strict=True):
        if name in undamped.bearings:
            node = undamped.bearings[name].node  # type: ignore[attr-defined]
            result[node] = result.get(node, 0.0) + complex(x, y) / STANDARD_GRAVITY
    return dict(sorted(result.items()))


def _points(rotor: Rotor, shape: np.ndarray) -> list[_Point]:
    """Return the masses of the nodes, and of bodies whose centre lies beyond their node."""
    z, mass = rotor.nodes, assemble(rotor).mass_sum[::2].copy()
    beyond = []
    for _, body in rotor.elements_of_kind(BodyElement):
        if body.offset:
            i = body.node - 1
            mass[i] -= body.mass
            moved = float(shape[i] @ (1.0, body.offset))
            place = Place(body.node, body.offset)
            beyond.append(_Point(place, z[i] + body.offset, body.mass, moved))
    at_nodes = zip(z, mass.tolist(), shape[:, 0].tolist(), strict=True)
    return [*(_Point(Place(i), *each) for i, each in enumerate(at_nodes, 1)), *beyond]


def _places(
    rotor: Rotor, shape: np.ndarray, bearings: dict[int, complex]
) -> list[tuple[Place, float, float]]:
    """Return place, angle and mass W of each unbalance."""
    z = rotor.nodes
    first, last = min(bearings), max(bearings)
    points = _points(rotor, shape)
    left = [point for point in points if point.z < z[first - 1]]
    right = [point for point in points if point.z > z[last - 1]]
    outside, whole = (sum(p.mass * p.w**2 for p in some) for some in (left + right, points))
    if 2 * outside > whole:
        least = _LOBE * max(abs(point.w) for point in points)
        return [
            *_beyond(left, rotor.sections[: first - 1][-1:], 2, least),
            *_beyond(right, rotor.sections[last - 1 :][:1], 0, least),
        ]
    lobes = _lobes(shape[:, 0], first, last)
    if len(lobes) == 1:
        return [(Place(lobes[0]), 0.0, abs(sum(bearings.values())))]
    result = []
    for node in lobes:
        is_against = (shape[node - 1, 0] > 0) != (shape[lobes[0] - 1, 0] > 0)
        nearest = min(bearings, key=lambda bearing: abs(z[bearing - 1] - z[node - 1]))
        result.append((Place(node), math.pi if is_against else 0.0, abs(bearings[nearest])))
    return result


def _beyond(
    end: Sequence[_Point], beside: Sequence[Section], at_bearing: int, least: float
) -> Iterator[tuple[Place, float, float]]:
    """Yield the unbalance of an end beyond the bearings that moves by more than `least`; its mass
    has what the element beside the bearing, if there is one, adds to the bearing's node."""
    moved = max(end, key=lambda point: abs(point.w), default=None)
    if moved and abs(moved.w) > least:
        shares = (shaft_element(one).translation[at_bearing, ::2].sum() for one in beside)
        mass = sum(point.mass for point in end) + float(sum(shares))
        yield moved.place, 0.0 if moved.w > 0 else math.pi, mass


def _lobes(shape: np.ndarray, first: int, last: int) -> list[int]:
    """Return the nodes of the largest deflection of each lobe from one bearing to another."""
    between = np.arange(first, last + 1)
    signs = np.sign(shape[between - 1])
    cuts = np.flatnonzero(np.diff(signs) != 0) + 1
    lobes = [piece[np.argmax(np.abs(shape[piece - 1]))] for piece in np.split(between, cuts)]
    largest = max(abs(shape[node - 1]) for node in lobes)
    return [int(node) for node in lobes if abs(shape[node - 1]) > _LOBE * largest]
