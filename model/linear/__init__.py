"""Linear analyses of a machine: modes, Campbell diagram, response to unbalance, deflection."""

from .campbell import Campbell, CriticalSpeed, campbell
from .journal import BearingCurves, bearing_curves
from .machine import CONTACTS, LinearError, LinearMachine
from .modes import Modes, modes
from .static import Static, static
from .unbalance import UnbalanceResponse, unbalance_response

__all__ = [
    "CONTACTS",
    "BearingCurves",
    "Campbell",
    "CriticalSpeed",
    "LinearError",
    "LinearMachine",
    "Modes",
    "Static",
    "UnbalanceResponse",
    "bearing_curves",
    "campbell",
    "modes",
    "static",
    "unbalance_response",
]
