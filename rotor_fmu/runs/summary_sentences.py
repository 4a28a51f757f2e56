"""What a run came to, in three sentences."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..display import current
from ..run_status import DOUBTFUL, FAILED, OK
from .measuring_points import display_name
from .recording import Recording

_AXES = {"x": "horizontal", "y": "vertical"}


def sentences(figures: Mapping[str, Any], recording: Recording, page: Path) -> list[str]:
    """Return the peak, the contacts and the state of a run; figures: its `summary`; page: its
    report."""
    return [_peak(figures), _contacts(recording), _state(figures, page)]


def _peak(figures: Mapping[str, Any]) -> str:
    place = figures["place"]
    if place is None:
        return "No part's motion was observed: give the machine a disc, a body or a sensor."
    peaks = [
        f"{_AXES[axis]} {_length(amount)} at {figures[f'{axis}_peak_hz']:.1f} Hz "
        f"({60 * figures[f'{axis}_peak_hz']:.0f} rpm)"
        for axis in "xy"
        if (amount := figures[f"{axis}_peak_um"]) is not None
    ]
    if peaks:
        return f"Peak of {display_name(place)}, 0-p from rest: {', '.join(peaks)}."
    largest = [um for axis in "xy" if (um := figures[f"{axis}_largest_um"]) is not None]
    moved = ""
    if largest:
        moved = f"; {display_name(place)} moved by at most {_length(max(largest))} from rest"
    return f"No peak, because {figures['no_peak']}{moved}."


def _length(um: float) -> str:
    """Return an amplitude [um, 0-p] in the unit that is shown."""
    unit = current().small_unit
    if unit != "µm":
        return f"{um * 1e-6 * current().small:.3g} {unit}"
    return f"{um:.0f} um" if um >= 10.0 else f"{um:.2g} um"


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


def _contacts(recording: Recording) -> str:
    shares = touching(recording)
    if not shares:
        return "The machine has no contact that was recorded."
    if not any(shares.values()):
        return "No journal touched."
    least, most = (round(100 * f(shares.values())) for f in (min, max))
    if least == most:
        return f"The journals touched for {most} % of the time."
    each = ", ".join(f"{display_name(name)} {100 * share:.0f} %" for name, share in shares.items())
    return f"The journals touched for {least} to {most} % of the time ({each})."


def _state(figures: Mapping[str, Any], page: Path) -> str:
    status = str(figures["status"])
    if status == OK:
        return f"Nothing makes the run doubtful; open {page}."
    if status.startswith(FAILED):
        return f"The run stopped before its end; open {page} for what came before."
    codes = status.removeprefix(DOUBTFUL).split(", ")
    told = zip(figures.get("messages", ()), figures.get("codes", ()), strict=True)
    reasons = [f": {message}" for message, code in told if code in codes]
    return f"The run is {status}{reasons[0] if reasons else ''}; open {page}."
