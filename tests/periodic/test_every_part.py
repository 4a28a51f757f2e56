"""The motions of curves are those that runs in time from rest come to, whatever holds the rotor."""

import math

import numpy as np
import pytest
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf

from ..parts.machines import STEEL, sections, touchdown
from ..toml_text import table

SAMPLES, TURNS = 64, 40
FILM = {"journal_radius": 0.02, "length": 0.02, "viscosity": 0.02, "short": True}
CONTACT = {"journal_radius": 0.02, "mu": 0.1, "k": 5e6, "c": 200.0}
HOUSING = table(
    "[housing]", name="seat", mass=2.0, mass_ratio=1.5, kx=3e6, ky=6e6, cx=300.0, cy=300.0
)
RING = {
    "journal_radius": 0.01,
    "length": 0.012,
    "clearance": 3e-5,
    "viscosity": 0.01,
    "outer_radius": 0.014,
    "outer_length": 0.014,
    "outer_clearance": 6e-5,
    "outer_viscosity": 0.01,
    "ring_mass": 0.02,
    "ring_inertia": 3e-6,
    "short": True,
}
SEAL = {
    "speed": [-400.0, 0.0, 400.0],
    "added_mass": 1.5,
    **{f"k{axis}": [2e5, 1e5, 2e5] for axis in ("xx", "yy")},
    **{f"c{axis}": [400.0, 300.0, 400.0] for axis in ("xx", "yy")},
    "kxy": [-6e4, 0.0, 6e4],
    "kyx": [6e4, 0.0, -6e4],
}


def at_both_ends(kind, **keys):
    return table(f"[{kind}]", z=0.0, **keys) + table(f"[{kind}]", z=0.6, **keys)


def amid(kind, **keys):
    """A part in the middle of a shaft on linear bearings."""
    held = at_both_ends("linear_bearing", kxx=2e6, kyy=3e6, cxx=500.0, cyy=600.0)
    return held + table(f"[{kind}]", node=3, **keys)


PARTS = {
    "plain film": at_both_ends("journal_bearing", clearance=5e-5, **FILM),
    "lobes": at_both_ends(
        *("journal_bearing",),
        clearance=5e-5,
        pads=[0.5236, 2.618, 4.7124],
        arc=1.9,
        preload=0.5,
        **FILM,
    ),
    "damper off its centre": at_both_ends(
        "squeeze_film_damper", clearance=1.5e-4, stiffness=1e6, **FILM
    ),
    "floating rings": at_both_ends("floating_ring_bearing", **RING),
    "seal and rub": amid("seal", **SEAL) + table("[contact]", node=3, clearance=2e-5, **CONTACT),
    "Hertz": amid("contact", clearance=1.5e-5, **CONTACT | {"k": 2e8, "exponent": 1.5}),
    "worn": amid("contact", clearance=1.5e-5, wear=4e-5, wear_angle=1.0, mu_rise=0.1, **CONTACT),
    "sticking": HOUSING
    + amid("contact", clearance=1.5e-5, housing="seat", k_t=3e6, **CONTACT | {"mu": 0.3}),
    "race": HOUSING
    + amid("support", stiffness=1e4)
    + touchdown(3, "seat").replace("0.25e-3", "0.02e-3"),
}


SPEEDS = (110.0, -160.0)
# each part in one sense, by turns; in the other one with the slow tests, and so what is a film as
# the plain one, or a wall as that of Hertz
LIKE_OTHERS = ("lobes", "worn")
CASES = [
    pytest.param(
        part, SPEEDS[(i + sense) % 2], marks=[pytest.mark.slow] * bool(sense or part in LIKE_OTHERS)
    )
    for i, part in enumerate(PARTS)
    for sense in (0, 1)
]


@pytest.mark.parametrize(("part", "speed"), CASES)
def test_a_curve_has_the_motion_that_a_run_from_rest_comes_to(part, speed):
    machine = rf.parse(
        f"{STEEL}[shaft]\neta_v = 1e-5\n{sections(0.2, 0.1, 0.1, 0.2, outer=0.03)}"
        + table("[disc]", node=2, diameter=0.2, width=0.03, e=1e-5, phase=0.3, name="hub")
        + table("[disc]", node=4, diameter=0.15, width=0.03, e=2e-5, phase=2.0)
        + PARTS[part]
    )
    ends = sorted((speed, 1.01 * speed))
    found = rf.response(machine, speed=(ends[0], ends[1]), stability=False)
    run = Simulation(machine.rotor, choose(tolerance=1e-5), speed=speed, warn=lambda _: None)
    period, seen = 2 * math.pi / abs(speed), []
    for i in range(SAMPLES):
        run.advance((TURNS + i / SAMPLES) * period, speed)
        seen.append((run.read("hub.x"), run.read("hub.y")))
    size = np.ptp(seen, axis=0).max() / 2
    (motion,) = found.at(speed)
    curve = np.transpose(found.series(motion, "hub", SAMPLES))
    assert np.abs(curve - seen).max() < 1e-3 * size
