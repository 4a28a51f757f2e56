"""What the FMU shows to people and tools: pages, licences, terminals, the same for every build."""

import re
import zipfile
from html.parser import HTMLParser
from xml.etree.ElementTree import fromstring

import fmpy
import pytest

from rotor_fmu.about import __version__


@pytest.fixture(scope="module")
def contents(fmu):
    with zipfile.ZipFile(fmu) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


class Links(HTMLParser):
    """Collects what a page shows."""

    def __init__(self):
        super().__init__()
        self.images, self.text = [], []

    def handle_starttag(self, tag, attrs):
        if tag == "img":
            self.images.append(dict(attrs)["src"])

    def handle_data(self, data):
        self.text.append(data)


def test_the_page_names_every_kind_of_variable_and_its_pictures_exist(fmu, contents):
    page = Links()
    page.feed(contents["documentation/index.html"].decode())
    assert page.images
    for image in page.images:
        assert contents[f"documentation/{image}"].startswith(b"\x89PNG")
    shown = set(page.text)
    for variable in fmpy.read_model_description(str(fmu)).modelVariables:
        name = variable.name
        for index in "123":
            name = name.replace(f"disc[{index}]", "disc[i]")
            name = name.replace(f"bearing[{index}]", "bearing[i]")
        assert name in shown


def test_terminals_refer_to_variables_that_exist(fmu, contents):
    names = {v.name for v in fmpy.read_model_description(str(fmu)).modelVariables}
    root = fromstring(contents["terminalsAndIcons/terminalsAndIcons.xml"])
    members = {
        m.get("memberName"): m.get("variableName") for m in root.iter("TerminalMemberVariable")
    }
    assert set(members.values()) <= names
    shaft = next(t for t in root.iter("Terminal") if t.get("name") == "shaft")
    assert {m.get("variableName") for m in shaft} == {"speed", "phi", "tau"}
    assert {t.get("name") for t in root.iter("Terminal")} >= {"disc[1]", "disc[3]", "coupling"}


def test_the_terminals_members_are_the_motion_and_the_torque_of_the_shaft_and_of_bodies(
    contents, free_fmu
):
    with zipfile.ZipFile(free_fmu) as archive:
        free = archive.read("terminalsAndIcons/terminalsAndIcons.xml")
    shafts = (
        {"w": "speed", "phi": "phi", "tau": "tau"},
        {"w": "w", "phi": "phi", "a": "a", "tau": "tau_drive"},
    )
    for xml, shaft in zip(
        (contents["terminalsAndIcons/terminalsAndIcons.xml"], free), shafts, strict=True
    ):
        found = {
            terminal.get("name"): {m.get("memberName"): m.get("variableName") for m in terminal}
            for terminal in fromstring(xml).iter("Terminal")
        }
        assert found.pop("shaft") == shaft
        assert found.pop("coupling") == {name: f"coupling.{name}" for name in ("fx", "fy")}
        assert found == {
            f"disc[{i}]": {name: f"disc[{i}].{name}" for name in ("fx", "fy", "x", "y")}
            for i in (1, 2, 3)
        }


def test_each_page_tells_its_own_drive_and_what_it_carries(fmu, free_fmu):
    for file, goes_in in ((fmu, "speed of the shaft"), (free_fmu, "torque of the drive")):
        with zipfile.ZipFile(file) as archive:
            page = archive.read("documentation/index.html").decode()
            names = archive.namelist()
        assert f"{goes_in} and the external loads go in" in " ".join(page.split())
        assert __version__ in page
        assert ("fmi-ls-ref.txt" in page) == ("documentation/fmi-ls-ref.txt" in names)
        assert any(name.startswith("extra/") for name in names) == (file == fmu)
        for link in re.findall(r'(?:href|src)="([^":]+)"', page):
            assert f"documentation/{link}" in names, link


@pytest.mark.parametrize("project", ["rotor-fmu", "pythonfmu"])
def test_the_licences_of_what_is_carried_are_there(contents, project):
    assert b"permission" in contents[f"documentation/licenses/{project}.txt"].lower()


def test_the_importing_tool_finds_an_icon(contents):
    assert contents["model.png"].startswith(b"\x89PNG")


def test_what_no_rotor_needs_stays_out(contents):
    modules = [name for name in contents if name.endswith(".py")]
    assert any(name.endswith("model/step/step.py") for name in modules)
