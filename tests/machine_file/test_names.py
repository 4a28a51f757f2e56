"""Parts by their names, and parts placed between the nodes of a shaft."""

import numpy as np
import pytest
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.parts.support import Support

import rotor_fmu as rf
from rotor_fmu.fmi.interface import interface
from rotor_fmu.runs.run_down import usual
from rotor_fmu.runs.synchronous_response import largest_synchronous_response

from ..parts.machines import shaft
from ..toml_text import refusal_of, table

SUPPORTS = "".join(table("[support]", node=node, stiffness=1e7) for node in (1, 3))
SIMPLE = "gravity = 0.0\n" + shaft(0.0, 0.3, 0.9, diameter=0.03) + SUPPORTS
HUB = "[[disc]]\nz = 0.5\ndiameter = 0.2\nwidth = 0.05\n"


def test_every_part_may_have_a_name_which_its_variables_have():
    toml = (
        rig_toml()
        .replace("[[disc]] ", '[[disc]]\nname = "impeller" ')
        .replace("[[bearing]]", '[[bearing]]\nname = "drive_end"', 1)
    )
    rotor = parse_rotor(toml)
    table = {v.name: v for v in interface(rotor)}
    assert {"impeller.e", "impeller.fx", "impeller.x_amp", "drive_end.clearance"} <= set(table)
    assert table["impeller.e"].text == "impeller: eccentricity of the centre of mass"
    assert table["impeller.fx"].text.startswith("external force on impeller at z = ")
    assert {"impeller.x", "drive_end.psi", "disc[2].x"} <= set(usual(rotor))
    assert rotor.with_value("impeller.e", 1e-5).discs[0].e == 1e-5


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (("fan", "fan"), "disc[5].name = fan: disc[4] has this name already"),
        (("two words",), "disc[4].name = 'two words': must be a word of letters a to z, digits"),
        (
            ("1st_stage",),
            "disc[4].name = '1st_stage': must be a word of letters a to z, digits and "
            "_ that does not begin with a digit",
        ),
        (("Laufrad_groß",), "disc[4].name = 'Laufrad_groß': must be a word of letters a to z"),
        (("solver",), "disc[4].name = solver: is reserved, as the name of variables"),
        (("bearing",), "disc[4].name = bearing: is reserved, as the name of a part type"),
    ],
)
def test_a_name_that_cannot_be_is_one_line(names, expected):
    toml = rig_toml()
    for name in names:
        toml += f'\n[[disc]]\nname = "{name}"\nz = 0.2\ndiameter = 0.1\nwidth = 0.02\n'
    assert expected in refusal_of(toml)


def test_a_part_between_two_nodes_splits_the_mesh():
    """Its modes are those of the same shaft with a node given there."""
    rotor = parse_rotor(SIMPLE + HUB)
    assert rotor.nodes == pytest.approx((0.0, 0.3, 0.5, 0.9))
    assert [disc.node for disc in rotor.discs] == [3]
    assert [support.node for support in rotor.of_kind(Support)] == [1, 4]
    given = SIMPLE.replace("[0.0, 0.3, 0.9]", "[0.0, 0.3, 0.5, 0.9]")
    given = given.replace("diameters = [0.03,", "diameters = [0.03, 0.03,")
    same = parse_rotor(given.replace("node = 3", "node = 4") + HUB)
    mine, other = (modes(r, count=4).damped for r in (rotor, same))
    np.testing.assert_allclose(mine, other, rtol=1e-9)


def test_a_hollow_tapered_section_with_a_sleeve_keeps_its_inertia_where_it_is_split():
    text = """
    [material]
    young = 2.1e11
    density = 7800.0
    [[section]]
    length = 1.0
    outer_left = 0.05
    outer_right = 0.08
    bore = 0.02
    [[section.layer]]
    bore_left = 0.05
    bore_right = 0.08
    outer = 0.1
    """
    whole = parse_rotor(text)
    split = parse_rotor(text + "[[sensor]]\nz = 0.3\n[[sensor]]\nz = 0.8\n[[sensor]]\nz = 0.3\n")
    assert len(split.nodes) == 4
    inertias = [
        sum(layer.polar_inertia for section in rotor.sections for layer in section.all_layers)
        for rotor in (whole, split)
    ]
    assert inertias[0] == pytest.approx(inertias[1], rel=1e-12)
    middle = split.sections[1]
    assert (middle.outer_left, middle.outer_right) == pytest.approx((0.059, 0.074))
    assert middle.layers[0].bore_right == pytest.approx(0.074)


@pytest.mark.parametrize(
    ("z", "expected"),
    [
        ("1.2", "sensor[1].z = 1.2 m: must lie on the shaft, from 0 to 0.9 m"),
        ("0.30001", "sensor[1].z = 0.30001 m: is 1e-05 m from the node at 0.3 m; must be at it"),
        ("true", "sensor[1].z = True: must be a number"),
        ("0.5\nnode = 1", "sensor[1].z: cannot be combined with sensor[1].node"),
    ],
)
def test_a_place_where_no_node_can_be_is_one_line(z, expected):
    assert expected in refusal_of(SIMPLE + f"[[sensor]]\nz = {z}\n")


def test_probes_bodies_and_linear_bearings_are_recorded_and_the_one_that_moves_most_is_drawn():
    """Of an overhung rotor: the probe at its end moves most."""
    toml = (
        SIMPLE.replace("node = 3", "node = 2")
        + "[[body]]\nname = 'hub'\nz = 0.6\nmass = 5.0\nI_d = 0.01\nI_p = 0.02\ne = 1e-4\n"
        + "[[linear_bearing]]\nz = 0.1\nkxx = 1e6\nkyy = 1e6\ncxx = 1e3\ncyy = 1e3\n"
        + "[[sensor]]\nname = 'tip'\nz = 0.9\n"
    )
    result = rf.simulate(rf.parse(toml), speed=60.0, stop=1.0)
    assert {"hub.x", "tip.x", "linear_bearing[1].x"} <= set(result.names)
    places = result.recording.places
    assert result.recording.place().name == "tip"
    assert [p.name for p in places] == ["hub", "linear_bearing[1]", "tip"]
    result.plot("orbit", "hub")
    assert result.orbit("linear_bearing[1]").z.size > 0


def test_of_places_that_move_as_much_a_body_stands_for_a_machine_and_no_bearing_at_its_node():
    """A motor's core rather than its magnetic pull, which is given as a bearing and comes last."""
    pull = "[[linear_bearing]]\nname = 'pull'\nnode = 2\nkxx = -1e4\nkyy = -1e4\ncxx = 0\ncyy = 0\n"
    core = "[[body]]\nname = 'core'\nnode = 2\nmass = 5.0\nI_d = 0.01\nI_p = 0.02\ne = 1e-4\n"
    recording = rf.simulate(rf.parse(SIMPLE + core + pull), speed=60.0, stop=1.0).recording
    assert [place.name for place in recording.places] == ["core", "pull"]
    assert recording.place().name == "core"
    response = largest_synchronous_response(recording)
    assert response
    assert response.place.name == "core"
