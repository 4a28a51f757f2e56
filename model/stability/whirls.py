"""Whirls that grow by themselves: roots of the machine with its contacts open, or closed and
slipping.

Far behind its wall a journal that whirls with its contact closed and slipping meets a force that
depends on its displacement linearly, F = -k (1 + i mu) d, the limit of a large circle: normal force
and, across it, friction, which feeds a backward whirl (Black 1968). A root with a positive real
part there is dry whip. A smaller circle meets a softer wall; how it comes to touch is not asked.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..kernels.functions import modulus
from ..kernels.jit import jit, jit_not_inlined
from ..structure.structure import Structure
from .eigenvalues import eigenvalues
from .matrices import (
    ALL,
    OPEN,
    is_closed,
    is_wall,
    take_basis,
    take_machine,
    take_tangents,
    take_vector,
)
from .resolution import is_stable, resolving_step, resolving_step_in_stages
from .survey_block import MOST_WHIRLS, WHIRL, Survey

# Less than this share of a growth left by the integrator is called hidden; what a step that
# resolves it must leave, and more of it where a tolerance is small.
HIDDEN, RESOLVED = 0.5, 0.97
# Speeds at which growing whirls are looked for, in shares of the present one; where it is passed by
# this factor they are looked for anew. At rest another growth is looked for.
_HALF, _PASSED = 0.5, 1.25
_BISECTIONS = 7  # to where something begins to grow, in a quarter of the speed
_SHARES = (0.0, 1.0, _HALF)
# Of what a machine with growing whirls dissipates, the share that the integrator may take besides.
_OVERDAMPING, _OVERDAMPING_OF_NONE = 0.05, 1.0
_GROWING = 1e-5  # least Re lambda / |lambda| of what is called growing: below it is rounding
_SLOW = 1e-3  # of the machine's lowest frequency: a root below it is a motion as a rigid body
_ALIKE = 5e-10  # ratios that differ by less differ in rounding
_DIGITS = 1e5  # of the bound on the step: six, so that rounding does not show


@dataclass(frozen=True)
class Whirl:
    """A growing whirl: root lambda, imaginary part > 0 [1/s]; is_backward: against the rotation,
    seen at the closed contacts (or the whole shaft); closed: which interfaces with a wall are
    closed; speed [rad/s]."""

    root: complex
    is_backward: bool
    closed: tuple[int, ...]
    speed: float

    @property
    def hz(self) -> float:
        """Frequency [Hz]."""
        return self.root.imag / (2 * np.pi)


def growing_whirls(structure: Structure, survey: Survey) -> tuple[Whirl, ...]:
    """What the last `find_growing_whirls` found, the fastest growing first."""
    interfaces = structure.interfaces
    walls = (interfaces.slips == 1).nonzero()[0].tolist()
    cases = {OPEN: (), ALL: tuple(walls)}
    return tuple(
        Whirl(complex(re, im), backward == 1.0, cases.get(int(case), (int(case),)), speed)
        for re, im, backward, case, speed in survey.whirls[: survey.counted[0]].tolist()
    )


@jit
def rounded_down(x, least):
    """x > 0, no larger than it was, with so many digits: `least` is the smallest integer that has
    them, 10 of two."""
    scale = 1.0
    while x * scale < least:
        scale *= 10.0
    while x * scale >= 10.0 * least:
        scale /= 10.0
    return math.floor(x * scale) / scale


@jit  # as arguments a whole run is more than a WebAssembly function may have
def find_growing_whirls(run, speed, is_start):
    """Find the whirls that grow at this speed of rotation [rad/s] and at half of it, with all
    contacts open, each alone closed, and all; keep the steps that a tolerance chooses short enough
    to see them, and judge what the integrator takes more strictly. At the start find what grows at
    rest too.

    With all contacts open it is the machine itself that is unstable: what grows there within the
    speeds for which this survey stands bounds the steps from now on, and the survey ends where
    something begins to grow.
    """
    structure, survey, r = run.structure, run.survey, run.memory.record[0]
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
        take_tangents(structure, survey, run.motion, run.problem.internal_state, share * speed)
        for case in range(ALL, len(structure.interfaces)):
            if share == 0.0 and case != OPEN:
                continue
            is_one = case >= 0 and is_wall(structure.interfaces[case])
            if not (is_one or case == OPEN or (case == ALL and walls > 1)):
                continue
            _take_roots(structure, survey, share * speed, case)
            if share == 0.0:
                _take_growth_at_rest(run)
            else:
                shortest = _take_whirls(run, share * speed, case)
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
def _take_roots(structure, survey, speed, case):
    """Fill in all roots at one speed [rad/s] in one case."""
    take_basis(structure, survey, case)
    take_machine(structure, survey, speed, case)
    states = states_of(structure, survey)
    for i in range(states):
        for k in range(states):
            survey.work[i, k] = survey.A[i, k]
    eigenvalues(survey.work, survey.re[:states], survey.im[:states])


@jit
def states_of(structure, survey):
    """How many states the machine has in the basis that is in use."""
    return 4 * (survey.in_use[0] + len(structure.housings))


@jit
def _find_survey_range(run, speed):
    """Say for which speeds the survey stands, up to where a whirl begins to grow with all contacts
    open, and bound the steps by what grows there."""
    r = run.memory.record[0]
    sign = -1.0 if speed < 0.0 else 1.0
    size, lowest = abs(speed), run.structure.numbers[0].lowest_omega
    r.surveyed_to = _edge(run, sign, size, _PASSED * max(size, lowest))
    below = size / _PASSED if size > lowest else 0.0
    r.surveyed_from = _edge(run, sign, size, below)


@jit
def _edge(run, sign, size, far):
    """From which size of speed on, towards `far` from `size` [rad/s], something grows with all
    contacts open, or `far`."""
    r = run.memory.record[0]
    step = _step_in_the_open(run, sign * far)
    if step == math.inf or r.h_in_the_open < math.inf:
        r.h_in_the_open = min(r.h_in_the_open, step)
        return far
    calm, growing = size, far
    for _ in range(_BISECTIONS):
        middle = 0.5 * (calm + growing)
        if _step_in_the_open(run, sign * middle) < math.inf:
            growing = middle
        else:
            calm = middle
    return growing


@jit
def _step_in_the_open(run, speed):
    """Longest step that resolves what grows at a speed [rad/s] with all contacts open [s]."""
    structure, survey = run.structure, run.survey
    take_tangents(structure, survey, run.motion, run.problem.internal_state, speed)
    _take_roots(structure, survey, speed, OPEN)
    longest = math.inf
    for i in range(states_of(structure, survey)):
        root = complex(survey.re[i], survey.im[i])
        if is_growing(root):
            longest = min(longest, _longest_step(run, root))
    return longest


@jit
def is_growing(root):
    """Whether a root, over the machine's lowest frequency, is a whirl that grows, not rounding."""
    return root.imag > _SLOW and root.real > _GROWING * modulus(root)


@jit
def _longest_step(run, root):
    """Longest step that leaves a growth its share [s]; root: over the lowest frequency."""
    method = run.method.numbers[0]
    share = max(RESOLVED, 1.0 - math.sqrt(method.tolerance))
    root = root * run.structure.numbers[0].lowest_omega
    if method.stages > 0:
        return resolving_step_in_stages(root, share)
    return resolving_step(method, root, share)


@jit
def _take_whirls(run, speed, case):
    """Take up what grows at one speed in one case; the longest step that resolves it [s]."""
    structure, survey = run.structure, run.survey
    shortest = math.inf
    states = states_of(structure, survey)
    for i in range(states):
        root = complex(survey.re[i], survey.im[i])
        if not is_growing(root):
            continue
        take_vector(survey, states // 2, root)
        is_backward = _turns_back(structure, survey, states // 4, case) == (speed >= 0.0)
        shortest = min(shortest, _longest_step(run, root))
        _keep(survey, root * structure.numbers[0].lowest_omega, is_backward, case, speed)
    return shortest


@jit
def _turns_back(structure, survey, half, case):
    """Whether the motion of `vector`, of x and y of `half` dofs and housings, turns from y to x: at
    the closed contacts, or as a whole."""
    forward = backward = 0.0
    rows = half if case == OPEN else len(structure.interfaces)
    for row in range(rows):
        if case == OPEN:
            x, y = survey.vector[row], survey.vector[half + row]
        elif is_closed(structure.interfaces, row, case):
            x = y = 0.0j
            for i in range(half):
                x += survey.pick[row, i] * survey.vector[i]
                y += survey.pick[row, i] * survey.vector[half + i]
        else:
            continue
        along, against = x + 1j * y, x - 1j * y
        forward += along.real * along.real + along.imag * along.imag
        backward += against.real * against.real + against.imag * against.imag
    return backward > forward


@jit
def _keep(survey, root, is_backward, case, speed):
    """Put a whirl among those found, the fastest first."""
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
    result[at, WHIRL.is_backward] = 1.0 if is_backward else 0.0
    result[at, WHIRL.case], result[at, WHIRL.speed] = case, speed


@jit
def _take_growth_at_rest(run):
    """Take up the root of the growth with the least damping ratio, its imaginary part >= 0."""
    survey = run.survey
    best, most = complex(math.nan, math.nan), 0.0
    for i in range(states_of(run.structure, survey)):
        root = complex(survey.re[i], survey.im[i])
        size = modulus(root)
        if not (root.imag >= 0.0 and size > _SLOW and root.real > _GROWING * size):
            continue
        ratio = root.real / size
        # of those that do not oscillate, which differ in rounding alone, the fastest
        is_faster = abs(ratio - most) <= _ALIKE and root.real > best.real
        if ratio > most + _ALIKE or is_faster:
            best, most = root, ratio
    survey.rest[0] = best * run.structure.numbers[0].lowest_omega
