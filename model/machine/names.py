"""Names of a machine's parts and quantities."""

import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from ..parts.base import Part
from ..quantities import QuantityError

IDENTIFIER = re.compile(r"([A-Za-z_][A-Za-z0-9_]{0,63})?")  # in C, or nothing
# What no part may be called: headings of other names, and names that stand for themselves.
_RESERVED = (
    *("shaft", "solver", "energy"),
    *("time", "speed", "speed_rate", "speed_continuation", "tau_drive", "w_start", "gravity"),
    *("phi", "w", "a", "tau", "tau_load", "J", "tau_wave", "tau_impedance", "step_work", "limit"),
    *("dphi_ddrive", "dw_ddrive", "dtau_ddrive", "dtau_load_ddrive"),
)


class Name(NamedTuple):
    """The name of a machine's quantity: the kind of part, its number from 1 (0 if a machine has
    only one), the quantity. It is formatted for output and never parsed."""

    kind: str
    number: int
    quantity: str

    def __str__(self) -> str:
        if not self.kind:
            return self.quantity
        return f"{spelled(self.kind, self.number)}.{self.quantity}"


def spelled(kind: str, index: int) -> str:
    """Return a part's name: `bearing[1]`, `coupling`."""
    return f"{kind}[{index}]" if index else kind


def check_names(parts: Sequence[Part]) -> None:
    """Raise `QuantityError` for a name that no part may have, or that two have."""
    kinds = {part.KIND for part in parts}
    counts: Counter[str] = Counter()
    seen: dict[str, str] = {}
    for part in parts:
        label = part.label
        counts[part.KIND] += 1
        if not label:
            continue
        where = spelled(part.KIND, counts[part.KIND])
        if not isinstance(label, str) or not IDENTIFIER.fullmatch(label):
            raise QuantityError(
                f"{where}.name = {label!r}: must be a word of letters a to z, digits and _ that "
                "does not begin with a digit, of up to 64"
            )
        if label in _RESERVED or label in kinds:
            of = "a part type" if label in kinds else "variables"
            raise QuantityError(f"{where}.name = {label}: is reserved, as the name of {of}")
        if label in seen:
            raise QuantityError(f"{where}.name = {label}: {seen[label]} has this name already")
        seen[label] = where
