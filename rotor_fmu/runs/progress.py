"""Progress of a run, with the length of its steps and what limits it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from rich.console import Console
from rich.progress import Progress, TimeRemainingColumn

from ..model.settings import Settings

# Of the time reached [s], and of what gives all that the model computes there, by name.
ReportProgress = Callable[[float, Callable[[], Mapping[str, float]]], None]
_console = Console(stderr=True)
_LINE_EVERY, _BAR_EVERY = 10.0, 0.1  # seconds, without and with a terminal
_NEARLY = 0.75  # of the longest step: what is left where an interval is cut to equal parts


def silent(t: float, observe: Callable[[], Mapping[str, float]]) -> None:
    """Show no progress."""


@contextmanager
def shown(label: str, stop: float, step: float, settings: Settings) -> Iterator[ReportProgress]:
    """A bar; where no terminal is, a line every now and then.

    stop, step: end of the run and communication step [s]; settings: of the run.
    """
    said = time.monotonic()

    def is_due(every: float) -> bool:
        nonlocal said
        if time.monotonic() - said < every:
            return False
        said = time.monotonic()
        return True

    def report(t: float, observe: Callable[[], Mapping[str, float]]) -> None:
        if is_due(_LINE_EVERY):
            _console.print(f"{label}: {t:.4g} of {stop:g} s, {steps(observe(), step, settings)}")

    if not _console.is_terminal:
        yield report
        return
    with Progress(
        *Progress.get_default_columns()[:-1],
        TimeRemainingColumn(),
        console=_console,
        transient=True,
    ) as bar:
        task = bar.add_task(label, total=stop)

        def progress(t: float, observe: Callable[[], Mapping[str, float]]) -> None:
            if is_due(_BAR_EVERY):
                text = f"{label}, {steps(observe(), step, settings)}"
                bar.update(task, completed=t, description=text)

        yield progress


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
