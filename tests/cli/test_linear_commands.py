"""The commands that tell linear answers, the objects of Python, and files that extend others."""

import json
import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.linear import Modes
from rotor_fmu.model.machine.ross import parse_ross
from rotor_fmu.model.machine.toml import rig, rig_toml
from rotor_fmu.model.machine.toml_text import toml_text

from rotor_fmu.balancing.result import Balancing
from rotor_fmu.cli import app
from rotor_fmu.cli.speeds import one_speed, speed_range
from rotor_fmu.display import speed_with_unit
from rotor_fmu.errors import InputError
from rotor_fmu.linear import acceptance, answers, frequency_answers
from rotor_fmu.linear.displayed import Displayed
from rotor_fmu.machine_file.loading import load_rotor, machine_text

from ..known import EXAMPLES

ROSS = Path(__file__).parents[1] / "reference" / "ross"
TURBOCHARGER = EXAMPLES / "turbocharger" / "rotor.toml"
PNG = b"\x89PNG"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["modes", "--speed", "3000rpm"], "Modes at 50 Hz (314.16 rad/s), contacts pinned"),
        (
            ["campbell", "--speed", "0:60Hz:7", "--count", "4"],
            "Critical speeds between 0 and 60 Hz",
        ),
        (["unbalance", "--speed", "20:40Hz:5", "--node", "5"], "Response to unbalance, contacts"),
        (["static"], "on bearing[1]"),
        (["show"], "zigulic2003: 8 nodes, 330 mm"),
    ],
)
def test_each_command_tells_a_table_and_writes_a_picture(command, tmp_path, arguments, expected):
    assert expected in command(*arguments)
    name = arguments[0]
    assert (tmp_path / "out" / f"{name}.png").exists()
    assert json.loads((tmp_path / "out" / f"{name}.json").read_text())


def test_campbell_has_critical_speeds_of_several_orders(command, tmp_path):
    """Of twice the speed those whose doubles are frequencies of the diagram."""
    said = command(
        *("campbell", "--rotor", str(ROSS / "under_tension.toml"), "--speed", "0:150:7"),
        *("--harmonic", "1", "--harmonic", "2", "--range", "50:80", "--count", "4"),
    )
    assert "Critical speeds of 1, 2 times the speed" in said
    critical = json.loads((tmp_path / "out" / "campbell.json").read_text())["critical"]
    assert {c["harmonic"] for c in critical} == {1.0, 2.0}
    rotor = answers.rotor_of(ROSS / "under_tension.toml")
    for c in critical:
        damped = answers.modes(rotor, c["speed"], count=4).damped
        assert np.abs(damped / (c["harmonic"] * c["speed"]) - 1).min() < 1e-9


@pytest.mark.usefixtures("drawn")
def test_mode_shapes_are_drawn_in_space_too(command, tmp_path):
    command("modes", "--speed", "3000rpm", "--count", "2")
    assert (tmp_path / "out" / "modes_3d.png").read_bytes().startswith(PNG)


def test_frequencies_damping_ratio_and_decrement_of_a_mode_fit_together(command):
    _, names, numbers, *_ = command("modes", "--count", "1").splitlines()
    row = dict(zip(*(re.split("  +", line.strip()) for line in (names, numbers)), strict=True))
    damped, natural = float(row["f_d [Hz]"]), float(row["f_n [Hz]"])
    ratio = float(row["damping ratio"])
    assert ratio == pytest.approx(math.sqrt(1 - (damped / natural) ** 2), rel=5e-3)
    decrement = 2 * math.pi * ratio / math.sqrt(1 - ratio**2)
    assert float(row["log dec"]) == pytest.approx(decrement, rel=1e-4)


def test_numbers_of_the_rig_are_those_of_the_paper(command):
    """Its 29.4 and 32.5 Hz."""
    natural = json.loads(command("modes", "--json"))["natural"]
    np.testing.assert_allclose(np.array(natural[:2]) / (2 * math.pi), [29.4, 32.5], rtol=0.006)


@pytest.mark.usefixtures("without_peaks")
def test_json_says_all_in_si(command):
    output = json.loads(command("unbalance", "--json", "--speed", "30Hz"))
    result = answers.unbalance_response(rig(), [60 * math.pi])
    np.testing.assert_allclose(np.array(output["x"]) @ [1, 1j], result.x)


def test_a_rotor_from_ross_is_taken_as_it_is_and_imported(command, tmp_path):
    direct = command("modes", "--rotor", str(ROSS / "on_pedestals.json"))
    machine = tmp_path / "machine.toml"
    app(
        ["import-ross", str(ROSS / "on_pedestals.json"), "--out", str(machine)],
        standalone_mode=False,
    )
    output = command("modes", "--rotor", str(machine))
    assert output.splitlines()[-9:-1] == direct.splitlines()[-9:-1]


def test_names_in_the_comments_of_an_import_from_ross_end_no_comment(tmp_path):
    saved = tmp_path / "rotor.a\nb"
    text = (ROSS / "compressor.toml").read_text()
    saved.write_text(text.replace("BearingElement_bearing 0", "BearingElement_a\\nb 0"))
    machine = tmp_path / "machine.toml"
    app(["import-ross", str(saved), "--out", str(machine)], standalone_mode=False)
    head = machine.read_text().partition("\n\n")[0].splitlines()
    assert [line[0] for line in head] == len(head) * ["#"]
    assert r"rotor.a\nb" in head[0]
    assert any(r"BearingElement_a\nb 0" in line for line in head)


def test_an_import_from_ross_overwrites_nothing_that_a_user_wrote(tmp_path):
    machine = tmp_path / "machine.toml"
    arguments = ["import-ross", str(ROSS / "on_pedestals.json"), "--out", str(machine)]
    app(arguments, standalone_mode=False)
    app(arguments, standalone_mode=False)  # what it wrote itself it may write again
    machine.write_text(edited := f"{machine.read_text()}# clearances of ours\n")
    with pytest.raises(InputError, match="is there already, and holds something else"):
        app(arguments, standalone_mode=False)
    assert machine.read_text() == edited


def test_a_page_overwrites_no_machine_file(tmp_path):
    file = tmp_path / "machine.toml"
    file.write_text(rig_toml())
    for arguments in (["report", "--rated", "3000rpm"], ["page"]):
        files = ["--rotor", str(file), "--out", str(file)]
        with pytest.raises(InputError, match="is there already, and is no page"):
            app([*arguments, *files], standalone_mode=False)
    assert file.read_text() == rig_toml()


def test_what_is_not_the_same_as_in_ross_is_said_wherever_a_file_is_read():
    said = []
    load_rotor(ROSS / "compressor.toml", said.append)
    notes = parse_ross((ROSS / "compressor.toml").read_text()).notes
    assert notes
    assert said == [f"{ROSS / 'compressor.toml'}: {note}" for note in notes]


def test_a_notebook_shows_a_table_and_a_picture():
    result = answers.modes(rig(), 100.0, count=2)
    assert isinstance(result, Modes)
    assert result._repr_html_().startswith("<table><caption>Modes at 15.915 Hz (100 rad/s)")
    assert result._repr_png_().startswith(PNG)


def test_speeds_are_read_in_any_unit():
    assert one_speed("-3e2") == -300
    assert one_speed("60 rpm") == pytest.approx(2 * math.pi)
    np.testing.assert_allclose(speed_range("0:10Hz:3", 9), [0, 10 * math.pi, 20 * math.pi])
    assert len(speed_range("0:10", 9)) == 9


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["modes", "--speed", "fast"], "--speed fast: must be a number"),
        (["modes", "--speed", "nan"], "--speed nan: must be a number"),
        (["modes", "--count", "0"], "--count 0: must be from 1"),
        (["modes", "--contacts", "ajar"], "contacts = ajar: must be one of open, pinned"),
        (["modes", "--rotor", "none.toml"], "none.toml: cannot be read"),
        (["campbell", "--speed", "10"], "--speed 10: must be FROM:TO"),
        (["campbell", "--speed", "10:5"], "FROM must be below TO"),
        (
            ["campbell", "--speed", "0:1e300"],
            "--speed 0:1e300: must be at most 1e+07 rad/s in size",
        ),
        (["modes", "--speed", "-1e300"], "--speed -1e300: must be at most 1e+07 rad/s in size"),
        (["campbell", "--speed", "0:5:1"], "POINTS must be an integer from 2 to 100000, not 1"),
        (["campbell", "--speed", "1:100:x"], "POINTS must be an integer from 2 to 100000, not x"),
        (["campbell", "--speed", "1:x:100"], "--speed 1:x:100: TO must be a finite number, not x"),
        (["campbell", "--speed", "1:9:3:4"], "1:9:3:4: must be FROM:TO or FROM:TO:POINTS"),
        (["campbell", "--speed", "1::3"], "--speed 1::3: must be FROM:TO or FROM:TO:POINTS"),
        (["campbell", "--speed", "0rpm:5Hz"], "must have one unit"),
        (["campbell", "--harmonic", "-1"], "harmonic = -1: must be > 0"),
        (["unbalance", "--unbalance", "5"], "--unbalance 5: must be NODE:AMOUNT"),
        (["unbalance", "--unbalance", "5:1g.m:up"], "--unbalance 5:1g.m:up: must be NODE:AMOUNT"),
        (["unbalance", "--unbalance", "5:1g.m:9mm"], "--unbalance 5: 9mm: must be an angle, in"),
        (["unbalance", "--node", "12"], "--node 12: must be from 1 to 8"),
        (["static", "--contacts", "open"], "the machine is not held"),
    ],
)
def test_impossible_wishes_are_refused(refusal, tmp_path, arguments, expected):
    said = refusal(*arguments)
    assert expected in said
    assert "\n" not in said
    assert not list(tmp_path.iterdir())


def test_a_file_extends_another(tmp_path):
    (tmp_path / "base.toml").write_text((ROSS / "compressor.toml").read_text())
    (tmp_path / "middle.toml").write_text(
        'extends = "base.toml"\nname = "rubbing"\n[[contact]]\nnode = 4\njournal_radius = 0.06\n'
        "clearance = 2e-4\nk = 1e8\nmu = 0.1\n"
    )
    (tmp_path / "top.toml").write_text(
        'extends = "middle.toml"\n[shaft]\neta_v = 1e-6\n[[point_mass]]\nnode = 1\nmass = 1.0\n'
        "[[seal]]\nnode = 2\nkxx = 1.0\nkyy = 1.0\ncxx = 1.0\ncyy = 1.0\n"
    )
    rotor = answers.rotor_of(tmp_path / "top.toml")
    assert (rotor.name, rotor.eta_v) == ("rubbing", 1e-6)
    kinds = [part.KIND for part in rotor.parts]
    assert [kinds.count(k) for k in ("contact", "seal", "point_mass", "body")] == [1, 2, 1, 2]


def test_of_a_table_that_is_extended_numbers_are_replaced_and_others_stay(tmp_path):
    parts = [{"node": 1, "e": 1.0}, {"node": 2, "e": 2.0}]
    base = {"shaft": {"nodes": [0, 1], "diameters": [0.1]}, "gravity": 9.81, "disc": parts[:1]}
    (tmp_path / "0.toml").write_text(toml_text(base))
    own = {"shaft": {"nodes": [0, 2]}, "gravity": 0.0, "disc": parts[1:]}
    for i in range(1, 10):
        text = toml_text({"extends": f"{i - 1}.toml"} | (own if i == 1 else {}))
        (tmp_path / f"{i}.toml").write_text(text)
    shaft = base["shaft"] | own["shaft"]
    assert tomllib.loads(machine_text("--rotor", tmp_path / "8.toml")) == own | {
        "shaft": shaft,
        "disc": parts,
    }
    with pytest.raises(InputError, match=r"1.toml: extends = '0.toml': goes round, or more than 8"):
        machine_text("--rotor", tmp_path / "9.toml")


def test_an_empty_list_leaves_none_of_the_parts_of_what_is_extended(tmp_path):
    (tmp_path / "base.toml").write_text(rig_toml())
    (tmp_path / "own.toml").write_text('extends = "base.toml"\ndisc = []\n')
    base, rotor = answers.rotor_of(tmp_path / "base.toml"), answers.rotor_of(tmp_path / "own.toml")
    assert [part.KIND for part in rotor.parts if part.KIND != "disc"] == [
        part.KIND for part in base.parts if part.KIND != "disc"
    ]
    assert len(rotor.parts) == len(base.parts) - 3


@pytest.mark.parametrize(
    ("base", "expected"),
    [
        ("own.toml", "goes round"),
        ("none.toml", "cannot be read"),
        (3, "must be the name of a file"),
    ],
)
def test_what_cannot_be_extended_is_refused(tmp_path, base, expected):
    own = tmp_path / "own.toml"
    own.write_text(toml_text({"extends": base}))
    with pytest.raises(InputError) as refused:
        machine_text("--rotor", own)
    assert expected in str(refused.value)


@pytest.mark.usefixtures("without_peaks")
@pytest.mark.parametrize(
    "angle", [*(pytest.param(at, marks=pytest.mark.slow) for at in ("90", "0.25turn")), "90deg"]
)
def test_unbalance_writes_every_speed_as_csv_with_units(command, tmp_path, angle):
    """The amplitudes are those of the answer; an unbalance may be given in g mm."""
    given = ("--speed", "20:40Hz:5", "--node", "5", "--unbalance", f"4:50g.mm:{angle}")
    command("unbalance", *given)
    head, *rows = (tmp_path / "out" / "unbalance.csv").read_text().splitlines()
    assert head.startswith("speed [rad/s],node[5].x [m],node[5].y [m],node[5].x_phase [rad]")
    speeds = np.linspace(40 * math.pi, 80 * math.pi, 5)
    result = answers.unbalance_response(rig(), speeds, unbalances=[(4, 5e-5, math.pi / 2)])
    numbers = np.array([list(map(float, row.split(","))) for row in rows])
    np.testing.assert_allclose(numbers[:, 0], speeds, rtol=1e-8)
    np.testing.assert_allclose(numbers[:, 1], np.abs(result.x[:, 4]), rtol=1e-8)
    np.testing.assert_allclose(numbers[:, 5], result.major[:, 4], rtol=1e-8)


def test_a_result_is_a_line_in_a_console():
    for result in (
        answers.modes(rig()),
        answers.static(rig()),
        answers.campbell(rig(), [0.0, 100.0]),
        answers.unbalance_response(rig(), [50.0, 100.0]),
        acceptance.critical_peaks(rig(), 300.0, [2]),
        frequency_answers.frequency_response(rig(), [50.0, 100.0], 2, [2]),
    ):
        assert "\n" not in repr(result)
        assert len(repr(result)) < 120
    for kind in (frequency_answers.Sensitivity, Balancing):
        assert kind.__repr__ is Displayed.__repr__


@pytest.fixture(scope="module")
def turbocharger():
    """A machine and where it becomes unstable."""
    rotor = load_rotor(TURBOCHARGER)[1]
    return rotor, answers.campbell(rotor, np.linspace(100.0, 1000.0, 7), count=2).threshold


@pytest.mark.parametrize("top", [1.01, pytest.param(20.0, marks=pytest.mark.slow)])
def test_the_threshold_of_stability_is_named_within_the_picture(turbocharger, top):
    """Of a rotor that becomes unstable at the end of the speeds, and soon after their beginning."""
    rotor, threshold = turbocharger
    result = answers.campbell(rotor, np.linspace(100.0, top * threshold, 5), count=2)
    figure = result.figure()
    figure.draw_without_rendering()
    (legend,) = figure.legends
    (text,) = (text for text in legend.texts if text.get_text().startswith("unstable above "))
    box = text.get_window_extent()
    assert figure.bbox.x0 < box.x0 < box.x1 < figure.bbox.x1


@pytest.mark.usefixtures("without_peaks")
@pytest.mark.parametrize(("top", "unstable"), [(0.9, 0), (1.1, 1)])
def test_a_response_beyond_the_threshold_of_stability_is_said_not_to_be_reached(
    turbocharger, command, top, unstable
):
    top *= turbocharger[1]
    rotor = ("--rotor", str(TURBOCHARGER))
    force = ("--force", "1", "--speed", f"{top}", "--frequency", "10:1000:2")
    both = ("frequency-response", *force), ("unbalance", "--speed", f"{0.9 * top}:{top}:2")
    for given in both if unstable else both[:1]:
        said = command(*given, *rotor)
        assert said.count(f"unstable at {speed_with_unit(top)}, where its steady") == unstable
        assert said.count("unstable") == unstable
        assert "oil films, each linearized where its journal rests at that speed" in said
        assert "follow a vibration at the frequency of rotation" not in said


@pytest.mark.parametrize(("kyy", "unstable"), [(-1e4, 1), (1e4, 0)])
def test_an_equilibrium_that_a_machine_leaves_is_said_to_be_unstable(
    command, tmp_path, kyy, unstable
):
    """On the negative stiffness of a magnet it rests above the bearing that bears it."""
    path = tmp_path / "magnet.toml"
    path.write_text(
        "[material]\nyoung = 2.1e11\ndensity = 7800.0\n[shaft]\nnodes = [0.0, 0.5]\n"
        "diameters = [0.05]\n[[support]]\nnode = 1\nstiffness = 1e6\n[[linear_bearing]]\n"
        f"node = 2\nkxx = 1e4\nkyy = {kyy}\ncxx = 10.0\ncyy = 10.0\n",
        encoding="utf-8",
    )
    said = command("static", "--rotor", str(path))
    assert said.count("its equilibrium at 0 Hz is unstable") == unstable
