"""Guembel's rupture: against closed forms, a solution in two dimensions, its own differences."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves.reynolds_2d import film_in_plane
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.law import Weights
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

from .films import film, heavy_shaft
from .test_film_fuzz import slopes

_SPEED, _C = 100.0, 1e-4
_GIVEN = {"journal_radius": 0.05, "clearance": _C, "viscosity": 0.1, "roughness": 1e-7}
_SHAPES = {
    "plain": {},
    "halves": {"pads": (math.pi / 2, 1.5 * math.pi), "arc": math.pi - 0.35, "preload": 0.3},
    "three lobes": {"pads": (0.5, 2.6, 4.7), "arc": 1.9, "preload": 0.4, "offset": 0.7},
}


def _bearing(**more):
    return JournalBearing(**{"node": 1, **_GIVEN, "length": 0.05, "rupture": "guembel", **more})


@pytest.mark.parametrize("e", [0.2, 0.5, 0.8])
def test_a_long_film_is_half_of_sommerfelds(e):
    """Times 5/6: so much of a pressure that is the same along the length a parabola keeps."""
    part = _bearing(length=20.0, points=192.0)
    force = BearingAlone(part, _SPEED).force(e * _C)
    scale = 6 * 0.1 * _SPEED * 0.05 * part.length * (0.05 / _C) ** 2
    radial = -2 * e**2 / ((2 + e**2) * (1 - e**2))
    across = math.pi * e / ((2 + e**2) * math.sqrt(1 - e**2))
    assert force.real / scale == pytest.approx(5 / 6 * radial, rel=2e-3)
    assert force.imag / scale == pytest.approx(5 / 6 * across, rel=2e-3)


@pytest.mark.parametrize("e", [0.2, 0.5, 0.8])
def test_a_short_film_is_the_pi_film(e):
    """Which converges to it with the square of the elements."""
    errors = []
    for points in (96.0, 192.0):
        part = _bearing(length=2e-3, points=points)
        force = BearingAlone(part, _SPEED).force(e * _C)
        expected = BearingAlone(replace(part, short=True), _SPEED).force(e * _C)
        errors.append(abs(force - expected) / abs(expected))
    assert errors[1] < 4e-3
    assert errors[1] < 0.7 * errors[0]
    # in closed form: Ocvirk
    scale = 0.1 * 0.05 * part.length**3 * _SPEED / _C**2
    closed = complex(-(e**2) / (1 - e**2) ** 2, math.pi * e / (4 * (1 - e**2) ** 1.5))
    assert expected / scale == pytest.approx(closed, rel=1e-9)


@pytest.mark.parametrize("count", [2, pytest.param(6, marks=pytest.mark.slow)])
@pytest.mark.parametrize("supply", [0.0, pytest.param(2e5, marks=pytest.mark.slow), 3e6])
@pytest.mark.parametrize("shape", _SHAPES)
def test_its_tangent_and_its_load_in_two_dimensions(shape, supply, count):
    part = _bearing(**_SHAPES[shape], supply_pressure=supply)
    part.check("journal_bearing")
    alone, random = BearingAlone(part, _SPEED), np.random.default_rng(5)
    for _ in range(count):
        d = 0.7 * _C * math.sqrt(random.random()) * np.exp(2j * math.pi * random.random())
        v = 20 * _C * complex(*random.normal(size=2))
        for weights, h in ((Weights(1.0, 0.0, 0.0), 1e-9), (Weights(0.0, 1.0, 0.0), 1e-5)):
            tangent = alone.tangent(d, v, weights)
            # the best of three: a node's pressure that changes its sign spoils the longer ones
            error = min(
                np.abs(slopes(alone, d, v, weights, share * h) - tangent).max()
                for share in (1.0, 0.1, 0.01)
            )
            assert error < 2e-6 * np.abs(tangent).max()
        in_plane = film_in_plane(part, _SPEED, d, viscosity=part.viscosity)
        assert abs(alone.force(d) - in_plane) < 0.03 * abs(in_plane)
        seen = alone.outputs(d, v)
        assert seen["power"] > 0.0
        assert seen["flow"] > 0.0
        assert alone.pressure(d, np.linspace(0, 2 * math.pi, 50)).min() >= -supply


@pytest.mark.parametrize("e", [0.3, 0.7])
def test_a_film_that_is_fed_so_that_it_never_ruptures_is_the_full_film(e):
    """Ocvirk's over the whole circle: no force towards the middle, twice that across it. Fed a
    little, it is between both."""
    part = _bearing(length=2e-3, points=384.0)
    scale = 0.1 * 0.05 * part.length**3 * _SPEED / _C**2
    full = 1j * math.pi * e / (2 * (1 - e**2) ** 1.5)
    largest = BearingAlone(part, _SPEED).outputs(e * _C)["pressure"]
    shares = []
    for supply in (0.0, 0.1 * largest, 0.5 * largest, 2.0 * largest):
        film = BearingAlone(replace(part, supply_pressure=supply), _SPEED)
        shares.append(film.force(e * _C) / scale)
    assert shares[-1] == pytest.approx(full, abs=2e-3 * abs(full))
    for before, after in pairwise(shares):
        assert before.real < after.real <= 1e-3
        assert before.imag < after.imag


def test_a_supply_pressure_needs_a_film_that_fills_its_pads():
    for more in ({"rupture": "reynolds"}, {"short": True}):
        with pytest.raises(QuantityError) as refused:
            _bearing(**more, supply_pressure=1e5).check("journal_bearing[1]")
        assert str(refused.value) == (
            "journal_bearing[1].supply_pressure = 100000 Pa: needs journal_bearing[1].rupture = "
            "guembel and journal_bearing[1].short = false, a film that fills its pads"
        )


def test_it_bears_otherwise_than_reynolds_rupture():
    d = 0.3 * _C - 0.5j * _C
    forces = [BearingAlone(_bearing(rupture=r), _SPEED).force(d) for r in ("reynolds", "guembel")]
    assert 0.01 < abs(forces[1] / forces[0] - 1.0) < 0.3


def test_a_rotor_runs_in_such_films():
    halves = {"pads": [1.570796, 4.712389], "arc": 2.8, "rupture": "guembel"}
    fed = film(3, rupture="guembel", supply_pressure=2e5)
    rotor = parse_rotor(heavy_shaft(2e-6) + film(1, **halves) + fed)
    run = Simulation(
        rotor, choose("controlled", tolerance=1e-3), speed=400.0, warn=lambda message: None
    )
    run.advance(0.2, 400.0)
    assert run.read("journal_bearing[1].power") > 0.0
    lost = sum(run.read(n) for n in run.names if n.startswith("energy.") and n.endswith("_loss"))
    assert abs(run.read("energy.residual")) < 1e-4 * lost


def test_an_unknown_rupture_is_refused():
    with pytest.raises(QuantityError) as refused:
        _bearing(rupture="sommerfeld").check("journal_bearing[1]")
    assert str(refused.value) == (
        "journal_bearing[1].rupture = sommerfeld: must be one of reynolds, guembel"
    )
