"""Numbers, names and tables of schemes as the page writes them."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

from rotor_fmu.cells import markdown_table

from .findings import title_of


def ms(h: float) -> str:
    """A step length [s] in ms."""
    return f"{h * 1e3:.3g}"


def percent(value: float | None) -> str:
    """A share in percent, a dash if there is none."""
    return (
        "-" if value is None else f"{100 * value:.2g}" if value < 0.0995 else f"{100 * value:.0f}"
    )


def listed(names: Sequence[str]) -> str:
    """Names in a sentence."""
    return " and ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)


def scheme_table(
    schemes: Iterable[str], columns: dict[str, Any], cell: Callable[[str, Any], str], corner: str
) -> str:
    """A row a scheme; columns: by their heads what `cell` makes a cell of, behind the scheme."""
    rows = [[title_of(s), *(cell(s, column) for column in columns.values())] for s in schemes]
    return markdown_table([corner, *columns], rows)


def step_table(
    schemes: Iterable[str], steps: Sequence[float], cell: Callable[[str, float], str]
) -> str:
    """A row a scheme, a column a step length [s]."""
    return scheme_table(schemes, {ms(h): h for h in steps}, cell, "h [ms]")
