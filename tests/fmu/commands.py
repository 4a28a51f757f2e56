"""The commands of host.c through FMPy: python commands.py FMU < COMMANDS"""

import sys

import fmpy


def logger(environment, name, status, category, message):
    print("log", status, " ".join(message.decode().split()), flush=True)


class Host:
    """An FMU and what can be done with it, by the names of the commands."""

    def __init__(self, fmu):
        self.folder = fmpy.extract(fmu)
        self.description = fmpy.read_model_description(self.folder)
        self.fmu = None

    def instantiate(self):
        self.fmu = fmpy.instantiate_fmu(
            self.folder, self.description, "CoSimulation", debug_logging=True, logger=logger
        )

    def setup(self, t):
        self.fmu.setupExperiment(startTime=float(t))

    def enter(self):
        self.fmu.enterInitializationMode()

    def exit(self):
        self.fmu.exitInitializationMode()

    def real(self, vr, value):
        self.fmu.setReal([int(vr)], [float(value)])

    def integer(self, vr, value):
        self.fmu.setInteger([int(vr)], [int(value)])

    def step(self, t, h):
        self.fmu.doStep(float(t), float(h))

    def get(self, vr):
        return self.fmu.getReal([int(vr)])[0]

    def reset(self):
        self.fmu.reset()

    def terminate(self):
        self.fmu.terminate()

    def free(self):
        if self.fmu is not None:
            self.fmu.freeInstance()
            self.fmu = None

    def call(self, name, *arguments):
        """Carry out one command; its status and, of `get`, the value."""
        if self.fmu is None and name not in ("instantiate", "free"):
            return (3,)
        try:
            value = getattr(self, name)(*arguments)
        except fmpy.fmi1.FMICallException as error:
            return (error.status,)
        except Exception:  # of instantiate, which FMPy raises for want of a status
            return (4,)
        return (0,) if value is None else (0, f"{value:.17g}")


if __name__ == "__main__":
    host = Host(sys.argv[1])
    for line in sys.stdin:
        words = line.split()
        print(words[0], *host.call(*words), flush=True)
