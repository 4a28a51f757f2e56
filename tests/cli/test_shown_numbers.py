"""Numbers and names in tables and pictures: all digits, apart, and what is rounding as 0."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.structure.beam import shaft_element

from rotor_fmu.cells import cell
from rotor_fmu.display import (
    choose,
    display_of,
    range_with_unit,
    restored,
    shown_speed,
    speed_with_unit,
)
from rotor_fmu.linear import acceptance, answers, bearing_answers, frequency_answers
from rotor_fmu.linear.displayed import _shear
from rotor_fmu.linear.linear_plots import deflection
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.plotting.figure_style import PlainFigure, new_figure, new_panels, save
from rotor_fmu.plotting.notebook import png
from rotor_fmu.run_pictures import run_folder

from ..known import EXAMPLES
from ..recordings import recorded


def test_a_run_far_from_standstill_fills_its_picture():
    """From 300 to 180 rad/s, 47.7 to 28.6 Hz; one near standstill is drawn down to it."""
    far, near = (run_folder.journal_angle(recorded(rate=rate), "") for rate in (-20.0, -40.0))
    assert far.axes[0].get_xlim() == (20.0, 50.0)
    assert near.axes[0].get_xlim() == (0.0, 50.0)


@pytest.mark.usefixtures("drawn")
def test_names_are_drawn_as_written_and_powers_of_ten_as_powers(tmp_path):
    figure, axes = new_figure()
    axes.semilogy([1, 2], [1e-3, 1e3])
    axes.set_title("rotor $_1$")
    save(figure, tmp_path / "figure.png")
    assert not axes.title.get_parse_math()
    labels = [label for label in axes.get_yticklabels() if label.get_text()]
    assert labels
    assert all(label.get_parse_math() for label in labels)


@pytest.mark.usefixtures("drawn")
def test_a_figure_is_written_as_matplotlib_would_drawn_once_less(tmp_path, monkeypatch):
    def figure():
        made, panels = new_panels(6.4, 2.5, 1, 2)
        panels[0].plot([0, 1], [1e6, 2e6], label="a curve")
        panels[0].set_ylabel("a label of an axis")
        made.colorbar(panels[1].imshow([[0.0, 1.0]]), ax=panels[1])
        made.suptitle("A title")
        return made

    figure().savefig(tmp_path / "matplotlib.png", metadata={"Software": None})
    drawn, draw = [], PlainFigure.draw
    monkeypatch.setattr(PlainFigure, "draw", lambda *of: (drawn.append(of), draw(*of)))
    made = figure()
    engine = made.get_layout_engine()
    save(made, tmp_path / "saved.png")
    assert len(drawn) == 1
    assert made.get_layout_engine() is engine
    written = [(tmp_path / f"{name}.png").read_bytes() for name in ("matplotlib", "saved")]
    assert written[0] == written[1] == png(figure())


def test_speeds_in_pictures_have_all_digits_before_the_point():
    with restored():
        choose("rpm")
        assert shown_speed(1814.3) == "17325"
        assert shown_speed(100 * math.pi / 3) == "1000"
        # where rounding missed 10000 rpm by a little
        assert shown_speed(-9999.9999 * math.pi / 30) == "-10000"
        assert shown_speed(9999.4 * math.pi / 30) == "9999"


def test_speeds_in_tables_and_titles_have_all_digits_before_the_point_too():
    with restored():
        choose("rpm")
        assert speed_with_unit(4000 * math.pi) == "120000 rpm"
        assert range_with_unit(1200 * math.pi, 5000 * math.pi) == "between 36000 and 150000 rpm"
    assert [cell(x) for x in (99999.7, 128333.3, 1.839e6, 2.2e7)] == [
        *("100000", "128333", "1839000", "2.2e+07"),
    ]


def test_numbers_of_six_digits_below_a_narrow_picture_stand_apart():
    figure, panels = new_panels(8.4, 7.4, 2, 2)
    panels[1].plot([20e3, 150e3], [0.0, 1.0])
    figure.draw_without_rendering()
    boxes = [label.get_window_extent() for label in panels[1].get_xticklabels()]
    seen = [box for box in boxes if panels[1].bbox.x0 <= (box.x0 + box.x1) / 2 <= panels[1].bbox.x1]
    assert len(seen) >= 3
    assert all(left.x1 < right.x0 for left, right in itertools.pairwise(seen))


def test_what_of_a_load_is_rounding_is_shown_as_0():
    """No film bears across gravity, but for 3e-9 of what it bears."""
    _, rotor = load_rotor(EXAMPLES / "turbocharger" / "rotor.toml")
    answer = answers.static(rotor)
    answer = replace(answer, load_x=3e-9 * answer.load_y)
    rows = answer.table().rows[-len(answer.supports) :]
    assert {row[4] for row in rows} == {0.0}
    assert [row[5] for row in rows] == pytest.approx(answer.load_y)


@pytest.fixture(scope="module")
def upright():
    """A rotor in plain films, which nothing loads: these have no direct stiffness."""
    _, rotor = load_rotor(EXAMPLES / "oil_film" / "rotor.toml")
    return replace(rotor, inclination=math.pi / 2)


def test_what_nothing_loads_rests_in_the_middle_of_its_films(upright):
    answer = answers.static(upright, 400.0)
    for moved in (answer.x, answer.y, answer.slope_x, answer.load_x, answer.load_y):
        assert not moved.any()


def test_a_journal_in_the_middle_of_its_pads_has_no_attitude(upright):
    pads = {"pads": tuple(math.tau * (n / 5 + 0.25) for n in range(5)), "arc": 1.0, "preload": 0.4}
    (film, *_) = (p for p in upright.parts if isinstance(p, JournalBearing))
    tilting = replace(upright, parts=(replace(film, tilting=True, pad_inertia=1e-4, **pads),))
    found = bearing_answers.bearing(tilting, [100.0, 300.0, 400.0], load=0.0)
    assert not found.eccentricity.any()
    assert not found.attitude.any()
    assert not bearing_answers.bearing(tilting, [100.0, 300.0], load=1.0).attitude.any()
    plain = bearing_answers.bearing(upright, [100.0, 250.0, 300.0, 400.0])
    assert not plain.critical_mass.any()


def test_coefficients_that_are_rounding_are_shown_as_0(upright):
    table = bearing_answers.bearing(upright, [100.0, 400.0]).table()
    shown = dict(zip(table.heads, zip(*table.rows, strict=True), strict=True))
    for name in ("kxx [N/m]", "kyy", "cxy", "cyx"):
        assert shown[name] == (0.0, 0.0)
    assert all(shown["kyx"])


def test_a_critical_map_says_whether_its_lines_are_speeds_or_frequencies():
    speeds, frequencies = (
        acceptance.critical_map(rig(), [1e5, 2e5], count=1, synchronous=is_synchronous)
        for is_synchronous in (True, False)
    )
    assert speeds.table().title.startswith("Undamped forward critical speeds where a bearing has")
    title = frequencies.table().title
    assert title.startswith("Natural frequencies at standstill where a bearing has the stiffness")
    rigid = f"first critical speed on rigid supports {speed_with_unit(speeds.rigid)}"
    assert title.endswith(f"{rigid}; no bearing's own stiffness meets a line within the map")
    labels = [each.figure().axes[0].get_ylabel() for each in (speeds, frequencies)]
    assert labels == [
        "Undamped critical speed [Hz]",
        "Undamped natural frequency at standstill [Hz]",
    ]


def test_what_is_rounding_is_not_drawn_beside_other_curves(upright):
    assert not acceptance.critical_map(upright).figure().legends
    found = frequency_answers.frequency_response(upright, [1.0, 10.0], 2, [2], speed=400.0)
    found.receptance[:, :, 1, 0] *= 1e-12
    above, _ = found.figure().axes
    assert [line.get_label() for line in above.lines] == ["node 2: x by x", "node 2: y by y"]


def test_a_value_is_shown_with_its_unit_if_it_has_one():
    shown = display_of("--units", "us").of_si
    assert shown("m").text(25.4e-6) == "1 mil"
    assert display_of("--units", "si").of_si("m").text(1e-6) == "1 um"
    assert shown("1").text(0.25) == "0.25"


def test_a_range_of_one_speed_is_said_as_one_speed():
    speed = 8000 * math.pi / 30
    with restored():
        choose("rpm")
        assert range_with_unit(speed, speed) == "at 8000 rpm"
        assert range_with_unit(speed, 1.25 * speed) == "between 8000 and 10000 rpm"
        table = acceptance.unbalance_check(rig(), 0.1 * speed, 0.1 * speed, [4]).table()
    assert table.title.startswith("API 617 at 800 rpm, ")


def test_the_unbalance_picture_says_that_amplitudes_are_0_p():
    figure = answers.unbalance_response(rig(), np.linspace(10.0, 300.0, 20)).figure()
    assert figure.axes[0].get_ylabel() == "Amplitude [µm 0-p]"


def test_a_shape_is_drawn_with_the_elements_own_cubic():
    """Within it a cantilevered element under a force at its end has what Timoshenko's beam has;
    a cubic with the sections' rotations for slopes has not."""
    section = rig().sections[0]
    stiffness = shaft_element(section).stiffness[np.ix_((2, 3), (2, 3))]
    w, rotation = np.linalg.solve(stiffness, [1.0, 0.0])
    length, phi = section.length, _shear(section)
    inertia = math.pi / 64 * section.outer_left**4
    bending = section.material.young * inertia
    sheared = phi * length**2 / 12  # E I / (kappa G A)
    assert w == pytest.approx(length**3 / 3 / bending + length * sheared / bending, rel=1e-9)
    z, deflections, rotations = (
        np.array([0.0, length]),
        np.array([0.0, w]),
        np.array([0.0, rotation]),
    )
    x = length / 4
    truth = (x**2 * (3 * length - x) / 6 + x * sheared) / bending
    assert deflection(z, deflections, rotations, [phi])(x) == pytest.approx(truth, rel=1e-9)
    assert abs(deflection(z, deflections, rotations, [0.0])(x) / truth - 1) > 1e-3


@pytest.mark.parametrize(
    ("sizes", "is_cut"), [([1.0, 2.0, 1.5], False), ([1.0, 1.5, 2.0], True), ([1.0] * 3, False)]
)
def test_a_largest_sensitivity_at_an_end_of_the_frequencies_is_said_to_be_there(sizes, is_cut):
    """A loop without force has the same at all of them."""
    at = 2.0 * math.pi * np.array([1.0, 10.0, 20.0])
    seen = np.array(sizes, complex)[:, None]
    found = frequency_answers.Sensitivity(100.0, at, ("left x",), seen, True)
    title = found.table().title
    assert "largest from 1 to 20 Hz" in title
    assert ("at an end of that range" in title) == is_cut
