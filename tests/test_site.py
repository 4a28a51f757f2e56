"""The site of README, docs and examples: whole, and without a broken link."""

import re
import runpy
from pathlib import Path

import pytest

SITE = runpy.run_path(str(Path(__file__).parents[1] / "docs" / "site" / "build.py"))
ROOT = Path(__file__).parents[1]


@pytest.fixture
def tree(tmp_path):
    SITE["assemble"](tmp_path / "tree")
    return tmp_path / "tree"


def test_the_site_is_made_without_a_warning_and_loads_nothing_from_a_network(tree, tmp_path, capfd):
    assert SITE["render"](tree, tmp_path / "site") == 0, capfd.readouterr().err
    pages = list((tmp_path / "site").rglob("*.html"))
    assert len(pages) > 12
    for page in pages:
        loaded = re.findall(r"""<(?:script|link|img)[^>]+(?:src|href)="([^"]+)""", page.read_text())
        assert not [
            address for address in loaded if address.startswith(("http:", "https:", "//"))
        ], page


def test_a_link_to_nothing_is_an_error(tree, tmp_path, capfd):
    page = tree / "docs" / "hosts.md"
    page.write_text(page.read_text() + "\n[nowhere](no_such_page.md)\n")
    assert SITE["render"](tree, tmp_path / "site") != 0
    assert "no_such_page" in capfd.readouterr().err


def test_every_page_of_the_project_is_in_the_site():
    globs = ("docs/*.md", "docs/notebooks/*.ipynb", "examples/*/README.md")
    written = {path for glob in globs for path in ROOT.glob(glob)}
    assert written == set(SITE["pages"]())
