"""The page of a periodic response: curves, and the orbit of the point under the pointer."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..display import current
from ..model.periodic.branch import Bifurcation, Solution
from ..report.packed import COARSE, packed
from ..report.report_tables import notices_html, table
from ..report.run_page import page, template
from .curves import ONCE_A_TURN, UNITS
from .vertices import Vertex, drawn, vertices

if TYPE_CHECKING:
    from .result import ResponseResult

_SAMPLES = 96  # of a turn of an orbit
_MOST_VALUES = 3_000_000  # of all orbits


def response_page(result: "ResponseResult", name: str) -> str:
    """Return the page as HTML; name: of the machine."""
    lines, axis = [vertices(branch) for branch in result.branches], result.axis
    points = [vertex.motion for line in lines for vertex in line]
    branches = [drawn(branch) for branch in result.branches]
    every = [vertex for branch in branches for vertex in branch]
    places = list(result.probes)
    turns = max((p.orbit.turns for p in points), default=1)
    samples = _SAMPLES * turns
    while samples > 32 and 2 * samples * len(points) * len(places) > _MOST_VALUES:
        samples //= 2
    data: dict[str, Any] = {
        "parameter": result.parameter,
        "unit": axis.unit,
        "small": current().small_unit,
        "value": packed(np.array([p.value for p in points]) * axis.factor),
        "branch": [i for i, line in enumerate(lines) for _ in line],
        "stable": [int(vertex.is_stable) for line in lines for vertex in line],
        "kind": [p.kind if isinstance(p, Bifurcation) else "" for p in points],
        "multiplier": packed(np.array([_largest(p) for p in points])),
        "harmonics": [p.orbit.H for p in points],
        # the shaft's mark meets a whirl at any phase
        "turns": [0 if result.is_whirl else p.orbit.turns for p in points],
        "whirl": packed(np.array([p.orbit.omega for p in points]) * current().speed),
        "frequency": current().frequency_unit if result.is_whirl else "",
        "samples": samples,
        "quantities": {q: current().of_si(unit).unit for q, unit in _units(result).items()},
        "line": {
            "value": packed(np.array([v.motion.value for v in every]) * axis.factor),
            "branch": [i for i, branch in enumerate(branches) for _ in branch],
            "stable": [int(v.is_stable) for v in every],
        },
        "places": [_place(result, place, points, every, samples) for place in places],
    }
    found = result.table()
    listed = table("Bifurcations", found.heads, found.rows) if found.rows else ""
    body = template("response.html").substitute(notices=notices_html(result.notes), tables=listed)
    return page(title=name, about=found.title, body=body, data=data, scripts=("response.js",))


def _units(result: "ResponseResult") -> dict[str, str]:
    """Return the quantities that the motions have, with their units."""
    return {q: u for q, u in UNITS.items() if not (result.is_whirl and q in ONCE_A_TURN)}


def _largest(point: Solution | Bifurcation) -> float:
    """Return the size of the largest multiplier, or of the one that crosses the unit circle."""
    if isinstance(point, Bifurcation):
        return abs(point.multiplier)
    return float(np.abs(point.multipliers[0])) if len(point.multipliers) else np.nan


def _place(
    result: "ResponseResult",
    place: str,
    points: list[Solution | Bifurcation],
    every: list[Vertex],
    samples: int,
) -> dict[str, Any]:
    """Return the curves of a place, those that are drawn through every vertex, and its orbits, one
    after another."""

    def curves(motions: Iterable[Solution | Bifurcation]) -> dict[str, Any]:
        values = [result.quantities(motion, place) for motion in motions]
        return {
            q: packed(current().of_si(unit).factor * np.array([each[q] for each in values]))
            for q, unit in _units(result).items()
        }

    # each by its own size about its mean: a small orbit would be steps of the largest one
    orbits = np.array([result.series(point, place, samples) for point in points])
    about = orbits.reshape(-1, 2, samples)
    about = about - about.mean(axis=2, keepdims=True)
    size = np.abs(about).max(axis=(1, 2), initial=0.0)
    x, y = (about / np.where(size > 0, size, 1.0)[:, None, None]).transpose(1, 0, 2)
    lines = curves(vertex.motion for vertex in every)
    orbit = {"x": packed(x, COARSE), "y": packed(y, COARSE), "size": packed(size * current().small)}
    return {"name": place, "curves": curves(points), "lines": lines, **orbit}
