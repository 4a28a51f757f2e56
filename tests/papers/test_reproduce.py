"""What paper A ran, run again: the table, the pictures, a call that goes on where one stopped."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from typer.testing import CliRunner

from papers.zigulic2003 import reproduce
from papers.zigulic2003.__main__ import app

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "explanation" / "reproduction.md"


def rows_of(text):
    """The cells of the runs in a table in Markdown, by their titles."""
    rows = [line.strip("| ").split(" | ") for line in text.splitlines() if line.startswith("| ")]
    titles = {case.title for case in reproduce.CASES}
    return {title: cells for title, *cells in rows if title in titles}


def test_a_table_is_made_of_runs_and_made_again_of_those_that_are_there(monkeypatch, tmp_path):
    converged, *others = (
        replace(case, sets=("solver.preset=paper",) if case.name == "converged" else case.sets)
        for case in reproduce.CASES
        if case.name in ("converged", "newmark", "wbz")
    )
    cases = (converged, *(replace(case, repetitions=min(2, case.repetitions)) for case in others))
    monkeypatch.setattr(reproduce, "CASES", cases)
    monkeypatch.setattr(reproduce, "SECONDS", 3.0)
    said = []
    reproduce.reproduce(tmp_path, said.append)
    text = (tmp_path / "table.md").read_text(encoding="utf-8")
    rows = rows_of(text)
    assert list(rows) == [case.title for case in cases]
    assert re.fullmatch(r"\d+\.\d( \(\d+ to \d+\))? at [56]\d\.\d\d", rows[cases[1].title][0])
    assert rows[cases[2].title][:2] == ["-", "-"]
    assert [line.rpartition(": ")[2] for line in said] == ["doubtful", "doubtful", "failed"]
    monkeypatch.setattr(reproduce, "execute", None)  # no run is made any more
    reproduce.reproduce(tmp_path, said.append)
    assert (tmp_path / "table.md").read_text(encoding="utf-8") == text


@pytest.mark.slow
def test_the_page_shows_what_the_command_makes(tmp_path):
    """The converged row to the last digit; runs at 4 ms are chaotic."""
    result = CliRunner().invoke(app, ["--out", str(tmp_path)])
    assert result.exit_code == 0, result.output
    made, shown = rows_of(result.output), rows_of(PAGE.read_text(encoding="utf-8"))
    assert list(made) == list(shown)
    title = reproduce.CASES[0].title
    assert made[title][:6] == shown[title][:6]
    pictures = set(re.findall(r"figures/(\w+\.png)", PAGE.read_text(encoding="utf-8")))
    assert len(pictures) == 13
    assert pictures <= {path.name for path in tmp_path.glob("*.png")}
