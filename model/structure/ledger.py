"""The entries of the energy ledger: stores [J], inflows and dissipation [W].

The machine's own come first, then those of the laws. Kernels sum the entries of all laws in this
order; a machine has those of its laws, in the same order.
"""

from collections.abc import Sequence

from ..machine.rotor import Rotor
from ..parts import LAWS
from ..parts.base import InterfaceElement
from ..quantities import SPEED, Output


def _each_once(entries: Sequence[Output]) -> tuple[Output, ...]:
    """Return the entries in their order without repeated names."""
    by_name: dict[str, Output] = {}
    for entry in entries:
        by_name.setdefault(entry.name, entry)
    return tuple(by_name.values())


MACHINE_STORES = (
    Output(
        "kinetic",
        "J",
        "kinetic energy, including that of rotation",
        nominal=100.0,
        reached_by=SPEED,
    ),
    Output("elastic", "J", "elastic energy of shaft and housing springs", nominal=0.01),
    Output("gravity", "J", "potential energy of gravity and constant forces", nominal=0.01),
)
# a jump of the speed is work
INFLOWS = (
    Output("drive", "J", "work of the drive since the start", nominal=100.0, reached_by=SPEED),
    Output("external", "J", "work of the external forces since the start", nominal=1.0),
)
MACHINE_LOSSES = (
    Output(
        "structure",
        "J",
        "dissipated in shaft and supports, and carried off by lines, since the start",
        nominal=1.0,
    ),
    Output("housing", "J", "dissipated in the housings' dampers", nominal=1.0),
)
MACHINE_FLOWS = (*INFLOWS, *MACHINE_LOSSES)
# a law cannot know it: it takes the motion of the whole shaft
BOW = Output(
    "bow",
    "J",
    "work that the bowed shaft does against the heat that bows it; negative where the heat does it",
    nominal=1e-6,
)
LAW_STORES = _each_once([store for law in LAWS for store in law.stores])
LAW_LOSSES = _each_once([*(loss for law in LAWS for loss in law.losses), BOW])
STORES = tuple(entry.name for entry in (*MACHINE_STORES, *LAW_STORES))
FLOWS = tuple(entry.name for entry in (*MACHINE_FLOWS, *LAW_LOSSES))


def law_entries(rotor: Rotor) -> tuple[list[int], list[int]]:
    """Return the indices in `LAW_STORES` and `LAW_LOSSES` of the entries that a machine's laws
    have."""
    laws = [interface.law for _, interface in rotor.elements_of_kind(InterfaceElement)]
    stores = {store.name for law in laws for store in law.stores}
    losses = {loss.name for law in laws for loss in law.losses}
    losses |= {BOW.name for law in laws if law.bow is not None}
    return (
        [i for i, store in enumerate(LAW_STORES) if store.name in stores],
        [i for i, loss in enumerate(LAW_LOSSES) if loss.name in losses],
    )
