"""Motions that grow without oscillating: no analysis of stability calls them stable."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import LinearError, campbell, critical_map, level_1, level_2, modes
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.linear import answers, stability_answers
from rotor_fmu.linear.mode_answers import mode_shapes_figure
from rotor_fmu.linear.where_linearized import where_not_at_rest
from tests.linear.api_617 import ROOT, SHAFT
from tests.linear.test_long_shafts import shaft

PULLING = "[[{kind}]]\nnode = {node}\nkxx = {k}\nkyy = {ky}\ncxx = 2e3\ncyy = 2e3\n"
UNBALANCE = "[[unbalance]]\nnode = 4\namount = 1e-5\n"


def pulled(kind="linear_bearing", node=4, k=-5e6):
    """A rotor on bearings of 10 kN/mm, and in x alone a stiffness at one node beside them."""
    held = "".join(PULLING.format(kind="linear_bearing", node=n, k=1e7, ky=1e7) for n in (1, 7))
    return parse_rotor(SHAFT + held + PULLING.format(kind=kind, node=node, k=k, ky=0.0))


def all_roots(rotor, speed):
    """All eigenvalues of the dense matrices [1/s]."""
    linear = LinearMachine(rotor).at(speed)
    inverse = np.linalg.inv(linear.M.toarray())
    none, one = np.zeros_like(inverse), np.eye(len(inverse))
    stiff, damped = inverse @ linear.K.toarray(), inverse @ linear.D.toarray()
    return np.linalg.eigvals(np.block([[none, one], [-stiff, -damped]]))


@pytest.mark.parametrize(
    "k", [-2.5e6, *(pytest.param(k, marks=pytest.mark.slow) for k in (-1e6, -3e6)), -5e6]
)
def test_what_grows_without_oscillating_is_not_stable(k):
    """A bearing that pulls the shaft to one side, more strongly than it is stiff or less."""
    rotor, speed = pulled(k=k), 300.0
    largest = max(all_roots(rotor, speed), key=lambda root: root.real)
    grows = largest.real > 0.0
    if grows:
        assert largest.imag == 0.0
        assert modes(rotor, speed).growing == pytest.approx([largest.real], rel=1e-6)
    one, two = level_1(rotor, speed, node=4, anticipated=1e3), level_2(rotor, speed)
    assert (one.threshold == 0.0) == (one.log_dec_alone == -math.inf) == grows
    assert one.is_level_2_required or not grows
    assert (two.cases[0].log_dec == -math.inf) == grows
    assert two.is_met != grows
    assert (campbell(rotor, [100.0, speed]).threshold is not None) == grows


@pytest.mark.parametrize("count", [16, 64])
@pytest.mark.parametrize("k", [-1e6, -1e8, -1e9, -1e12])
@pytest.mark.parametrize("across", [0.0, 1.0])
def test_growth_is_found_however_fast_it_is(count, k, across):
    """That of all eigenvalues, though only the lowest modes are asked for; alike in x and y the
    rotor whirls as it is pulled away."""
    held = (PULLING.format(kind="linear_bearing", node=n, k=1e7, ky=1e7) for n in (1, count + 1))
    pull = PULLING.format(kind="linear_bearing", node=count // 2, k=k, ky=across * k)
    rotor = shaft(count, *held, pull)
    expected = [root for root in all_roots(rotor, 300.0) if root.real > abs(root.imag)]
    found = modes(rotor, 300.0, count=3)
    whirls = found.eigenvalues[found.eigenvalues.real > 0.0]
    together = [*found.growing, *whirls, *whirls.conj()]
    assert sorted(root.real for root in together) == pytest.approx(
        sorted(root.real for root in expected), rel=1e-5
    )
    assert found.growth == pytest.approx(1.0 if expected else 0.0, abs=0.1)


def test_a_rotor_that_nothing_holds_does_not_grow_by_rounding():
    free = parse_rotor((ROOT / "examples" / "drop" / "compressor.toml").read_text())
    for rotor in (free, parse_rotor(SHAFT)):
        for speed in (0.0, 300.0):
            assert len(modes(rotor, speed, contacts="open").growing) == 0
    assert campbell(free, [0.0, 100.0], contacts="open").threshold is None


HINGED = SHAFT + PULLING.format(kind="linear_bearing", node=1, k=1e7, ky=1e7)
NOT_SHOWN = "; motions of frequency 0, which nothing holds, are not shown"


@pytest.mark.parametrize("text", [HINGED, HINGED.replace("node = 1", "node = 3"), SHAFT])
@pytest.mark.parametrize("speed", [0.0, 300.0])
def test_what_nothing_holds_is_said_and_is_no_mode(text, speed):
    """Rounding makes it a pair that oscillates or two motions that do not, as it falls."""
    result = answers.modes(parse_rotor(text), speed)
    assert not result.is_held
    assert NOT_SHOWN in result.table().title
    assert len(result.natural) == 8
    assert result.natural[0] > 1.0
    assert not np.any(np.abs(result.decays) < 1.0)
    assert result.is_sound.all()


def test_what_nothing_holds_has_no_critical_speed():
    assert not campbell(parse_rotor(HINGED), [0.0, 200.0, 400.0]).critical


def test_every_picture_of_modes_says_what_nothing_holds():
    for text, is_free in (
        (HINGED, True),
        (HINGED + PULLING.format(kind="linear_bearing", node=4, k=1e7, ky=1e7), False),
    ):
        shown = answers.modes(parse_rotor(text), 0.0)
        for figure in (shown.figure(), mode_shapes_figure(shown)):
            assert (NOT_SHOWN in figure.get_suptitle()) == is_free


def test_rounding_of_what_nothing_holds_is_no_logarithmic_decrement():
    """Of a rotor on two dampers, at a speed: the sensitivity is that of the modes that are held."""
    damper = "[[linear_bearing]]\nnode = {}\nkxx = 0.0\nkyy = 0.0\ncxx = {}\ncyy = {}\n"
    rotor = parse_rotor(SHAFT + damper.format(1, 2e3, 2e3) + damper.format(5, 1e3, 1e3))
    one = level_1(rotor, 300.0, node=4)
    assert 0.0 < -one.sensitivity * one.threshold < 10.0 * one.log_dec_alone


def test_a_seal_that_pulls_makes_its_case_of_level_2_unstable():
    cases = level_2(pulled("seal"), 300.0).cases
    assert [case.log_dec == -math.inf for case in cases] == [False, True]


@pytest.mark.parametrize("nodes", [(7,), (1, 7)])
def test_a_shaft_that_is_not_held_against_what_pulls_has_no_critical_speed_on_rigid_supports(nodes):
    """One bearing, about which it turns, or none: its stability is judged all the same."""
    held = "" if 1 in nodes else PULLING.format(kind="linear_bearing", node=1, k=1e7, ky=1e7)
    pulls = (PULLING.format(kind="linear_bearing", node=n, k=-5e5, ky=-5e5) for n in nodes)
    rotor = parse_rotor("gravity = 0.0\n" + SHAFT + held + "".join(pulls))
    one = level_1(rotor, 300.0, node=4)
    assert math.isnan(one.critical_speed_ratio)
    assert one.is_level_2_required
    with pytest.raises(LinearError, match="not held by its bearings against what pulls"):
        critical_map(rotor, [1e6, 1e7])


def test_what_grows_without_oscillating_has_no_sensitivity_to_cross_coupling():
    """Alike in x and y the least coupling makes it a whirl, whose decrement is finite."""
    pulls = "".join(PULLING.format(kind="linear_bearing", node=n, k=-5e5, ky=-5e5) for n in (1, 7))
    one = level_1(parse_rotor(SHAFT + pulls), 300.0, node=4)
    assert one.log_dec_alone == -math.inf
    assert math.isfinite(one.log_dec[1])
    assert math.isnan(one.sensitivity)


def test_the_tables_name_growth_without_oscillation_and_a_missing_stage():
    rotor = pulled()
    tables = (
        answers.modes(rotor, 300.0).table(),
        stability_answers.level_1(rotor, 300.0, node=4).table(),
        stability_answers.level_2(rotor, 300.0).table(),
    )
    for table in tables:
        assert "UNSTABLE: a motion grows without oscillating" in table.title
    assert "no stage and no cross coupling was given: QA is 0" in tables[1].title
    for result in (
        stability_answers.level_1(rotor, 300.0, node=4),
        stability_answers.level_2(rotor, 300.0),
    ):
        result.figure().canvas.draw()
    given = stability_answers.level_1(pulled(k=-1e6), 300.0, node=4, anticipated=1e3).table().title
    assert "UNSTABLE" not in given
    assert "no stage" not in given


@pytest.mark.usefixtures("without_peaks")
@pytest.mark.parametrize(("soft", "is_unstable"), [(2e5, True), (4e6, False)])
def test_a_response_from_speeds_on_at_which_bearings_are_softer_than_what_pulls_says_so(
    soft, is_unstable, command, tmp_path
):
    """A generator's films are soft at low speeds; at its rated one it is stable."""
    stiffness = f"kxx = [{soft}, 1e7]\nkyy = [{soft}, 1e7]\ncxx = 2e3\ncyy = 2e3\n"
    held = f"[[linear_bearing]]\nnode = {{}}\nspeed = [10.0, 300.0]\n{stiffness}"
    pull = PULLING.format(kind="linear_bearing", node=4, k=-1e6, ky=-1e6)
    path = tmp_path / "machine.toml"
    path.write_text(SHAFT + held.format(1) + held.format(7) + pull + UNBALANCE)
    assert (campbell(parse_rotor(path.read_text()), [10.0, 300.0]).threshold == 10.0) == is_unstable
    said = command("unbalance", "--rotor", str(path), "--speed", "10:300:3")
    assert (
        "unstable at 1.5915 Hz, where its steady response is not reached" in said
    ) == is_unstable


@pytest.mark.parametrize(
    ("k", "cross", "leaves"), [(-1e4, 0.0, True), (-1e4, 1e3, True), (1e4, 3e4, False)]
)
def test_a_pull_alike_in_both_planes_moves_a_machine_away_though_it_turns_a_little(
    k, cross, leaves
):
    """Of m z'' + c z' + (k - i cross) z = 0 the growing root is a whirl only where k > 0."""
    bearing = f"kxx = {k}\nkyy = {k}\nkxy = {cross}\nkyx = {-cross}\ncxx = 10.0\ncyy = 10.0\n"
    rotor = parse_rotor(
        SHAFT + "".join(f"[[linear_bearing]]\nnode = {n}\n{bearing}" for n in (1, 7))
    )
    fastest = max(all_roots(rotor, 300.0), key=lambda root: root.real)
    assert fastest.real > 0.0
    assert (abs(fastest.imag) < fastest.real) == leaves
    assert bool(where_not_at_rest(rotor, 300.0)) == leaves
