"""Campbell diagrams: lines of modes followed by their shapes, and their critical speeds."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import (
    LinearMachine,
    campbell,
    modes,
)
from rotor_fmu.model.machine.toml import parse_rotor, rig
from rotor_fmu.model.parts.linear_bearing import LinearBearing

from rotor_fmu.linear import answers
from rotor_fmu.linear.linear_plots import draw_whirling
from rotor_fmu.plotting.figure_style import new_panels
from tests.machines import jeffcott

from ..parts.machines import shaft
from ..toml_text import table
from .test_linear import PRINTED, ROOT, two_discs


def test_a_frequency_meets_the_speed_at_a_critical_speed():
    rotor = PRINTED["5.9.1"][0]
    diagram = campbell(rotor, np.linspace(0, 400, 9), count=4)
    assert [c.whirl for c in diagram.critical] == ["backward", "forward", "backward", "forward"]
    for critical in diagram.critical:
        frequencies = modes(rotor, critical.speed).damped
        assert np.abs(frequencies - critical.speed).min() < 1e-8 * critical.speed


@pytest.mark.parametrize(
    "speeds",
    [
        *(pytest.param(each, marks=pytest.mark.slow) for each in ((-300.0, 0.0), (0.0, 300.0))),
        *((-300.0, -10.0), (-300.0, 300.0)),
    ],
)
def test_critical_speeds_do_not_care_which_way_the_shaft_turns(speeds):
    """From two speeds alone, one of them at rest or beyond it."""
    found = campbell(rig(), speeds, contacts="pinned").critical
    ahead = [c.speed for c in campbell(rig(), (0.0, 150.0, 300.0), contacts="pinned").critical]
    back = [-speed for speed in reversed(ahead)]
    expected = [*(back if speeds[0] < 0 else ()), *(ahead if speeds[1] > 0 else ())]
    np.testing.assert_allclose([c.speed for c in found], expected, rtol=1e-9)


@pytest.mark.parametrize(
    "most", [*(pytest.param(most, marks=pytest.mark.slow) for most in (1e4, 1e5)), 1e6]
)
def test_no_branch_is_lost_where_bearings_overdamp_modes(most):
    """Damping that rises up to ten thousand times and falls again, with cross coupling: a branch
    is interrupted at most where its mode does not oscillate, no two end at one mode, and of the
    lowest modes at the end none is on no branch."""
    speeds = (0.0, 200.0, 400.0, 600.0, 800.0)
    coupling = tuple(5e3 * s for s in speeds)
    damping = (100.0, most / 2, most, most / 2, 100.0)
    bearings = [
        LinearBearing(
            node=n,
            speed=speeds,
            kxx=5e6,
            kyy=6e6,
            kxy=coupling,
            kyx=tuple(-k for k in coupling),
            cxx=damping,
            cyy=damping,
        )
        for n in (1, 7)
    ]
    result = campbell(two_discs(6, *bearings), np.linspace(0.0, 800.0, 25))
    assert np.isfinite(result.eigenvalues[:, :6]).all()  # which stay oscillating
    last = result.eigenvalues[-1]
    last = last[np.isfinite(last)]
    known = modes(two_discs(6, *bearings), 800.0, count=16).eigenvalues
    nearest = np.abs(last[:, None] - known[None, :]) / np.abs(last)[:, None]
    assert nearest.min(axis=1).max() < 1e-6
    assert nearest[:, :8].min(axis=0).max() < 1e-6
    assert len(set(nearest.argmin(axis=1))) == len(last)


def test_each_speed_at_which_stability_changes_is_told():
    """A disc of damping c on a shaft of stiffness k is unstable where the cross coupling exceeds
    c sqrt(k / m): here below 20 and above 125 rad/s."""
    damper = jeffcott(damping=20.0)
    most = 20.0 * modes(damper, 0.0, count=2).natural[0]
    speeds = (0.0, 20.0, 50.0, 100.0, 125.0, 150.0)
    coupling = tuple(share * most for share in (1.5, 1.0, 0.0, 0.0, 1.0, 2.0))
    none = dict.fromkeys(("kxx", "kyy", "cxx", "cyy"), 0.0)
    against = tuple(-k for k in coupling)
    across = LinearBearing(node=2, speed=speeds, kxy=coupling, kyx=against, **none)
    machine = replace(damper, parts=(*damper.parts, across))
    found = answers.campbell(machine, np.linspace(0.0, 150.0, 7), count=2)
    assert found.threshold == 0.0
    assert found.turns == pytest.approx((20.0, 125.0), rel=1e-3)
    low, high = (f"{n / (2 * np.pi):.5g} Hz ({n:.6g} rad/s)" for n in found.turns)
    assert found.stability == f"unstable below {low} and above {high}"
    figure = found.figure()
    figure.draw_without_rendering()
    (legend,) = figure.legends
    assert legend.get_window_extent().x1 < figure.bbox.x1


def dense_oscillating(machine, speed, scale):
    """Oscillating eigenvalues at a speed [1/s], lowest first, of the dense matrices in units of
    time of 1 / scale."""
    linear = machine.with_own_states(machine.at(speed))
    M, D, K = scale**2 * linear.M.toarray(), scale * linear.D.toarray(), linear.K.toarray()
    A = np.block([[np.zeros_like(M), np.eye(len(M))], [np.linalg.solve(M, -np.hstack([K, D]))]])
    if (own := linear.own_states) is not None:
        X, by = own.across.toarray(), own.tangents
        of_rotor = np.hstack([by.by_d @ X / scale, by.by_v @ X])
        on_rotor = np.linalg.solve(M, X.T @ by.force)
        on_rotor = np.vstack([0 * on_rotor, on_rotor])
        A = np.block([[A, on_rotor], [of_rotor, by.by_states / scale]])
    values = scale * np.linalg.eigvals(A)  # which balances, as that of a pair of matrices does not
    values = values[values.imag > 1e-5 * np.abs(values)]
    return values[np.argsort(np.abs(values))]


@pytest.mark.parametrize(
    ("example", "top"),
    [
        pytest.param("oil_film", 900.0, marks=pytest.mark.slow),
        *(("turbocharger", 11310.0), ("squeeze_film", 500.0)),
    ],
)
def test_every_one_of_the_lowest_modes_lies_on_a_line_of_its_own(example, top):
    """Also those that films overdamp at the first speed."""
    rotor = parse_rotor((ROOT / "examples" / example / "rotor.toml").read_text())
    speeds = np.linspace(top / 200, top, 13)
    result, machine = campbell(rotor, speeds, count=8), LinearMachine(rotor)
    for speed, lines in zip(speeds, result.eigenvalues, strict=True):
        lines = lines[np.isfinite(lines)]
        assert len(np.unique(lines)) == len(lines)
        for value in dense_oscillating(machine, speed, top / 4)[:8]:
            assert np.abs(lines - value).min() < 1e-8 * abs(value)


def test_modes_are_followed_through_their_crossings():
    """A forward mode overtakes a backward one of higher order; coarse speeds or fine, the same."""
    rotor = PRINTED["5.9.9"][0]
    coarse, fine = (campbell(rotor, np.linspace(0, 2000, n), count=6) for n in (5, 33))
    np.testing.assert_allclose(coarse.eigenvalues, fine.eigenvalues[::8], rtol=1e-6, atol=1e-6)


def overhung(*more):
    """A shaft with two discs between its bearings and one beyond; more: nodes beside those that it
    needs [m]."""
    nodes = sorted({*np.round(np.linspace(0.0, 1.6, 9), 6), *np.round(more, 6)})
    bearing = {"kxx": 2e7, "kyy": 2e7, "cxx": 10.0, "cyy": 10.0}
    text = table("material", young=2.1e11, density=7850.0)
    text += table("shaft", nodes=nodes, diameters=[0.05] * (len(nodes) - 1))
    for z, diameter, width in ((0.4, 0.5, 0.05), (0.8, 0.4, 0.03), (1.6, 0.6, 0.04)):
        text += table("[disc]", z=z, diameter=diameter, width=width)
    for z in (0.0, 1.2):
        text += table("[linear_bearing]", z=z, **bearing)
    return parse_rotor(text)


def test_modes_are_the_same_ones_though_a_stretch_of_the_shaft_has_many_nodes():
    speeds = np.linspace(0, 1500, 5)
    even, uneven = (
        campbell(overhung(*more), speeds, count=6) for more in ((), np.linspace(0.0, 0.1, 8))
    )
    np.testing.assert_allclose(uneven.natural, even.natural, rtol=1e-2)


def test_a_mode_has_no_frequency_where_it_does_not_oscillate():
    """Damped by far more than critically at 50 and 150 rad/s, by little at 200 rad/s."""
    damping = {"cxx": (1e5, 1e5, 10.0), "cyy": (1e5, 1e5, 10.0)}
    damper = LinearBearing(node=2, speed=(0.0, 100.0, 200.0), kxx=0.0, kyy=0.0, **damping)
    rotor = jeffcott()
    rotor = replace(rotor, parts=(*rotor.parts, damper))
    diagram = campbell(rotor, [50.0, 150.0, 200.0], count=6)
    for seen in (diagram.damped, diagram.natural, diagram.log_dec):
        np.testing.assert_array_equal(
            np.isnan(seen), 2 * [6 * [False] + 2 * [True]] + [8 * [False]]
        )


def test_a_mode_that_does_not_oscillate_in_between_meets_no_speed_there():
    """Of the turbocharger, whose floating rings overdamp modes that oscillate at other speeds."""
    text = (ROOT / "examples" / "turbocharger" / "rotor.toml").read_text()
    result = campbell(parse_rotor(text), np.linspace(7.1, 11310.0, 7), count=12)
    assert len(result.critical) >= 3
    for critical in result.critical:
        seen = modes(parse_rotor(text), critical.speed, count=18).damped
        assert np.abs(seen / critical.speed - 1).min() < 1e-6


def test_a_frequency_that_jumps_past_the_speed_meets_it_nowhere():
    """Where an upper pad begins to bear, that of a mode changes at once."""
    text = table("material", young=2.1e11, density=7850.0)
    text += table("[section]", length=0.859, outer=0.056, elements=6)
    for z, mass, across, polar in ((0.431, 28.493, 0.1958, 2.2751), (0.505, 4.522, 0.023, 2.0583)):
        text += table("[body]", z=z, mass=mass, I_d=across, I_p=polar)
    pads = {"pads": [0.785, 2.356, 3.927, 5.498], "arc": 1.3, "preload": 0.2, "tilting": True}
    for z, length, clearance, viscosity in (
        (0.043, 0.0539, 1.093e-4, 0.0041),
        (0.816, 0.042, 7.165e-5, 0.0542),
    ):
        film = {"length": length, "clearance": clearance, "viscosity": viscosity}
        text += table("[journal_bearing]", z=z, journal_radius=0.028, **film, **pads)
    result = campbell(parse_rotor("gravity = 9.81\n" + text), (1250.7, 1250.8), count=6)
    before, after = result.damped[:, 5] - result.speeds
    assert before > 0 > after
    assert not result.critical


def test_of_two_lines_that_coincide_both_colours_are_seen():
    axes = np.ravel(new_panels(4.0, 3.0, 1)[1])[0]
    speed, is_clear = np.arange(3.0), np.ones(3, bool)
    values = np.tile([5.0, 5.0, 5.001, 5.1, 1.0], (3, 1))
    for mode, whirl in enumerate(("forward", "backward", "backward", "forward")):
        draw_whirling(axes, speed, values, mode, [whirl] * 3, is_clear)
    assert [line.is_dashed() for line in axes.lines] == [False] * 2 + [True] * 4 + [False] * 2


@pytest.mark.parametrize(("damping", "is_damped"), [(1e3, False), (1.7e3, True)])
def test_a_critical_speed_whose_amplification_is_below_2_5_is_said_to_be_damped(damping, is_damped):
    """As the unbalance check says of its peak; of a rigid rotor on springs and dampers."""
    held = {"kxx": 1e6, "kyy": 1e6, "cxx": damping, "cyy": damping}
    rotor = parse_rotor(
        f"gravity = 0.0\n{shaft(0.0, 0.1, 0.2, diameter=0.1)}"
        + table("[body]", node=2, mass=10.0, I_d=1.0, I_p=0.1, e=1e-5)
        + "".join(table("[linear_bearing]", node=node, **held) for node in (1, 3))
    )
    diagram = answers.campbell(rotor, np.linspace(1.0, 600.0, 7), count=4)
    first = [c for c in diagram.critical if 200.0 < c.speed < 400.0]
    assert first
    zeta = math.sqrt(1.0 / (1.0 + (2 * math.pi / first[0].log_dec) ** 2))
    assert (1.0 / (2.0 * zeta) < 2.5) == is_damped
    assert [c.is_critically_damped for c in first] == [is_damped] * len(first)
    assert ("critically damped (AF below 2.5)" in diagram.table().title) == is_damped
    legend = diagram.figure().legends[0].get_texts()
    assert any("critically damped" in text.get_text() for text in legend) == is_damped
