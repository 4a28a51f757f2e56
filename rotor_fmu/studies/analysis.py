"""What a study says: quantiles, how often a limit is passed, what each parameter does."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from .dataset import about_of, open_dataset
from .design import GRID, SENSITIVITY, Axis, Design, Distribution
from .study import FAILED

if TYPE_CHECKING:
    import xarray

QUANTILES = (0.01, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99)
CONFIDENCE = 0.95


def analyse(folder: Path) -> dict[str, Any]:
    """Figures of the rows there are, as JSON can say them.

    columns: of every number that is kept, count, mean, std and quantiles; limits: how many runs
    pass each, and the share with its interval of Clopper and Pearson, both of runs drawn
    independently (`is_drawn`); sensitivity: indices of Sobol or Morris with their confidence
    intervals, where the design is one of theirs.
    """
    about, data = about_of(folder), open_dataset(folder)
    design = design_of(about["design"])
    numbers = [c["name"] for c in about["columns"] if not c["dimension"]]
    drawn = data.isel(run=np.flatnonzero(is_drawn(design, data.run.values)))
    failed = np.char.startswith(data.status.values.astype(str), FAILED)
    report: dict[str, Any] = {
        "name": about["name"],
        "runs": about["runs"],
        "rows": int(data.sizes["run"]),
        "failed": int(failed.sum()),
        "doubtful": int((data.status.values != "ok").sum() - failed.sum()),
        "columns": {name: statistics(drawn[name].values) for name in numbers},
        "limits": {
            name: exceedance(drawn[name].values, limit) for name, limit in about["limits"].items()
        },
    }
    if design.kind == GRID:  # whose points are chosen: their share is no estimate
        for found in report["limits"].values():
            found.pop("interval", None)
    if design.kind in SENSITIVITY:
        report["sensitivity"] = {name: sensitivity(design, data, name) for name in numbers}
    return report


def is_drawn(design: Design, runs: np.ndarray) -> np.ndarray:
    """Whether runs were drawn independently of one another, shape (n,): a block of saltelli or
    morris holds points that differ in a coordinate from two, or from one, that were."""
    if design.kind not in SENSITIVITY:
        return np.ones(len(runs), dtype=bool)
    block = len(design) // design.size
    within = runs % block
    return (within == 0) | ((within == block - 1) & (design.kind == "saltelli"))


def design_of(told: dict[str, Any]) -> Design:
    """The design that a folder tells of."""
    axes = tuple(
        Axis(
            axis["name"],
            tuple(axis["targets"]),
            tuple(axis.get("values", ())),
            Distribution(axis["distribution"], axis["parameters"])
            if "distribution" in axis
            else None,
            axis.get("unit", ""),
        )
        for axis in told["axes"]
    )
    return Design(axes, told["kind"], told["size"], told["seed"], levels=told["levels"])


def statistics(values: np.ndarray) -> dict[str, Any]:
    """Count of finite values, mean, standard deviation, quantiles; shape (n,)."""
    finite = values[np.isfinite(values)]
    if not len(finite):
        return {"count": 0}
    found = np.quantile(finite, QUANTILES).tolist()
    return {
        "count": len(finite),
        "mean": float(finite.mean()),
        "std": float(finite.std(ddof=1)) if len(finite) > 1 else 0.0,
        "least": float(finite.min()),
        "largest": float(finite.max()),
        "quantiles": dict(zip(map(str, QUANTILES), found, strict=True)),
    }


def exceedance(values: np.ndarray, limit: float) -> dict[str, Any]:
    """How many of the finite values lie above a limit, and the share that this says."""
    from scipy.stats import binomtest

    finite = values[np.isfinite(values)]
    above = int((finite > limit).sum())
    if not len(finite):
        return {"limit": limit, "above": 0, "count": 0}
    interval = binomtest(above, len(finite)).proportion_ci(CONFIDENCE)
    return {
        "limit": limit,
        "above": above,
        "count": len(finite),
        "share": above / len(finite),
        "interval": [float(interval.low), float(interval.high)],
    }


def sensitivity(design: Design, data: xarray.Dataset, name: str) -> dict[str, Any]:
    """Indices of a column by the names of what is varied, each with its half width at 95 %.

    A sample with gaps is used up to its last whole block; `{}` where a run of it failed or none is
    whole.
    """
    values = np.full(len(design), math.nan)
    values[data.run.values] = data[name].values
    block = len(design) // design.size
    whole = np.isfinite(values.reshape(-1, block)).all(axis=1)
    if whole.sum() < 2 or np.ptp(values[np.isfinite(values)]) == 0:
        return {}
    kept = np.repeat(whole, block)
    problem = design.problem()
    names = problem["names"]
    if design.kind == "saltelli":
        from SALib.analyze import sobol

        found = sobol.analyze(
            problem, values[kept], calc_second_order=False, conf_level=CONFIDENCE, seed=design.seed
        )
        keys = ("S1", "S1_conf", "ST", "ST_conf")
    else:
        from SALib.analyze import morris

        found = morris.analyze(
            problem,
            design.sample[kept],
            values[kept],
            conf_level=CONFIDENCE,
            num_levels=design.levels,
            seed=design.seed,
        )
        keys = ("mu", "mu_star", "mu_star_conf", "sigma")
    indices = {axis: {key: float(found[key][i]) for key in keys} for i, axis in enumerate(names)}
    return {"blocks": int(whole.sum()), "of": len(whole), "indices": indices}


def worst(data: xarray.Dataset, name: str, count: int = 10) -> list[dict[str, Any]]:
    """The runs with the largest absolute value of a column, those that failed first."""
    if name not in data or data[name].ndim != 1:
        raise InputError(f"{name}: is no number that the study keeps")
    values = np.abs(data[name].values)
    failed = np.char.startswith(data.status.values.astype(str), FAILED)
    rank = np.where(failed, np.inf, np.where(np.isfinite(values), values, -np.inf))
    axes = [str(c) for c in data.coords if data[c].dims == ("run",) and c not in ("run", "id")]
    return [
        {
            "id": str(data.id.values[i]),
            "run": int(data.run.values[i]),
            **{axis: float(data[axis].values[i]) for axis in axes},
            name: float(data[name].values[i]),
            "status": str(data.status.values[i]),
        }
        for i in np.argsort(-rank, kind="stable")[:count]
    ]
