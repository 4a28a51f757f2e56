"""The compiled functions that are called from outside, each of a run's block alone."""

from __future__ import annotations

import math

from ..kernels.compiled import compiled
from ..schemes.family import Scheme
from ..step.laws import law_opening, law_tangent, relative
from ..structure.parameters import prepare
from . import march, tape
from .block import LAYOUT
from .control import Control
from .equilibrium import HELD, find_equilibrium, release
from .observe import observe

_view = LAYOUT.view
# Where a contact is called closed and slipping: penetration over the radius of its wall, and a spin
# [rad/s] that leaves nothing of the smoothing of friction.
_DEPTH, _SLIPPING = 0.1, 1e9


@compiled
def _scheme(numbers):
    return Scheme(numbers.alpha_m, numbers.alpha_f, numbers.beta, numbers.gamma)


@compiled
def _control(numbers):
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
        numbers.h_in_contact,
        numbers.overdamping,
    )


@compiled
def start(block, speed, drive, rate):
    """Take up the parameters, find the rest under the loads that are set, and begin a run there.

    speed [rad/s]; drive: the speed, or a free rotor's torque [N.m]; rate [rad/s2]. Returns HELD or
    why there is no equilibrium.
    """
    run = _view(block)
    prepare(run.structure)
    r = run.memory.record[0]
    r.omega = speed
    if len(run.structure.releases) > 0:
        release(run.structure, run.motion, run.memory.loads)
    else:
        status = find_equilibrium(
            run.structure, speed, run.motion, run.trial, run.memory, run.work, run.problem
        )
        if status != HELD:
            return status
    for i in range(len(run.structure.probes)):
        run.memory.rest[i] = run.motion.q[run.structure.probes[i].dof]
    march.begin_interval(run.structure, drive, rate, True, run.motion, run.memory, run.work)
    observe(run.structure, run.motion, run.memory, run.work, run.reading.observed)
    tape.start(run.structure, run.motion, run.memory, run.work, run.tape, run.reading.observed)
    return HELD


@compiled
def advance(block, t_end, drive, rate):
    """`march.advance` under the loads that are set; returns its status. rate: of the speed
    [rad/s2], or NaN where it goes on as the last two speeds say."""
    run = _view(block)
    numbers = run.method.numbers[0]
    status = march.advance(
        run.structure,
        _scheme(numbers),
        _control(numbers),
        t_end,
        drive,
        march.continued_rate(run.memory.record, drive) if math.isnan(rate) else rate,
        run.motion,
        run.trial,
        run.memory,
        run.work,
        run.problem,
        run.reading,
        run.tape,
    )
    observe(run.structure, run.motion, run.memory, run.work, run.reading.observed)
    return status


@compiled
def linearize(block, by_d, by_v):
    """Fill problem.p and problem.q with the laws' tangents, by_d times those by the displacement
    and by_v times those by the velocity: at rest, but where there is a wall a little behind it, at
    the right, its surfaces slipping in the sense of the rotation."""
    run = _view(block)
    structure, problem = run.structure, run.problem
    omega = run.memory.record[0].omega
    for j in range(len(structure.interfaces)):
        interface = structure.interfaces[j]
        own = run.motion.own[interface.own :]
        d = relative(interface, run.motion.q)
        sliding = omega
        if interface.has_wall == 1:
            d = complex(interface.length, 0.0)
            d += law_opening(structure.laws, interface, d) + _DEPTH * interface.length
            sliding = -_SLIPPING if omega < 0.0 else _SLIPPING
        _force, problem.p[j], problem.q[j] = law_tangent(
            structure.laws,
            interface,
            d,
            0.0j,
            omega,
            sliding,
            by_d,
            by_v,
            0.0,
            own,
            problem.own[interface.own :],
        )


@compiled
def look(block):
    """`observe` alone; what depends on the state but is not in it is made anew."""
    run = _view(block)
    run.work.key[0] = -1.0
    observe(run.structure, run.motion, run.memory, run.work, run.reading.observed)
