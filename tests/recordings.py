"""Recordings in closed form."""

import numpy as np

from rotor_fmu.runs.recording import Recording


def recorded(stop=6.0, step=1e-3, speed=300.0, rate=-20.0, disc="disc[2]", **about):
    """A run-down with orders in closed form, a contact and two sinks: forward 1x of 80 um, backward
    1x of 20 um on a disc."""
    t = np.arange(0.0, stop, step)
    phi = speed * t + rate * t**2 / 2
    z = 40e-6 * np.exp(1j * (phi - 0.6)) + 10e-6 * np.exp(-1j * phi)
    columns = {"phi": phi, "w": speed + rate * t}
    for name, of in (("disc[1]", z), (disc, 2 * z), ("bearing[1]", 0.5 * z)):
        columns |= {f"{name}.x": of.real, f"{name}.y": of.imag}
    columns["bearing[1].psi"] = np.mod(np.angle(z), 2 * np.pi)
    columns["bearing[1].fn"] = np.where(z.real > 0, 5.0, 0.0)
    columns["energy.friction_loss"] = 2.0 * t
    columns["energy.structure_loss"] = 0.5 * t
    units = dict.fromkeys(columns, "m") | {"phi": "rad", "w": "rad/s"}
    return Recording(t, columns, units, {"machine": "closed form", "status": "ok", **about})


def write_study(folder, runs=60, planned=80, kind="random"):
    """A study's folder: the largest x over friction and clearance, some runs failed, a curve."""
    import json

    import pyarrow as pa
    import pyarrow.parquet as pq

    rng = np.random.default_rng(3)
    mu, clearance = rng.uniform(0, 0.4, runs), rng.uniform(2e-5, 1e-4, runs)
    has_failed = mu > 0.35
    peak = np.where(has_failed, np.nan, 5e-4 + 8e-4 * mu)
    grid = [20.0, 30.0, 40.0]
    columns = {
        "run": np.arange(runs),
        "id": [f"id{i:03d}" for i in range(runs)],
        "status": ["failed: whirled apart" if failed else "ok" for failed in has_failed],
        "mu": mu,
        "clearance": clearance,
        "peak": pa.array(peak, from_pandas=True),
        "amplitude": [None if np.isnan(p) else [p / 2, p, p / 3] for p in peak],
    }
    table = pa.table(columns)
    (folder / "rows").mkdir(parents=True)
    # parts overlap where a merge was cut short
    pq.write_table(table.slice(runs // 3), folder / "rows" / "a.parquet")
    pq.write_table(table.slice(0, runs // 2), folder / "rows" / "b.parquet")
    retained = {"text": "largest x", "unit": "m", "dimension": "", "coordinate": []}
    curve = {"text": "amplitude", "unit": "m", "dimension": "speed", "coordinate": grid}
    law = {"distribution": "uniform", "parameters": {"low": 0.0, "high": 1.0}}
    about = {
        "name": "tolerances",
        "runs": planned,
        "design": {
            **{"kind": kind, "size": planned, "seed": 0, "levels": 4},
            "axes": [
                {"name": name, "targets": [name], "unit": unit, **law}
                for name, unit in (("mu", "1"), ("clearance", "m"))
            ],
        },
        "columns": [
            {"name": "peak", "coordinate_unit": "1", **retained},
            {"name": "amplitude", "coordinate_unit": "rad/s", **curve},
        ],
    }
    (folder / "study.json").write_text(json.dumps(about))
    return columns
