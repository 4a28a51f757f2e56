"""SciPy's stiff solvers with error control, on compiled right-hand side and Jacobian."""

from functools import partial

import numpy as np
import scipy.integrate

from ..problem import Diverged, Method, Orbit, Problem, orbit
from .cvode import MODES, absolute

PROGRAM = "SciPy"


def methods() -> list[Method]:
    """Radau, BDF and LSODA; too slow for more than the beginning of the run-down. Radau, whose cost
    is that of dense factors, on four modes too."""
    chosen = [(name, 0) for name in ("Radau", "BDF", "LSODA")] + [("Radau", MODES)]
    return [
        Method(
            f"{PROGRAM} on {modes} modes" if modes else PROGRAM,
            f"{name}, rtol = {rtol:g}",
            partial(solve, name, rtol, modes=modes),
            only_short=True,
        )
        for name, modes in chosen
        for rtol in (1e-3, 1e-5)
    ]


def solve(name: str, rtol: float, problem: Problem, modes: int = 0) -> Orbit:
    """From rest to the problem's end, on all of the shaft or so many component modes; raises
    `Diverged`."""
    machine = problem.machine(modes)
    atol = absolute(machine, rtol)
    steps = 0
    solver = getattr(scipy.integrate, name)(
        machine.slope,
        0.0,
        problem.start(modes),
        problem.stop,
        rtol=rtol,
        atol=atol,
        jac=machine.jacobian,
    )
    times = problem.times
    states = np.empty((len(times), len(atol)))
    done = 0
    with np.errstate(all="ignore"):
        while solver.status == "running":
            solver.step()
            steps += 1
            if solver.status == "failed":
                raise Diverged(f"gave up at t = {solver.t:.3g} s")
            reached = np.searchsorted(times, solver.t, side="right")
            if reached > done:
                states[done:reached] = solver.dense_output()(times[done:reached]).T
                done = reached
    return orbit(problem, times, machine.disc(states), steps)
