"""One run: its inputs, the run itself through an FMU or directly, its recording and figures."""

# What `rotor-fmu plot` draws of a run, beside its recording.
PLOTS = (
    "bode", "polar", "orbit", "cascade", "poincare", "contact-angle", "contact-force", "energy",
    "spectrum", "whirl",
)  # fmt: skip
# Kinds of plot that each option changes.
PLOTS_CHANGED = {
    "place": tuple(kind for kind in PLOTS if kind != "energy"),
    "speed": ("orbit", "spectrum"),
    "pp": ("bode", "polar", "cascade", "spectrum"),
}
