"""The comparison of rub laws: ours is Coulomb's at every angle; ROSS' is what its page says."""

from pathlib import Path

import pytest

from benchmarks.rub_laws import closed_form, installed, of_ross, ours, table

PAGE = Path(__file__).parents[2] / "docs" / "explanation" / "rub_laws.md"


def test_friction_brakes_by_mu_n_at_every_angle():
    """But for the smoothing at small sliding speeds, v over sqrt(v2 + v_s2)."""
    for mine, exact in zip(ours(), closed_form(), strict=True):
        assert mine.tangential == pytest.approx(exact.tangential, rel=1e-5)
        assert mine.radial == pytest.approx(0.0, abs=1e-9)


@pytest.mark.skipif(installed() is None, reason="ROSS is not installed")
def test_the_page_shows_what_ross_has_today():
    rows = [
        [cell.strip() for cell in line.split("|")[-3:-1]]
        for line in PAGE.read_text(encoding="utf-8").splitlines()
        if line.startswith("| ") and line[2].isdigit()
    ]
    friction = of_ross(installed()[0])
    seen = [[f"{round(v, 9) + 0.0:.2f}" for v in each[1:]] for each in friction]
    assert seen == rows


def test_the_table_has_a_row_an_angle():
    assert len(table({"closed form": closed_form()}).splitlines()) == 2 + 8
