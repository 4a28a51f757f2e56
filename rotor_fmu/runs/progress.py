"""Progress of a run, with the length of its steps and what limits it."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from ..model.settings import Settings

# Of the time reached [s], and of what gives all that the model computes there, by name.
ReportProgress = Callable[[float, Callable[[], Mapping[str, float]]], None]
_NEARLY = 0.75  # of the longest step: what is left where an interval is cut to equal parts


def silent(t: float, observe: Callable[[], Mapping[str, float]]) -> None:
    """Show no progress."""


@contextmanager
def shown(label: str, stop: float, step: float, settings: Settings) -> Iterator[ReportProgress]:
    """Show the progress of a run: a bar on a terminal, otherwise a line every ten seconds.

    stop, step: end of the run and communication step [s]; settings: of the run.
    """
    # no run without progress needs a screen
    from ..screen import progress_of

    with progress_of(label, stop, first=10.0) as update:

        def report(t: float, observe: Callable[[], Mapping[str, float]]) -> None:
            update(t, lambda: f"{t:.4g} of {stop:g} s, {steps(observe(), step, settings)}", False)

        yield report


def steps(now: Mapping[str, float], step: float, settings: Settings) -> str:
    """Return the length of the last step, and what limits it, in words.

    now: the model's outputs, by name; step: the communication step [s].
    """
    h = now["solver.h_last"]
    length = f"{1e3 * h:.3g} ms" if h >= 1e-4 else f"{1e6 * h:.3g} µs"
    return f"steps of {length}{_limit(h, now, step, settings)}"


def _limit(h: float, now: Mapping[str, float], step: float, settings: Settings) -> str:
    if settings.mode == "fixed" or h >= _NEARLY * min(step, settings.h_max):
        return ""  # as long as was asked for
    if h <= 1.01 * settings.h_min:
        return ", the shortest allowed"
    touching = [name.removesuffix(".fn") for name in now if name.endswith(".fn") and now[name] > 0]
    by = "the tolerance" if settings.mode == "controlled" else "the error's limits"
    if touching:
        by += f" while {' and '.join(touching)} touch{'es' if len(touching) == 1 else ''}"
    return f", by {by}"
