"""Linear bearings and seals: eight coefficients, each constant or a table over the speed.

With the node's displacement d = u + i v [m] relative to the housing, or to ground,

    F = -(K d + C d'),    K = [[kxx, kxy], [kyx, kyy]],    C = [[cxx, cxy], [cyx, cyy]]

A liquid seal's fluid adds m d'' against ground, `added_mass` in the machine's mass matrix.

In complex coordinates K d = k d + l conj(d), with k = (kxx + kyy + i (kyx - kxy)) / 2 and l =
(kxx - kyy + i (kyx + kxy)) / 2.

The ledger: K0, the symmetric part of K at standstill, stores d^T K0 d / 2; C dissipates d'^T C d';
the rest, d'^T (K - K0) d, has no potential: it is the work of the cross coupling and of a stiffness
that depends on the speed. It is a separate entry, `circulation`, negative where it feeds the whirl.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ..kernels.jit import jit, jit_not_inlined
from ..quantities import (
    ANY,
    NOT_NEGATIVE,
    Output,
    QuantityError,
    check_all,
    places,
    quantities,
    quantity,
)
from .base import (
    FORCE_OUTPUTS,
    GROUND,
    AddedMassElement,
    Element,
    InterfaceElement,
    Part,
    ProbeElement,
    Shape,
)
from .law import Law
from .speed_table import check_ascending, check_column, cubic, interpolant, row_at, speed_table


def _stiffness(direction: str, *default: float) -> Any:
    text = f"stiffness, {direction}"
    return quantity("N/m", text, ANY, *default, is_parameter=True, may_be_list=True)


def _damping(direction: str, *default: float) -> Any:
    text = f"damping, {direction}"
    return quantity("N.s/m", text, ANY, *default, is_parameter=True, may_be_list=True)


@dataclass(frozen=True, kw_only=True)
class Coefficients:
    """Stiffness [N/m] and damping [N.s/m]: kxy is minus the force in x per displacement in y."""

    kxx: float | tuple[float, ...] = _stiffness("horizontal")
    kxy: float | tuple[float, ...] = _stiffness("horizontal force by vertical displacement", 0.0)
    kyx: float | tuple[float, ...] = _stiffness("vertical force by horizontal displacement", 0.0)
    kyy: float | tuple[float, ...] = _stiffness("vertical")
    cxx: float | tuple[float, ...] = _damping("horizontal")
    cxy: float | tuple[float, ...] = _damping("horizontal force by vertical velocity", 0.0)
    cyx: float | tuple[float, ...] = _damping("vertical force by horizontal velocity", 0.0)
    cyy: float | tuple[float, ...] = _damping("vertical")


# of a row of `speed_table`
_COLUMNS = 1 + 4 * len(quantities(Coefficients))
_CUBICS = places(quantities(Coefficients), 1, 4)


@jit_not_inlined
def coefficients(part, tables, speed):
    """Return the stiffness k, l [N/m] and damping c, e [N.s/m] at a speed [rad/s]: K d = k d + l
    conj(d), C d' = c d' + e conj(d'). Beyond a table's ends they are those at the end."""
    kxx, kxy, kyx, kyy = part.kxx, part.kxy, part.kyx, part.kyy
    cxx, cxy, cyx, cyy = part.cxx, part.cxy, part.cyx, part.cyy
    rows = part.rows
    if rows > 0:
        at = row_at(tables, part.table, rows, _COLUMNS, speed)
        s = max(0.0, speed - tables[at])
        kxx += cubic(tables, at + _CUBICS.kxx, s)
        kxy += cubic(tables, at + _CUBICS.kxy, s)
        kyx += cubic(tables, at + _CUBICS.kyx, s)
        kyy += cubic(tables, at + _CUBICS.kyy, s)
        cxx += cubic(tables, at + _CUBICS.cxx, s)
        cxy += cubic(tables, at + _CUBICS.cxy, s)
        cyx += cubic(tables, at + _CUBICS.cyx, s)
        cyy += cubic(tables, at + _CUBICS.cyy, s)
    k, l = 0.5 * complex(kxx + kyy, kyx - kxy), 0.5 * complex(kxx - kyy, kyx + kxy)  # noqa: E741
    return k, l, 0.5 * complex(cxx + cyy, cyx - cxy), 0.5 * complex(cxx - cyy, cyx + cxy)


LOSSES = (
    Output("bearings", "J", "dissipated by the damping of linear bearings", nominal=1.0),
    Output(
        "circulation",
        "J",
        "dissipated by the cross coupling of linear bearings and by the dependence of their "
        "stiffness on the speed; negative where it feeds the whirl",
        nominal=1.0,
    ),
)
_OUT, _LOSS = places(FORCE_OUTPUTS), places(LOSSES)


@jit
def _force(part, tables, kinematics, internal_state):
    d, d_dot = kinematics.displacement, kinematics.velocity
    k, l, c, e = coefficients(part, tables, kinematics.speed)  # noqa: E741
    return -(k * d + l * d.conjugate() + c * d_dot + e * d_dot.conjugate())


@jit
def _tangent(part, tables, kinematics, weights, free, internal_state):
    d, d_dot = kinematics.displacement, kinematics.velocity
    by_d, by_v = weights.displacement, weights.velocity
    k, l, c, e = coefficients(part, tables, kinematics.speed)  # noqa: E741
    force = -(k * d + l * d.conjugate() + c * d_dot + e * d_dot.conjugate())
    return force, -(by_d * k + by_v * c), -(by_d * l + by_v * e)


@jit
def _energy(part, tables, displacement, internal_state):
    d = displacement
    k, l, _, _ = coefficients(part, tables, 0.0)  # noqa: E741
    return (0.5 * ((k.real * d + l * d.conjugate()) * d.conjugate()).real,)


@jit
def _dissipate(part, tables, kinematics, internal_state, out):
    d, d_dot = kinematics.displacement, kinematics.velocity
    k, l, c, e = coefficients(part, tables, kinematics.speed)  # noqa: E741
    k0, l0, _, _ = coefficients(part, tables, 0.0)
    out[_LOSS.bearings] = ((c * d_dot + e * d_dot.conjugate()) * d_dot.conjugate()).real
    circulating = (k - k0.real) * d + (l - l0) * d.conjugate()
    out[_LOSS.circulation] = (circulating * d_dot.conjugate()).real
    return 0.0


@jit
def _observe(part, tables, kinematics, internal_state, out):
    force = _force(part, tables, kinematics, internal_state)
    out[_OUT.fx] = force.real
    out[_OUT.fy] = force.imag


def _table(part: "LinearBearing") -> np.ndarray:
    """Return the rows of `speed_table` of all coefficients; 0 of constants."""
    lists = {n: v for n in _CUBICS._fields if isinstance(v := getattr(part, n), tuple)}
    return speed_table(part.speed, _CUBICS._fields, lists)


LINEAR_BEARING = Law(
    name="linear_bearing",
    kind=Coefficients,
    force=_force,
    tangent=_tangent,
    energy=_energy,
    dissipate=_dissipate,
    observe=_observe,
    outputs=FORCE_OUTPUTS,
    stores=(Output("bearings", "J", "elastic energy of linear bearings and seals", nominal=0.01),),
    losses=LOSSES,
    table=_table,
    stiffness=lambda part: float(np.trace(part.matrices(0.0)[0])) / 2,
)


@dataclass(frozen=True, kw_only=True)
class LinearBearing(Coefficients, Part):
    """A bearing given by its eight coefficients, between a node (from 1) and the housing of that
    name or ground.

    A coefficient is a number, or a list over `speed` [rad/s], ascending: interpolated monotonically
    (PCHIP: Fritsch and Carlson 1980), constant beyond the ends.
    """

    KIND: ClassVar[str] = "linear_bearing"
    TEXT: ClassVar[str] = "a bearing, given by its stiffness and damping coefficients"
    LAWS: ClassVar[tuple[Law, ...]] = (LINEAR_BEARING,)

    node: int
    housing: str = GROUND
    speed: tuple[float, ...] = quantity(
        "rad/s", "speeds of the table, ascending", ANY, (), may_be_list=True
    )
    added_mass: float = quantity(
        "kg", "direct added mass of the fluid, which has no weight", NOT_NEGATIVE, 0.0
    )

    def check(self, where: str) -> None:
        """Raise `QuantityError` for impossible quantities or an impossible table."""
        check_all(where, self)
        if not isinstance(self.speed, tuple):
            raise QuantityError(f"{where}.speed = {self.speed!r}: must be a list of numbers")
        check_ascending(f"{where}.speed", "rad/s", self.speed)
        tabulated = [n for n in quantities(Coefficients) if isinstance(getattr(self, n), tuple)]
        if tabulated and not self.speed:
            raise QuantityError(f"{where}.{tabulated[0]}: a list needs {where}.speed")
        if tabulated and len(self.speed) < 2:
            raise QuantityError(f"{where}.speed: {len(self.speed)} given, at least 2 are needed")
        for name in tabulated:
            values, over = getattr(self, name), f"{where}.speed"
            check_column(f"{where}.{name}", values, over, len(self.speed))
        if self.speed and not tabulated:
            raise QuantityError(f"{where}.speed: no coefficient is a list over it")
        if self.added_mass > 0 and self.housing != GROUND:
            raise QuantityError(
                f"{where}.added_mass = {self.added_mass:g} kg: must be 0 in a housing"
            )

    def matrices(self, speed: float) -> tuple[np.ndarray, np.ndarray]:
        """Return K [N/m] and C [N.s/m] at a speed [rad/s], each of shape (2, 2)."""
        at = float(np.clip(speed, self.speed[0], self.speed[-1])) if self.speed else speed
        values = [
            float(interpolant(self.speed, v)(at)) if isinstance(v, tuple) else v
            for v in (getattr(self, name) for name in quantities(Coefficients))
        ]
        return np.reshape(values[:4], (2, 2)), np.reshape(values[4:], (2, 2))

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield one interface, a probe of the shaft in it and the added mass."""
        yield InterfaceElement(self.node, LINEAR_BEARING, self, self.housing)
        yield AddedMassElement(self.node, self.added_mass)
        yield ProbeElement(self.node)

    def outline(self) -> Iterator[Shape]:
        """Yield a spring from the shaft to ground or to its housing."""
        yield Shape(0.0, 0.0, 0.0, 0.0, "spring" if self.housing == GROUND else "pedestal")


@dataclass(frozen=True, kw_only=True)
class Seal(LinearBearing):
    """A seal: a linear bearing under its own name."""

    KIND: ClassVar[str] = "seal"
    TEXT: ClassVar[str] = "a seal, given by its stiffness and damping coefficients"
