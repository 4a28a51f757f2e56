"""Self-excited whirls: unstable roots of the machine with its contacts open, or closed and
slipping. Contacts that carry the machine, which nothing else holds, are never all open: they are as
at rest instead.

At a large penetration a journal that whirls with its contact closed and slipping meets a force that
is linear in its displacement, F = -k (1 + i mu) d, the limit of a large circle: normal force and,
at right angles to it, friction, which feeds a backward whirl (Black 1968). A root with a positive
real part there is dry whip. A smaller circle meets a softer wall; how the journal comes into
contact is not considered.
"""

import math

from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..step.laws import relative
from .eigenvalues import eigenvalues
from .eigenvector import fill_eigenvector
from .matrices import (
    ALL,
    OPEN,
    REST,
    fill_basis_matrices,
    fill_rest_tangents,
    fill_system_matrix,
    fill_tangents,
    find_seats,
    is_seat,
    is_wall,
)
from .resolution import is_stable, resolving_step, resolving_step_in_stages
from .sense import sense_of_whirl
from .survey_block import MOST_WHIRLS, WHIRL

# A growth is called hidden if the integrator leaves less than the first share of it; a step that
# resolves it leaves at least the second, and more where a tolerance is small.
HIDDEN, RESOLVED = 0.5, 0.97
# Growing whirls are sought at these shares of the present speed, and anew after it has grown by the
# factor _PASSED. At standstill growth from rest is sought instead.
_HALF, _PASSED = 0.5, 1.25
_BISECTIONS = 7  # steps to the speed of the onset of growth, within a quarter of the speed
_SHARES = (0.0, 1.0, _HALF)
# The energy that the integrator may dissipate, as a share of that of a machine with growing whirls,
# and of one without.
_OVERDAMPING, _OVERDAMPING_OF_NONE = 0.05, 1.0
_GROWING = 1e-5  # least Re lambda / |lambda| that counts as growth: below it is rounding
_SLOW = 1e-3  # share of the machine's lowest frequency: a lower root is a rigid-body motion
_ALIKE = 5e-10  # ratios that differ by less differ by rounding only
_CENTRED = 1e-9  # of a clearance: nearer to the middle the force of a film is rounding
_DIGITS = 1e5  # the bound on the step is rounded to six digits, so that it is reproducible


@jit
def rounded_down(x, least):
    """Return x > 0 rounded down to a number of digits; `least`: the smallest integer with that
    many, 10 for two."""
    scale = 1.0
    while x * scale < least:
        scale *= 10.0
    while x * scale >= 10.0 * least:
        scale /= 10.0
    return math.floor(x * scale) / scale


@jit  # as arguments a whole run is more than a WebAssembly function may have
def find_growing_whirls(run, speed, is_start):
    """Find the whirls that grow at this speed of rotation [rad/s] and at half of it, with all
    contacts open, or as they carry the machine, each alone closed, and all closed; bound the steps
    so that a tolerance resolves them, and tighten the limit of numerical damping. At the start find
    growth at rest too.

    With all contacts open, or as at rest, the machine itself is unstable: growth at any speed of
    this survey's range bounds the steps from now on, and the range ends where a growth begins.
    """
    structure, survey, r = run.structure, run.survey, run.memory.record[0]
    if is_start != 0:
        find_seats(structure, run.motion, run.memory.seats)
    r.surveyed_at = speed
    survey.counted[0] = 0
    survey.rest[0] = complex(math.nan, math.nan)
    walls = 0
    for j in range(len(structure.interfaces)):
        walls += 1 if is_wall(structure.interfaces[j]) else 0
    r.h_in_contact = r.h_in_the_open = math.inf
    r.overdamping = _OVERDAMPING_OF_NONE
    survey.in_use[1] = -2
    for share in _SHARES:
        if (share == 0.0 and is_start == 0) or (share == _HALF and speed == 0.0):
            continue
        fill_tangents(structure, survey, run.motion, run.problem.internal_state, share * speed)
        if share == 0.0 and not _rests_here(structure, survey, run.motion):
            continue
        for case in range(ALL, len(structure.interfaces)):
            if share == 0.0 and case != OPEN:
                continue
            is_one = case >= 0 and is_wall(structure.interfaces[case])
            if not (is_one or case == OPEN or (case == ALL and walls > 1)):
                continue
            held = case
            if case == OPEN:
                held = _fill_own_roots(run, share * speed)
            else:
                _fill_roots(structure, survey, run.memory.seats, share * speed, case)
            if share == 0.0:
                _record_growth_at_rest(run)
            else:
                shortest = _record_whirls(run, share * speed, held)
                if case == OPEN and share == 1.0:
                    r.h_in_the_open = shortest
                elif case != OPEN:
                    r.h_in_contact = min(r.h_in_contact, shortest)
    _find_survey_range(run, speed)
    if is_stable(run.method.numbers[0]):
        if survey.counted[0] > 0:
            r.overdamping = _OVERDAMPING
        if r.h_in_contact < math.inf:
            r.h_in_contact = rounded_down(r.h_in_contact, _DIGITS)
        if r.h_in_the_open < math.inf:
            r.h_in_the_open = rounded_down(r.h_in_the_open, _DIGITS)
    else:
        r.h_in_contact = r.h_in_the_open = math.inf


@jit_not_inlined
def _fill_roots(structure, survey, seats, speed, case):
    """Fill in all roots at one speed [rad/s] in one case."""
    fill_basis_matrices(structure, survey, case)
    fill_system_matrix(structure, survey, seats, speed, case)
    states = states_of(structure, survey)
    for i in range(states):
        for k in range(states):
            survey.work[i, k] = survey.A[i, k]
    eigenvalues(survey.work, survey.re[:states], survey.im[:states])


@jit
def _fill_own_roots(run, speed):
    """Fill in all roots of the machine itself at one speed [rad/s]: with all contacts open or, if
    some carry it and nothing else does, with these as at rest; return which."""
    structure, survey, seats = run.structure, run.survey, run.memory.seats
    lies = _has_seats(seats)
    if not lies or _has_other_supports(structure):
        _fill_roots(structure, survey, seats, speed, OPEN)
        lies = lies and _is_free(structure, survey)
    if not lies:
        return OPEN
    trial = run.problem.internal_state
    fill_rest_tangents(structure, survey, run.motion, trial, seats, speed)
    _fill_roots(structure, survey, seats, speed, REST)
    fill_tangents(structure, survey, run.motion, trial, speed)
    return REST


@jit
def _rests_here(structure, survey, motion):
    """Return whether the machine at standstill, for which the tangents are, is where it is: an oil
    film that carries it has no stiffness then."""
    result = True
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        is_off_centre = modulus(relative(interface, motion.q)) > _CENTRED * interface.length
        carries = interface.has_wall == 0 and motion.force[j] != 0.0 and is_off_centre
        result = result and not (carries and survey.p_d[j] == 0.0 and survey.q_d[j] == 0.0)
    return result


@jit
def _has_seats(seats):
    """Return whether a wall is closed at rest."""
    result = False
    for j in range(len(seats)):
        result = result or is_seat(seats, j)
    return result


@jit
def _has_other_supports(structure):
    """Return whether anything but walls is between the shaft and its surroundings."""
    result = len(structure.springs) > 0
    for j in range(len(structure.interfaces)):
        result = result or structure.interfaces[j].has_wall == 0
    return result


@jit
def _is_free(structure, survey):
    """Return whether a root found is that of a motion against no stiffness."""
    result = False
    for i in range(states_of(structure, survey)):
        result = result or modulus(complex(survey.re[i], survey.im[i])) <= _SLOW
    return result


@jit
def states_of(structure, survey):
    """Return the number of states of the machine in the present basis."""
    return 4 * (survey.in_use[0] + len(structure.housings)) + len(survey.rates)


@jit
def _find_survey_range(run, speed):
    """Set the range of speeds for which the survey is valid, up to where a whirl begins to grow
    with all contacts open, and bound the steps by the growth within it."""
    r = run.memory.record[0]
    sign = -1.0 if speed < 0.0 else 1.0
    size, lowest = abs(speed), run.structure.numbers[0].lowest_omega
    r.surveyed_to = _edge(run, sign, size, _PASSED * max(size, lowest))
    below = size / _PASSED if size > lowest else 0.0
    r.surveyed_from = _edge(run, sign, size, below)


@jit
def _edge(run, sign, size, far):
    """Return the absolute speed between `size` and `far` [rad/s] at which a whirl with open
    contacts first grows, or `far`."""
    r = run.memory.record[0]
    step = _step_in_the_open(run, sign * far)
    if step == math.inf or r.h_in_the_open < math.inf:
        r.h_in_the_open = min(r.h_in_the_open, step)
        return far
    stable, growing = size, far
    for _ in range(_BISECTIONS):
        middle = 0.5 * (stable + growing)
        if _step_in_the_open(run, sign * middle) < math.inf:
            growing = middle
        else:
            stable = middle
    return growing


@jit
def _step_in_the_open(run, speed):
    """Return the longest step that resolves all growth of the machine itself at a speed [rad/s]
    [s]."""
    structure, survey = run.structure, run.survey
    fill_tangents(structure, survey, run.motion, run.problem.internal_state, speed)
    _fill_own_roots(run, speed)
    longest = math.inf
    for i in range(states_of(structure, survey)):
        root = complex(survey.re[i], survey.im[i])
        if is_growing(root):
            longest = min(longest, _longest_step(run, root))
    return longest


@jit
def is_growing(root):
    """Return whether a root, over the machine's lowest frequency, is a growing whirl and not
    rounding."""
    return root.imag > _SLOW and root.real > _GROWING * modulus(root)


@jit
def _longest_step(run, root):
    """Return the longest step that resolves a growth [s]; root: over the lowest frequency."""
    method = run.method.numbers[0]
    share = max(RESOLVED, 1.0 - math.sqrt(method.tolerance))
    root = root * run.structure.numbers[0].lowest_omega
    if method.stages > 0:
        return resolving_step_in_stages(root, share)
    return resolving_step(method, root, share)


@jit
def _record_whirls(run, speed, case):
    """Record the growing whirls at one speed in one case; return the longest step that resolves
    them [s]."""
    structure, survey = run.structure, run.survey
    shortest = math.inf
    half = survey.in_use[0] + len(structure.housings)
    for i in range(states_of(structure, survey)):
        root = complex(survey.re[i], survey.im[i])
        if not is_growing(root):
            continue
        fill_eigenvector(survey, 2 * half, root)
        sense = sense_of_whirl(structure, survey, root, states_of(structure, survey), case, speed)
        shortest = min(shortest, _longest_step(run, root))
        _insert_whirl(survey, root * structure.numbers[0].lowest_omega, sense, case, speed)
    return shortest


@jit
def _insert_whirl(survey, root, sense, case, speed):
    """Insert a whirl among those found, the fastest first."""
    result = survey.whirls
    at = survey.counted[0]
    while at > 0 and result[at - 1, WHIRL.growth] < root.real:
        at -= 1
    if at == MOST_WHIRLS:
        return
    survey.counted[0] = min(survey.counted[0] + 1, MOST_WHIRLS)
    for row in range(survey.counted[0] - 1, at, -1):
        for k in range(len(WHIRL)):
            result[row, k] = result[row - 1, k]
    result[at, WHIRL.growth], result[at, WHIRL.omega] = root.real, root.imag
    result[at, WHIRL.sense] = sense
    result[at, WHIRL.case], result[at, WHIRL.speed] = case, speed


@jit
def _record_growth_at_rest(run):
    """Record the root of the growth with the least damping ratio, its imaginary part >= 0."""
    survey = run.survey
    best, most = complex(math.nan, math.nan), 0.0
    for i in range(states_of(run.structure, survey)):
        root = complex(survey.re[i], survey.im[i])
        size = modulus(root)
        if not (root.imag >= 0.0 and size > _SLOW and root.real > _GROWING * size):
            continue
        ratio = root.real / size
        # of roots that do not oscillate, which differ by rounding only, the fastest
        is_faster = abs(ratio - most) <= _ALIKE and root.real > best.real
        if ratio > most + _ALIKE or is_faster:
            best, most = root, ratio
    survey.rest[0] = best * run.structure.numbers[0].lowest_omega
