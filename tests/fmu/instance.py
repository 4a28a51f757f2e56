"""An FMU at work through FMPy, FMI 2.0 or 3.0, beside the `Simulation` that it must equal bit for
bit."""

import fmpy
import numpy as np


class Machine:
    """An instance with its variables by name."""

    def __init__(self, fmu, folder=None):
        self.folder = folder or fmpy.extract(str(fmu))
        self.description = fmpy.read_model_description(self.folder)
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables}
        self.computed = [
            v.name
            for v in self.description.modelVariables
            if v.causality in ("output", "local") and v.type in ("Real", "Float64")
        ]
        self.fmu = fmpy.instantiate_fmu(self.folder, self.description, "CoSimulation")
        self.is_fmi3 = self.description.fmiVersion.startswith("3")
        self.t = 0.0

    def set(self, **values):
        for name, value in values.items():
            if self.is_fmi3:
                self.fmu.setFloat64([self.refs[name]], [value])
            else:
                self.fmu.setReal([self.refs[name]], [value])

    def start(self, choices=(), **values):
        """Initialize with Reals and, in `choices`, Integers."""
        self.set(**values)
        for name, value in dict(choices).items():
            set_integer = self.fmu.setInt32 if self.is_fmi3 else self.fmu.setInteger
            set_integer([self.refs[name]], [value])
        if self.is_fmi3:
            self.fmu.enterInitializationMode(startTime=0.0)
        else:
            self.fmu.setupExperiment(startTime=0.0)
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def step(self, h):
        self.fmu.doStep(self.t, h)
        self.t += h

    def read(self, names=None):
        references = [self.refs[name] for name in names or self.computed]
        get = self.fmu.getFloat64 if self.is_fmi3 else self.fmu.getReal
        return np.array(get(references))

    def close(self):
        self.fmu.freeInstance()


def observed(simulation, names):
    return np.array([simulation.read(name) for name in names])
