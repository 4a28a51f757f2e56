"""The growing whirls that a run found."""

from typing import NamedTuple

import numpy as np
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.stability.matrices import ALL, OPEN, REST
from rotor_fmu.model.stability.sense import BACKWARD, as_a_whole


class Whirl(NamedTuple):
    """A growing whirl: root, imaginary part > 0 [1/s]; is_backward: against the rotation, all in
    all, at the closed contacts or of the whole shaft; closed: which interfaces with a wall are
    closed; speed [rad/s]."""

    root: complex
    is_backward: bool
    closed: tuple[int, ...]
    speed: float


def found_last(simulation):
    """The whirls that a run found last, the fastest growing first."""
    run = simulation._run
    walls = tuple(np.flatnonzero(run.structure.interfaces.slips == 1).tolist())
    seats = tuple(np.flatnonzero(run.memory.seats).tolist())
    cases = {OPEN: (), ALL: walls, REST: seats}
    return tuple(
        Whirl(
            complex(re, im),
            interpreted(as_a_whole)(sense) == BACKWARD,
            cases.get(int(case), (int(case),)),
            speed,
        )
        for re, im, sense, case, speed in run.survey.whirls[: run.survey.counted[0]].tolist()
    )
