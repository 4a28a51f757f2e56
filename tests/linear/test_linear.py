"""Linear answers against textbooks and closed forms."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.linear import (
    LinearError,
    LinearMachine,
    campbell,
    modes,
    static,
    unbalance_response,
)
from rotor_fmu.model.machine.rotor import Rotor
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.body import PointMass
from rotor_fmu.model.parts.disc import Disc
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.parts.shaft import Material, Section
from rotor_fmu.model.parts.support import Support
from rotor_fmu.model.parts.unbalance import Unbalance

RPM = math.pi / 30
ROOT = Path(__file__).parents[2]
# Friswell, Penny, Garvey, Lees: Dynamics of Rotating Machines (2010), section 5.9
STEEL = Material(young=211e9, density=7810.0, poisson=211e9 / (2 * 81.2e9) - 1)


def shaft(elements):
    return tuple(Section.cylinder(1.5 / elements, 0.05, STEEL) for _ in range(elements))


def two_discs(elements, *supports):
    parts = (
        Disc(elements // 3 + 1, 0.28, 0.07, bore=0.05),
        Disc(2 * elements // 3 + 1, 0.35, 0.07, bore=0.05),
        *supports,
    )
    return Rotor(STEEL, shaft(elements), parts)


# Natural frequencies [rad/s] at rest and at 4000 rev/min, as printed there
PRINTED = {
    "5.9.1": (
        two_discs(6, Support(1, 1e6), Support(7, 1e6)),
        [86.66, 86.66, 274.31, 274.31, 716.78],
        [85.39, 87.80, 251.78, 294.71, 600.18],
    ),
    "5.9.2": (
        two_discs(6, *(LinearBearing(node=n, kxx=1e6, kyy=8e5, cxx=0, cyy=0) for n in (1, 7))),
        [82.65, 86.66, 254.52, 274.31, 679.49],
        [82.33, 86.86, 239.64, 287.25, 583.49],
    ),
    "5.9.9": (
        Rotor(
            STEEL,
            shaft(6),
            (Disc(7, 0.35, 0.07, bore=0.05), Support(1, 1e7), Support(5, 1e7)),
        ),
        [90.14, 90.14, 830.43, 830.43],
        [76.19, 103.91, 565.99, 647.75],
    ),
}


@pytest.mark.parametrize("case", PRINTED)
def test_natural_frequencies_are_the_textbooks_to_the_digits_printed(case):
    rotor, at_rest, turning = PRINTED[case]
    for speed, printed in ((0.0, at_rest), (4000 * RPM, turning)):
        result = modes(rotor, speed).natural
        # not all that lie between them are printed, and of 716.786 the last digit was cut off
        for omega in printed:
            assert np.abs(result - omega).min() < 0.0065


def test_damped_frequencies_are_the_textbooks_to_the_digits_printed():
    rotor = two_discs(6, Support(1, 1e6, 3e3), Support(7, 1e6, 3e3))
    at_rest, turning = (modes(rotor, s) for s in (0.0, 4000 * RPM))
    cases = [
        (at_rest.natural, [13.91, 13.91, 48.18, 48.18, 137.06, 137.06]),
        (at_rest.damped, [13.89, 13.89, 46.54, 46.54, 103.22, 103.22]),
        (turning.natural, [13.70, 14.09, 43.61, 52.18]),
        (turning.damped, [13.68, 14.07, 41.98, 50.65]),
    ]
    for result, printed in cases:
        np.testing.assert_allclose(result[: len(printed)] / (2 * math.pi), printed, atol=0.0051)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_the_last_mode_at_rest_may_share_its_frequency_with_one_that_is_not_shown(count):
    found = modes(PRINTED["5.9.9"][0], count=count)
    assert found.whirl == ("planar",) * count
    shapes = np.abs([found.x, found.y]).max(axis=2)  # each in x or in y
    np.testing.assert_allclose(np.sort(shapes, axis=0).T, [[0.0, 1.0]] * count, atol=1e-6)


def test_circles_turn_either_way_at_speed_and_neither_at_rest():
    rotor = PRINTED["5.9.1"][0]
    found = modes(rotor)
    assert set(found.whirl) == {"planar"}
    # one of each pair in x, the other in y
    sizes = np.abs(np.stack([found.x, found.y])).max(axis=2)
    np.testing.assert_allclose(sizes, np.tile(np.eye(2), len(found.whirl) // 2), atol=1e-6)
    for speed in (400.0, -400.0):
        assert modes(rotor, speed).whirl[:4] == ("backward", "forward", "backward", "forward")


def test_shapes_satisfy_the_equation_of_motion():
    rotor = two_discs(6, Support(1, 1e6, 3e3), Support(7, 1e6, 3e3))
    machine, result = LinearMachine(rotor), modes(rotor, 300.0)
    linear = machine.at(300.0)
    for i, value in enumerate(result.eigenvalues):
        planes = [result.x[i], result.y[i], result.slope_x[i], result.slope_y[i]]
        u = np.stack(planes, axis=1).ravel()
        terms = [value**2 * linear.M @ u, value * linear.D @ u, linear.K @ u]
        assert np.abs(sum(terms)).max() < 1e-7 * max(np.abs(t).max() for t in terms)


def test_many_elements_find_the_same_modes_as_few():
    """The sparse and the dense way."""
    few, many = (
        modes(two_discs(n, Support(1, 1e6, 300.0), Support(n + 1, 1e6, 300.0)), 300.0, count=4)
        for n in (24, 60)
    )
    np.testing.assert_allclose(few.eigenvalues, many.eigenvalues, rtol=1e-5)


def test_how_far_a_mode_whirls_forward_does_not_depend_on_where_nodes_are_many():
    """On bearings that differ in x and y, with ten times as many in the overhung half."""
    bearings = (LinearBearing(node=n, kxx=1e7, kyy=3e6, cxx=0, cyy=0) for n in (1, 5))
    rotor = Rotor(STEEL, shaft(8), (Disc(9, 0.35, 0.07, bore=0.05), *bearings))
    fine = tuple(Section.cylinder(1.5 / 80, 0.05, STEEL) for _ in range(40))
    disc = replace(rotor.parts[0], node=45)
    refined = replace(rotor, sections=(*shaft(8)[:4], *fine), parts=(disc, *rotor.parts[1:]))
    few, many = (modes(of, 400.0, count=6).forwardness for of in (rotor, refined))
    np.testing.assert_allclose(few, many, atol=0.03)


def test_a_rotor_that_damps_itself_loses_stability_where_zorzi_and_nelson_say():
    light = Material(young=2.1e11, density=1.0)
    half = Section.cylinder(0.2, 0.02, light)
    stiffness = 48 * light.young * math.pi / 64 * 0.02**4 / 0.4**3
    inner, outer, mass = 1e-5 * stiffness, 2e-5 * stiffness, 20.0
    rotor = Rotor(
        light,
        (half, half),
        (PointMass(node=2, mass=mass), Support(1, 1e12), Support(2, 0.0, outer), Support(3, 1e12)),
        eta_v=1e-5,
        rotating_damping=True,
    )
    omega = math.sqrt(stiffness / mass)
    diagram = campbell(rotor, np.linspace(0, 6 * omega, 7), count=2)
    # the shear of the shaft makes it a little softer
    assert diagram.threshold == pytest.approx(omega * (1 + outer / inner), rel=0.01)
    before, behind = (modes(rotor, f * diagram.threshold, count=2) for f in (0.999, 1.001))
    assert before.log_dec.min() > 0 > behind.log_dec.min()


def test_unbalance_moves_jeffcotts_disc_as_it_should():
    light = Material(young=2.1e11, density=1.0)
    half = Section.cylinder(0.2, 0.02, light)
    mass, damping, e = 5.0, 400.0, 1e-4
    parts = (
        PointMass(node=2, mass=mass),
        Support(1, 1e12),
        Support(2, 0.0, damping),
        Support(3, 1e12),
    )
    rotor = Rotor(light, (half, half), (*parts, Unbalance(2, mass * e, 0.4)))
    rest = static(Rotor(light, (half, half), parts))
    omega = math.sqrt(9.81 / -rest.y[1])
    speeds = omega * np.array([0.3, 1.0, 2.5])
    result = unbalance_response(rotor, speeds)
    exact = mass * e * np.exp(0.4j) * speeds**2
    exact /= mass * (omega**2 - speeds**2) + 1j * speeds * damping
    np.testing.assert_allclose(result.x[:, 1], exact, rtol=1e-4)
    np.testing.assert_allclose(result.y[:, 1], -1j * exact, rtol=1e-4)
    np.testing.assert_allclose(result.forward[:, 1], exact, rtol=1e-4)
    assert np.abs(result.backward).max() < 1e-9 * np.abs(exact).max()


def test_bearings_bear_the_unbalance_and_the_inertia():
    """Newton's law for the whole rotor: what its bearings bear is what pulls less m a."""
    light = Material(young=2.1e11, density=1e-3)
    parts = (
        PointMass(node=3, mass=20.0),
        PointMass(node=5, mass=30.0),
        Support(1, 1e6, 3e3),
        Support(7, 5e5),
    )
    sections = tuple(Section.cylinder(0.25, 0.05, light) for _ in range(6))
    speed, amount = 300.0, 1e-3 * np.exp(0.2j)
    result = unbalance_response(Rotor(light, sections, (*parts, Unbalance(3, 1e-3, 0.2))), [speed])
    assert result.supports == ("support[1]", "support[2]")
    for plane, share in (("x", 1.0), ("y", -1j)):
        borne = getattr(result, f"load_{plane}")[0].sum()
        u = getattr(result, plane)[0]
        pull = share * amount + 20.0 * u[2] + 30.0 * u[4]
        assert borne == pytest.approx(speed**2 * pull, rel=1e-6)


def test_pinned_bearings_of_the_rig_carry_its_weight():
    machine = LinearMachine(rig())
    result = static(rig())
    assert result.contacts == "pinned"
    s = machine.structure
    weight = s.numbers[0].gravity * s.mass_sum[::2].sum()
    assert result.load_y.sum() == pytest.approx(-weight, rel=1e-9)
    np.testing.assert_allclose(result.housing_y, result.y[[1, 7]])


def test_what_the_pins_of_the_rig_bear_under_unbalance_its_housings_bear_too():
    result = unbalance_response(rig(), [100.0])
    for plane in "xy":
        housing = rig().bearings[0]
        k, c = (getattr(housing, f"{of}{plane}") for of in "kc")
        z = getattr(result, f"housing_{plane}")[0]
        borne = (k + 100j * c - 100.0**2 * housing.mass) * z
        np.testing.assert_allclose(getattr(result, f"load_{plane}")[0], borne, rtol=1e-6)


def test_a_machine_that_nothing_holds_is_refused_but_for_its_modes():
    with pytest.raises(LinearError, match="not held"):
        static(rig(), contacts="open")
    free = modes(rig(), contacts="open", count=4)
    assert free.contacts == "open"


def test_a_free_rotor_precesses_as_a_rigid_one_and_is_unstable_nowhere():
    rotor = Rotor(STEEL, shaft(6), (Disc(4, 0.35, 0.07, bore=0.05),))
    # mass, polar and diametral moment of inertia about the middle, of shaft and disc
    inertias = []
    for outer, inner, length in ((0.05, 0.0, 1.5), (0.35, 0.05, 0.07)):
        mass = STEEL.density * math.pi / 4 * (outer**2 - inner**2) * length
        square = (outer**2 + inner**2) / 4
        inertias.append((mass * square / 2, mass * (3 * square + length**2) / 12))
    polar, diametral = np.sum(inertias, axis=0)
    turning = modes(rotor, 1.0)
    (conical,) = turning.damped[turning.damped < 2.0]
    assert conical == pytest.approx(polar / diametral, rel=1e-4)
    assert campbell(rotor, np.linspace(0.0, 60.0, 7)).threshold is None


def test_impossible_wishes_are_refused():
    for wish in (
        lambda: modes(rig(), contacts="ajar"),
        lambda: modes(rig(), float("nan")),
        lambda: modes(rig(), count=0),
        lambda: campbell(rig(), [1.0]),
        lambda: campbell(rig(), [2.0, 1.0]),
        lambda: unbalance_response(rig(), []),
        lambda: unbalance_response(rig(), [100.0], unbalances=[(4, float("nan"), 0.0)]),
        lambda: static(rig(), loads=[(9, 0.0, 1.0)]),
    ):
        with pytest.raises(LinearError):
            wish()
