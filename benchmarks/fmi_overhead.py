"""What FMI adds to a communication step: python -m benchmarks.fmi_overhead

Set all inputs, a step of 0.1 ms, read all outputs, through FMPy's API and, of the native FMU, from
C; beside it the model's own call, and FMUs with as many variables that compute nothing. Medians of
CPU time.
"""

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import fmpy
import numpy as np
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build

from .native_master import CMaster, medians

H, STEPS, REPETITIONS = 1e-4, 5000, 7
SPEED = 400.0
IDLE = """
from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

class Idle(Fmi2Slave):
    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        for name in {inputs}:
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.input))
        for name in {outputs}:
            setattr(self, name, 0.0)
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        for name in {flags}:
            setattr(self, name, False)
            self.register_variable(
                Boolean(name, causality=Fmi2Causality.output, variability=Fmi2Variability.discrete)
            )
    def set_real(self, references, values):
        pass
    def get_real(self, references):
        return [0.0] * len(references)
    def get_boolean(self, references):
        return [False] * len(references)
    def do_step(self, t, h):
        return True
"""


def median_cost(call):
    """CPU time of call(t) in microseconds."""
    costs, n = [], 0
    for _ in range(REPETITIONS):
        begun = time.process_time()
        for _ in range(STEPS):
            call(n * H)
            n += 1
        costs.append((time.process_time() - begun) / STEPS * 1e6)
    return statistics.median(costs)


def variables(fmu, kind, causality):
    """References of the variables of an FMU, or of its folder."""
    described = fmpy.read_model_description(str(fmu)).modelVariables
    return [v.valueReference for v in described if v.type == kind and v.causality == causality]


def through_fmpy(fmu):
    """Cost of a communication step [us]."""
    folder = str(fmu) if fmu.is_dir() else fmpy.extract(str(fmu))
    instance = fmpy.instantiate_fmu(folder, fmpy.read_model_description(folder), "CoSimulation")
    inputs, outputs = variables(fmu, "Real", "input"), variables(fmu, "Real", "output")
    flags = variables(fmu, "Boolean", "output")
    values = [SPEED] + [0.0] * (len(inputs) - 1)
    instance.setupExperiment(startTime=0.0)
    instance.enterInitializationMode()
    instance.exitInitializationMode()

    def step(t):
        instance.setReal(inputs, values)
        instance.doStep(t, H)
        instance.getReal(outputs)
        instance.getBoolean(flags)

    return median_cost(step)


def idle_fmu(like, folder):
    """An FMU with as many variables as another that computes nothing."""
    counts = {
        "inputs": ("u", len(variables(like, "Real", "input"))),
        "outputs": ("y", len(variables(like, "Real", "output"))),
        "flags": ("b", len(variables(like, "Boolean", "output"))),
    }
    names = {key: [f"{letter}{i}" for i in range(n)] for key, (letter, n) in counts.items()}
    script = folder / "idle.py"
    script.write_text(IDLE.format(**names))
    command = [sys.executable, "-m", "pythonfmu", "build", "-f", str(script), "-d", str(folder)]
    subprocess.run(command, check=True, capture_output=True, cwd=folder)
    return folder / "Idle.fmu"


def model_alone():
    """Cost of the model's own call [us]."""
    sim = Simulation(rig(), choose(), speed=SPEED)
    loads = np.zeros(len(sim.structure.load_dof), dtype=complex)
    return median_cost(lambda t: sim.advance(t + H, SPEED, loads))


def table(title, rows):
    """Print rows of a text and us."""
    print(f"| {title} | us of CPU |\n| --- | ---: |")
    for text, cost in rows:
        print(f"| {text} | {cost:.2f} |")
    print()


def main():
    with tempfile.TemporaryDirectory() as name:
        fmu, master = build(Path(name), machine_of()), CMaster(Path(name))
        hosted, model = through_fmpy(fmu), model_alone()
        idle = through_fmpy(idle_fmu(fmu, Path(name)))
        idle_native = master.idle_fmu()
        native, nothing, from_c, kernels = medians(
            REPETITIONS,
            lambda: through_fmpy(master.fmu),
            lambda: through_fmpy(idle_native),
            lambda: master.run("steps"),
            lambda: master.run("kernels"),
        )
    table(
        "`RotorBearing.fmu`, a communication step of 0.1 ms",
        (
            ("through FMPy", hosted),
            ("the model's own call", model),
            ("so FMI adds", hosted - model),
            ("an FMU of pythonfmu that computes nothing", idle),
        ),
    )
    table(
        "`RotorBearingNative.fmu`, a communication step of 0.1 ms",
        (
            ("the kernels alone, from C", kernels),
            ("through FMI, from C", from_c),
            ("so FMI adds from C", from_c - kernels),
            ("through FMPy", native),
            ("an FMU in C that computes nothing, through FMPy", nothing),
            ("so FMI adds from FMPy, beyond FMPy's own", native - nothing - kernels),
        ),
    )


if __name__ == "__main__":
    main()
