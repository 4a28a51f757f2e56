"""Squeeze film dampers alone: their orbits, and where their ring rests, by closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import damper_curves
from rotor_fmu.model.linear import LinearError, static
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.housing import Housing
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper

from rotor_fmu.linear import bearing_answers

from ..parts.films import DAMPER
from ..parts.machines import rigid
from ..toml_text import table
from .bearing_machines import with_part


@pytest.mark.parametrize("full", [False, True])
def test_orbits_of_a_damper_are_those_of_the_closed_form(full):
    """mu R L^3 / c^3 times 2 w e / (1 - e^2)^2 and pi / 2 (1 - e^2)^-1.5; a full film's damping is
    twice that, and it has no stiffness."""
    part = SqueezeFilmDamper(**DAMPER, short=True, full=full, stiffness=1e5)
    found = damper_curves(with_part(part), 80.0, bearing="squeeze_film_damper[1]", load=2.0)
    e, scale = found.orbit, 0.01 * 0.05 * 0.02**3 / 1e-12
    damping = scale * math.pi / 2 / (1 - e**2) ** 1.5
    stiffness = 80.0 * scale * 2 * e / (1 - e**2) ** 2
    np.testing.assert_allclose(found.damping, (1 + full) * damping, rtol=1e-9)
    if full:
        assert np.abs(found.stiffness).max() < 1e-9 * stiffness.max()
    else:
        np.testing.assert_allclose(found.stiffness, stiffness, rtol=1e-9)
    power = (1 + full) * damping * (80.0 * e * 1e-4) ** 2
    np.testing.assert_allclose(found.power, power, rtol=1e-9)
    # it hangs in its spring
    assert found.eccentricity == pytest.approx(2.0 / 1e5 / 1e-4, rel=1e-9)
    np.testing.assert_allclose(found.K, 1e5 * np.eye(2), atol=1e-6)


@pytest.mark.parametrize("short", [pytest.param(True, marks=pytest.mark.slow), False])
def test_a_film_that_never_ruptures_has_no_stiffness_and_is_drawn_so(short):
    """Not what rounding leaves of it, on an axis of logarithms from 1e-9 N/m on."""
    part = SqueezeFilmDamper(**DAMPER, short=short, full=True, stiffness=1e5)
    found = bearing_answers.damper(
        with_part(part), 80.0, bearing="squeeze_film_damper[1]", load=2.0
    )
    assert not found.stiffness.any()
    figure = found.figure()
    assert [axes.get_yscale() for axes in figure.axes[1:]] == ["log", "linear", "log"]
    figure.draw_without_rendering()
    labels = [
        text.get_text() for axes in figure.axes for text in axes.get_yticklabels(which="both")
    ]
    assert not [label for label in labels if "mathdefault" in label]


def test_a_damper_without_a_spring_lies_on_its_wall_or_has_no_equilibrium():
    name = "squeeze_film_damper[1]"
    on_wall = SqueezeFilmDamper(**DAMPER, short=True, k=1e8)
    found = damper_curves(with_part(on_wall), 80.0, bearing=name, load=50.0)
    assert found.y == pytest.approx(-1e-4 + 1e-6 - 50.0 / 1e8, rel=1e-9)
    assert found.K[1, 1] == pytest.approx(1e8, rel=1e-9)
    with pytest.raises(LinearError) as raised:
        damper_curves(with_part(replace(on_wall, k=0.0)), 80.0, bearing=name, load=50.0)
    assert str(raised.value) == (
        "squeeze_film_damper[1]: no equilibrium: its load is 50 N, and its spring carries 0 N in "
        "that direction when the film is as thin as its roughness, 1e-06 m"
    )
    hung = replace(on_wall, k=0.0, stiffness=1e5)
    with pytest.raises(LinearError, match=r"its load is 50 N, and its spring carries 9\.9 N"):
        damper_curves(with_part(hung), 80.0, bearing=name, load=50.0)


CAGE = """
[[housing]]
name = "outer"
mass = 0.5
kx = 8e4
ky = 1e5
cx = 30.0
cy = 40.0
[[linear_bearing]]
node = 1
housing = "outer"
kxx = 1e7
kyy = 1e7
cxx = 0.0
cyy = 0.0
[[support]]
node = 3
stiffness = 1e7
[[squeeze_film_damper]]
node = 1
ring = "outer"
journal_radius = 0.05
length = 0.02
clearance = 1e-4
viscosity = 0.01
short = true
k = 1e8
"""


def test_a_ring_rests_in_its_cage_as_in_the_machine_and_has_its_stiffness_and_damping():
    """Without a load the film's damping is mu R L^3 / c^3 pi / 2."""
    name = "squeeze_film_damper[1]"
    rotor = parse_rotor(rigid(mass=1.0, gravity=9.81, rest=CAGE))
    whole, found = static(rotor, 80.0), damper_curves(rotor, 80.0, bearing=name)
    assert complex(found.x, found.y) == pytest.approx(whole.housing_x[0] + 1j * whole.housing_y[0])
    assert found.load == pytest.approx([0.0, -9.81 * (0.5 + 0.5)], rel=1e-6)
    assert found.eccentricity == pytest.approx(9.81 / 1e5 / 1e-4, rel=1e-6)
    np.testing.assert_allclose(found.cage, [8e4, 1e5])
    none = damper_curves(rotor, 80.0, bearing=name, load=0.0)
    film = 0.01 * 0.05 * 0.02**3 / 1e-12 * math.pi / 2
    np.testing.assert_allclose(none.K, np.diag([8e4, 1e5]), atol=1e-6)
    np.testing.assert_allclose(none.C, np.diag([30.0 + film, 40.0 + film]), rtol=1e-6)
    # within a casing that gives it is its place in that
    soft = dict.fromkeys(("kx", "ky"), 1e6) | dict.fromkeys(("cx", "cy"), 0.0)
    casing = 'housing = "casing"\n' + table("[housing]", name="casing", mass=1.0, **soft)
    within = parse_rotor(rigid(mass=1.0, gravity=9.81, rest=CAGE + casing))
    whole, found = static(within, 80.0), damper_curves(within, 80.0, bearing=name)
    ring, moved = whole.housing_y
    assert moved < 0.0
    assert found.y == pytest.approx(ring - moved)
    # the orbits are of the film alone
    uncaged = replace(rotor.of_kind(Housing)[0], kx=1e3, ky=1e3)
    bare = damper_curves(rotor.with_parts(Housing, uncaged), 80.0, bearing=name, load=0.0)
    np.testing.assert_allclose(none.stiffness, bare.stiffness)
    half = damper_curves(rotor, 80.0, bearing=name, load=5.0)
    assert half.y == pytest.approx(-5.0 / 1e5, rel=1e-9)
    on_wall = damper_curves(rotor, 80.0, bearing=name, load=50.0)
    reach = 1e-4 - 1e-6  # where it touches
    assert on_wall.y == pytest.approx(-(50.0 + 1e8 * reach) / (1e8 + 1e5), rel=1e-6)
    free = replace(rotor.of_kind(SqueezeFilmDamper)[0], k=0.0)
    with pytest.raises(LinearError, match=r"its load is 50 N, and its cage carries 9\.9 N"):
        damper_curves(rotor.with_parts(SqueezeFilmDamper, free), 80.0, bearing=name, load=50.0)
