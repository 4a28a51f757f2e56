"""Static deflection under gravity and loads, and the loads on the bearings."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..arguments import check_integer, rows
from ..machine.rotor import Rotor
from ..parts.base import InterfaceElement
from ..parts.law import never_breaks
from ..parts.load import Load
from ..quantities import STANDARD_GRAVITY
from ..structure.structure import total_mass
from .linear_machine import CHANGE, LinearError, LinearMachine, shared_machine
from .modes import checked_speed
from .support_loads import support_loads

_CREEPING, _HALVINGS = 1e-4, 8  # of a range of speeds
_NO_LOAD = 1e-10  # of the rotor's weight: what films bear that nothing loads is their rounding
# Of the same, and of a clearance: what pads leave whose angles are given to six digits.
_OF_PADS, _UNMOVED = 1e-7, 1e-6
Values = Sequence[float] | np.ndarray


@dataclass(frozen=True)
class Static:
    """A machine at rest under gravity and loads while it turns at `speed` [rad/s]; n nodes.

    contacts: `open` or `pinned`; z: positions of the nodes [m]; x, y [m], slope_x, slope_y [rad],
    shape (n,); housings: their names, housing_x, housing_y [m]; supports: names of the supports,
    support_z: their positions [m]; load_x, load_y: the load on each [N], downwards negative.
    """

    speed: float
    contacts: str
    z: np.ndarray
    x: np.ndarray
    y: np.ndarray
    slope_x: np.ndarray
    slope_y: np.ndarray
    housings: tuple[str, ...]
    housing_x: np.ndarray
    housing_y: np.ndarray
    supports: tuple[str, ...]
    support_z: np.ndarray
    load_x: np.ndarray
    load_y: np.ndarray


def static(
    rotor: Rotor,
    speed: float = 0.0,
    *,
    contacts: str | None = None,
    loads: Sequence[tuple[int, float, float]] = (),
) -> Static:
    """Return the static deflection of a machine under gravity and loads at a speed [rad/s].

    loads: (node from 1, force to the right, force upwards) [N]; contacts: `open` or `pinned`; None:
    open where the machine is held without them. Raises `LinearError` for a machine that is not held
    and for an unknown node.
    """
    speed = checked_speed(speed)
    machine = shared_machine(rotor, contacts)
    s = machine.structure
    force = np.zeros(machine.across.shape[1])
    for node, across, up in rows("loads", loads, "(node, force x, force y)"):
        at = 4 * (check_node(machine, node) - 1)
        force[at : at + 2] += across, up
    linear = machine.loaded(speed, force)
    whole = without_rounding(machine.expand @ linear.rest, CHANGE * s.numbers[0].small)
    x, y = whole[::2], whole[1::2]
    n = 2 * len(machine.nodes)
    bears = support_loads(machine, linear, machine.static_load + force).real
    bears = without_rounding(bears, _least_load(machine))
    sizes, moved = machine.structure.numbers[0], np.abs([x, y]).max()
    is_left = np.abs(bears).max(initial=0.0) <= _least_load(machine, _OF_PADS)
    is_left &= moved <= _UNMOVED * min(sizes.clearance, sizes.small)
    if is_left and not (machine.static_load + force).any():
        x, y, bears = 0.0 * x, 0.0 * y, 0.0 * bears
    return Static(
        speed=speed,
        contacts=machine.contacts,
        z=machine.nodes,
        x=x[:n:2],
        y=y[:n:2],
        slope_x=x[1:n:2],
        slope_y=y[1:n:2],
        housings=machine.supports.housings,
        housing_x=x[n:-1],
        housing_y=y[n:-1],
        supports=machine.supports.names,
        support_z=machine.nodes[machine.support_dofs // 2],
        load_x=bears[:, 0],
        load_y=bears[:, 1],
    )


def _least_load(machine: LinearMachine, share: float = _NO_LOAD) -> float:
    """Return the load [N] up to which what a support bears is rounding; share: of the weight."""
    return share * float(total_mass(machine.structure)) * STANDARD_GRAVITY


def without_rounding(values: np.ndarray, least: float) -> np.ndarray:
    """Return values, 0 where they are no larger than `least`, which is rounding."""
    return np.where(np.abs(values) > least, values, 0.0)


def under_its_weight(rotor: Rotor) -> Rotor:
    """Return the machine lying under its weight alone, without its constant loads."""
    lying = replace(rotor, gravity=STANDARD_GRAVITY, gravity_angle=0.0, inclination=0.0)
    return lying.with_parts(Load)


def needs_to_turn(rotor: Rotor, contacts: str | None = None) -> bool:
    """Return whether a machine is held and has oil films that carry their journals only as they
    turn, whatever else holds it: at standstill these lie on their walls, or no film bears them. A
    squeeze film's ring is where its spring or cage holds it."""
    elements = (element for _, element in rotor.elements_of_kind(InterfaceElement))
    films = (e for e in elements if e.law.breaks is not never_breaks and e.law.stiffness is None)
    return any(films) and shared_machine(rotor, contacts).is_held


def speeds_and_loads(
    rotor: Rotor, name: str, speeds: Values, load: float | Values | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return speeds [rad/s] and the load on an interface at each, complex x + i y [N].

    load: along gravity [N], one or several; None: what its weight and loads put on it.
    Raises `LinearError` if there are several of both.
    """
    given = np.asarray(speeds, dtype=float)
    if load is None:
        machine = shared_machine(rotor)
        place = machine.supports.interfaces.index(name)
        loads = np.array([-machine.loaded(float(s)).laws.force[place] for s in given])
        real, imag = (without_rounding(of, _least_load(machine)) for of in (loads.real, loads.imag))
        return given, real + 1j * imag
    loads = 0.0 + rotor.downwards * np.atleast_1d(load)
    if len(loads) > 1 < len(given):
        raise LinearError(f"{len(given)} speeds and {len(loads)} loads: only one of them may vary")
    given, loads = np.broadcast_arrays(given, loads)
    return given, loads


def check_node(machine: LinearMachine | Rotor, node: int) -> int:
    """Return the node if the machine has it; raises `LinearError` otherwise."""
    check_integer("node", node, 1, len(machine.nodes), LinearError)
    return node


@lru_cache(maxsize=4)  # the answers of a report all begin there
def lowest_speed(rotor: Rotor, top: float, contacts: str | None = None) -> float:
    """Return the lowest speed up to `top` [rad/s], of either sign, from which on the machine has
    linear answers: 0, or where its oil films begin to carry it, to some percent."""
    machine = shared_machine(rotor, contacts)

    def is_carried(speed: float) -> bool:
        try:
            machine.at(speed)
        except LinearError:
            return False
        return True

    low, high = _CREEPING * top, top
    if is_carried(low) or not is_carried(high):
        return 0.0
    for _ in range(_HALVINGS):
        middle = math.copysign(math.sqrt(low * high), top)
        low, high = (low, middle) if is_carried(middle) else (middle, high)
    return high
