"""Bodies, sections, gravity, base, ports and starts, each against what it must be equal to."""

import math

import numpy as np
import pytest
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import RotorWarning, Simulation
from rotor_fmu.model.structure.assembly import assemble
from rotor_fmu.model.structure.places import places

from rotor_fmu.fmu.binding import build_simulation
from rotor_fmu.fmu.interface import interface

from .machines import bearings, rigid

STEEL = "[material]\nyoung = 2.1e11\ndensity = 7800.0\n"
HELD = """
[[linear_bearing]]
z = 0.0
kxx = 1e6
kyy = 2e6
cxx = 100.0
cyy = 150.0
[[linear_bearing]]
z = 0.4
kxx = 1e6
kyy = 2e6
cxx = 100.0
cyy = 150.0
"""
HUB = """
[[body]]
z = 0.6
mass = 3.0
I_d = 0.02
I_p = 0.03
"""


def sections(*lengths, **keys):
    told = "\n".join(f"{key} = {value}" for key, value in keys.items())
    return "".join(f"[[section]]\nlength = {length}\n{told}\n" for length in lengths)


def pinned_frequencies(machine, pins=(0, -2)):
    """Natural frequencies [rad/s] at standstill with some dofs pinned."""
    s = assemble(machine)
    M, K = to_dense(s.M), to_dense(s.K)
    free = np.setdiff1d(np.arange(len(M)), np.arange(len(M))[list(pins)])
    at = np.ix_(free, free)
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M[at], K[at])).real))


def end_of(text, duration=0.01, h=1e-4, speed=150.0, loads=None, probe=0):
    sim = Simulation(parse_rotor(text), choose("robust", h=h), speed=speed, rate=500.0, loads=loads)
    for t in np.linspace(0, duration, 5)[1:]:
        sim.advance(t, speed + 500.0 * sim.time, loads)
    return sim.motion.q[sim.structure.probes[probe].dof], sim


# --- shaft and bodies ---


def test_a_body_beyond_its_node_moves_as_on_a_rigid_stub():
    shaft = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + HELD
    e = "e = 2e-4\nphase = 0.4\n"
    sensor = "[[sensor]]\nz = 0.6\n"
    stub = "[material.rigid]\nyoung = 1e15\ndensity = 1e-3\n" + shaft.replace(
        HELD, sections(0.05, outer=0.03, material='"rigid"') + HELD
    ).removeprefix(STEEL)
    offset, sim = end_of(shaft + HUB + "offset = 0.05\n" + e + sensor, probe=1)
    there, other = end_of(STEEL + stub + HUB.replace("z = 0.6", "z = 0.65") + e + sensor, probe=1)
    assert offset == pytest.approx(there, rel=1e-5)
    for name in ("tau", "energy.kinetic", "energy.gravity"):
        assert sim.read(name) == pytest.approx(other.read(name), rel=1e-5)


def test_a_load_on_a_body_beyond_its_node_acts_at_its_centre_and_is_seen_there():
    """A rigid rotor on two springs k at 0 and L, a force F at the centre of a body a beyond its
    node at b: springs yield by F (1 - s) / k and F s / k, s = (b + a) / L, and the rotor is
    straight."""
    k, force, b, a, length = 1e6, 300.0, 0.6, 0.05, 0.4
    rigid_shaft = STEEL.replace("2.1e11", "1e16") + sections(0.2, 0.2, 0.2, outer=0.03)
    held = HELD.replace("2e6", "1e6")
    machine = parse_rotor("gravity = 0.0\n" + rigid_shaft + held + HUB + f"offset = {a}\n")
    sim = Simulation(machine, choose("robust"), loads=np.array([force + 0j]))
    s = (b + a) / length
    left, right = force * (1 - s) / k, force * s / k
    assert sim.read("body[1].x") == pytest.approx(left + (right - left) * s, rel=1e-4)
    q = sim.motion.q
    node, slope = q[6].real, q[7].real
    assert node == pytest.approx(left + (right - left) * b / length, rel=1e-4)
    assert sim.read("body[1].x") == pytest.approx(node + a * slope, rel=1e-9)
    assert sim.read("body[1].x_amp") == 0.0


@pytest.mark.parametrize("modes", [0, 12])
def test_a_loaded_body_beyond_its_node_moves_as_on_a_rigid_stub(modes):
    shaft = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + HELD
    stub = "[material.rigid]\nyoung = 1e15\ndensity = 1e-3\n" + shaft.replace(
        HELD, sections(0.05, outer=0.03, material='"rigid"') + HELD
    ).removeprefix(STEEL)
    seen = []
    for text in (
        shaft + HUB + "offset = 0.05\ne = 2e-4\n",
        STEEL + stub + HUB.replace("z = 0.6", "z = 0.65") + "e = 2e-4\n",
    ):
        sim = Simulation(parse_rotor(text), choose("robust", h=1e-4, reduction=modes), speed=150.0)
        for i in range(20):
            sim.advance(1e-3 * (i + 1), 150.0, np.array([200.0 * i - 50.0j]))
        names = [f"body[1].{axis}{amp}" for axis in "xy" for amp in ("", "_amp")]
        seen.append([sim.read(name) for name in (*names, "energy.external_work", "energy.kinetic")])
    assert seen[0] == pytest.approx(seen[1], rel=1e-4 if modes == 0 else 1e-3)


def test_the_ledger_closes_with_a_body_beyond_its_node():
    text = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + HELD + HUB + "offset = 0.05\ne = 2e-4\n"
    residuals = [abs(end_of(text, 0.02, h)[1].read("energy.residual")) for h in (1e-4, 5e-5)]
    assert math.log2(residuals[0] / residuals[1]) == pytest.approx(2, abs=0.3)


def test_tension_raises_the_frequency_of_a_pinned_beam_as_that_of_a_string():
    length, d, force = 1.0, 0.01, 2e4
    machine = STEEL + sections(length, outer=d, elements=8)
    bending = 2.1e11 * math.pi / 64 * d**4
    plain, tight = (
        pinned_frequencies(parse_rotor(machine + f"axial_force = {f}\n"))[0] for f in (0.0, force)
    )
    raised = 1 + force * length**2 / (math.pi**2 * bending)
    # shear and rotary inertia are of the order (d / length)^2
    assert (tight / plain) ** 2 == pytest.approx(raised, rel=5e-4)


def test_a_sleeve_of_the_same_metal_makes_the_solid_shaft():
    solid = parse_rotor(STEEL + sections(2.0, outer=0.02, elements=6))
    layered = parse_rotor(
        STEEL
        + sections(2.0, outer=0.012, elements=6)
        + "[[section.layer]]\nbore = 0.012\nouter = 0.02"
    )
    assert assemble(layered).mass_sum == pytest.approx(assemble(solid).mass_sum, rel=1e-12)
    np.testing.assert_allclose(
        pinned_frequencies(layered)[:3], pinned_frequencies(solid)[:3], rtol=1e-3
    )


def test_a_tapered_section_weighs_what_a_frustum_does():
    text = STEEL + sections(0.5, outer_left=0.02, outer_right=0.04, bore=0.01, elements=5)
    mass = 7800 * 0.5 * math.pi * ((0.01**2 + 0.01 * 0.02 + 0.02**2) / 3 - 0.005**2)
    assert assemble(parse_rotor(text)).mass_sum[::2].sum() == pytest.approx(mass, rel=1e-12)


def test_a_disc_with_a_bore_and_a_metal_of_its_own():
    disc = '[[disc]]\nz = 0.2\ndiameter = 0.2\nwidth = 0.03\nbore = 0.03\nmaterial = "brass"\n'
    brass = "[material.brass]\nyoung = 1e11\ndensity = 8500.0\n"
    (part,) = parse_rotor(STEEL + brass + sections(0.2, 0.2, outer=0.03) + disc).discs
    mass = 8500 * math.pi * (0.1**2 - 0.015**2) * 0.03
    assert part.mass(7800.0) == pytest.approx(mass)
    assert part.polar_inertia(7800.0) == pytest.approx(mass * (0.1**2 + 0.015**2) / 2)


WRONG = [
    ("outer = 0.03", "", "section[1].outer is missing"),
    ("outer = 0.03", "outer = 0.03\nbore = 0.04", "section[1].bore_left = 0.04 m: must be below"),
    ("outer = 0.03", "outer = 0.03\nouter_left = 0.04", "section[1].outer: is given beside"),
    ("outer = 0.03", "outer = 0.03\nelements = 0", "section[1].elements = 0: must be an integer"),
    ("outer = 0.03", 'outer = 0.03\nmaterial = "bras"', "section[1].material = 'bras'"),
    ("outer = 0.03", "outer = 0.03\nlenght = 1", "section[1].lenght: unknown key; did you mean"),
    ("z = 0.6", "z = 0.59", "body[1].z = 0.59 m: no node is there; the nearest is node 4 at 0.6 m"),
    ("z = 0.6", "z = 0.6\nnode = 4", "body[1].z: is given beside body[1].node"),
    ("z = 0.6", "node = 9", "body[1].node = 9: must be an integer from 1 to 4"),
]


@pytest.mark.parametrize(("old", "new", "named"), WRONG)
def test_a_wrong_shaft_is_refused_by_name(old, new, named):
    text = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + HELD + HUB
    with pytest.raises(QuantityError) as refused:
        parse_rotor(text.replace(old, new, 1))
    assert named in str(refused.value)
    assert "\n" not in str(refused.value)


def test_layers_that_overlap_are_refused():
    layer = "[[section.layer]]\nbore = 0.01\nouter = 0.04"
    with pytest.raises(QuantityError, match="must not be below the outer diameter of what lies"):
        parse_rotor(STEEL + sections(0.2, outer=0.03) + layer)


# --- gravity, base, start, ports ---

FLEXIBLE = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + HELD + HUB
SEAL = "[[seal]]\nz = 0.2\nkxx = 1e5\nkyy = 1e5\nkxy = 5e4\nkyx = -5e4\ncxx = 40.0\ncyy = 40.0\n"


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
    with pytest.warns(RotorWarning, match="unstable at rest"):
        sim = Simulation(rotor)
    found = modes(rotor, 0.0, count=20).eigenvalues
    growing = found[np.argmax(found.real)]
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
    ends = [end_of(text, 0.01, h, loads=loads)[0] for h in (5e-5, 2.5e-5, 1.25e-5)]
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
    with pytest.raises(QuantityError, match="the name 'amb' is there already"):
        parse_rotor(text + port)
    with pytest.raises(QuantityError, match=r"port.name = 'a.b': must be a word"):
        parse_rotor(text.replace('"amb"', '"a.b"'))


# --- the ledger of a drop ---


def touchdown(node, housing):
    return f"""
[[touchdown_bearing]]
node = {node}
journal_radius = 0.03
clearance = 0.25e-3
mu = 0.2
k = 5e7
c = 500.0
race_inertia = 1e-4
race_drag = 0.01
race_damping = 1e-5
housing = "{housing}"
"""


SEATS = "".join(
    f'[[housing]]\nname = "{n}"\nmass = 0.5\nkx = 1e7\nky = 1e7\ncx = 500.0\ncy = 500.0\n'
    for n in "ab"
)
DROPPED = (
    STEEL
    + sections(0.1, 0.2, 0.2, 0.1, outer=0.05)
    + "[[disc]]\nnode = 3\ndiameter = 0.25\nwidth = 0.03\ne = 2e-5\n[start]\ny = 1e-5\n"
    + SEATS
    + touchdown(2, "a")
)


@pytest.mark.parametrize(
    ("k", "more"),
    [
        ("5e7", ""),
        ("5e9", "exponent = 1.5\n"),
        ("5e7", "wear = 5e-5\n"),
        ("5e9", "exponent = 1.5\nwear = 5e-5\nmu_rise = 0.1\n"),
    ],
)
def test_the_ledger_closes_in_a_drop_with_spin_up_and_rub(k, more):
    machine = DROPPED + touchdown(4, "b").replace("k = 5e7", f"k = {k}") + more
    sim = Simulation(parse_rotor(machine), choose("robust", h=5e-6), speed=300.0)
    for t in np.linspace(0, 0.2, 101)[1:]:
        sim.advance(t, 300.0)
    lost = sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
    assert sim.read("touchdown_bearing[1].race") > 250.0
    assert sim.read("energy.drag_loss") > 0
    assert abs(sim.read("energy.residual")) < 1e-4 * lost


def test_a_free_rotor_and_its_races_keep_what_friction_does_not_take():
    machine = parse_rotor(DROPPED + touchdown(4, "b"))
    sim = Simulation(machine, choose("robust", h=5e-6), speed=300.0, drive_torque=0.0)
    sim.advance(0.1, 0.0)
    lost = sum(sim.read(name) for name in sim.names if name.endswith("_loss"))
    assert sim.read("w") < 299.5
    assert sim.read("energy.drive_work") == pytest.approx(0, abs=1e-5 * lost)
    assert abs(sim.read("energy.residual")) < 1e-4 * lost


def test_a_run_with_races_goes_on_from_a_snapshot_bit_for_bit():
    sim = Simulation(parse_rotor(DROPPED + touchdown(4, "b")), choose("controlled"), speed=300.0)
    sim.advance(0.02, 300.0)
    there = sim.snapshot()
    sim.advance(0.04, 300.0)
    once = sim.observed.copy()
    sim.restore(there)
    sim.advance(0.04, 300.0)
    np.testing.assert_array_equal(sim.observed, once)


# --- elsewhere: component modes, the FMU's variables ---


def test_all_component_modes_are_the_whole_machine():
    text = FLEXIBLE + "offset = 0.02\ne = 1e-4\n" + SEAL + "[base]\n"
    flight = text + touchdown(2, "") + "[start]\ny = 1e-5\ntilt_x = 1e-4\n"
    for machine in (text, flight):
        ends = []
        for kept in (0, 50):
            settings = choose("robust", h=5e-5, reduction=kept)
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
    found = places(machine)
    assert list(found) == [name for name, _, _ in machine.parameters()]
    for name, _, value in machine.parameters():
        for place in found[name]:
            member, _, code = place.member.partition("[")
            rows = getattr(structure, member)
            rows = rows[int(code.rstrip("]"))] if code else rows
            assert rows[place.row][place.field] == value
