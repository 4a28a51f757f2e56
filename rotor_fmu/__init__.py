"""A rotor that rubs in clearance bearings, as an FMI 2.0 co-simulation component."""

import os as _os
from pathlib import Path as _Path

from .about import __version__
from .model.kernels.user_cache import keep_in as _keep_in

if _os.environ.get("ROTOR_FMU_CACHE"):
    _keep_in(_Path(_os.environ["ROTOR_FMU_CACHE"]))

__all__ = ["__version__"]
