"""The page in a browser: silent, linked, right under the cursor, at every width and in the dark."""

import math
import re

import numpy as np
import pytest

from rotor_fmu import vibration
from rotor_fmu.files import write_text
from rotor_fmu.report.run_page import runs_page
from rotor_fmu.report.study_page import study_page
from rotor_fmu.saved_results import read_study

from ..recordings import recorded, write_study
from .browser import ENTER, LEFT, NASTY, Page, look

ONE = {"one": {"parameters": {"bearing[1].clearance": 6e-5}}}
LONG = 4 * "a_word_of_sixteen"[:16]
# runs by their names, of each page
SHOWN = {
    "one": ONE,
    "two": ONE | {"two": {"speed": 350.0, "rate": -30.0}},
    "steady": {"steady": {"rate": 0.0}},
    "cut": {"cut": {"stop": 0.03, "status": "failed: whirled apart"}},
    # which turns both ways
    "nasty": {NASTY: {"machine": NASTY, "messages": [NASTY], "speed": 150.0, "rate": -50.0}},
    "long": {"long": {"disc": LONG, "parameters": {f"{LONG}.e": 1e-5}}},
    "backward": {"backward": {"speed": -300.0, "rate": 20.0}},
}
OTHERS = (*(name for name in SHOWN if name != "one"), "study")


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The page of a name, made when it is asked for first."""
    folder = tmp_path_factory.mktemp("pages")

    def page(name):
        file = folder / f"{name}.html"
        if not file.exists():
            write_text(content(name, folder), file)
        return file

    return page


def content(name, folder):
    if name == "study":
        write_study(folder / "study")
        return study_page(*read_study(folder / "study"))
    runs = [recorded(**about).named(title) for title, about in SHOWN[name].items()]
    return runs_page(runs, [{}] * len(runs))


@pytest.mark.parametrize(
    ("name", "sign"), [pytest.param("backward", -1, marks=pytest.mark.slow), ("nasty", 1)]
)
def test_speeds_of_a_shaft_that_turns_backward_are_below_zero(silent, pages, name, sign):
    page = Page(silent, pages(name))
    hz = np.array(page.run("return over.runs[0].stations.hz"))
    low, high = page.run("const r = over.bode.plot.x_range; return [r.start, r.end]")
    assert low < hz.min() < 0
    assert hz.max() < high
    assert (hz.max() > 0) == (sign > 0)
    page.set("station", 0)
    page.find("near").click()
    near = page.run("return time.range.end - time.range.start")
    assert near == pytest.approx(8 / abs(hz[0]), rel=1e-3)
    # z turns with the shaft, more forward than backward, whichever way that is
    order, top = page.run(
        "const d = over.parts[0].spectrum.data; return [[...d.order], [...d.top]]"
    )
    assert order[int(np.argmax(top))] == 1.0
    assert "whirls forward" in page.text("reading")


def test_a_name_is_shown_as_it_is(silent, pages):
    page = Page(silent, pages("nasty"), is_anew=False)
    assert page.run("return document.querySelector('h1').textContent") == NASTY
    assert page.run("return document.querySelector('.about').textContent") == NASTY
    assert page.run("return time.runs[0].name") == NASTY


@pytest.fixture
def page(silent, pages):
    """The page of one run, loaded once for tests that change in it what no other of them looks at,
    or change it back."""
    return Page(silent, pages("one"), is_anew=False)


def test_a_speed_picked_by_a_click_shows_its_orbit_and_spectrum(page):
    page.click_at("over.bode", 40.0, 50.0)
    run = recorded()
    z = run.columns["disc[2].x"] + 1j * run.columns["disc[2].y"]
    stations = np.array(page.run("return over.runs[0].stations.hz"))
    nearest = stations[np.argmin(np.abs(stations - 40.0))]
    at = int(page.find("station").get_property("value"))
    assert abs(stations[at] - nearest) < 0.5
    assert f"at {float(f'{stations[at]:.5g}'):g} Hz" in page.text("reading")
    # what the library of signals says at that speed
    orbit = np.array(page.run("const d = over.parts[0].orbit.data; return [[...d.x], [...d.y]]"))
    t = page.run("return over.runs[0].stations.t[arguments[0]]", at)
    near = np.abs(run.t - t) < 2 * 2 * math.pi / 240.0
    assert np.abs(orbit[0]).max() == pytest.approx(np.abs(z.real[near]).max() * 1e6, rel=0.01)
    assert np.abs(orbit[0] + 1j * orbit[1]).min() == pytest.approx(60.0, rel=0.01)
    truth = vibration.full_spectrum(run.t, run.columns["phi"], z, 2 * math.pi * stations[at])
    top = np.array(page.run("return [...over.parts[0].spectrum.data.top]"))
    assert np.abs(top - truth.amplitude * 1e6).max() < 0.05
    spans = page.run("return over.spans.map((span) => span.location)")
    assert spans == [stations[at]] * len(spans)
    mark = page.run("const d = over.parts[0].marks.data; return [d.x[0], d.y[0]]")
    expected = 80 * np.exp(-0.6j) + 20
    assert complex(*mark) == pytest.approx(expected, abs=0.1)


def test_four_lines_differ_in_colour_and_dash_and_a_tooltip_names_the_line_and_its_unit(page):
    lines = page.run(
        "const value = (given) => String(given.value ?? given);"
        "return over.bode.hovered.slice(0, 4).map(({ name, glyph }) =>"
        "[name, value(glyph.line_color), value(glyph.line_dash)])"
    )
    assert [name for name, *_ in lines] == ["1x of x", "1x of y", "2x", "0.5x"]
    assert len({color for _, color, _ in lines}) == len({dash for *_, dash in lines}) == 4
    assert page.run("return over.bode.hover.tooltips.map((row) => row.join(' '))") == [
        "line $name", "amplitude @y{custom} µm 0-p", "speed @x{custom} Hz",
    ]  # fmt: skip
    said = page.run("return over.bode.hover.formatters['@y'].format(0.00123456789, '', {})")
    assert said == "0.0012346"  # of a rotor that moves by nanometres


def test_speeds_are_shown_in_rpm(page):
    page.set("turns", "60", "change")
    for chart in ("bode", "phase", "energy"):
        axis = f"over.{chart}.plot.below[0]"
        assert page.run(f"return {axis}.axis_label") == "Speed [rpm]"
        ticks = page.run(f"return {axis}.formatter.doFormat([20, 30.5], {{}})")
        assert ticks == ["1200", "1830"]
        apart = np.diff(page.run(f"return {axis}.ticker.get_ticks(0, 50, null, 0, {{}}).major"))
        assert 60 * apart == pytest.approx(500)
    assert page.run("return over.bode.hover.tooltips[2].join(' ')") == "speed @x{custom} rpm"
    assert re.search(r" at \d+ rpm \([\d.]+ Hz\), t = ", page.text("reading"))
    across = "over.spectrum.plot.below[0]"
    assert page.run(f"return {across}.axis_label") == "Whirl frequency [cpm], backward < 0"
    assert page.run(f"return {across}.formatter.doFormat([50], {{}})") == ["3000"]
    page.set("turns", "1", "change")
    assert page.run("return over.bode.plot.below[0].axis_label") == "Speed [Hz]"


def test_values_under_the_cursor_are_those_recorded(page):
    run = recorded()
    x = run.columns["disc[2].x"] * 1e6
    for t in (0.0, 1.234, 3.3333, 5.999):
        page.set("cursor", t)
        i = int(np.argmin(np.abs(run.t - t)))
        output = page.text("value")
        assert output.startswith(f"disc 2 x at {run.t[i]:.6f} s")
        assert float(output.split(": ")[1].split()[0]) == pytest.approx(x[i], abs=0.002)
    page.set("signal", "1", "change")
    page.wait("time.label === 'disc 2 y'")
    page.set("cursor", 1.234)
    y = run.columns["disc[2].y"][1234] * 1e6
    page.wait(f"document.getElementById('value').textContent.includes('{y:.1f}')")


def test_a_second_place_and_a_time_base_are_drawn(page):
    """Disc 1 moves half as much as disc 2; the time base is about the mean of its two turns."""
    assert page.run("return over.parts[0].second.data.y.length") == 0
    page.set("second", "disc[1]", "change")
    one, two = page.run("const p = over.parts[0]; return [p.bodeX.data.y[10], p.second.data.y[10]]")
    assert two == pytest.approx(one / 2, rel=1e-3)
    orbits = page.run(
        "const p = over.parts[0]; return [[...p.orbit.data.x], [...p.otherOrbit.data.x],"
        "[...p.base[0].data.y], [...p.base[0].data.x]]"
    )
    assert np.array(orbits[0]) == pytest.approx(2 * np.array(orbits[1]), abs=0.05)
    assert orbits[2] == pytest.approx(orbits[0], abs=1e-6)
    away = "const at = over.places[0].orbits, old = at.re; at.re = old.map((v) => v - 40);"
    back = "over.pick(10); at.re = old; return [...over.parts[0].base[0].data.y]"
    assert abs(np.mean(page.run(away + back))) < 1e-3
    assert orbits[3][0] == 0
    assert orbits[3][-1] == pytest.approx(2, abs=0.05)
    assert "disc 1" in page.run("return document.querySelector('#bode .legend').textContent")


@pytest.mark.slow
def test_the_slider_is_worked_by_the_keys(silent, pages):
    page = Page(silent, pages("one"))
    before = int(page.find("station").get_property("value"))
    output = page.text("reading")
    page.find("station").press(LEFT, LEFT)
    assert int(page.find("station").get_property("value")) == before - 2
    assert page.text("reading") != output
    page.find("in").press(ENTER)
    assert page.run("return time.range.end - time.range.start") == pytest.approx(3.0, rel=1e-3)


@pytest.mark.slow
def test_zoom_shows_the_samples_that_are_there(silent, pages):
    page = Page(silent, pages("one"))
    run = recorded()
    page.set("cursor", 2.0)
    for _ in range(6):
        page.find("in").click()
    start, end = page.run("return [time.range.start, time.range.end]")
    assert end - start == pytest.approx(5.999 / 64, rel=1e-6)
    assert start < 2.0 < end
    x, y = map(np.array, page.run("const d = time.sources[0].data; return [[...d.x], [...d.y]]"))
    inside = (run.t > start) & (run.t < end)
    assert np.all(np.isin(np.round(run.t[inside], 5), np.round(x, 5)))
    truth = np.interp(x, run.t, run.columns["disc[2].x"]) * 1e6
    assert y == pytest.approx(truth, abs=0.01)
    assert page.run("return time.dots[0].visible")
    page.find("all").click()
    assert page.run("return [time.range.start, time.range.end]") == pytest.approx([0, 5.999])
    # the whole is thinned to what a screen shows, its extremes kept
    low, high = page.run(
        "const { y } = time.sources[0].data; return [Math.min(...y), Math.max(...y)]"
    )
    assert [low, high] == pytest.approx(
        [run.columns["disc[2].x"].min() * 1e6, run.columns["disc[2].x"].max() * 1e6], abs=0.01
    )


@pytest.mark.slow
def test_peak_to_peak_is_twice_and_the_axis_says_so(silent, pages):
    page = Page(silent, pages("one"))
    half = page.run("return over.parts[0].bodeX.data.y[10]")
    page.set("unit", "1", "change")
    assert page.run("return over.parts[0].bodeX.data.y[10]") == pytest.approx(2 * half)
    assert page.run("return over.bode.plot.left[0].axis_label") == "1x amplitude [µm peak-to-peak]"
    assert half == pytest.approx(np.abs(80 * np.exp(-0.6j) + 20), rel=1e-3)


@pytest.mark.slow
def test_another_place_is_drawn_with_its_clearance(silent, pages):
    page = Page(silent, pages("one"))
    assert page.run("return over.parts[0].ring.data.x.length") == 0
    page.set("place", "bearing[1]", "change")
    ring = page.run("const { x, y } = over.parts[0].ring.data; return Math.hypot(x[7], y[7])")
    assert ring == pytest.approx(60.0)
    assert "bearing 1 at" in page.text("reading")


@pytest.mark.slow
def test_two_runs_lie_over_each_other_at_one_speed(silent, pages):
    page = Page(silent, pages("two"))
    page.click_at("over.bode", 35.0, 50.0)
    output = page.text("reading")
    assert "one, disc 2 at 3" in output
    assert "two, disc 2 at 3" in output
    names = page.run("return document.querySelector('#bode .legend').textContent")
    assert "one: 1x of x" in names
    assert "two: 1x of x" in names
    page.set("shown", "1", "change")
    assert page.run("return over.shownRun") == 1


@pytest.mark.slow
def test_pictures_over_speed_move_together(silent, pages):
    page = Page(silent, pages("one"))
    page.run("over.bode.plot.x_range.setv({ start: 30, end: 40 })")
    for chart in ("phase", "whirl", "force", "angle", "energy"):
        result = page.run(f"const r = over.{chart}.plot.x_range; return [r.start, r.end]")
        assert result == [30, 40], chart


@pytest.mark.slow
def test_a_run_at_one_speed_goes_over_time(silent, pages):
    page = Page(silent, pages("steady"))
    assert page.run("return over.phase.plot.below[0].axis_label") == "Time [s]"
    page.click_at("over.bode", 4.0, 50.0)
    assert "t = 4" in page.text("reading") or "t = 3.9" in page.text("reading")


@pytest.mark.slow
def test_a_run_cut_short_shows_what_there_is(silent, pages):
    page = Page(silent, pages("cut"))
    assert not page.find("pictures").is_displayed()
    assert page.run("return time.whole[1]") == pytest.approx(0.029)
    assert not page.find("near").is_displayed()


@pytest.mark.slow
def test_a_page_prints(silent, pages):
    Page(silent, pages("one"))
    assert silent.printed().startswith("JVBERi0")  # %PDF-, in base64


def test_the_wheel_zooms_about_the_pointer_and_a_double_click_shows_all_again(page):
    """And dragging over a picture shows the stretch that was selected."""
    ends = "const r = over.bode.plot.x_range; return [r.start, r.end]"
    whole = page.run(ends)
    page.click_at("over.bode", 40.0, 50.0)
    at = page.place("over.bode", 40.0)
    page.wheel(*at, -300)
    page.wait("over.bode.plot.x_range.end - over.bode.plot.x_range.start < 30")
    low, high = page.run(ends)
    share = (40 - low) / (high - low)
    assert share == pytest.approx((40 - whole[0]) / (whole[1] - whole[0]), abs=0.03)
    page.wheel(*at, 3000)
    page.wait(f"over.bode.plot.x_range.end > {high + 1}")
    low, high = page.run(ends)
    assert whole[0] <= low < high <= whole[1]
    page.wheel(*at, -300)
    page.wait("over.bode.plot.x_range.end - over.bode.plot.x_range.start < 30")
    page.double_click_until(f"over.bode.plot.x_range.end === {whole[1]}", *at)
    left, right = (page.place("over.bode", x) for x in (32, 38))
    page.mouse(*left, "down", right, "up")
    page.wait("over.bode.plot.x_range.end < 39")
    assert page.run("return over.bode.plot.x_range.start") == pytest.approx(32, abs=0.5)
    assert page.run("return over.bode.plot.x_range.end") == pytest.approx(38, abs=0.5)


# the last, and the dark ones last of them: Firefox is started anew to be dark
@pytest.mark.parametrize(
    "name",
    ["one", *(pytest.param(n, marks=pytest.mark.slow) for n in OTHERS)],
)
@pytest.mark.parametrize(("width", "dark"), [(1600, False), (400, True)])
def test_every_page_is_silent_and_fits_its_width(silent, pages, name, width, dark):
    look(silent, width, dark)
    page = Page(silent, pages(name), is_anew=dark)
    assert page.run("return document.documentElement.scrollWidth") <= width
    number = "document.querySelector('.table td:last-child').getBoundingClientRect()"
    assert name == "study" or page.run(f"return {number}.right") <= width
    ground = page.run("return CHARTS[0].plot.background_fill_color")
    assert ground == ("#14181d" if dark else "#ffffff")
    assert page.run("return performance.getEntriesByType('resource')") == []
    # what cannot be seen is said in words
    untold = page.run(
        "return [...document.querySelectorAll('[role=img], img')].filter((each) =>"
        "each.offsetParent && !(each.getAttribute('aria-label') ?? each.alt)).length"
    )
    assert untold == 0
    unnamed = page.run(
        "return [...document.querySelectorAll('input, select')].filter((each) =>"
        "!each.labels.length).length"
    )
    assert unnamed == 0


@pytest.mark.slow
def test_pictures_follow_when_the_reader_goes_dark(silent, pages):
    page = Page(silent, pages("one"))
    ground = "return over.bode.plot.background_fill_color"
    assert page.run(ground) == "#ffffff"
    look(silent, dark=True)
    page.wait("over.bode.plot.background_fill_color !== '#ffffff'")
    assert page.run(ground) == "#14181d"
