"""The jump of a rigid rotor on squeeze film dampers, against the closed form of its orbits.

mu R L^3 / (m c^3 w_n) = 0.05 of both dampers together, unbalance 0.3 of the clearance.
"""

import math

import pytest

import rotor_fmu as rf

from ..parts.films import DAMPER, on_dampers
from ..parts.machines import shaft
from ..toml_text import table

B, U, NATURAL, MASS = 0.05, 0.3, 100.0, 10.0
FOLD, ORBITS = 1.5312, (0.87388, 0.84178, 0.41580)  # the latter at a speed of 2


def hung(**more):
    """A rotor of 2 kg with a support at its left end and a short damper at its right one."""
    body = table("[body]", node=2, mass=2.0, I_d=1e-2, I_p=1e-3, e=3e-4)
    damper = table("[squeeze_film_damper]", **{**DAMPER, "node": 3, "short": True, **more})
    support = table("[support]", node=1, stiffness=1e6, damping=200.0)
    return rf.parse(shaft(0.0, 0.1, 0.2) + body + support + damper)


def dampers(**more):
    slender = DAMPER["length"] / DAMPER["clearance"]
    viscosity = B * MASS * NATURAL / (2.0 * DAMPER["journal_radius"] * slender**3)
    return on_dampers(viscosity, young=2.1e15, density=1e-3, **more)


@pytest.fixture(scope="module")
def curve():
    return rf.response(dampers(), speed=(1.2 * NATURAL, 2.2 * NATURAL))


def orbits(curve, speed):
    """Orbits over the clearance, the largest first, with the points of the curve."""
    points = curve.at(speed * NATURAL)
    sizes = [(curve.amplitude(p, "body[1]") / DAMPER["clearance"], p) for p in points]
    return sorted(sizes, key=lambda pair: -pair[0])


def left_of(e, s):
    """The closed form's equation of an orbit e at a speed s, 0 where it holds [1]."""
    a, b = 2.0 * B * e / (1.0 - e**2) ** 2, math.pi * B / (2.0 * (1.0 - e**2) ** 1.5)
    return e**2 * ((1.0 - s**2 + a * s) ** 2 + (b * s) ** 2) / (U * s**2) ** 2 - 1.0


def test_the_curve_folds_where_the_closed_form_does(curve):
    (fold,) = curve.bifurcations
    assert fold.kind == "fold"
    assert fold.value / NATURAL == pytest.approx(FOLD, rel=1e-4)
    # and is bracketed: one orbit a little below, three a little above
    assert [len(orbits(curve, s)) for s in (0.999 * FOLD, 1.001 * FOLD)] == [1, 3]


def test_three_orbits_at_twice_the_natural_frequency(curve):
    found = orbits(curve, 2.0)
    assert [e for e, _ in found] == pytest.approx(ORBITS, rel=1e-4)
    assert [point.is_stable for _, point in found] == [True, False, True]


@pytest.mark.parametrize("speed", [1.2, 1.4, 1.6, 1.8, 2.2])
def test_every_orbit_is_one_of_the_closed_form(curve, speed):
    found = orbits(curve, speed)
    assert len(found) == (1 if speed < FOLD else 3)
    for e, _ in found:
        # the equation changes by about its slope times the orbit's error
        slope = (left_of(1.0001 * e, speed) - left_of(0.9999 * e, speed)) / 2e-4
        assert abs(left_of(e, speed)) < 1e-4 * abs(slope)


@pytest.mark.slow  # of rubs the same check is made in test_rub and test_branches
@pytest.mark.parametrize("turns", [30, 100])
def test_stable_orbits_stay_in_time_and_the_unstable_one_is_left(curve, turns):
    for _, point in orbits(curve, 2.0):
        seen = curve.check(point, turns=turns)
        assert seen.stays == point.is_stable


def test_a_branch_ends_where_a_film_becomes_thinner_than_its_roughness():
    """As a run in time does: there is no such motion."""
    rough = dampers(roughness=0.2 * DAMPER["clearance"])
    result = rf.response(rough, speed=(1.2 * NATURAL, 1.8 * NATURAL))
    (note,) = [n for n in result.notes if n.code == "branch-lost"]
    assert "the film of squeeze_film_damper[1] becomes thinner than its roughness" in note
    largest = max(result.amplitude(p, "body[1]") for p in result.points)
    assert 0.7 < largest / DAMPER["clearance"] < 0.8


def test_nor_does_one_begin_there():
    """The rotor's weight would hang it through the wall of the damper."""
    result = rf.response(hung(full=True, stiffness=5e4), speed=(250.0, 260.0))
    assert not result.branches
    broken = "the film of squeeze_film_damper[1] would be thinner than its roughness"
    assert all(broken in note for note in result.notes)


def test_a_motion_that_a_damper_carries_by_whirling_alone_stays_in_time():
    """Although the rotor has no rest in which a run could begin: nothing centres its damper."""
    result = rf.response(hung(), speed=(250.0, 260.0))
    (point,) = result.at(250.0)
    assert result.check(point, turns=5).stays
