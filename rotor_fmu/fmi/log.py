"""Messages of an FMU's log: a sentence and, in brackets, its machine-readable code."""

import re

from ..model.message_templates import Message

_CODE = re.compile(r" \[([a-z-]+)\]")


def with_code(text: str, code: str) -> str:
    """Return a sentence as an FMU logs it."""
    return f"{text} [{code}]" if code else text


def read_message(text: bytes) -> Message:
    """Return the message that an FMU's logger received; its code is empty if it has none."""
    # the wrapper puts a line of its own before the message of an exception
    line = text.decode("utf-8", "replace").splitlines()[-1] if text else ""
    line = line.replace("##", "#")  # a `#` alone would stand before a reference to a variable
    code = _CODE.search(line)
    return Message(_CODE.sub("", line), code[1] if code else "")
