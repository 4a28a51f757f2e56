"""Sections and bodies of a shaft, each against what it must be equal to."""

import math

import numpy as np
import pytest
from rotor_fmu.model.kernels.band import to_dense
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.structure.assembly import assemble

from ..toml_text import refusal_of
from .machines import (
    HELD,
    HUB,
    STEEL,
    end_of,
    sections,
)


def pinned_frequencies(machine, pins=(0, -2)):
    """Natural frequencies [rad/s] at standstill with some dofs pinned."""
    s = assemble(machine)
    M, K = to_dense(s.M), to_dense(s.K)
    free = np.setdiff1d(np.arange(len(M)), np.arange(len(M))[list(pins)])
    at = np.ix_(free, free)
    return np.sqrt(np.sort(np.linalg.eigvals(np.linalg.solve(M[at], K[at])).real))


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
    (
        "outer = 0.03",
        "outer = 0.03\nouter_left = 0.04",
        "section[1].outer: cannot be combined with",
    ),
    ("outer = 0.03", "outer = 0.03\nelements = 0", "section[1].elements = 0: must be an integer"),
    ("outer = 0.03", 'outer = 0.03\nmaterial = "bras"', "section[1].material = 'bras'"),
    ("outer = 0.03", "outer = 0.03\nlenght = 1", "section[1].lenght: unknown key; did you mean"),
    ("z = 0.6", "z = 0.61", "body[1].z = 0.61 m: must lie on the shaft, from 0 to 0.6 m"),
    ("z = 0.6", "z = 0.6\nnode = 4", "body[1].z: cannot be combined with body[1].node"),
    ("z = 0.6", "node = 9", "body[1].node = 9: must be an integer from 1 to 4"),
]


@pytest.mark.parametrize(("old", "new", "named"), WRONG)
def test_a_wrong_shaft_is_refused_by_name(old, new, named):
    text = STEEL + sections(0.2, 0.2, 0.2, outer=0.03) + HELD + HUB
    assert named in refusal_of(text.replace(old, new, 1))


def test_layers_that_overlap_are_refused_by_their_order_in_the_file():
    layers = "".join(f"[[section.layer]]\nbore = {d}\nouter = 0.05\n" for d in (0.04, 0.01))
    with pytest.raises(QuantityError, match=r"layer\[2\].bore_left = 0.01 m: must not be below"):
        parse_rotor(STEEL + sections(0.2, outer=0.03) + layers)
