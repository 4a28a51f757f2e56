"""The page of a response: its curve, and the orbit of the point under the pointer."""

import numpy as np
import pytest
from rotor_fmu.model.periodic.branch import FOLD, Bifurcation, Branch, Solution

import rotor_fmu as rf
from rotor_fmu.display import choose, restored
from rotor_fmu.periodic.response_page import response_page
from rotor_fmu.periodic.vertices import pieces, vertices

from ..documents.browser import NASTY, Page
from ..parts.machines import bearings, rigid
from .machines import CLEARANCE, OMEGA, jeffcott, rub

HERTZ = 1 / (2 * np.pi)  # of a rad/s


def test_the_page_is_one_file_with_tables_and_a_name_that_is_text(curve):
    html = response_page(curve, NASTY)
    assert NASTY not in html
    assert ">fold</td>" in html


def test_picture_table_and_page_are_in_the_units_chosen(curve):
    with restored():
        choose("rpm, mil")
        axes = curve.figure().axes[0]
        heads, rows = curve.table().heads, curve.table().rows
        html = response_page(curve, "Jeffcott")
    assert axes.get_xlabel() == heads[2] == "speed [rpm]"
    assert axes.get_xlim()[1] == pytest.approx(240.0 * 30 / np.pi)
    found = [b.value * 30 / np.pi for b in curve.bifurcations]
    assert [row[2] for row in rows] == pytest.approx(found)
    assert axes.get_ylabel() == "Largest distance from the mean [mil]"
    drawn = max(line.get_ydata().max() for line in axes.lines)
    assert drawn == pytest.approx(curve.curve("disc").value.max() / 25.4e-6)
    assert axes.get_title("left").endswith("periodic motions over speed")
    assert '"unit":"rpm","small":"mil"' in html


def test_the_table_says_where_on_the_unit_circle_a_pair_of_multipliers_leaves_it(over_friction):
    (torus,) = [b for b in over_friction.bifurcations if b.kind == "Neimark-Sacker"]
    (row,) = [row for row in over_friction.table().rows if row[1] == "Neimark-Sacker"]
    real, _, imaginary = row[3].partition(" ± ")
    crossing = complex(float(real), float(imaginary.removesuffix("i")))
    assert abs(crossing - complex(torus.multiplier.real, abs(torus.multiplier.imag))) < 1e-3


def drawn_through(speeds, amplitudes):
    """Speeds and amplitudes of what is drawn through stable motions with these."""
    points = [
        Solution(speed, None, np.array([[0.0], [z]]), np.zeros(0), True, 0.0, ())
        for speed, z in zip(speeds, amplitudes, strict=True)
    ]
    ((motions, _),) = pieces(Branch(points))
    return np.array([at.value for at in motions]), np.array([at.motion[1, 0] for at in motions])


def test_between_the_points_of_a_resonance_a_curve_is_drawn_on_which_they_lie():
    """As near to the closed form as cubics are; through points of a line nothing is added."""

    def amplitude(speed):
        return 1e-5 / (1 - (speed / 100) ** 2 + 0.1j * speed / 100)

    points = 100 + 5 * np.sinh(np.linspace(-2.5, 2.5, 23))
    speeds, seen = drawn_through(points, amplitude(points))
    assert len(speeds) > 2 * len(points)
    assert set(points) <= set(speeds)
    assert (np.diff(speeds) > 0).all()
    assert np.abs(seen - amplitude(speeds)).max() < 2e-3 * np.abs(seen).max()
    straight, _ = drawn_through(points, 1e-6j * points)
    assert straight == pytest.approx(points)


def test_across_a_corner_no_curve_is_drawn():
    """Such as where a contact begins: up to it and from it on it is a line."""
    speeds, seen = drawn_through([1.0, 2.0, 3.0, 4.0, 5.0], [0.0, 0.0, 0.0, 2.0, 4.0])
    assert len(speeds) == 5
    assert seen.tolist() == [0.0, 0.0, 0.0, 2.0, 4.0]


def test_marks_lie_on_the_curve_which_changes_from_full_to_dashed_at_them(curve, over_friction):
    for found in (curve, over_friction):
        lines = found.figure().axes[0].lines
        drawn = [np.column_stack(line.get_data()) for line in lines]
        marks = {tuple(at[0]) for at in drawn if len(at) == 1}
        curves = [at for at in drawn if len(at) > 1]
        on_curves = {tuple(at) for line in curves for at in line}
        assert len(marks) >= len(found.bifurcations) > 0
        assert marks <= on_curves
        ends = [tuple(line[0]) for line in curves], [tuple(line[-1]) for line in curves]
        assert set(ends[0]) & set(ends[1]) <= marks


@pytest.mark.slow
def test_the_pointer_shows_the_orbit_of_the_nearest_point(silent, curve, tmp_path):
    path = tmp_path / "response.html"
    path.write_text(response_page(curve, "Jeffcott"), encoding="utf-8")
    page = Page(silent, path)
    points = [vertex.motion for branch in curve.branches for vertex in vertices(branch)]
    assert page.run("return curves.place.name") == "disc"
    omega = 1.8
    for sign, words in ((1, "stable"), (-1, "unstable")):
        radius = 1e6 * CLEARANCE * rub(omega, sign=sign)
        page.run("curves.follow(arguments[0], arguments[1])", omega * OMEGA * HERTZ, radius)
        said = page.text("reading")
        assert f", {words}, " in said
        x, y = page.run("return [curves.path.data.x, curves.path.data.y]")
        i = page.run("return curves.row")
        at = points[i]
        assert abs(at.value - omega * OMEGA) < 0.03 * omega * OMEGA
        expected = 1e6 * curve.amplitude(at, "disc")
        assert np.hypot(x, y) == pytest.approx(np.full(len(x), expected), rel=1e-3)
    # a motion of the mouse itself
    page.click_at("curves.chart", 1.2 * OMEGA * HERTZ, 1e6 * CLEARANCE * rub(1.2))
    assert abs(points[page.run("return curves.row")].value - 1.2 * OMEGA) < 0.1 * OMEGA
    page.find("after").click()
    before = page.run("return curves.row")
    page.find("before").click()
    assert page.run("return curves.row") == before - 1
    (fold,) = [i for i, at in enumerate(points) if isinstance(at, Bifurcation) and at.kind == FOLD]
    page.run("curves.pick(arguments[0])", fold)
    assert ", fold, " in page.text("reading")
    page.set("quantity", "x_1x", "change")
    assert "disc.x_1x" in page.text("reading")


def test_unstable_motions_are_dashed_and_curves_those_of_the_picture(silent, curve, tmp_path):
    path = tmp_path / "response.html"
    path.write_text(response_page(curve, "Jeffcott"), encoding="utf-8")
    page = Page(silent, path)
    full, dashed = page.run(
        "return curves.lines[0].map((s) => s.data.y.map((v) => Number.isFinite(v) ? v : null))"
    )
    drawn = {"-": [], "--": []}
    for line in curve.figure(["disc"]).axes[0].lines:
        if len(line.get_ydata()) > 1:
            drawn[line.get_linestyle()] += list(line.get_ydata())
    for on_page, in_picture in zip((full, dashed), drawn.values(), strict=True):
        shown = sorted(v for v in on_page if v is not None)
        assert shown == pytest.approx(sorted(in_picture), rel=1e-5)
        assert len(shown) > 20


@pytest.mark.slow
def test_an_orbit_far_smaller_than_the_largest_one_is_round(silent, tmp_path):
    path = tmp_path / "response.html"
    found = rf.response(jeffcott(zeta=1e-3, e=1e-3), speed=(20.0, 400.0), stability=False)
    path.write_text(response_page(found, "Jeffcott"), encoding="utf-8")
    page = Page(silent, path)
    page.run("curves.pick(0)")
    x, y = page.run("return [curves.path.data.x, curves.path.data.y]")
    curve = 1e6 * found.curve("disc").value
    assert curve[0] < 1e-4 * curve.max()
    assert np.hypot(x, y) == pytest.approx(np.full(len(x), curve[0]), rel=1e-3)


def test_places_that_move_alike_have_one_curve_with_the_names_of_both():
    ends = "".join(f'[[sensor]]\nnode = {n}\nname = "at_{n}"\n' for n in (1, 2))
    unbalanced = "[[unbalance]]\nnode = 2\namount = 1e-4\n"
    text = rigid(parts=bearings(OMEGA**2, 0.2 * OMEGA) + unbalanced + ends)
    found = rf.response(rf.parse(text), speed=(50.0, 150.0), stability=False)
    axes = found.figure(["at_1", "at_2"]).axes[0]
    assert len(axes.lines) == 1
    assert axes.get_legend().get_texts()[0].get_text() == "at_1, at_2"
