"""Exudyn's generalized-alpha: the same matrices, the contacts in compiled force and Jacobian.

Exudyn has no clearance bearing with friction, so the contacts, the unbalance and the gyroscopic
forces come in a user function; those are compiled by numba and called through Exudyn's interface to
Python. Exudyn's fast build, full Newton above and modified Newton below `_FINE`, and a tolerance of
its iteration that costs no accuracy: what was quickest of what was tried.
"""

import sys
from functools import partial
from typing import Any

import numpy as np

from ..forces import add_gyroscopic, fill_force, fill_jacobian, machine
from ..problem import RATE, SPEED, Diverged, Method, Missing, Orbit, Problem, orbit
from .quiet import quiet

PROGRAM = "Exudyn"
_FINE = 2e-4  # [s]
_ITERATION_TOLERANCE = 1e-5
_FINE_SAMPLE = 5e-4  # for the peaks, and to interpolate between [s]


def methods() -> list[Method]:
    """The dissipation of `robust` and the best one (`dissipation`); raises `Missing`."""
    load()
    chosen = [(0.2, 5e-4), (0.3, 1e-3), (0.3, 5e-4), (0.3, 2.5e-4)]
    return [method(rho, h) for rho, h in chosen] + [method(0.3, 1e-4, only_short=True)]


def method(rho: float, h: float, only_short: bool = False) -> Method:
    """Chung and Hulbert's scheme of spectral radius rho, steps of h [s]."""
    setting = f"rho = {rho:g}, h = {h:g} s"
    return Method(PROGRAM, setting, partial(solve, rho, h), only_short=only_short)


def load() -> Any:
    """Exudyn in its fast build; raises `Missing`."""
    vars(sys)["exudynFast"] = True  # how Exudyn is asked for its build without range checks
    try:
        with quiet():
            import exudyn
    except ImportError as error:
        raise Missing(f"Exudyn: {error} (pip install exudyn)") from error
    return exudyn


def solve(rho: float, h: float, problem: Problem) -> Orbit:
    """From rest to the problem's end in steps of h [s]; raises `Diverged` and `Missing`."""
    exudyn = load()
    from exudyn import itemInterface as items

    given = machine(problem.rotor, SPEED, RATE)
    size = len(given.M)
    force, jacobian = np.zeros(size), np.zeros((size, size))

    def force_function(mbs, t, item, q, v):
        velocities = np.asarray(v)
        fill_force(t, np.asarray(q), velocities, given.forces, force)
        add_gyroscopic(t, velocities, given.forces, force)
        return force

    def jacobian_function(mbs, t, item, q, v, of_q, of_v):
        fill_jacobian(t, np.asarray(q), np.asarray(v), of_q, of_v, given.forces, jacobian)
        return jacobian

    system = exudyn.SystemContainer().AddSystem()
    node = system.AddNode(
        items.NodeGenericODE2(
            referenceCoordinates=np.zeros(size),
            initialCoordinates=given.rest,
            initialCoordinates_t=np.zeros(size),
            numberOfODE2Coordinates=size,
        )
    )
    system.AddObject(
        items.ObjectGenericODE2(
            nodeNumbers=[node],
            massMatrix=given.M,
            stiffnessMatrix=given.K,
            dampingMatrix=given.C,
            forceUserFunction=force_function,
            jacobianUserFunction=jacobian_function,
        )
    )
    coordinates = exudyn.OutputVariableType.Coordinates
    sensor = system.AddSensor(
        items.SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=coordinates)
    )
    system.Assemble()
    settings = exudyn.SimulationSettings()
    integration = settings.timeIntegration
    integration.numberOfSteps = round(problem.stop / h)
    integration.endTime = problem.stop
    integration.generalizedAlpha.spectralRadius = rho
    integration.newton.useModifiedNewton = h < _FINE
    integration.newton.relativeTolerance = _ITERATION_TOLERANCE
    integration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = max(h, min(_FINE_SAMPLE, problem.sample))
    try:
        with quiet():
            has_ended = system.SolveDynamic(settings)
    except ValueError as error:
        raise Diverged(str(error).splitlines()[0]) from error
    if not has_ended:
        raise Diverged("its Newton iteration did not converge")
    rows = system.GetSensorStoredData(sensor)
    disc = rows[:, 1 + given.disc] + 1j * rows[:, 1 + given.disc + size // 2]
    steps = int(system.sys["dynamicSolver"].it.currentStepIndex) - 1
    return orbit(problem, rows[:, 0], disc, steps)
