"""The varied parameters and the list of runs: lists and grids in product, distributions sampled.

A sample is drawn in the unit cube and mapped by the inverse of each distribution, so that every
design serves every distribution. Run i takes the grid's point i mod g and the sample's i div g.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from typing import Any

import numpy as np

from ..errors import InputError, check_integer, check_one_of
from ..units import number

GRID = "grid"
SAMPLED = ("random", "latin-hypercube", "sobol")
SENSITIVITY = ("saltelli", "morris")
DESIGNS = (GRID, *SAMPLED, *SENSITIVITY)
# name: what it needs
DISTRIBUTIONS = {
    "uniform": ("low", "high"),
    "log-uniform": ("low", "high"),
    "normal": ("mean", "std"),
    "truncated-normal": ("mean", "std", "low", "high"),
}
MOST = 10_000_000  # runs of a study


@dataclass(frozen=True)
class Distribution:
    """A distribution by name with its parameters; `InputError` for one that cannot be."""

    name: str
    parameters: Mapping[str, float]

    def __post_init__(self) -> None:
        p = self.parameters
        if "low" in p and not p["low"] < p["high"]:
            raise InputError(f"low = {p['low']:g}: must be below high = {p['high']:g}")
        if self.name == "log-uniform" and not p["low"] > 0:
            raise InputError(f"low = {p['low']:g}: must be > 0")
        if "std" in p and not p["std"] > 0:
            raise InputError(f"std = {p['std']:g}: must be > 0")

    def at(self, u: np.ndarray) -> np.ndarray:
        """Return the inverse of the cumulative distribution at shares u, of their shape; rounding
        carries none beyond the distribution's ends."""
        p = self.parameters
        return np.clip(self._rounded_at(u), p.get("low", -math.inf), p.get("high", math.inf))

    def _rounded_at(self, u: np.ndarray) -> np.ndarray:
        from scipy import stats

        p = self.parameters
        if self.name == "uniform":
            return p["low"] + u * (p["high"] - p["low"])
        if self.name == "log-uniform":
            return np.exp(math.log(p["low"]) + u * math.log(p["high"] / p["low"]))
        if self.name == "normal":
            return stats.norm.ppf(u, p["mean"], p["std"])
        a, b = ((p[end] - p["mean"]) / p["std"] for end in ("low", "high"))
        return stats.truncnorm.ppf(u, a, b, p["mean"], p["std"])


@dataclass(frozen=True)
class Axis:
    """Something that is varied: its name, the names of what it sets, its values, listed or
    distributed, and their unit ("1" where they have none, empty where it is not known)."""

    name: str
    targets: tuple[str, ...]
    values: tuple[float, ...] = ()
    distribution: Distribution | None = None
    unit: str = ""

    @property
    def stated(self) -> tuple[float, ...]:
        """The values that the file states: those listed, or the ends of the distribution."""
        law = {} if self.distribution is None else self.distribution.parameters
        return self.values or tuple(law[end] for end in ("low", "high") if end in law)

    @property
    def decides(self) -> dict[str, Any]:
        """Return what decides the values, as JSON values."""
        about: dict[str, Any] = {"name": self.name, "targets": list(self.targets)}
        if self.distribution is None:
            return about | {"values": list(self.values)}
        law = self.distribution
        return about | {"distribution": law.name, "parameters": dict(law.parameters)}


@dataclass(frozen=True)
class Design:
    """The list of runs, made when it is asked for; points that are equal are one run.

    kind: one of `DESIGNS`; size: of a sample its points, of saltelli the base sample's, of morris
    its trajectories. Raises `InputError`.
    """

    axes: tuple[Axis, ...]
    kind: str = GRID
    size: int = 0
    seed: int = 0
    levels: int = field(default=4, kw_only=True)

    def __post_init__(self) -> None:
        if self.drawn and self.kind == GRID:
            raise InputError(
                f"vary {self.drawn[0].name}: is distributed; [design] must name one of "
                f"{', '.join(DESIGNS[1:])} as its kind"
            )
        if self.kind != GRID and not self.drawn:
            raise InputError(f"design {self.kind}: nothing in [vary] is distributed")
        if self.kind in SENSITIVITY and self.listed:
            raise InputError(
                f"vary {self.listed[0].name}: is listed; {self.kind} takes distributions alone"
            )
        unbounded = [a for a in self.drawn if a.distribution and a.distribution.name == "normal"]
        if self.kind == "morris" and unbounded:
            raise InputError(
                f"vary {unbounded[0].name}: is normal; morris reaches the ends of a distribution, "
                "which must be bounded: truncated-normal, uniform or log-uniform"
            )
        points = math.prod(self.shape) * self.drawn_points
        if not 0 < points <= MOST:
            raise InputError(f"the design has {points} runs; must be from 1 to {MOST}")

    @property
    def listed(self) -> tuple[Axis, ...]:
        """The axes with listed values, in product."""
        return tuple(axis for axis in self.axes if axis.distribution is None)

    @property
    def drawn(self) -> tuple[Axis, ...]:
        """The axes with a distribution."""
        return tuple(axis for axis in self.axes if axis.distribution is not None)

    @property
    def shape(self) -> tuple[int, ...]:
        """Lengths of the lists."""
        return tuple(len(axis.values) for axis in self.listed)

    @property
    def drawn_points(self) -> int:
        """Points of the sample, 1 of a grid."""
        if self.kind == GRID:
            return 1
        beside = {"saltelli": len(self.drawn) + 1, "morris": len(self.drawn)}
        return self.size * (1 + beside.get(self.kind, 0))

    def __len__(self) -> int:
        return math.prod(self.shape) * len(self._distinct[0])

    @cached_property
    def sample(self) -> np.ndarray:
        """The sample in the unit cube, shape (points, distributed)."""
        from scipy.stats import qmc

        n, d = self.size, len(self.drawn)
        if self.kind == "random":
            return np.random.default_rng(self.seed).random((n, d))
        if self.kind == "latin-hypercube":
            return qmc.LatinHypercube(d, rng=np.random.default_rng(self.seed)).random(n)
        points = 1 << (n - 1).bit_length()  # of Sobol: whole powers of two, and their beginning
        if self.kind == "sobol":
            return qmc.Sobol(d, rng=np.random.default_rng(self.seed)).random(points)[:n]
        problem = self.problem()
        if self.kind == "saltelli":
            from SALib.sample import sobol

            sample = sobol.sample(problem, points, calc_second_order=False, seed=self.seed)
            return sample[: self.drawn_points]
        from SALib.sample import morris

        return morris.sample(problem, n, num_levels=self.levels, seed=self.seed)

    def problem(self) -> dict[str, Any]:
        """Return the unit cube as SALib describes it."""
        names = [axis.name for axis in self.drawn]
        return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}

    @cached_property
    def _drawn_values(self) -> np.ndarray:
        columns = [
            axis.distribution.at(self.sample[:, i])
            for i, axis in enumerate(self.drawn)
            if axis.distribution
        ]
        return np.array(columns)

    @cached_property
    def _distinct(self) -> tuple[np.ndarray, np.ndarray]:
        """Points of the sample that differ, each by its first, shape (m,), and for every point its
        place among them, shape (drawn_points,)."""
        if not self.drawn:
            return np.zeros(1, int), np.zeros(1, int)
        points = self._drawn_values.T
        _, first, place = np.unique(points, axis=0, return_index=True, return_inverse=True)
        order = np.argsort(first)
        rank = np.empty_like(order)
        rank[order] = np.arange(len(order))
        return first[order], rank[place.ravel()]

    @property
    def runs(self) -> np.ndarray:
        """The run of every point, in product with the lists, shape (points,)."""
        listed = math.prod(self.shape)
        return (listed * self._distinct[1][:, None] + np.arange(listed)).ravel()

    @property
    def is_independent(self) -> np.ndarray:
        """Whether each point was drawn by itself, shape (points,): a block of saltelli or morris
        holds points that differ in a coordinate from two, or from one, that were."""
        within = np.arange(self.drawn_points)
        if self.kind in SENSITIVITY:
            block = self.drawn_points // self.size
            within = within % block
            is_last = (within == block - 1) & (self.kind == "saltelli")
            return (within == 0) | is_last
        return np.ones(len(self.runs), bool)

    def point(self, run: int) -> dict[str, float]:
        """Return the values of a run by the axes' names."""
        drawn, at = divmod(run, math.prod(self.shape))
        values = {}
        for axis, i in zip(self.listed, np.unravel_index(at, self.shape), strict=True):
            values[axis.name] = axis.values[i]
        for k, axis in enumerate(self.drawn):
            values[axis.name] = float(self._drawn_values[k, self._distinct[0][drawn]])
        return {axis.name: values[axis.name] for axis in self.axes}

    def settings(self, point: Mapping[str, float]) -> dict[str, float]:
        """Return the values of a point by the names of what they set."""
        return {target: point[axis.name] for axis in self.axes for target in axis.targets}

    def values(self, run: int) -> dict[str, float]:
        """Return the values of a run by the names of what they set."""
        return self.settings(self.point(run))

    @property
    def _decides(self) -> dict[str, Any]:
        return {
            "kind": self.kind,
            "size": self.size,
            "seed": self.seed,
            "levels": self.levels,
            "axes": [axis.decides for axis in self.axes],
        }

    @property
    def description(self) -> dict[str, Any]:
        """Return its description, as JSON values."""
        axes = [axis.decides | {"unit": axis.unit} for axis in self.axes]
        return self._decides | {"axes": axes}

    @property
    def identity(self) -> str:
        """Hash of the axes, the kind, the seed and, since samplers change, of the sample."""
        digest = sha256(repr(self._decides).encode())
        if self.drawn:
            digest.update(self._drawn_values.tobytes())
            digest.update(self._distinct[1].tobytes())
        return digest.hexdigest()


def axis_of(
    name: str,
    targets: Sequence[str],
    table: Mapping[str, Any],
    unit: str = "",
    read: Callable[[str, object], float] = number,
) -> Axis:
    """Return the axis that a table of [vary] describes: `values`, `grid` or `distribution`; unit:
    of what is set; read: returns a listed value. `InputError`."""
    where = f"vary {name}"
    given = [key for key in ("values", "grid", "distribution") if key in table]
    if len(given) != 1:
        ways = "values = [...], grid = { from, to, count }, distribution = NAME"
        raise InputError(f"{where}: must have one of {ways}")
    allowed = {"names", given[0]}
    if given[0] == "values":
        values = _listed(where, table["values"], read)
    elif given[0] == "grid":
        values = _grid(where, table["grid"], unit)
    else:
        allowed |= {p for needed in DISTRIBUTIONS.values() for p in needed}
    for key in table:
        if key not in allowed:
            raise InputError(f"{where}: {key} is unknown beside {given[0]}")
    if given[0] != "distribution":
        return Axis(name, tuple(targets), tuple(dict.fromkeys(values)), unit=unit)
    return Axis(name, tuple(targets), distribution=_distribution(where, table, unit), unit=unit)


def _distribution(where: str, table: Mapping[str, Any], unit: str) -> Distribution:
    kind = table["distribution"]
    check_one_of(f"{where}: distribution = {kind!r}", kind, DISTRIBUTIONS)
    needed = DISTRIBUTIONS[kind]
    parameters = {key: table[key] for key in table if key not in ("names", "distribution")}
    for key in needed:
        if key not in parameters:
            raise InputError(f"{where}: a {kind} distribution needs {', '.join(needed)}; no {key}")
    for key in parameters:
        if key not in needed:
            raise InputError(f"{where}: a {kind} distribution has no {key}")
    numbers = {key: number(f"{where}: {key}", parameters[key], unit) for key in needed}
    try:
        return Distribution(kind, numbers)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _grid(where: str, grid: object, unit: str) -> tuple[float, ...]:
    form = "must be { from, to, count }, and may have spacing"
    if not isinstance(grid, dict):
        raise InputError(f"{where}: grid = {grid!r}: {form}")
    for key in ("from", "to", "count"):
        if key not in grid:
            raise InputError(f"{where}: grid without {key}: {form}")
    if unknown := sorted(grid.keys() - {"from", "to", "count", "spacing"}):
        raise InputError(f"{where}: grid with {unknown[0]}: {form}")
    low, high = (number(f"{where}: grid {key}", grid[key], unit) for key in ("from", "to"))
    check_integer(f"{where}: grid count", grid["count"], 1, MOST)
    spacing = grid.get("spacing", "linear")
    check_one_of(f"{where}: grid spacing = {spacing!r}", spacing, ("linear", "log"))
    if spacing == "log" and not (low > 0 and high > 0):
        raise InputError(f"{where}: grid from {low:g} to {high:g}: must be > 0 with spacing log")
    spread = np.geomspace if spacing == "log" else np.linspace
    return tuple(spread(low, high, grid["count"]).tolist())


def _listed(where: str, values: object, read: Callable[[str, object], float]) -> tuple[float, ...]:
    if not isinstance(values, list) or not values:
        raise InputError(f"{where}: values = {values!r}: must be a list of numbers")
    return tuple(read(where, value) for value in values)
