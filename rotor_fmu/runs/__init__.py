"""One run: its inputs, the run itself through an FMU or directly, its recording and figures."""

from ..errors import InputError

# What `rotor-fmu plot` draws of a run, beside its recording.
PLOTS = (
    "bode", "polar", "orbit", "cascade", "poincare", "contact-angle", "contact-force", "energy",
    "spectrum", "whirl", "centerline",
)  # fmt: skip
# Kinds of plot that each option changes.
PLOTS_CHANGED = {
    "place": tuple(kind for kind in PLOTS if kind != "energy"),
    "speed": ("orbit", "spectrum"),
    "is_pp": ("bode", "polar", "cascade", "spectrum"),
}


def check_options(kind: str, **options: object) -> None:
    """Raise `InputError` for an option that is given and does not change this kind of plot."""
    for name, value in options.items():
        if value is not None and value is not False and kind not in PLOTS_CHANGED[name]:
            kinds = ", ".join(PLOTS_CHANGED[name])
            raise InputError(f"{name}: changes no plot {kind}, only {kinds}")
