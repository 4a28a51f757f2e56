"""Frequency response to a force, and the sensitivity of control loops: against closed forms of one
degree of freedom, Routh's criterion, and the response to unbalance."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.linear import LinearError, modes, unbalance_response
from rotor_fmu.model.linear.frequency_response import (
    ControlLoop,
    frequency_response,
    sensitivity,
)
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.body import Body
from rotor_fmu.model.parts.shaft import Material, Section

from rotor_fmu.linear.frequency_answers import place_of, read_loops
from rotor_fmu.machine_report.rub_check import rub_check
from tests.validation.test_ross import machine

ROOT = Path(__file__).parents[2]
JEFFCOTT_TEXT = (ROOT / "examples" / "jeffcott_rub" / "jeffcott.toml").read_text()
JEFFCOTT = parse_rotor(JEFFCOTT_TEXT)
FREQUENCIES = np.array([10.0, 60.0, 99.0, 150.0, 400.0])  # natural: 100 rad/s
M, C, K = 1.0, 20.0, 1e4
LOOP = ControlLoop("magnet", 2, 2, kp=100.0, kd=1.0, force_per_current=50.0)
MAGNETS = ROOT / "examples" / "magnetic_bearing" / "compressor.toml"
PNG = b"\x89PNG"


def of_end(k, c):
    return f"kxx = {k}\nkyy = {k}\ncxx = {c}\ncyy = {c}"


def impedance(s):
    return M * s**2 + C * s + K


def test_the_response_of_one_degree_of_freedom_is_the_closed_form():
    result = frequency_response(JEFFCOTT, FREQUENCIES, 2, [2])
    expected = 1 / impedance(1j * FREQUENCIES)
    np.testing.assert_allclose(result.receptance[:, 0, 0, 0], expected, rtol=1e-4)
    np.testing.assert_allclose(result.receptance[:, 0, 1, 1], expected, rtol=1e-4)
    assert np.abs(result.receptance[:, 0, 0, 1]).max() < 1e-9 * np.abs(expected).max()


def test_a_force_that_turns_with_the_shaft_moves_it_as_an_unbalance_does():
    rotor = machine("compressor.toml")
    result = frequency_response(rotor, [500.0], 3, [2, 5], speed=500.0)
    pull = 1e-4 * 500.0**2 * np.array([1.0, -1j])
    expected = unbalance_response(rotor, [500.0], unbalances=[(3, 1e-4, 0.0)])
    for k, node in enumerate((2, 5)):
        x, y = result.receptance[0, k] @ pull
        assert x == pytest.approx(expected.x[0, node - 1], rel=1e-9)
        assert y == pytest.approx(expected.y[0, node - 1], rel=1e-9)


def closed_form(loop, s):
    """The sensitivity of a control loop on one degree of freedom."""
    low_pass = 1 / (1 + s / (2 * math.pi * loop.filter_frequency)) if loop.filter_frequency else 1.0
    control = (loop.kp + loop.kd * s) * low_pass + loop.ki / s
    control = control * 50.0 / (1 + s * loop.amplifier_time) * np.exp(-s * loop.delay)
    return 1 / (1 + control / (impedance(s) - loop.negative_stiffness))


@pytest.mark.parametrize(
    "loop",
    [
        replace(LOOP, amplifier_time=1e-3),
        replace(LOOP, filter_frequency=200.0, ki=500.0, delay=5e-4, negative_stiffness=3e3),
    ],
)
def test_the_sensitivity_of_one_degree_of_freedom_is_the_closed_form(loop):
    result = sensitivity(JEFFCOTT, FREQUENCIES, [loop])
    assert np.isin(FREQUENCIES, result.frequencies).all()
    expected = closed_form(loop, 1j * result.frequencies)
    assert result.loops == ("magnet x", "magnet y")
    for column in (0, 1):
        np.testing.assert_allclose(result.sensitivity[:, column], expected, rtol=1e-4)


@pytest.mark.parametrize("delay", [0.0, pytest.param(1e-4, marks=pytest.mark.slow)])
@pytest.mark.parametrize("amplifier_time", [5e-5, 1.5e-3, 1.9e-3])
def test_the_largest_sensitivity_is_that_between_the_frequencies_too(amplifier_time, delay):
    """Of the closed form at a million frequencies; the slower the amplifier, the sharper the
    peak."""
    loop = replace(LOOP, kp=200.0, kd=0.0, amplifier_time=amplifier_time, delay=delay)
    result = sensitivity(JEFFCOTT, np.geomspace(10.0, 1000.0, 5), [loop])
    assert result.is_stable
    fine = np.linspace(10.0, 1000.0, 1_000_001)
    size = np.abs(closed_form(loop, 1j * fine))
    assert result.largest == pytest.approx(size.max(), rel=1e-3)
    at = result.frequencies[np.abs(result.sensitivity).argmax(axis=0)]
    assert at == pytest.approx(fine[size.argmax()], rel=1e-4)


@pytest.mark.parametrize("idle", [{"kp": 0.0, "kd": 0.0, "ki": 0.0}, {"force_per_current": 0.0}])
def test_a_loop_without_force_has_the_sensitivity_of_an_open_one(idle):
    result = sensitivity(JEFFCOTT, [50.0], [replace(LOOP, **idle)])
    assert (result.sensitivity == 1.0).all()
    assert result.is_stable


def test_the_closed_loop_is_stable_as_routh_says():
    """m T s^3 + (m + c T) s^2 + (c + k T + kd) s + k + kp is stable where the product of its inner
    coefficients exceeds that of its outer ones."""
    kp, kd = 50.0 * 4000.0, 0.0
    # (m + c T)(c + k T + kd) = m T (k + kp): a quadratic equation for T
    a, b = C * K, M * K + C * (C + kd) - M * (K + kp)
    root = math.sqrt(b**2 - 4 * a * M * (C + kd))
    for T in ((-b - root) / (2 * a), (-b + root) / (2 * a)):
        below, above = (
            sensitivity(
                JEFFCOTT, [50.0], [replace(LOOP, kp=4000.0, kd=0.0, amplifier_time=factor * T)]
            ).is_stable
            for factor in (0.99, 1.01)
        )
        assert below != above


def test_a_long_delay_makes_the_loop_unstable():
    """Without damping of its own: (m s^2 + c s + k) + kp exp(-s T) crosses where the loop gain is
    one; T from its phase."""
    kp = 50.0 * 4000.0
    # size: (k - m w^2)^2 + (c w)^2 = kp^2
    p = np.roots([M**2, C**2 - 2 * K * M, K**2 - kp**2])
    w = math.sqrt(max(p.real))
    phase = math.pi + math.atan2((impedance(1j * w)).imag, impedance(1j * w).real)
    T = (2 * math.pi - phase) % (2 * math.pi) / w
    made = [
        replace(LOOP, kp=4000.0, kd=0.0, amplifier_time=1e-9, delay=f * T) for f in (0.97, 1.03)
    ]
    stable = [sensitivity(JEFFCOTT, [50.0], [loop]).is_stable for loop in made]
    assert stable == [True, False]


@pytest.mark.parametrize("turns", [0, 1, 2])
def test_delays_of_turns_of_the_vibration_are_stable_where_the_closed_form_is(turns):
    """(m s^2 + c s + k) + kp exp(-s T), kp < k, has poles on the axis at two frequencies w: beyond
    T of the higher one two more of them grow, beyond that of the lower one two less."""
    kp = 50.0 * 50.0
    higher, lower = sorted(np.sqrt(np.roots([M**2, C**2 - 2 * K * M, K**2 - kp**2])))[::-1]
    delays = [
        (-np.angle(-impedance(1j * w)) % (2 * math.pi) + 2 * math.pi * turns) / w
        for w in (higher, lower)
    ]
    assert delays[0] < delays[1] < (delays[0] + 2 * math.pi / higher)
    loop, near = replace(LOOP, kp=50.0, kd=0.0, amplifier_time=1e-9), np.outer(delays, [0.99, 1.01])
    made = [replace(loop, delay=float(delay)) for delay in near.ravel()]
    stable = [sensitivity(JEFFCOTT, [50.0], [each]).is_stable for each in made]
    assert stable == [True, False, False, True]


LOOPS = """
[[loop]]
name = "left"
sensor = "left_sensor"
magnet = "left_magnet"
kp = 12000.0
ki = 1e5
kd = 16.0
filter_frequency = 2000.0
amplifier_time = 1e-4
delay = 1.5e-4
force_per_current = 264.0
negative_stiffness = 1.584e6
"""
BOTH = LOOPS + LOOPS.replace("left", "right")


@pytest.fixture
def loops(tmp_path):
    file = tmp_path / "loops.toml"
    file.write_text(BOTH)
    return file


@pytest.mark.usefixtures("drawn")
def test_the_command_tells_the_zone_of_each_loop(tmp_path, loops, command):
    said = command(
        *("frequency-response", "--rotor", str(MAGNETS), "--loop", str(loops)),
        *("--zones", "2:3:4", "--frequency", "1:1000Hz:21"),
    )
    assert "UNSTABLE" not in said
    assert [line.split()[-1] for line in said.splitlines() if line.startswith((" left", "right"))]
    data = json.loads((tmp_path / "out" / "frequency_response.json").read_text())
    assert data["is_stable"] is True
    largest = max(math.hypot(*value[0]) for value in data["sensitivity"])
    assert ("B" if largest > 2 else "A") in said.split()
    assert (tmp_path / "out" / "frequency_response.png").read_bytes().startswith(PNG)


def test_a_few_frequencies_show_the_sensitivity_of_a_flexible_rotor_as_many_do(loops):
    rotor = parse_rotor(MAGNETS.read_text())
    of_file = read_loops("--loop", loops, rotor)
    few, many = (
        sensitivity(rotor, np.geomspace(10.0, 6000.0, n), of_file, speed=300.0) for n in (3, 31)
    )
    np.testing.assert_allclose(few.largest, many.largest, rtol=1e-9)


@pytest.mark.parametrize("damping", [pytest.param(0.2, marks=pytest.mark.slow), 2e-5])
def test_the_command_tells_the_peak_of_a_fast_machine_between_its_frequencies(
    tmp_path, command, damping
):
    """One degree of freedom, 1000 Hz: 1 / (2 zeta k sqrt(1 - zeta^2)) at its peak."""
    stiffness = (2000.0 * math.pi) ** 2
    text = JEFFCOTT_TEXT.replace("9800.0", str(0.98 * stiffness)).replace(
        "kxx = 100.0\nkyy = 100.0\ncxx = 0.2\ncyy = 0.2", of_end(0.01 * stiffness, damping)
    )
    text = text.replace("19.6", str(98 * damping)).replace("2.1e10", "2.1e15")
    file = tmp_path / "fast.toml"
    file.write_text(text)
    command("frequency-response", "--rotor", str(file), "--force", "disc")
    data = json.loads((tmp_path / "out" / "frequency_response.json").read_text())
    largest = max(math.hypot(*value[0][0][0]) for value in data["receptance"])
    zeta = 100 * damping / (2 * math.sqrt(stiffness))
    expected = 1 / (2 * zeta * stiffness * math.sqrt(1 - zeta**2))
    assert largest == pytest.approx(expected, rel=1e-6)


def test_the_peaks_of_a_free_rotor_are_its_modes_and_none_of_rounding(tmp_path, command):
    drop = ROOT / "examples" / "drop" / "compressor.toml"
    said = command("frequency-response", "--rotor", str(drop), "--force", "2", "--contacts", "open")
    rows = [line.split() for line in said.splitlines() if " by " in line]
    found = np.array([float(row[4]) for row in rows])
    natural = modes(parse_rotor(drop.read_text()), contacts="open").natural / (2 * math.pi)
    bending = np.unique(np.round(natural[natural > 510.0], 3))  # below: of the housings alone
    assert found == pytest.approx([*bending, *bending], rel=1e-3)
    data = json.loads((tmp_path / "out" / "frequency_response.json").read_text())
    assert data["frequencies"][0] == pytest.approx(2 * math.pi)


def test_the_command_tells_the_peaks_of_a_port(command):
    jeffcott = str(ROOT / "examples" / "jeffcott_rub" / "jeffcott.toml")
    asked = "--rotor", jeffcott, "--force", "disc", "--frequency", "1:50Hz"
    assert "x by x  15." in command("frequency-response", *asked)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "--force, --loop: one of them must be given, and only one"),
        (["--force", "left_magnett"], "or a part's name; did you mean left_magnet"),
        (["--force", "99"], "must be a node from 1 to"),
        (["--force", "1", "--frequency", "0:5Hz"], "must be FROM:TO, both above 0"),
        (["--force", "1", "--frequency", "5Hz"], "must be FROM:TO, both above 0"),
        (["--force", "1", "--zones", "3:4:5"], "are of --loop"),
        (["--loop", "none.toml"], "cannot be read"),
        (["--loop", "LOOPS", "--zones", "5:4:3"], "three ascending numbers"),
    ],
)
def test_impossible_wishes_are_refused(refusal, loops, arguments, expected):
    given = [str(loops) if text == "LOOPS" else text for text in arguments]
    assert expected in refusal("frequency-response", "--rotor", str(MAGNETS), *given)


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ("kp =", "kpp =", "loop[1].kpp: unknown key; did you mean kp? known are name,"),
        ("kd = 16.0\n", "", "loop[1].kd is missing"),
        ("delay = 1.5e-4", "delay = -1", "loop[1].delay = -1 s: must be >= 0 and finite"),
        ("delay = 1.5e-4", "delay = inf", "loop[1].delay = inf s: must be >= 0 and finite"),
        ("delay = 1.5e-4", "delay = true", "loop[1].delay = True: must be a number"),
        ("delay = 1.5e-4", 'delay = "1"', "loop[1].delay = '1': must be a number"),
        ('sensor = "left_sensor"\n', "", "loop[1].sensor is missing"),
        ('"left_sensor"', '"left_sensr"', "or a part's name; did you mean left_sensor"),
        ("[[loop]]", "[[lop]]", "lop: unknown"),
        ("[[loop]]", "[[loop", "loops.toml: is not valid TOML"),
        ("delay = 1.5e-4", f"delay = {'[' * 5000}", "loops.toml: is not valid TOML"),
        ('"right"', '"left"', "loops.toml: loop[2].name = 'left': another has it"),
        (BOTH, "loop = []", "no [[loop]] is there; at least one is needed"),
        (BOTH, "loop = [5]", "no [[loop]] is there; at least one is needed"),
    ],
)
def test_a_bad_file_of_loops_is_refused(refusal, loops, before, after, expected):
    loops.write_text(loops.read_text().replace(before, after))
    said = refusal("frequency-response", "--rotor", str(MAGNETS), "--loop", str(loops))
    assert expected in said


def test_a_loop_whose_force_grows_without_bounds_is_refused():
    with pytest.raises(LinearError, match="filter_frequency or amplifier_time is required"):
        sensitivity(JEFFCOTT, [50.0], [LOOP])
    with pytest.raises(LinearError, match="frequencies: must be above 0"):
        frequency_response(JEFFCOTT, [0.0], 2, [2])
    with pytest.raises(LinearError, match="nodes: at least one must be given"):
        frequency_response(JEFFCOTT, [50.0], 2, [])


OVERHUNG = """
[material]
young = 2.1e11
density = 7850.0
[shaft]
nodes = [0.0, 0.2, 0.4, 0.6, 0.8]
diameters = [0.04, 0.04, 0.04, 0.04]
[[support]]
node = 1
stiffness = 2e7
damping = 500.0
[[support]]
node = 4
stiffness = 2e7
damping = 500.0
[[body]]
node = 5
mass = 12.0
I_d = 0.05
I_p = 0.09
offset = 0.08
"""


def test_a_force_on_a_part_acts_beyond_its_node_where_the_part_lies(tmp_path, command):
    """As on a node at the end of a massless, rigid piece of shaft that is as long."""
    given = parse_rotor(OVERHUNG)
    rigid = Section.cylinder(0.08, 0.04, Material(young=1e17, density=1e-6))
    (body,) = given.of_kind(Body)
    longer = replace(given, sections=(*given.sections, rigid))
    longer = longer.with_parts(Body, replace(body, node=6, offset=0.0))
    frequencies = np.array([100.0, 400.0, 1500.0])
    expected = frequency_response(longer, frequencies, 6, [6, 3], speed=300.0)
    place = place_of(given, "body[1]", "--force")
    found = frequency_response(given, frequencies, place, [place, 3], speed=300.0)
    largest = np.abs(expected.receptance).max()
    np.testing.assert_allclose(found.receptance, expected.receptance, atol=1e-6 * largest)
    file = tmp_path / "overhung.toml"
    file.write_text(OVERHUNG)
    said = command("frequency-response", "--rotor", str(file), "--force", "body[1]")
    assert "a force on node 5 +80 mm" in said


def test_a_report_shows_the_linear_response_beside_a_rub_where_the_part_lies():
    given = parse_rotor(OVERHUNG)
    rigid = Section.cylinder(0.08, 0.04, Material(young=1e17, density=1e-6))
    (body,) = given.of_kind(Body)
    check = rub_check(given.with_parts(Body, replace(body, e=1e-5)), 100.0, 400.0)
    longer = replace(given, sections=(*given.sections, rigid))
    longer = longer.with_parts(Body, replace(body, node=6, offset=0.0, e=1e-5))
    assert check.place == "body[1]"
    expected = unbalance_response(longer, check.speed).major[:, 5]
    np.testing.assert_allclose(check.linear, expected, rtol=1e-5)
