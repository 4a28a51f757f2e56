"""Every block of README, docs and examples, run as a reader would paste it.

In an environment of its own, a copy of the project with what its README installs, page by page from
the top. A block of TOML that begins with the name of a file is saved under it.
"""

import itertools
import os
import re
import shutil
import subprocess
import sys

import pytest

from tools.checkout import ROOT, lay_out

from ..processes import run_anew

PAGES = sorted([ROOT / "README.md", *ROOT.glob("docs/*/*.md"), *ROOT.glob("examples/*/README.md")])
RUN = {"sh": ["sh", "-e", "-c"], "python": ["python", "-c"]}
# the tests are not run by the tests
NOT_HERE = re.compile(r"^make test.*$", re.MULTILINE)


def blocks(page):
    """(language, text) of a page's fenced blocks that run, in turn."""
    result = re.findall(r"^```(\w*)\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
    return [(language, text) for language, text in result if language in (*RUN, "toml")]


def readable(page):
    """Whether a page has blocks to run."""
    return any(language in RUN for language, _ in blocks(page))


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    """The project as it is checked out, and its environment made by its own rule."""
    folder = tmp_path_factory.mktemp("newcomer") / "rotor-fmu"
    lay_out(folder)
    library = ROOT / "model" / "library"  # which would take a minute to make
    if library.is_dir():
        shutil.copytree(library, folder / "model" / "library")
    made = subprocess.run(
        ["make", f"PYTHON={sys.executable}", ".venv/made"],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.returncode == 0, made.stdout + made.stderr
    for language, text in blocks(ROOT / "README.md"):
        if language == "toml":  # which other pages go on with
            run(language, text, folder, {})
    return folder


def run(language, text, folder, environment):
    """What is wrong with a block that is run: its exit status and what it printed where it fails or
    warns, else nothing. A machine file is saved."""
    if language == "toml":
        if named := re.match(r"# (\w+\.toml)", text):
            (folder / named[1]).write_text(text, encoding="utf-8")
        return ""
    text = NOT_HERE.sub("", text)
    done = subprocess.run(
        [*RUN[language], text],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    is_wrong = done.returncode or re.search(r"warning|traceback", done.stdout, re.IGNORECASE)
    return f"{text}\nexit {done.returncode}\n{done.stdout}" if is_wrong else ""


@pytest.mark.slow
@pytest.mark.parametrize(
    "page", [page for page in PAGES if readable(page)], ids=lambda page: str(page.relative_to(ROOT))
)
def test_the_blocks_of_a_page_run_as_pasted_and_warn_of_nothing(copy, page):
    bin_folder = copy / ".venv" / ("Scripts" if os.name == "nt" else "bin")
    environment = {**os.environ, "PATH": f"{bin_folder}{os.pathsep}{os.environ['PATH']}"}
    environment.pop("PYTHONPATH", None)
    environment["PIP_QUIET"] = "2"  # what it says of its indexes is not the page's
    is_example = "examples" in page.relative_to(ROOT).parts
    folder = (copy / page.relative_to(ROOT)).parent if is_example else copy
    for language, text in blocks(page):
        assert run(language, text, folder, environment) == ""


def test_commands_stand_in_blocks_that_are_run():
    for page in PAGES:
        indented = re.findall(
            r"^    (?:rotor-fmu|make|pip|fmpy|python) .*$", page.read_text(), re.M
        )
        assert not indented, f"{page.name}: {indented}"


SELECTING = """
import shlex, sys, pytest
for command in sys.argv[1:]:
    if status := pytest.main([*shlex.split(command), "--collect-only", "-qq"]):
        print("nothing:", command, status)
"""


@pytest.mark.slow
def test_every_command_of_tests_in_a_page_selects_some():
    """A test that a default leaves out, as slow, needs the mark in the command too."""
    texts = (page.read_text(encoding="utf-8").replace("\n", " ") for page in PAGES)
    found = (re.findall(r"`(?:pytest |(?=-m native ))([^`]+)`", text) for text in texts)
    commands = sorted(set(itertools.chain(*found)))
    assert len(commands) > 40
    done = run_anew(SELECTING, *commands, cwd=ROOT)
    assert "nothing:" not in done.stdout, re.findall(r"nothing:.*", done.stdout)
    assert done.returncode == 0, done.stderr
