"""Sentences with places for the numbers that a kernel tells.

`{g}` and `{.4g}` stand for a number, `{d}` for an integer, `{?this|that}` for the text that a
number chooses, from 0. The FMU's instance spells the same (`rotor_fmu/fmi/c/log.c`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable

TOLD = 16  # numbers of a sentence, at most
_PLACE = re.compile(r"\{(\?[^{}]*|[d]|\.?\d*g)\}")


def spell(pattern: str, numbers: Iterable[float]) -> str:
    """A sentence with its numbers."""
    told = iter(numbers)

    def shown(place: re.Match[str]) -> str:
        kind, number = place[1], next(told)
        if kind.startswith("?"):
            return kind[1:].split("|")[int(number)]
        return f"{int(number):d}" if kind == "d" else f"{number:{kind}}"

    return _PLACE.sub(shown, pattern)


def choice(texts: Iterable[str]) -> str:
    """The place for one of some texts."""
    return f"{{?{'|'.join(texts)}}}"
