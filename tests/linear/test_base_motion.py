"""Frequency response to an acceleration of the base, relative to it: against the closed form of one
degree of freedom, the deflection under gravity, and a run in time."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import LinearError, static
from rotor_fmu.model.linear.frequency_response import frequency_response
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.base_and_start import Base
from rotor_fmu.model.settings import PRESETS
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf
from rotor_fmu.linear.frequency_answers import frequency_response as shown_response

from ..known import EXAMPLES
from ..toml_text import table

JEFFCOTT = EXAMPLES / "jeffcott_rub" / "jeffcott.toml"
COMPRESSOR = EXAMPLES / "tilting_pads" / "compressor.toml"
M, C, K = 1.0, 20.0, 1e4  # of the Jeffcott rotor


def test_one_degree_of_freedom_follows_the_closed_form():
    rotor = parse_rotor(JEFFCOTT.read_text())
    s = 1j * np.array([10.0, 60.0, 99.0, 150.0, 400.0])
    found = frequency_response(rotor, s.imag, "base", [2]).receptance[:, 0]
    expected = -M / (M * s**2 + C * s + K)
    for axis in (0, 1):
        np.testing.assert_allclose(found[:, axis, axis], expected, rtol=1e-4)
    assert np.abs(found[:, 0, 1]).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("example", ["tilting_pads/compressor.toml", "paper_rig/rig.toml"])
def test_a_slow_acceleration_deflects_as_gravity_to_the_other_side(example):
    """Of the rig with its housings, on which the shaft is pinned."""
    rotor = rf.load(EXAMPLES / example).rotor
    node = len(rotor.nodes) // 2
    found = frequency_response(rotor, [1e-3], "base", [node], contacts="pinned").receptance[0, 0]
    bare = replace(rotor, gravity=0.0)
    none = static(bare, contacts="pinned")
    for axis, angle in ((0, math.pi / 2), (1, math.pi)):
        pulled = replace(rotor, gravity=2.0, gravity_angle=angle)
        at = static(pulled, contacts="pinned")
        moved = np.array([at.x[node - 1] - none.x[node - 1], at.y[node - 1] - none.y[node - 1]])
        assert found[:, axis].real == pytest.approx(-moved / 2.0, rel=1e-4, abs=1e-12)


def test_a_run_under_a_shaken_base_becomes_the_answer():
    """On tilting pads' coefficients at 900 rad/s; the acceleration is linear between 64 points of
    a period, whose first harmonic is smaller by the square of sin(x) / x, x = pi / 64."""
    omega, speed, n = 380.0, 900.0, 64
    read = rf.load(COMPRESSOR).rotor
    still = read.with_values({name: 0.0 for name in read.numbers() if name.endswith(".e")})
    rotor = replace(still, parts=(*still.parts, Base(name="deck")))
    found = frequency_response(rotor, [omega], "base", [9], speed=speed).receptance[0, 0, :, 0]
    run = Simulation(rotor, replace(PRESETS["controlled"], tolerance=1e-5), speed=speed)
    at = [run.names.index(f"impeller_4.{axis}") for axis in "xy"]
    t = 2 * np.pi / omega * np.arange(40 * n + 1) / n
    rest, moved = run.observed[at].copy(), []
    a = 2.0 * np.cos(omega * t) + 0j
    ports = np.eye(len(run.structure.load_dof))[run.structure.load_dof == -1][0]  # of the base
    for i in range(len(t) - 1):
        rate = (a[i + 1] - a[i]) / (t[i + 1] - t[i])
        run.advance(t[i + 1], speed, a[i] * ports, rate=0.0, load_rates=rate * ports)
        moved.append(run.observed[at] - rest)
    last = slice(-10 * n, None)
    first = 2 * np.mean(np.array(moved)[last].T * np.exp(-1j * omega * t[1:][last]), axis=1)
    linear = np.sinc(1.0 / n) ** 2
    assert np.abs(first / 2.0 / linear - found).max() < 1e-4 * np.abs(found).max()


def test_the_command_shakes_a_base_of_any_name_and_shows_the_sensors(tmp_path, command):
    file = tmp_path / "machine.toml"
    file.write_text(COMPRESSOR.read_text() + '\n[base]\nname = "deck"\n')
    said = command("frequency-response", "--rotor", str(file), "--force", "deck")
    assert "Frequency response to an acceleration of the base" in said
    assert "um/g" in said
    data = json.loads((tmp_path / "out" / "frequency_response.json").read_text())
    assert (data["force"], data["nodes"]) == ("base", [4, 16])
    shown = next(line.split() for line in said.splitlines() if " x by x" in line)
    of_x = max(math.hypot(*row[0][0][0]) for row in data["receptance"])
    assert float(shown[5]) == pytest.approx(1e6 * 9.80665 * of_x, rel=1e-4)


def test_without_sensors_it_shows_other_parts_and_a_bare_shaft_asks(tmp_path, command, refusal):
    rotor = EXAMPLES / "rolling_bearing" / "rotor.toml"
    command("frequency-response", "--rotor", str(rotor), "--force", "base")
    data = json.loads((tmp_path / "out" / "frequency_response.json").read_text())
    assert data["nodes"] == [2]
    said = refusal("frequency-response", "--rotor", str(JEFFCOTT), "--force", "bas")
    assert said.endswith("did you mean base?")
    bare = tmp_path / "bare.toml"
    text = JEFFCOTT.read_text()
    supports = [f"[[support]]\nnode = {i}\nstiffness = 1e4\ndamping = 1.0\n" for i in (1, 3)]
    oil = {"journal_radius": 0.01, "length": 0.01, "clearance": 1e-4, "viscosity": 0.01}
    supports.append(table("[journal_bearing]", node=2, **oil))  # nor has it a probe
    bare.write_text("\n".join([text[: text.index("[[point_mass]]")], *supports]))
    said = refusal("frequency-response", "--rotor", str(bare), "--force", "base")
    assert said.endswith(
        "--node: must be given; of no part is the motion observed, as it is of a sensor"
    )
    with pytest.raises(LinearError, match=r"^force = 'bse': must be a node, a place, or 'base'$"):
        frequency_response(parse_rotor(text), [50.0], "bse", [2])


def test_what_nothing_holds_stays_where_it_is_at_an_angle_of_0():
    """With open contacts the rig is free, and relative to its base moves by -a / (i omega)^2."""
    rig = rf.load(EXAMPLES / "paper_rig" / "rig.toml").rotor
    answer = shown_response(rig, [2 * math.pi, 10.0], "base", [5], contacts="open")
    for row in answer.table().rows:
        assert row[3] == pytest.approx(9.80665e6 / (2 * math.pi) ** 2, rel=1e-6)
        assert row[4] == 0.0
