"""The overhung machine whose journal whips itself apart, and its run-down."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.simulation import Simulation

OVERHUNG = Path(__file__).parents[1] / "reference/overhung.toml"


def overhung_machine(**changes):
    """The machine, its bearing changed."""
    rotor = parse_rotor(OVERHUNG.read_text(encoding="utf-8"))
    return rotor.with_parts(Bearing, replace(rotor.bearings[0], **changes))


def run_down(rotor, settings, stop, warn, interval=0.01):
    """From 400 rad/s by 10 rad/s2; the simulation at its end, and the largest amplitude of its
    disc after half a second [m]."""
    sim = Simulation(rotor, settings, speed=400.0, rate=-10.0, warn=warn)
    peak = 0.0
    for t in np.linspace(0.0, stop, round(stop / interval) + 1)[1:]:
        sim.advance(t, 400.0 - 10.0 * sim.time)
        if sim.time > 0.5:
            peak = max(peak, sim.read("disc[1].x_amp"))
    return sim, peak
