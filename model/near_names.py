"""Known names that are like a given one, which may be misspelt."""

from collections.abc import Iterable
from difflib import SequenceMatcher
from itertools import takewhile

_LIKE = 0.6  # least likeness of names, from 0 to 1


def near_names(
    given: object, known: Iterable[str], most: int = 1, least: float = _LIKE
) -> list[str]:
    """Return up to `most` known names, the one most like the given one first; of those that are
    equally like it, the one that begins like it, then the one that is known first.

    least: the least likeness of what is returned, from 0 to 1.
    """
    text = str(given)
    like = {name: SequenceMatcher(None, name, text).ratio() for name in known}
    near = [name for name, ratio in like.items() if ratio >= least]
    near.sort(key=lambda name: (-like[name], -_alike_from_begin(name, text)))
    return near[:most]


def suggestion(given: object, known: Iterable[str]) -> str:
    """Return `; did you mean x?` if a known name is near, for the end of a refusal."""
    near = near_names(given, known)
    return f"; did you mean {near[0]}?" if near else ""


def meant(name: str, known: Iterable[str]) -> str:
    """Return a suggestion for a misspelt name: up to three known ones that are like it, or, where
    none is, the first three and how many more there are."""
    listed = sorted(set(known))
    near = near_names(name, listed, 3, 0.5)
    if near:
        return f"did you mean {', '.join(near)}?"
    others = f" and {len(listed) - 3} more" if len(listed) > 3 else ""
    return f"known: {', '.join(listed[:3])}{others}" if listed else "there is none"


def _alike_from_begin(a: str, b: str) -> int:
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(a, b, strict=False)))
