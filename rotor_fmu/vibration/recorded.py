"""The rows of a recording that a function of signals takes, checked: what another program recorded,
or was put together by hand, may be anything."""

import numpy as np

from ..errors import InputError, shown_value

_REAL = "iuf"  # kinds of numpy's types
_COMPLEX = "z"  # the argument that may be complex


class TooFewTurns(ValueError):
    """A signal that is too short; the message gives the number of turns it has and needs."""


class TooFewRows(TooFewTurns):
    """A signal that was recorded too coarsely; the message gives its rows per turn."""


def recorded(**signals: object) -> list[np.ndarray]:
    """Return signals, given by their arguments' names, as arrays of one shape, (n,). Those of t are
    times [s], which may stand and must not fall; z may be complex. Raises `InputError`."""
    arrays = {name: _numbers(name, values) for name, values in signals.items()}
    shapes = [array.shape for array in arrays.values()]
    if len(set(shapes)) > 1 or len(shapes[0]) != 1:
        each = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise InputError(f"{each}: must be alike, (n,)")
    if "t" in arrays:
        t = arrays["t"][np.isfinite(arrays["t"])]
        for row in np.flatnonzero(np.diff(t) < 0).tolist():
            raise InputError(f"t = {t[row + 1]} s after {t[row]} s: times must not fall")
    return list(arrays.values())


def finite(**signals: object) -> list[np.ndarray]:
    """Return `recorded` signals without the rows in which one of them is not finite."""
    arrays = recorded(**signals)
    is_known = np.all([np.isfinite(array) for array in arrays], axis=0)
    return [array[is_known] for array in arrays]


def enough(rows: np.ndarray, least: int) -> None:
    """Raise `TooFewRows` where there are fewer rows than a function needs."""
    if len(rows) < least:
        raise TooFewRows(f"the signal has {len(rows)} recorded rows; needed: at least {least}")


def _numbers(name: str, values: object) -> np.ndarray:
    try:
        array = np.asarray(values)
    except ValueError:  # rows of unlike lengths
        array = np.empty(0, object)
    if array.dtype.kind not in (_REAL + "c" if name == _COMPLEX else _REAL):
        raise InputError(f"{shown_value(name, values)}: must be an array of numbers")
    return array if array.dtype.kind == "c" else np.asarray(array, float)
