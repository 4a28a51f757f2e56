"""A machine in bearings of any kinds rests, in linear analyses, where a run begins: two searches
that share no line."""

import math
import random

import numpy as np
import pytest
from rotor_fmu.model.linear import LinearError, modes, static
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation
from scipy.optimize import brentq

from ..toml_text import table

_SHAPES = (
    {},
    {"short": True},
    {"pads": [1.5708, 4.71239], "arc": 2.7, "preload": 0.3},
    {
        **{"pads": [0.942, 2.199, 3.456, 4.712, 5.969], "arc": 1.0, "preload": 0.4},
        **{"tilting": True, "pad_inertia": 1e-4},
    },
)


class _Draw(random.Random):
    def decades(self, low, high):
        return math.exp(self.uniform(math.log(low), math.log(high)))


def _rolling(draw):
    sign = draw.choice((-1.0, 1.0))
    return "rolling_bearing", {
        **{"count": draw.randint(5, 16), "pitch_diameter": 0.06, "element_diameter": 0.008},
        **{"k": draw.decades(1e8, 1e10), "exponent": draw.choice((1.5, 1.1111))},
        **{"clearance": sign * draw.decades(1e-7, 2e-4), "cage_angle": draw.uniform(0.0, 6.28)},
    }


def _film(draw):
    return "journal_bearing", {
        **{"journal_radius": 0.03, "length": draw.uniform(0.02, 0.06)},
        **{"clearance": draw.decades(3e-5, 3e-4), "viscosity": draw.decades(5e-3, 5e-2)},
        **draw.choice(_SHAPES),
    }


def _linear(draw):
    k = draw.decades(1e5, 1e8)
    across = {"kxy": 0.3 * draw.uniform(-k, k), "kyx": 0.3 * draw.uniform(-k, k)}
    damping = {"cxx": 1e-3 * k, "cyy": 1e-3 * k}
    return "linear_bearing", {"kxx": k, "kyy": k * draw.uniform(0.5, 2.0), **across, **damping}


def _damper(draw):
    return "squeeze_film_damper", {
        **{"journal_radius": 0.05, "length": 0.015, "viscosity": 0.01, "k": 1e8},
        **{"clearance": draw.decades(5e-5, 3e-4), "stiffness": draw.decades(1e6, 1e8)},
    }


def _support(draw):
    return "support", {"stiffness": draw.decades(1e5, 1e9), "damping": 100.0}


def _ring(draw):
    return "floating_ring_bearing", {
        **{"journal_radius": 0.03, "length": 0.03, "clearance": draw.decades(3e-5, 1e-4)},
        **{"viscosity": 0.02, "outer_viscosity": 0.02, "outer_length": 0.03},
        **{"outer_radius": 0.038, "outer_clearance": draw.decades(5e-5, 2e-4)},
        **{"ring_mass": 0.2, "ring_inertia": 2e-4},
    }


_KINDS = (_rolling, _rolling, _film, _film, _linear, _damper, _support, _ring)
_ON_HOUSING = (_rolling, _film, _linear, _damper)


def _drawn(seed):
    """A machine, and a speed [rad/s] at which its films carry it."""
    draw = _Draw(seed)
    count = draw.randint(4, 9)
    nodes = np.cumsum([0.0, *(draw.uniform(0.05, 0.25) for _ in range(count - 1))])
    diameters = [draw.decades(0.02, 0.06) for _ in range(count - 1)]
    tables = [
        f"gravity_angle = {draw.choice((0.0, draw.uniform(-3.0, 3.0)))}",
        table("material", young=2.1e11, density=7800.0),
        table("shaft", nodes=nodes.tolist(), diameters=diameters),
    ]
    for _ in range(draw.randint(1, 2)):
        size = {"diameter": draw.uniform(0.1, 0.4), "width": draw.uniform(0.01, 0.06)}
        tables.append(table("[disc]", node=draw.randint(1, count), **size))
    kinds = []
    for node in sorted(draw.sample(range(1, count + 1), draw.choice((2, 2, 2, 3)))):
        of = draw.choice(_KINDS)
        kind, quantities = of(draw)
        if of in _ON_HOUSING and draw.random() < 0.3:
            quantities["housing"] = f"pedestal_{node}"
            stiffness = {"kx": draw.decades(1e6, 1e9), "ky": draw.decades(1e6, 1e9)}
            held = {"mass": draw.uniform(1.0, 30.0), "cx": 1e3, "cy": 1e3, **stiffness}
            tables.append(table("[housing]", name=quantities["housing"], **held))
        tables.append(table(f"[{kind}]", node=node, **quantities))
        kinds.append(of)
    floats = _film in kinds or _ring in kinds
    speed = draw.uniform(100.0, 800.0) if floats else draw.choice((0.0, 300.0))
    return parse_rotor("\n".join(tables)), speed


def _distance(rotor, speed):
    """How far apart both are, of the displacement; None where the run finds no equilibrium,
    infinite where only the run does."""
    try:
        motion = Simulation(rotor, choose(), speed=speed, warn=lambda _: None).motion
    except EquilibriumError:  # a run is also refused where it would begin too far from the axis
        return None
    try:
        rest = static(rotor, speed=speed)
    except LinearError:
        return math.inf
    seen, expected = rest.x + 1j * rest.y, motion.q[: 2 * len(rest.x) : 2]
    assert np.isfinite(modes(rotor, speed).eigenvalues).all()
    return np.abs(seen - expected).max() / np.abs(expected).max()


@pytest.mark.parametrize("seed", [*range(12), 67, 179, 355, 398, 399, 571])
def test_a_machine_rests_where_its_run_begins(seed):
    distance = _distance(*_drawn(seed))
    assert distance is None or distance < 1e-6


def test_a_journal_rests_where_another_pad_is_about_to_bear():
    # pads without preload: in the second bearing one bears right of the journal and not left of it
    film = {"journal_radius": 0.03, "tilting": True, "pad_inertia": 1e-4}
    four = {"pads": [1.5708, 3.1416, 4.7124, 6.2832], "arc": 1.25, "clearance": 1.2e-4}
    three = {"pads": [2.618, 4.7124, 0.5236], "arc": 1.667, "clearance": 3.46e-5}
    tables = (
        table("material", young=2.1e11, density=7800.0),
        table("shaft", nodes=[0.0, 0.14, 0.29, 0.51, 0.62, 0.73, 0.79], diameters=[0.04] * 6),
        table("[disc]", node=4, diameter=0.328, width=0.026),
        table("[journal_bearing]", node=1, length=0.021, viscosity=0.0068, **film, **four),
        table("[journal_bearing]", node=2, length=0.034, viscosity=0.037, **film, **three),
    )
    assert _distance(parse_rotor("\n".join(tables)), 380.0) < 1e-6


def test_a_journal_rests_where_the_force_of_a_pad_sets_in():
    """The tangents say nothing there, in a range of speeds of 2e-9 rad/s."""
    wheels = (5, 0.42), (6, 0.42), (7, 0.42), (8, 0.42), (9, 0.4), (10, 0.38)
    diameters = [0.1, 0.11, 0.13, 0.14, *5 * [0.15], 0.15, 0.14, 0.13, 0.11, 0.09]
    pads = {"pads": [math.radians(54 + 72 * n) for n in range(5)], "arc": math.radians(58)}
    film = {"journal_radius": 0.06, "length": 0.05, "clearance": 0.09 * 1e-3, "viscosity": 0.02}
    tilting = {"tilting": True, "pad_inertia": 2e-4, "preload": 0.3}
    tables = (
        table("material", young=206842718795.0509, density=7833.0),
        table("shaft", nodes=[round(0.15 * i, 2) for i in range(15)], diameters=diameters),
        *(table("[disc]", node=node, diameter=size, width=0.04) for node, size in wheels),
        table("[disc]", node=15, diameter=0.2, width=0.05),
        *(table("[journal_bearing]", node=node, **film, **pads, **tilting) for node in (3, 13)),
    )
    rotor = parse_rotor("\n".join(tables))
    near, there = (static(rotor, speed=179.6327246805142 + apart).y for apart in (-1e-6, 0.0))
    assert there == pytest.approx(near, rel=1e-6)


def test_a_journal_rests_where_the_end_of_its_film_passes_a_point_of_the_grid():
    """The force has a step there of some 1e-8 of itself, and rest lies within it."""
    film = {"journal_radius": 0.2, "length": 0.36, "clearance": 3e-4, "viscosity": 0.025}
    lemon = {"pads": [1.5707963, 4.712389], "arc": 2.617994, "preload": 0.5}
    tables = (
        table("material", young=2.06e11, density=7850.0),
        table("shaft", nodes=[0.0, 2.0, 4.0, 6.0, 8.0], diameters=[0.4, 0.8, 0.8, 0.4]),
        *(table("[journal_bearing]", node=node, **film, **lemon) for node in (2, 4)),
    )
    rotor = parse_rotor("\n".join(tables))
    for speed in (8.539206162608327, 39.65012876597377, 1.2373761518419273):
        there, near = (static(rotor, speed=s).y for s in (speed, speed * (1.0 + 1e-6)))
        assert there == pytest.approx(near, rel=1e-5)


@pytest.mark.parametrize("speed", [-300.0, 300.0])
def test_a_journal_rests_in_a_bearing_of_one_pad_further_out_than_its_clearance(speed):
    """From the middle of that film tangents lead away from the pad."""
    film = {"journal_radius": 0.025, "length": 0.03, "clearance": 1e-4, "viscosity": 0.03}
    pad = {"pads": [4.5248], "arc": 1.0, "preload": 0.5, "offset": 0.0}
    tables = (
        table("material", young=2.1e11, density=7800.0),
        table("shaft", nodes=[0.0, 0.3, 0.6], diameters=[0.05, 0.05]),
        table("[disc]", node=2, diameter=0.6, width=0.05),
        table("[journal_bearing]", node=1, **film, **pad),
        table("[support]", node=3, stiffness=1e8, damping=1e4),
    )
    rotor = parse_rotor("\n".join(tables))
    assert _distance(rotor, speed) < 1e-6
    rest = static(rotor, speed=speed)
    assert math.hypot(rest.x[0], rest.y[0]) > film["clearance"]


@pytest.mark.slow
def test_no_machine_rests_where_only_a_run_finds_it():
    distances = [_distance(*_drawn(seed)) for seed in range(12, 312)]
    known = np.array([distance for distance in distances if distance is not None])
    assert len(known) > 250
    assert known.max() < 1e-6


def test_a_vertical_machine_rests_where_its_pads_are_just_as_stiff_as_what_pulls():
    """There nothing leads back to the middle, and rounding leads anywhere."""
    angles = [math.radians(30.0 * n) for n in range(12)]
    film = {"journal_radius": 0.5, "length": 0.25, "clearance": 2.5e-4, "viscosity": 0.03}
    pads = {"tilting": True, "pads": angles, "arc": math.radians(24.0), "preload": 0.3}
    pull = {"kxx": -2e8, "kyy": -2e8, "cxx": 0.0, "cyy": 0.0}
    tables = (
        f"inclination = {math.pi / 2}",
        table("material", young=2.1e14, density=7850.0),
        table("shaft", nodes=[0.0, 2.0, 4.0], diameters=[0.8, 0.8]),
        *(table("[journal_bearing]", node=node, **film, **pads) for node in (1, 3)),
        table("[linear_bearing]", node=2, **pull),
    )
    rotor = parse_rotor("\n".join(tables))
    bearing = dict(rotor.named_parts())["journal_bearing[1]"]

    def left(speed):
        return 2.0 * BearingAlone(bearing, speed).coefficients(0j)[0][0, 0] - 2e8

    speed = brentq(left, 1.0, 50.0, xtol=1e-13)
    assert np.abs(LinearMachine(rotor).at(speed).rest).max() == 0.0
