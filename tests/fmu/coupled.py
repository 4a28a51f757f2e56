"""The rotor and a motor, coupled by a master of our own: what other masters must give as well."""

import csv
import io
from itertools import accumulate, pairwise

from ..processes import run_python
from .instance import Machine

H, STEPS = 0.002, 100
# Begin and length of the steps: summed up, and as differences of times that count nanoseconds.
SUMMED = [(t, H) for t in accumulate([H] * (STEPS - 1), initial=0.0)]
COUNTED = [(a / 1e9, b / 1e9 - a / 1e9) for a, b in pairwise(range(0, 202_000_000, 2_000_000))]
TOLERANCE = 1e-3  # of CoFMPy, for every input in its own unit
TRANSFER = {"rotor": ("tau", "motor", "tau"), "motor": ("w", "rotor", "speed")}
SEEN = ("w", "phi", "tau", "disc[3].x", "disc[3].y")


class Part(Machine):
    """One of the two FMUs, with what it is given before each step."""

    def __init__(self, fmu, **inputs):
        super().__init__(fmu)
        self.inputs = inputs

    def get(self, name):
        return self.read([name])[0]


def march(
    rotor,
    motor,
    order,
    algorithm,
    iterations=1,
    steps=SUMMED,
    settings=None,
    is_told_at_start=False,
):
    """What SEEN names of the rotor after every step, for a co-simulation from w = 150 rad/s.

    algorithm: jacobi (both step from the same inputs) or gauss_seidel (in `order`); with more than
    one iteration both are set back and repeat the step until no input changes by TOLERANCE.
    steps: begin and length of each; settings: Integers of the rotor; is_told_at_start: outputs are
    passed on before the first step.
    """
    parts = {"rotor": Part(rotor, speed=150.0), "motor": Part(motor, tau=0.0)}
    for part, choices in ((parts["motor"], {}), (parts["rotor"], settings or {})):
        part.start(choices, **part.inputs)
    if is_told_at_start:
        for name in order:
            transfer(parts, name, parts[name].get(TRANSFER[name][0]))
    rows = []
    for t, h in steps:
        states = {}
        for _ in range(iterations):
            before = {name: dict(part.inputs) for name, part in parts.items()}
            outputs = {}
            for name in order:
                part = parts[name]
                if name in states:
                    part.fmu.setFMUstate(states[name])
                elif iterations > 1:
                    states[name] = part.fmu.getFMUstate()
                part.set(**part.inputs)
                part.fmu.doStep(t, h)
                outputs[name] = part.get(TRANSFER[name][0])
                if algorithm == "gauss_seidel":
                    transfer(parts, name, outputs[name])
            for name in order:
                transfer(parts, name, outputs[name])
            change = [abs(outputs[n] - before[t][i]) for n, (_, t, i) in TRANSFER.items()]
            if max(change) < TOLERANCE:
                break
        rows.append([parts["rotor"].get(name) for name in SEEN])
    return rows


def transfer(parts, name, value):
    _, target, variable = TRANSFER[name]
    parts[target].inputs[variable] = value


def last_row(script, *arguments):
    """What a script of the examples prints last, by name."""
    done = run_python(script, *arguments)
    assert done.returncode == 0, done.stderr
    row = list(csv.DictReader(io.StringIO(done.stdout)))[-1]
    return {name: float(value) for name, value in row.items()}


def through_libcosim(folder, system, stop, shown):
    """What libcosim tells at `stop` [s] of the variables `shown` of a system laid out in a folder,
    from the file `system`."""
    script = folder / "with_libcosim.py"
    return last_row(script, str(folder / system), str(stop), str(stop), *shown)
