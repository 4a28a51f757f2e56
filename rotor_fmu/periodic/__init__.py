"""Periodic motions over speed, for Python and as the command `rotor-fmu response`."""
