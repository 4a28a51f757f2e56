"""A rolling bearing alone: where its shaft rests under a load, its coefficients there, what each
element carries, and how both change while the elements pass."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np
from scipy.optimize import minimize

from ..kernels.kernel import interpreted
from ..linear.static import Values, speeds_and_loads
from ..linear.system_at_speed import LinearError
from ..machine.rotor import Rotor
from ..parts.law import BY_D
from ..parts.law_probe import LawProbe, cleared
from ..parts.rolling_bearing import RollingBearing, cage_ratio

_ITERATIONS, _LEFT, _OPEN = 1000, 1e-10, 1e-6  # forces over the load
_ROUNDING = 1e-14
_SMALL = 1e-6  # of an element's preload
_NEWTON, _SOFT = 8, 1e-12  # steps; of the stiffness, where nothing resists
_PLACES = 24  # of the cage while an element comes to where that before it was


class RollingAlone(LawProbe):
    """A rolling bearing whose shaft rests and whose elements stand.

    part: the bearing; where: its name, for messages; passed: how far the cage has turned from its
    start, the inner race ahead of it [rad].
    """

    def __init__(
        self, part: RollingBearing, where: str = "rolling_bearing", passed: float = 0.0
    ) -> None:
        super().__init__(part, 0.0, where)
        # Python's numbers: to read them of a record takes longer than to calculate with them
        names = self._law.dtype.fields or ()
        self._record = SimpleNamespace(**dict(zip(names, self._record.item(), strict=True)))
        self.part = part
        self.ratio = float(interpreted(cage_ratio)(part))
        self._states = np.array([passed, passed / self.ratio if passed else 0.0])

    def _energy(self, d: complex) -> float:
        energy = interpreted(self._law.energy)
        return float(energy(self._record, self._tables, complex(d), self._states)[0])

    def rest(self, load: complex, start: complex | None = None) -> complex:
        """Return where the shaft rests under a load [N]: where its energy, which is convex, is
        least, looked for from `start` on [m]; raises `LinearError` where that was not found."""
        part = self.part
        # a load that is small beside the elements' preload is borne where that is in balance
        preload = part.k * max(0.0, -part.clearance) ** part.exponent
        size = max(abs(load), _SMALL * preload)
        if size == 0.0:
            return 0j
        pressed = (size / part.k) ** (1.0 / part.exponent)
        # from where one element would carry more than the load
        reach = pressed + abs(part.clearance) + part.outer_depth + part.inner_depth

        def potential(x: np.ndarray) -> float:
            d = reach * complex(*x)
            return (self._energy(d) - (load.conjugate() * d).real) / (size * reach)

        def slope(x: np.ndarray) -> np.ndarray:
            left = (self.force(reach * complex(*x)) + load) / size
            return np.array([-left.real, -left.imag])

        def curvature(x: np.ndarray) -> np.ndarray:
            return -self.tangent(reach * complex(*x), 0j, BY_D) * reach / size

        def newton(x: np.ndarray) -> np.ndarray:
            for _ in range(_NEWTON):
                x = x - np.linalg.lstsq(curvature(x), slope(x), rcond=_SOFT)[0]
                if np.abs(slope(x)).max() < _ROUNDING:
                    break
            return x

        first = load / size if start is None else start / reach
        begin = np.array([first.real, first.imag])
        x = newton(begin)
        if np.abs(slope(x)).max() > _LEFT:
            options = {"gtol": _LEFT, "maxiter": _ITERATIONS, "initial_trust_radius": 0.1}
            found = minimize(
                potential, begin, method="trust-exact", jac=slope, hess=curvature, options=options
            )
            x = newton(found.x)  # the potential's digits may end before those of its slope do
        d = reach * complex(*x)
        if abs(self.force(d) + load) > _OPEN * size:
            raise LinearError(f"{self.where}: no equilibrium under its load, {abs(load):.4g} N")
        return d

    def element_loads(self, d: complex) -> np.ndarray:
        """Return what each element carries [N], shape (count,)."""
        part, loads = self.part, []
        for i in range(int(part.count)):
            # the law of this element alone
            angle = part.cage_angle + 2.0 * math.pi * i / part.count
            one = LawProbe(replace(part, cage_angle=angle, cage_ratio=self.ratio), 0.0, self.where)
            one._record.count, one._states = 1.0, self._states
            loads.append(one.outputs(d)["largest"])
        return np.array(loads)


@dataclass(frozen=True)
class RollingCurves:
    """A rolling bearing of Z elements over n loads.

    bearing: its name; clearance [m]; ratio: the cage's speed over the rotor's [1]; speeds: at which
    the machine has the loads [rad/s], shape (n,); load: on the shaft, to the right and upwards,
    shape (n, 2) [N]; x, y [m], largest load of an element [N], loaded: how many carry, shape (n,);
    angles of the elements [rad], shape (Z,), and what each carries [N], elements, shape (n, Z);
    K [N/m], C [N.s/m], shape (n, 2, 2), with the elements as they stand at the start. K_passing:
    the stiffness as the cage turns by an element's share of the circle, in equal steps, shape
    (n, m, 2, 2) [N/m].
    """

    bearing: str
    clearance: float
    ratio: float
    speeds: np.ndarray
    load: np.ndarray
    x: np.ndarray
    y: np.ndarray
    largest: np.ndarray
    loaded: np.ndarray
    angles: np.ndarray
    elements: np.ndarray
    K: np.ndarray
    C: np.ndarray
    K_passing: np.ndarray


def rolling_curves(
    rotor: Rotor, speeds: Values = (0.0,), *, bearing: str, load: float | Values | None = None
) -> RollingCurves:
    """Return a rolling bearing's equilibrium and coefficients under each load.

    speeds: of the machine [rad/s]; bearing: its name; load: along gravity [N], by default what the
    weight and loads put on it at each speed, on which nothing else depends. Raises `LinearError`
    if there is no equilibrium, or if there are several of both.
    """
    part = dict(rotor.named_parts())[bearing]
    assert isinstance(part, RollingBearing)
    speeds, loads = speeds_and_loads(rotor, bearing, speeds, load)
    pitch = 2.0 * math.pi / part.count
    places = [RollingAlone(part, bearing, i * pitch / _PLACES) for i in range(_PLACES)]
    alone = places[0]
    rows = [_row(places, complex(on)) for on in loads]
    return RollingCurves(
        bearing=bearing,
        clearance=part.clearance,
        ratio=alone.ratio,
        speeds=np.array(speeds),
        load=np.column_stack([loads.real, loads.imag]),
        angles=part.cage_angle + pitch * np.arange(int(part.count)),
        **{key: np.array([row[key] for row in rows]) for key in rows[0]},
    )


def _row(places: Sequence[RollingAlone], load: complex) -> dict[str, object]:
    alone = places[0]
    d = alone.rest(load)
    K, C = alone.coefficients(d)
    x, y = cleared(np.array([d.real, d.imag]))
    elements = alone.element_loads(d)
    passing, start = [K], d
    for each in places[1:]:
        start = each.rest(load, start)
        passing.append(each.coefficients(start)[0])
    return {
        "x": x,
        "y": y,
        "largest": elements.max(),
        "loaded": int(np.count_nonzero(elements)),
        "elements": elements,
        "K": cleared(K),
        "C": cleared(C),
        "K_passing": cleared(np.array(passing)),
    }
