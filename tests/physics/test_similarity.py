"""A motion does not depend on the units in which its machine is written: a machine scaled in mass,
length and time moves as the scaled motion (Buckingham's theorem), so that no length, stiffness or
time of its own is hidden in the program."""

import math
from dataclasses import fields, is_dataclass, replace

import pytest
from rotor_fmu.model.quantities import quantities
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.time_loop.recorder import recordable

from rotor_fmu.fmi.variables import unit

from ..machines import overhung
from .test_energy import KINDS

# powers of two, by which products scale without rounding
SCALES = (
    {"kg": 1.0, "m": 1.0, "s": 1.0},
    {"kg": 2.0**-20, "m": 2.0**-10, "s": 2.0**-6},
    {"kg": 2.0**16, "m": 2.0**6, "s": 2.0**4},
)
SECONDS, SPEED, RATE = 1 / 64, 200.0, 64.0
SETTINGS = {
    "fixed": ("robust", {"h": 2e-5}),
    "controlled": ("controlled", {"h": 1e-5, "h_min": 1e-8, "h_max": 2e-3}),
    "stages": ("controlled", {"h": 1e-5, "h_min": 1e-8, "h_max": 2e-3, "method": "radau5"}),
}
TIMES = ("h", "h_min", "h_max")


def scale_of(name, scales):
    """By what a number of this unit grows."""
    head, _, power = name.partition("^")  # N/m^1.5
    above, _, below = head.partition("/")
    if power:
        return scale_of(above, scales) / scale_of(below, scales) ** float(power)
    base = {} if name == "degC" else unit(name).base
    return math.prod(scales.get(of, 1.0) ** exponent for of, exponent in base.items())


def scaled(value, scales):
    """A machine, or something that it consists of, in other units."""
    if isinstance(value, tuple):
        return tuple(scaled(each, scales) for each in value)
    if not is_dataclass(value):
        return value
    new = {field.name: scaled(getattr(value, field.name), scales) for field in fields(value)}
    declared = dict(quantities(value))
    if "specific_heat" in declared:  # here films have one temperature, and these are not used
        del declared["specific_heat"], declared["density"]
    for name, of in declared.items():
        if isinstance(new[name], float):
            new[name] *= scale_of(of.unit, scales)
    return replace(value, **new)


def motion_of(rotor, settings, scales):
    """Everything that a run observes but what the solver says of itself, in the first units."""
    time = scales["s"]
    preset, changes = SETTINGS[settings]
    own = {key: of * time if key in TIMES else of for key, of in changes.items()}
    speed, rate = SPEED / time, RATE / time**2
    sim = Simulation(scaled(rotor, scales), choose(preset, **own), speed=speed, rate=rate)
    sim.advance(SECONDS * time, speed + rate * SECONDS * time)
    units = {str(entry.name): entry.output.unit for entry in recordable(sim.rotor)}
    return {
        name: sim.read(name) / scale_of(units[name], scales)
        for name in sim.names
        if not name.startswith("solver.") and name != "energy.residual"
    }


@pytest.mark.parametrize("settings", SETTINGS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_scaled_machine_moves_as_the_scaled_motion(kind, settings):
    rotor = overhung(others=(KINDS[kind][0],))
    motion, *others = (motion_of(rotor, settings, scales) for scales in SCALES)
    assert abs(motion["energy.kinetic"]) > 1
    for other in others:
        assert not [
            name for name in motion if other[name] != pytest.approx(motion[name], rel=1e-7, abs=0)
        ]
