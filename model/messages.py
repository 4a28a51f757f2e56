"""The messages about a run, each stated once: a code is an index into `SENTENCES`, after those of
the settings (see `message_templates`). `{where}` stands for the machine's own list of contact
states, `{names}` for that of its contacts."""

from collections.abc import Sequence

import numpy as np

from .message_templates import choice
from .quantities import places
from .settings import settings_messages as settings
from .warnings import FINER, RUN_WARNINGS, UNFINISHED

GOOD = settings.GOOD
_WHERE = "t = {.6g} s, speed {.4g} rad/s, step {.3g} s: "
_NO_REST = "no static equilibrium under gravity and the loads at the start"
_WITH_WALL = "give the bearing, unless its ring floats, a contact stiffness k: then"
_LIMIT, _UNIT = choice(("limit.displacement", "limit.force")), choice((" m", " N"))
_DIVERGED = f"{_WHERE}the solution diverged (node {{d}} past {{.3g}} m or not finite); "
_SLIPPING = " in contact and slipping"
_AS_AT_REST = "the contacts as they carry the machine at rest"
_SENSE = choice(
    (
        *("forward whirl", "backward whirl", "planar motion"),
        *("mixed whirl, mainly forward,", "mixed whirl, mainly backward,"),
    )
)
_SEEN = choice(("whirl forward", "whirl backward", "move in a plane"))
_WHIRL = (
    f"with {{where}} a {_SENSE} of {{.4g}} Hz ({{.4g}} rad/s) grows by {{.3g}} 1/s at {{.4g}} rad/s"
)
# What numerical damping does to a growth, by a flag before and after the number: leaves some of it,
# or more than takes it away.
_DOES = f"{choice(('leaves ', 'damps it by '))}{{.3g}}{choice((' 1/s of it', ' 1/s'))}"
_AT_REST = (
    "unstable at rest: with no contact closed but what carries the machine {how}; look at the "
    "damping and the stiffness of its bearings"
)
_SENTENCES = {
    "NOT_SUPPORTED": "no static equilibrium: the rotor is supported at {d} of its nodes and "
    "would tilt; at least 2 bearings or supports are needed",
    "TOO_FAR": f"{_NO_REST}: it would lie beyond {{.3g}} m, a tenth of the shaft's length; "
    "clearances and loads must be smaller, or springs stiffer",
    "NO_REST": f"{_NO_REST} was found",
    "UNFINISHED_AT_REST": f"{_NO_REST} was found in {{d}} iterations (solver.max_iterations); "
    "allow more of them",
    "LOST_IN_ROUNDING": f"{_NO_REST} was found: beside the stiffness of the shaft's elements, "
    "{.2g} N/m, rounding hides that of its supports, {.2g} N/m; reduce young: the "
    "shaft remains effectively rigid",
    "UNSTABLE_REST": f"{_NO_REST} that is stable exists: a journal rests on the ridge of its worn "
    "bore; change wear_angle, or give a [start]",
    "START_BEYOND": "[start]: node {d} lies {.3g} m from the axis; must be within {.3g} m, a tenth "
    "of the shaft's length",
    "START_IN_FILM": "[start]: node {d} lies {.3g} m from the middle of its oil film, of a "
    "clearance of {.3g} m, and the film would be thinner than its roughness; start nearer to the "
    f"middle, or {_WITH_WALL} the surfaces touch",
    "IN_STAGES": "solver.sensitivities, tau_impedance: not available with solver.method = radau5; "
    "take another solver.method",
    "NO_INERTIA": "a torque drives the rotor, whose moment of inertia about its axis is {.2g} "
    "kg.m2: must be at least {.2g} kg.m2, four times U^2/m of its unbalances; a point_mass has "
    "none, a disc and a body have",
    "LIMITED": f"{_LIMIT} = {{.6g}}{_UNIT}: must be above {{.6g}}{_UNIT}, the value at the "
    "static equilibrium under the loads at the start",
    "FILM_AT_REST": f"{_NO_REST}: the oil film at node {{d}} does not carry them at {{.4g}} rad/s: "
    f"{choice(('its load is', 'the load on the machine is'))} {{.4g}} N, and it carries {{.4g}} N "
    "when it is as thin as its roughness; take a larger length, viscosity or speed, or, of a "
    f"damper, stiffness; or {_WITH_WALL} a journal that stands still lies on its wall",
    "FILM_BROKEN": f"{_WHERE}the oil film at node {{d}} is thinner than its roughness; "
    f"{_WITH_WALL} the surfaces touch",
    "NOT_CONVERGED": f"{_WHERE}the contact forces did not converge; try a smaller solver.h, or the "
    "preset robust",
    "DIVERGED": f"{_DIVERGED}try {FINER}; if it diverges at every step length, the "
    "machine itself is unstable under its loads at this speed, or a partner that sets them needs "
    "shorter communication steps",
    "DIVERGED_UNSTABLE": f"{_DIVERGED}the scheme is unstable (spectral radius {{.4g}} > 1): take "
    "alpha_m <= alpha_f <= 0.5",
    "WHIRLED_APART": f"{_WHERE}the run diverged by an instability of the machine (node {{d}} past "
    f"{{.3g}} m or not finite): {_WHIRL}, and it was seen to {_SEEN} at {{.4g}} Hz; a shorter "
    "step does not help: reduce friction or add damping",
    "STOPPED": f"{_WHERE}{UNFINISHED}",
    "PAST_LIMIT": f"t = {{.9g}} s: the next step passes {_LIMIT} = {{.6g}}{_UNIT}, with {{.6g}}"
    f"{_UNIT}",
    "CONTACT_CHANGED": f"t = {{.9g}} s: {{names}} {choice(('closed', 'opened'))}",
    "OSCILLATES_AT_REST": _AT_REST.replace(
        "{how}", "a mode of {.4g} Hz ({.4g} rad/s) grows, its logarithmic decrement being {.3g}"
    ),
    "MOVES_AT_REST": _AT_REST.replace(
        "{how}", "it moves away from its equilibrium by {.3g} 1/s, without oscillating"
    ),
    "HIDES": f"solver steps of {{.3g}} s hide an instability: {_WHIRL}, and the integrator, at "
    f"omega h = {{.2g}}, {_DOES}; take steps of at most {{g}} s, or the preset controlled",
    "UNSTABLE": f"unstable: {_WHIRL}; the machine itself is past its threshold of stability",
    **{warning.since: warning.words for warning in RUN_WARNINGS},
}
SENTENCES = (*settings.SENTENCES, *_SENTENCES.values())
# The machine-readable code of each; empty for a message that ends a run.
_CODES = {
    "OSCILLATES_AT_REST": "unstable-at-rest",
    "MOVES_AT_REST": "unstable-at-rest",
    "HIDES": "hidden-instability",
    "UNSTABLE": "unstable",
    **{warning.since: warning.code for warning in RUN_WARNINGS},
}
CODES = (*settings.CODES, *(_CODES.get(name, "") for name in _SENTENCES))
# The code of each by its name.
CODE = places(_SENTENCES, len(settings.SENTENCES))
FIRST_RUN_WARNING = len(SENTENCES) - len(RUN_WARNINGS)


def closed_at(contacts: Sequence[str], interfaces: np.recarray) -> str:
    """Return the choice of contact states that `{where}` stands for: all contacts open, or that
    there are none, all that slip closed, those closed that carry the machine, or one of them
    closed.

    contacts: names of the interfaces.
    """
    walls = np.flatnonzero(interfaces.slips == 1).tolist()
    together = " and ".join(contacts[j] for j in walls)
    alone = [f"{name}{_SLIPPING}" for name in contacts]
    opened = "all contacts open" if interfaces.has_wall.any() else "no contacts"
    return choice((opened, f"{together}{_SLIPPING}", _AS_AT_REST, *alone))
