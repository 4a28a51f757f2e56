"""Physics and numerics of a flexible rotor that rubs in clearance bearings.

Knows no FMI, no screen and no files except machine files. Data flows one way:
TOML text -> `Rotor` -> `Structure` -> `Simulation`.
"""
