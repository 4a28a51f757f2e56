"""A rotor that rubs in clearance bearings, as an FMI 2.0 co-simulation component."""

from .about import __version__

__all__ = ["__version__"]
