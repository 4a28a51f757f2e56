"""The site of README, docs and examples: whole, and without a broken link."""

import re
import runpy
import shutil
from pathlib import Path

import pytest

SITE = runpy.run_path(str(Path(__file__).parents[2] / "docs" / "site" / "build.py"))
ROOT = Path(__file__).parents[2]
NAMED = re.compile(
    r"(?<![\w/.-])(?:model|rotor_fmu|tests|tools|papers|benchmarks|examples|docs)/[\w/.]*\w"
)
MADE = {"model/library"}  # by commands

# of Sphinx' extensions to each other
pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::PendingDeprecationWarning"),
]


@pytest.mark.slow  # nor does `make docs` make it with one
def test_the_site_is_made_without_a_warning_and_loads_nothing_from_a_network(tmp_path, capfd):
    tree = tmp_path / "tree"
    SITE["assemble"](tree)
    assert SITE["render"](tree, tmp_path / "site") == 0, capfd.readouterr().err
    pages = list((tmp_path / "site").rglob("*.html"))
    assert len(pages) > 12
    for page in pages:
        loaded = re.findall(r"""<(?:script|link|img)[^>]+(?:src|href)="([^"]+)""", page.read_text())
        assert not [
            address for address in loaded if address.startswith(("http:", "https:", "//"))
        ], page


def test_a_link_to_nothing_is_an_error(tmp_path, capfd):
    tree = tmp_path / "tree"
    tree.mkdir()
    shutil.copyfile(ROOT / "docs" / "site" / "conf.py", tree / "conf.py")
    page = tree / "index.md"
    page.write_text("# A page\n\n[itself](index.md)\n")
    page.write_text(page.read_text() + "\n[nowhere](no_such_page.md)\n")
    assert SITE["render"](tree, tmp_path / "site") != 0
    said = capfd.readouterr().err
    assert "no_such_page" in said
    assert said.count("WARNING") == 1


def test_every_page_of_the_project_is_in_the_site():
    globs = (
        *("ARCHITECTURE.md", "CHANGELOG.md", "CONTRIBUTING.md", "examples/*/README.md"),
        *("docs/*.md", "docs/*/*.md", "docs/*/*.ipynb"),
    )
    written = {path for glob in globs for path in ROOT.glob(glob)}
    assert written == set(SITE["pages"]())


@pytest.mark.parametrize(
    "page",
    [ROOT / "README.md", *(page for page in sorted(SITE["pages"]()) if page.suffix == ".md")],
    ids=lambda page: str(page.relative_to(ROOT)),
)
def test_the_files_that_a_page_names_are_there(page):
    named = set(NAMED.findall(page.read_text(encoding="utf-8"))) - MADE
    assert not {name for name in named if not (ROOT / name).exists()}


def test_the_glossary_says_each_word_once_in_their_order():
    page = (ROOT / "docs" / "reference" / "glossary.md").read_text(encoding="utf-8")
    words = re.findall(r"^\| ([^|]+?) \|", page, re.MULTILINE)[2:]
    assert len(words) > 40
    assert words == sorted(set(words), key=str.lower)
