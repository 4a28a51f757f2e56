"""Machines drawn at random, and what CVODE finds of them.

CVODE (SUNDIALS) solves the equations of `benchmarks.equations`, which share the matrices with this
project and nothing of its time integration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.settings import Settings, choose
from rotor_fmu.model.simulation import Simulation, StepFailure
from sksundae.cvode import CVODE

from benchmarks import equations

from .whip import overhung_machine

TIMES = np.linspace(0.0, 0.3, 151)  # [s]
# Some machines stand on the edge between a whip and none: a peak is right that CVODE finds with an
# unbalance between these multiples of the true one.
UNBALANCES = (1.0, 0.99, 1.01)
ATOL = 1e-4  # displacements below it [m] are known to as much as it is, relative to it


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
    """A run of a machine beside CVODE's: status; error of the disc's largest displacement beyond
    what `UNBALANCES` make of it, relative to it [1]; of its orbit, relative to clearance and
    largest displacement [1]."""

    status: str
    peak: float
    orbit: float


def by_cvode(rotor: Rotor, speed: float) -> np.ndarray:
    """The disc's orbits from rest with all `UNBALANCES`, shape (unbalances, times) [m]."""
    varied = (
        rotor.with_parts(Disc, *(replace(disc, e=factor * disc.e) for disc in rotor.discs))
        for factor in UNBALANCES
    )
    return np.array([_orbit(one, speed) for one in varied])


def _orbit(rotor: Rotor, speed: float, rtol: float = 1e-8) -> np.ndarray:
    at_rest = Simulation(rotor, speed=speed, warn=lambda message: None).motion
    machine = equations.equations(rotor, speed, 0.0)
    coefficients = machine.coefficients
    solver = CVODE(
        lambda t, state, out: equations.slope(t, state, out, coefficients),
        jacfn=lambda t, state, _, out: equations.jacobian(t, state, out, coefficients),
        rtol=rtol,
        atol=np.repeat([ATOL * rtol, 1e3 * ATOL * rtol], machine.size),
        max_num_steps=10**8,
    )
    orbit = machine.disc(solver.solve(TIMES, equations.real_state(at_rest.q, at_rest.v)).y)
    return orbit - orbit[0]


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
        max(0.0, 1 - peak / least, peak / most - 1),
        np.abs(orbit - truth).max() / (rotor.bearings[0].clearance + size),
    )


def main(count: int = 50) -> None:
    """Print errors over the population: median and worst, orbits in multiples of the tolerance."""
    cases = [machine(seed) for seed in range(count)]
    truths = [by_cvode(*case) for case in cases]
    for name, settings in (
        *((f"tolerance {tol:g}", choose(tolerance=tol)) for tol in (1e-2, 1e-3, 1e-4)),
        ("robust", choose("robust")),
    ):
        runs = [judged(*c, settings, truth) for c, truth in zip(cases, truths, strict=True)]
        ok = [run for run in runs if run.status == "ok"]
        peaks = np.array([run.peak for run in ok])
        orbits = np.array([run.orbit for run in ok]) / settings.tolerance
        print(
            f"{name}: {len(ok)} of {count} ok; peak off by {100 * np.median(peaks):.2g} % "
            f"(median), {100 * peaks.max():.2g} % (worst); orbit by {np.median(orbits):.2g} and "
            f"{orbits.max():.2g} tolerances; {np.sum(peaks > 0.1)} above 10 %, "
            f"{np.sum(peaks > 0.01)} above 1 %",
            flush=True,
        )


if __name__ == "__main__":
    main()
