"""One file a part. A new kind of part is a file here and the line that imports it."""

from .base import Part
from .base_and_start import Base, Start
from .bearing import Bearing
from .body import Body, PointMass
from .bow import Bow
from .clearance_contact import ClearanceContact
from .disc import Coupling, Disc
from .floating_ring_bearing import FloatingRingBearing
from .heated_contact import HeatedContact
from .housing import Housing
from .journal_bearing import JournalBearing
from .law import Law
from .line import Line
from .linear_bearing import LinearBearing, Seal
from .load import Load
from .port import Port, Sensor
from .rolling_bearing import RollingBearing
from .squeeze_film_damper import SqueezeFilmDamper
from .support import Support
from .touchdown_bearing import TouchdownBearing
from .unbalance import Unbalance

_KINDS = [
    kind
    for kind in list(vars().values())
    if isinstance(kind, type) and issubclass(kind, Part) and kind is not Part
]
# Every kind of part that is imported above, in that order, those of which a machine has one last.
PARTS: tuple[type[Part], ...] = tuple(sorted(_KINDS, key=lambda kind: kind.IS_SINGLE))
# The force laws of these parts, each once; a law's place here is its code in the kernels.
LAWS: tuple[Law, ...] = tuple({law.name: law for part in PARTS for law in part.LAWS}.values())
