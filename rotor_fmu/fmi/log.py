"""Messages of an FMU's log: a sentence and, in brackets, the code that a machine reads."""

from __future__ import annotations

import re

from ..model.spelling import Message

_CODE = re.compile(r" \[([a-z-]+)\]")


def with_code(text: str, code: str) -> str:
    """A sentence as an FMU says it."""
    return f"{text} [{code}]" if code else text


def read_message(text: bytes) -> Message:
    """A message as an FMU's logger gets it; its code is empty where it has none."""
    # the wrapper puts a line of its own before the message of an exception
    line = text.decode("utf-8", "replace").splitlines()[-1] if text else ""
    code = _CODE.search(line)
    return Message(_CODE.sub("", line), code[1] if code else "")
