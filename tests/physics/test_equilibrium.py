"""Rest under gravity: statics of the reactions, and the sag by integrating the bending moments."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig, rig_toml
from rotor_fmu.model.parts.bearing import Bearing
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, Simulation
from rotor_fmu.model.structure.assembly import assemble

from papers.dense_machine import clearance_contacts, rest

from ..machines import disc_dofs, overhung
from ..toml_text import refusal_of, table
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
    result, expected = (rest(rotor).imag[disc_dofs(rotor)] for rotor in (fine, RIG))
    np.testing.assert_allclose(result, expected, rtol=1e-7)


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
    with pytest.raises(EquilibriumError, match="the rotor is supported at 1 of its nodes"):
        rest(LOOSE[case])


def test_a_clearance_of_ten_metres_is_said_to_be_too_large():
    far = RIG.with_parts(Bearing, replace(FIRST, clearance=10.0), replace(LAST, clearance=10.0))
    with pytest.raises(EquilibriumError, match=r"beyond 0.033 m.*clearances .* must be smaller"):
        rest(far)


def test_a_shaft_too_stiff_to_calculate_with_is_not_said_to_be_loose():
    with pytest.raises((EquilibriumError, QuantityError)) as refused:
        rest(parse_rotor(rig_toml().replace("young = 2.1e11", "young = 1e25")))
    assert "supported at" not in str(refused.value)


def stiff(young, density, outer, elements):
    """A stiff shaft of 1 m with 10 kg in its middle, on a bearing of 1e6 N/m at each end."""
    bearing = "[[linear_bearing]]\nkxx = 1e6\nkyy = 1e6\ncxx = 1.0\ncyy = 1.0\nnode = {}\n"
    return (
        f"[material]\nyoung = {young}\ndensity = {density}\n[[section]]\nlength = 1.0\n"
        f"outer = {outer}\nelements = {elements}\n"
        f"[[point_mass]]\nnode = {elements // 2 + 1}\nmass = 10.0\n"
        f"{bearing.format(1)}{bearing.format(elements + 1)}"
    )


TOO_STIFF = stiff(2e18, 1e-3, 0.3, 60)


def test_a_shaft_that_rounding_makes_loose_is_said_to_be_too_stiff():
    machine = parse_rotor(TOO_STIFF)
    with pytest.raises(EquilibriumError, match=r"rounding hides that of its supports, 2e\+06 N/m"):
        rest(machine)


@pytest.mark.parametrize(("young", "elements"), [(2e13, 60), (2e15, 60), (2e16, 20)])
def test_a_textbooks_rigid_shaft_rests_on_its_bearings(young, elements):
    """Steps in which rounding no longer shrinks are distinguished from those that lead on."""
    q = rest(parse_rotor(stiff(young, 1.0, 0.1, elements)))
    weight = (10.0 + math.pi / 4 * 0.1**2) * 9.81
    np.testing.assert_allclose(q[[0, 2 * elements]].imag, -weight / 2e6, rtol=1e-5)


@pytest.mark.parametrize("inclination", [math.pi / 2, 1.5708, -math.pi / 2, 1.5 * math.pi])
def test_a_vertical_machine_between_its_contacts_has_no_weight_across(inclination):
    vertical = replace(RIG, inclination=inclination)
    assert np.all(rest(vertical) == 0)
    simulation = Simulation(vertical, speed=100.0)
    simulation.advance(0.01, 100.0)
    assert simulation.read("disc[1].r_amp") > 0


def test_a_machine_that_leans_lies_on_its_bearings_by_the_share_of_the_cosine():
    leaning = replace(RIG, inclination=1.57)
    np.testing.assert_allclose(
        reactions(leaning).sum(), total_weight(RIG) * math.cos(1.57), rtol=1e-9
    )


def worn(wear, angle=math.pi / 2, both=True):
    """The rig with bores worn in a direction, upwards for one; the second bearing too or not."""
    first, last = (replace(b, wear=wear, wear_angle=angle) for b in (FIRST, LAST))
    return RIG.with_parts(Bearing, first, last if both else LAST)


@pytest.mark.parametrize(
    "wear",
    [1.1e-4, 1e-3, *(pytest.param(wear, marks=pytest.mark.slow) for wear in (1.3e-4, 2e-4))],
)
@pytest.mark.parametrize("both", [True, False], ids=["both", "one"])
def test_a_bore_worn_opposite_the_load_holds_the_journal_beside_the_hump(wear, both):
    """s = c + w (1 + cos(psi - pi / 2)) / 2: the lowest point of the bore is where the cosine of
    the angle from the bottom is c / w + 1 / 2, and the bottom a hump where that is below 1. It is
    the same on either side, and journals may lie on different ones."""
    simulation = Simulation(worn(wear, both=both))
    clearance = FIRST.clearance + 14.0 / FIRST.k  # half of the weight presses it in
    lowest = math.acos(clearance / wear + 0.5)
    aside = simulation.read("bearing[1].psi") - 1.5 * math.pi
    assert abs(aside) == pytest.approx(lowest, rel=0.02)
    assert (abs(simulation.read("bearing[2].psi") - 1.5 * math.pi) > 0.1) == both
    # and it stays: on the hump it fell off by itself
    before = simulation.motion.q.copy()
    simulation.advance(0.2, 0.0)
    np.testing.assert_allclose(simulation.motion.q, before, atol=1e-9 * clearance)


@pytest.mark.parametrize("wear", [1.1e-4, 1.3e-4])
def test_rounding_does_not_choose_the_side_of_a_hump_on_which_a_journal_lies(wear):
    angles = [math.pi / 2 * (1.0 + few * 2.0**-52) for few in (-4, -1, 0, 1, 4)]
    asides = [Simulation(worn(wear, angle)).motion.q for angle in angles]
    for other in asides[1:]:
        np.testing.assert_allclose(other, asides[0], atol=1e-9 * FIRST.clearance)


@pytest.mark.parametrize(("wear", "angle"), [(9e-5, math.pi / 2), (2e-4, 1.5 * math.pi)])
def test_a_bore_worn_less_or_below_the_load_holds_it_at_the_bottom(wear, angle):
    simulation = Simulation(worn(wear, angle))
    for j in (1, 2):
        assert simulation.read(f"bearing[{j}].psi") == pytest.approx(1.5 * math.pi, abs=1e-9)


def test_a_hump_without_a_rest_beside_it_is_said():
    with pytest.raises(
        EquilibriumError, match="rests on the ridge of its worn bore; change wear_angle"
    ):
        rest(worn(0.3))


@pytest.mark.parametrize(
    ("start", "node", "distance"),
    [("y = -0.05", 1, 0.05), ("x = 0.03\ny = 0.03", 1, 0.0424), ("tilt_x = 0.5", 1, 0.0907)],
)
def test_a_start_beyond_what_a_machine_reaches_is_refused(start, node, distance):
    rotor = parse_rotor(f"{rig_toml()}[start]\n{start}\n")
    with pytest.raises(EquilibriumError) as refused:
        Simulation(rotor)
    message = str(refused.value)
    assert message.startswith(f"[start]: node {node} lies {distance:.3g} m from the axis")
    assert message.endswith("must be within 0.033 m, a tenth of the shaft's length")


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("vx", "1e9", "start.vx = 1e+09 m/s: must be from -5000 to 5000"),
        ("vy", "-5001.0", "start.vy = -5001 m/s: must be from -5000 to 5000"),
        ("rate_y", "1e6", "start.rate_y = 1e+06 rad/s: must be from -100000 to 100000"),
    ],
)
def test_a_start_faster_than_a_machine_can_move_is_refused(key, value, words):
    assert refusal_of(f"{rig_toml()}\n[start]\n{key} = {value}\n") == words


def test_a_start_within_the_bound_is_taken():
    rotor = parse_rotor(f"{rig_toml()}[start]\ny = 0.03\n")
    simulation = Simulation(rotor)
    assert simulation.read("disc[3].y") == pytest.approx(0.03, rel=1e-9)
    simulation.advance(1e-4, 0.0)
    assert 0.02 < simulation.read("disc[3].y") < 0.03, "its bearings push it back"


@pytest.mark.parametrize("pivot", [0.0, 1e9])
@pytest.mark.parametrize("first", [4.712389, 1.5 * math.pi, 4.5])
def test_a_journal_at_standstill_lies_on_pads_that_tilt(first, pivot):
    """A pad without friction lets its journal go along it, up to the pad beside: with the load on a
    pad a rounding of its angle moves the journal there."""
    bearing = {
        **{"journal_radius": 0.05, "length": 0.05, "clearance": 1e-4, "viscosity": 0.02},
        **{"pads": [first + 0.4 * math.pi * i for i in range(5)], "arc": 1.0472, "preload": 0.3},
        **{"tilting": True, "pad_inertia": 1e-4, "pivot_stiffness": pivot, "k": 1e9},
    }
    shaft = table("material", young=2.1e11, density=7850.0) + table("shaft", eta_v=1e-5)
    shaft += table("[section]", length=1.2, elements=6, outer=0.1)
    machine = shaft + "".join(table("[journal_bearing]", z=z, **bearing) for z in (0.1, 1.1))
    simulation = Simulation(parse_rotor(machine), choose())
    weight = 1.2 * math.pi / 4 * 0.1**2 * 7850.0 * G
    for j in (1, 2):
        name = f"journal_bearing[{j}]"
        assert simulation.read(f"{name}.fy") == pytest.approx(0.5 * weight, rel=1e-6)
        assert abs(simulation.read(f"{name}.fx")) < 1e-6 * weight
        assert 0.9 < simulation.read(f"{name}.eccentricity") < 1.3
    before = simulation.motion.q.copy()
    simulation.advance(0.001, 0.0)
    np.testing.assert_allclose(simulation.motion.q, before, atol=1e-3 * bearing["clearance"])


@pytest.mark.parametrize("pivot", [0.0, 1e8])
def test_what_lies_on_pads_without_inertia_stays_there(pivot):
    """At standstill films carry nothing: what is left of a pad's moment is the rounding of its
    wall's force, and is none."""
    pads = {
        **{"pads": [(2 * i - 3) * math.pi / 4 for i in range(4)], "arc": 1.3, "offset": 0.5},
        **{"tilting": True, "pivot_stiffness": pivot, "k": 1e8, "mu": 0.1},
        **{"journal_radius": 0.01, "length": 0.01, "clearance": 5e-5, "viscosity": 0.02},
    }
    machine = table("material", young=2.1e11, density=7850.0) + table("shaft", eta_v=1e-5)
    machine += table("[section]", length=0.5, elements=6, outer=0.02)
    machine += table("[body]", z=0.25, mass=4.0, I_d=0.005, I_p=0.01)
    machine += "".join(table("[journal_bearing]", z=z, **pads) for z in (0.0, 0.5))
    simulation = Simulation(parse_rotor(machine), choose("robust"))
    before = simulation.motion.q.copy()
    simulation.advance(0.3, 0.0)
    np.testing.assert_allclose(simulation.motion.q, before, atol=1e-3 * pads["clearance"])


# on elastic pivots a machine is at rest on its pads above
@pytest.mark.parametrize("pivot", [0.0, pytest.param(1e8, marks=pytest.mark.slow)])
def test_a_machine_rests_where_a_pad_just_begins_to_bear(pivot):
    """The angle of the lower pad is rounded, as people write it: nothing holds the journal across,
    up to where another pad begins to bear with the square root of the way."""
    pads = {
        **{"pads": [4.712389, 0.523599, 2.617994], "arc": 1.4, "preload": 0.0, "tilting": True},
        **{"journal_radius": 0.02, "length": 0.02, "clearance": 5e-5, "viscosity": 0.00335},
    }
    machine = table("material", young=2.1e11, density=7850.0) + table("shaft", eta_v=1e-5)
    machine += table("[section]", length=0.5, elements=4, outer=0.04)
    for z in (0.0, 0.5):
        machine += table("[journal_bearing]", z=z, pivot_stiffness=pivot, points=8, **pads)
    simulation = Simulation(parse_rotor(machine), speed=100.0, warn=lambda _: None)
    weight = 0.5 * math.pi / 4 * 0.04**2 * 7850.0 * G
    for j in (1, 2):
        name = f"journal_bearing[{j}]"
        assert simulation.read(f"{name}.fy") == pytest.approx(0.5 * weight, rel=1e-6)
        assert abs(simulation.read(f"{name}.fx")) < 1e-6 * weight
