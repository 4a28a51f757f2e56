"""The outcome of a run, as the code of a message (`messages`) and its numbers."""

import math

import numpy as np

from . import messages
from .film_capacity import film_capacity, film_load, is_supported
from .kernels.functions import modulus
from .kernels.jit import jit
from .kernels.kernel import interpreted
from .message_templates import MOST_ARGUMENTS, fill_template
from .settings.resolver import radius_at_infinity
from .stability.matrices import OPEN, REST, is_seat
from .stability.resolution import is_stable, resolving_step, seen_growth
from .stability.sense import BACKWARD, FORWARD, PLANAR, as_a_whole
from .stability.survey_block import WHIRL
from .stability.whirls import HIDDEN, RESOLVED, rounded_down
from .step.laws import first_invalid_law, relative
from .step.step_status import ENDED_EARLY, FILM_INVALID, NOT_CONVERGED, UNFINISHED
from .structure.parameters import least_inertia
from .time_loop import early_return, equilibrium
from .time_loop.control import keeps_tolerance, varies
from .time_loop.energy import FLOW, STORE, total_energy
from .time_loop.memory import spin_now

_TWO_PI = 2 * math.pi
_ROUNDING = 1e-9  # share of a root: a smaller imaginary part is rounding
_TWO_DIGITS = 10.0
_SLENDER = 0.1  # ratio of an orbit's axes below which a motion is said to be in a plane
_LOST = 1e-9  # share of the shaft's stiffness: rounding may hide a softer support


@jit
def no_rest(run, status, arguments):
    """Return the message that states why a start has no equilibrium."""
    structure, numbers = run.structure, run.structure.numbers[0]
    if status == equilibrium.OUT_OF_BOUNDS:
        invalid = first_invalid_law(structure, run.motion.q, run.motion.internal_state)
        if not equilibrium.is_out_of_bounds(structure, run.motion) and invalid >= 0:
            interface = structure.interfaces[invalid]
            arguments[0] = _node_of(structure, interface.dof)
            arguments[1] = modulus(relative(interface, run.motion.q))
            arguments[2] = interface.length
            return messages.CODE.START_IN_FILM
        farthest = _farthest(run)
        arguments[0] = structure.deflections[farthest, 1]
        arguments[1] = modulus(run.motion.q[structure.deflections[farthest, 0]])
        arguments[2] = numbers.bound
        return messages.CODE.START_BEYOND
    if status == early_return.IN_STAGES:
        return messages.CODE.IN_STAGES
    if status == early_return.NO_INERTIA:
        arguments[0], arguments[1] = numbers.inertia, least_inertia(structure)
        return messages.CODE.NO_INERTIA
    if status == early_return.LIMITED:
        r = run.memory.record[0]
        is_force = r.failed_at == early_return.PAST_FORCE
        arguments[0] = arguments[2] = arguments[4] = 1.0 if is_force else 0.0
        arguments[1] = r.limit_force if is_force else r.limit_displacement
        arguments[3] = r.failed_value
        return messages.CODE.LIMITED
    arguments[0] = _supported_nodes(structure)
    if arguments[0] < 2.0:
        return messages.CODE.NOT_SUPPORTED
    if status == equilibrium.UNFINISHED_AT_REST:
        arguments[0] = run.memory.record[0].max_iterations
        return messages.CODE.UNFINISHED_AT_REST
    invalid = first_invalid_law(structure, run.trial.q, run.trial.internal_state)
    if invalid >= 0:
        load, is_its_own = film_load(run, invalid)
        arguments[0] = _node_of(structure, structure.interfaces[invalid].dof)
        arguments[1] = run.memory.record[0].omega
        arguments[2], arguments[3] = 0.0 if is_its_own else 1.0, load
        arguments[4] = film_capacity(run, invalid)
        return messages.CODE.FILM_AT_REST
    if status == equilibrium.UNSTABLE:
        return messages.CODE.UNSTABLE_REST
    stiffest, mass = 0.0, 0.0
    for i in range(len(structure.deflections)):
        dof = structure.deflections[i, 0]
        stiffest = max(stiffest, structure.K_shaft[dof, 0])
        mass += structure.mass_sum[dof]
    arguments[0], arguments[1] = stiffest, mass * numbers.lowest_omega * numbers.lowest_omega
    if _LOST * stiffest > arguments[1]:
        return messages.CODE.LOST_IN_ROUNDING
    arguments[0] = numbers.bound
    return messages.CODE.TOO_FAR if status == equilibrium.NOT_SUPPORTED else messages.CODE.NO_REST


@jit
def _node_of_invalid_film(run):
    """Return the node (from 1) of a law that is invalid where the last step led, or 0."""
    structure = run.structure
    j = first_invalid_law(structure, run.trial.q, run.trial.internal_state)
    return _node_of(structure, structure.interfaces[j].dof) if j >= 0 else 0


@jit
def _node_of(structure, dof):
    """Return the node (from 1) of a deflection, or that a housing supports, by its dof."""
    for j in range(len(structure.interfaces)):
        if structure.interfaces[j].end == dof:
            dof = structure.interfaces[j].dof
    for i in range(len(structure.deflections)):
        if structure.deflections[i, 0] == dof:
            return structure.deflections[i, 1]
    return 0


@jit
def _supported_nodes(structure):
    """Return the number of nodes with a spring or an interface."""
    supported = 0
    for dof in range(structure.M.shape[0]):
        supported += 1 if is_supported(structure, dof) else 0
    return supported


@jit
def growth_at_rest(root, arguments):
    """Return the message about a motion that grows from rest by this root [1/s], whose imaginary
    part is >= 0; NaN: there is none."""
    if root != root:
        return messages.GOOD
    if root.imag > _ROUNDING * modulus(root):
        arguments[0], arguments[1] = root.imag / _TWO_PI, root.imag
        arguments[2] = -_TWO_PI * root.real / root.imag
        return messages.CODE.OSCILLATES_AT_REST
    arguments[0] = root.real
    return messages.CODE.MOVES_AT_REST


def grows_at_rest(root: complex) -> str:
    """Return the message about a motion that grows from rest, as a text; root [1/s]: with an
    imaginary part >= 0."""
    arguments = np.zeros(MOST_ARGUMENTS)
    code = interpreted(growth_at_rest)(root, arguments)
    return fill_template(messages.SENTENCES[code], arguments)


@jit
def _describe_whirl(whirl, arguments, at):
    """Write the six numbers of a row of `survey.whirls` into the arguments, from `at` on."""
    case, omega = whirl[WHIRL.case], whirl[WHIRL.omega]
    arguments[at] = -1.0 - case if case < 0.0 else case + 3.0
    arguments[at + 1] = whirl[WHIRL.sense]
    arguments[at + 2], arguments[at + 3] = omega / _TWO_PI, omega
    arguments[at + 4], arguments[at + 5] = whirl[WHIRL.growth], whirl[WHIRL.speed]


@jit
def unstable(run, arguments):
    """Return the message about the whirl of the machine itself, its contacts open or, unless it has
    been lifted off them, as they carry it, that grows fastest at the present speed, if a survey
    found one."""
    survey, lies = run.survey, False
    for j in range(len(run.memory.seats)):
        lies = lies or (is_seat(run.memory.seats, j) and run.motion.force[j] != 0.0)
    for i in range(survey.counted[0]):
        whirl = survey.whirls[i]
        is_present = whirl[WHIRL.speed] == run.memory.record[0].surveyed_at
        is_its_own = whirl[WHIRL.case] == OPEN or (lies and whirl[WHIRL.case] == REST)
        if is_its_own and is_present:
            _describe_whirl(whirl, arguments, 0)
            return messages.CODE.UNSTABLE
    return messages.GOOD


@jit
def hidden(run, arguments):
    """Return the message about growing whirls that a survey found and that the solver's steps hide:
    the one that grows fastest, and the longest step that resolves them all."""
    survey, numbers = run.survey, run.method.numbers[0]
    if keeps_tolerance(numbers.mode) or not is_stable(numbers):
        return messages.GOOD
    h = run.memory.record[0].h if not varies(numbers.mode) else numbers.h_max
    longest = math.inf
    for i in range(survey.counted[0]):
        whirl = survey.whirls[i]
        root = complex(whirl[WHIRL.growth], whirl[WHIRL.omega])
        seen = seen_growth(numbers, h, root)
        if not seen < HIDDEN * root.real:
            continue
        if longest == math.inf:
            arguments[0] = h
            _describe_whirl(whirl, arguments, 1)
            arguments[7] = modulus(root) * h
            arguments[8] = arguments[10] = 1.0 if seen < 0.0 else 0.0
            arguments[9] = abs(seen)
        longest = min(longest, resolving_step(numbers, root, RESOLVED))
    if longest == math.inf:
        return messages.GOOD
    arguments[11] = rounded_down(longest, _TWO_DIGITS)
    return messages.CODE.HIDES


@jit
def _farthest(run):
    """Return the index of the deflection farthest from the axis, or the first not finite."""
    deflections = run.structure.deflections
    place, farthest = 0, -1.0
    for i in range(len(deflections)):
        q = run.motion.q[deflections[i, 0]]
        square = q.real * q.real + q.imag * q.imag
        distance = square if math.isfinite(square) else math.inf
        if distance > farthest:
            place, farthest = i, distance
    return place


@jit
def _is_driven_by_loads(run):
    """Return whether the external loads supplied all of the energy that bends the machine, as those
    of a partner do whose answer comes late: then no whirl did."""
    total_energy(run.structure, spin_now(run.memory.record), run.motion, run.work.stores)
    return run.memory.work[FLOW.external] > run.work.stores[STORE.elastic]


@jit
def _whirled_apart(run, arguments):
    """Return whether there are growing whirls; if so, write the one that is most like the motion
    reached into the arguments from 5 on: of the same sense, if there is one, and the nearest in
    frequency. A motion in a plane does not go round: its frequency is that of its acceleration."""
    survey, motion, speed = run.survey, run.motion, run.memory.record[0].omega
    dof = run.structure.deflections[_farthest(run), 0]
    q, v = motion.q[dof], motion.v[dof]
    square = q.real * q.real + q.imag * q.imag
    rate = (q.conjugate() * v).imag / square
    swing = math.sqrt(max(0.0, -(q.conjugate() * motion.v_dot[dof]).real / square))
    sense = BACKWARD if (rate < 0.0) == (speed >= 0.0) else FORWARD
    seen = abs(rate)
    if seen < _SLENDER * swing:
        sense, seen = PLANAR, swing
    is_any = True
    for i in range(survey.counted[0]):
        is_any = is_any and as_a_whole(survey.whirls[i, WHIRL.sense]) != sense
    nearest = math.inf
    for i in range(survey.counted[0]):
        whirl = survey.whirls[i]
        ratio = whirl[WHIRL.omega] / max(seen, 1e-9)
        ratio = max(ratio, 1.0 / ratio)
        is_alike = is_any or as_a_whole(whirl[WHIRL.sense]) == sense
        if is_alike and (nearest == math.inf or ratio < nearest):
            nearest = ratio
            _describe_whirl(whirl, arguments, 5)
    arguments[11] = sense
    arguments[12] = seen / _TWO_PI
    return survey.counted[0] > 0


@jit
def failure(run, status, arguments):
    """Return the message that states why an `advance` ended early; if it diverged, the whirls must
    have been surveyed anew."""
    r = run.memory.record[0]
    arguments[0], arguments[1], arguments[2] = r.failed_at, r.omega, r.failed_h
    if status == NOT_CONVERGED:
        return messages.CODE.NOT_CONVERGED
    if status == FILM_INVALID:
        arguments[3] = _node_of_invalid_film(run)
        return messages.CODE.FILM_BROKEN
    if status == UNFINISHED:
        arguments[3] = r.max_iterations
        return messages.CODE.STOPPED
    ended = status - ENDED_EARLY
    if ended > early_return.GOES_ON:
        arguments[1] = r.failed_value
        if ended < early_return.CLOSED:
            is_force = ended == early_return.PAST_FORCE
            arguments[1] = arguments[3] = arguments[5] = 1.0 if is_force else 0.0
            arguments[2] = r.limit_force if is_force else r.limit_displacement
            arguments[4] = r.failed_value
            return messages.CODE.PAST_LIMIT
        arguments[2] = ended - early_return.CLOSED
        return messages.CODE.CONTACT_CHANGED
    arguments[3] = run.structure.deflections[_farthest(run), 1]
    arguments[4] = run.structure.numbers[0].bound
    if not is_stable(run.method.numbers[0]):
        arguments[5] = radius_at_infinity(run.method.numbers[0])
        return messages.CODE.DIVERGED_UNSTABLE
    if not _is_driven_by_loads(run) and _whirled_apart(run, arguments):
        return messages.CODE.WHIRLED_APART
    return messages.CODE.DIVERGED
