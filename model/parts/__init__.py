"""One file a part. A new kind of part is a file here and its name in `PARTS`."""

from ..protocol.law import Law
from ..protocol.part import Part
from .bearing import Bearing
from .clearance_contact import ClearanceContact
from .disc import Coupling, Disc
from .housing import Housing
from .port import Port
from .support import Support
from .unbalance import Unbalance

PARTS: tuple[type[Part], ...] = (
    Bearing,
    Disc,
    Coupling,
    Support,
    Housing,
    ClearanceContact,
    Unbalance,
    Port,
)

# The force laws of these parts, each once; a law's place here is its code in the kernels.
LAWS: tuple[Law, ...] = tuple({part.LAW.name: part.LAW for part in PARTS if part.LAW}.values())
