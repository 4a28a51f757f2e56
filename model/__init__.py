"""Physics and numerics of a flexible rotor that rubs in clearance bearings.

Knows no FMI, no files and no screen. Data flows one way:
TOML text -> `Rotor` -> `Structure` -> `Simulation`.
"""
