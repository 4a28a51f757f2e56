"""The page as a file: what it holds, what it says, what it refuses. A browser opens it in
test_page.py."""

import base64
import json
import math
import re
import zlib
from html import escape

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig_toml
from scipy.integrate import cumulative_trapezoid
from typer.testing import CliRunner

from rotor_fmu.cli import app
from rotor_fmu.errors import InputError
from rotor_fmu.plotting.thinning import extremes
from rotor_fmu.report.packed import COARSE, FINE, packed
from rotor_fmu.report.report_tables import table
from rotor_fmu.report.run_page import runs_page, write_report
from rotor_fmu.report.study_page import study_page
from rotor_fmu.runs.recording import Recording
from rotor_fmu.saved_results import read_study

from ..recordings import recorded, write_study
from ..signals.test_turning_both_ways import swept


def report(*arguments):
    return CliRunner().invoke(app, ["report", *map(str, arguments)])


def block(text, name):
    """What a page's block of data holds."""
    result = re.search(rf'<script type="application/json" id="{name}">(.*?)</script>', text, re.S)
    return json.loads(result.group(1))


def unpacked(pack):
    """The values of a pack again, as the browser reads them."""
    bits, n = pack["bits"], pack["n"]
    raw = zlib.decompress(base64.b64decode(pack["data"]))
    planes = np.frombuffer(raw, np.uint8).reshape(bits // 8, n).astype(np.uint32)
    shifts = 8 * np.arange(bits // 8, dtype=np.uint32)[:, None]
    counts = (planes << shifts).sum(axis=0, dtype=np.uint32)
    top = np.uint32(2**bits - 1)
    for _ in range(pack["differences"]):
        counts = np.cumsum(counts, dtype=np.uint32) & top
    return np.where(counts == top, np.nan, pack["low"] + pack["step"] * counts)


@pytest.mark.parametrize("bits", [COARSE, FINE])
@pytest.mark.parametrize("kind", ["noise", "smooth", "constant", "empty", "unknown"])
def test_packed_numbers_come_back_within_half_a_step(bits, kind):
    values = {
        "noise": np.random.default_rng(0).normal(size=5000),
        "smooth": 1e-4 * np.sin(np.linspace(0, 60, 5000)),
        "constant": np.full(10, 3.25),
        "empty": np.zeros(0),
        "unknown": np.array([1.0, np.nan, 3.0, np.inf]),
    }[kind]
    pack = packed(values, bits)
    result = unpacked(pack)
    is_known = np.isfinite(values)
    assert np.array_equal(np.isfinite(result), is_known)
    assert np.all(np.abs(result - values)[is_known] <= 0.501 * pack["step"] + 1e-15)
    if is_known.sum() > 1:
        span = np.ptp(values[is_known])
        assert pack["step"] == pytest.approx(span / (2**bits - 2), abs=1e-30)


def test_thinned_signals_keep_their_extremes():
    values = np.random.default_rng(1).normal(size=10_007)
    retained = extremes(values, 100)
    assert np.all(np.diff(retained) > 0)
    assert len(retained) <= 202
    assert values[retained].max() == values.max()
    for part in np.array_split(np.arange(len(values)), 90):
        inside = retained[(retained >= part[0] - 101) & (retained <= part[-1] + 101)]
        assert values[inside].max() >= values[part].max()


def test_a_page_asks_for_nothing_from_outside(tmp_path):
    write_report(recorded(toml=rig_toml()), {"steps": 12}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert not re.findall(r"<(?:script|img|link|iframe)[^>]+(?:src|href)=\"(?!data:)", text)
    assert "@import" not in text
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


@pytest.mark.usefixtures("drawn")
def test_a_page_is_the_same_each_time(tmp_path):
    for name in ("a", "b"):
        (tmp_path / name / "run").mkdir(parents=True)
        write_report(recorded(toml=rig_toml()), {}, tmp_path / name / "run" / "report.html")
    pages = [(tmp_path / name / "run" / "report.html").read_bytes() for name in ("a", "b")]
    assert b"base64,PD94bWwg" in pages[0]  # its picture begins as XML
    assert pages[0] == pages[1]


def test_words_in_a_table_are_flush_left_and_numbers_flush_right():
    rows = [[1, "forward", "12 to 30"], [2, "-", "none"]]
    text = table("modes", ["mode", "whirl", "speeds"], rows)
    left = re.findall(r"<t[hd][^>]*text-align: left[^>]*>(.*?)</t[hd]>", text)
    assert left == ["whirl", "forward", "-"]


def test_the_tables_say_what_the_closed_form_has(tmp_path):
    loads = {"disc[1].fx": [-2.0, 3.0], "disc[1].fy": [-20.0, -20.0]}
    write_report(recorded(loads=loads), {"steps": 4321}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    rows = [re.findall(r"<td.*?>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", text)]
    cells = {row[0]: row[1:] for row in rows if row}
    assert cells["steps"] == ["4321"]
    assert cells["disc[1].fx, as given"] == ["-2 to 3"]
    assert cells["disc[1].fy, as given"] == ["-20"]
    # forward 80, backward 20: the major semi-axis is 100 um, the largest x is that
    assert float(cells["disc 2"][0]) == pytest.approx(100.0, rel=1e-3)
    assert float(cells["disc 2"][-1]) == pytest.approx(100.0, rel=5e-3)
    assert float(cells["friction"][1]) == pytest.approx(80.0, rel=1e-3)
    assert float(cells["bearing 1"][0]) == pytest.approx(5.0)
    assert float(cells["bearing 1"][2]) == pytest.approx(50.0, abs=1.0)


@pytest.mark.parametrize(
    ("share", "is_fast"), [pytest.param(0.05, False, marks=pytest.mark.slow), (1.0, True)]
)
def test_an_amplification_is_marked_where_the_run_passed_too_fast(tmp_path, share, is_fast):
    """A mode of 50 Hz and an amplification of 15; slow is a fifth of the half width's square."""
    q, frequency = 15.0, 100 * np.pi
    speed, amplitude, t = swept(q, share * (0.5 / q) ** 2)
    phi = cumulative_trapezoid(speed, t, initial=0.0)
    z = 1e-5 * amplitude * np.exp(1j * phi)
    columns = {"phi": phi, "w": frequency * speed, "disc[1].x": z.real, "disc[1].y": z.imag}
    units = {"phi": "rad", "w": "rad/s", "disc[1].x": "m", "disc[1].y": "m"}
    run = Recording(t / frequency, columns, units, {"machine": "a mode", "status": "ok"})
    write_report(run, {}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    cell = re.search(r"<td[^>]*>disc 1</td>(?:<td[^>]*>[^<]*</td>){2}<td.*?>([^<]*)</td>", text)[1]
    assert (", passed too fast" in cell) == is_fast
    assert cell.startswith("&gt; ") == is_fast
    assert is_fast or float(cell) == pytest.approx(q, rel=0.05)


@pytest.mark.parametrize("nasty", ['</script><img src=x onerror="alert(1)">', "<!--<script>"])
def test_a_page_cannot_be_broken_by_a_name(tmp_path, nasty):
    given = recorded(machine=nasty, messages=[nasty], status=f"failed: {nasty}")
    text = runs_page([given.named(nasty)], [{}])
    assert nasty not in text
    assert text.count(escape(nasty)) >= 5  # title, heading, machine, messages
    assert block(text, "data")["runs"][0]["name"] == nasty
    # after "<!--<script" nothing but another "</script>" would end a script
    for name in ("data", "signals"):
        assert "<" not in re.search(rf'id="{name}">(.*?)</script>', text, re.S).group(1)


def test_a_studys_page_cannot_be_broken_by_a_name(tmp_path):
    write_study(tmp_path / "study")
    about, rows = read_study(tmp_path / "study")
    text = study_page(about | {"name": "<!--<script>"}, rows, {"id000": "<!--<script>"})
    assert "<!--<script>" not in text
    assert block(text, "data")["pages"] == {"id000": "<!--<script>"}


def test_numbers_that_are_not_finite_leave_a_page_that_can_be_read(tmp_path):
    given = recorded(status="failed: diverged")
    for name in ("energy.friction_loss", "disc[1].x", "bearing[1].fn", "w"):
        given.columns[name][-5:] = np.nan
    text = runs_page([given.named("diverged")], [{"wall_s": math.nan}])
    shown = block(text, "data")["runs"][0]
    assert shown["why"] is None
    assert [sink["total"] for sink in shown["power"]["sinks"]] == [
        None,
        pytest.approx(3.0, rel=1e-2),
    ]
    assert "NaN" not in re.search(r'id="data">(.*?)</script>', text, re.S).group(1)


def test_a_failed_run_says_how_far_it_came_and_why(tmp_path):
    status = "failed: the machine whirled itself apart"
    write_report(recorded(stop=2.0, status=status), {}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "stopped before its end. It came to t = 1.999 s at 41.38 Hz: the machine" in text


@pytest.mark.parametrize("stop", [0.0, 1e-3, 2e-3, 0.03])
def test_a_run_that_came_to_no_turns_has_a_page_that_says_so(stop, tmp_path):
    write_report(recorded(stop=stop, status="failed: no"), {}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "has no pictures over speed: the signal holds" in text
    assert block(text, "signals")[0]["signals"][0]["v"]["n"] == len(recorded(stop=stop).t)


def test_a_recording_without_places_still_shows_its_signals(tmp_path):
    given = recorded()
    for name in [name for name in given.columns if name.endswith((".x", ".y"))]:
        given.columns.pop(name)
    write_report(given, {}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "has no pictures over speed: its recording has no place with x and y" in text
    names = [signal["name"] for signal in block(text, "signals")[0]["signals"]]
    assert names == ["bearing[1].fn", "w"]
    assert "responses after the start-up" not in text


def test_two_runs_of_one_name_are_told_apart(tmp_path):
    for name in ("soft", "stiff"):
        (tmp_path / name / "run").mkdir(parents=True)
        recorded().save(tmp_path / name / "run" / "recording.npz")
    out = tmp_path / "report.html"
    result = report(tmp_path / "soft" / "run", tmp_path / "stiff" / "run", "--out", out)
    assert result.exit_code == 0, result.output
    names = [run["name"] for run in block(out.read_text(encoding="utf-8"), "data")["runs"]]
    assert names == ["soft/run", "stiff/run"]


def test_a_studys_rows_are_told_once_each(tmp_path):
    columns = write_study(tmp_path / "study")
    out = tmp_path / "report.html"
    result = report(tmp_path / "study", "--out", out)
    assert result.exit_code == 0, result.output
    text = out.read_text(encoding="utf-8")
    data = block(text, "data")
    assert data["pages"] == {}
    assert data["ids"] == columns["id"]
    assert unpacked(data["values"]["mu"]) == pytest.approx(columns["mu"], abs=1e-6)
    assert "The study goes on: 60 of 80 runs" in text
    failed = columns["status"].count("failed: whirled apart")
    assert f"{failed} runs: failed: whirled apart" in text


@pytest.mark.parametrize("unit", ["1", "rad/s"])
def test_lists_without_a_coordinate_are_counted_from_one(tmp_path, unit):
    """The rows of a Poincare section, the points of a response, whose number varies, or held speeds
    that differ from run to run."""
    columns = write_study(tmp_path / "study")
    about, rows = read_study(tmp_path / "study")
    for column in about["columns"]:
        column |= {"coordinate": [], "coordinate_unit": unit}
    (curve,) = block(study_page(about, rows), "data")["curves"]
    assert (curve["coordinate"], curve["coordinate_unit"]) == ([1.0, 2.0, 3.0], "-")
    values = unpacked(curve["values"]).reshape(-1, 3)
    known = [1e6 * np.array(kept or [np.nan] * 3) for kept in columns["amplitude"]]
    assert values == pytest.approx(np.array(known), rel=1e-3, nan_ok=True)


def test_a_map_of_morris_tells_no_quantiles(tmp_path):
    for kind in ("random", "morris"):
        write_study(tmp_path / kind, kind=kind)
        result = report(tmp_path / kind, "--out", tmp_path / f"{kind}.html")
        assert result.exit_code == 0, result.output
        text = (tmp_path / f"{kind}.html").read_text(encoding="utf-8")
        cells = re.findall(
            r"<td.*?>(.*?)</td>", re.search(r"<tr><td[^>]*>peak</td>.*?</tr>", text).group()
        )
        assert all(cell != "-" for cell in cells[2:7:4])  # least and largest
        assert (cells[3:6] == ["-"] * 3) == (kind == "morris")


def test_a_run_made_again_with_its_signals_has_a_page_that_the_map_links(tmp_path):
    write_study(tmp_path / "a study")
    folder = tmp_path / "a study" / "runs" / "id007"
    folder.mkdir(parents=True)
    recorded().save(folder / "recording.npz")
    result = report(tmp_path / "a study", "--out", tmp_path / "pages" / "report.html")
    assert result.exit_code == 0, result.output
    text = (tmp_path / "pages" / "report.html").read_text(encoding="utf-8")
    assert block(text, "data")["pages"] == {"id007": "../a%20study/runs/id007/report.html"}
    assert (folder / "report.html").read_text(encoding="utf-8").startswith("<!doctype html>")


@pytest.mark.parametrize(
    ("prepare", "arguments", "sentence"),
    [
        ("", ("nowhere",), "nowhere: is not there"),
        ("empty", ("empty",), "empty: holds no recording.npz"),
        ("study", ("study", "study"), "is a study, which has a page of its own"),
        ("bare", ("bare",), "bare: holds no rows of a study"),
        ("torn", ("torn",), "a.parquet: is damaged"),
        ("empty", ("empty", "empty", "empty"), "3 runs: a page shows one or two"),
        ("run", ("run", "--out", "run"), "is a folder; give the page's name"),
        ("other", ("other",), "its recording has no w"),
    ],
)
def test_bad_input_is_one_line(prepare, arguments, sentence, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / (prepare or "empty")
    if prepare == "study":
        write_study(folder)
    else:
        folder.mkdir()
    if prepare in ("bare", "torn"):
        (folder / "study.json").write_text("{}")
    if prepare == "torn":
        (folder / "rows").mkdir()
        (folder / "rows" / "a.parquet").write_bytes(b"PAR1")
    given = recorded()
    if prepare == "other":
        given.columns.pop("w")
    if prepare in ("run", "other"):
        given.save(folder / "recording.npz")
    result = report(*arguments)
    assert isinstance(result.exception, InputError), result.output
    assert sentence in str(result.exception)


@pytest.mark.slow
def test_a_page_of_a_million_samples_stays_below_eight_megabytes(tmp_path):
    write_report(recorded(stop=10.0, step=1e-5), {}, tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    signals = block(text, "signals")[0]["signals"]
    assert [signal["every"] for signal in signals[:1]] == [1]
    assert signals[0]["v"]["n"] == 1_000_000
    assert len(text) < 8e6
