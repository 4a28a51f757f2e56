"""A machine with given unbalances, or with its own and its bows, times a factor."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ..model.linear.places import PlacedAmount, as_place
from ..model.machine.rotor import Rotor
from ..model.parts.base import Part
from ..model.parts.unbalance import Unbalance


def with_unbalances(rotor: Rotor, unbalances: Sequence[PlacedAmount] | None, scale: float) -> Rotor:
    """Return the machine with these unbalances and no bow, or with its own unbalances and bows,
    times a factor: what drives the linear response.

    unbalances: (node from 1 or place, amount [kg.m], angle [rad]).
    """
    if unbalances is None:
        parts = [_times(part, scale) for part in rotor.parts]
        return replace(rotor, parts=tuple(parts))
    bare = [_times(part, 0.0) for part in rotor.parts if not isinstance(part, Unbalance)]
    placed = [
        Unbalance(node, scale * amount, phase, offset)
        for (node, offset), amount, phase in ((as_place(at), a, phi) for at, a, phi in unbalances)
    ]
    return replace(rotor, parts=(*bare, *placed))


def _times(part: Any, scale: float) -> Part:
    """Return a part with its unbalance or bow times a factor."""
    for name in ("e", "amount", "amplitude"):
        if hasattr(part, name):
            part = replace(part, **{name: scale * getattr(part, name)})
    return part
