"""Space has no direction of its own: a machine turned with its gravity by a quarter, or mirrored
with the sense of its speed, answers as the turned or mirrored one. A sign or an axis that a part or
an analysis forgets shows here, without a reference solution.

The mirror is the diagonal x = y, so that both images swap x and y; sense: 1 of what is turned, -1
of what is mirrored, whose angles and speeds run backwards.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear.modes import modes
from rotor_fmu.model.linear.static import static
from rotor_fmu.model.linear.unbalance import unbalance_response
from rotor_fmu.model.parts import PARTS
from rotor_fmu.model.quantities import quantities
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from ..machines import overhung

SPEED, RATE, SECONDS = 170.0, 500.0, 2e-3
QUARTER = math.pi / 2
GRAVITY_ANGLE = 0.4

WALL = {"node": 2, "journal_radius": 0.01, "clearance": 5e-5, "mu": 0.2, "k": 2e7}
WORN = {"wear": 2e-5, "wear_angle": 4.0, "wear_power": 2.0}
HOUSING = {"kx": 3e6, "ky": 2e6, "cx": 300.0, "cy": 500.0, "mass": 1.0, "mass_ratio": 1.3}
SEAT = ("housing", {"name": "seat", **HOUSING})
EIGHT = {
    **{"node": 3, "kxx": 2e5, "kxy": 3e4, "kyx": -5e4, "kyy": 1e5},
    **{"cxx": 60.0, "cxy": 5.0, "cyx": -8.0, "cyy": 40.0},
}
OVER_SPEED = {
    **(EIGHT | {"speed": (-200.0, 100.0, 300.0), "kxy": (1e4, 3e4, 4e4)}),
    **{"kxx": (2e5, 3e5, 1e5), "cyx": (1.0, -8.0, 3.0)},
}
FILM = {"node": 3, "length": 0.02, "journal_radius": 0.02, "clearance": 1e-4, "viscosity": 0.02}
COARSE = {"points": 12}
DAMPER = FILM | {"clearance": 1e-3, "stiffness": 1e4, "housing": "seat"}
GROOVED = {"pads": (0.2, 3.4), "arc": (2.6, 2.7), "preload": (0.3, 0.2), "offset": (0.6, 0.5)}
TILTING = {
    **{"pads": (0.8, 2.4, 4.0, 5.5), "arc": 1.2, "offset": 0.55, "preload": 0.3},
    **{"tilting": True, "pad_inertia": 1e-6},
}
HEATED = {
    **{"viscosity": (0.04, 0.015), "temperature": (40.0, 80.0)},
    **{"speed": (100.0, 300.0), "static_load": 60.0},
}
RING = {
    **{"outer_radius": 0.03, "outer_length": 0.02, "outer_clearance": 1.5e-4},
    **{"outer_viscosity": 0.02, "ring_mass": 0.05, "ring_inertia": 3e-5, "short": True},
}
BALLS = {
    **{"node": 3, "count": 8, "pitch_diameter": 0.05, "element_diameter": 0.01, "k": 1e9},
    **{"cage_angle": 0.2, "outer_depth": 1e-6, "outer_angle": 4.5, "outer_arc": 0.8},
    **{"inner_depth": 1e-6, "inner_angle": 4.0, "inner_arc": 0.8},
}
# What stands beside the discs and the springs, by the name of the case.
CASES = {
    "bearing": [("bearing", WALL | HOUSING)],
    "contact": [("contact", WALL | WORN)],
    "sticking contact": [("contact", WALL | {"k_t": 1e7})],
    "touchdown_bearing": [("touchdown_bearing", WALL | {"race_inertia": 1e-4, "race_drag": 0.01})],
    "heated_contact": [("heated_contact", WALL | {"bow_per_heat": 1e-6, "bow_decay": 0.1})],
    "housing": [SEAT, ("contact", WALL | {"housing": "seat"})],
    "linear_bearing": [SEAT, ("linear_bearing", EIGHT | {"housing": "seat"})],
    "linear_bearing over the speed": [("linear_bearing", OVER_SPEED)],
    "seal": [("seal", EIGHT | {"added_mass": 2.0})],
    "rolling_bearing": [("rolling_bearing", BALLS)],
    "journal_bearing": [("journal_bearing", FILM | COARSE)],
    "grooved journal_bearing": [("journal_bearing", FILM | GROOVED | COARSE)],
    "tilting pads": [("journal_bearing", FILM | TILTING | COARSE)],
    "heated journal_bearing": [("journal_bearing", FILM | GROOVED | HEATED | COARSE)],
    "squeeze_film_damper": [SEAT, ("squeeze_film_damper", DAMPER)],
    "floating_ring_bearing": [("floating_ring_bearing", FILM | RING)],
    "disc": [("disc", {"node": 2, "diameter": 0.1, "width": 0.02, "e": 1e-4, "phase": 2.0})],
    "coupling": [
        ("coupling", {"node": 1, "diameter": 0.1, "width": 0.02, "e": 1e-4, "phase": 2.0})
    ],
    "body": [
        *[("body", {"node": 3, "mass": 1.0, "I_d": 1e-3, "I_p": 2e-3, "e": 1e-4, "phase": 2.0})],
        *[("body", {"node": 3, "mass": 1.0, "I_d": 1e-3, "I_p": 2e-3, "offset": 0.02})],
    ],
    "point_mass": [("point_mass", {"node": 3, "mass": 1.0})],
    "unbalance": [("unbalance", {"node": 3, "amount": 1e-4, "phase": -1.0})],
    "bow": [("bow", {"node": 2, "amplitude": 1e-5, "phase": 2.0})],
    "load": [("load", {"node": 3, "fx": 20.0, "fy": -30.0, "offset": 0.02})],
    "support": [("support", {"node": 2, "stiffness": 1e5, "damping": 30.0})],
    "sensor": [("sensor", {"node": 2})],
    "port": [("port", {"node": 2})],
    "line": [("line", {"node": 2, "impedance": 50.0})],
    "base": [("base", {})],
    "start": [
        ("start", {"x": 4e-5, "y": 1e-5, "vx": 0.1, "vy": -0.2, "tilt_x": 1e-4, "rate_y": 0.1})
    ],
}
LOAD = 3.0 - 5.0j  # on every port [N], or of the foundation [m/s2]

ANGLES = {"phase", "pads", "wear_angle", "cage_angle", "outer_angle", "inner_angle"}
# What takes its sign from x, and all that is of one axis or of two.
SIGNED = {"x", "vx", "fx", "tilt_x", "rate_x", "kxy", "kyx", "cxy", "cyx"}
OF_AXES = SIGNED | {
    *("y", "vy", "fy", "tilt_y", "rate_y"),
    *("kx", "ky", "cx", "cy", "kxx", "kyy", "cxx", "cyy"),
}
SWAP = str.maketrans("xy", "yx")


def each(value, change):
    """A number changed, or each of several."""
    return tuple(map(change, value)) if isinstance(value, tuple) else change(value)


def image(part, sense):
    """A part turned or mirrored: angles run on or back, and what is of an axis is of the other."""
    names, new = set(quantities(part)), {}
    for name in names & ANGLES:
        new[name] = each(getattr(part, name), lambda angle: QUARTER + sense * angle)
    for name in names & OF_AXES:
        sign = -sense if name in SIGNED else 1
        other = getattr(part, name.translate(SWAP))
        new[name] = each(other, lambda number, sign=sign: sign * number)
    if "mass_ratio" in names:  # of the mass in y over that in x
        new |= {"mass": part.mass * part.mass_ratio, "mass_ratio": 1 / part.mass_ratio}
    if sense < 0 and "pads" in names:
        new["offset"] = each(part.offset, lambda share: 1 - share)
    if sense < 0 and "kxx" in names:  # its table ascends from the other end
        new["speed"] = each(part.speed, lambda speed: -speed)
        new = {name: of[::-1] if isinstance(of, tuple) else of for name, of in new.items()}
    return replace(part, **new)


def turned(z, sense):
    """Vectors x + i y turned or mirrored."""
    return 1j * (z if sense > 0 else np.conj(z))


def image_of_machine(rotor, sense):
    # that of the angle of gravity from the right, again from downwards
    angle = sense * (rotor.gravity_angle - QUARTER) + math.pi
    parts = tuple(image(part, sense) for part in rotor.parts)
    return replace(rotor, parts=parts, gravity_angle=angle)


def machine(case):
    kinds = {kind.KIND: kind for kind in PARTS}
    parts = [kinds[kind](**values) for kind, values in CASES[case]]
    return overhung(others=parts, gravity_angle=GRAVITY_ANGLE, rotating_damping=True)


def answers(rotor, speed, load):
    """Eigenvalues of the lowest modes [1/s], and vectors x + i y: deflection [m] and loads on the
    supports [N] at rest; the whirl by unbalance as the mark points to the right and a quarter of a
    turn later [m]; all displacements at the end of a short run that speeds up [m, rad]."""
    rest = static(rotor, speed, loads=[(2, load.real, load.imag)])
    whirl = unbalance_response(rotor, [speed])
    later = [1.0, 1j * np.sign(speed)]
    sim = Simulation(rotor, choose("robust", h=2e-5), speed=speed, rate=np.sign(speed) * RATE)
    loads = np.full(len(sim.structure.load_dof), load)
    sim.advance(SECONDS, speed + np.sign(speed) * RATE * SECONDS, loads)
    return {
        "modes": np.sort_complex(modes(rotor, speed).eigenvalues),
        "rest": rest.x + 1j * rest.y,
        "housings": rest.housing_x + 1j * rest.housing_y,
        "loads": rest.load_x + 1j * rest.load_y,
        "whirl": np.array([(at * whirl.x).real + 1j * (at * whirl.y).real for at in later]),
        "motion": sim.motion.q.copy(),
    }


def test_no_kind_of_part_is_forgotten():
    known = {kind for parts in CASES.values() for kind, _ in parts}
    assert known == {kind.KIND for kind in PARTS}


@pytest.mark.parametrize("case", CASES)
def test_a_turned_or_mirrored_machine_answers_as_the_turned_or_mirrored_one(case):
    rotor = machine(case)
    of_itself = answers(rotor, SPEED, LOAD)
    for sense in (1, -1):
        found = answers(image_of_machine(rotor, sense), sense * SPEED, turned(LOAD, sense))
        for name, values in of_itself.items():
            expected = values if name == "modes" else turned(values, sense)
            largest = np.abs(expected).max(initial=0.0)
            assert found[name] == pytest.approx(expected, rel=0, abs=1e-9 * largest), (name, sense)
