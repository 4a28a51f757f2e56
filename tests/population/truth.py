"""What CVODE finds of a drawn machine, and how much it depends on what nobody knows exactly.

CVODE (SUNDIALS) solves the equations of `tests.parts.equations`, which share the matrices of shaft
and bodies with this project and nothing else.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from sksundae.cvode import CVODE

from ..parts.equations import Equations
from .machines import SAMPLES, Case, drawn

RTOL = 1e-9
SLIGHTLY = 1e-5  # relative change of the start, the unbalance and the speed
KEPT = (0, 3, 7, 23)  # machines whose truth is written down, which takes CVODE a minute
_FILE = Path(__file__).parents[1] / "reference" / "drawn_truths.json"


@dataclass(frozen=True)
class Truth:
    """The orbit of the node that is looked at, from where it starts, at the times, complex [m];
    condition: its largest change, relative to its size, by a relative change of start, unbalance
    or speed, over that [1]."""

    orbit: np.ndarray
    condition: float

    @property
    def size(self) -> float:
        """Largest displacement from the start [m]."""
        return float(np.abs(self.orbit).max())


def truth(case: Case, rtol: float = RTOL) -> Truth:
    """CVODE's orbit of a case and its condition."""
    exact = orbit(case, rtol)
    size = np.abs(exact).max()
    changed = (
        orbit(case, rtol, shift=SLIGHTLY * size),
        orbit(case, rtol, unbalance=1 + SLIGHTLY),
        orbit(case, rtol, faster=1 + SLIGHTLY),
    )
    largest = max(float(np.abs(other - exact).max()) for other in changed)
    return Truth(exact, largest / (SLIGHTLY * size))


def keep() -> None:
    """Write down the truth of the machines of `KEPT`."""
    made = {}
    for seed in KEPT:
        exact = truth(drawn(seed))
        places = [[float(f"{x:.9g}") for x in (z.real, z.imag)] for z in exact.orbit.tolist()]
        made[seed] = {"condition": float(f"{exact.condition:.6g}"), "orbit": places}
    lines = (f'"{seed}": {json.dumps(each)}' for seed, each in made.items())
    _FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def kept(seed: int) -> Truth:
    """The truth of one of these machines as it was written down."""
    made = json.loads(_FILE.read_text(encoding="utf-8"))[str(seed)]
    return Truth(np.array(made["orbit"]) @ [1, 1j], made["condition"])


def orbit(
    case: Case,
    rtol: float,
    *,
    shift: float = 0.0,
    unbalance: float = 1.0,
    faster: float = 1.0,
) -> np.ndarray:
    """The node's way from its start at the angles of rotation that belong to the times.

    shift: of the rotor at the start [m]; unbalance, faster: factors of the unbalance and of the
    speed, and of that with which the foundation moves.
    """
    equations = Equations(
        case.rotor,
        faster * case.speed,
        faster**2 * case.rate,
        unbalance,
        case.base,
        case.stop / SAMPLES / faster,
    )
    start = case.simulation(warn=lambda message: None).motion
    n = equations.size
    q, v = start.q[:n].copy(), start.v[:n]
    at = 2 * (case.node - 1)
    origin = q[at]
    q[: 2 * len(case.rotor.nodes) : 2] += shift
    state = np.concatenate([q.real, q.imag, v.real, v.imag, np.zeros(len(equations.walls))])
    floor = 1e-8 * max(abs(origin), 1e-6)
    atol = np.repeat(
        [floor * rtol * 1e2, floor * rtol * 1e5, rtol], [2 * n, 2 * n, len(equations.walls)]
    )
    solver = CVODE(equations.slope, rtol=rtol, atol=atol, max_num_steps=10**8)
    y = solver.solve(case.times / faster, state).y
    return y[:, at] + 1j * y[:, n + at] - origin


if __name__ == "__main__":
    keep()
