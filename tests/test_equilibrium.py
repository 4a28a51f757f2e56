"""Rest under gravity: statics of the reactions, and the sag by integrating the bending moments."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.rest import rest
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.dense import clearance_contacts

from .machines import disc_dofs, overhung
from .statics import reactions_of_two_pins, sag_of_discs, total_weight

RIG = rig()
FIRST, LAST = RIG.bearings
G = RIG.gravity


def reactions(rotor):
    """Upward forces of the housings on the journals [N] at rest."""
    q = rest(rotor)
    up = []
    for bearing in clearance_contacts(assemble(rotor)):
        d = q[bearing.dof] - q[bearing.end]
        up.append(-bearing.k * max(0.0, abs(d) - bearing.clearance) * d.imag / abs(d))
    return np.array(up)


def test_the_rig_sags_as_statics_and_mohrs_integral_say():
    ends = [RIG.nodes[bearing.node - 1] for bearing in (FIRST, LAST)]
    carried = reactions_of_two_pins(RIG, *ends)
    heights = []
    for bearing, reaction in zip((FIRST, LAST), carried, strict=True):
        housing = (reaction + bearing.mass * G) / bearing.ky
        heights.append(-bearing.clearance - reaction / bearing.k - housing)
    discs = [RIG.nodes[d.node - 1] for d in RIG.discs]
    expected = np.interp(discs, ends, heights) - sag_of_discs(RIG, *ends)
    np.testing.assert_allclose(rest(RIG).imag[disc_dofs(RIG)], expected, rtol=1e-7)
    np.testing.assert_allclose(reactions(RIG), carried, rtol=1e-9)


def test_the_third_disc_of_the_rig_rests_where_an_independent_prototype_put_it():
    sim = Simulation(RIG, choose("robust"))
    assert sim.read("disc[3].y") == pytest.approx(-238.3e-6, abs=0.3e-6)
    for j in (1, 2):
        assert sim.read(f"bearing[{j}].psi") == pytest.approx(math.radians(270), abs=1e-9)
        assert abs(sim.read(f"bearing[{j}].x")) < 1e-10 * FIRST.clearance
        assert sim.read(f"bearing[{j}].contact") == 1


THIRD = {
    "with two bearings side by side": (3, 50e-6),
    "with a tight bearing amid": (5, 10e-6),
    "with a bearing amid that almost lifts": (5, 300e-6),
    "with a bearing amid that carries nothing": (5, 500e-6),
}


@pytest.mark.parametrize("case", THIRD)
def test_the_bearings_carry_the_weight_also(case):
    node, clearance = THIRD[case]
    middle = replace(FIRST, node=node, clearance=clearance)
    rotor = RIG.with_parts(Bearing, FIRST, middle, LAST)
    up = reactions(rotor)
    assert up.sum() == pytest.approx(total_weight(rotor), rel=1e-9)
    if case == "with a bearing amid that carries nothing":
        np.testing.assert_allclose(up[[0, 2]], reactions(RIG), rtol=1e-7)
        assert up[1] == 0


@pytest.mark.parametrize("node", [3, 4])
def test_an_overhung_rotor_is_held_down_at_its_first_bearing(node):
    rotor = RIG.with_parts(Bearing, FIRST, replace(LAST, node=node))
    ends = [rotor.nodes[bearing.node - 1] for bearing in rotor.bearings]
    carried = reactions_of_two_pins(rotor, *ends)
    assert carried[0] < 0
    np.testing.assert_allclose(reactions(rotor), carried, rtol=1e-9)


def test_supports_carry_what_the_bearings_do_not():
    rotor = RIG.with_parts(Support, Support(5, 1e5))
    spring = -1e5 * rest(rotor)[2 * 4].imag
    assert reactions(rotor).sum() + spring == pytest.approx(total_weight(rotor), rel=1e-9)


@pytest.mark.parametrize("rotor", [RIG, overhung()])
def test_without_gravity_all_rests_at_zero(rotor):
    assert np.all(rest(replace(rotor, gravity=0.0)) == 0)


@pytest.mark.parametrize("parts", [4, 16])
def test_the_rest_does_not_depend_on_how_finely_the_shaft_is_divided(parts):
    def moved(part):
        return replace(part, node=(part.node - 1) * parts + 1)

    fine = replace(
        RIG,
        sections=tuple(
            replace(s, length=s.length / parts) for s in RIG.sections for _ in range(parts)
        ),
        parts=tuple(map(moved, RIG.parts)),
    )
    found, expected = (rest(rotor).imag[disc_dofs(rotor)] for rotor in (fine, RIG))
    np.testing.assert_allclose(found, expected, rtol=1e-7)


SOFT = {"clearance": 1e-6, "k": 1e4, "ky": 2e3}  # by 17 mm, half of what a machine reaches


@pytest.mark.parametrize("name", SOFT)
def test_a_rotor_that_sinks_far_compared_with_its_clearance_still_rests(name):
    first = replace(FIRST, **{name: SOFT[name]})
    np.testing.assert_allclose(
        reactions(RIG.with_parts(Bearing, first, LAST)), reactions(RIG), rtol=1e-6
    )


LOOSE = {
    "one bearing": RIG.with_parts(Bearing, FIRST),
    "one support": RIG.with_parts(Bearing).with_parts(Support, Support(4, 1e6)),
}


@pytest.mark.parametrize("case", LOOSE)
def test_a_rotor_that_nothing_keeps_from_tilting_is_refused(case):
    with pytest.raises(EquilibriumError, match="no static equilibrium: the rotor is held at 1 "):
        rest(LOOSE[case])


def test_a_clearance_of_ten_metres_is_said_to_be_too_large():
    far = RIG.with_parts(Bearing, replace(FIRST, clearance=10.0), replace(LAST, clearance=10.0))
    with pytest.raises(EquilibriumError, match=r"beyond 0.033 m.*clearances .* must be smaller"):
        rest(far)


def test_a_shaft_too_stiff_to_calculate_with_is_not_said_to_be_loose():
    with pytest.raises((EquilibriumError, QuantityError)) as refused:
        rest(parse_rotor(rig_toml().replace("young = 2.1e11", "young = 1e25")))
    assert "held at" not in str(refused.value)
