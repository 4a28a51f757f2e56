"""Gravity, base, housings, starts, ports, component modes, each against what it must be equal to;
what an FMU says of a machine."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import RotorNote, Simulation
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.parameter_locations import parameter_locations

from rotor_fmu.fmi.binding import build_simulation
from rotor_fmu.fmi.interface import interface

from .machines import (
    DROPPED,
    FLEXIBLE,
    HELD,
    HUB,
    SEAL,
    STEEL,
    bearings,
    end_of,
    rigid,
    sections,
    touchdown,
)


def test_a_vertical_machine_feels_no_gravity():
    q, _ = end_of(f"inclination = {math.pi / 2}\n" + FLEXIBLE)
    none, _ = end_of("gravity = 0.0\n" + FLEXIBLE)
    assert q == pytest.approx(none, abs=1e-18)


def test_gravity_turned_by_a_right_angle_pulls_to_the_right():
    isotropic = FLEXIBLE.replace("kyy = 2e6", "kyy = 1e6").replace("cyy = 150.0", "cyy = 100.0")
    down, _ = end_of(isotropic)
    right, _ = end_of(f"gravity_angle = {math.pi / 2}\n" + isotropic)
    assert right == pytest.approx(1j * down, rel=1e-9)
    assert down.imag < 0 < right.real


def test_a_base_that_accelerates_upwards_is_gravity():
    seat = '[[housing]]\nname = "seat"\nmass = 2.0\nkx = 1e7\nky = 1e7\ncx = 50.0\ncy = 50.0\n'
    text = FLEXIBLE.replace("cxx", 'housing = "seat"\ncxx', 1) + "e = 1e-4\n" + seat
    still, sim = end_of(text)
    loads = np.array([0.0, 9.81j])
    risen, other = end_of("gravity = 0.0\n" + text + "[base]\n", loads=loads)
    assert risen == pytest.approx(still, rel=1e-9)
    assert other.read("tau") == pytest.approx(sim.read("tau"), rel=1e-9)
    # the work of the base is what gravity gives
    given = other.read("energy.external_work")
    start = Simulation(parse_rotor(text), choose("robust"), speed=150.0)
    assert given == pytest.approx(
        start.read("energy.gravity") - sim.read("energy.gravity"), rel=1e-3, abs=1e-9
    )


SEAT = '[[housing]]\nname = "seat"\nmass = 2.0\nmass_ratio = 3.0\nkx = 1e6\nky = 4e6\n'


def test_a_housing_swings_with_one_mass_horizontally_and_another_vertically():
    """Out of the rotor's reach, pushed by its base: two oscillators without damping."""
    wall = (
        'node = 2\nhousing = "seat"\njournal_radius = 0.02\nclearance = 0.01\nmu = 0.1\nk = 1e7\n'
    )
    text = FLEXIBLE + SEAT + "cx = 0.0\ncy = 0.0\n[[contact]]\n" + wall + "[base]\n"
    sim = Simulation(parse_rotor(text), choose("robust", h=1e-5), speed=150.0)
    housing = len(sim.structure.M)
    start = sim.motion.q[housing]
    assert start == pytest.approx(-6.0 * 9.81j / 4e6, rel=1e-9)
    t = 0.004
    sim.advance(t, 150.0, np.array([0.0, 3.0 + 5.0j]))
    moved = sim.motion.q[housing] - start
    assert moved.real == pytest.approx(
        -2.0 * 3.0 / 1e6 * (1 - math.cos(math.sqrt(1e6 / 2.0) * t)), rel=1e-3
    )
    assert moved.imag == pytest.approx(
        -6.0 * 5.0 / 4e6 * (1 - math.cos(math.sqrt(4e6 / 6.0) * t)), rel=1e-3
    )
    assert abs(sim.read("energy.residual")) < 1e-4 * sim.read("energy.elastic")


def test_the_survey_sees_a_housings_masses_as_the_linear_answers_do():
    held = HELD.replace("cxx = 100.0", 'cxx = 1.0\nhousing = "seat"').replace(
        "cyy = 150.0", "cyy = 1.0"
    )
    text = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + held + HUB + SEAT + "cx = 5.0\ncy = 5.0\n"
    rotor = parse_rotor(text + SEAL.replace("5e4", "8e5"))
    with pytest.warns(RotorNote, match="unstable at rest"):
        sim = Simulation(rotor)
    result = modes(rotor, 0.0, count=20).eigenvalues
    growing = result[np.argmax(result.real)]
    assert growing.real > 0
    assert complex(sim._run.survey.rest[0]) == pytest.approx(
        complex(growing.real, abs(growing.imag)), rel=1e-6
    )


def test_the_order_is_2_with_every_linear_part():
    seat = '[[housing]]\nname = "seat"\nmass = 2.0\nkx = 1e7\nky = 1e7\ncx = 50.0\ncy = 50.0\n'
    text = FLEXIBLE.replace("cxx", 'housing = "seat"\ncxx', 1) + "offset = 0.02\ne = 1e-4\n"
    text = text.replace("outer = 0.03", "outer_left = 0.03\nouter_right = 0.032\naxial_force = 1e4")
    text += seat + SEAL + "[base]\n"
    loads = np.array([0.0, 3.0 + 1.0j])
    ends = [end_of(text, 0.1, h, loads=loads)[0] for h in (2e-4, 1e-4, 5e-5)]
    ratio = abs(ends[0] - ends[1]) / abs(ends[1] - ends[2])
    assert math.log2(ratio) == pytest.approx(2, abs=0.05)


def test_a_released_rotor_flies_a_parabola_and_tilts_about_its_centre_of_mass():
    start = "[start]\nx = 1e-4\nvx = 0.1\nvy = 0.2\ntilt_y = 1e-3\nrate_x = 0.05\n"
    wall = "[[contact]]\nnode = 2\njournal_radius = 0.05\nclearance = 1.0\nmu = 0.1\nk = 1e6\n"
    sensors = "".join(f'[[sensor]]\nnode = {n}\nname = "n{n}"\n' for n in (1, 2, 3))
    sim = Simulation(
        parse_rotor(rigid(gravity=9.81, parts=wall + sensors, rest=start)), choose("robust", h=1e-5)
    )
    assert sim.read("n3.y") - sim.read("n1.y") == pytest.approx(1e-4)
    sim.advance(0.01, 0.0)
    assert sim.read("n2.x") == pytest.approx(1e-4 + 0.1 * 0.01, rel=1e-9)
    assert sim.read("n2.y") == pytest.approx(0.2 * 0.01 - 9.81 / 2 * 1e-4, rel=1e-9)
    assert sim.read("n2.vy") == pytest.approx(0.2 - 9.81 * 0.01, rel=1e-9)
    assert sim.read("n3.x") - sim.read("n1.x") == pytest.approx(0.05 * 0.01 * 0.1, rel=1e-6)


def test_a_port_is_called_by_its_name_once():
    port = '[[port]]\nnode = 2\nname = "amb"\n'
    text = rigid(parts=bearings(1e4, 10.0) + port)
    assert {"amb.x", "amb.vy"} <= set(Simulation(parse_rotor(text)).names)
    with pytest.raises(
        QuantityError, match=r"port\[2\]\.name = amb: port\[1\] has this name already"
    ):
        parse_rotor(text + port)
    with pytest.raises(QuantityError, match=r"port\[1\]\.name = 'a.b': must be a word"):
        parse_rotor(text.replace('"amb"', '"a.b"'))


def test_all_component_modes_are_the_whole_machine():
    text = FLEXIBLE + "offset = 0.02\ne = 1e-4\n" + SEAL + "[base]\n"
    flight = text + touchdown(2, "") + "[start]\ny = 1e-5\ntilt_x = 1e-4\n"
    for machine in (text, flight):
        ends = []
        for retained in (0, 50):
            settings = choose("robust", h=5e-5, reduction=retained)
            loads = np.array([2.0, 3.0 + 1.0j])
            sim = Simulation(parse_rotor(machine), settings, speed=150.0, loads=loads)
            sim.advance(0.005, 150.0, loads)
            ends.append([sim.read(f"body[1].{axis}") for axis in "xy"])
        np.testing.assert_allclose(ends[1], ends[0], rtol=1e-6)


def test_the_fmu_has_the_inputs_outputs_and_parameters_of_its_parts():
    base = '[base]\n[[port]]\nnode = 3\nname = "amb"\n'
    machine = parse_rotor(DROPPED + touchdown(4, "b") + base)
    table = interface(machine)
    kinds = {v.name: v.causality for v in table}
    expected = {
        "base.ax": "input", "base.ay": "input", "amb.fx": "input", "amb.vy": "output",
        "touchdown_bearing[2].race": "output", "touchdown_bearing[1].race_inertia": "parameter",
        "start.y": "parameter", "gravity": "parameter",
    }  # fmt: skip
    assert expected.items() <= kinds.items()
    values = {v.name: v.start for v in table if v.start is not None}
    values["start.y"] = 2e-5
    ends = []
    for change in ({"base.ay": 9.81, "gravity": 0.0}, {}):
        sim = build_simulation(machine, table, values | change, warn=pytest.fail)
        assert sim.read("amb.y") == pytest.approx(2e-5)
        sim.advance(0.01, 400.0)
        ends.append((sim.read("amb.x"), sim.read("amb.vy")))
    assert ends[0] == pytest.approx(ends[1], rel=1e-6)


def test_every_parameter_of_the_parts_has_its_place_in_an_assembled_machine():
    machine = parse_rotor(DROPPED + touchdown(4, "b") + HELD.replace("z = 0.4", "z = 0.5"))
    structure = assemble(machine)
    result = parameter_locations(machine)
    assert list(result) == [of.name for of in machine.parameters().values()]
    for name, _, value in machine.parameters().values():
        for place in result[name]:
            member, _, code = place.member.partition("[")
            rows = getattr(structure, member)
            rows = rows[int(code.rstrip("]"))] if code else rows
            assert rows[place.row][place.field] == value
