"""Periodic answers over speed, for Python and as the command `rotor-fmu response`."""
