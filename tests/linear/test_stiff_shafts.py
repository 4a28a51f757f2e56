"""Shafts as stiff as those of textbooks: linear answers against closed forms of the rigid rotor."""

import numpy as np
import pytest
from rotor_fmu.model.linear import campbell, modes, static, unbalance_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.structure.assembly import assemble

from rotor_fmu.linear import answers
from rotor_fmu.linear.machine_warnings import machine_warnings

LENGTH, DIAMETER, DENSITY = 1.0, 0.1, 1.0
MASS, I_D, I_P = 10.0, 0.1, 0.2
K, C, SPEED = 1e6, 100.0, 300.0
# Of the hub and of the shaft about its middle
SHAFT = DENSITY * np.pi / 4 * DIAMETER**2 * LENGTH
TOTAL = MASS + SHAFT
DIAMETRAL = I_D + SHAFT * (LENGTH**2 / 12 + DIAMETER**2 / 16)
POLAR = I_P + SHAFT * DIAMETER**2 / 8


def machine(young, elements, more="", shaft="", c=C):
    bearing = f"[[linear_bearing]]\nkxx = {K}\nkyy = {K}\ncxx = {c}\ncyy = {c}\n"
    return parse_rotor(f"""
[material]
young = {young}
density = {DENSITY}
[shaft]
{shaft}
[[section]]
length = {LENGTH}
outer = {DIAMETER}
elements = {elements}
[[body]]
node = {elements // 2 + 1}
mass = {MASS}
I_d = {I_D}
I_p = {I_P}
{bearing}node = 1
{bearing}node = {elements + 1}
{more}
""")


def rigid_roots():
    """Of the rigid rotor: twice m s^2 + 2 c s + 2 k, and of its tilt in complex coordinates
    I_d s^2 + (c l^2 / 2 - i Omega I_p) s + k l^2 / 2; imaginary parts > 0, by size."""
    bounce = np.roots([TOTAL, 2 * C, 2 * K])
    tilt = np.roots([DIAMETRAL, C * LENGTH**2 / 2 - 1j * SPEED * POLAR, K * LENGTH**2 / 2])
    roots = np.array([*bounce[bounce.imag > 0], *bounce[bounce.imag > 0], *tilt])
    roots = roots.real + 1j * np.abs(roots.imag)
    return roots[np.argsort(np.abs(roots))]


DAMPED = "eta_v = 1e-4\nrotating_damping = true\neta_h = 1e-3"


@pytest.mark.parametrize(
    ("elements", "shaft"),
    [(4, ""), (20, DAMPED), (60, ""), pytest.param(60, DAMPED, marks=pytest.mark.slow)],
)
def test_a_stiff_and_light_shaft_has_the_modes_of_a_rigid_rotor(elements, shaft):
    exact = rigid_roots()
    result = modes(machine(2e18, elements, shaft=shaft), SPEED, count=4)
    np.testing.assert_allclose(result.eigenvalues, exact, rtol=2e-8)
    np.testing.assert_allclose(result.log_dec, -2 * np.pi * exact.real / exact.imag, rtol=1e-7)
    assert result.is_sound.all()
    assert result.whirl[2:] == ("backward", "forward")


def test_beside_bending_modes_that_are_faster_by_many_decades_the_rigid_ones_are_held():
    stiff, stiffer = 2e18, 2e22
    rotor = machine(stiffer, 4)
    result = modes(rotor, SPEED, count=8)
    # the bending modes are below the rounding of the rigid ones, and known from a softer shaft
    bending = modes(machine(stiff, 4), SPEED, count=8).natural[-1] * np.sqrt(stiffer / stiff)
    assert bending > 1e8 * result.natural[0]
    assert result.is_held
    bounce = min(abs(rigid_roots()))
    below, above = (modes(rotor, share * bounce, count=8).growth for share in (0.5, 2.0))
    assert max(below, above) < 0.0
    critical = campbell(rotor, np.array([0.5, 1.5]) * bounce, count=8).critical
    assert [c.speed for c in critical[:2]] == pytest.approx([bounce, bounce], rel=1e-3)


def test_the_modes_come_nearer_to_the_rigid_ones_as_the_shaft_stiffens():
    off = [
        np.abs(modes(machine(young, 20), SPEED, count=4).eigenvalues / rigid_roots() - 1).max()
        for young in (2e13, 2e14, 2e15, 2e16)
    ]
    np.testing.assert_allclose(np.log10(off[:-1]) - np.log10(off[1:]), 1.0, atol=0.01)


@pytest.mark.parametrize("young", [2.1e11, 2e18])
def test_the_lowest_frequency_of_a_machine_does_not_depend_on_rounding(young):
    lowest = assemble(machine(young, 60)).numbers[0].lowest_omega
    result = modes(machine(young, 4), 0.0, count=1).natural[0]
    assert lowest == pytest.approx(result, rel=2e-4)


def test_a_rigid_rotor_answers_to_unbalance_as_it_should():
    amount, z = 1e-4, 0.25
    more = f"[[unbalance]]\nz = {z}\namount = {amount}\n"
    result = unbalance_response(machine(2e18, 20, more), [SPEED])
    arm = z - LENGTH / 2
    push = amount * SPEED**2
    along = push / (2 * K + 2j * SPEED * C - SPEED**2 * TOTAL)
    tilted = (K + 1j * SPEED * C) * LENGTH**2 / 2 - SPEED**2 * (DIAMETRAL - POLAR)
    tilt = push * arm / tilted
    exact = along + tilt * (result.z - LENGTH / 2)
    np.testing.assert_allclose(result.forward[0], exact, rtol=1e-7)
    ends = (K + 1j * SPEED * C) * exact[[0, -1]]
    np.testing.assert_allclose(result.load_x[0], ends, rtol=1e-7)


@pytest.mark.parametrize("elements", [20, 60, 500])
def test_bearings_and_pins_of_a_stiff_shaft_bear_its_weight_by_the_lever(elements):
    hung = machine(
        2e18,
        elements,
        "[[contact]]\nz = 0.75\njournal_radius = 0.05\nclearance = 1e-4\nk = 1e8\nmu = 0.1\n",
    )
    # in the order of the parts: the contact, both bearings
    opened, pinned = (static(hung, contacts=word) for word in ("open", "pinned"))
    weight = TOTAL * 9.81
    np.testing.assert_allclose(opened.load_y, [0.0, -weight / 2, -weight / 2], rtol=1e-7)
    # pinned at z = 3 / 4 the rigid beam turns about it against its springs
    turn = weight * 0.25 / (K * (0.75**2 + 0.25**2))
    left, right = -K * 0.75 * turn, K * 0.25 * turn
    np.testing.assert_allclose(pinned.load_y, [-weight - left - right, left, right], rtol=1e-6)


@pytest.mark.parametrize(("length", "outer", "bore"), [(10.0, 1.0, 0.1), (0.02, 0.003, 0.0)])
def test_a_shaft_sags_as_timoshenkos_beam_whatever_its_size(length, outer, bore):
    young, density, poisson, gravity = 2.1e11, 7850.0, 0.3, 9.81
    area, ratio = np.pi / 4 * (outer**2 - bore**2), bore / outer
    inertia, around = np.pi / 64 * (outer**4 - bore**4), (1 + ratio**2) ** 2
    cowper = 6 * (1 + poisson) * around
    cowper /= (7 + 6 * poisson) * around + (20 + 12 * poisson) * ratio**2
    load, shear = density * area * gravity, cowper * young / (2 * (1 + poisson)) * area
    stiffness = 100 * young * inertia / length**3
    bearing = f"[[linear_bearing]]\nkxx = {stiffness}\nkyy = {stiffness}\ncxx = 0.0\ncyy = 0.0\n"
    result = static(
        parse_rotor(
            f"[material]\nyoung = {young}\ndensity = {density}\npoisson = {poisson}\n"
            f"[[section]]\nlength = {length}\nouter = {outer}\nbore = {bore}\nelements = 20\n"
            f"{bearing}z = 0.0\n{bearing}z = {length}\n"
        )
    )
    z = result.z
    sag = load * z / (24 * young * inertia) * (length**3 - 2 * length * z**2 + z**3)
    sag += load * z * (length - z) / (2 * shear) + load * length / (2 * stiffness)
    np.testing.assert_allclose(result.y, -sag, rtol=1e-12)


def test_modes_of_a_steel_shaft_of_many_elements_are_found():
    """Rounding of its stiffness hid the equilibrium of five hundred."""
    few, many = (modes(machine(2.1e11, n), SPEED, count=4).eigenvalues for n in (20, 500))
    np.testing.assert_allclose(few, many, rtol=1e-6)


def test_modes_are_found_where_damping_crowds_the_eigenvalues():
    """At -1 / eta_v, beside which the tilting modes of sixty elements were not found."""
    few, many = (modes(machine(2.1e11, n, shaft="eta_v = 1e-3"), SPEED) for n in (20, 60))
    np.testing.assert_allclose(few.eigenvalues, many.eigenvalues, rtol=1e-5)
    assert few.damping_ratio[[0, 1, 3, 4]].max() < 0.2


def test_modes_that_rounding_hides_are_said_and_are_no_instability():
    rotor = machine(2e26, 4)
    result = modes(rotor, SPEED)
    assert result.is_sound[:4].all()
    assert not result.is_sound[4:].any()
    np.testing.assert_allclose(result.eigenvalues[:4], rigid_roots(), rtol=1e-9)
    title = answers.modes(rotor, SPEED).table().title
    assert "of mode 5, 6, 7, 8 rounding leaves residuals up to" in title
    assert "rounding" not in answers.modes(machine(2e18, 4), SPEED, count=4).table().title
    assert campbell(rotor, [0.0, SPEED]).threshold is None
    assert machine_warnings(rotor) == []


@pytest.mark.parametrize("young", [2e16, pytest.param(2e18, marks=pytest.mark.slow), 2e20])
def test_rounding_of_a_stiff_shaft_without_damping_is_no_instability(young):
    """Its bending modes are a million times faster than those of the rigid rotor, and known to that
    share of rounding."""
    assert campbell(machine(young, 4, c=0.0), np.linspace(10.0, 900.0, 10)).threshold is None


def test_a_stiff_shaft_that_damps_has_the_lines_of_a_rigid_rotor_alone():
    damped = machine(2e15, 20, shaft="eta_v = 1e-4")
    diagram = campbell(damped, [0.0, 300.0, 600.0])
    assert diagram.eigenvalues.shape == (3, 4)
    assert np.isfinite(diagram.eigenvalues).all()
