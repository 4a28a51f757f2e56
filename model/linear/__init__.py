"""Linear analyses of a machine: modes, Campbell diagram, response to unbalance, deflection."""

from .campbell import Campbell, CriticalSpeed, campbell
from .machine import CONTACTS, LinearError, LinearMachine
from .modes import Modes, modes
from .static import Static, static
from .unbalance import UnbalanceResponse, unbalance_response

__all__ = [
    "CONTACTS",
    "Campbell",
    "CriticalSpeed",
    "LinearError",
    "LinearMachine",
    "Modes",
    "Static",
    "UnbalanceResponse",
    "campbell",
    "modes",
    "static",
    "unbalance_response",
]
