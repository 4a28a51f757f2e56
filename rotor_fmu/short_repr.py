"""A short text of objects that hold arrays."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np


class ShortRepr:
    """A data class whose `repr` gives the shapes of its arrays instead of their numbers."""

    def __repr__(self) -> str:
        parts = (f"{f.name}: {_short(getattr(self, f.name))}" for f in fields(self))  # type: ignore[arg-type]
        return f"{type(self).__name__}({', '.join(parts)})"


def _short(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return " x ".join(map(str, value.shape)) + " numbers"
    if isinstance(value, Mapping):
        return f"{len(value)} by name"
    if isinstance(value, float):
        return f"{value:.6g}"
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
