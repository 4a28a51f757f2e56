"""This project's runs of drawn machines, beside CVODE's."""

import math
from dataclasses import dataclass

import numpy as np
from rotor_fmu.model.message_templates import Message
from rotor_fmu.model.settings import Settings
from rotor_fmu.model.simulation import StepFailure

from papers.integrators.tolerances import TAME, TOLERANCES
from rotor_fmu.run_status import DOUBTFUL, status_of

from .machines import Case
from .truth import Truth

# An orbit is within so many tolerances, times 1 + condition; and the largest displacement of a
# machine with a condition below TAME within a share, at each of the tolerances.
PROMISED = 10.0
OF_THE_MACHINE = ("burst-speed", "not-laminar")  # doubts about a drawn machine, not its numbers
PEAKS = dict(zip(TOLERANCES, (0.1, 0.02, 0.005), strict=True))


@dataclass(frozen=True)
class Judged:
    """A run against CVODE's: status; relative errors of the largest displacement and, at the worst
    time, of the displacement's size and place (`orbit`), of the largest displacement [1]; the
    largest error of its direction, weighed by its size [rad]."""

    status: str
    peak: float
    amplitude: float
    phase: float
    orbit: float


def judged(case: Case, truth: Truth, settings: Settings) -> Judged:
    """Run a case and hold it against the truth, as far as it comes."""
    status, orbit = ran(case, settings)
    return Judged(status, *errors(orbit, truth.orbit[: len(orbit)]))


def ran(case: Case, settings: Settings) -> tuple[str, np.ndarray]:
    """Status of a run, and the node's way from its start as far as it comes [m]."""
    said: list[Message] = []
    sim = case.simulation(settings, warn=said.append)
    at = 2 * (case.node - 1)
    origin, status = complex(sim.motion.q[at]), ""
    seen = [0j]
    for i in range(1, len(case.times)):
        try:
            case.advance(sim, i)
        except StepFailure as failure:
            status = str(failure)
            break
        seen.append(complex(sim.motion.q[at]) - origin)
    about_numbers = (message for message in said if message.code not in OF_THE_MACHINE)
    return status or status_of(about_numbers), np.array(seen)


def errors(orbit: np.ndarray, exact: np.ndarray) -> tuple[float, float, float, float]:
    """Of the largest displacement, of the size, of the direction, of the place; see `Judged`."""
    size = float(np.abs(exact).max()) or 1.0
    turned = np.angle(orbit * exact.conj()) * np.minimum(np.abs(orbit), np.abs(exact))
    return (
        abs(float(np.abs(orbit).max()) / size - 1),
        float(np.abs(np.abs(orbit) - np.abs(exact)).max()) / size,
        float(np.abs(turned).max()) / size,
        float(np.abs(orbit - exact).max()) / size,
    )


def is_kept(run: Judged, tolerance: float, condition: float) -> bool:
    """Whether a run that says nothing keeps the promise; any that says something does."""
    return run.status != "ok" or _is_right(run, tolerance, condition)


def is_false_alarm(run: Judged, tolerance: float, condition: float) -> bool:
    """Whether a run that is as near as is promised is called doubtful."""
    return run.status.startswith(DOUBTFUL) and _is_right(run, tolerance, condition)


def _is_right(run: Judged, tolerance: float, condition: float) -> bool:
    is_near = run.orbit <= PROMISED * tolerance * (1 + condition)
    return is_near and (run.peak <= PEAKS[tolerance] or condition >= TAME or math.isnan(condition))
