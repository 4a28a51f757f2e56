"""What linear answers take for granted: the ends of tables, that films are laminar, that something
holds the machine, where oil films are linearized, how tilting pads follow, that the machine is
stable, that contacts are open, and that journals and rings move little in their films."""

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from ..display import current, speed_with_unit
from ..model.laws_at_rest.oil import machine_with_oil
from ..model.linear.amplification import CRITICALLY_DAMPED
from ..model.linear.linear_machine import LinearError, shared_machine
from ..model.linear.linearization import OPEN
from ..model.linear.modes import LEAST_GROWTH, modes, modes_up_to
from ..model.linear.orbit import semi_axes
from ..model.linear.places import PlacedAmount
from ..model.linear.static import static
from ..model.linear.subsynchronous import subsynchronous_whirl
from ..model.linear.supports import walls
from ..model.linear.unbalance import UnbalanceResponse
from ..model.linear.unbalance_peaks import gaps
from ..model.machine.rotor import Rotor
from ..model.machine.speed_ranges import speed_ranges
from ..model.message_templates import Message
from ..model.parts.base import GROUND, BowElement, InterfaceElement
from ..model.parts.law import never_breaks

# Of either sign, a damping ratio beyond which a motion grows or decays before it has turned.
_WHIRLS = 0.5**0.5
_SMALL = 0.5  # of a film's clearance: in a larger motion its coefficients are others


def which_bows_act(machine: Rotor, unbalances: Sequence[PlacedAmount] | None) -> list[str]:
    """Return a sentence about the residual bows of a machine, if it has any, in its steady response
    to its own unbalances, or to others."""
    if unbalances is None:
        return _of_bows(machine, "turn with the shaft, and the response has theirs")
    return _of_bows(machine, "are left out beside unbalances given instead")


def where_straight(machine: Rotor) -> list[str]:
    """Return a sentence for a machine whose residual bows its deflection at rest leaves out."""
    return _of_bows(machine, "turn with the shaft, and are left out at rest")


def _of_bows(machine: Rotor, what: str) -> list[str]:
    bows = (name for name, bow in machine.elements_of_kind(BowElement) if bow.amplitude)
    names = ", ".join(bows)
    return [f"residual bows {what}: {names}"] if names else []


def where_linearized(
    machine: Rotor,
    speeds: Collection[float],
    contacts: str | None = None,
    *,
    coupling: Mapping[int, float] | None = None,
    follows_force: bool = False,
) -> list[str]:
    """Return a sentence for each range outside of which some of these speeds [rad/s] lie, for a
    machine that nothing holds under its weight, and for oil films; contacts: `open` or `pinned`;
    coupling: further cross-coupled stiffness [N/m] by node (from 1); follows_force: whether what
    follows a vibration has the frequency of a force."""
    result: list[str] = [*where_beyond_ranges(machine, speeds)]
    linear = shared_machine(machine)
    if linear.static_load.any() and not linear.is_held:
        where = "linearized in the middle of all clearances, as if it had no weight"
        result.append(f"{linear.why_not_held()}; {where}")
    # a damper's film is where its spring or cage holds the ring
    films = (name for name, film in _films(machine).items() if film.law.stiffness is None)
    if names := ", ".join(films):
        where = "where its journal rests at that speed"
        if not any(speeds) and not linear.holds_at(0.0):
            where = "in the middle of its clearance, since at standstill it carries nothing"
        result.append(f"oil films, each linearized {where}: {names}")
    result += where_it_lies_in_contacts(machine, max(speeds, key=abs), contacts)
    if follows_force:
        return result
    if linear.laws.follows.any():
        pads = np.array(linear.supports.interfaces)[linear.laws.follows]
        result.append(
            "their pads that tilt follow a vibration at the frequency of rotation; slower whirls "
            f"have another damping, which a run shows: {', '.join(pads)}"
        )
    fastest = max(speeds, key=abs)
    whirl = subsynchronous_whirl(machine, fastest, contacts, tuple((coupling or {}).items()))
    if whirl and not whirl.is_critically_damped:
        here = "all are critically damped"
        if whirl.synchronous < CRITICALLY_DAMPED:
            here = f"it is {whirl.synchronous:.3g}"
        result.append(
            f"at {speed_with_unit(fastest)} the least log dec of slower whirls is "
            f"{whirl.log_dec:.3g}, of {speed_with_unit(whirl.frequency)}, where pads follow each "
            f"at its own frequency; here {here}"
        )
    return result


def where_it_lies_in_contacts(
    machine: Rotor, speed: float, contacts: str | None = None
) -> list[str]:
    """Return a sentence for the clearances that gravity and loads close at a speed [rad/s] where
    all are taken as open."""
    if shut := closed_at_rest(machine, speed, contacts):
        closed = f"the shaft at rest lies in contacts that are taken as open: {', '.join(shut)}"
        return [f"{closed}; a run begins on them, as does `rotor-fmu response`"]
    return []


def where_it_is_not_balanced(machine: Rotor, speed: float) -> list[str]:
    """Return a sentence for the clearances that gravity and loads close at a balancing speed
    [rad/s]."""
    if shut := closed_at_rest(machine, speed):
        closed = f"the shaft at rest lies in contacts: {', '.join(shut)}"
        return [f"{closed}; influence coefficients are those of a machine that does not rub"]
    return []


def closed_at_rest(machine: Rotor, speed: float, contacts: str | None = None) -> list[str]:
    """Return the clearances that gravity and loads close at a speed [rad/s] where all are taken as
    open, each in words with its sag."""
    linear, parts = shared_machine(machine, contacts), walls(machine)
    if linear.contacts != OPEN or not parts:
        return []
    try:
        lying = static(machine, speed, contacts=contacts)
    except LinearError:
        return []
    of_nodes, of_housings = lying.x + 1j * lying.y, lying.housing_x + 1j * lying.housing_y
    at, d, shut = np.concatenate([np.repeat(of_nodes, 2), of_housings, [0.0]]), current(), []
    for gap in gaps(linear, parts):
        sag, clearance = abs(at[gap.dof] - at[gap.end]), gap.clearance
        if sag > clearance + getattr(parts[gap.name].source, "wear", 0.0):
            sizes = (f"{d.small * size:.5g} {d.small_word}" for size in (sag, clearance))
            shut.append(f"{gap.name} with a sag of {' in a clearance of '.join(sizes)}")
    return shut


def where_beyond_ranges(machine: Rotor, speeds: Collection[float]) -> list[Message]:
    """Return a message for each end of a range, of a table or of a laminar film, beyond which some
    speeds [rad/s] lie, on the furthest one, by their size where it is for either sense."""
    result: list[Message] = []
    for allowed in speed_ranges(machine_with_oil(machine)):
        over = [abs(speed) if allowed.is_of_size else speed for speed in speeds]
        below = (speed for speed in over if speed < allowed.low)
        above = (speed for speed in over if speed > allowed.high)
        ends = min(below, default=None), max(above, default=None)
        result += [allowed.message(end) for end in ends if end is not None]
    return result


def where_not_reached(
    machine: Rotor, speeds: Collection[float], contacts: str | None = None
) -> list[str]:
    """Return a sentence for each of some speeds [rad/s] at which the machine is unstable, so that
    it does not come to its steady response there."""
    result = []
    for speed in speeds:
        why = "`rotor-fmu campbell` has the threshold"
        linear = shared_machine(machine, contacts)
        found = modes_up_to(linear, linear.at(speed), abs(speed))
        if found.growth <= LEAST_GROWTH:
            whirl = subsynchronous_whirl(machine, speed, contacts, ())
            if not (whirl and whirl.is_growing):
                continue
            why = f"a whirl of {speed_with_unit(whirl.frequency)} grows, which its pads follow"
        where = f"unstable at {speed_with_unit(speed)}, where its steady response is not reached"
        result.append(f"{where}; {why}")
    return result


def where_films_are_left(machine: Rotor, response: UnbalanceResponse) -> list[str]:
    """Return a sentence for oil films in which a steady response is no small motion."""
    at_housing = dict(zip(response.housings, range(len(response.housings)), strict=True))
    taken = []
    for name, film in _films(machine).items():
        x, y = response.x[:, film.node - 1], response.y[:, film.node - 1]
        if film.ring != GROUND:
            x, y = (of[:, at_housing[film.ring]] for of in (response.housing_x, response.housing_y))
        if film.housing != GROUND:
            x = x - response.housing_x[:, at_housing[film.housing]]
            y = y - response.housing_y[:, at_housing[film.housing]]
        clearances = (getattr(film.source, of, 0.0) for of in ("clearance", "outer_clearance"))
        share = semi_axes(x, y)[0] / sum(clearances)
        if share.max() > _SMALL:
            at = speed_with_unit(float(response.speeds[np.argmax(share)]))
            taken.append(f"{name} {100 * share.max():.3g} % at {at}")
    if not taken:
        return []
    return [
        f"the response takes more than half of the clearance of oil films: {', '.join(taken)}; "
        "they are linearized, for small motions: a run has the real one"
    ]


def _films(machine: Rotor) -> dict[str, InterfaceElement]:
    """Return the interfaces of oil films by the parts' names: the laws of films alone may break."""
    elements = machine.elements_of_kind(InterfaceElement)
    return {name: e for name, e in elements if e.law.breaks is not never_breaks}


def where_not_at_rest(machine: Rotor, speed: float, contacts: str | None = None) -> list[str]:
    """Return a sentence for a machine whose equilibrium at a speed [rad/s] it leaves, as on a
    negative stiffness, which gyroscopic moments turn a little; one that whirls about its
    equilibrium has it still."""
    found = modes(machine, speed, contacts=contacts)
    if not (len(found.growing) or (found.damping_ratio < -_WHIRLS).any()):
        return []
    how = "without oscillating" if len(found.growing) else "hardly oscillating"
    where = f"its equilibrium at {speed_with_unit(speed)} is unstable"
    return [f"{where}: it moves away from there {how}"]
