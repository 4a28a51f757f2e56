"""The compiled functions that are called from outside, each of a run's block alone."""

from __future__ import annotations

import math

from ..kernels.jit import jit
from ..schemes.family import Scheme
from ..stability.whirls import find_growing_whirls
from ..step.excitation import at_place
from ..structure.parameters import prepare
from . import recorder, time_loop
from .block import LAYOUT
from .control import Control
from .equilibrium import BEYOND, HELD, find_equilibrium, is_beyond, release
from .error_control import first_size
from .observe import observe

_view = LAYOUT.view


@jit
def _scheme(numbers):
    return Scheme(numbers.alpha_m, numbers.alpha_f, numbers.beta, numbers.gamma)


@jit
def _control(numbers, r):
    return Control(
        numbers.mode,
        numbers.h_min,
        numbers.h_max,
        numbers.eps_min,
        numbers.eps_max,
        numbers.indicator,
        numbers.beta_error,
        numbers.norm,
        numbers.atol,
        numbers.rtol,
        numbers.tolerance,
        numbers.error_constant,
        numbers.is_fitted != 0,
        numbers.stages,
        r.h_in_contact,
        r.h_in_the_open,
        r.overdamping,
    )


@jit
def start(block, speed, drive, rate):
    """Take up the parameters, find the rest under the loads that are set, and begin a run there.

    speed [rad/s]; drive: the speed, or a free rotor's torque [N.m]; rate [rad/s2]. Returns HELD or
    why there is no equilibrium.
    """
    run = _view(block)
    prepare(run.structure)
    r = run.memory.record[0]
    r.omega = speed
    run.stages.key[0] = -1.0
    if len(run.structure.releases) > 0:
        release(run.structure, run.motion, run.memory.loads)
        if is_beyond(run.structure, run.motion):
            return BEYOND
    else:
        status = find_equilibrium(
            run.structure, speed, run.motion, run.trial, run.memory, run.work, run.problem
        )
        if status != HELD:
            return status
    for i in range(len(run.structure.probes)):
        run.memory.rest[i] = at_place(run.structure.probes[i], run.motion.q)
    time_loop.begin_interval(run.structure, drive, rate, True, run.motion, run.memory, run.work)
    first_size(run.structure, speed, run.motion, run.memory)
    observe(run.structure, run.motion, run.memory, run.work, run.reading.observed, True)
    recorder.start(
        run.structure, run.motion, run.memory, run.work, run.recorder, run.reading.observed
    )
    return HELD


@jit
def advance(block, t_end, drive, rate):
    """Call `time_loop.advance` under the loads that are set, with their rates; returns its status.
    rate: of `drive`, or NaN where a speed goes on as the last two say and a torque stays."""
    run = _view(block)
    numbers = run.method.numbers[0]
    status = time_loop.advance(
        run.structure,
        _scheme(numbers),
        _control(numbers, run.memory.record[0]),
        t_end,
        drive,
        time_loop.continued_rate(run.memory.record, drive) if math.isnan(rate) else rate,
        run.motion,
        run.trial,
        run.memory,
        run.work,
        run.problem,
        run.stages,
        run.reading,
        run.recorder,
    )
    observe(run.structure, run.motion, run.memory, run.work, run.reading.observed, True)
    return status


@jit
def survey(block, speed, is_start):
    """Look for the whirls that grow up to a speed of rotation [rad/s] and, at the start, for what
    grows at rest; see `stability.whirls`."""
    find_growing_whirls(_view(block), speed, is_start)


@jit
def refresh_outputs(block):
    """`observe` alone; what depends on the state but is not in it is made anew."""
    run = _view(block)
    run.work.key[0] = -1.0
    run.stages.key[0] = -1.0
    observe(run.structure, run.motion, run.memory, run.work, run.reading.observed, True)
