"""Pictures of linear analyses: what is read in them covers nothing else."""

import math
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.text import Text
from rotor_fmu.model.linear.amplification import Peak
from rotor_fmu.model.linear.stability_levels import StabilityCase
from rotor_fmu.model.linear.unbalance_check import ProbeCritical

from rotor_fmu.balancing.result import Balancing, ResidualUnbalance, Vibration
from rotor_fmu.linear import answers, bearing_answers, frequency_answers
from rotor_fmu.linear.acceptance import CriticalPeaks
from rotor_fmu.linear.linear_plots import FAINT
from rotor_fmu.linear.stability_answers import StabilityLevel2
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.plotting.colors import COLORS
from rotor_fmu.vibration.influence_coefficients import once_per_turn

from ..known import EXAMPLES
from ..toml_text import table
from .test_linear_commands import ROSS, TURBOCHARGER


@pytest.mark.usefixtures("drawn")
def test_the_labels_of_a_campbell_diagram_do_not_cover_each_other():
    """Of a machine whose critical speeds of four orders lie close together."""
    rotor = load_rotor(ROSS / "under_tension.toml")[1]
    result = answers.campbell(rotor, np.linspace(0.0, 400.0, 9), harmonic=(1.0, 2.0, 3.0, 4.0))
    figure = result.figure()
    figure.draw_without_rendering()
    axes = figure.axes[0]
    boxes = [Text.get_window_extent(text) for text in axes.texts]  # without their lines
    assert len(boxes) == len(result.critical) > 8
    assert not any(box.count_overlaps(boxes[:i]) for i, box in enumerate(boxes))


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize(
    "orders", [(1.0,), pytest.param(tuple(np.arange(1.0, 11.0)), marks=pytest.mark.slow)]
)
def test_the_legend_of_a_campbell_diagram_lies_within_it_and_covers_no_line(orders):
    rotor = load_rotor(TURBOCHARGER)[1]
    figure = answers.campbell(rotor, [100.0, 1000.0], harmonic=orders).figure()
    figure.draw_without_rendering()
    (legend,) = figure.legends
    box = legend.get_window_extent()
    assert figure.bbox.x0 <= box.x0 < box.x1 <= figure.bbox.x1
    assert not box.count_overlaps([axes.bbox for axes in figure.axes])


@pytest.mark.parametrize("lowest", [100.0, 800.0])
def test_the_threshold_in_a_campbell_diagram_is_named_as_in_its_table_and_covers_no_line(lowest):
    result = answers.campbell(
        load_rotor(EXAMPLES / "from_ross" / "rubbing.toml")[1], [lowest, 1000.0]
    )
    figure = result.figure()
    assert result.stability in [text.get_text() for text in figure.legends[0].texts]
    assert not figure.axes[1].texts


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_mode_that_hardly_oscillates_hides_no_decrement_of_a_campbell_diagram(sign):
    """It grows or decays by a factor without limit in each of its periods."""
    result = answers.campbell(load_rotor(TURBOCHARGER)[1], [100.0, 1000.0])
    log_dec = np.full_like(result.log_dec, 0.2)
    log_dec[:, 0] = sign * 1e4
    result = replace(result, eigenvalues=-log_dec / (2.0 * math.pi) + 1j)
    low, high = result.figure().axes[1].get_ylim()
    assert (low, high) == pytest.approx((-3.0, 0.22) if sign < 0.0 else (-0.1, 3.0))


def test_modes_too_damped_to_peak_are_faint_in_a_campbell_diagram():
    """Since they meet the line of the speed at no critical speed; some do not oscillate at all."""
    result = answers.campbell(load_rotor(TURBOCHARGER)[1], [100.0, 1000.0])
    figure = result.figure()
    is_faint = [line.get_alpha() == FAINT for line in figure.axes[0].lines[: len(result.log_dec.T)]]
    np.testing.assert_array_equal(is_faint, ~(result.damping_ratio <= 0.5**0.5).any(axis=0))
    assert sum(is_faint) == 1
    assert "damping ratio above 0.71: no peak" in [
        text.get_text() for text in figure.legends[0].texts
    ]


@pytest.mark.usefixtures("drawn")
def test_the_loads_in_a_picture_of_a_machine_at_rest_cover_neither_each_other_nor_nodes(tmp_path):
    """Of a machine whose supports stand close together."""
    nodes = [0.05 * i for i in range(9)]
    text = table("material", young=2.1e11, density=7800.0)
    text += table("shaft", nodes=nodes, diameters=[0.03] * 8)
    for node in range(1, 10):
        text += table("[support]", node=node, name=f"support_at_{node}", stiffness=1e5)
    rotor = tmp_path / "rotor.toml"
    rotor.write_text(text)
    figure = answers.static(rotor).figure()
    figure.draw_without_rendering()
    (axes,) = figure.axes
    boxes = [Text.get_window_extent(text) for text in axes.texts if text.get_text()]
    assert len(boxes) == 9
    dots = axes.transData.transform(axes.lines[2].get_xydata())
    for i, box in enumerate(boxes):
        assert not box.count_overlaps(boxes[:i])
        assert not any(box.contains(*dot) for dot in dots)


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize("case", ["two elements", "long words"])
def test_the_loads_in_a_picture_of_a_machine_at_rest_cross_no_curve(tmp_path, case):
    """Of a shaft that sags below and beside its supports."""
    text = table("material", young=2.1e11, density=7800.0)
    text += table("shaft", nodes=[0.0, 0.5, 1.0], diameters=[0.03, 0.03])
    for node in (1, 3):
        text += table("[support]", node=node, name=f"support_at_{node}", stiffness=1e7)
    rotor = tmp_path / "rotor.toml"
    rotor.write_text(text)
    rotor, count = (rotor, 2) if case == "two elements" else (ROSS / "pump.toml", 4)
    figure = answers.static(load_rotor(rotor)[1]).figure()
    figure.draw_without_rendering()
    (axes,) = figure.axes
    words = [text for text in axes.texts if text.get_text()]
    assert len(words) == count
    for line in axes.lines:
        path = line.get_transform().transform_path(line.get_path())
        for text in words:
            assert not path.intersects_bbox(Text.get_window_extent(text), filled=False)


def test_the_decrements_of_stability_level_2_are_written_where_none_can_be_taken_for_the_limit():
    values = (-1.4, 0.09, 0.3)
    cases = [
        StabilityCase(f"case {at}", value, 100.0, value, 100.0) for at, value in enumerate(values)
    ]
    figure = StabilityLevel2(300.0, tuple(cases)).figure()
    figure.draw_without_rendering()
    (axes,) = figure.axes
    labels = axes.get_yticklabels()
    assert [text.get_text() for text in labels] == ["case 0: -1.4", "case 1: 0.09", "case 2: 0.3"]
    boxes = [text.get_window_extent() for text in labels]
    assert figure.bbox.x0 <= min(box.x0 for box in boxes)
    assert max(box.x1 for box in boxes) < axes.bbox.x0
    assert not axes.texts


def test_pictures_write_the_sign_of_micrometres_where_tables_write_letters():
    rotor = load_rotor(TURBOCHARGER)[1]
    name = "floating_ring_bearing[1]"
    ring = bearing_answers.floating_ring(rotor, [2000.0, 3000.0], bearing=name).figure()
    assert ring.axes[0].get_xlabel() == "x [µm]"
    swing = frequency_answers.frequency_response(rotor, [100.0, 200.0], 1, [1], speed=2000.0)
    assert swing.figure().axes[0].get_ylabel() == "Displacement by force [µm/N]"


def test_pictures_draw_each_of_many_nodes_in_a_colour_of_its_own():
    """Of more nodes than there are colours of pictures."""
    rotor = load_rotor(ROSS / "under_tension.toml")[1]
    nodes = range(1, len(rotor.nodes) + 1)
    assert len(nodes) > len(COLORS)
    unbalance = answers.unbalance_response(rotor, [100.0, 200.0]).figure(nodes)
    force = frequency_answers.frequency_response(rotor, [100.0, 200.0], 1, nodes).figure()
    for figure, legend in ((unbalance, unbalance.axes[0].get_legend()), (force, *force.legends)):
        lines = zip(legend.texts, legend.legend_handles, strict=True)
        shown = {t.get_text(): h.get_color() for t, h in lines if t.get_text()[:4] == "node"}
        assert [*shown] == [f"node {node}" for node in nodes]
        assert len(set(shown.values())) == len(nodes)
        assert {line.get_color() for line in figure.axes[0].lines} == {*shown.values()}


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_n1_is_the_half_power_speed_nearer_to_standstill_whichever_way_the_shaft_turns(sense):
    ends = sorted((sense * 90.0 * math.tau, sense * 115.0 * math.tau))
    peak = Peak(sense * 100.0 * math.tau, 1e-5, *ends)
    (row,) = CriticalPeaks((ProbeCritical(1, "x", peak, None),)).table().rows
    assert row[4:] == pytest.approx((sense * 90.0, sense * 115.0, 4.0))


@pytest.mark.parametrize("factor", [0.5, 3.0, 3e4])
def test_what_is_critically_damped_is_written_within_the_picture_of_amplification_factors(factor):
    peak = Peak(100.0, 1e-5, 100.0 - 50.0 / factor, 100.0 + 50.0 / factor)
    figure = CriticalPeaks((ProbeCritical(1, "x", peak, None),)).figure()
    figure.draw_without_rendering()
    (axes,) = figure.axes
    words = Text.get_window_extent(axes.texts[0])
    assert axes.bbox.y0 < words.y0 < words.y1 < axes.bbox.y1


def test_a_balancing_at_several_speeds_has_a_picture_of_each():
    """Whose vibrations differ in size: at 30 rad/s they are a dot beside those at 300 rad/s."""
    seen = [
        Vibration(2, axis, speed, speed**2 * 1e-9, 0.0, 0.0)
        for speed in (30.0, 300.0)
        for axis in "xy"
    ]
    numbers = {"influence": np.zeros((4, 1)), "rank": 1, "touches": False, "settles": True}
    found = Balancing((), tuple(seen), (), service_speed=300.0, messages=(), **numbers)
    slow, fast = found.figure().axes
    assert [text.get_text() for text in slow.texts] == ["2x", "2y"]
    assert [axes.get_title(loc="left") for axes in (slow, fast)] == ["at 4.7746 Hz", "at 47.746 Hz"]
    assert fast.viewLim.width == pytest.approx(100.0 * slow.viewLim.width)


@pytest.mark.usefixtures("drawn")
def test_places_that_vibrate_alike_have_labels_beside_each_other_in_a_balancing():
    seen = tuple(Vibration(n, "x", 30.0, 1e-6 + n * 1e-9j, 0.0, 0.0) for n in (2, 3, 4, 5))
    numbers = {"influence": np.zeros((4, 1)), "rank": 1, "touches": False, "settles": True}
    figure = Balancing((), seen, (), service_speed=30.0, messages=(), **numbers).figure()
    figure.draw_without_rendering()
    (axes,) = figure.axes
    boxes = [Text.get_window_extent(text) for text in axes.texts]
    assert [text.get_text() for text in axes.texts] == ["2x", "3x", "4x", "5x"]
    assert not any(box.count_overlaps(boxes[:i]) for i, box in enumerate(boxes))
    assert axes.get_xlabel() == "In phase with the mark [µm 0-p]"  # as in every picture


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_lag_is_negative_in_a_balancing_whichever_way_the_shaft_turns(sense):
    """Of a vibration that is 0.3 rad behind the mark."""
    turned = np.linspace(0.0, 40.0, 400)
    seen = once_per_turn(sense * turned, np.cos(turned - 0.3))
    numbers = {"influence": np.zeros((1, 1)), "rank": 1, "touches": False, "settles": True}
    vibrations = (Vibration(2, "x", sense * 30.0, seen, 0.0, 0.0),)
    found = Balancing((), vibrations, (), service_speed=30.0, messages=(), **numbers)
    (row,) = found.table().rows
    assert row[6] == pytest.approx(np.degrees(-0.3))
    # whose angles beside it grow from x towards y, against the rotation
    assert ("of vibrations in the sense of rotation" in found.table().title) == (sense < 0)
    (axes,) = found.figure().axes
    shown = next(line for line in axes.lines if line.get_label() == "initial")
    assert np.arctan2(*shown.get_data()[::-1]) == pytest.approx(-0.3)


def test_rounding_of_an_unbalance_of_one_direction_is_no_angle():
    numbers = {"influence": np.zeros((1, 0)), "rank": 0, "touches": False, "settles": True}
    vibrations = (Vibration(2, "x", 30.0, 1e-6 + 0j, 0j, 0j),)
    there = ResidualUnbalance(1, 10.0, 1e-6 + 1e-22j, 0j, 1e-6, 1.0)
    found = Balancing((), vibrations, (there,), service_speed=30.0, messages=(), **numbers)
    assert found.table().rows[0][6] == 0.0
