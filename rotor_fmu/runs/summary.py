"""The figures of a run: peaks, synchronous response, contacts and the solver's work."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from ..run_status import messages_and_codes
from ..vibration import TURN
from .measuring_points import bearings_of, probe_that_moves_most
from .other_whirl import other_whirl
from .peaks import largest_row, peak_index, start_up, why_no_peak
from .recording import Recording
from .run_down import Run
from .synchronous_response import largest_synchronous_response

_NEAR_PEAK = 0.005  # of its speed, within which contact angles are those of a peak
_NO_LOSS = 1e-12  # of the energies of a run: of less dissipation the ledger's rounding is a share
_PEAKS = (
    *("place", "x_peak_um", "x_peak_hz", "x_peak_s", "y_peak_um", "y_peak_hz", "y_peak_s"),
    *("no_peak", "x_largest_um", "y_largest_um", "r_largest_um", "r_start_um", "y_static_um"),
)
_OF_REST = ("y_static_um", "circulation_hz")  # of no machine that begins in the air


def summary(
    run: Run, place: str | None = None, recording: Recording | None = None
) -> dict[str, Any]:
    """Return the figures of a run; recording: of the run, whose rows show angles as communication
    points, some in a turn, may not, and which knows whether the machine begins in the air.

    place: whose peaks these are, by default of the part that moves most; x_peak_um, y_peak_um:
    largest amplitude 0-p from rest after the start-up; x_peak_hz, y_peak_hz, x_peak_s, y_peak_s:
    the speed and the time of it; no_peak: why there is none, and these are None, as of an amplitude
    that is largest at an edge of the run, or of a run at one speed; x_largest_um, y_largest_um,
    r_largest_um: the largest after the start-up, peak or not, in x, in y, in any direction;
    r_start_um: the largest in the start-up; y_static_um: where the place begins in y.

    other_order, other_hz, other_um: order, negative backward, frequency and major semi-axis of the
    largest whirl in the place's full spectrum where it moves most, if that is not 1x and a fifth of
    the motion: its peak over the speed is then no resonance with the speed. Else None.

    synchronous_place: whose 1x response after the start-up is the largest; synchronous_um: major
    semi-axis of its ellipse, 0-p; synchronous_hz: the speed of it; amplification: factor of the
    place's highest resonance, None where the run passes none, or too quickly, or not both of its
    half-power points. All are None of a run of too few turns, or whose 1x keeps its angle to the
    mark nowhere, as while a free vibration hides it.

    psi_at_x_peak_deg: between which contact angles the last bearing that touches does so at the
    peak in x, None if it does not there; circulation_hz: lowest and highest speed after the
    start-up at which that bearing's journal goes all round, passing the side opposite to where it
    rests. This and y_static_um are None of a machine that begins in the air.

    steps, rejected: steps that the solver took, and took again more finely; newton_per_step: its
    iterations; h_min, h_max, h_last: shortest, longest and last step [s]; solver_s: time of the run
    alone [s]; energy_residual: energy error of the integrator, relative to all energy dissipated
    [1]; trapped_steps, trapped_at_s: steps in the false state, and when it began; overdamped_at_s:
    since when the integrator dissipates more than the machine; status: `ok`, `doubtful` or
    `failed`, with the reason; messages: all that the run says of itself; codes: one for each.
    """
    c = run.columns
    last = {name: float(column[-1]) if len(column) else 0.0 for name, column in c.items()}
    steps = last["solver.steps"]
    losses = dissipated(last[name] for name in last if name.endswith("_loss"))
    stored = max((abs(last[n]) for n in last if n.startswith("energy.")), default=0.0)
    residual = last["energy.residual"] / losses if losses > _NO_LOSS * stored else None
    overdamped_at = last["solver.overdamped_at"]
    return {
        **(figures := _peaks(run, place or _probe(run, recording))),
        **_other_than_synchronous(run, figures["place"], recording),
        **_synchronous(recording),
        **_angles(recording or run, figures["x_peak_hz"]),
        **(dict.fromkeys(_OF_REST) if recording and recording.is_released else {}),
        "steps": int(steps),
        "rejected": int(last["solver.rejected"]),
        "newton_per_step": last["solver.newton"] / steps if steps else None,
        "h_min": last["solver.h_min_used"],
        "h_max": last["solver.h_max_used"],
        "h_last": last["solver.h_last"],
        "solver_s": run.wall_s,
        "energy_residual": residual,
        "trapped_steps": int(last["solver.trapped"]),
        "trapped_at_s": last["solver.trapped_at"] if last["solver.trapped"] else None,
        "overdamped_at_s": overdamped_at if overdamped_at >= 0 else None,
        "status": run.status,
        **messages_and_codes(run.messages),
    }


def dissipated(losses: Iterable[float]) -> float:
    """Return the energy dissipated by sinks [J]; a negative one, as of cross coupling, feeds the
    motion, and takes nothing from what others dissipate."""
    return sum(max(loss, 0.0) for loss in losses)


def last_contact(columns: Mapping[str, np.ndarray]) -> str | None:
    """Return the last part with a contact angle of those that touch, of all where none does."""
    parts = [name.removesuffix(".psi") for name in columns if name.endswith(".psi")]
    none = np.zeros(1)
    forces = {p: columns.get(f"{p}.fn_peak", columns.get(f"{p}.fn", none)) for p in parts}
    touching = [part for part, force in forces.items() if (force > 0.0).any()]
    return next(reversed(touching or parts), None)


def _probe(run: Run, recording: Recording | None) -> str | None:
    rotor = recording.rotor if recording else None
    return probe_that_moves_most(run.columns, bearings_of(rotor))


def _peaks(run: Run, place: str | None) -> dict[str, Any]:
    figures: dict[str, Any] = dict.fromkeys(_PEAKS)
    c, hz = run.columns, run.hz
    figures["place"] = place
    if len(hz) and place:
        figures["y_static_um"] = float(c[f"{place}.y"][0]) * 1e6
    late = np.flatnonzero(run.t > start_up(run.t, c["w"]))
    if not len(late):
        return figures | {"no_peak": why_no_peak(run.t, c["w"], run.status)}
    if place:
        before, after = np.split(c[f"{place}.r_amp"] * 1e6, late[:1])
        figures["r_start_um"] = float(before.max(initial=0.0))
        figures["r_largest_um"] = float(after.max())
    for axis in "xy" if place else "":
        amplitude = c[f"{place}.{axis}_amp"]
        largest = float(amplitude[late].max())
        figures[f"{axis}_largest_um"] = largest * 1e6
        at = peak_index(run.t, c["w"], amplitude)
        if at is not None:
            figures[f"{axis}_peak_um"] = float(amplitude[at]) * 1e6
            figures[f"{axis}_peak_hz"] = float(hz[at])
            figures[f"{axis}_peak_s"] = float(run.t[at])
        else:
            figures["no_peak"] = why_no_peak(run.t, c["w"], run.status, largest)
    return figures


def _other_than_synchronous(
    run: Run, place: str | None, recording: Recording | None
) -> dict[str, Any]:
    names = ("other_order", "other_hz", "other_um")
    if place is None or recording is None or not len(run.t):
        return dict.fromkeys(names)
    size = run.columns[f"{place}.r_amp"]
    at = largest_row(run.t, size, start_up(run.t, run.columns["w"]))
    found = other_whirl(recording, recording.place(place), float(run.t[at]), float(size[at]))
    if found is None:
        return dict.fromkeys(names)
    values = found.order, found.frequency / TURN, found.major * 1e6
    return dict(zip(names, values, strict=True))


def _synchronous(recording: Recording | None) -> dict[str, Any]:
    largest = largest_synchronous_response(recording) if recording else None
    resonance = largest and largest.resonance
    factor = resonance.amplification if resonance and not resonance.is_fast else math.nan
    return {
        "synchronous_place": largest and largest.place.name,
        "synchronous_um": largest and largest.major * 1e6,
        "synchronous_hz": largest and largest.speed / TURN,
        "amplification": factor if math.isfinite(factor) else None,
    }


def _angles(run: Run | Recording, peak_hz: float | None) -> dict[str, Any]:
    """Return psi of the last bearing that touches, while it does, from and to [deg], the latter
    above 360 where 0 is passed, at the speed of a peak, and between which speeds the journal
    circulates [Hz]."""
    figures: dict[str, Any] = {"psi_at_x_peak_deg": None, "circulation_hz": None}
    t, c, contact = run.t, run.columns, last_contact(run.columns)
    late = np.flatnonzero(t > start_up(t, c["w"]))
    if not contact or not len(late):
        return figures
    psi, hz = c[f"{contact}.psi"], c["w"] / TURN
    if peak_hz is not None:
        near = late[np.abs(hz[late] - peak_hz) <= _NEAR_PEAK * abs(peak_hz)]
        if f"{contact}.fn" in c:  # a journal in the air has no contact
            near = near[c[f"{contact}.fn"][near] > 0.0]
        if len(near):
            figures["psi_at_x_peak_deg"] = np.degrees(_range(psi[near])).tolist()
    laps = np.rint((np.unwrap(psi) - psi[0]) / TURN)  # one that rocks, however far, has none
    round_trip = late[laps[late] != laps[late - 1]]
    if len(round_trip):
        figures["circulation_hz"] = [float(f(hz[round_trip])) for f in (min, max)]
    return figures


def _range(angles: np.ndarray) -> np.ndarray:
    """Return the ends of a range of angles about their mean direction, from [0, 2 pi) on [rad]."""
    mean = float(np.angle(np.exp(1j * angles).sum()))
    away = (angles - mean + math.pi) % TURN - math.pi
    low = (mean + away.min()) % TURN
    return np.array([low, low + np.ptp(away)])


def touching(recording: Recording) -> dict[str, float]:
    """Return the share of the time in which each contact was closed [1], by its name."""
    t = recording.t
    if len(t) < 2 or not t[-1] > t[0]:
        return {}
    lasted = np.diff(t) / (t[-1] - t[0])
    return {
        name.removesuffix(".fn"): float(lasted @ (column[1:] > 0))
        for name, column in recording.columns.items()
        if name.endswith(".fn")
    }
