"""The page of a study in a browser: a point of its map opens its run."""

import math

import numpy as np
import pyarrow as pa
import pytest

from rotor_fmu.files import write_text
from rotor_fmu.report.study_page import _notices, study_page
from rotor_fmu.saved_results import read_study

from ..recordings import write_study
from .browser import Page


@pytest.mark.slow
def test_a_point_of_the_map_opens_its_run(silent, tmp_path):
    columns = write_study(tmp_path / "study")
    write_text(study_page(*read_study(tmp_path / "study")), tmp_path / "study.html")
    page = Page(silent, tmp_path / "study.html")
    row = 17
    page.click_at("map.chart", columns["mu"][row], 1e6 * columns["clearance"][row])
    assert page.text("reading").startswith(f"Run {row}, id017: mu ")
    assert f", clearance {1e6 * columns['clearance'][row]:.2f}"[:-1] in page.text("reading")
    assert " µm, peak " in page.text("reading")
    cells = page.run(
        "return [...document.querySelectorAll('#picked td')].map((c) => c.textContent)"
    )
    output = dict(zip(cells[::2], cells[1::2], strict=True))
    assert output["id"] == "id017"
    assert float(output["mu [-]"]) == pytest.approx(columns["mu"][row], rel=1e-4)
    assert float(output["clearance [µm]"]) == pytest.approx(
        1e6 * columns["clearance"][row], rel=1e-4
    )
    axes = "return [map.chart.plot, map.curve.plot].flatMap((p) => [p.below[0], p.left[0]])"
    labels = page.run(f"{axes}.map((a) => a.axis_label.text)")
    assert labels == ["mu [-]", "clearance [µm]", "speed [Hz]", "amplitude [µm]"]
    assert page.run("return map.bar.title.text") == "peak [µm]"
    assert float(output["peak [µm]"]) == pytest.approx(500 + 800 * columns["mu"][row], rel=1e-4)
    assert output["with its signals"] == "rotor-fmu study ... --select id017"
    hertz = page.run("return map.line.data.x")
    start, end = page.run("return [map.curve.plot.x_range.start, map.curve.plot.x_range.end]")
    assert start < min(hertz) < max(hertz) < end  # the whole curve is seen
    assert hertz == pytest.approx([w / (2 * math.pi) for w in (20.0, 30.0, 40.0)])
    page.find("after").click()
    assert page.text("reading").startswith("Run 18, id018")
    page.set("run", "3")
    assert page.text("reading").startswith("Run 3, id003")
    failed = columns["status"].index("failed: whirled apart")
    page.set("run", failed)
    assert page.text("reading").endswith("failed: whirled apart")


@pytest.mark.slow
def test_doubtful_runs_are_marked_and_a_map_of_one_value_has_its_size(silent, tmp_path):
    columns = write_study(tmp_path / "study")
    about, rows, *more = read_study(tmp_path / "study")
    status = ["doubtful: too-coarse" if i < 5 else text for i, text in enumerate(columns["status"])]
    rows = rows.set_column(2, "status", pa.array(status))
    same = pa.array([None if text.startswith("failed") else 1e-9 for text in status])
    rows = rows.set_column(rows.column_names.index("peak"), "peak", same)
    about = {**about, "can_be_selected": False}  # linear answers have no signals
    write_text(study_page(about, rows, *more), tmp_path / "study.html")
    page = Page(silent, tmp_path / "study.html")
    assert "--select" not in page.text("picked")
    marked = page.run("return [...map.doubtful.data.x]")
    good = [mu for mu, text in zip(columns["mu"], status, strict=True) if text[:6] == "doubtf"]
    assert marked == pytest.approx(good, abs=1e-6)
    assert f"{len(good)} of them doubtful (squares)" in page.run(
        "return map.chart.legend.textContent"
    )
    assert page.run("return [map.mapper.low, map.mapper.high]") == pytest.approx([1e-3, 2e-3])
    page.set("run", status.index("failed: whirled apart"))
    assert ", peak -; failed" in page.text("reading")


@pytest.mark.slow
def test_the_legend_of_the_map_tells_failed_runs_whatever_is_shown(silent, tmp_path):
    columns = write_study(tmp_path / "study")
    count = sum(text.startswith("failed") for text in columns["status"])
    good = len(columns["status"]) - count
    write_text(study_page(*read_study(tmp_path / "study")), tmp_path / "study.html")
    page = Page(silent, tmp_path / "study.html")
    # colours and places that failed runs have, and that they have not
    for across, up, shade in (
        ("mu", "clearance", "mu"),
        ("peak", "clearance", "mu"),
        ("peak", "peak", "peak"),
    ):
        for name, value in (("across", across), ("up", up), ("shade", shade)):
            page.set(name, value, "change")
        legend = page.run("return map.chart.legend.textContent")
        assert f"{good} runs" in legend
        assert "doubtful" not in legend
        assert f"{count} failed, or without the value (crosses)" in legend
        crosses = page.run("return [...map.failed.data.x, ...map.failed.data.y]")
        assert len(crosses) == 2 * count
        assert None not in crosses  # as a browser hands over what is no number


@pytest.mark.parametrize(("kinds", "expected"), [(6, "1 more reason;"), (7, "2 more reasons;")])
def test_reasons_that_are_left_out_are_counted(kinds, expected):
    status = [f"failed: {at}" for at in range(kinds)]
    assert f"... and {expected} the map shows each." in _notices({}, status, kinds, [])


@pytest.mark.parametrize("is_least", [False, True])
def test_runs_beyond_a_limit_are_counted(tmp_path, is_least):
    """Of those that have the value; a limit that none passes is not named."""
    write_study(tmp_path / "study")
    about, rows, *_ = read_study(tmp_path / "study")
    peaks = np.asarray(rows["peak"].to_numpy(), float)
    limit = float(np.nanmedian(peaks))
    count = int((peaks < limit if is_least else peaks > limit).sum())
    sign = "&lt;" if is_least else "&gt;"
    said = f"{count} runs beyond a limit: peak {sign} {1e6 * limit:.5g} µm<"
    for value, is_said in ((limit, True), (0.0 if is_least else 1.0, False)):
        limits = {"peak": {"value": value, "is_least": is_least}}
        page = study_page({**about, "limits": limits}, rows)
        assert (said in page, "beyond a limit" in page) == (is_said, is_said)


def test_quantiles_of_some_of_the_runs_are_named_as_such(tmp_path):
    """Of a design for indices, most of whose runs repeat draws of others; the rest is of all."""
    write_study(tmp_path / "study")
    about, rows, *_ = read_study(tmp_path / "study")
    some = study_page(about, rows, {}, np.arange(12))
    assert "value; quantiles of the 12 that are draws of their own" in some
    for drawn in (None, np.arange(0)):
        assert "draws of their own" not in study_page(about, rows, {}, drawn)
