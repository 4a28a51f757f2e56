"""A machine's FMU driven through FMPy, with values by name in SI units."""

import shutil

import fmpy
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation


class Machine:
    """An FMU, extracted once; every `start` is an instance of its own."""

    def __init__(self, fmu):
        self.folder = fmpy.extract(str(fmu))
        self.description = fmpy.read_model_description(self.folder)
        self.known = {v.name: v for v in self.description.modelVariables}

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)

    def start(self, **values):
        """An instance that begins with these values; in names `__` stands for a dot, and what is
        called in a dictionary `at` is taken as it is. tolerance: of the experiment."""
        return Running(self, values.pop("tolerance", None), values)


class Running:
    """An instance at work."""

    def __init__(self, machine, tolerance, values):
        self.known, self.time = machine.known, 0.0
        self.fmu = fmpy.instantiate_fmu(machine.folder, machine.description, "CoSimulation")
        values = {**values.pop("at", {}), **values}
        for name, value in values.items():
            self.set(name.replace("__", "."), value)
        self.fmu.setupExperiment(startTime=0.0, tolerance=tolerance)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def set(self, name, value):
        variable = self.known[name]
        if variable.type == "Real":
            self.fmu.setReal([variable.valueReference], [value])
        else:
            self.fmu.setInteger([variable.valueReference], [value])

    def advance(self, to):
        """Step to a time [s]."""
        self.fmu.doStep(self.time, to - self.time)
        self.time = to

    def read(self, *names):
        """Values of variables: one alone, or a list."""
        values = [self._value(self.known[name]) for name in names]
        return values[0] if len(values) == 1 else values

    def _value(self, variable):
        get = self.fmu.getBoolean if variable.type == "Boolean" else self.fmu.getReal
        return get([variable.valueReference])[0]

    def __enter__(self):
        return self

    def __exit__(self, *reason):
        self.fmu.freeInstance()


def of_both(machine_of, text, names, speed, step=0.01):
    """Values of variables of a machine in TOML at a speed [rad/s], after each of five steps [s]: of
    its FMU, and of its simulation."""
    settings = choose("controlled", tolerance=1e-3)
    simulation = Simulation(parse_rotor(text), settings, speed=speed, warn=lambda _: None)
    of_fmu, of_simulation = [], []
    with machine_of(text).start(speed=speed, tolerance=1e-3) as run:
        for i in range(1, 6):
            run.advance(step * i)
            simulation.advance(step * i, speed)
            of_fmu.append(run.read(*names))
            of_simulation.append([simulation.read(name) for name in names])
    return of_fmu, of_simulation
