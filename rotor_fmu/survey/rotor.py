"""The survey's runs of the rig: its run-down, perturbed, and cycles of the false state planted."""

from __future__ import annotations

import math
import time
from pathlib import Path

import numpy as np

from model import false_state, one_axis
from model.assembly import assemble
from model.excitation import Spin
from model.rotor_toml import rig, rig_toml
from model.schemes import Scheme, chung_hulbert, generalized_alpha
from model.settings import Settings
from model.simulation import Simulation, StepFailure
from model.step import Motion, residual

from ..run_down import PEAKS_AFTER
from ..signals import RUN_DOWN_RATE, RUN_DOWN_SPEED, RUN_DOWN_STOP
from .grid import Experiment, Row
from .sources import source_digest

REPETITIONS = 12
PHASE_STEP = 1e-5  # between perturbed runs, of all unbalances [rad]
WINDOW = 0.04  # communication step, over which amplitudes are compared [s]
# Whole parts of the window, so that each step is as long as it says.
STEPS = tuple(WINDOW / n for n in (10, 14, 20, 28, 40, 56, 80, 112, 160, 226, 400))
REFERENCE = chung_hulbert(0.2), WINDOW / 1600
_REFERENCE_FILE = "run_down.npz"
_DISC = "disc[3]"

SPEEDS = (50.0, 120.0, 160.0, 185.0, 200.0, 220.0, 260.0, 300.0, 400.0)  # of planted cycles [rad/s]
PLANTED_FOR = 1.0  # [s]
_WATCHED = 0.2  # at its end [s]


def is_of_the_rotor(scheme: Scheme) -> bool:
    """Whether the rotor's settings can name it: its beta and gamma are those of its alphas."""
    return scheme == generalized_alpha(scheme.alpha_f, scheme.alpha_m)


def _settings(scheme: Scheme, h: float) -> Settings:
    return Settings("generalized-alpha", alpha_f=scheme.alpha_f, alpha_m=scheme.alpha_m, h=h)


def _simulation(scheme: Scheme, h: float, phase: float, speed: float) -> Simulation:
    rotor = rig()
    for i in range(1, len(rotor.discs) + 1):
        rotor = rotor.with_value(f"disc[{i}].phase", phase)
    settings = _settings(scheme, h)
    return Simulation(rotor, settings, speed=speed, rate=RUN_DOWN_RATE, warn=lambda message: None)


def _ends() -> np.ndarray:
    return WINDOW * np.arange(1, round(RUN_DOWN_STOP / WINDOW) + 1)


def _run_down(simulation: Simulation) -> np.ndarray:
    """Amplitudes of the last disc at the ends of all windows, shape (windows, 2) [m]."""
    names = [simulation.names.index(f"{_DISC}.{axis}_amp") for axis in "xy"]
    amplitudes = []
    for n, t in enumerate(_ends()):
        simulation.advance(t, RUN_DOWN_SPEED + RUN_DOWN_RATE * n * WINDOW)
        amplitudes.append(simulation.observed[names])
    return np.array(amplitudes)


def prepare_run_down(folder: Path) -> None:
    """The converged run that the others are compared with; with it the greatest speed of each
    journal in its clearance, window by window [m/s]."""
    path = folder / _REFERENCE_FILE
    if path.exists():
        return
    scheme, h = REFERENCE
    simulation = _simulation(scheme, h, 0.0, RUN_DOWN_SPEED)
    amplitudes = _run_down(simulation)
    unfinished = path.with_suffix(".part.npz")
    np.savez_compressed(unfinished, amplitudes=amplitudes, impacts=_impact_speeds())
    unfinished.replace(path)


def _impact_speeds() -> np.ndarray:
    """Greatest speed of each journal relative to its housing in each window, shape (windows,
    bearings) [m/s], of a converged run."""
    scheme, _ = REFERENCE
    h = STEPS[-1]
    simulation = _simulation(scheme, h, 0.0, RUN_DOWN_SPEED)
    contacts = simulation.structure.contacts
    n = simulation.structure.M.shape[1]
    parts = round(WINDOW / h / 2)
    greatest = np.zeros((len(_ends()), len(contacts)))
    for i in range(len(greatest)):
        for part in range(1, parts + 1):
            speed = RUN_DOWN_SPEED + RUN_DOWN_RATE * simulation.time
            simulation.advance(WINDOW * (i + part / parts), speed)
            v = simulation.motion.v
            greatest[i] = np.maximum(greatest[i], np.abs(v[contacts.dof] - v[n:]))
    return greatest


def read_reference(folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes [m] and impact speeds [m/s] that `prepare_run_down` left."""
    with np.load(folder / _REFERENCE_FILE) as data:
        return data["amplitudes"], data["impacts"]


def run_down(scheme: Scheme, h: float, case: int, folder: Path) -> Row:
    """One run-down: its amplitudes' error, the false state, the energy made, the work done.

    error: root mean square of the amplitudes' difference from the converged run, over that of the
    converged amplitudes, both axes, t > 2 s.
    """
    reference, _ = read_reference(folder)
    simulation = _simulation(scheme, h, case * PHASE_STEP, RUN_DOWN_SPEED)
    begun = time.process_time()
    try:
        amplitudes = _run_down(simulation)
    except StepFailure as failure:
        return {"status": f"failed at {simulation.time:.4g} s", **_work(simulation, begun)} | (
            _false_state(simulation) if "diverged" not in str(failure) else {}
        )
    late = _ends() > PEAKS_AFTER
    difference = amplitudes[late] - reference[late]
    peaks = amplitudes[late].max(axis=0) / reference[late].max(axis=0) - 1.0
    return {
        "status": "ok" if not simulation.read("solver.trapped") else "false state",
        "error": float(np.sqrt(np.mean(difference**2) / np.mean(reference[late] ** 2))),
        "error_x": float(peaks[0]),
        "error_y": float(peaks[1]),
        **_false_state(simulation),
        "energy_made": simulation.read("energy.residual"),
        **_work(simulation, begun),
    }


def _false_state(simulation: Simulation) -> Row:
    found: Row = {"trapped": simulation.read("solver.trapped") / simulation.read("solver.steps")}
    if found["trapped"]:
        at = simulation.read("solver.trapped_at")
        found |= {"trapped_at": at, "trapped_speed": RUN_DOWN_SPEED + RUN_DOWN_RATE * at}
    return found


def _work(simulation: Simulation, begun: float) -> Row:
    return {
        "steps": simulation.read("solver.steps"),
        "newton": simulation.read("solver.newton"),
        "cpu_s": time.process_time() - begun,
    }


def strongest_cycle(
    scheme: Scheme, h: float
) -> tuple[int, int, one_axis.Axis, false_state.Cycle] | None:
    """Bearing, direction, axis and cycle, of the rig's lasting cycles, that bears the greatest
    load; None where there is none."""
    structure = assemble(rig())
    found = None
    for bearing in range(len(structure.contacts)):
        for direction in (one_axis.X, one_axis.Y):
            axis = one_axis.axis_of(structure, bearing, direction)
            for cycle in false_state.cycles(axis, scheme, h):
                bears = cycle.bears(axis)
                if bears > 0.0 and cycle.is_stable and (found is None or bears > found[0]):
                    found = bears, bearing, direction, axis, cycle
    return found[1:] if found else None


def plant(
    simulation: Simulation, bearing: int, direction: int, cycle: false_state.Cycle, spin: Spin
) -> None:
    """Put a simulation at rest into a cycle of the false state, at its first letter.

    The static load at right angles turns and shortens the chord on which the journal bounces.
    """
    structure = simulation.structure
    axes = [one_axis.axis_of(structure, bearing, d) for d in (one_axis.X, one_axis.Y)]
    axis, other = axes[direction], axes[1 - direction]
    snapshot = simulation.snapshot()
    motion = Motion(*snapshot[: len(Motion._fields)])
    tilt = cycle.tilt(axis.across)
    unit = (1.0, 1j)[direction]
    for array, change in zip(motion, cycle.state, strict=False):
        array += unit * math.cos(tilt) * change
    if direction == one_axis.X:
        lift = math.copysign(axis.clearance * math.sin(tilt), axis.across) - other.rest
        motion.q[:] += 1j * lift * other.static[0]
    loads = np.zeros(len(structure.load_dof), dtype=complex)
    residual(structure, spin, loads, motion, np.zeros(structure.M.shape[1], dtype=complex))
    simulation.restore(snapshot)


def planted(scheme: Scheme, h: float, case: int, folder: Path) -> Row:
    """The strongest predicted cycle planted at one of `SPEEDS`: whether it lasts for a second.

    trapped: share of the last 0.2 s; power: energy made then.
    """
    predicted = strongest_cycle(scheme, h)
    if predicted is None:
        return {"status": "no cycle"}
    bearing, direction, axis, cycle = predicted
    speed = SPEEDS[case]
    simulation = _simulation(scheme, h, 0.0, speed)
    begun = time.process_time()
    plant(simulation, bearing, direction, cycle, Spin(speed, RUN_DOWN_RATE, 0.0))
    row: Row = {
        "bears": cycle.bears(axis),
        "load": float(one_axis.unbalance_loads(simulation.structure, speed)[bearing].max()),
        "power_predicted": cycle.power,
        "word": f"{bearing + 1}{'xy'[direction]}:{cycle.word}",
    }
    try:
        simulation.advance(PLANTED_FOR - _WATCHED, speed)
        before = simulation.read("solver.trapped"), simulation.read("energy.residual")
        steps = simulation.read("solver.steps")
        simulation.advance(PLANTED_FOR, speed + RUN_DOWN_RATE * (PLANTED_FOR - _WATCHED))
    except StepFailure:
        return row | {"status": f"failed at {simulation.time:.4g} s", **_work(simulation, begun)}
    made = simulation.read("energy.residual") - before[1]
    trapped = (simulation.read("solver.trapped") - before[0]) / (
        simulation.read("solver.steps") - steps
    )
    return row | {
        "status": "ok",
        "trapped": trapped,
        "power": made / _WATCHED,
        **_work(simulation, begun),
    }


def _run_down_version() -> str:
    return f"{source_digest('model.simulation')} {rig_toml()} {(PHASE_STEP, WINDOW, REFERENCE)!r}"


def _planted_version() -> str:
    return f"{source_digest('model.simulation', 'model.false_state')} {rig_toml()} {PLANTED_FOR}"


RUN_DOWN = Experiment(
    name="rotor",
    steps=STEPS,
    cases=tuple(f"{i * PHASE_STEP:g} rad" for i in range(REPETITIONS)),
    version=_run_down_version,
    run=run_down,
    takes=is_of_the_rotor,
    prepare=prepare_run_down,
)
PLANTED = Experiment(
    name="planted",
    steps=STEPS,
    cases=tuple(f"{speed:g} rad/s" for speed in SPEEDS),
    version=_planted_version,
    run=planted,
    takes=is_of_the_rotor,
)
