"""From one impact into the false state, or out of it: the map of a journal between two walls.

Along one axis a step is linear but for one number, the wall's force at its end,

    x1 = A x0 + B1 F1 + B0 F0,    F1 = -(k (d1 -+ s) + c d1'), if the journal is past a wall

so that many impacts, of all speeds and at all instants of a step, are followed at once.
"""

import numpy as np

from papers.integrators.members import Scheme

from .one_axis import Axis, step_matrices

INSTANTS = 16  # of the first touch, within a step
STEPS = 600  # in which an impact comes to rest or does not
_WATCHED = 60  # at the end
_CROSSINGS = 15  # in the steps watched, that make a false state


def follow(
    axis: Axis, scheme: Scheme, h: float, speeds: np.ndarray, steps: int = STEPS
) -> np.ndarray:
    """Displacements of a journal that flies at a wall, shape (steps, speeds, INSTANTS) [m].

    h [s]; speeds: of the journal relative to its housing at first, shape (m,) [m/s]. The machine
    moves as if it were rigid; the static load acts on.
    """
    A, B1, B0 = step_matrices(axis, scheme, h)
    size = len(axis.M)
    shape, _ = axis.static
    pick = axis.pick
    within = (np.arange(INSTANTS) + 0.5) / INSTANTS
    speed = np.repeat(speeds, INSTANTS)
    x = np.zeros((3 * size, len(speed)))
    # so far from the wall that it is touched within the first step
    start = axis.clearance - np.tile(within, len(speeds)) * h * speed
    x[:size] = np.outer(shape, start)
    x[size : 2 * size] = h * np.outer(shape, speed)
    d_of, v_of = pick @ B1[:size], pick @ B1[size : 2 * size] / h
    stiffness = 1.0 + axis.k * d_of + axis.c * v_of
    before = np.zeros(len(speed))
    load = np.outer(B1 + B0, np.full(len(speed), axis.along))
    seen = np.empty((steps, len(speed)))
    for n in range(steps):
        x = A @ x + np.outer(B0, before) + load
        d, v = pick @ x[:size], pick @ x[size : 2 * size] / h
        side = np.sign(d)
        past = side * d > axis.clearance
        force = -(axis.k * (d - side * axis.clearance) + axis.c * v) / stiffness
        force = np.where(past & (side * force < 0.0), force, 0.0)
        x += np.outer(B1, force)
        before = force
        seen[n] = d + d_of * force
    return seen.reshape(steps, len(speeds), INSTANTS)


def trapped_share(axis: Axis, scheme: Scheme, h: float, speeds: np.ndarray) -> np.ndarray:
    """Share of the impacts at each speed [m/s] that end in the false state, shape (m,) [1]."""
    late = follow(axis, scheme, h, speeds)[-_WATCHED:]
    wall = np.where(np.abs(late) >= axis.clearance, np.sign(late), 0.0)
    # a wall, and the other one a step or two later
    crossings = sum((wall[k:] * wall[:-k] < 0.0).sum(axis=0) for k in (1, 2))
    return (crossings >= _CROSSINGS).mean(axis=1)
