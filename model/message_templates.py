"""Templates of messages, with places for the numbers that a kernel returns.

`{g}` and `{.4g}` stand for a number, `{d}` for an integer, `{?this|that}` for the text that a
number chooses, from 0. The FMU's instance formats them in the same way (`rotor_fmu/fmi/c/log.c`).
"""

import re
from collections.abc import Iterable
from typing import Any

MOST_ARGUMENTS = 16  # numbers of a sentence, at most
_PLACE = re.compile(r"\{(\?[^{}]*|[d]|\.?\d*g)\}")


def fill_template(pattern: str, numbers: Iterable[float]) -> str:
    """Return a template filled in with numbers."""
    arguments = iter(numbers)

    def shown(place: re.Match[str]) -> str:
        kind, number = place[1], next(arguments)
        if kind.startswith("?"):
            return kind[1:].split("|")[int(number)]
        return f"{int(number):d}" if kind == "d" else f"{number:{kind}}"

    return _PLACE.sub(shown, pattern)


class Message(str):
    """A message of a run, and its machine-readable code.

    A note is about the machine or the input; any other message means that the result is not to be
    trusted.
    """

    __slots__ = ("code",)
    code: str

    def __new__(cls, text: str, code: str) -> "Message":
        """Create a message from its text and its code."""
        message = super().__new__(cls, text)
        message.code = code
        return message

    def __getnewargs__(self) -> tuple[Any, ...]:
        """Return the arguments with which `pickle` and `copy` create it anew."""
        return str(self), self.code

    @property
    def is_note(self) -> bool:
        """Whether it is a note, which does not affect the quality of the run."""
        return self.code in NOTES


NOTES = frozenset(
    {
        "hysteretic-as-slower",
        "idle-setting",
        "interpreted",
        "reduction-pays",
        "slow",
        "tolerance-raised",
        "unstable",
        "unstable-at-rest",
    }
)


def choice(texts: Iterable[str]) -> str:
    """Return the place for one of several texts."""
    return f"{{?{'|'.join(texts)}}}"
