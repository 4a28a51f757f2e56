"""Pages in the units that were chosen, of runs, of a study and of a machine that runs."""

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.display import choose, restored
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.live.live_page import page_data
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.report.run_page import runs_page

from ..recordings import recorded, write_study
from ..toml_text import table


def test_tables_of_the_page_are_in_the_units_chosen():
    def page():
        return runs_page([recorded().named("one")], [{}])

    with restored():
        choose("rpm,mil,pp")
        chosen = page()
    mine, si = _cells(chosen, "disc 2"), _cells(page(), "disc 2")
    assert mine[0] == pytest.approx(2 / 25.4 * si[0], rel=1e-4)
    assert mine[1] == pytest.approx(60 * si[1], rel=1e-4)
    assert mine[-3:] == pytest.approx([um / 25.4 for um in si[-3:]], rel=1e-4)
    for head in ("1x, largest [mil pp]", "at [rpm]", "x [mil pp]", "S_max [mil 0-p]"):
        assert f'<th scope="col">{head}</th>' in chosen


def test_what_was_set_in_a_run_is_shown_with_its_unit():
    given = {"speed_rate": -5.235987755982989, "bearing[2].clearance": 1e-4, "bearing[2].mu": 0.1}
    run = recorded()
    about = {**run.about, "toml": rig_toml(), "parameters": given}
    with restored():
        choose("rpm,mil")
        page = runs_page([replace(run, about=about).named("one")], [{}])
    assert _cells(page, re.escape("speed_rate, as set [rpm/s]")) == [-50.0]
    assert _cells(page, re.escape("bearing[2].clearance, as set [mil]")) == [3.937]
    assert _cells(page, re.escape("bearing[2].mu, as set")) == [0.1]


def test_what_a_study_varied_of_a_run_is_shown_with_its_unit(tmp_path):
    path = tmp_path / "study.toml"
    path.write_text(
        table("run", kind="constant", speed=300, settle=0.01, turns=1, per_turn=8)
        + table("vary", **{"run.speed": {"values": ["3000 rpm"]}})
        + table("keep", end={"last": "w"})
    )
    model = read_study(path).model
    recording = model.record({"run.speed": 100 * math.pi, "disc[1].e": 2.54e-5})
    with restored():
        choose("rpm,mil")
        page = runs_page([recording.named("one")], [{}])
    assert _cells(page, re.escape("run.speed, as set [rpm]")) == [3000.0]
    assert _cells(page, re.escape("disc[1].e, as set [mil]")) == [1.0]


def _cells(page, place):
    """Numbers of a row of a table in a page."""
    row = re.search(rf"<tr><td.*?>{place}</td>(.*?)</tr>", page)[1]
    return [float(text) for text in re.findall(r"<td.*?>([^<]*)</td>", row) if text != "-"]


def test_a_page_begins_in_the_units_that_were_chosen():
    runs = [recorded().named("one")]
    with restored():
        choose("rpm,mil")
        page = runs_page(runs, [{}])
    assert '<option value="60" selected>rpm' in page
    assert '"unit":"mil"' in page
    assert '"unit":"\\u00b5m"' not in page
    assert '<option value="2" selected>mil 0-p' in page
    assert "<h1>closed form</h1>" in page
    assert "selected" not in runs_page(runs, [{}]).split("<script")[0]


def test_the_page_of_a_study_is_in_the_units_that_were_chosen(command, tmp_path):
    """Of a machine that asks for none they are Hz and µm; its file may ask for others, and
    `--units` for others again."""
    write_study(tmp_path / "study")
    pages = [_page_of_study(command, tmp_path, *given) for given in ((), ("--units", "us"))]
    about = json.loads((tmp_path / "study" / "study.json").read_text())
    (tmp_path / "study" / "study.json").write_text(json.dumps(about | {"units": "rpm,mil"}))
    pages.append(_page_of_study(command, tmp_path))
    units = [[c["unit"] for c in data["columns"]] for data in pages]
    assert units == [["-", "µm", "µm"], ["-", "mil", "mil"], ["-", "mil", "mil"]]
    curves = [data["curves"][0] for data in pages]
    assert [c["coordinate_unit"] for c in curves] == ["Hz", "rpm", "rpm"]
    assert [c["unit"] for c in curves] == ["µm", "mil", "mil"]
    hz, rpm = (np.array(c["coordinate"]) for c in curves[:2])
    assert rpm == pytest.approx(60 * hz)


def _page_of_study(command, folder, *given):
    command("report", str(folder / "study"), *given)
    text = (folder / "out").read_text(encoding="utf-8")
    return json.loads(re.search(r'id="data">(.*?)</script>', text, re.S).group(1))


def test_the_page_on_which_a_machine_runs_is_in_the_units_that_were_chosen():
    machine = machine_of()
    with restored():
        choose("us, pp")
        us = page_data(machine)
    si = page_data(machine)
    units = {name: each["unit"] for name, each in us["units"].items()}
    assert units == {"speed": "rpm", "displacement": "mil"}
    assert us["units"]["displacement"]["factor"] == pytest.approx(1e6 / 25.4)  # none is doubled
    shown = [c["unit"] for group in (us["course"], *us["groups"]) for c in group["controls"]]
    shown += [c["unit"] for c in us["recorded"]]
    assert {"rpm", "rpm/s", "mil", "lbf", "lbf/in", "lbf.s/in", "lb", "lbf.in"} <= set(shown)
    assert not {"Hz", "µm", "um", "N", "N/m", "N.s/m", "kg", "N.m", "rad/s", "m"} & set(shown)
    assert [c["unit"] for c in si["course"]["controls"]] == ["Hz", "Hz", "Hz/s", "s", ""]
    # what runs and what an address says stays in SI units
    starts = [[c["start"] for c in data["course"]["controls"]] for data in (us, si)]
    assert starts[0] == starts[1]


@pytest.mark.native
def test_the_command_page_takes_units(command, tmp_path):
    command("page", "--units", "us")
    assert '"speed":{"unit":"rpm"' in (tmp_path / "out").read_text(encoding="utf-8")
