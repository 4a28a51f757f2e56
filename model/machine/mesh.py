"""The nodes of a shaft: those of its sections, and one wherever a part is placed between them."""

from collections.abc import Sequence
from itertools import accumulate, pairwise
from typing import Any

from ..arguments import check_integer
from ..parts.shaft import Section
from ..quantities import QuantityError

# Shares of the shaft's length: positions closer than the first are the same; between the first and
# the second they are refused, because rounding does not allow so short, and so stiff, an element.
_SAME, _NEAR = 1e-9, 1e-4


class Mesh:
    """Sections between nodes, divided where parts are placed.

    sections: the file's; start: position of the first node [m]; places: names of parts with their
    positions [m]. Raises `QuantityError` for a position off the shaft, or too close to a node.
    """

    def __init__(
        self, sections: Sequence[Section], start: float, places: Sequence[tuple[str, float]]
    ) -> None:
        self._given = list(accumulate((s.length for s in sections), initial=start))
        low, high = self._given[0], self._given[-1]
        self._same, near = _SAME * (high - low), _NEAR * (high - low)
        added: list[float] = []
        for where, z in places:
            if not low - self._same <= z <= high + self._same:
                raise QuantityError(
                    f"{where}.z = {z:g} m: must lie on the shaft, from {low:g} to {high:g} m"
                )
            nodes = sorted([*self._given, *added])
            nearest = min(nodes, key=lambda node: abs(node - z))
            if abs(nearest - z) <= self._same:
                continue
            if abs(nearest - z) < near:
                raise QuantityError(
                    f"{where}.z = {z:.9g} m: is {abs(nearest - z):.2g} m from the node at "
                    f"{nearest:.9g} m; must be at it, or at least {near:.2g} m away"
                )
            added.append(z)
        self.sections = tuple(_divided(sections, self._given, sorted(added)))
        self.nodes = tuple(accumulate((s.length for s in self.sections), initial=start))

    def node_at(self, z: float) -> int:
        """Return the number of the node at a position [m], from 1."""
        return 1 + min(range(len(self.nodes)), key=lambda i: abs(self.nodes[i] - z))

    def node(self, where: str, number: Any) -> int:
        """Return the number of a node of the file's sections, from its number there."""
        check_integer(f"{where}.node", number, 1, len(self._given), QuantityError)
        return self.node_at(self._given[number - 1])


def _divided(sections: Sequence[Section], nodes: Sequence[float], added: Sequence[float]) -> Any:
    """Yield the sections, each cut at the positions that lie within it."""
    for section, (left, right) in zip(sections, pairwise(nodes), strict=True):
        cuts = [(z - left) / (right - left) for z in added if left < z < right]
        if not cuts:
            yield section
            continue
        for begin, end in pairwise([0.0, *cuts, 1.0]):
            layers = (layer.part(begin, end) for layer in section.layers)
            yield section.part(begin, end).with_layers(*layers)
