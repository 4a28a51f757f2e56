"""Error-controlled step lengths: the local error in the norm of the masses, and a PI controller.

The error of a step is taken per unit of time, in cycles of the motion, so that the error of a run
is proportional to the tolerance (Hairer, Norsett and Wanner, Solving Ordinary Differential
Equations I, sec. II.4; PI control: Gustafsson 1991).
"""

from __future__ import annotations

import math

from ..kernels.compiled import compiled
from ..kernels.functions import direction, root
from ..step.laws import law_opening, relative

SAFETY = 0.8
# Of one step length to the next, at most; growing slowly costs little and calms the next impact.
GROWTH, SHRINKAGE = 1.25, 0.2
CUT = 0.9  # of the wished length: a step below it was cut short and says nothing against it
SMALLEST = 1e-8  # an error that it does not pay to tell from none
# Share of a step before which a contact's opening or closing is worth ending a repeated step at.
LATE = 0.9


@compiled
def local_error(structure, control, pace, h, old, new):
    """Error of a step of length h [s] over the one tolerated [1]; pace: of the motion, with the
    rotation's sign [rad/s].

    Displacements are weighted with their masses (root mean square), so that neither the turning
    point of a node matters nor a light journal that shakes in its clearance. Tolerated is a share
    of this displacement and the clearance, per 2.5 radians of the slowest motion or of the pace,
    whichever is faster: with that the disc's orbit keeps to some times the tolerance.

    At the turn of a swing along a line the accelerations do not change for a moment; there the
    distance to what a whirl of this pace would have changed them to is taken.
    """
    share = structure.mass_share
    turned = direction(pace * h)
    error = 0.0
    apart = 0.0
    size = 0.0
    for i in range(len(share)):
        change = new.a[i] - old.a[i]
        other = new.a[i] - turned * old.a[i]
        q = new.q[i]
        apart += share[i] * (other.real * other.real + other.imag * other.imag)
        error += share[i] * (change.real * change.real + change.imag * change.imag)
        size += share[i] * (q.real * q.real + q.imag * q.imag)
    error = max(error, apart)
    radians = h * max(structure.numbers[0].slowest, abs(pace))
    tolerated = (
        0.4 * radians * control.tolerance * (structure.numbers[0].clearance + math.sqrt(size))
    )
    return abs(control.error_constant) * h * h * math.sqrt(error) / tolerated


@compiled
def contact_error(structure, control, h, new):
    """Error of a step of length h [s] that ends in contact and may be too long to see a whirl grow
    there [1]: as long as its amplitude is below the tolerance, no other error shows that it does
    not."""
    for j in range(len(structure.interfaces)):
        if structure.interfaces[j].has_wall == 1 and new.force[j] != 0.0:
            ratio = h / control.h_in_contact
            return ratio * ratio
    return 0.0


@compiled
def next_length(wished, h, error, error_before):
    """Wished length of the next step [s] after one of length h [s] with these last errors [1]; a
    communication point may have cut h shorter than was wished, which says nothing against it.

    The factor is SAFETY error^-0.35 trend^0.2, of gains for an error per unit of time of order 2.
    """
    error = max(error, SMALLEST)
    trend = max(error_before, SMALLEST) / error
    fifth = root(error, 5)
    twentieth = math.sqrt(math.sqrt(fifth))
    factor = SAFETY * root(trend, 5) / (fifth * twentieth * twentieth * twentieth)
    shortest = SHRINKAGE * h if h > CUT * wished else wished
    return min(GROWTH * wished, max(shortest, factor * h))


@compiled
def repeated_length(structure, h, error, old, new):
    """Length to repeat a step with whose error is too large [s].

    That of the error, or, if it is longer, up to where a contact opens or closes: the two parts of
    such a step are smooth each, and only their joint is not.
    """
    share = max(SHRINKAGE, SAFETY / math.sqrt(error))
    joint = 1.0
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        before = law_opening(structure.laws, interface, relative(interface, old.q))
        after = law_opening(structure.laws, interface, relative(interface, new.q))
        if before * after < 0.0:
            joint = min(joint, before / (before - after))
    return h * (joint if share < joint < LATE else share)
