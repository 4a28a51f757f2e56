"""The compiled entry points, each a function of a run's block alone; they return a status, DONE if
they cannot fail."""

import math

from ..kernels.jit import jit, jit_inlined
from ..schemes.family import Scheme
from ..stability.whirls import find_growing_whirls
from ..step.bows import add_residual_bows, is_bowed
from ..step.excitation import at_place
from ..step.laws import first_invalid_law
from ..step.step_status import DONE
from ..step.tangent import RunTangents
from ..structure.parameters import least_inertia, prepare
from . import derivatives, recorder, time_loop
from .block import LAYOUT
from .communication_interval import begin_interval, continued_rate
from .control import REALTIME, Control
from .early_return import IN_STAGES, LIMITED, NO_INERTIA, rests_past_limit
from .energy import FLOW, total_energy
from .equilibrium import AT_EQUILIBRIUM, OUT_OF_BOUNDS, find_equilibrium, is_out_of_bounds, release
from .error_control import first_size
from .memory import spin_now
from .observe import observe
from .sensitivities import observe_sensitivities

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
        numbers.newton_limit,
        r.h_in_contact,
        r.h_in_the_open,
        r.overdamping,
    )


@jit
def start(block, speed, drive, rate):
    """Take up the parameters, find the equilibrium under the present loads, and begin a run there.

    speed [rad/s]; drive: the speed, or a free rotor's torque [N.m]; rate [rad/s2]. Return
    AT_EQUILIBRIUM or why there is none.
    """
    run = _view(block)
    prepare(run.structure)
    r = run.memory.record[0]
    r.omega = speed
    if run.method.numbers[0].stages > 0 and (r.has_sensitivities == 1 or r.drive_impedance > 0.0):
        return IN_STAGES
    if r.is_free == 1 and run.structure.numbers[0].inertia < least_inertia(run.structure):
        return NO_INERTIA
    run.stages.key[0] = -1.0
    if len(run.structure.releases) > 0:
        release(run.structure, run.motion, run.memory.loads)
        if is_out_of_bounds(run.structure, run.motion):
            return OUT_OF_BOUNDS
        if first_invalid_law(run.structure, run.motion.q, run.motion.internal_state) >= 0:
            return OUT_OF_BOUNDS
        _note_rest(run)
    else:
        for bows in range(2 if is_bowed(run.structure) else 1):
            if bows == 1:  # amplitudes are those about the rest of the straight shaft
                add_residual_bows(run.structure, run.structure.static_load)
            status = find_equilibrium(
                run.structure, speed, run.motion, run.trial, run.memory, run.work, run.problem
            )
            if status != AT_EQUILIBRIUM:
                return status
            if bows == 0:
                _note_rest(run)
            else:
                prepare(run.structure)  # the static load again
    if rests_past_limit(run.structure, run.motion, r):
        return LIMITED
    begin_interval(run.structure, drive, rate, True, run.motion, run.memory, run.work)
    first_size(run.structure, speed, run.motion, run.memory)
    _observe(run, _tangents(run))
    recorder.start(
        run.structure, run.motion, run.memory, run.work, run.recorder, run.outputs.observed
    )
    return AT_EQUILIBRIUM


@jit
def advance(block, t_end, drive, rate):
    """Call `time_loop.advance` under the present loads and their rates; return its status. rate: of
    `drive`, or NaN: a speed continues linearly as between the last two values, and a torque is
    constant."""
    run = _view(block)
    numbers = run.method.numbers[0]
    r, tangents = run.memory.record[0], _tangents(run)
    d_rate = 0.0
    if math.isnan(rate):
        rate, d_rate = continued_rate(run.memory.record, drive, t_end - r.t)
    scheme, control = _scheme(numbers), _control(numbers, r)
    status = time_loop.advance(run, scheme, control, tangents, t_end, drive, rate, d_rate)
    _observe(run, tangents)
    return status


@jit
def _note_rest(run):
    for i in range(len(run.structure.probes)):
        run.memory.rest[i] = at_place(run.structure.probes[i], run.motion.q)


@jit_inlined
def _tangents(run):
    return RunTangents(run.tangent, run.tangent_after, run.tangent_work, run.moved)


@jit_inlined
def _observe(run, tangents):
    """Fill in all outputs."""
    out = run.outputs.observed
    observe(run.structure, run.motion, run.memory, run.work, out, True)
    if run.memory.record[0].has_sensitivities == 1:
        observe_sensitivities(run.structure, run.motion, run.memory, run.work, tangents, out)


@jit
def survey(block, speed, is_start):
    """Search for whirls that grow up to a speed of rotation [rad/s] and, at the start, for growth
    at rest; see `stability.whirls`. In real time this is done at the start only."""
    run = _view(block)
    in_real_time = run.method.numbers[0].mode == REALTIME
    if is_start != 0 or not in_real_time:
        find_growing_whirls(run, speed, is_start)
    if in_real_time:
        r = run.memory.record[0]
        r.surveyed_from, r.surveyed_to = 0.0, math.inf
    return DONE


@jit
def refresh_outputs(block):
    """Fill in the outputs from the present state; the factorized matrices, which are not part of
    it, become invalid."""
    run = _view(block)
    run.work.key[0] = -1.0
    run.stages.key[0] = -1.0
    _observe(run, _tangents(run))
    return DONE


@jit
def retune(block, is_changed):
    """Take up parameters that change during a run: called before and after they change. The change
    of the machine's energy counts as work of external loads."""
    run = _view(block)
    r = run.memory.record[0]
    if is_changed != 0:
        prepare(run.structure)
        run.work.key[0] = -1.0
        run.stages.key[0] = -1.0
    energy = total_energy(run.structure, spin_now(run.memory.record), run.motion, run.work.stores)
    if is_changed != 0:
        run.memory.work[FLOW.external] += energy - r.energy_before
    r.energy_before = energy
    return DONE


@jit
def differentiate(block, row):
    """Fill outputs.derivatives with the first and second time derivatives, or, if row >= 0, with
    the sensitivities to the input of a row of the tangents."""
    run = _view(block)
    if row < 0:
        derivatives.by_time(run, _tangents(run))
    else:
        derivatives.by_input(run, _tangents(run), row)
    return DONE
