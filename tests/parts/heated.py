"""Machines with a heated contact: a run, and the bow that it has reached."""

import cmath

from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

SPEED = 120.0


def bow(sim):
    """The bow of the first heated contact [m], in the shaft's axes."""
    return cmath.rect(sim.read("heated_contact[1].bow"), sim.read("heated_contact[1].bow_angle"))


def run(text, duration, speed=SPEED, settings=None, **options):
    """The simulation of a machine at the end of a run at one speed [rad/s], or torque [N.m]."""
    sim = Simulation(
        parse_rotor(text), settings or choose(), speed=speed, warn=lambda _: None, **options
    )
    sim.advance(duration, options.get("drive_torque", speed))
    return sim
