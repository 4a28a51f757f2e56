"""The README says what the code says."""

import re
import runpy
from pathlib import Path

import pytest
from rotor_fmu.model.machine.toml import parse_rotor

ROOT = Path(__file__).parents[2]


def test_the_pages_made_from_the_code_say_what_it_says_now():
    made = runpy.run_path(str(ROOT / "docs" / "site" / "made.py"))["made"]()
    assert len(made) == 6
    # no comparison of long texts, which pytest takes minutes to explain
    outdated = [page.name for page, text in made.items() if page.read_text("utf-8") != text]
    assert not outdated, "make pages"


def test_the_hosts_page_names_test_files_that_exist():
    page = (ROOT / "docs" / "reference" / "hosts.md").read_text(encoding="utf-8")
    named = set(re.findall(r"(?:tests|benchmarks)/[a-z_/]+\.(?:py|c)", page))
    assert len(named) >= 5
    for file in named:
        assert (ROOT / file).is_file(), file


def test_what_a_page_links_to_is_there():
    folders = ("docs", "examples", "papers", "benchmarks")
    pages = [*ROOT.glob("*.md"), *(p for folder in folders for p in (ROOT / folder).rglob("*.md"))]
    assert len(pages) > 50
    for page in pages:
        links = re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8"))
        missing = [x for x in links if "://" not in x and not (page.parent / x).exists()]
        assert not missing, page


@pytest.mark.parametrize(("page", "least"), [("README.md", 2), ("CONTRIBUTING.md", 12)])
def test_the_make_targets_named_exist(page, least):
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = set(re.findall(r"(?:^|`)make ([a-z-]+)", (ROOT / page).read_text("utf-8"), re.M))
    assert len(named) >= least
    for target in named:
        assert re.search(rf"^{target}:", makefile, re.M), target


def test_the_machine_of_the_readme_is_one():
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (machine,) = re.findall(r"```toml\n(.*?)```", text, re.S)
    assert parse_rotor(machine).name == "fan"
