"""Warnings about a machine before a run, from its linear analyses."""

from ..model import messages
from ..model.kernels.kernel import interpreted
from ..model.linear.linear_machine import LinearError, shared_machine
from ..model.linear.linearization import OPEN
from ..model.linear.modes import modes
from ..model.machine.rotor import Rotor
from ..model.message_templates import fill_template
from ..model.outcomes import grows_at_rest
from ..model.parts.base import ReleaseElement
from ..model.simulation import HYSTERETIC_AS_SLOWER
from ..model.structure.parameters import least_inertia

# Least Re lambda / |lambda| of what is called growing; share of the machine's lowest frequency
# below which a root is a motion as a rigid body: rounding.
_GROWING, _SLOW = 1e-5, 1e-3


def machine_warnings(rotor: Rotor, is_free: bool = False) -> list[str]:
    """Return warnings about a machine that nothing holds, about one that is unstable at rest, about
    hysteresis, which a run does not know, and, if is_free, one that no torque drives."""
    result = [str(HYSTERETIC_AS_SLOWER)] if rotor.eta_h > 0.0 else []
    machine = shared_machine(rotor)
    is_released = bool(rotor.elements_of_kind(ReleaseElement))
    if machine.static_load.any() and not (machine.is_held or is_released):
        result.append(f"{machine.why_not_held()}, or give a [start] in the air")
    inertia, least = (
        machine.structure.numbers[0].inertia,
        interpreted(least_inertia)(machine.structure),
    )
    if is_free and inertia < least:
        result.append(fill_template(messages.SENTENCES[messages.CODE.NO_INERTIA], (inertia, least)))
    try:
        at_rest = modes(rotor, 0.0, contacts=OPEN)
    except LinearError:
        return result
    roots = [*at_rest.eigenvalues[at_rest.is_sound], *(complex(decay) for decay in at_rest.decays)]
    slow = _SLOW * machine.structure.numbers[0].lowest_omega
    growing = [r for r in roots if abs(r) > slow and r.real > _GROWING * abs(r)]
    if growing:
        result.append(grows_at_rest(max(growing, key=lambda r: r.real / abs(r))))
    return result
