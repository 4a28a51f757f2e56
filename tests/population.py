"""Machines drawn at random, and what CVODE finds of them.

CVODE (SUNDIALS) solves the equations of `benchmarks.equations`, which share the matrices with this
project and nothing of its time integration. `python -m tests.population` judges them, the rig and
the examples, and keeps what it finds for `docs/integrators.md`.
"""

from __future__ import annotations

import csv
import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.settings import Settings, choose
from rotor_fmu.model.simulation import Simulation, StepFailure
from sksundae.cvode import CVODE

from benchmarks import equations
from papers.integrators import tolerances

from . import known
from .whip import overhung_machine

TIMES = np.linspace(0.0, 0.3, 151)  # [s]
# Some machines stand on the edge between a whip and none: a peak is right that CVODE finds with an
# unbalance between these multiples of the true one.
UNBALANCES = (1.0, 0.99, 1.01)
RTOL = 1e-10
ATOL = 1e-4  # displacements below it [m] are known to as much as it is, relative to it
SLIGHTLY = 1e-5  # a shift of the start, relative to the orbit: much to CVODE, little to the machine


def machine(seed: int) -> tuple[Rotor, float]:
    """The overhung machine with friction, clearance, damping, gravity and speed [rad/s] drawn."""
    draw = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return math.exp(draw.uniform(math.log(low), math.log(high)))

    mu, clearance, damping = between(0.02, 0.4), between(3e-5, 3e-4), between(100, 3000)
    speed, gravity = draw.uniform(100, 500), float(draw.choice([0.0, 9.81]))
    rotor = overhung_machine(mu=mu, clearance=clearance, cx=damping, cy=damping)
    supports = (replace(s, damping=damping) for s in rotor.supports)
    return replace(rotor.with_parts(Support, *supports), gravity=gravity), speed


@dataclass(frozen=True)
class Judged:
    """A run of a machine beside CVODE's: status; error of the disc's largest displacement, relative
    to it, and beyond what `UNBALANCES` make of it [1]; error of its orbit, relative to clearance
    and largest displacement [1]."""

    status: str
    peak: float
    beyond: float
    orbit: float


def by_cvode(rotor: Rotor, speed: float) -> np.ndarray:
    """The disc's orbits from rest with all `UNBALANCES`, shape (unbalances, times) [m]."""
    return np.array([_orbit(unbalanced(rotor, factor), speed) for factor in UNBALANCES])


def unbalanced(rotor: Rotor, factor: float) -> Rotor:
    """The machine with so many times its unbalance."""
    return rotor.with_parts(Disc, *(replace(disc, e=factor * disc.e) for disc in rotor.discs))


def condition(rotor: Rotor, speed: float, exact: np.ndarray) -> float:
    """How many times the change of the start, a shift of the rotor sideways, its orbit changes by
    [1]."""
    shift = SLIGHTLY * _size(rotor, exact)
    return np.abs(_orbit(rotor, speed, shift) - exact).max() / shift


def _size(rotor: Rotor, orbit: np.ndarray) -> float:
    """Clearance and largest displacement, by which errors of the orbit are told [m]."""
    return rotor.bearings[0].clearance + np.abs(orbit).max()


def _orbit(rotor: Rotor, speed: float, shift: float = 0.0) -> np.ndarray:
    """The disc's way from where it rests [m]; shift: of the rotor at the start [m]."""
    at_rest = Simulation(rotor, speed=speed, warn=lambda message: None).motion
    machine = equations.equations(rotor, speed, 0.0)
    coefficients = machine.coefficients
    solver = CVODE(
        lambda t, state, out: equations.slope(t, state, out, coefficients),
        jacfn=lambda t, state, _, out: equations.jacobian(t, state, out, coefficients),
        rtol=RTOL,
        atol=np.repeat([ATOL * RTOL, 1e3 * ATOL * RTOL], machine.size),
        max_num_steps=10**8,
    )
    q = at_rest.q.copy()
    q[: 2 * len(rotor.nodes) : 2] += shift
    orbit = machine.disc(solver.solve(TIMES, equations.real_state(q, at_rest.v)).y)
    return orbit - orbit[0] + shift


def judged(rotor: Rotor, speed: float, settings: Settings, exact: np.ndarray) -> Judged:
    """This project's run against CVODE's orbits `exact` as far as it comes."""
    said: list[str] = []
    sim = Simulation(rotor, settings, speed=speed, warn=said.append)
    found, status = [0j], "ok"
    start = complex(sim.read("disc[1].x"), sim.read("disc[1].y"))
    for t in TIMES[1:]:
        try:
            sim.advance(t, speed)
        except StepFailure as failure:
            status = str(failure)
            break
        found.append(complex(sim.read("disc[1].x"), sim.read("disc[1].y")) - start)
    if status == "ok" and said:
        status = said[-1]
    orbit, truth = np.array(found), exact[0, : len(found)]
    peaks, peak = np.abs(exact[:, : len(found)]).max(axis=1), np.abs(orbit).max()
    size, least, most = peaks[0], peaks.min(), peaks.max()
    return Judged(
        status,
        abs(peak / size - 1),
        max(0.0, 1 - peak / least, peak / most - 1),
        np.abs(orbit - truth).max() / _size(rotor, truth),
    )


def random_machines(count: int) -> Iterator[tolerances.Row]:
    """Each of the machines at each tolerance."""
    for seed in range(count):
        rotor, speed = machine(seed)
        exact = by_cvode(rotor, speed)
        told = condition(rotor, speed, exact[0])
        for tolerance in tolerances.TOLERANCES:
            run = judged(rotor, speed, choose(tolerance=tolerance), exact)
            errors = run.peak, run.beyond, run.orbit
            yield tolerances.Row("random", str(seed), tolerance, run.status, *errors, told)


def known_machines() -> Iterator[tolerances.Row]:
    """The rig's windows and the examples at each tolerance."""
    for group, runs in (("rig", known.rig_windows()), ("examples", known.examples())):
        for run in runs:
            exact = run.exact()
            told = known.condition(run, exact)
            size = np.abs(exact).max()
            for tolerance in tolerances.TOLERANCES:
                status, orbit = run.found(choose(tolerance=tolerance))
                peak = abs(np.abs(orbit).max() / size - 1)
                error = np.abs(orbit - exact).max() / size
                yield tolerances.Row(group, run.name, tolerance, status, peak, peak, error, told)


def main(count: int = 50) -> None:
    """Judge everything, keep the rows where `docs/integrators.md` finds them, print its table."""
    rows = [*random_machines(count), *known_machines()]
    with tolerances.TABLE.open("w", encoding="utf-8", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(tolerances.Row._fields)
        lines.writerows(row._replace(status=row.status.split(" since")[0]).told() for row in rows)
    for line in (tolerances.head(), *tolerances.table(tolerances.rows())):
        print(*line, sep=" | ")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
