"""What the FMU shows to people and tools: pages, licences, terminals, the same for every build."""

import math
import re
import subprocess
import zipfile
from html.parser import HTMLParser
from pathlib import Path
from xml.etree.ElementTree import fromstring

import fmpy
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml

from rotor_fmu.about import __version__
from rotor_fmu.fmi.description import default_experiment, summary
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.archive import contents_of, wrap
from rotor_fmu.fmi.packing.documents import rows
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.fmi.packing.python_fmu import build
from rotor_fmu.fmi.terminals import terminals_of
from rotor_fmu.machine_file.loading import machine_text

from ..parts.films import film
from ..parts.machines import FLEXIBLE
from ..toml_text import table

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def contents(fmu):
    return contents_of(fmu)


@pytest.mark.parametrize(
    ("said", "reason"), [("Traceback\nno disk\n", "no disk"), ("", "status 7")]
)
def test_an_fmu_that_cannot_be_made_says_why_in_one_line(said, reason, monkeypatch, tmp_path):
    """By the last line of pythonfmu, or, where it says nothing, its exit status."""
    failed = subprocess.CompletedProcess([], 7, "", said)
    monkeypatch.setattr(subprocess, "run", lambda *_, **__: failed)
    with pytest.raises(OSError, match=rf"cannot make an FMU of entry\.py: .*{reason}$"):
        wrap(tmp_path / "entry.py", [], tmp_path / "raw.fmu")


def test_the_table_names_the_parameters_that_a_host_may_tune(fmu):
    """Those that FMPy reads from the description, of a machine whose parts are one of a kind."""
    variables = fmpy.read_model_description(str(fmu)).modelVariables
    tunable = {v.name.replace("[1]", "[i]") for v in variables if v.variability == "tunable"}
    listed = {
        name
        for name, causality, *_ in rows(interface(parse_rotor(rig_toml())))
        if "tunable" in causality
    }
    assert "bearing[i].mu" in listed
    assert listed == {name for name in tunable if not re.search(r"\[\d\]", name)}


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


def test_the_end_of_a_line_takes_and_gives_waves():
    """Its input is no force, and its terminal none of a body that a force acts on."""
    rotor = parse_rotor(
        FLEXIBLE + table("[line]", name="wire", node=2, impedance=30.0) + table("[port]", node=2)
    )
    variables = {v.name: v for v in interface(rotor)}
    assert variables["wire.fx"].text.startswith("incoming wave of the line on node 2 at z = ")
    assert variables["port[1].fx"].text.startswith("external force on node 2 at z = ")
    terminals = {t.name: t for t in terminals_of(interface(rotor))}
    assert terminals["wire"].kind == "line"
    assert {"fx", "fy", "wave_x", "wave_y"} <= set(terminals["wire"].members)
    assert terminals["port[1]"].kind == "body"
    assert not {"wave_x", "wave_y"} & set(terminals["port[1]"].members)


def test_what_a_bearing_exerts_makes_no_terminal():
    """Outputs of the same names as the inputs of a body: nothing can be joined there."""
    rotor = parse_rotor(FLEXIBLE + film(2))
    outputs = {v.name for v in interface(rotor) if v.causality == "output"}
    assert "journal_bearing[1].fx" in outputs
    inputs = {v.name for v in interface(rotor) if v.causality == "input"}
    terminals = {t.name: t.members for t in terminals_of(interface(rotor)) if t.kind == "body"}
    assert terminals.keys() == {name.removesuffix(".fx") for name in inputs if name.endswith(".fx")}


def test_terminals_refer_to_variables_that_exist(fmu, contents):
    names = {v.name for v in fmpy.read_model_description(str(fmu)).modelVariables}
    root = fromstring(contents["terminalsAndIcons/terminalsAndIcons.xml"])
    members = {
        m.get("memberName"): m.get("variableName") for m in root.iter("TerminalMemberVariable")
    }
    assert set(members.values()) <= names
    shaft = next(t for t in root.iter("Terminal") if t.get("name") == "shaft")
    assert {m.get("variableName") for m in shaft} == {"speed", "phi", "tau", "tau_load"}
    assert {t.get("name") for t in root.iter("Terminal")} >= {"disc[1]", "disc[3]", "coupling"}


def test_the_terminals_members_are_the_motion_and_the_torque_of_the_shaft_and_of_bodies(
    contents, free_fmu
):
    free = contents_of(free_fmu)["terminalsAndIcons/terminalsAndIcons.xml"]
    shafts = (
        {"w": "speed", "phi": "phi", "tau": "tau", "tau_load": "tau_load"},
        {"w": "w", "phi": "phi", "a": "a", "tau": "tau_drive"},
    )
    for xml, shaft in zip(
        (contents["terminalsAndIcons/terminalsAndIcons.xml"], free), shafts, strict=True
    ):
        result = {
            terminal.get("name"): {m.get("memberName"): m.get("variableName") for m in terminal}
            for terminal in fromstring(xml).iter("Terminal")
        }
        assert result.pop("shaft") == shaft
        assert result.pop("coupling") == {name: f"coupling.{name}" for name in ("fx", "fy")}
        assert result == {
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


@pytest.mark.parametrize("kind", ["python", 2, 3])
def test_an_fmu_speaks_of_its_own_machine(tmp_path, kind):
    toml = machine_text("", EXAMPLES / "drop" / "compressor.toml")
    if kind == "python":
        fmu = build(tmp_path, machine_of(toml, False))
    else:
        fmu = build_native(tmp_path, machine_of(toml, False), kind, ["linux64"])
    description = fmpy.read_model_description(str(fmu))
    assert description.modelName == "dropping compressor"
    assert description.description == (
        "dropping compressor: a flexible rotor with 2 bodies, 2 housings, 2 touchdown bearings, "
        "driven by its speed"
    )
    assert (
        float(description.defaultExperiment.stopTime) == default_experiment(parse_rotor(toml)).stop
    )
    with zipfile.ZipFile(fmu) as archive:
        page = archive.read("documentation/index.html").decode()
        names = archive.namelist()
    assert description.description in page
    assert "Zigulic" not in page
    assert "documentation/run_down.png" not in names


def test_what_drives_it_is_said(free_fmu):
    assert fmpy.read_model_description(str(free_fmu)).description == (
        "zigulic2003: a flexible rotor with 2 bearings, 3 discs, 1 coupling, driven by a torque"
    )


def test_a_row_of_several_parts_has_the_start_value_of_each_and_none_is_lost():
    """Two discs that differ, and of two bearings the first one has tables, which are no
    parameters."""
    bearing = "[[linear_bearing]]\nnode = {}\nkxx = {}\nkyy = {}\ncxx = {}\ncyy = {}\n"
    tables = bearing.format(1, *["[1e7, 2e7]", "[1e7, 2e7]", "[0.0, 0.0]", "[0.0, 0.0]"])
    disc = "[[disc]]\nnode = {}\ndiameter = 0.1\nwidth = 0.01\ne = {}\n"
    shaft = "[shaft]\nnodes = [0.0, 0.2, 0.4]\ndiameters = [0.02, 0.02]\n"
    text = (
        f"[material]\nyoung = 2.1e11\ndensity = 7800.0\n{shaft}{disc.format(1, 1e-5)}"
        f"{disc.format(2, 2e-5)}{tables}speed = [0.0, 500.0]\n{bearing.format(3, 3e6, 3e6, 0, 0)}"
    )
    starts = {row[0]: row[3] for row in rows(interface(parse_rotor(text)))}
    assert starts["disc[i].e"] == "1e-05, 2e-05"
    assert starts["disc[i].phase"] == "0"
    assert starts["linear_bearing[2].kxx"] == "3e+06"
    assert "linear_bearing[i].x" in starts


def test_parts_with_names_are_counted_by_what_they_are():
    toml = rig_toml().replace("[[disc]]", '[[disc]]\nname = "impeller"', 1)
    assert summary(parse_rotor(toml), False) == (
        "zigulic2003: a flexible rotor with 2 bearings, 3 discs, 1 coupling, driven by its speed"
    )


@pytest.mark.parametrize("stiffness", [0.01, 1.0, 5.0, 20.0, 100.0])
def test_the_default_experiment_is_as_long_as_the_machine_is_slow(stiffness):
    """Sixty periods and more of the lowest mode, each with six points and more; a Jeffcott rotor's,
    of which bearings of 1e4 N/m make 100 rad/s."""
    toml = machine_text("", EXAMPLES / "jeffcott_rub" / "jeffcott.toml")
    scaled = re.sub(
        r"(?m)^(k[xy]{2}) = (\S+)", lambda m: f"{m[1]} = {float(m[2]) * stiffness}", toml
    )
    experiment = default_experiment(parse_rotor(scaled))
    assert experiment.step == pytest.approx(experiment.stop / 1000)
    periods = experiment.stop * 100.0 * math.sqrt(stiffness) / (2 * math.pi)
    assert 60 <= periods <= 1000 / 6


@pytest.mark.parametrize("project", ["rotor-fmu", "pythonfmu"])
def test_the_licences_of_what_is_carried_are_there(contents, project):
    assert b"permission" in contents[f"documentation/licenses/{project}.txt"].lower()


def test_the_importing_tool_finds_an_icon(contents):
    assert contents["model.png"].startswith(b"\x89PNG")
