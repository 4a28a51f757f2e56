"""Tilting pads at rest: where their films bear, where unheld ones idle, and the journal on them."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.laws_at_rest.potential_rest import rest_in_potential
from rotor_fmu.model.linear.bearing_equilibrium import BearingAlone
from rotor_fmu.model.parts.journal_bearing import JournalBearing

_PI = math.pi
_C, _SPEED = 1e-4, 100.0


def _part(count, on_pad=False, offset=0.5, **more):
    """Pads whose pivots are spread evenly, one or a gap below; the surface goes anticlockwise."""
    arc = 0.85 * 2.0 * _PI / count
    first = -0.5 * _PI + (0.0 if on_pad else _PI / count) + (0.5 - offset) * arc
    part = JournalBearing(
        **{"node": 1, "journal_radius": 0.05, "length": 0.05, "clearance": _C, "viscosity": 0.1},
        **{"pads": tuple(first + 2.0 * _PI * i / count for i in range(count)), "arc": arc},
        **{"offset": offset, "tilting": True, **more},
    )
    part.check("journal_bearing")
    return part


def _pivots(part):
    return np.array([cmath.exp(1j * (p + (part.offset - 0.5) * part.arc)) for p in part.pads])


def _mirrored(part):
    return replace(part, pads=tuple(_PI - p for p in part.pads), offset=1.0 - part.offset)


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_pad_with_an_offset_pivot_bears_a_journal_beyond_its_centre(sense):
    """As a plane slider does, whose pivot is behind its middle: before and behind the position at
    which pad and journal are concentric its load is the same, and it goes on from there."""
    part = _part(4, offset=0.6)
    part = part if sense > 0.0 else _mirrored(part)
    pivot, loads = _pivots(part)[0], []
    for radial in (1e-3, 1e-6, 0.0, -1e-6, -0.3):
        film = BearingAlone(part, sense * _SPEED)
        loads.append(film.pad_loads(radial * _C * pivot)[0])
    assert loads[1:4] == pytest.approx([loads[2]] * 3, rel=1e-4)
    assert loads[0] > loads[1] > loads[4] > 0.1 * loads[1]


def test_a_pad_in_the_middle_without_preload_bears_in_its_wedge():
    """The journal bears nothing there, each pad the same."""
    film = BearingAlone(_part(5, offset=0.6), _SPEED)
    loads = film.pad_loads(0j)
    assert loads.min() > 0.0
    assert loads == pytest.approx(loads[0], rel=1e-6)
    assert abs(film.force(0j)) < 1e-6 * loads[0]


@pytest.mark.parametrize(
    ("part", "places"),
    [
        (_part(4), (-0.5j, 0.1 - 0.3j, -0.2 - 0.6j)),
        # where the other end of a pad could lie against the wall
        (_part(4, k=1e9, preload=0.3, offset=0.52), (-0.151 - 1.086j,)),
    ],
)
def test_an_unheld_pad_idles_where_its_film_begins_to_converge_at_its_end(part, places):
    """Wherever the journal came from."""
    film, end = BearingAlone(part, _SPEED), math.tan((1.0 - part.offset) * part.arc)
    for d in (_C * place for place in places):
        across = (1j * _pivots(part)).conjugate() * d
        radial = (_pivots(part).conjugate() * d).real + _C * part.preload / (1.0 - part.preload)
        film.force(-d)
        unheld = radial < 0.0
        assert unheld.sum() == 2
        idle = radial * end - across.real
        np.testing.assert_allclose(film.tilts(d)[unheld], idle[unheld], atol=1e-5 * _C)
        loads = film.pad_loads(d)
        assert loads[unheld].max() < 1e-12 * loads.max()


@pytest.mark.parametrize(
    "load", [400.0, *(pytest.param(load, marks=pytest.mark.slow) for load in (10.0, 1e4))]
)
@pytest.mark.parametrize(
    "given",
    [
        *(
            pytest.param(each, marks=pytest.mark.slow)
            for each in ({"count": 6}, {"count": 4, "on_pad": True})
        ),
        {"count": 6, "offset": 0.54},
        {"count": 5, "offset": 0.6, "on_pad": True},
        {"count": 5, "preload": 0.024},
        {"count": 6, "pad_inertia": 1e-3, "pivot_stiffness": 3e8},
        {"count": 3, "k": 1e9},
    ],
)
def test_a_journal_rests_at_one_place_wherever_it_is_looked_for(given, load):
    """Pads without preload begin to bear with the root of the approach."""
    part = _part(**given)
    film = BearingAlone(part, _SPEED)
    d = film.rest(-1j * load)
    assert abs(d.real) < 1e-6 * _C
    for start in (0.02 * _C * cmath.exp(1j), -0.6j * _C, 0.5 * _C, (0.3 + 0.4j) * _C):
        found = BearingAlone(part, _SPEED).rest(-1j * load, start)
        assert abs(found - d) < 2e-6 * _C
    mirrored = BearingAlone(_mirrored(part), -_SPEED).rest(-1j * load)
    assert abs(-mirrored.conjugate() - d) < 2e-6 * _C


def test_a_journal_that_is_free_across_its_load_rests_below_the_middle():
    """On one pad of three: it may move until another begins to bear."""
    film = BearingAlone(_part(3, on_pad=True), _SPEED)
    load = 200.0
    for start in (None, 0.3 * _C, (-0.2 - 0.1j) * _C):
        d = film.rest(-1j * load, start)
        assert abs(d.real) < 1e-6 * _C
        assert film.pad_loads(d) == pytest.approx([load, 0.0, 0.0], rel=1e-5)


def test_a_pad_whose_pivot_gives_bears_on_while_its_film_lets_it_go():
    """On a rigid pivot its load ends at once; on a spring it falls with the pivot's displacement,
    so that the bearing's force has no jump."""
    part = _part(6, offset=0.53, pivot_stiffness=1.3e8)
    pivot = _pivots(part)[0]
    radial = np.linspace(0.05, -0.4, 91)
    films = [BearingAlone(part, _SPEED) for _ in radial]
    forces = [film.force(r * _C * pivot) for film, r in zip(films, radial, strict=True)]
    alone = np.array([-f * pivot.conjugate() for f in forces]).real
    assert np.abs(np.diff(alone)).max() < 0.1 * np.abs(alone).max()


def _root(x):
    return math.copysign(math.sqrt(abs(x)), x)


@pytest.mark.parametrize(
    ("force", "load", "rest"),
    [
        (lambda d: complex(-_root(d.real), -_root(d.imag)), 3.0 - 4.0j, 9.0 - 16.0j),
        (lambda d: complex(-_root(d.real), -d.imag), -2.0j, -2.0j),
        # a wall that begins to bear with a jump, from 1 N to 3 N, at a displacement of 1
        (lambda d: complex(-d.real, -d.imag + (2.0 if d.imag < -1.0 else 0.0)), -2.0j, -1.0j),
        # free across the load
        (lambda d: complex(0.0, -d.imag), -0.5j, -0.5j),
    ],
)
def test_the_least_of_a_potential_in_closed_form(force, load, rest):
    found = rest_in_potential(force, load, 1.0)
    assert found == pytest.approx(rest, abs=1e-4)


def test_a_load_that_nothing_bears_has_no_rest():
    assert rest_in_potential(lambda d: 0j, -1j, 1e-4) is None
