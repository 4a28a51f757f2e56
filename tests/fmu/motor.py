"""A partner for the rotor, as its own FMU: an inertia that drives it and feels its torque."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Fmi2Variability, Real


class Motor(Fmi2Slave):
    """J w' = drive - tau, one explicit Euler step a communication step."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.tau = 0.0
        self.w = 150.0
        self.drive = 0.4
        self.J = 0.02
        self.register_variable(Real("tau", causality=Fmi2Causality.input))
        self.register_variable(Real("w", causality=Fmi2Causality.output))
        for name in ("drive", "J"):
            self.register_variable(
                Real(name, causality=Fmi2Causality.parameter, variability=Fmi2Variability.tunable)
            )

    def do_step(self, current_time, step_size):
        self.w += step_size * (self.drive - self.tau) / self.J
        return True
