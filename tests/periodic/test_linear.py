"""A machine without nonlinear parts, or whose parts touch nothing, has the linear answers."""

import re

import numpy as np
import pytest
from rotor_fmu.model.linear import response_with_peaks
from rotor_fmu.model.periodic import starting_points

import rotor_fmu as rf

from ..parts.machines import FLEXIBLE, SEAL, bearings, rigid
from .machines import CLEARANCE, OMEGA, jeffcott

UNBALANCE = "[[unbalance]]\nnode = {0}\namount = {1}\n[[sensor]]\nnode = {0}\n"
UNBALANCED = FLEXIBLE + SEAL + UNBALANCE.format(4, 1e-4)


@pytest.fixture(scope="module")
def both():
    machine = rf.parse(UNBALANCED)
    result = rf.response(machine, speed=(50.0, 400.0))
    return machine, result, machine.unbalance_response([p.value for p in result.points])


def test_it_responds_as_the_unbalance_response_says(both):
    _, result, linear = both
    for i, point in enumerate(result.points):
        n = 2 * len(linear.z)
        whole = point.motion[1].reshape(-1, 2)[:n:2]
        expected = np.column_stack([linear.x[i], linear.y[i]])
        assert np.abs(whole - expected).max() <= 1e-8 * np.abs(expected).max()


def test_half_of_its_range_is_its_amplitude_in_every_phase(both):
    _, result, _ = both
    half, once = (result.curve("sensor[1]", of).value for of in ("x_amp", "x_1x"))
    assert half == pytest.approx(once, rel=2e-5)


def test_it_hangs_where_gravity_holds_it(both):
    machine, result, _ = both
    point = result.points[20]
    static = machine.static(point.value)
    means = point.motion[0].real.reshape(-1, 2)[: 2 * len(static.z) : 2]
    assert means[:, 1] == pytest.approx(static.y, rel=1e-8)


def test_a_small_orbit_is_found_about_a_large_sag():
    """A well balanced machine on soft springs: it hangs a thousand times its orbit below."""
    small = rf.parse(rigid(1.0, 9.81, bearings(1e4, 20.0) + UNBALANCE.format(2, 1e-6)))
    found = rf.response(small, speed=(50.0, 60.0), stability=False)
    orbits = small.unbalance_response([p.value for p in found.points])
    assert found.curve("sensor[1]", "x_1x").value == pytest.approx(np.abs(orbits.x[:, 1]), rel=1e-6)


def test_its_multipliers_are_those_of_its_modes(both):
    machine, result, _ = both
    point = result.points[40]
    slowest = max(machine.modes(point.value).eigenvalues.real)
    growth = np.log(np.abs(point.multipliers[0])) * point.value / (2 * np.pi)
    assert growth == pytest.approx(slowest, rel=1e-7)


def test_a_seed_of_a_machine_without_contacts_is_searched_without_a_run_in_time(monkeypatch):
    monkeypatch.setattr(starting_points, "_simulation", None)
    found = rf.response(rf.parse(UNBALANCED), speed=(50.0, 100.0), seeds=(70.0,), stability=False)
    assert [note.code for note in found.notes] == ["no-motion"]


@pytest.mark.parametrize("damping", [pytest.param(1.0, marks=pytest.mark.slow), 1e-3])
def test_no_peak_lies_between_two_points_of_a_machine_without_contacts(damping):
    """Not even one as narrow as a thousandth of the range, nor the weak one of backward whirl."""
    text = UNBALANCED
    for c in (100.0, 150.0, 40.0):
        text = text.replace(f" = {c}\n", f" = {c * damping}\n")
    machine = rf.parse(text.replace("5e4", "0.0"))
    result = rf.response(machine, speed=(50.0, 400.0), stability=False)
    linear = response_with_peaks(machine.rotor, np.linspace(50.0, 400.0, 50))
    curve = result.curve("sensor[1]")
    shown = np.interp(linear.speeds, curve.parameter, curve.value)
    for peak in linear.peaks[4]:
        at = linear.speeds == peak
        assert shown[at] == pytest.approx(linear.major[at, 3], rel=0.05)
    assert linear.peaks[4]
    assert len(curve.parameter) < 40 * (1 + len(linear.peaks[4]))


def test_a_narrow_peak_is_drawn_as_the_closed_form_between_its_points_too():
    zeta, most = 1e-3, 0.5
    result = rf.response(jeffcott(zeta=zeta, e=2 * zeta * most), speed=(20.0, 1000.0))
    (line,) = result.figure(["disc"]).axes[0].lines
    ratio = np.linspace(0.99, 1.01, 2001)
    whirl = 2 * zeta * most * ratio**2 / np.hypot(1 - ratio**2, 2 * zeta * ratio)
    at = np.array(line.get_xdata()) * 2 * np.pi / OMEGA  # of Hz
    drawn = np.interp(ratio, at, line.get_ydata())
    assert np.abs(line.get_ydata()).max() == pytest.approx(1e6 * most * CLEARANCE, rel=1e-3)
    assert np.abs(drawn / (1e6 * CLEARANCE) - whirl).max() < 0.01 * most


@pytest.mark.parametrize("most", [1e-5, pytest.param(0.1, marks=pytest.mark.slow), 0.75])
def test_no_step_passes_over_a_narrow_resonance_nor_goes_through_it_twice(most):
    """One whose whirl, at most so many clearances, touches nothing; its damping is a thousandth,
    and its width a thousandth of the longest step. However few clearances it is, a picture shows
    it."""
    zeta = 1e-3
    result = rf.response(jeffcott(zeta=zeta, e=2 * zeta * most), speed=(20.0, 1000.0))
    curve = result.curve("disc")
    ratio = curve.parameter / OMEGA
    whirl = 2 * zeta * most * ratio**2 / np.hypot(1 - ratio**2, 2 * zeta * ratio)
    assert curve.value / CLEARANCE == pytest.approx(whirl, rel=1e-3)
    assert curve.value.max() / CLEARANCE > 0.97 * most
    assert (np.diff(curve.parameter) > 0).all()
    assert result.branches[0].ends == ("start", "end of the range")


STIFF_PEDESTALS = """
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.25, 0.5, 0.75, 1.0]
diameters = [0.03, 0.03, 0.03, 0.03]
[[disc]]
node = 3
diameter = 0.2
width = 0.03
e = 1e-6
[[support]]
node = 1
stiffness = 1e9
[[support]]
node = 3
stiffness = 1e3
damping = 50.0
[[support]]
node = 5
stiffness = 1e9
[[contact]]
node = 1
journal_radius = 0.015
clearance = 1e-4
mu = 0.1
k = 1e7
"""


def test_a_resonance_of_a_disc_is_drawn_that_the_contacts_hardly_notice():
    """The contact is at a node of the mode: while the disc goes through it, it moves less than a
    ten thousandth of its clearance."""
    machine = rf.parse(STIFF_PEDESTALS)
    (branch,) = rf.response(machine, speed=(20.0, 1000.0), stability=False).branches
    linear = response_with_peaks(machine.rotor, np.linspace(20.0, 1000.0, 500))
    contact, disc = (np.array([abs(p.motion[1, 2 * i]) for p in branch.points]) for i in (0, 4))
    assert contact.max() < 1e-4 * 1e-4
    drawn = np.interp(linear.speeds, [p.value for p in branch.points], disc)
    assert np.abs(drawn - linear.major[:, 2]).max() < 0.05 * linear.major[:, 2].max()


@pytest.mark.parametrize("housing", ["", 'housing = "frame"\n'])
def test_of_a_machine_without_a_part_that_is_seen_to_move_the_contact_is_shown(housing):
    """Across its gap, where the frame, which nothing touches, rests: the picture was empty."""
    frame = '[[housing]]\nname = "frame"\nmass = 1.0\nkx = 1e6\nky = 1e6\ncx = 10.0\ncy = 10.0\n'
    gap = "node = 4\njournal_radius = 0.01\nclearance = 1.0\nmu = 0.1\nk = 1e7\n"
    text = UNBALANCED.replace("[[sensor]]\nnode = 4\n", "").replace(SEAL, "")
    held = "".join(f"[[support]]\nnode = {n}\nstiffness = 1e6\ndamping = 100.0\n" for n in (1, 3))
    bare = re.sub(r"(?s)\[\[(disc|body|linear_bearing)\]\].*?(?=\[\[|$)", "", text) + held
    machine = rf.parse(f"{bare}[[contact]]\n{gap}{housing}{frame if housing else ''}")
    result = rf.response(machine, speed=(50.0, 100.0))
    linear = machine.unbalance_response([p.value for p in result.points])
    assert list(result.probes) == ["contact[1]"]
    once = result.curve("contact[1]", "x_1x").value
    assert once == pytest.approx(abs(linear.x[:, 3]), rel=1e-6)
