"""The messages about settings: a code is an index into `SENTENCES` (see `message_templates`).

All but `UNSTABLE` begin with the name of a setting, to which an FMU adds a prefix.
"""

from ..message_templates import choice
from .table import BY_NAME, METHODS, MODES, NORMS, SETTINGS, SHAPES, Choice, is_idle

GOOD = 0
(
    NOT_TAKEN,
    NEEDED,
    STEPS_CROSSED,
    STEP_OUTSIDE,
    LIMITS_CROSSED,
    BAD_DIFFERENCE,
    UNCONTROLLED,
    UNSTABLE,
    FITTED_IN_STAGES,
    OUT_OF_RANGE,
) = range(1, 11)
IDLE = OUT_OF_RANGE + len(SETTINGS)

_METHOD, _SHAPE = choice(METHODS), choice(SHAPES)


def _parameter_name(name: str) -> str:
    """Return a setting with its value, as a template."""
    setting = BY_NAME[name]
    if isinstance(setting, Choice):
        return f"{name} = {choice(setting.values)}"
    return f"{name} = {{g}}" + ("" if setting.unit == "1" else f" {setting.unit}")


def _out_of_range(name: str) -> str:
    setting = BY_NAME[name]
    if isinstance(setting, Choice):
        return ""  # an unknown name of a choice is refused before
    return f"{_parameter_name(name)}: {setting.rule.words}"


def _idle(name: str) -> str:
    if not any(is_idle(name, mode, norm) for mode in MODES for norm in NORMS):
        return ""
    norms = choice(("", *(f" with the norm {norm}" for norm in NORMS)))
    return f"{_parameter_name(name)}: has no effect in the mode {choice(MODES)}{norms}"


SENTENCES = (
    "",
    f"{_SHAPE} = {{g}}: not a parameter of {_METHOD}; set solver.method too",
    f"method = {_METHOD}: needs {_SHAPE} too",
    "h_min = {g} s: must be at most h_max = {g} s",
    "h = {g} s: must lie between h_min = {g} s and h_max = {g} s",
    "eps_min = {g}: must be below eps_max = {g}",
    "alpha_f - alpha_m = {g}: must be above -1 (beta would be 0)",
    f"method = {_METHOD}: takes mode = controlled, which chooses its step lengths by a tolerance; "
    f"mode = {choice(MODES)} is not safe with its long steps",
    f"{_METHOD} with alpha_f = {{g}}, alpha_m = {{g}} is unstable: its spectral radius for fast "
    "oscillations is {.4g}, above 1; the run will diverge",
    f"{_parameter_name('fitted')}: has no effect with the method {_METHOD}",
    *(_out_of_range(setting.name) for setting in SETTINGS),
    *(_idle(setting.name) for setting in SETTINGS),
)
_CODES = {UNSTABLE: "unstable-scheme", FITTED_IN_STAGES: "idle-setting"}
# The machine-readable code of each; empty for an error, which prevents a run.
CODES = (
    *(_CODES.get(code, "") for code in range(OUT_OF_RANGE)),
    *("" for _ in SETTINGS),
    *("idle-setting" for _ in SETTINGS),
)
assert len(CODES) == len(SENTENCES) == IDLE + len(SETTINGS)


def prefixed(prefix: str) -> tuple[str, ...]:
    """Return the messages with `prefix` before the settings' names."""
    return tuple(
        text if code in (GOOD, UNSTABLE) or not text else f"{prefix}{text}"
        for code, text in enumerate(SENTENCES)
    )
