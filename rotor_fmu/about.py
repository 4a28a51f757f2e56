"""Version and date for everything that is built: building twice gives the same bytes."""

__version__ = "0.1.0"
RELEASED = "2026-11-21T00:00:00Z"
