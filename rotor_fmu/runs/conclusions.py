"""What a run came to, in sentences."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..display import current
from ..run_status import DOUBTFUL, OK, has_failed
from .measuring_points import display_name
from .peaks import start_up
from .recording import Recording
from .summary import touching

_ROUNDING = 1e-9  # of a share, that may be missing to all of the time
_AXES = {"x": "horizontal", "y": "vertical"}


def sentences(figures: Mapping[str, Any], recording: Recording, left: Path) -> list[str]:
    """Return the peak, the synchronous response if there is one, the contacts and the state of a
    run; figures: its `summary`; left: its report, or the folder where there is none."""
    about = [_peak(figures, recording), _contacts(recording), _state(figures, left)]
    if figures.get("synchronous_place") is not None:
        about.insert(1, _once_a_turn(figures))
    if figures.get("other_order") is not None:
        about.insert(1, _not_once_a_turn(figures))
    return about


def _peak(figures: Mapping[str, Any], recording: Recording) -> str:
    begin = "where it was released" if recording.is_released else "rest"
    place = figures["place"]
    if place is None:
        but = " but that of journals in their clearances" if recording.places else ""
        return f"No part's motion was observed{but}: give the machine a disc, a body or a sensor."
    peaks = [
        f"{_AXES[axis]} {_length(amount)} at {_speed(figures[f'{axis}_peak_hz'])}"
        for axis in "xy"
        if (amount := figures[f"{axis}_peak_um"]) is not None
    ]
    start = ""
    first, later = figures["r_start_um"], figures["r_largest_um"]
    if first is not None and (recording.is_released or first > later):
        end = start_up(recording.t, recording.w)
        start = f" In the start-up, the first {end:.3g} s, it moved by at most {_length(first)}."
    if peaks:
        return f"Peak of {display_name(place)}, 0-p from {begin}: {', '.join(peaks)}.{start}"
    moved = ""
    if figures["r_largest_um"] is not None:
        far = _length(figures["r_largest_um"])
        moved = f"; {display_name(place)} moved by at most {far} from {begin} after the start-up"
    return f"No peak, because {figures['no_peak']}{moved}.{start}"


def _not_once_a_turn(figures: Mapping[str, Any]) -> str:
    order, at = figures["other_order"], _speed(abs(figures["other_hz"])).replace("rpm", "cpm")
    size = _length(figures["other_um"] * (2 if current().is_pp else 1))
    measured, sense = current().amplitude_words.split()[-1], "backward" if order < 0 else "forward"
    return f"Where it moves most it whirls {sense} at {abs(order):.2g}x, {at}: {size} {measured}."


def _once_a_turn(figures: Mapping[str, Any]) -> str:
    place, factor = display_name(figures["synchronous_place"]), figures["amplification"]
    size = _length(figures["synchronous_um"] * (2 if current().is_pp else 1))
    measured = current().amplitude_words.split()[-1]
    at = _speed(figures["synchronous_hz"])
    amplified = "" if factor is None else f", amplification factor {factor:.3g}"
    return f"Largest synchronous (1x) response: {place}, {size} {measured} at {at}{amplified}."


def _speed(hz: float) -> str:
    """Return a speed [Hz] to a tenth of a Hz and in whole rpm, or to three digits if fewer, first
    in the unit that is shown."""
    both = [
        f"{value:.{places}f} {unit}" if abs(value) >= least else f"{value:.3g} {unit}"
        for unit, value, places, least in (("Hz", hz, 1, 10.0), ("rpm", 60 * hz, 0, 100.0))
    ]
    first, second = both if current().speed_unit == "Hz" else reversed(both)
    return f"{first} ({second})"


def _length(um: float) -> str:
    """Return a length [um] in the unit of displacements that is shown."""
    unit = current().small_unit
    if unit != "µm":
        return f"{um * 1e-6 * current().small:.3g} {unit}"
    return f"{um:.0f} um" if um >= 10.0 else f"{um:.2g} um"


def _contacts(recording: Recording) -> str:
    shares = touching(recording)
    if not shares:
        return "The machine has no contact that was recorded."
    met = {c.name for c in recording.contacts if (c.peak > 0).any()}  # in a row or between two
    if not met:
        return "No journal touched."
    if not any(shares.values()):
        return "Journals touched, but too shortly for the rows of the recording to show it."
    each = {name: _percent(share, name in met) for name, share in shares.items()}
    least, most = (each[f(shares, key=lambda name: shares[name])] for f in (min, max))
    if least == most:
        return f"The journals touched for {most} % of the time."
    listed = ", ".join(f"{display_name(name)}: {share} %" for name, share in each.items())
    return f"The journals touched for {least} to {most} % of the time ({listed})."


def _percent(share: float, has_met: bool) -> str:
    """Return a share of the time in whole percent: 0 only of none, 100 only of all."""
    if has_met and share < 0.005:
        return "less than 1"
    return "more than 99" if 0.995 <= share < 1.0 - _ROUNDING else f"{100 * share:.0f}"


def _state(figures: Mapping[str, Any], left: Path) -> str:
    status = str(figures["status"])
    if status == OK:
        return f"Nothing makes the run doubtful; open {left}."
    if has_failed(status):
        return f"The run stopped before its end; open {left} for what came before."
    codes = status.removeprefix(DOUBTFUL).split(", ")
    logged = zip(figures.get("messages", ()), figures.get("codes", ()), strict=True)
    reasons = [f": {message}" for message, code in logged if code in codes]
    return f"The run is {status}{reasons[0] if reasons else ''}; open {left}."
