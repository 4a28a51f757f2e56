"""Numbers and names as the page writes them."""

from __future__ import annotations

from collections.abc import Sequence


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
