"""Evaluation of a study: quantiles, how often limits are exceeded, sensitivities to parameters."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..run_status import FAILED, OK
from .design import SENSITIVITY, Axis, Design, Distribution
from .store import about_of, open_dataset
from .study import Limit

if TYPE_CHECKING:
    import xarray

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
CONFIDENCE = 0.95
# Samples that fill their space more evenly than independent draws would.
_EVEN = ("latin-hypercube", "sobol", "saltelli")


def analyse(folder: Path) -> dict[str, Any]:
    """Return the figures of the rows there are, as JSON can say them.

    columns: of every metric, count of finite and infinite values, least and largest, and, unless
    the design is morris, whose points are placed to be compared, mean, std and quantiles; limits:
    how many runs pass each, and the share, in which a run that failed counts as one that does; of
    runs drawn independently with its interval of Clopper and Pearson; says: notes on how to read
    them; sensitivity: indices of Sobol or Morris with their confidence intervals, where the design
    is one of theirs.
    """
    about, data = about_of(folder), open_dataset(folder)
    design = design_of(about["design"])
    numbers = [c["name"] for c in about["columns"] if not c["dimension"]]
    raw = data.copy()
    for name in (c["name"] for c in about["columns"] if c.get("is_direction")):
        if name in numbers:
            data[name] = data[name].dims, about_their_mean(data[name].values)
    status = data.status.values.astype(str)
    failed = np.char.startswith(status, FAILED)
    rows = np.arange(len(status))
    if is_estimate(design):
        rows = drawn_rows(design, data.run.values)
    count_failed = int(failed[rows].sum())
    columns = {name: statistics(data[name].values[rows]) for name in numbers}
    limits = {
        name: exceedance(raw[name].values[rows], Limit(**limit), count_failed)
        for name, limit in about["limits"].items()
    }
    meaningless = {"interval"} if design.listed else set()
    if not is_estimate(design):
        meaningless = {"mean", "std", "quantiles", "share", "interval"}
    for result in (*columns.values(), *limits.values()):
        for key in meaningless & result.keys():
            del result[key]
        if "interval" in result:
            result["conservative"] = design.kind in _EVEN
    said = _says(design, count_failed, len(rows))
    for name, result in limits.items():
        if "share" in result and (lacking := len(rows) - result["count"]):
            said.append(
                f"{lacking} of {len(rows)} runs have no value of {name}, whose share is of the "
                "others"
            )
    said += [
        f"{result['infinite']} of {len(rows)} runs have an infinite value of {name}, which stands "
        "in no quantile"
        for name, result in columns.items()
        if "infinite" in result
    ]
    report: dict[str, Any] = {
        "name": about["name"],
        "runs": about["runs"],
        "rows": int(data.sizes["run"]),
        "failed": int(failed.sum()),
        "doubtful": int((status != OK).sum() - failed.sum()),
        "columns": columns,
        "limits": limits,
        "says": said,
    }
    if design.kind in SENSITIVITY:
        report["sensitivity"] = {name: sensitivity(design, data, name) for name in numbers}
    return report


def is_estimate(design: Design) -> bool:
    """Return whether quantiles and shares of a design's points are meaningful for the varied
    parameters: not of those that morris places."""
    return design.kind != "morris"


def drawn_rows(design: Design, runs: np.ndarray) -> np.ndarray:
    """Return, of the rows of the given runs, shape (n,), those of points that were drawn, or
    listed, independently, equal points as often as they were."""
    row = np.full(len(design), -1)
    row[runs] = np.arange(len(runs))
    result = row[design.runs[design.is_independent]]
    return result[result >= 0]


def _says(design: Design, failed: int, count: int) -> list[str]:
    """Return notes on how to read quantiles and shares."""
    said = []
    if design.kind == "morris":
        said.append(
            "morris places its points to be compared with their neighbours: they give no quantiles "
            "and no shares"
        )
    elif not design.drawn:
        said.append("the points of a grid are chosen: quantiles and shares are of them alone")
    elif design.listed:
        said.append("each draw stands at all points of the lists: shares have no intervals")
    elif design.kind in _EVEN:
        said.append(
            f"a {design.kind} sample is spread more evenly than independent draws: intervals of "
            "shares are conservative, the true ones narrower"
        )
    if failed:
        said.append(
            f"{failed} of {count} runs failed: they count as beyond every limit, and stand in no "
            "quantile"
        )
    return said


def design_of(design: dict[str, Any]) -> Design:
    """Return the design that is recorded in a folder."""
    axes = []
    for axis in design["axes"]:
        is_drawn = "distribution" in axis
        drawn = Distribution(axis["distribution"], axis["parameters"]) if is_drawn else None
        targets, values = tuple(axis["targets"]), tuple(axis.get("values", ()))
        axes.append(Axis(axis["name"], targets, values, drawn, axis.get("unit", "")))
    kind, size, seed = design["kind"], design["size"], design["seed"]
    return Design(tuple(axes), kind, size, seed, levels=design["levels"])


def about_their_mean(angles: np.ndarray) -> np.ndarray:
    """Return angles [rad], which begin anew after a turn, within half a turn of their mean
    direction, shape (n,)."""
    mean = np.angle(np.exp(1j * angles[np.isfinite(angles)]).sum())
    return mean + np.angle(np.exp(1j * (angles - mean)))


def statistics(values: np.ndarray) -> dict[str, Any]:
    """Return how many values are finite, how many infinite if any are, and mean, standard deviation
    and quantiles of the finite ones; shape (n,)."""
    finite = values[np.isfinite(values)]
    infinite = int(np.isinf(values).sum())
    of_infinite = {"infinite": infinite} if infinite else {}
    if not len(finite):
        return {"count": 0, **of_infinite}
    result = np.quantile(finite, QUANTILES).tolist()
    return {
        **of_infinite,
        "count": len(finite),
        "mean": float(finite.mean()),
        "std": float(finite.std(ddof=1)) if len(finite) > 1 else 0.0,
        "least": float(finite.min()),
        "largest": float(finite.max()),
        "quantiles": dict(zip(map(str, QUANTILES), result, strict=True)),
    }


def exceedance(values: np.ndarray, limit: Limit, failed: int = 0) -> dict[str, Any]:
    """Return how many of the values that there are lie beyond a limit, and the share of these
    together with the failed runs, which may have passed it too."""
    from scipy.stats import binomtest

    is_beyond = values < limit.value if limit.is_least else values > limit.value
    beyond, count = int(is_beyond.sum()), int((~np.isnan(values)).sum()) + failed
    result: dict[str, Any] = {"limit": limit.value, "is_least": limit.is_least}
    result |= {"beyond": beyond, "failed": failed, "count": count}
    if count:
        interval = binomtest(beyond + failed, count).proportion_ci(CONFIDENCE)
        result["share"] = (beyond + failed) / count
        result["interval"] = [float(interval.low), float(interval.high)]
    return result


def sensitivity(design: Design, data: "xarray.Dataset", name: str) -> dict[str, Any]:
    """Return the indices of a column by varied name, each with its half width at 95 %.

    Of a sample with gaps whole blocks are used; `{}` of fewer than two, or none that vary.
    """
    of_runs = np.full(len(design), math.nan)
    of_runs[data.run.values] = data[name].values
    values = of_runs[design.runs]
    block = design.drawn_points // design.size
    whole = np.isfinite(values.reshape(-1, block)).all(axis=1)
    retained = np.repeat(whole, block)
    if whole.sum() < 2 or np.ptp(values[retained]) == 0:
        return {}
    problem = design.problem()
    names = problem["names"]
    drawn = {"conf_level": CONFIDENCE, "seed": design.seed}
    if design.kind == "saltelli":
        from SALib.analyze import sobol

        result = sobol.analyze(problem, values[retained], calc_second_order=False, **drawn)
        keys = ("S1", "S1_conf", "ST", "ST_conf")
    else:
        from SALib.analyze import morris

        drawn["num_levels"] = design.levels
        result = morris.analyze(problem, design.sample[retained], values[retained], **drawn)
        keys = ("mu", "mu_star", "mu_star_conf", "sigma")
    indices = {axis: {key: float(result[key][i]) for key in keys} for i, axis in enumerate(names)}
    return {"blocks": int(whole.sum()), "of": len(whole), "indices": indices}


def worst(
    data: "xarray.Dataset", name: str, count: int = 10, *, limit: Limit | None = None
) -> list[dict[str, Any]]:
    """Return the runs with the largest absolute value of a column, of one that has a limit those
    nearest to it or furthest beyond; those that failed first."""
    values = data[name].values
    values = np.abs(values) if limit is None else -values if limit.is_least else values
    failed = np.char.startswith(data.status.values.astype(str), FAILED)
    order = np.lexsort((-values, ~failed))  # a nan is behind all others
    axes = [str(c) for c in data.coords if data[c].dims == ("run",) and c not in ("run", "id")]
    return [
        {
            "id": str(data.id.values[i]),
            "run": int(data.run.values[i]),
            **{axis: float(data[axis].values[i]) for axis in axes},
            name: float(data[name].values[i]),
            "status": str(data.status.values[i]),
        }
        for i in order[:count]
    ]
