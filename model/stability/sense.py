"""The sense in which a growing motion whirls, by the rule of `linear.modes.Modes.whirl`: forward,
backward, planar, or mixed where nodes whirl either way, and then which way as a whole."""

from ..kernels.functions import modulus
from ..kernels.jit import jit
from .matrices import OPEN, REST, is_closed

# The choices of `messages`; a mixed whirl that is forward or backward as a whole is their sum.
FORWARD, BACKWARD, PLANAR, MIXED = 0.0, 1.0, 2.0, 3.0
_DEGENERATE = 1e-7  # relative distance of two roots that are one, whose motion may whirl either way
_PLANAR = 1e-3  # difference of the parts that turn with and against x to y, below which it is none
_AT_REST = 1e-18  # share of a square: nodes that move less rest while housings move


@jit
def sense_of_whirl(structure, survey, root, states, case, speed):
    """Return the sense of the motion of `vector` against the rotation: at the closed contacts or,
    where none is but those that carry the machine, of the whole shaft, or of the housings where no
    node moves; root: its own, of so many in all."""
    is_whole = case in (OPEN, REST)
    shares = 0
    for i in range(states):
        distance = modulus(complex(survey.re[i], survey.im[i]) - root)
        shares += 1 if distance <= _DEGENERATE * modulus(root) else 0
    if is_whole and shares > 1:
        return PLANAR
    nodes = len(structure.deflections) if is_whole else 0
    rows = nodes + (len(structure.housings) if is_whole else len(structure.interfaces))
    first, last = 0, rows
    if is_whole:
        shaft = _largest(structure, survey, case, 0, nodes)
        housings = _largest(structure, survey, case, nodes, rows)
        if shaft < _AT_REST * housings:
            first = nodes
        else:
            last = nodes
    size = _largest(structure, survey, case, first, last)
    high = low = whole = total = 0.0
    for row in range(first, last):
        with_x_to_y, against = _parts(structure, survey, case, row)
        high = max(high, with_x_to_y - against)
        low = min(low, with_x_to_y - against)
        whole += with_x_to_y - against
        total += with_x_to_y + against
    way = FORWARD if (whole > 0.0) == (speed >= 0.0) else BACKWARD
    if high > _PLANAR * size and low < -_PLANAR * size:
        return MIXED + way
    return PLANAR if abs(whole) < _PLANAR * total else way


@jit
def as_a_whole(sense):
    """Return the sense of a whirl as a whole, which is mixed in no case."""
    return sense - MIXED if sense >= MIXED else sense


@jit
def _largest(structure, survey, case, first, last):
    """Return the largest square of both parts together of rows `first` to `last`, without it."""
    result = 0.0
    for row in range(first, last):
        with_x_to_y, against = _parts(structure, survey, case, row)
        result = max(result, with_x_to_y + against)
    return result


@jit
def _parts(structure, survey, case, row):
    """Return the squares of the parts of `vector` that turn from x to y and from y to x, at a node,
    or beyond these a housing; in other cases at an interface, 0 of one that is open."""
    coarse = survey.in_use[0]
    half = coarse + len(structure.housings)
    nodes = len(structure.deflections)
    x = y = 0.0j
    if case not in (OPEN, REST):
        if is_closed(structure.interfaces, row, case):
            for i in range(half):
                x += survey.pick[row, i] * survey.vector[i]
                y += survey.pick[row, i] * survey.vector[half + i]
    elif row >= nodes:
        x, y = survey.vector[coarse + row - nodes], survey.vector[half + coarse + row - nodes]
    else:
        dof = structure.deflections[row, 0]
        for i in range(coarse):
            share = _share(survey, dof, i)
            x += share * survey.vector[i]
            y += share * survey.vector[half + i]
    along, against = x + 1j * y, x - 1j * y
    return (
        along.real * along.real + along.imag * along.imag,
        against.real * against.real + against.imag * against.imag,
    )


@jit
def _share(survey, dof, i):
    """Return the part of the displacement of a dof of the shaft in the coarse dof i."""
    place = survey.in_use[1]
    if place >= 0:
        return survey.single_contact_basis[place, dof, i]
    if survey.basis.shape[1] > 0:
        return survey.basis[dof, i]
    return 1.0 if i == dof else 0.0
