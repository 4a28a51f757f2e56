"""Version and date, stamped into what is built: building twice gives the same bytes."""

__version__ = "0.1.0"
RELEASED = "2026-11-21T00:00:00Z"
