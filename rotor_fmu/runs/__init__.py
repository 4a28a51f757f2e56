"""One run: its inputs, the run itself through an FMU or directly, its recording and figures."""

# What `rotor-fmu plot` draws of a run, beside its recording.
PLOTS = (
    "bode", "polar", "orbit", "cascade", "poincare", "contact-angle", "contact-force", "energy",
    "spectrum", "whirl",
)  # fmt: skip
