"""A contact whose friction heats the shaft on one side, so that it bows (Newkirk 1926).

The heat Q [W] of friction enters where the journal touches, at the angle psi - theta from the mark
of the rotor, and that side expands. The bow b [m] (`structure.bow`), complex in the rotor's frame,
follows

    b' = p Q e^(i (psi - theta)) - q b

with p = bow_per_heat and q = bow_decay (Kellenberger 1980, with the heat in the place of the
displacement of his seal ring). The rest is a clearance contact that may stick.
"""

from dataclasses import dataclass, replace
from typing import ClassVar

from ..contact.rubbing import rubbing, rubbing_tangent, stretching
from ..contact.wall import ContactQuantities
from ..kernels.functions import angle, direction, modulus
from ..kernels.jit import jit, jit_not_inlined
from ..quantities import NOT_NEGATIVE, SPEED, Output, places, quantity
from .clearance_contact import OUTPUTS as CONTACT_OUTPUTS
from .clearance_contact import STICKING_CONTACT, ClearanceContact, observe_contact
from .law import Law


@dataclass(frozen=True, kw_only=True)
class BowQuantities:
    """The quantities of a thermal bow: bow per heat, p [m/J], and the rate at which the bow decays
    as the heat spreads, q [1/s]."""

    bow_per_heat: float = quantity(
        "m/J",
        "bow of the shaft per heat of friction, at the contact, from the line through its ends",
        NOT_NEGATIVE,
        is_tunable=True,
    )
    bow_decay: float = quantity(
        "1/s", "rate at which the bow decays as the heat spreads", NOT_NEGATIVE, is_tunable=True
    )


@dataclass(frozen=True, kw_only=True)
class HeatedQuantities(ContactQuantities, BowQuantities):
    """The quantities of a bow, then those of a clearance contact; see
    `touchdown_bearing.TouchdownQuantities`."""


OUTPUTS = (
    *CONTACT_OUTPUTS,
    Output("heat", "W", "heat of friction", nominal=10.0, reached_by=SPEED),
    Output("bow", "m", "bow of the shaft by the heat of this contact, at its node", True, 1e-5),
    Output("bow_angle", "rad", "angle of the bow from the mark of the shaft", True, 1.0),
)
_OUT = places(OUTPUTS)
# the first is that of a contact that sticks, of which all else but the bow is
_STATE = places(("elongation", "bow_x", "bow_y"))


@jit_not_inlined
def _rubbing(part, kinematics, internal_state):
    """Return the `Rubbing` of the contact, and the heat of friction [W]."""
    z = internal_state[_STATE.elongation]
    surface = part.journal_radius * kinematics.sliding_speed
    contact = rubbing(part, kinematics, surface, z)
    spring = part.k_t * z * stretching(part, contact.friction, z)
    return contact, contact.friction * contact.sliding - spring


@jit
def _heating(part, kinematics, heat):
    """Return the rate at which heat [W] bows the shaft [m/s], in the rotor's frame."""
    if heat == 0.0:
        return 0.0j
    d = kinematics.displacement * direction(-kinematics.angle)
    return d * (part.bow_per_heat * heat / modulus(d))


@jit_not_inlined
def _tangent(part, tables, kinematics, weights, free, internal_state):
    surface, b = part.journal_radius * kinematics.sliding_speed, weights.rate
    force, p, q, z = rubbing_tangent(part, kinematics, weights, surface, b, free[_STATE.elongation])
    internal_state[_STATE.elongation] = z
    heating = _heating(part, kinematics, _rubbing(part, kinematics, internal_state)[1])
    factor = 1.0 / (1.0 + b * part.bow_decay)
    internal_state[_STATE.bow_x] = factor * (free[_STATE.bow_x] + b * heating.real)
    internal_state[_STATE.bow_y] = factor * (free[_STATE.bow_y] + b * heating.imag)
    return force, p, q


@jit_not_inlined
def _rates(part, tables, kinematics, internal_state, out):
    contact, heat = _rubbing(part, kinematics, internal_state)
    heating = _heating(part, kinematics, heat)
    out[_STATE.elongation] = stretching(part, contact.friction, internal_state[_STATE.elongation])
    out[_STATE.bow_x] = heating.real - part.bow_decay * internal_state[_STATE.bow_x]
    out[_STATE.bow_y] = heating.imag - part.bow_decay * internal_state[_STATE.bow_y]


@jit_not_inlined
def _observe(part, tables, kinematics, internal_state, out):
    contact, heat = _rubbing(part, kinematics, internal_state)
    observe_contact(kinematics.displacement, contact, out)
    bow = complex(internal_state[_STATE.bow_x], internal_state[_STATE.bow_y])
    out[_OUT.heat] = heat
    out[_OUT.bow] = modulus(bow)
    out[_OUT.bow_angle] = angle(bow)


HEATED_CONTACT = replace(
    STICKING_CONTACT,
    name="heated_contact",
    kind=HeatedQuantities,
    tangent=_tangent,
    observe=_observe,
    outputs=OUTPUTS,
    rates=_rates,
    states=tuple(0.0 for _ in _STATE),
    bow=_STATE.bow_x,
)


@dataclass(frozen=True, kw_only=True)
class HeatedContact(HeatedQuantities, ClearanceContact):
    """A clearance contact whose friction heats and bows the shaft, at a node (from 1) between the
    ends of the shaft; without a bow at the start."""

    KIND: ClassVar[str] = "heated_contact"
    TEXT: ClassVar[str] = "a journal in a clearance whose friction heats and bows the shaft"
    LAWS: ClassVar[tuple[Law, ...]] = (HEATED_CONTACT,)

    @property
    def law(self) -> Law:
        """The law of a contact that heats the shaft."""
        return HEATED_CONTACT
