"""Runs through a built FMU: signals, run-down, its figures, reproduction, reports."""

# What `rotor-fmu plot` draws of a run, beside its recording.
PLOTS = (
    "bode", "polar", "orbit", "cascade", "poincare", "contact-angle", "contact-force", "energy",
    "spectrum", "whirl",
)  # fmt: skip
