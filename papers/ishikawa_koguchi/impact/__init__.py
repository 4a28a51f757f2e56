"""Paper B (Ishikawa and Koguchi): which time integrators survive a hard impact.

The same step as the rotor's (`linear_step`, `band`), closed by a hard stop instead of a penalty law
with friction. Not part of the FMU. Data flows one way: `Bars`, `Ratchet` or `RunDown` ->
`Structure` -> `Stepper` -> `march`, by `increments` or `average_time` -> `Run`.
"""
