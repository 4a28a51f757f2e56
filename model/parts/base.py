"""The definition of a part: a frozen data class that says of which elements it consists.

Assembly knows only the few elements below. A new kind of part combines them, and brings a `Law` of
its own if a force is neither linear nor constant.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from ..quantities import SPEED, Output, Rule, check_all, quantities, remembered

if TYPE_CHECKING:
    from .law import Law

BASE = 0  # the node of a port that is the foundation's acceleration
GROUND = ""  # the name of the housing that does not move


class BodyElement(NamedTuple):
    """A rigid body on the shaft: mass [kg], diametral and polar moment of inertia about its centre
    [kg.m2], which lies `offset` [m] beyond the node along the shaft."""

    node: int
    mass: float
    diametral: float
    polar: float
    offset: float = 0.0


class AddedMassElement(NamedTuple):
    """A mass [kg] of fluid that a node accelerates against ground. It has no weight."""

    node: int
    mass: float


class SpringElement(NamedTuple):
    """An isotropic linear spring [N/m] and damper [N.s/m] from a node to ground."""

    node: int
    stiffness: float
    damping: float


class UnbalanceElement(NamedTuple):
    """A rotating unbalance `mass` times `e` [kg.m] at the angle `phase` of a part's quantities.

    spinning_mass [kg] turns on the circle of radius e and adds to the inertia about the axis; both
    lie `offset` [m] beyond the node along the shaft.
    """

    node: int
    mass: float
    spinning_mass: float
    e: float
    phase: float
    offset: float = 0.0


class ForceElement(NamedTuple):
    """A constant force [N], `offset` [m] beyond a node along the shaft."""

    node: int
    fx: float
    fy: float
    offset: float = 0.0


class BowElement(NamedTuple):
    """A residual bow of the shaft: how far a node between its ends lies off the line through these
    [m], and the angle of that from the shaft's mark [rad]."""

    node: int
    amplitude: float
    phase: float


class PortElement(NamedTuple):
    """A place where an external force acts, `offset` [m] beyond a node, with its name in texts; or
    `BASE`, whose input is the acceleration of the foundation. impedance: of a transmission line,
    whose end resists with this force per velocity [N.s/m]."""

    node: int
    where: str
    offset: float = 0.0
    impedance: float = 0.0


class ProbeElement(NamedTuple):
    """A place whose displacement and amplitude are observed, `offset` [m] beyond a node."""

    node: int
    offset: float = 0.0


class VelocityElement(NamedTuple):
    """A node whose velocity is observed."""

    node: int


class ReleaseElement(NamedTuple):
    """The rotor's rigid-body motion at the start, in the place of the equilibrium: of its centre of
    mass [m], [m/s], and its slope [1] with its rate [rad/s]."""

    x: float
    y: float
    vx: float
    vy: float
    tilt_x: float
    tilt_y: float
    rate_x: float
    rate_y: float


class MountElement(NamedTuple):
    """A housing called `name`, with the numbers of `source` (`parts.housing`)."""

    name: str
    source: Any


class InterfaceElement(NamedTuple):
    """A node against a housing, or against `GROUND`: a law with the numbers of `source`. ring: the
    housing at the node that moves in its place, if any."""

    node: int
    law: "Law"
    source: Any
    housing: str = GROUND
    ring: str = GROUND


Element = (
    BodyElement
    | AddedMassElement
    | SpringElement
    | UnbalanceElement
    | ForceElement
    | BowElement
    | PortElement
    | ProbeElement
    | VelocityElement
    | ReleaseElement
    | MountElement
    | InterfaceElement
)


_LAST = (
    "over the last whole revolution and after it, and since the last communication point; at "
    "standstill since that point alone"
)
_FROM_REST = f"{_LAST}; at rest under the loads at the start, or where [start] releases it"
_ONCE = "0-p, over the last whole revolution; 0 before the first one in one sense and at standstill"
_LEADS = "leads phi, in the sense of rotation: a lag is negative"
PROBE_OUTPUTS = (
    Output("x", "m", "displacement to the right", True, 1e-4),
    Output("y", "m", "displacement upwards, negative at rest by the static sag", True, 1e-4),
    *remembered(
        Output("x_amp", "m", f"largest abs(x - x at rest) {_FROM_REST}", nominal=1e-4),
        Output("y_amp", "m", f"largest abs(y - y at rest) {_FROM_REST}", nominal=1e-4),
        Output("r_amp", "m", f"largest distance from rest in any direction {_LAST}", True, 1e-4),
        Output("x_1x", "m", f"amplitude of the 1x component of x, {_ONCE}", nominal=1e-4),
        Output("y_1x", "m", f"amplitude of the 1x component of y, {_ONCE}", nominal=1e-4),
        Output("x_1x_phase", "rad", f"angle by which the 1x component of x {_LEADS}", nominal=1.0),
        Output("y_1x_phase", "rad", f"angle by which the 1x component of y {_LEADS}", nominal=1.0),
    ),
)
# Of an interface with a wall, behind the outputs of its law.
WALL_OUTPUTS = remembered(Output("fn_peak", "N", f"largest normal force {_LAST}", nominal=10.0))
# The force of an interface whose friction or coefficients depend on the speed.
FORCE_OUTPUTS = (
    Output("fx", "N", "force on the rotor, to the right", True, 10.0, reached_by=SPEED),
    Output("fy", "N", "force on the rotor, upwards", True, 10.0, reached_by=SPEED),
)
STEP_WORK = Output(
    "step_work", "J", "energy that entered here over the last communication step", nominal=1e-3
)
_MOTIONS = (
    ("x", "m/N", 1e-6),
    ("y", "m/N", 1e-6),
    ("vx", "m/(N.s)", 1e-3),
    ("vy", "m/(N.s)", 1e-3),
)
PORT_OUTPUTS = remembered(
    STEP_WORK,
    *(
        Output(
            f"d{name}_df{axis}",
            unit,
            f"change of {name} here, at the end of the last communication step, by f{axis} during "
            "it; 0 unless solver.sensitivities asks for it",
            nominal=nominal,
        )
        for name, unit, nominal in _MOTIONS
        for axis in "xy"
    ),
)
WAVE_OUTPUTS = tuple(
    Output(
        f"wave_{axis}",
        "N",
        f"reflected wave, f{axis} - 2 Z v{axis}",
        True,
        10.0,
        reached_by=f"f{axis}",
    )
    for axis in "xy"
)
VELOCITY_OUTPUTS = (
    Output("vx", "m/s", "velocity to the right", True, 1e-2),
    Output("vy", "m/s", "velocity upwards", True, 1e-2),
)
MOUNT_OUTPUTS = (
    Output("housing_x", "m", "displacement of the housing to the right", nominal=1e-4),
    Output("housing_y", "m", "displacement of the housing upwards", nominal=1e-6),
)


def outputs_of(element: Element) -> tuple[Output, ...]:
    """Return the outputs of an element, in the order in which they are observed."""
    if isinstance(element, ProbeElement):
        return PROBE_OUTPUTS
    if isinstance(element, VelocityElement):
        return VELOCITY_OUTPUTS
    if isinstance(element, MountElement):
        return MOUNT_OUTPUTS
    if isinstance(element, PortElement):
        outputs = PORT_OUTPUTS[:1] if element.node == BASE else PORT_OUTPUTS
        return (*outputs, *WAVE_OUTPUTS) if element.impedance > 0.0 else outputs
    if isinstance(element, InterfaceElement):
        more = WALL_OUTPUTS if element.law.has_wall else ()
        return (*element.law.outputs_of(element.source), *more)
    return ()


@dataclass(frozen=True)
class Part(ABC):
    """A part of a machine. Subclasses declare their quantities as fields.

    KIND: its table in a machine file and its name in the FMU; TEXT: what it is, in a line;
    IS_SINGLE: whether a machine has one at most; LAWS: that its interfaces may have; name: what its
    variables, pictures and messages call it, or "": its kind and number.
    """

    KIND: ClassVar[str]
    TEXT: ClassVar[str]
    IS_SINGLE: ClassVar[bool] = False
    LAWS: "ClassVar[tuple[Law, ...]]" = ()

    name: str = field(default="", kw_only=True)

    @abstractmethod
    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield the elements that the part puts into the machine; where: its name in messages;
        density: of the machine's material [kg/m3]."""

    @property
    def label(self) -> str:
        """The name that a user gave the part; empty without one."""
        return self.name

    def check(self, where: str) -> None:
        """Raise `QuantityError` for a quantity that the part cannot have; the message names it, its
        value and what is allowed, and the part as `where`."""
        check_all(where, self)

    def rule_of(self, name: str) -> Rule:
        """Return which values one of its quantities may have while the others are as they are."""
        return quantities(self)[name].rule

    def outline(self) -> "Iterator[Shape]":
        """Yield the blocks by which the part is drawn, z from its node on [m]."""
        yield from ()


class Shape(NamedTuple):
    """A block of a drawing: its left end and width along the shaft, its radii [m] (outer 0: that of
    the shaft), and its role: `body`; about the journal `housing`, on springs, or `stator`; `spring`
    to ground or `pedestal`, a spring to a housing; `force`, from above, or `lift`, from below;
    `gauge`."""

    left: float
    width: float
    inner: float
    outer: float
    role: str
