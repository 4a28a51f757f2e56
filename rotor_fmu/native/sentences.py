"""What the kernels have to say: a code is the place of a sentence in `SENTENCES`.

`{.4g}` and the like stand for the numbers that the kernel tells, in turn; `{d}` for an integer;
`{?this|that}` for the text that a number chooses, from 0; `{where}` for what the machine's table
has in its place.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

from ..model.doubts import DOUBTS, NO_REST, STALLED
from ..model.settings import INDICATORS, METHODS, MODES, NORMS, Settings, without_effect
from ..model.simulation import SMALLER_STEP
from ..model.stability import sentences as whirls

GOOD = 0
# The parameters of the methods, and the settings that must be positive, in the order of the checks.
SHAPES = ("alpha_f", "alpha_m", "rho")
POSITIVE = ("h", "h_min", "h_max", "eps_min", "eps_max", "atol", "rtol", "tolerance")

_WHERE = "t = {.6g} s, speed {.4g} rad/s, step {.3g} s: "
_DIVERGED = f"{_WHERE}the solution diverged (node {{d}} past {{.3g}} m or not finite); "
_LEAVES_NONE = "must be at least -1 and below 1"

# What decides the step length, and whatever a run may have of mode and norm: one sentence for each
# setting that then changes nothing, "" for the others; of a choice one for each of its names.
IDLE_NUMBERS = ("h_min", "h_max", "eps_min", "eps_max", "tolerance", "atol", "rtol")
_CONTEXTS = [{"mode": mode, "norm": norm} for mode in MODES for norm in NORMS]
_FAR = 0.875  # a number that no preset has


def _idle(context: dict[str, str], name: str, value: object) -> str:
    given: dict[str, Any] = {
        "h": _FAR,
        "h_min": _FAR,
        "h_max": _FAR,
        "eps_min": 0.1,
        "eps_max": 0.2,
    } | context
    told = without_effect(Settings(**given), [name])
    if not told:
        return ""
    before, _, why = told[0].partition(": ")
    shown = value if isinstance(value, str) else "{g}"
    return f"solver.{before.partition(' = ')[0]} = {shown}: {why}"


_IDLE = tuple(
    _idle(context, name, value)
    for context in _CONTEXTS
    for name, values in (
        *((name, (0.0,)) for name in IDLE_NUMBERS),
        ("indicator", INDICATORS),
        ("norm", NORMS),
    )
    for value in values
)
IDLE_ROW = len(_IDLE) // len(_CONTEXTS)


def _native(template: str, **texts: str) -> str:
    """A template of the model with its places for numbers as they are here."""
    for name, text in texts.items():
        template = template.replace(f"{{{name}}}", text)
    return re.sub(r"\{\w+:([^{}]*)\}", r"{\1}", template)


def _choice(texts: Sequence[str]) -> str:
    return f"{{?{'|'.join(texts)}}}"


def _either(one: str, other: str, inside: str) -> str:
    """Of two templates about one number that which a flag names, told before and behind it."""
    parts = zip(one.split(inside), other.split(inside), strict=True)
    return inside.join(_choice(pair) for pair in parts)


def closed_at(contacts: Sequence[str], walls: Sequence[int]) -> str:
    """What stands for `{where}`: all contacts open, all that are walls closed, each alone."""
    together = whirls.AND.join(contacts[j] for j in walls)
    alone = [f"{name}{whirls.SLIPPING}" for name in contacts]
    return _choice((whirls.OPEN, f"{together}{whirls.SLIPPING}", *alone))


_WAY = _choice(whirls.WAYS)
_HIDES = _native(whirls.HIDES, way=_WAY, does=_either(*whirls.DOES, "{seen:.3g}"))
_AT_REST = tuple(_native(whirls.AT_REST, how=how) for how in (whirls.OSCILLATES, whirls.MOVES_AWAY))
_APART = _native(whirls.APART, way=_WAY, seen=_WAY)

SENTENCES = (
    "",
    *(
        f"solver.{name} = {{g}}: {method} does not take it; set the method too"
        for method in METHODS
        for name in SHAPES
    ),
    *(f"solver.method = {method}: needs {name} too" for method in METHODS for name in SHAPES),
    *(
        f"solver.{name} = {{g}}: must be > 0 and {'at most 1' if name == 'tolerance' else 'finite'}"
        for name in POSITIVE
    ),
    "solver.h = {g} s: must lie between h_min = {g} s and h_max = {g} s",
    "solver.eps_min = {g}: must be below eps_max = {g}",
    f"solver.alpha_f = {{g}}: {_LEAVES_NONE}",
    f"solver.alpha_m = {{g}}: {_LEAVES_NONE}",
    "solver.alpha_f - alpha_m = {g}: must be above -1 (beta would be 0)",
    "solver.rho = {g}: must be between 0 and 1",
    *(
        f"{method} with alpha_f = {{g}}, alpha_m = {{g}} is unstable: its spectral radius for fast "
        "oscillations is {.4g}, above 1; the run will diverge"
        for method in METHODS
    ),
    *_IDLE,
    *(re.sub(r"\{:([^{}]*)\}", r"{\1}", why.replace("{:.0f}", "{d}")) for why in NO_REST),
    f"{_WHERE}the contact forces did not converge; try a smaller solver.h, or the preset robust",
    f"{_DIVERGED}{SMALLER_STEP}",
    f"{_DIVERGED}the scheme is unstable (spectral radius {{.4g}} > 1): take alpha_m <= alpha_f <= "
    "0.5",
    f"{_WHERE}{_APART}",
    f"{_WHERE}{STALLED}",
    *_AT_REST,
    _HIDES,
    *(doubt.words.replace("{:.4g}", "{.4g}") for doubt in DOUBTS),
)


def _codes(*counts: int) -> tuple[int, ...]:
    """Where groups of so many sentences begin, behind the empty one."""
    begins = [1]
    for count in counts:
        begins.append(begins[-1] + count)
    return tuple(begins)


(
    NOT_TAKEN,
    NEEDED,
    NOT_POSITIVE,
    STEP_OUTSIDE,
    LIMITS_CROSSED,
    BAD_ALPHA_F,
    BAD_ALPHA_M,
    BAD_DIFFERENCE,
    BAD_RHO,
    UNSTABLE,
    IDLE,
    NO_REST_AT,
    NOT_CONVERGED,
    DIVERGED,
    DIVERGED_UNSTABLE,
    WHIRLED_APART,
    TOO_SLOW,
    OSCILLATES_AT_REST,
    MOVES_AT_REST,
    HIDES,
    DOUBTFUL,
    _END,
) = _codes(
    len(METHODS) * len(SHAPES),
    len(METHODS) * len(SHAPES),
    len(POSITIVE),
    *(1,) * 6,
    len(METHODS),
    len(_IDLE),
    len(NO_REST),
    *(1,) * 8,
    len(DOUBTS),
)
assert len(SENTENCES) == _END
