"""Linear analyses of a machine: modes, Campbell diagram, response to unbalance, deflection, and the
checks of API 617 and 684."""

from .campbell import Campbell, CriticalSpeed, campbell
from .critical_map import CriticalMap, critical_map, mean_stiffness
from .linear_machine import LinearError, LinearMachine
from .linearization import CONTACTS
from .modes import Modes, modes
from .stability_levels import StabilityLevel1, StabilityLevel2, Stage, level_1, level_2
from .static import Static, lowest_speed, needs_to_turn, static
from .unbalance import UnbalanceResponse, unbalance_response
from .unbalance_check import UnbalanceCheck, critical_peaks, unbalance_check
from .unbalance_peaks import response_with_peaks
from .unbalance_placement import placed_unbalances
