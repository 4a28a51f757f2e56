"""The data of the page of a run, computed here once, so that the browser only draws; of signals
over time every sample where there is room, else the extremes."""

from typing import Any, NamedTuple

import numpy as np

from .. import vibration
from ..display import current
from ..plotting.thinning import extremes
from ..runs.measuring_points import MeasuringPoint, display_name
from ..runs.peaks import is_constant, largest_row, start_up
from ..runs.recording import Recording
from ..vibration import TURN, Synchronous, TooFewTurns
from .criticals import NO_CRITICALS, Criticals
from .packed import COARSE, packed

_ROWS = 2000  # of curves over speed
_ON_END = 8  # turns of a Poincare section, where not all are shown
_STATIONS = 160  # speeds whose orbit and spectrum can be picked
_BLOCK, _ORBIT = 16, 2  # turns of a spectrum, of an orbit
_ORBIT_POINTS = 64  # a turn
_LEAST_BLOCK = 4
_MOST_PLACES = 12
ROOM = 2_400_000  # samples that a page holds in full
_STRETCHES = 15_000
_MOST = 40  # signals


def run_data(run: Recording, criticals: Criticals = NO_CRITICALS) -> dict[str, Any]:
    """Return everything but the signals over time, as JSON values; lengths in µm, speeds in Hz,
    forces in the unit that is shown; criticals: its machine's.

    A run of too few turns has no places, and `why` says so.
    """
    data: dict[str, Any] = {"name": run.name, "status": run.status, "why": None}
    data |= {"places": [], "touches": [], "power": None, "criticals": None}
    try:
        if not run.places:
            return data | {"why": "its recording has no place with x and y"}
        data |= _turns(run)
        data["criticals"] = criticals._asdict()
    except TooFewTurns as error:
        data["why"] = str(error)
    return data


def _turns(run: Recording) -> dict[str, Any]:
    shown = sorted(run.places, key=lambda p: (p.name != run.place().name, -p.motion))
    retained = {place.name for place in shown[:_MOST_PLACES]}
    result: dict[str, Any] = {"places": []}
    for place in run.places:
        if place.name not in retained:
            continue
        seen = _evaluated(run.resampled(place))
        result["places"].append(_place(place, seen, start_up(run.t, run.w)))
        if "stations" not in result:
            result |= _shared(seen)
    result["chosen"] = run.place().name
    d, contacts = current(), []
    for contact in run.contacts:
        rub = vibration.contact(run.t, run.phi, contact.psi, contact.fn, contact.peak)
        rows = np.union1d(_thin(len(rub.t)), extremes(rub.peak, _ROWS // 2))
        values = {"hz": rub.speed / TURN, "peak": rub.peak * d.force, "mean": rub.mean * d.force}
        values |= {"share": 100 * rub.share, "angle": np.degrees(rub.angle), "t": rub.t}
        values |= {"low": np.degrees(rub.low), "width": np.degrees(rub.width)}
        entry = {key: packed(column[rows]) for key, column in values.items()}
        contacts.append({"name": contact.name, "label": contact.label, **entry})
    sinks = run.sinks
    t, speed, powers = vibration.power_by_sink(run.t, run.phi, sinks)
    rows = _thin(len(t))
    power: dict[str, Any] = {"hz": packed(speed[rows] / TURN), "t": packed(t[rows])}
    power["sinks"] = [
        {"label": s, "total": float(sinks[s][-1]), "p": packed(p[rows])} for s, p in powers.items()
    ]
    return result | {"touches": contacts, "power": power, "force": d.force_unit}


class _Evaluated(NamedTuple):
    """A place's motion over whole turns, with the turns of a block of its spectra, and what it
    comes to."""

    signal: Synchronous
    block: int
    track: vibration.OrderTrack
    cascade: vibration.Cascade
    whirl: vibration.Whirl


def _evaluated(signal: Synchronous) -> _Evaluated:
    block = min(_BLOCK, signal.longest)  # fewer turns if the run has fewer
    return _Evaluated(
        signal,
        block,
        vibration.order_track_of(signal, turns=_LEAST_BLOCK),
        vibration.cascade_of(signal, turns=block, lines=_STATIONS),
        vibration.whirl_of(signal, turns=block),
    )


def _shared(seen: _Evaluated) -> dict[str, Any]:
    """Return the data common to all places: the turns' times and speeds, and the stations."""
    signal, block, track, cascade, whirl = seen
    rows = _thin(len(track.t))
    speed = cascade.speed / TURN
    stations = {"t": cascade.t.tolist(), "hz": speed.tolist(), "passage": cascade.passage.tolist()}
    turns = _thin_turns(len(signal.values))
    blocks = _thin(len(whirl.t))
    whirls = {"t": packed(whirl.t[blocks]), "hz": packed(whirl.speed[blocks] / TURN)}
    return {
        "track": {"t": packed(track.t[rows]), "hz": packed(track.speed[rows] / TURN)},
        "stations": stations,
        "isOneWay": cascade.is_one_way,
        "isConstant": is_constant(speed),
        "orders": cascade.order.tolist(),
        "turns": {"t": packed(signal.begin[turns]), "hz": packed(signal.speed[turns] / TURN)},
        "whirl": whirls | {"turns": block},
        "orbit": {"turns": _ORBIT, "points": _ORBIT_POINTS},
    }


def _place(place: MeasuringPoint, seen: _Evaluated, begin: float) -> dict[str, Any]:
    signal, block, track, cascade, whirl = seen
    rows = _thin(len(track.t))
    vectors = {"x": track.x(), "y": track.y()}
    curves = {
        f"{axis}{part}": packed(values[rows])
        for axis, vector in vectors.items()
        for part, values in (("Re", vector.real), ("Im", vector.imag))
    }
    curves |= {"twice": packed(track.major(2.0)[rows]), "half": packed(track.major(0.5)[rows])}
    middle = cascade.first + (block - _ORBIT) // 2
    stride = signal.per_turn // _ORBIT_POINTS
    orbits = np.array([signal.values[i : i + _ORBIT, ::stride].ravel() for i in middle])
    turns = _thin_turns(len(signal.values))
    points = signal.values[turns, 0]
    blocks = _thin(len(whirl.t))
    return {
        "name": place.name,
        "label": place.label,
        "largest": float(track.t[largest_row(track.t, track.major(), begin)]),
        "clearance": None if place.clearance is None else place.clearance * 1e6,
        "curves": curves,
        "orbits": {"re": packed(orbits.real, COARSE), "im": packed(orbits.imag, COARSE)},
        # what the steps were too long to show is drawn as nothing
        "cascade": packed(np.nan_to_num(cascade.amplitude), COARSE),
        "points": {"re": packed(points.real), "im": packed(points.imag)},
        "sense": packed(whirl.sense[blocks]),
        "order": packed(whirl.order[blocks]),
    }


def _thin(n: int) -> np.ndarray:
    return np.unique(np.linspace(0, n - 1, min(n, _ROWS)).round().astype(int))


def _thin_turns(n: int) -> np.ndarray:
    """Return turns by eights on end, so that a motion that repeats in a few of them has all its
    points in a Poincare section."""
    if n <= _ROWS:
        return np.arange(n)
    first = np.linspace(0, n - _ON_END, _ROWS // _ON_END).round().astype(int)
    return (first[:, None] + np.arange(_ON_END)).ravel()


def signal_data(run: Recording, room: int = ROOM) -> dict[str, Any]:
    """Return displacements, contact forces and the drive torque of a run over its time.

    Keys: t, packed [s], None where no signal is there in full; signals, each with name, label,
    unit, v, and t of its own where it is thinned, every says by how many steps.
    """
    entries = _entries(run)
    in_full = min(len(entries), max(room // max(len(run.t), 1) - 1, 0))
    signals = []
    for i, (name, unit, values) in enumerate(entries):
        entry: dict[str, Any] = {"name": name, "label": display_name(name), "unit": unit}
        entry |= {"t": None, "every": 1}
        if i >= in_full and len(values) > 2 * _STRETCHES:
            retained = extremes(values, _STRETCHES)
            entry["t"], values = packed(run.t[retained]), values[retained]
            entry["every"] = len(run.t) / _STRETCHES
        signals.append({**entry, "v": packed(values, COARSE)})
    is_shared = any(entry["t"] is None for entry in signals)
    return {"t": packed(run.t) if is_shared else None, "signals": signals}


def _entries(run: Recording) -> list[tuple[str, str, np.ndarray]]:
    """Return the names, units and values in the units that are shown, of the places that move most,
    as many as there is room for, and of all that is none."""
    d, result = current(), list[tuple[str, str, np.ndarray]]()
    others = [(f"{c.name}.fn", d.force_unit, c.fn * d.force) for c in run.contacts]
    if "tau" in run.columns:
        others.append(("tau", d.torque_unit, run.columns["tau"] * d.torque))
    others.append(("w", d.speed_unit, run.w * d.speed))
    moving = sorted(run.places, key=lambda p: (not p.name.startswith("disc"), -p.motion))
    for place in moving:
        result += [
            (f"{place.name}.x", d.small_unit, place.z.real * d.small),
            (f"{place.name}.y", d.small_unit, place.z.imag * d.small),
        ]
    return result[: max(_MOST - len(others), 2)] + others
