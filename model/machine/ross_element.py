"""An element of a rotor that ROSS saved: one table of the file, with its values checked."""

import math
import re
from typing import Any, NamedTuple

from ..quantities import QuantityError
from .table_reader import nearest, number

# Entries that draw, name or repeat something, those of the classes beside the coefficients, and of
# old solvers.
_IDLE = ("tag", "color", "scale_factor", "interpolation", "sparse", "n_eigen")
# What ROSS writes into a TOML file for a number that NumPy made: the number, and what makes it no
# integer.
_OF_NUMPY = re.compile(r"np\.(?:float|u?int)\d+\((-?\d{1,19}((?:\.\d+)?(?:e[-+]?\d+)?))\)")


def _plain(value: Any) -> Any:
    """Return a number that NumPy made as a number, anything else as it is."""
    made = _OF_NUMPY.fullmatch(value) if isinstance(value, str) else None
    return (float(made[1]) if made[2] else int(made[1])) if made else value


class Element(NamedTuple):
    """One table of the file: its key, its class, its values."""

    where: str
    kind: str
    values: dict[str, Any]

    def given(self, key: str, default: float | None = None) -> Any:
        """Return what must be given, unless it has a default."""
        value = self.values.get(key)
        value = default if value is None else _plain(value)
        if value is None:
            raise QuantityError(f"{self.where}.{key} is missing")
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """Return a finite number."""
        value = number(self.given(key, default))
        if not isinstance(value, float):
            raise QuantityError(f"{self.where}.{key} = {value!r}: must be a number")
        if not math.isfinite(value):
            raise QuantityError(f"{self.where}.{key} = {value}: must be finite")
        return value

    def node(self, key: str = "n") -> int:
        """Return a node, from 0."""
        value = self.given(key)
        if isinstance(value, bool) or not isinstance(value, int) or value < 0:
            raise QuantityError(f"{self.where}.{key} = {value!r}: must be an integer from 0")
        return value

    def has(self, key: str) -> bool:
        """Return whether a coefficient is given."""
        return self.values.get(key) not in (None, [])

    def column(self, key: str) -> float | list[float]:
        """Return a coefficient: a number, or a list over the speed."""
        if not self.has(key):
            return 0.0
        value = self.values[key]
        if not isinstance(value, list):
            return self.number(key, 0.0)
        if any(isinstance(item, list) for item in value):
            raise QuantityError(
                f"{self.where}.{key}: a table over the speed and the whirl frequency has no "
                "meaning in time; save it over the speed alone"
            )
        cells = [self._replace(values={key: item}).number(key) for item in value]
        return cells[0] if len(set(cells)) == 1 else cells

    def refuse_nonzero(self, *keys: str) -> None:
        """Raise `QuantityError` for a key with another value than 0."""
        for key in keys:
            if (value := self.column(key)) != 0:
                raise QuantityError(f"{self.where}.{key} = {value}: must be 0; it is not supported")

    def refuse_others(self, *known: str) -> None:
        """Raise `QuantityError` for an unknown key with a value."""
        for key, value in self.values.items():
            if value is not None and key not in (*known, *_IDLE):
                hint = nearest(key, known)
                raise QuantityError(f"{self.where}.{key}: unknown key, {hint}not carried over")
