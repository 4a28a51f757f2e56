"""Whirls on tilting pads that follow each at its own frequency."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import bearing_curves
from rotor_fmu.model.linear import campbell, modes
from rotor_fmu.model.linear.frequency_response import (
    ControlLoop,
    frequency_response,
    sensitivity,
)
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.linear.subsynchronous import SubsynchronousWhirl, subsynchronous_whirl
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.linear.where_linearized import where_linearized, where_not_reached
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.machine_report import report_page

from ..known import EXAMPLES
from ..parts.films import film, in_films
from ..parts.machines import shaft
from ..toml_text import table

SPEED = 1000.0


def on_pads(q, **changes):
    """Text of a disc between tilting pads, with a cross coupling [N/m]."""
    pads = {"pads": [math.radians(54 + 72 * i) for i in range(5)], "arc": 0.9, "preload": 0.3}
    pads |= changes
    film = {"journal_radius": 0.04, "length": 0.04, "clearance": 6e-5, "viscosity": 0.015}
    text = table("material", young=2.1e11, density=7850.0)
    text += table("shaft", nodes=[0.0, 0.5, 1.0], diameters=[0.08, 0.08])
    text += table("[disc]", node=2, diameter=0.5, width=0.08, e=1e-6)
    text += table("[seal]", node=2, kxx=0.0, kyy=0.0, kxy=q, kyx=-q, cxx=0.0, cyy=0.0)
    for node in (1, 3):
        text += table("[journal_bearing]", node=node, **film, **pads, tilting=True, points=8)
    return text


def steep(mass=1100.0, inclination=1.4591, **changes):
    """A heavy, stiff rotor on pads, on soft pivots unless changed, which it presses little."""
    text = table("material", young=2.1e11, density=7850.0)
    text += table("shaft", nodes=[0.0, 0.1, 0.2], diameters=[0.08, 0.08])
    text += table("[body]", node=2, mass=mass, I_d=mass / 365.0, I_p=mass / 550.0)
    pads = {"pads": [math.radians(45 + 90 * i) for i in range(4)], "arc": 1.3, "preload": 0.2}
    film = {"journal_radius": 0.04, "length": 0.03, "clearance": 8e-5, "viscosity": 0.02}
    pads |= {"tilting": True, "pivot_stiffness": 1e8} | changes
    text += "".join(table("[journal_bearing]", node=node, **film, **pads) for node in (1, 3))
    return replace(parse_rotor(text), inclination=inclination)


def test_its_decrement_is_the_width_of_the_peak_of_the_frequency_response():
    """In which pads follow the force: it is several times as narrow as with pads that follow the
    rotation."""
    rotor = parse_rotor(on_pads(5.5e5))
    whirl = subsynchronous_whirl(rotor, SPEED)
    half = whirl.log_dec / (2 * math.pi)
    at = [whirl.frequency * (1 + share * half) for share in (-1, 0, 1)]
    found = frequency_response(rotor, at, 2, [2], speed=SPEED)
    below, peak, above = abs(found.receptance[:, 0, 1, 1])
    assert (peak / below) ** 2 + (peak / above) ** 2 == pytest.approx(4.0, rel=0.02)
    slower = modes(rotor, SPEED).damped < SPEED
    assert whirl.synchronous == modes(rotor, SPEED).log_dec[slower].min() > 5 * whirl.log_dec


def test_a_campbell_diagram_has_the_threshold_of_a_whirl_that_pads_follow():
    """That of the mass on each bearing, which the load of a steep machine lets whirl from a speed
    on to another; with synchronous coefficients it never does."""
    rotor, speeds = steep(), [400.0, 500.0, 650.0, 950.0]
    diagram, alone = campbell(rotor, speeds), bearing_curves(rotor, speeds)
    assert (diagram.damping_ratio > 0).all()
    assert alone.turns == pytest.approx([582.0, 782.0], rel=0.01)
    assert diagram.threshold == pytest.approx(alone.threshold, rel=1e-4)


def test_a_whirl_that_pads_with_inertia_damp_is_stable_though_they_drive_one_with_the_rotation():
    rotor = steep(100.0, 1.3, preload=0.0, pivot_stiffness=0.0, pad_inertia=1e-3)
    threshold = campbell(rotor, [400.0, 600.0, 800.0]).threshold
    assert modes(rotor, threshold - 10.0).growth > 0.01
    assert threshold == pytest.approx(bearing_curves(rotor, [400.0, 800.0]).threshold, rel=5e-3)


def test_a_peak_of_a_whirl_that_pads_follow_is_found_between_a_few_frequencies():
    """It lies beside the poles with pads that follow the rotation, and is much sharper."""
    rotor = steep()
    found, expected = (
        frequency_response(rotor, at, 1, [1], speed=800.0, peaks=peaks)
        for at, peaks in (([20.0, 2000.0], True), (np.linspace(211.0, 211.3, 301), False))
    )
    size = abs(found.receptance[:, 0, 0, 0])
    assert size.max() == pytest.approx(abs(expected.receptance[:, 0, 0, 0]).max(), rel=1e-3)
    whirl = subsynchronous_whirl(rotor, 800.0)
    assert found.frequencies[size.argmax()] == pytest.approx(whirl.frequency, rel=1e-5)


@pytest.mark.parametrize(("q", "is_unstable"), [(3e5, False), (8e5, True)])
def test_answers_say_what_it_is_and_where_it_grows(q, is_unstable):
    """Though with synchronous coefficients neither machine is unstable."""
    rotor = parse_rotor(on_pads(q))
    (least,) = [s for s in where_linearized(rotor, [100.0, SPEED]) if "least log dec" in s]
    assert least.startswith("at 159.15 Hz the least log dec of slower whirls is")
    assert "pads that tilt follow a vibration at the frequency" in " ".join(
        where_linearized(rotor, [SPEED])
    )
    assert where_linearized(rotor, [SPEED], follows_force=True) == [
        "oil films, each linearized where its journal rests at that speed: "
        "journal_bearing[1], journal_bearing[2]"
    ]
    said = where_not_reached(rotor, [SPEED])
    assert len(said) == is_unstable
    assert all("Hz grows, which its pads follow" in sentence for sentence in said)


def test_lower_modes_of_housings_alone_hide_no_whirl():
    """Five housings that nothing couples with the rotor, with two better damped modes each."""
    housings = ""
    for i in range(5):
        k, c = 1e3 * (1 + i), 30.0 * math.sqrt(1 + i)
        housings += table("[housing]", name=f"h{i}", mass=1.0, kx=k, ky=k, cx=c, cy=c)
    alone = subsynchronous_whirl(parse_rotor(on_pads(8e5)), SPEED)
    found = subsynchronous_whirl(parse_rotor(on_pads(8e5) + housings), SPEED)
    assert alone.is_growing
    assert tuple(found) == pytest.approx(tuple(alone), rel=1e-6)


@pytest.mark.parametrize(("speed", "is_said"), [(1500.0, True), (1000.0, False), (200.0, False)])
def test_what_is_critically_damped_has_no_number(speed, is_said):
    """By API 684 with an amplification factor below 2.5, a damping ratio above 0.2. Here whirls
    are so on a thick shaft with synchronous coefficients, with which at 200 rad/s none is left."""
    rotor = parse_rotor(on_pads(0.0).replace("0.08, 0.08", "0.2, 0.2"))
    whirl, found = subsynchronous_whirl(rotor, speed), modes(rotor, speed)
    slower = found.damping_ratio[found.damped < speed]
    assert (slower > 0.2).all()
    assert (whirl.synchronous == math.inf) == (len(slower) == 0)
    ratio = whirl.log_dec / math.hypot(2 * math.pi, whirl.log_dec)
    assert whirl.is_critically_damped == (ratio > 0.2) == (not is_said)
    said = [s for s in where_linearized(rotor, [speed]) if "least log dec" in s]
    assert len(said) == len(list(report_page._slower(whirl))) == is_said
    assert all(s.endswith("at its own frequency; here all are critically damped") for s in said)


@pytest.mark.parametrize(("log_dec", "is_met"), [(-0.02, False), (0.02, True)])
def test_the_report_concludes_whether_slower_whirls_decay(log_dec, is_met):
    (found,) = report_page._slower(SubsynchronousWhirl(log_dec, 300.0, 0.2))
    assert found.text.endswith(f"least log dec {log_dec}, of 47.746 Hz.")
    assert found.is_met == is_met
    assert not list(report_page._slower(None))


def test_cross_coupling_does_the_same_as_in_a_seal_that_carries_nothing():
    without, sealed = (replace(parse_rotor(on_pads(q)), gravity=0.0) for q in (0.0, 3e5))
    found = subsynchronous_whirl(without, SPEED, coupling=((2, 3e5),))
    assert found == pytest.approx(subsynchronous_whirl(sealed, SPEED), rel=1e-6)


def test_there_is_none_of_a_machine_slower_than_its_modes_or_without_pads():
    """Beside the modes of the shaft there is a whirl in the films, which is critically damped."""
    rotor = parse_rotor(on_pads(0.0))
    assert subsynchronous_whirl(rotor, 100.0).is_critically_damped
    fixed = parse_rotor(on_pads(0.0).replace("tilting = true", ""))
    assert subsynchronous_whirl(fixed, SPEED) is None


def test_an_answer_does_not_depend_on_what_was_asked_before():
    """Or a pad may bear, or not, where it just begins to, by the order of speeds."""
    rotor = parse_rotor(on_pads(0.0))
    asked, fresh = LinearMachine(rotor), LinearMachine(rotor)
    asked.at(3 * SPEED)
    for one, other in zip(asked.at(SPEED).laws, fresh.at(SPEED).laws, strict=True):
        assert (one == other).all()


def is_stable(rotor, speed):
    """Whether control loops are that do next to nothing."""
    loop = ControlLoop("magnet", 2, 2, kp=1e-3, kd=0.0, force_per_current=1.0)
    return sensitivity(rotor, [50.0], [loop], speed=speed).is_stable


@pytest.mark.parametrize("q", [5.5e5, 8e5])
def test_control_loops_are_as_stable_as_whirls_which_pads_follow(q):
    rotor = parse_rotor(on_pads(q))
    assert modes(rotor, SPEED).growth < 0.0
    assert is_stable(rotor, SPEED) == (subsynchronous_whirl(rotor, SPEED).log_dec > 0.0)


@pytest.mark.parametrize("speed", [440.0, 460.0])
def test_control_loops_are_as_stable_as_the_whirls_of_floating_rings(speed):
    rotor = load_rotor(EXAMPLES / "turbocharger" / "rotor.toml")[1]
    assert is_stable(rotor, speed) == (modes(rotor, speed).growth < 0.0)


def test_the_critical_mass_is_that_at_which_a_machine_of_it_begins_to_whirl():
    """Where pads that follow the rotation would leave each mass unstable, as a pad that bears
    little, pivoted behind its middle, is negatively stiff to fast motions."""
    pads = {"pads": (5.178, 0.989, 3.084), "arc": 1.644, "offset": 0.745, "tilting": True}
    found = bearing_curves(in_films(**pads), [-400.0], load=2.0)
    assert np.linalg.det(found.K[0]) > 0.0 > np.trace(found.K[0])
    for share, grows in ((0.999, False), (1.001, True)):
        mass = share * found.critical_mass[0]
        body = table("[body]", node=2, mass=2 * mass, I_d=4e-3 * mass, I_p=1e-6 * mass)
        light = shaft(0.0, 0.1, 0.2, material=table("material", young=2.1e13, density=1e-4))
        rotor = parse_rotor(
            f"gravity = {2.0 / mass}\n{light}{body}{film(1, **pads)}{film(3, **pads)}"
        )
        whirl = subsynchronous_whirl(rotor, -400.0)
        assert whirl.is_growing == grows
        assert whirl.frequency == pytest.approx(found.whirl[0], rel=1e-3)
