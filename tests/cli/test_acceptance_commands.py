"""The commands that check a machine by API 617 and 684: tables, pictures, bad input."""

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.text import Text
from rotor_fmu.model.machine.operating_speeds import Operation
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.clearance_contact import ClearanceContact
from rotor_fmu.model.parts.linear_bearing import LinearBearing
from rotor_fmu.model.simulation import HYSTERETIC_AS_SLOWER

from rotor_fmu.cli import app
from rotor_fmu.errors import InputError
from rotor_fmu.linear import acceptance
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.machine_report import report_page
from rotor_fmu.machine_report.report_page import ReportOptions, as_ranges, machine_report

from ..known import EXAMPLES
from ..linear.api_617 import RPM, SHAFT, support
from ..toml_text import table

ROSS = Path(__file__).parents[1] / "reference" / "ross"
COMPRESSOR = str(ROSS / "compressor.toml")
PNG = b"\x89PNG"


@pytest.mark.usefixtures("drawn")
def test_critical_map_tells_where_bearings_meet_it(command, tmp_path):
    said = command("critical-map", "--rotor", COMPRESSOR, "--stiffness", "1e7:1e9:5")
    assert "linear_bearing[1] kxx     1" in said
    assert (tmp_path / "out" / "critical_map.png").read_bytes().startswith(PNG)
    data = json.loads((tmp_path / "out" / "critical_map.json").read_text())
    assert data["crossings"][0]["bearing"] == "linear_bearing[1]"


def test_bearings_of_the_same_stiffness_share_the_rows_of_a_critical_map(command, tmp_path):
    said = command("critical-map", "--rotor", str(EXAMPLES / "from_ross" / "rubbing.toml"))
    for axis in "xy":
        alike = f"linear_bearing[1] k{axis}{axis}, linear_bearing[2] k{axis}{axis}"
        modes = [line.removeprefix(alike).split()[0] for line in said.splitlines() if alike in line]
        assert modes == sorted({*modes})


def test_the_stiffnesses_of_four_bearings_look_different_in_a_critical_map(tmp_path):
    text = table("material", young=2.1e11, density=7800.0)
    text += table("shaft", nodes=[0.0, 0.2, 0.4, 0.6], diameters=[0.03] * 3)
    for node in range(1, 5):
        k = {"kxx": node * 1e6, "kyy": node * 1.6e6} if node < 4 else {"kxx": 9e6, "kyy": 9e6}
        text += table("[linear_bearing]", node=node, cxx=0.0, cyy=0.0, **k)
    rotor = tmp_path / "rotor.toml"
    rotor.write_text(text)
    figure = acceptance.critical_map(load_rotor(rotor)[1], [1e5, 1e6, 1e7]).figure()
    (legend,) = figure.legends
    lines = legend.get_lines()
    assert len(lines) == 7
    assert len({(line.get_color(), str(line._unscaled_dash_pattern)) for line in lines}) == 7


def test_stiffnesses_that_a_critical_map_does_not_show_apart_are_one_line():
    k = {"kxx": 1e6, "kyy": 1.001e6, "cxx": 0.0, "cyy": 0.0}
    text = SHAFT + "".join(table("[linear_bearing]", node=node, **k) for node in (1, 7))
    shown = acceptance.critical_map(parse_rotor(text), [1e5, 1e6, 1e7], count=1)
    assert len(shown.table().rows) == 2
    (legend,) = shown.figure().legends
    assert [label.get_text().count("bearing") for label in legend.get_texts()] == [4]


@pytest.mark.usefixtures("drawn")
def test_stability_of_both_levels(command, tmp_path):
    stage = ["--stage", "3:500e3:0.3:0.02:2.5", "--cross-coupling", "4:1e5"]
    said = command("stability", "--rotor", COMPRESSOR, "--rated", "9000rpm", *stage)
    assert "level 2 is not required" in said
    data = json.loads((tmp_path / "out" / "stability.json").read_text())
    expected = 3 * 500e3 / (9000 * math.pi / 30 * 0.3 * 0.02) * 2.5 + 1e5
    assert data["anticipated"] == pytest.approx(expected)
    said = command("stability", "--rotor", COMPRESSOR, "--rated", "9000rpm", "--level", "2")
    assert "with seal[1]" in said
    assert (tmp_path / "out" / "stability.png").read_bytes().startswith(PNG)


@pytest.mark.usefixtures("drawn")
def test_unbalance_is_held_against_the_range(command, tmp_path):
    said = command(
        *("unbalance", "--rotor", str(ROSS / "under_tension.toml"), "--range", "1500:2000rpm"),
        *("--mode", "1", "--node", "7", "--clearance", "7:1e-4", "--speed", "0:2500rpm:11"),
    )
    assert "API 617 between 25 and 33.333 Hz" in said
    assert "clearance node 7" in said
    data = json.loads((tmp_path / "out" / "unbalance.json").read_text())
    critical = data["check"]["criticals"][0]
    assert critical["peak"]["amplification"] > 2.5
    assert critical["margin"]["required"] > 0
    assert (tmp_path / "out" / "unbalance_check.png").read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["critical-map", "--stiffness", "1e7"], "--stiffness 1e7: must be FROM:TO"),
        (["critical-map", "--stiffness", "1e7:1e5"], "--stiffness 1e7:1e5: FROM must be below TO"),
        (["critical-map", "--count", "0"], "--count 0: must be from 1 to 100"),
        (["stability", "--rotor", COMPRESSOR], "--rated: must be given"),
        (["stability", "--rated", "-5rpm"], "--rated -5rpm: must be above 0"),
        (["stability", "--rated", "fast"], "--rated fast: must be a number"),
        (["stability", "--rated", "50Hz", "--level", "3"], "--level 3: must be 1 or 2"),
        (
            ["stability", "--rated", "50Hz", "--level", "2", "--node", "4"],
            "--node 4: is of level 1; at level 2 each cross coupling has its own node",
        ),
        (["stability", "--rated", "50Hz", "--stage", "3:1"], "--stage 3:1: must be NODE:POWER"),
        (["stability", "--rated", "50Hz", "--cross-coupling", "x"], "must be NODE:STIFFNESS"),
        (
            ["stability", "--rated", "50Hz", "--cross-coupling", "99:1"],
            "--cross-coupling 99: must be",
        ),
        (["unbalance", "--unbalance", "99:1e-5"], "--unbalance 99: must be from 1 to"),
        (
            ["unbalance", "--node", "4", "--node", "4"],
            "--node 4: is given twice; they must be diff",
        ),
        (
            ["unbalance", "--clearance", "4:0.2mm", "--clearance", "4:0.3mm"],
            "--clearance 4:0.3mm: node 4 has another one already",
        ),
        (["unbalance", "--unbalance", "4:50g:0"], "--unbalance 4: 50g: must be an unbalance"),
        (["stability", "--rated", "50Hz", "--node", "99"], "--node 99: must be from 1"),
        (
            ["unbalance", "--range", "60:100Hz", "--mode", "1", "--factor", "nan"],
            "factor = nan: must be > 0 and finite",
        ),
        (
            ["unbalance", "--factor", "3"],
            "--factor 3: needs --mode, whose unbalances it multiplies",
        ),
        (
            ["report", "run", "--node", "2"],
            "--node: is of the report of a machine, which n",
        ),
        (["report", "run", "--stage", "3:1kW:1:1:1"], "--stage: is of the report of a machine"),
        (["report", "--rotor", COMPRESSOR, "--live"], "--live and --rotor: `rotor-fmu page` w"),
        (["unbalance", "--range", "60:50Hz"], "--range 60:50Hz: FROM must be below TO"),
        (["unbalance", "--range", "0:50Hz"], "--range 0:50Hz: must be FROM:TO, both above 0"),
        (["unbalance", "--rotor", COMPRESSOR, "--mode", "1"], "need the operating range"),
        (["unbalance", "--clearance", "1"], "--clearance 1: must be NODE:RADIUS"),
        (
            ["unbalance", "--range", "10:50Hz", "--mode", "1", "--unbalance", "3:1e-5"],
            "only one of them",
        ),
        (
            ["unbalance", "--range", "10:50Hz", "--mode", "99"],
            "mode = 99: must be an integer from 1",
        ),
    ],
)
def test_impossible_wishes_are_refused(refusal, tmp_path, arguments, expected):
    said = refusal(*arguments)
    assert expected in said
    assert "\n" not in said
    assert not list(tmp_path.iterdir())


JEFFCOTT = str(Path(__file__).parents[2] / "examples" / "jeffcott_rub" / "jeffcott.toml")


@pytest.mark.usefixtures("coarse_report")
def test_the_report_of_a_machine_goes_on_into_contact(tmp_path, capsys):
    """The Jeffcott rotor in its clearance: running up the rub lasts far beyond the resonance,
    running down it begins where the free response closes the clearance."""
    page = tmp_path / "jeffcott.html"
    app(
        ["report", "--rotor", JEFFCOTT, "--range", "1400:1800rpm", "--out", str(page)],
        standalone_mode=False,
    )
    said, waited = capsys.readouterr()
    assert waited.startswith("run-up and run-down with contacts, ")
    assert "The rub lasts in the operating range (contact[1]), only running up." in said
    html = page.read_text()
    for heading in ("Machine", "At rest", "Critical speeds", "Mode shapes", "Into contact"):
        assert f"<h2>{heading}</h2>" in html
    assert "<canvas" in html
    assert "http" not in html.replace("http://www.w3.org", "")
    data = json.loads(page.with_suffix(".json").read_text())
    assert data["machine"]["mass"] == pytest.approx(1.0, rel=1e-3)
    assert set(data["static"]["load_y"]) == {0.0}  # without gravity
    # of the closed form: half a clearance over 2 zeta sqrt(1 - zeta^2)
    peak = 0.5e-3 / (0.2 * math.sqrt(0.99))
    assert max(map(max, data["response"]["major"])) == pytest.approx(peak, rel=1e-3)
    (closing,) = data["contact"]["closings"]
    # of the closed form the response exceeds twice the eccentricity between these speeds
    assert closing["begin"] == pytest.approx(100 * _crosses(2.0, below=True), rel=0.02)
    assert closing["end"] == pytest.approx(100 * _crosses(2.0, below=False), rel=0.02)
    up, down = data["contact"]["runs"]
    assert up["contacts"][0]["share_in_range"] > 0.5
    assert down["contacts"][0]["share_in_range"] == 0.0


@pytest.mark.usefixtures("conclusions_alone")
def test_what_runs_of_a_report_say_of_their_numbers_is_concluded_once():
    """Hysteresis, which they take otherwise than the rest of the report does."""
    rotor = replace(load_rotor(Path(JEFFCOTT))[1], eta_h=1e-4, rotating_damping=True)
    concluded = machine_report(rotor, ReportOptions(1400 * RPM, 1800 * RPM)).conclusions
    assert concluded[1].text == "Probes above 25.4 um peak-to-peak: node 1, node 2, node 3."
    assert concluded[-2].text.startswith("The rub lasts in the operating range")
    assert concluded[-1].text == HYSTERETIC_AS_SLOWER


@pytest.mark.usefixtures("conclusions_alone")
def test_a_report_begins_with_the_threshold_of_stability_below_the_highest_speed():
    """Above it the machine does not come to the steady response, from which the rest follows. The
    Jeffcott rotor's damping takes a cross-coupled stiffness of 2 zeta k = 2000 N/m."""
    rotor = load_rotor(Path(JEFFCOTT))[1]
    for coupling in (1900.0, 2100.0):
        parts = [
            replace(p, kxy=coupling, kyx=-coupling) if getattr(p, "kxx", 0.0) == 9800.0 else p
            for p in rotor.parts
        ]
        machine = replace(rotor, parts=tuple(parts))
        first, *rest = machine_report(machine, ReportOptions(10.0, 20.0)).conclusions
        assert first.text.startswith("The machine is unstable already at ") == (coupling > 2000.0)
        assert first.is_met == (coupling < 2000.0)
        assert any(each.is_met for each in rest) == (coupling < 2000.0)


@pytest.mark.usefixtures("conclusions_alone")
def test_a_machine_without_unbalance_is_not_said_to_pass(refusal, tmp_path, capsys):
    """It answers to nothing. A report places the unbalances of API 617 then: its critical speed of
    4128 rpm is too near to the range."""
    file = tmp_path / "balanced.toml"
    file.write_text(SHAFT + support(1, 1e7, 500.0) + support(7, 1e7, 500.0))
    for arguments in ([], ["--range", "2500:3500rpm"]):
        assert "no unbalance acts" in refusal("unbalance", "--rotor", str(file), *arguments)
    pulled = tmp_path / "pulled.toml"
    pulls = table("[linear_bearing]", node=4, kxx=-5e7, kyy=0.0, cxx=0.0, cyy=0.0)
    pulled.write_text(f"{file.read_text()}\n{pulls}")
    assert "no unbalance acts" in refusal("unbalance", "--rotor", str(pulled), *arguments)
    assert not any(capsys.readouterr())  # where it is unstable is no matter then
    report = machine_report(load_rotor(file)[1], ReportOptions(2500 * RPM, 3500 * RPM))
    said = report.conclusions[0].text
    assert said.startswith("Critical speeds too near to the operating range: ")
    assert "Unbalances placed by API 617 for mode 1: " in report.html
    assert "Deflection at rest" in report.html


@pytest.mark.usefixtures("coarse_report", "without_runs")
def test_a_machine_far_below_its_critical_speeds_is_said_to_have_none_there(command):
    """The Jeffcott rotor's is at 955 rpm; looked at is one and a half times the highest speed."""
    rotor = load_rotor(Path(JEFFCOTT))[1]
    report = machine_report(rotor, ReportOptions(10.0, 20.0))
    none = "The response shows no critical speed up to 4.7746 Hz, 150 % of the highest one of the "
    none += "operating range."
    assert report.conclusions[0] == (none, True)
    assert "Nothing pulls across the shaft" in report.html
    assert "Deflection at rest" not in report.html
    texts = acceptance.unbalance_check(rotor, 10.0, 20.0, [2]).figure().findobj(Text)
    assert "no critical speed up to 4.7746 Hz" in [text.get_text() for text in texts]
    said = command("campbell", "--rotor", JEFFCOTT, "--speed", "0:20")
    assert said.startswith("No critical speed between 0 and 3.1831 Hz, contacts open; stable at")
    assert "log dec" not in said


@pytest.mark.usefixtures("coarse_report", "without_runs")
def test_what_is_looked_at_by_itself_reaches_a_trip_speed_beyond_half_above_the_range(
    command, tmp_path
):
    """A runaway speed, as of a hydraulic turbine: the Jeffcott rotor's critical one is below it."""
    file = tmp_path / "rotor.toml"
    speeds = "minimum_speed = 40.0\nmaximum_continuous_speed = 60.0\ntrip_speed = 110.0\n"
    file.write_text(f"{Path(JEFFCOTT).read_text()}\n[operation]\n{speeds}")
    assert command("campbell", "--rotor", str(file)).startswith("Critical speeds between 0 and 17.")
    report = machine_report(load_rotor(file)[1], ReportOptions(40.0, 60.0))
    assert report.numbers["campbell"]["speeds"][-1] == pytest.approx(110.0)
    low = load_rotor(Path(JEFFCOTT))[1]
    low = replace(low, operation=Operation(trip_speed=50.0))
    said = machine_report(low, ReportOptions(10.0, 20.0)).conclusions[0].text
    assert said.startswith(
        "The response shows no critical speed up to 7.9577 Hz, 250 % of the highest one of the "
    )


def _crosses(amplitude, below):
    """Where r^2 / sqrt((1 - r^2)^2 + (0.2 r)^2) is this: (1 - 1 / a^2) r^4 - 1.96 r^2 + 1 = 0."""
    a, b = 1 - amplitude**-2, 1.96
    root = math.sqrt(b**2 - 4 * a)
    return math.sqrt((b - root if below else b + root) / (2 * a))


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ([], "RUN_OR_STUDY: must be given"),
        (["--rotor", JEFFCOTT], "--range: must be given"),
        (["somewhere", "--rotor", JEFFCOTT], "somewhere and --rotor"),
        (["--rotor", JEFFCOTT, "--rated", "0rpm"], "--rated 0rpm: must be above 0"),
        (["--rotor", JEFFCOTT, "--rated", "9rpm", "--node", "9"], "--node 9: must be from 1 to 3"),
    ],
)
def test_impossible_reports_are_refused(tmp_path, arguments, expected):
    with pytest.raises(InputError) as refused:
        app(["report", *arguments, "--out", str(tmp_path / "page.html")], standalone_mode=False)
    assert expected in str(refused.value)
    assert not list(tmp_path.iterdir())


def test_a_report_of_a_machine_that_nothing_holds_is_refused_before_all_else(monkeypatch):
    rotor = load_rotor(Path(JEFFCOTT))[1]
    bare = tuple(p for p in rotor.parts if not isinstance(p, (LinearBearing, ClearanceContact)))
    free = replace(rotor, parts=bare)
    monkeypatch.setattr(report_page, "lowest_speed", None)
    with pytest.raises(InputError, match="not held"):
        machine_report(free, ReportOptions(10.0, 20.0))


def test_peaks_of_one_critical_speed_are_reported_as_a_range():
    """Probes and directions have them at slightly different speeds."""
    peaks = [2 * math.pi * hz for hz in (174.2, 141.7, 144.1, 173.9, 141.7, 250.0)]
    assert list(as_ranges(peaks)) == ["141.7 to 144.1", "173.9 to 174.2", "250"]


@pytest.mark.usefixtures("coarse_report", "without_runs")
@pytest.mark.parametrize("has_own", [False, True])
def test_what_moves_a_bowed_machine_is_said(command, tmp_path, has_own):
    file = tmp_path / "bowed.toml"
    own = "[[unbalance]]\nnode = 3\namount = 1e-5\n" if has_own else ""
    bowed = "gravity = 0.0\n" + SHAFT + support(1, 1e7) + support(7, 1e7) + own
    file.write_text(bowed + "[[bow]]\nnode = 4\namplitude = 1e-5\n")
    asked = ("unbalance", "--rotor", str(file), "--range", "50:60")
    assert "the response has theirs: bow[1]" in command(*asked)
    assert "left out beside unbalances given instead: bow[1]" in command(*asked, "--mode", "1")
    assert "left out at rest: bow[1]" in command("static", "--rotor", str(file))
    html = machine_report(load_rotor(file)[1], ReportOptions(50.0, 60.0)).html
    assert ("own unbalances act" in html) == has_own
    assert "the response has theirs: bow[1]" in html
    assert "it is straight" not in html
