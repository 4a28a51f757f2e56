"""What `test_new_part` runs in a copy of the package that knows two parts more."""

import json
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
from rotor_fmu.model.linear import supports
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.linear.unbalance_peaks import gaps
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.cubic_spring import CUBIC
from rotor_fmu.model.parts.law import Kinematics, Weights
from rotor_fmu.model.periodic.laws import LawsAlongMotion
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.description import Described
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.documents import documents

TOML = Path(sys.argv[1]).read_text()
STOP = "\n[[elastic_stop]]\nnode = 2\nroom = 3e-4\nstiffness = 1e7\n"
SPEED, DURATION = 180.0, 0.02


def input_error(text):
    try:
        parse_rotor(text)
    except QuantityError as error:
        return str(error)
    return ""


def run(steps):
    """Displacement at the end [m], residual of the ledger and what was dissipated [J]."""
    settings = choose("robust", method="newmark", h=DURATION / steps)
    sim = Simulation(parse_rotor(TOML), settings, speed=SPEED, warn=lambda message: None)
    sim.advance(DURATION, SPEED)
    x = sim.read("disc[1].x") + 1j * sim.read("disc[1].y")
    losses = [sim.read(f"energy.{name}_loss") for name in ("structure", "housing", "cubic")]
    return x, sim.read("energy.residual"), sum(losses), sim.read("energy.cubic")


def derivative(record, d, d_dot, dz, by_d, by_v, size=1e-9):
    """Central difference of the force along by_d dz, by_v dz."""

    def force(side):
        moved = d + side * size * by_d * dz, d_dot + side * size * by_v * dz
        return CUBIC.force(record, (), Kinematics(*moved, 0.0, 0.0, 0.0), ())

    return (force(1) - force(-1)) / (2 * size)


record = np.array([(4e12, 25.0)], CUBIC.dtype).view(np.recarray)[0]
d, d_dot, dz = 3e-4 - 2e-4j, 0.1 + 0.3j, 0.6 + 0.8j
_, p, q = CUBIC.tangent(
    record, (), Kinematics(d, d_dot, 0.0, 0.0, 0.0), Weights(1.0, 0.02, 0.0), (), ()
)
linear = derivative(record, d, d_dot, dz, 1.0, 0.02)
runs = [run(steps) for steps in (40, 80, 160)]
stopped = LinearMachine(parse_rotor(TOML + STOP))
walls = LawsAlongMotion(stopped.structure, stopped.structure.interfaces.has_wall == 1)
moved = np.array([[1e-4, 0.0], [0.0, -4e-4]])
variables = interface(parse_rotor(TOML))
files = documents(Described(parse_rotor(TOML), "RotorBearing", needs_python=True), variables, fmi=2)
seen = {
    "tangent": abs(p * dz + q * dz.conjugate() - linear) / abs(linear),
    "x": [abs(b[0] - a[0]) for a, b in pairwise(runs)],
    "residual": [abs(r[1]) for r in runs],
    "loss": runs[-1][2],
    "stored": runs[-1][3],
    "table": {v.name: [v.causality, v.unit, v.text] for v in variables},
    "misspelt": input_error(TOML.replace("cubic = ", "cubik = ")),
    "impossible": input_error(TOML.replace("4e12", "-4e12")),
    "clearances": [
        (gap.name, gap.clearance) for gap in gaps(stopped, supports.walls(stopped.rotor))
    ],
    "corners": walls.corner_gaps(moved, 0.0 * moved)[:, 0].tolist(),
    "rolling": len(walls.rubbing),
    "page": files["documentation/index.html"].decode(),
}
print(json.dumps(seen))
