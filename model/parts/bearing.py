"""Paper A's bearing: a journal in the clearance of a housing of its own."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

from ..contact.wall import ContactQuantities
from .base import Element, InterfaceElement, MountElement, Part, Shape
from .clearance_contact import ClearanceContact, contact_law
from .housing import HousingQuantities
from .law import Law


@dataclass(frozen=True, kw_only=True)
class Bearing(HousingQuantities, ContactQuantities, Part):
    """A journal at a node (from 1) in the clearance of a housing on springs (paper A, Fig. 2)."""

    KIND: ClassVar[str] = "bearing"
    TEXT: ClassVar[str] = "a journal in the clearance of a housing of its own"
    LAWS: ClassVar[tuple[Law, ...]] = ClearanceContact.LAWS

    node: int

    def elements(self, where: str, density: float) -> Iterator[Element]:
        """Yield a housing, and the contact with it."""
        yield InterfaceElement(self.node, contact_law(self), self, where)
        yield MountElement(where, self)

    def outline(self) -> Iterator[Shape]:
        """Yield a housing about the journal."""
        yield Shape(0.0, 0.0, self.journal_radius, self.journal_radius, "housing")
