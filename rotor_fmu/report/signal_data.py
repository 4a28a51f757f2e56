"""Signals over time for the page: every sample where there is room, else the extremes."""

from typing import Any

import numpy as np

from ..display import current
from ..plotting.thinning import extremes
from ..runs.measuring_points import display_name
from ..runs.recording import Recording
from .packed import COARSE, packed

ROOM = 2_400_000  # samples that a page holds in full
_STRETCHES = 15_000
_MOST = 40  # signals


def signal_data(run: Recording, room: int = ROOM) -> dict[str, Any]:
    """Return displacements, contact forces and the drive torque of a run over its time.

    Keys: t, packed [s], None where no signal is there in full; signals, each with name, label,
    unit, v, and t of its own where it is thinned, every says by how many steps.
    """
    entries = _entries(run)
    in_full = min(len(entries), max(room // max(len(run.t), 1) - 1, 0))
    signals = []
    for i, (name, unit, values) in enumerate(entries):
        entry: dict[str, Any] = {
            "name": name,
            "label": display_name(name),
            "unit": unit,
            "t": None,
            "every": 1,
        }
        if i >= in_full and len(values) > 2 * _STRETCHES:
            retained = extremes(values, _STRETCHES)
            entry["t"], values = packed(run.t[retained]), values[retained]
            entry["every"] = len(run.t) / _STRETCHES
        signals.append({**entry, "v": packed(values, COARSE)})
    is_shared = any(entry["t"] is None for entry in signals)
    return {"t": packed(run.t) if is_shared else None, "signals": signals}


def _entries(run: Recording) -> list[tuple[str, str, np.ndarray]]:
    """Return the names, units and values in the units that are shown, what moves most first."""
    d, result = current(), list[tuple[str, str, np.ndarray]]()
    moving = sorted(run.places, key=lambda p: (not p.name.startswith("disc"), -p.motion))
    for place in moving:
        result += [
            (f"{place.name}.x", d.small_unit, place.z.real * d.small),
            (f"{place.name}.y", d.small_unit, place.z.imag * d.small),
        ]
    result += [
        (f"{contact.name}.fn", d.force_unit, contact.fn * d.force) for contact in run.contacts
    ]
    if "tau" in run.columns:
        result.append(("tau", d.torque_unit, run.columns["tau"] * d.torque))
    result.append(("w", d.speed_unit, run.w * d.speed))
    return result[:_MOST]
