"""Modes in which housings move alone, while the rotor rests."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import LinearError, campbell, modes
from rotor_fmu.model.linear.critical_map import critical_map
from rotor_fmu.model.linear.unbalance_placement import placed_unbalances
from rotor_fmu.model.machine.toml import rig

from rotor_fmu.linear import answers
from rotor_fmu.linear.mode_answers import mode_shapes_figure
from tests.machines import overhung


def test_modes_of_equal_housings_stay_the_lines_that_they_are():
    """Six modes of one frequency, whose shapes at a speed are any of those of that frequency."""
    seals = [replace(rig().bearings[0], node=n, kx=4e7, ky=4e7, mass=4.0) for n in (1, 2, 3)]
    diagram = campbell(overhung(others=seals), np.linspace(10.0, 500.0, 9), count=18)
    assert diagram.damped.shape == (9, 18)
    of_housings = np.abs(diagram.natural / math.sqrt(1e7) - 1).max(axis=0) < 1e-9
    assert of_housings.sum() == 6


def test_housings_that_move_alone_are_the_shape_and_say_how_they_whirl():
    """In lines, along x and y apart: the nodes have no motion but rounding."""
    seals = [replace(rig().bearings[0], node=n, kx=4e7, ky=3e7, mass=4.0) for n in (1, 2, 3)]
    found = modes(overhung(others=seals), 300.0, count=18)
    alone = np.isin(np.round(found.natural**2), (7.5e6, 1e7))
    assert alone.sum() == 6
    for parts in (found.x, found.y, found.slope_x, found.slope_y):
        assert not parts[alone].any()
    sizes = np.hypot(np.abs(found.housing_x), np.abs(found.housing_y))
    assert sizes[alone].max(axis=1) == pytest.approx(1.0)
    assert {found.whirl[mode] for mode in np.flatnonzero(alone)} == {"planar"}


def test_modes_of_housings_alone_are_none_that_unbalances_could_excite():
    seals = [replace(rig().bearings[0], node=n, kx=4e5, ky=3e5, mass=4.0) for n in (1, 2, 3)]
    with_seals, without = overhung(others=seals), overhung()
    for mode in range(1, 7):
        assert placed_unbalances(with_seals, mode, 300.0) == placed_unbalances(without, mode, 300.0)
    with pytest.raises(LinearError, match="mode = 7: must be an integer from 1 to 6"):
        placed_unbalances(with_seals, 7, 300.0)


@pytest.mark.parametrize("synchronous", [True, False])
@pytest.mark.parametrize("ky", [4e5, 3e5])
def test_housings_alone_have_no_critical_speeds(ky, synchronous):
    seals = [replace(rig().bearings[0], node=n, kx=4e5, ky=ky, mass=4.0) for n in (1, 2, 3)]
    stiffness = np.geomspace(1e5, 1e8, 9)
    seen, expected = (
        np.sort(critical_map(rotor, stiffness, synchronous=synchronous).speeds)
        for rotor in (overhung(others=seals), overhung())
    )
    np.testing.assert_allclose(seen, expected, rtol=1e-9)


def test_tables_and_pictures_say_where_housings_move_alone():
    seals = [replace(rig().bearings[0], node=n, kx=4e5, ky=3e5, mass=4.0) for n in (1, 2, 3)]
    shown = answers.modes(overhung(others=seals), count=6)
    assert "; in mode 3, 4, 5, 6 housings move alone" in shown.table().title
    flat = mode_shapes_figure(shown).axes[3]
    assert flat.get_title().endswith(", planar, housings alone")
    assert flat.get_ylim() == flat.get_zlim() == (-1.0, 1.0)
