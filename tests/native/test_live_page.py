"""The page on which a machine runs, in a browser: the FMU's numbers, and nothing leaves it."""

import base64
import csv
import math
import re
import runpy
import select
import socket
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.files import write_text
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.live.live_page import solver_page, solver_table
from rotor_fmu.runs.peaks import start_up

from ..documents.browser import NASTY, RIGHT, look
from .live import LivePage
from .wasm import Native, rows_of

START = "start-up, the first 0.1 s"  # a fifth of half a second


@pytest.mark.parametrize(("width", "dark"), [(400, True), (1500, False)])
def test_the_page_is_small_and_silent_and_fits_its_width(silent, rig, width, dark):
    look(silent, width, dark)
    page = LivePage(silent, rig).ended()
    assert rig.stat().st_size < 1_500_000
    assert page.run("return document.documentElement.scrollWidth") <= width
    assert page.run("return performance.getEntriesByType('resource')") == []
    assert page.notices() == []
    unnamed = page.run(
        "return [...document.querySelectorAll('input, select, progress')].filter((each) =>"
        "!each.labels.length && !each.getAttribute('aria-label')).map((each) => each.id)"
    )
    assert unnamed == []
    named = page.run(
        "return [...document.querySelectorAll('[role=img], img')].map((each) =>"
        "each.getAttribute('aria-label') ?? each.alt)"
    )
    assert len(named) == 5
    assert all(named)
    ground = page.run(
        "return getComputedStyle(document.querySelector('svg.chart')).backgroundColor"
    )
    assert ground == ("rgb(20, 24, 29)" if dark else "rgb(255, 255, 255)")


def test_the_longest_name_of_a_part_fits_a_telephone(silent, tmp_path):
    name = 4 * "a_word_of_sixteen"[:16]
    file = tmp_path / "long.html"
    toml = re.sub(r"(\[\[disc\]\]\n)", rf'\1name = "{name}"\n', rig_toml(), count=1)
    write_text(solver_page(machine_of(toml)), file)
    look(silent, 400)
    page = LivePage(silent, file).ended()
    page.run(
        "for (const each of document.querySelectorAll('.bar select')) { each.selectedIndex ="
        f" [...each.options].findIndex((option) => /{name[:16]}|a word of/.test(option.text));"
        " each.dispatchEvent(new Event('change')); }"
    )
    assert page.run("return document.documentElement.scrollWidth") <= 400
    cut_off = page.run(
        "return [...document.querySelectorAll('svg.chart text')].filter((each) => {"
        "const [box, room] = [each, each.closest('svg')].map((of) => of.getBoundingClientRect());"
        "return box.top < room.top || box.bottom > room.bottom; }).map((each) => each.textContent)"
    )
    assert cut_off == []


def test_its_numbers_are_the_native_librarys_bit_for_bit(silent, rig):
    page = LivePage(silent, rig).ended()
    lines = list(csv.reader(page.run("return csv(now)").splitlines()))
    native = rows_of(Native(solver_table(machine_of())), page.run("return now.plan"))
    names = [head.partition(" [")[0] for head in lines[0]]
    assert names == ["time", *page.run("return data.recorded.map((each) => each.name)")]
    assert {"time [s]", "w [rad/s]", "disc[1].x [m]", "bearing[1].fn [N]"} <= set(lines[0])
    assert np.array(lines[1:], float).tobytes() == native.tobytes()
    # what is drawn is what was computed
    at = names.index("disc[1].r_amp")
    highest = page.run("return charts.distance.view.ys[1]")
    assert highest == pytest.approx(1.04 * 1e6 * native[:, at].max(), rel=1e-6)
    settled = native[:, 0] > start_up(native[:, 0], native[:, names.index("w")])
    ends = page.run("return abscissa(now)[rowAt(now, startUp(now))]")
    assert ends == native[~settled, names.index("w")][-1] / math.tau
    largest = native[settled, at].max()
    assert largest < 0.99 * native[:, at].max()
    assert f"of disc 1 from its start after the start-up: {1e6 * largest:.4g} " in page.text(
        "state"
    )


def test_a_slider_moved_by_the_keys_runs_again_beside_the_run_before(silent, rig):
    page = LivePage(silent, rig).ended()
    page.run("byName.get('bearing[1].clearance').range.focus()")
    page.press(RIGHT)
    page.ended(2)
    clearance = page.run("return values['bearing[1].clearance']")
    assert clearance > 5e-5
    linked = page.run(
        "return Object.fromEntries(new URLSearchParams(location.hash.slice(1)).entries())"
    )
    assert float(linked["bearing[1].clearance"]) == clearance
    assert page.run(
        "return [before.given['bearing[1].mu'], now.given['bearing[1].clearance']]"
    ) == [
        0.04,
        clearance,
    ]
    keys = page.run("return document.querySelector('#distance .key').textContent")
    assert keys == "the run beforethis run" + START
    assert "; the run before: " in page.text("state")
    page.find("compare").click()
    assert (
        page.run("return document.querySelector('#distance .key').textContent")
        == "this run" + START
    )
    page.find("reset").click()
    assert page.run("return Object.keys(values)") == []


def test_a_ramp_stands_over_time_beside_a_run_at_constant_speed(silent, rig):
    page = LivePage(silent, rig).ended()
    page.run("change(byName.get('course.to'), 400); change(byName.get('course.hold'), 0.3)")
    page.find("run").click()
    page.ended(2)
    assert page.run("return before.plan.duration") == pytest.approx(0.5)
    assert page.run("return charts.distance.view.xs") == pytest.approx([0, 0.5])
    page.find("reset").click()
    page.run("change(byName.get('course.to'), 395)")
    page.find("run").click()
    page.ended(3)
    speeds = page.run("return charts.distance.view.xs")
    assert speeds == pytest.approx([395 / math.tau, 400 / math.tau])


def test_a_run_can_be_stopped_and_what_there_is_stays(silent, rig):
    page = LivePage(silent, rig, "")
    page.wait("now.n > 400")
    page.find("stop").click()
    page.ended()
    rows, planned = page.run("return [now.n, now.plan.rows]")
    assert 400 < rows < planned == 40001
    assert page.notices() == ["The run ended early: stopped"]
    assert len(page.run("return csv(now)").splitlines()) == 1 + rows


def test_pictures_of_a_run_that_ended_early_show_no_more_than_it(silent, rig):
    page = LivePage(silent, rig, "")
    page.wait("now.n > 400")
    page.find("stop").click()
    page.ended()
    end, speeds = page.run(
        "return [now.t[now.n - 1], [now.n - 1, 0].map((row) => speedAt(now, row))]"
    )
    assert page.run("return charts.time.view.xs") == pytest.approx([0.0, end])
    assert page.run("return charts.distance.view.xs") == pytest.approx(speeds)
    page.set("cursor", "500")
    assert page.run("return picked") == pytest.approx(0.5 * end)


def test_what_cannot_be_is_said_in_the_fmus_words(silent, rig):
    page = LivePage(
        silent, rig, "#bearing[1].clearance=-1e-5&bearing[7].mu=0.1&course.rate=a"
    ).ended()
    assert page.notices() == [
        "The address has bearing[7].mu = 0.1, which this machine does not know.",
        "The address has course.rate = a, which is no number.",
        "The run ended early: bearing[1].clearance = -1e-05 m: must be > 0 and finite",
    ]
    page.set(page.run("return byName.get('course.rate').input.id"), "0", "change")
    page.find("run").click()
    assert page.notices() == ["rate of the speed: must be > 0"]
    assert page.text("state") == "Not run."


@pytest.mark.parametrize(
    ("name", "value"), [("bearing[1].clearance", "-1"), ("course.rate", "0")], ids=["fmu", "page"]
)
def test_no_picture_of_another_run_stands_beside_settings_that_cannot_run(silent, rig, name, value):
    page = LivePage(silent, rig).ended()
    lines = "return document.querySelectorAll('svg.chart path.now').length"
    assert page.run(lines) > 0
    page.run(f"byName.get({name!r}).input.id = 'typed'")
    page.set("typed", value, "change")
    page.find("run").click()
    page.wait("document.querySelectorAll('.notice').length === 1")
    page.wait("field('stop').disabled")
    assert page.run(lines) == 0
    assert page.text("reading") == ""
    assert page.run("return field('csv').disabled")
    page.find("reset").click()
    page.run("change(byName.get('course.to'), 395)")
    page.find("run").click()
    page.wait("now?.seconds !== undefined && now.n > 0")
    assert page.run(lines) > 0
    assert "; the run before: " in page.text("state")


def test_no_request_leaves_the_page(driver, rig):
    page = LivePage(driver, rig).ended()
    with socket.create_server(("127.0.0.1", 0)) as server:
        page.run(
            "window.blocked = []; window.refused = ''; const away = arguments[0];"
            "document.addEventListener('securitypolicyviolation', (event) =>"
            "  blocked.push(event.effectiveDirective));"
            "fetch(away).catch((error) => { refused = String(error); });"
            "const add = (kind, given) =>"
            "  document.body.append(Object.assign(document.createElement(kind), given));"
            "add('img', { src: away });"
            "add('iframe', { src: away });"
            "add('script', { textContent: 'x = 1' });",
            f"http://127.0.0.1:{server.getsockname()[1]}/",
        )
        page.wait("refused && blocked.length >= 4")
        blocked = set(page.run("return blocked"))
        assert blocked == {"connect-src", "img-src", "script-src-elem", "frame-src"}
        # Chromium opens a connection for a frame before it looks whether it may; nothing is sent
        while select.select([server], [], [], 0.5)[0]:
            caller, _ = server.accept()
            with caller:
                assert select.select([caller], [], [], 0.5)[0] == [] or caller.recv(1) == b""
    assert driver.said()  # which names them


def test_a_machines_name_is_shown_and_runs_nothing(silent, tmp_path):
    nasty = f'</script></title>{NASTY} " onload=x'
    toml = re.sub(r'(?m)^name = ".*"$', lambda _: f"name = '{nasty}'", rig_toml())
    assert nasty in toml
    write_text(solver_page(machine_of(toml)), tmp_path / "nasty.html")
    page = LivePage(silent, tmp_path / "nasty.html").ended()
    assert page.run("return document.querySelector('h1').textContent") == nasty
    assert page.run("return document.title") == nasty
    assert page.run("return data.name") == nasty
    assert page.run("return document.scripts.length") == 5


def test_the_picture_of_a_run_at_one_speed_is_over_time_and_says_so(silent, rig):
    page = LivePage(silent, rig, "#course.to=400&course.hold=0.2").ended()
    caption = "return document.querySelector('#distance figcaption').textContent"
    label = "return document.querySelector('#distance svg').getAttribute('aria-label')"
    assert page.run(caption) == "Distance from its start, largest in a turn, over time"
    assert page.run(label).startswith(
        "Distance from its start, largest in a turn, over time. Distance, disc 1 [µm] over Time [s]"
    )
    page = LivePage(silent, rig).ended()
    assert page.run(caption) == "Distance from its start, largest in a turn, over speed"
    page.run(
        "field('place').value = data.places.findIndex((place) => place.clearance);"
        "field('place').dispatchEvent(new Event('change'))"
    )
    assert page.run(caption) == "Distance from the centre, over speed"
    keys = "return [...document.querySelectorAll('#orbit .key span')].map((one) => one.textContent)"
    assert page.run(keys) == ["this run", "clearance of this run"]


def test_a_machine_without_a_part_that_is_seen_to_move_has_no_empty_pictures(silent, tmp_path):
    bare = re.sub(r"(?s)\[\[(disc|bearing)\]\].*", "", rig_toml())
    supports = "".join(
        f"[[support]]\nnode = {node}\nstiffness = 1e6\ndamping = 100.0\n" for node in (2, 8)
    )
    write_text(solver_page(machine_of(bare + supports)), tmp_path / "bare.html")
    page = LivePage(silent, tmp_path / "bare.html", "#course.to=395&course.rate=10").ended()
    assert page.text("state").endswith(" give the machine a disc, a body or a sensor.")
    shown = "return [...document.querySelectorAll('figure[id]')].filter((f) => f.checkVisibility())"
    assert page.run(f"{shown}.map((figure) => figure.id)") == ["time", "near"]
    assert not page.find("place").is_displayed()


def test_the_page_prints_its_pictures(silent, rig):
    LivePage(silent, rig).ended()
    assert len(base64.b64decode(silent.printed())) > 20_000


def test_the_sites_first_page_leads_to_pages_on_which_machines_run(silent, tmp_path, capfd):
    site = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "site" / "build.py"))
    tree = tmp_path / "tree"
    tree.mkdir()
    (tree / "conf.py").write_text('project = "rotor-fmu"\nextensions = ["myst_parser"]\n')
    (tree / "index.md").write_text("# rotor-fmu\n\nWords.\n\n## Two commands\n")
    site["add_machines"](tree)
    assert site["render"](tree, tmp_path / "site") == 0, capfd.readouterr().err
    first = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    linked = re.findall(r'href="(try/\w+\.html)"', first)
    assert linked == ["try/rig.html", "try/drop.html"]
    rig, drop = (tmp_path / "site" / name for name in linked)
    LivePage(silent, rig, "").wait("document.getElementById('progress').value > 0")
    # not over 40 s: on some processors Firefox now and then takes fifty times as long
    LivePage(silent, rig).ended()
    LivePage(silent, drop, "").ended()


def test_numbers_beside_an_axis_leave_room_for_its_name(silent, rig):
    page = LivePage(silent, rig).ended()
    drawn = (
        "charts.time.draw({ series: [{ x: [0, 1], y: [0, arguments[0]], kind: 'now' }],"
        " xLabel: 'x', yLabel: 'y' });"
        "const left = (text) => text.getBoundingClientRect().left;"
        "const texts = [...charts.time.root.querySelectorAll('[text-anchor=end]')];"
        "return [texts.map((text) => text.textContent), Math.min(...texts.map(left)) -"
        " charts.time.root.querySelector('[transform]').getBoundingClientRect().right]"
    )
    for size, largest in ((3e6, "3e+6"), (-3e6, "0"), (3e-5, "3e-5"), (3e3, "3000")):
        texts, room = page.run(drawn, size)
        assert "0" in texts
        assert texts[-1] == largest
        assert room > 0


def test_an_axis_has_two_numbers_at_least(silent, rig):
    """One alone gives no scale: over 891 a telephone's picture had 0 between -500 and 500."""
    page = LivePage(silent, rig).ended()
    for size in np.geomspace(1, 10, 25):
        drawn = page.run("return ticks(-arguments[0], arguments[0], 4.4)", size)
        assert 2 <= len(drawn) <= 9
    assert page.run("return ticks(0, 10, 5)") == [0, 2, 4, 6, 8, 10]
