"""The survey's run-downs of the rig: converged, perturbed, in the false state."""

import time
from pathlib import Path

import numpy as np
from rotor_fmu.model.machine.toml import rig, rig_toml
from rotor_fmu.model.settings import Settings
from rotor_fmu.model.simulation import Simulation, StepFailure

from papers.dense_machine import clearance_contacts
from papers.integrators.members import Scheme, chung_hulbert, generalized_alpha
from rotor_fmu.files import unfinished

from .grid import Experiment, Row
from .sources import file_digest, source_digest

# Paper A's run-down: 400 - 10 t rad/s, over 40 s.
RUN_DOWN_SPEED, RUN_DOWN_RATE, RUN_DOWN_STOP = 400.0, -10.0, 40.0
REPETITIONS = 12
PHASE_STEP = 1e-5  # between perturbed runs, of all unbalances [rad]
WINDOW = 0.04  # communication step, over which amplitudes are compared [s]
# Whole parts of the window, so that each step is as long as it says.
STEPS = tuple(WINDOW / n for n in (10, 14, 20, 28, 40, 56, 80, 112, 160, 226, 400))
REFERENCE = chung_hulbert(0.2), WINDOW / 1600
_START_UP = 2.0  # whose amplitudes are not compared [s]
_REFERENCE_FILE = "run_down.npz"
_DISC = "disc[3]"


def is_of_the_rotor(scheme: Scheme) -> bool:
    """Whether the rotor's settings can name it: its beta and gamma are those of its alphas."""
    return scheme == generalized_alpha(scheme.alpha_f, scheme.alpha_m)


def _settings(scheme: Scheme, h: float) -> Settings:
    return Settings("generalized-alpha", alpha_f=scheme.alpha_f, alpha_m=scheme.alpha_m, h=h)


def perturbed(scheme: Scheme, h: float, phase: float, speed: float) -> Simulation:
    """The rig at rest, at `speed` [rad/s] and running down, its unbalances turned by `phase`
    [rad]; steps of h [s]."""
    rotor = rig()
    for i in range(1, len(rotor.discs) + 1):
        rotor = rotor.with_value(f"disc[{i}].phase", phase)
    settings = _settings(scheme, h)
    return Simulation(rotor, settings, speed=speed, rate=RUN_DOWN_RATE, warn=lambda message: None)


def _ends() -> np.ndarray:
    return WINDOW * np.arange(1, round(RUN_DOWN_STOP / WINDOW) + 1)


def _run_down(simulation: Simulation) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes of the last disc at the ends of all windows, shape (windows, 2) [m], and the steps
    in the false state up to there, shape (windows,)."""
    names = [simulation.names.index(f"{_DISC}.{axis}_amp") for axis in "xy"]
    trapped = simulation.names.index("solver.trapped")
    seen = []
    for n, t in enumerate(_ends()):
        simulation.advance(t, RUN_DOWN_SPEED + RUN_DOWN_RATE * n * WINDOW)
        seen.append(simulation.observed[[*names, trapped]])
    amplitudes_and_count = np.array(seen)
    return amplitudes_and_count[:, :2], amplitudes_and_count[:, 2]


def prepare_run_down(folder: Path) -> None:
    """The converged run that the others are compared with; with it the greatest speed of each
    journal in its clearance, window by window [m/s]."""
    path = folder / _REFERENCE_FILE
    if path.exists():
        return
    scheme, h = REFERENCE
    simulation = perturbed(scheme, h, 0.0, RUN_DOWN_SPEED)
    amplitudes, _ = _run_down(simulation)
    with unfinished(path) as part:
        np.savez_compressed(part, amplitudes=amplitudes, impacts=_impact_speeds())


def _impact_speeds() -> np.ndarray:
    """Greatest speed of each journal relative to its housing in each window, shape (windows,
    bearings) [m/s], of a converged run."""
    scheme, _ = REFERENCE
    h = STEPS[-1]
    simulation = perturbed(scheme, h, 0.0, RUN_DOWN_SPEED)
    contacts = clearance_contacts(simulation.structure)
    parts = round(WINDOW / h / 4)
    greatest = np.zeros((len(_ends()), len(contacts)))
    for i in range(len(greatest)):
        for part in range(1, parts + 1):
            speed = RUN_DOWN_SPEED + RUN_DOWN_RATE * simulation.time
            simulation.advance(WINDOW * (i + part / parts), speed)
            v = simulation.motion.v
            greatest[i] = np.maximum(greatest[i], np.abs(v[contacts.dof] - v[contacts.end]))
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
    reference, impacts = read_reference(folder)
    simulation = perturbed(scheme, h, case * PHASE_STEP, RUN_DOWN_SPEED)
    begun = time.process_time()
    try:
        amplitudes, trapped = _run_down(simulation)
    except StepFailure as failure:
        how = "diverged" if "diverged" in str(failure) else "stalled"
        return {"status": f"{how} at {simulation.time:.4g} s", **work_of(simulation, begun)}
    late = _ends() > _START_UP
    difference = amplitudes[late] - reference[late]
    peaks = amplitudes[late].max(axis=0) / reference[late].max(axis=0) - 1.0
    return {
        "status": "ok" if not simulation.read("solver.trapped") else "false state",
        "error": float(np.sqrt(np.mean(difference**2) / np.mean(reference[late] ** 2))),
        "error_x": float(peaks[0]),
        "error_y": float(peaks[1]),
        **_false_state(simulation, trapped),
        "energy_made": simulation.read("energy.residual"),
        "impact_speed": float(impacts.max()),
        **work_of(simulation, begun),
    }


def _false_state(simulation: Simulation, trapped: np.ndarray) -> Row:
    result: Row = {"trapped": float(trapped[-1]) / simulation.read("solver.steps")}
    if trapped[-1]:
        at = simulation.read("solver.trapped_at")
        last = _ends()[np.flatnonzero(np.diff(trapped, prepend=0.0))[-1]]
        result["trapped_at"] = at
        result["trapped_speed"] = RUN_DOWN_SPEED + RUN_DOWN_RATE * at
        result["trapped_until"] = RUN_DOWN_SPEED + RUN_DOWN_RATE * float(last)
    return result


def work_of(simulation: Simulation, begun: float) -> Row:
    """Steps, Newton iterations and the CPU time since `begun` [s]."""
    return {
        "steps": simulation.read("solver.steps"),
        "newton": simulation.read("solver.newton"),
        "cpu_s": time.process_time() - begun,
    }


def _version() -> str:
    return f"{source_digest('rotor_fmu.model.simulation')} {file_digest(__file__)} {rig_toml()}"


RUN_DOWN = Experiment(
    name="rotor",
    steps=STEPS,
    cases=tuple(f"{i * PHASE_STEP:g} rad" for i in range(REPETITIONS)),
    version=_version,
    run=run_down,
    takes=is_of_the_rotor,
    prepare=prepare_run_down,
)
