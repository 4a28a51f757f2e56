"""`rotor-fmu ssp`: a machine and a drive as one system, in the files of two standards."""

import json
import re
import zipfile

import pytest
from lxml import etree

from rotor_fmu.cli.fmus import ssp
from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.master import coupled
from rotor_fmu.errors import InputError
from rotor_fmu.fmi.packing.archive import contents_of

from ..parts.machines import shaft
from ..processes import run_python
from .coupled import last_row
from .test_hosts import LIBCOSIM, needs, run
from .test_schemas import EXAMPLES, FMI3, SSP, mistakes, osp_schema

VALUES = SSP.with_name("SystemStructureParameterValues.xsd")
MACHINE = EXAMPLES / "drop" / "compressor.toml"
SEEN = ["speed", "tau_load", "w", "energy.residual"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Of a machine that is no example of coupling."""
    out = tmp_path_factory.mktemp("system")
    ssp.__wrapped__(rotor=MACHINE, is_native=True, step="1ms", stop="1", out=out)
    return out


def test_the_package_is_valid_with_units_connectors_and_parameters(folder):
    with zipfile.ZipFile(folder / "System.ssp") as archive:
        names = set(archive.namelist())
        structure = archive.read("SystemStructure.ssd")
        sets = {name: archive.read(name) for name in names if name.endswith(".ssv")}
    assert {"resources/DriveTrain.fmu", "resources/DroppingCompressorNative.fmu"} < names
    assert mistakes(structure, SSP) == []
    root = etree.fromstring(structure)
    space = {"ssd": root.nsmap["ssd"], "ssc": root.nsmap["ssc"]}
    connectors = {
        (c.getparent().getparent().get("name"), c.get("name"), c.get("kind"))
        for c in root.iterfind(".//ssd:Connector", space)
    }
    assert ("rotor", "tau_load", "output") in connectors
    assert ("rotor", "speed", "input") in connectors
    for connection in root.iterfind(".//ssd:Connection", space):
        for side, kind in (("start", "output"), ("end", "input")):
            of = connection.get(f"{side}Element"), connection.get(f"{side}Connector"), kind
            assert of in connectors
    units = {u.get("name") for u in root.iterfind(".//ssc:Unit", space)}
    used = {r.get("unit") for r in root.iterfind(".//ssc:Real", space)}
    assert used == units
    assert len(sets) == 2
    for content in sets.values():
        assert mistakes(content, VALUES) == []
    rotor = etree.fromstring(sets["resources/rotor.ssv"])
    assert rotor.xpath("//*[@name='speed']/*")[0].get("value") == "0.0"


def test_the_terminals_of_both_ends_are_matched_by_what_is_connected(folder):
    """In the form of FMI 3.0, whose schema they follow."""
    root = etree.fromstring(contents_of(folder / "System.ssp")["SystemStructure.ssd"])
    space = {"ssd": root.nsmap["ssd"], "ssc": root.nsmap["ssc"]}
    shafts, known = {}, {}
    for component in root.iterfind(".//ssd:Component", space):
        (terminals,) = component.iterfind(".//ssc:Annotation/Terminals", space)
        described = etree.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
        described.append(terminals)
        assert mistakes(etree.tostring(described), FMI3 / "fmi3TerminalsAndIcons.xsd") == []
        connectors = {c.get("name") for c in component.iterfind(".//ssd:Connector", space)}
        for member in terminals.iter("TerminalMemberVariable"):
            assert member.get("variableName") in connectors
        name = component.get("name")
        known[name] = {t.get("name") for t in terminals}
        shafts[name] = {
            m.get("memberName"): m.get("variableName")
            for m in terminals.iterfind("Terminal[@name='shaft']/*")
        }
    assert {"disc[1]", "disc[2]", "body[1]"} & known["rotor"]
    # FMI's rule `bus`: members of the same name are connected
    both = shafts["drive"].keys() & shafts["rotor"].keys()
    matched = {frozenset(f"{n}.{shafts[n][m]}" for n in shafts) for m in both}
    connected = {
        frozenset(f"{c.get(f'{s}Element')}.{c.get(f'{s}Connector')}" for s in ("start", "end"))
        for c in root.iterfind(".//ssd:Connection", space)
    }
    assert matched == connected


@needs("libcosimpy", "pip install libcosimpy")
@pytest.mark.parametrize("algorithm", ["fixedStep", "ecco"])
def test_libcosim_runs_it_with_its_power_bond(folder, tmp_path, algorithm):
    text = (folder / "OspSystemStructure.xml").read_text()
    for fmu in folder.glob("*.fmu"):
        (tmp_path / fmu.name).write_bytes(fmu.read_bytes())
    file = tmp_path / "OspSystemStructure.xml"
    file.write_text(text.replace(">fixedStep<", f">{algorithm}<"))
    call = ["from_osp_config_file", str(file), 60, SEEN]
    run(LIBCOSIM, json.dumps(call), cwd=tmp_path)
    rows = json.loads((tmp_path / "rows.json").read_text())
    assert len(rows) == 60
    speed, load, w, _ = rows[-1]
    assert w > 0.0
    assert speed == pytest.approx(w, rel=0.5)
    assert load != 0.0


@needs("libcosimpy", "pip install libcosimpy")
def test_libcosim_opens_the_package_and_steps_as_osps_file_says(folder, tmp_path):
    rows = []
    for how, file in (
        ("from_ssp_file", "System.ssp"),
        ("from_osp_config_file", "OspSystemStructure.xml"),
    ):
        call = [how, str(folder / file), 40, SEEN]
        run(LIBCOSIM, json.dumps(call), cwd=tmp_path)
        rows.append(json.loads((tmp_path / "rows.json").read_text()))
    assert rows[0] == rows[1]
    assert rows[0][-1][SEEN.index("w")] > 0.0


@needs("libcosimpy", "pip install libcosimpy")
@pytest.mark.parametrize("file", ["System.ssp", "OspSystemStructure.xml"])
def test_the_script_of_the_examples_runs_either_file(folder, file):
    script = EXAMPLES / "with_libcosim.py"
    row = last_row(script, str(folder / file), "0.2", "0.1", "drive.w")
    assert row["time"] == pytest.approx(0.2)
    assert row["drive.w"] > 0.0


@needs("libcosimpy", "pip install libcosimpy")
@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "usage: python with_libcosim.py FILE STOP EVERY SLAVE.VARIABLE..., times in seconds"),
        (["System.ssp", "now", "0"], "usage: python with_libcosim.py FILE STOP EVERY SLAVE.VARI"),
        (["System.ssp", "-1", "0"], "-1 0: STOP must be > 0 and below 1e9 s, EVERY from 0 to STOP"),
        (["None.ssp", "1", "0"], "None.ssp: is not a file"),
        (["System.ssp", "1", "0", "w"], "w: is no variable of the slaves drive, rotor"),
        (["System.ssp", "1", "0", "drive.u"], "drive.u: is no variable of drive"),
    ],
)
def test_the_script_says_in_a_line_what_it_cannot_run(folder, arguments, expected):
    done = run_python(EXAMPLES / "with_libcosim.py", *arguments, cwd=folder)
    assert done.returncode == 2
    assert done.stderr.startswith(expected)
    assert done.stderr.count("\n") == 1


def test_by_ecco_the_load_goes_on_and_a_step_may_lose_little_of_the_energy(tmp_path):
    ssp.__wrapped__(rotor=MACHINE, is_native=True, algorithm="ecco", target="200", out=tmp_path)
    root = etree.parse(tmp_path / "OspSystemStructure.xml").getroot()
    values = {v.get("variable"): float(v[0].get("value")) for v in root.iter("{*}InitialValue")}
    assert values["continuation"] == 1.0
    (tolerance,) = root.iter("{*}AbsoluteTolerance")
    assert float(tolerance.text) == pytest.approx(1e-8 * 0.5 * values["J_rotor"] * 200.0**2)


@pytest.mark.parametrize(
    ("given", "expected", "stop"),
    [({}, 523.598776, 39.3), ({"target": "3000rpm", "stop": "9s"}, 314.159265, 9.0)],
)
def test_the_drive_runs_up_to_the_machines_own_speed(tmp_path, given, expected, stop):
    machine = tmp_path / "fan.toml"
    text = MACHINE.read_text()
    own = 'rated_speed = "5000 rpm"\nrun_up_rate = 20.0'
    machine.write_text(text.replace("rated_speed = 1000.0", own))
    ssp.__wrapped__(rotor=machine, is_native=True, out=tmp_path, **given)
    root = etree.parse(tmp_path / "OspSystemStructure.xml").getroot()
    values = {v.get("variable"): float(v[0].get("value")) for v in root.iter("{*}InitialValue")}
    assert values["w_target"] == pytest.approx(expected, rel=1e-8)
    assert values["ramp"] == 20.0
    structure = etree.fromstring(
        zipfile.ZipFile(tmp_path / "System.ssp").read("SystemStructure.ssd")
    )
    (experiment,) = structure.iter("{*}DefaultExperiment")
    assert float(experiment.get("stopTime")) == stop  # one and a half times the run-up


def values_of(folder, name):
    """Start values of a component by OSP's file."""
    root = etree.parse(folder / "OspSystemStructure.xml").getroot()
    (simulator,) = root.xpath(f"//*[@name='{name}' and @source]")
    return {v.get("variable"): float(v[0].get("value")) for v in simulator.iter("{*}InitialValue")}


def test_the_drive_of_the_rig_is_that_of_the_examples(tmp_path):
    ssp.__wrapped__(is_native=True, out=tmp_path)
    drive = Coupling(EXAMPLES / "drive_train" / "drive_train.py")
    own = {v.name: v.start for v in drive.variables}
    values = values_of(tmp_path, "drive")
    assert {"J_motor", "k", "c", "kp", "ki", "tau_max", "h"} < values.keys()
    for name, value in values.items():
        assert value == pytest.approx(own[name], rel=1e-6), name


@pytest.mark.parametrize(("length", "speed", "rate"), [(0.01, 6283.0, 2e4), (1.0, 300.0, 100.0)])
def test_a_drive_brings_a_machine_of_any_size_to_its_speed(tmp_path, length, speed, rate):
    """Of 4e-8 and of 4e2 kg.m2; the drive of the rig diverged at the one and crept at the other."""
    machine = tmp_path / "machine.toml"
    operation = f"[operation]\nrated_speed = {speed}\nrun_up_rate = {rate}\n"
    nodes = [0.0, 0.5 * length, length]
    machine.write_text(
        f"{shaft(*nodes, diameter=0.2 * length)}{operation}"
        f"[[disc]]\nnode = 2\ndiameter = {length}\nwidth = {0.5 * length}\n"
    )
    made = ssp.__wrapped__(rotor=machine, is_native=True, out=tmp_path / "out")
    assert not [warning for warning in made["warnings"] if "drive" in warning]
    given = {"drive": values_of(tmp_path / "out", "drive")}
    stop, recorded = 1.5 * speed / rate, {"drive": ["w"]}
    with coupled({"drive": made["drive"]}, [], [], given, recorded, stop=stop) as alone:
        run = alone.run(0.002)
    assert run["drive"]["w"][-1] == pytest.approx(speed, rel=1e-3)
    assert max(run["drive"]["w"]) < 1.01 * speed


def test_a_drive_that_is_too_weak_or_a_run_too_short_is_said(tmp_path, capsys):
    weak = ssp.__wrapped__(rotor=MACHINE, is_native=True, tau_max="0.2", out=tmp_path)
    assert weak["warnings"][-1].startswith("the drive reaches at most 112.8 of 1000 rad/s by")
    assert f"warning: {weak['warnings'][-1]}\n" in capsys.readouterr().err
    short = ssp.__wrapped__(rotor=MACHINE, is_native=True, stop="10", out=tmp_path)
    assert short["warnings"][-1].startswith("the drive reaches at most 625 of 1000 rad/s")
    assert ssp.__wrapped__(rotor=MACHINE, is_native=True, out=tmp_path)["warnings"] == []


def test_a_machine_that_cannot_start_at_rest_starts_where_its_films_carry_it(tmp_path):
    """The system could not start: no film carries anything before its journal turns."""
    machine = EXAMPLES / "turbocharger" / "rotor.toml"
    made = ssp.__wrapped__(rotor=machine, is_native=True, target="500", out=tmp_path)
    fmus = {name: made[name] for name in ("drive", "rotor")}
    given, recorded = {name: values_of(tmp_path, name) for name in fmus}, {"rotor": ["w"]}
    start = given["rotor"]["speed"]
    assert 0.0 < start < 0.02 * 500.0
    assert given["drive"]["w_start"] == start
    (warning,) = made["warnings"]
    expected = f"the system starts at {start:g} rad/s; at 0 rad/s it has no static equilibrium"
    assert warning.startswith(expected)
    pairs = [("drive.w", "rotor.speed"), ("rotor.tau_load", "drive.tau_load")]
    with coupled(fmus, pairs, (), given, recorded, stop=0.02) as opened:
        run = opened.run(0.002)
    assert run.status == "ok"
    assert run["rotor"]["w"][0] == start < run["rotor"]["w"][-1]


def test_a_machine_that_no_torque_can_drive_is_warned_of_as_by_build_free(tmp_path):
    """Its unbalance takes away more inertia than its light shaft has: every drive diverges."""
    jeffcott = EXAMPLES / "jeffcott_rub" / "jeffcott.toml"
    made = ssp.__wrapped__(rotor=jeffcott, is_native=True, out=tmp_path)
    assert any("must be at least 1e-06 kg.m2, four times U^2/m" in w for w in made["warnings"])


@pytest.mark.parametrize("name", ["drive train", "Drivetrain"])
def test_a_machine_whose_fmu_the_drives_would_replace_is_refused(tmp_path, name):
    machine = tmp_path / "machine.toml"
    machine.write_text(re.sub('name = ".*"', f'name = "{name}"', MACHINE.read_text(), count=1))
    with pytest.raises(InputError, match=r"^Drive[Tt]rain\.fmu: is the drive's FMU; give the mach"):
        ssp.__wrapped__(rotor=machine, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


@needs("libcosimpy", "pip install libcosimpy")
def test_osps_file_is_valid(folder):
    content = (folder / "OspSystemStructure.xml").read_bytes()
    assert mistakes(content, osp_schema()) == []
    bonds = etree.fromstring(content).xpath("//*[@powerBond]")
    assert len(bonds) == 2
    assert len({bond.get("powerBond") for bond in bonds}) == 1


def test_a_machine_that_nothing_holds_is_warned_of_as_by_build(tmp_path, capsys):
    machine = tmp_path / "hanging.toml"
    machine.write_text(shaft(0.0, 0.5, 1.0) + "[[support]]\nnode = 1\nstiffness = 1e7\n")
    summary = ssp.__wrapped__(rotor=machine, is_native=True, out=tmp_path)
    warning, start = summary["warnings"]
    assert warning.startswith("the machine is not held")
    assert start.startswith("the system cannot start at 0 rad/s: no static equilibrium")
    assert f"warning: {warning}\n" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"step": "0"}, "--step 0: must be > 0 and at most 1 s"),
        ({"tau_max": "-1kN.m"}, "--tau-max -1kN.m: must be > 0 and at most 1e+06 N.m"),
        (
            {"step": "9ns", "stop": "10s"},
            "--step 9ns: would make 1.11e+09 steps until --stop = 10 s; at most 1e+09",
        ),
        ({"stop": "1ms", "step": "2ms"}, "--step 0.002 s: must be at most --stop = 0.001 s"),
        ({"tau_max": "5 mm"}, "--tau-max 5 mm: must be a torque, in N.m or such as"),
        ({"tau_max": "-1"}, "--tau-max -1: must be > 0"),
        ({"target": "20 mm"}, "--target 20 mm: must be a speed"),
        ({"target": "2e7"}, "--target 2e7: must be at most 1e+06 rad/s in size"),
        ({"algorithm": "eco"}, "--algorithm eco: must be one of fixedStep, ecco"),
    ],
)
def test_what_cannot_be_is_refused(tmp_path, given, sentence):
    with pytest.raises(InputError, match=re.escape(sentence)):
        ssp.__wrapped__(out=tmp_path / "x", **given)
    assert not (tmp_path / "x").exists()


@pytest.mark.parametrize(
    ("operation", "sentence"),
    [
        (
            "rated_speed = 2e6",
            "--target = 2e+06 rad/s, the machine's rated speed: must be at most 1e+06 rad/s",
        ),
        (
            "rated_speed = 100.0\nrun_up_rate = 1e-5",
            "--stop 1.5e+07, one and a half times the run-up at the machine's rate: must be > 0",
        ),
        (
            "rated_speed = 100.0\nrun_up_rate = 1e6",
            "--step 0.002 s: must be at most --stop = 0.00015 s, one and a half times the run-up",
        ),
    ],
)
def test_what_follows_from_the_machine_and_cannot_be_is_not_laid_to_an_option(
    tmp_path, operation, sentence
):
    machine = tmp_path / "machine.toml"
    machine.write_text(MACHINE.read_text().replace("rated_speed = 1000.0", operation))
    with pytest.raises(InputError, match=re.escape(sentence)):
        ssp.__wrapped__(rotor=machine, out=tmp_path / "x")
