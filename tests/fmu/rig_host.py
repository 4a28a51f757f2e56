"""A host of the rig's FMU that calls an instance of either skin by the names of variables."""

from rotor_fmu.model.machine.toml import rig

from rotor_fmu.fmi.interface import interface

H = 0.01
TABLE = interface(rig())
AT = {variable.name: i for i, variable in enumerate(TABLE)}


class Host:
    """An instance, and shorter ways to call it."""

    def __init__(self, fmu):
        self.fmu = fmu

    def set(self, name, value):
        self.fmu.set(TABLE[AT[name]].kind, [AT[name]], [value])
        return self

    def get(self, name):
        return self.fmu.get(TABLE[AT[name]].kind, [AT[name]])[0]

    def start(self, t=0.0, stop=None, tolerance=None):
        self.fmu.setup(t, stop, tolerance)
        return self.initialize()

    def initialize(self):
        self.fmu.enter()
        self.fmu.exit()
        return self

    def steps(self, t, count, h=H):
        for i in range(count):
            self.fmu.step(t + i * h, h)
        return self

    @property
    def warnings(self):
        return self.fmu.warnings
