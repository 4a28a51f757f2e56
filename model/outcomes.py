"""What a run has come to, as the code of a sentence (`messages`) and its numbers."""

from __future__ import annotations

import math

import numpy as np

from . import messages as say
from .kernels.compiled import compiled, plain
from .kernels.functions import modulus
from .march import equilibrium, march
from .march.control import CONTROLLED, FIXED
from .settings.resolver import radius_at_infinity
from .spelling import TOLD, spell
from .stability.matrices import OPEN
from .stability.memory import WHIRL
from .stability.resolution import is_stable, resolving_step, seen_growth
from .stability.whirls import HIDDEN, RESOLVED, rounded_down

_TWO_PI = 2 * math.pi
_ROUNDING = 1e-9  # of a root: an imaginary part below it is what a processor rounds to
_TWO_DIGITS = 10.0
_LOST = 1e-9  # of the shaft's stiffness: what is softer rounding may hide


@compiled
def no_rest(run, status, told):
    """Why a start has no equilibrium."""
    structure, numbers = run.structure, run.structure.numbers[0]
    if status == equilibrium.BEYOND:
        farthest = _farthest(run)
        told[0] = structure.deflections[farthest, 1]
        told[1] = modulus(run.motion.q[structure.deflections[farthest, 0]])
        told[2] = numbers.bound
        return say.START_BEYOND
    told[0] = _held_nodes(structure)
    if told[0] < 2.0:
        return say.NOT_HELD
    if status == equilibrium.UNSTABLE:
        return say.ON_A_HUMP
    stiffest, mass = 0.0, 0.0
    for i in range(len(structure.deflections)):
        dof = structure.deflections[i, 0]
        stiffest = max(stiffest, structure.K_shaft[dof, 0])
        mass += structure.mass_sum[dof]
    told[0], told[1] = stiffest, mass * numbers.lowest_omega * numbers.lowest_omega
    if _LOST * stiffest > told[1]:
        return say.LOST_IN_ROUNDING
    told[0] = numbers.bound
    return say.TOO_FAR if status == equilibrium.NOT_HELD else say.NO_REST


@compiled
def _held_nodes(structure):
    """How many nodes have a spring or an interface."""
    held = 0
    for dof in range(structure.M.shape[0]):
        is_held = False
        for i in range(len(structure.springs)):
            spring = structure.springs[i]
            is_held = is_held or (spring.dof == dof and spring.stiffness > 0.0)
        for j in range(len(structure.interfaces)):
            is_held = is_held or structure.interfaces[j].dof == dof
        held += 1 if is_held else 0
    return held


@compiled
def growth_at_rest(root, told):
    """What grows at rest with this root [1/s], its imaginary part >= 0; NaN: nothing."""
    if root != root:
        return say.GOOD
    if root.imag > _ROUNDING * modulus(root):
        told[0], told[1] = root.imag / _TWO_PI, root.imag
        told[2] = -_TWO_PI * root.real / root.imag
        return say.OSCILLATES_AT_REST
    told[0] = root.real
    return say.MOVES_AT_REST


def grows_at_rest(root: complex) -> str:
    """A sentence about a growth at rest, its root [1/s] with an imaginary part >= 0."""
    told = np.zeros(TOLD)
    return spell(say.SENTENCES[plain(growth_at_rest)(root, told)], told)


@compiled
def _tell_whirl(whirl, told, at):
    """Six numbers about a row of `survey.found`."""
    case, omega = whirl[WHIRL.case], whirl[WHIRL.omega]
    told[at] = -1.0 - case if case < 0.0 else case + 2.0
    told[at + 1] = whirl[WHIRL.is_backward]
    told[at + 2], told[at + 3] = omega / _TWO_PI, omega
    told[at + 4], told[at + 5] = whirl[WHIRL.growth], whirl[WHIRL.speed]


@compiled
def unstable(run, told):
    """Of the whirls that a survey found, that which grows fastest at the present speed with all
    contacts open."""
    survey = run.survey
    for i in range(survey.counted[0]):
        whirl = survey.found[i]
        is_present = whirl[WHIRL.speed] == run.memory.record[0].surveyed_at
        if whirl[WHIRL.case] == OPEN and is_present:
            _tell_whirl(whirl, told, 0)
            return say.UNSTABLE
    return say.GOOD


@compiled
def hidden(run, told):
    """The growing whirls that a survey found and that the solver's steps hide: the one that grows
    fastest, and the longest step that resolves them all."""
    survey, numbers = run.survey, run.method.numbers[0]
    if numbers.mode == CONTROLLED or not is_stable(numbers):
        return say.GOOD
    h = run.memory.record[0].h if numbers.mode == FIXED else numbers.h_max
    longest = math.inf
    for i in range(survey.counted[0]):
        whirl = survey.found[i]
        root = complex(whirl[WHIRL.growth], whirl[WHIRL.omega])
        seen = seen_growth(numbers, h, root)
        if not seen < HIDDEN * root.real:
            continue
        if longest == math.inf:
            told[0] = h
            _tell_whirl(whirl, told, 1)
            told[7] = modulus(root) * h
            told[8] = told[10] = 1.0 if seen < 0.0 else 0.0
            told[9] = abs(seen)
        longest = min(longest, resolving_step(numbers, root, RESOLVED))
    if longest == math.inf:
        return say.GOOD
    told[11] = rounded_down(longest, _TWO_DIGITS)
    return say.HIDES


@compiled
def _farthest(run):
    """Which deflection is farthest away, or the first that is nowhere."""
    deflections = run.structure.deflections
    place, farthest = 0, -1.0
    for i in range(len(deflections)):
        q = run.motion.q[deflections[i, 0]]
        square = q.real * q.real + q.imag * q.imag
        distance = square if math.isfinite(square) else math.inf
        if distance > farthest:
            place, farthest = i, distance
    return place


@compiled
def _whirled_apart(run, told):
    """Whether there are growing whirls; if so, from told[5] on, the one most like the motion
    reached: in its sense, if there is one, and nearest in frequency."""
    survey, motion, speed = run.survey, run.motion, run.memory.record[0].omega
    dof = run.structure.deflections[_farthest(run), 0]
    q, v = motion.q[dof], motion.v[dof]
    rate = (q.conjugate() * v).imag / (q.real * q.real + q.imag * q.imag)
    is_backward = (rate < 0.0) == (speed >= 0.0)
    is_any = True
    for i in range(survey.counted[0]):
        is_any = is_any and (survey.found[i, WHIRL.is_backward] == 1.0) != is_backward
    nearest = math.inf
    for i in range(survey.counted[0]):
        whirl = survey.found[i]
        ratio = whirl[WHIRL.omega] / max(abs(rate), 1e-9)
        ratio = max(ratio, 1.0 / ratio)
        is_alike = is_any or (whirl[WHIRL.is_backward] == 1.0) == is_backward
        if is_alike and (nearest == math.inf or ratio < nearest):
            nearest = ratio
            _tell_whirl(whirl, told, 5)
    told[11] = 1.0 if is_backward else 0.0
    told[12] = abs(rate) / _TWO_PI
    return survey.counted[0] > 0


@compiled
def failure(run, status, told):
    """Why an `advance` did not come to its end; where it diverged, the survey of whirls has to have
    been made anew."""
    r = run.memory.record[0]
    told[0], told[1], told[2] = r.failed_at, r.omega, r.failed_h
    if status == march.NOT_CONVERGED:
        return say.NOT_CONVERGED
    if status == march.UNFINISHED:
        told[3] = r.max_iterations
        return say.STOPPED
    told[3] = run.structure.deflections[_farthest(run), 1]
    told[4] = run.structure.numbers[0].bound
    if not is_stable(run.method.numbers[0]):
        told[5] = radius_at_infinity(run.method.numbers[0])
        return say.DIVERGED_UNSTABLE
    return say.WHIRLED_APART if _whirled_apart(run, told) else say.DIVERGED
