"""How much a run is to be trusted: `ok`, `doubtful: ` and codes of warnings, `failed: ` and why."""

from collections.abc import Iterable

from .model.message_templates import Message

OK, DOUBTFUL, FAILED = "ok", "doubtful: ", "failed: "
NOT_CONFIRMED = "not-confirmed"  # a code
_OF_COST = ("reduction-pays", "slow")  # codes of what is said of a run's cost, not of its numbers


def status_of(messages: Iterable[Message], failure: str | None = None) -> str:
    """Return the status of a run that said this; failure: why it ended early."""
    if failure is not None:
        return f"{FAILED}{failure}"
    codes = dict.fromkeys(m.code for m in messages if m.code and not m.is_note)
    return f"{DOUBTFUL}{', '.join(codes)}" if codes else OK


def has_failed(status: str) -> bool:
    """Whether a run of this status ended early."""
    return status.startswith(FAILED)


def not_confirmed(status: str) -> str:
    """Return the status of a run that the same run, solved more finely, does not confirm."""
    if status == OK:
        return f"{DOUBTFUL}{NOT_CONFIRMED}"
    return status if has_failed(status) else f"{status}, {NOT_CONFIRMED}"


def on_numbers(messages: Iterable[str], codes: Iterable[str]) -> list[Message]:
    """Return the messages of a run that bear on its numbers; not why it failed."""
    both = zip(messages, codes, strict=True)
    return [Message(message, code) for message, code in both if code and code not in _OF_COST]


def first_of_each(messages: Iterable[Message]) -> list[Message]:
    """Return the messages of several runs, of those that differ in numbers alone the first: of one
    code, about one part."""
    found: dict[tuple[str, str], Message] = {}
    for message in messages:
        found.setdefault((message.code, message.partition(":")[0]), message)
    return list(found.values())


def messages_and_codes(messages: Iterable[Message]) -> dict[str, list[str]]:
    """Return the messages of a run and their codes, as a file or a page gives them."""
    listed = [*messages]
    return {"messages": [str(m) for m in listed], "codes": [m.code for m in listed]}
