"""Units of tables and pictures, chosen once; the factors are the units' definitions."""

import itertools
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.text import Text
from rotor_fmu.model.linear import Static
from rotor_fmu.model.linear.frequency_response import ControlLoop
from rotor_fmu.model.machine.toml import rig, rig_toml

from rotor_fmu import parse
from rotor_fmu.api.result import Result
from rotor_fmu.balancing.result import Balancing, CorrectionPlane, ResidualUnbalance, Vibration
from rotor_fmu.display import (
    choose,
    current,
    display_of,
    restored,
)
from rotor_fmu.errors import InputError
from rotor_fmu.linear import acceptance, answers, bearing_answers, stability_answers
from rotor_fmu.linear.frequency_answers import frequency_response, sensitivity
from rotor_fmu.linear.mode_answers import mode_shapes_figure
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.run_pictures import run_folder, signal_plots
from rotor_fmu.run_pictures.signal_plots import bode, orbit
from rotor_fmu.run_pictures.view import View

from ..recordings import recorded

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_us_units_are_by_definition_and_words_go_together():
    us, mixed = display_of("--units", "us"), display_of("--units", "rpm, um, PP")
    assert (us.speed_unit, us.small_unit, us.length_unit) == ("rpm", "mil", "in")
    assert us.speed * 100 * math.pi == pytest.approx(3000)
    ones = [us.small * 25.4e-6, us.length * 0.0254, us.mass * 0.45359237]
    assert ones == pytest.approx([1, 1, 1])
    assert us.force * 4.4482216152605 == pytest.approx(1)
    # lbf/in, lbf.s/in, lbf.in, psi, oz.in: NIST SP 811, appendix B
    others = [us.stiffness * 175.1268, us.damping * 175.1268, us.torque * 0.1129848]
    assert [*others, us.pressure * 6894.757, us.unbalance * 7.200778e-4] == pytest.approx(
        5 * [1], rel=1e-6
    )
    assert mixed.amplitude == pytest.approx(2e6)
    assert mixed.amplitude_unit == "µm pp"


@pytest.mark.parametrize("text", ["pp,0-p", "rpm, Hz", "mil um", "us, si"])
def test_two_units_of_one_quantity_are_refused(text):
    with pytest.raises(InputError, match=f"^--units {text}: '.*' and '.*' are units of the same$"):
        display_of("--units", text)


def test_a_word_beside_a_system_of_units_acts_wherever_it_stands():
    assert display_of("--units", "Hz, us") == display_of("--units", "us, Hz, hz")
    assert display_of("--units", "Hz, us").speed_unit == "Hz"


def test_a_word_that_is_none_is_refused_with_its_nearest():
    with pytest.raises(
        InputError, match=r"--units mils: 'mils' must be one of .*did you mean mil\?"
    ):
        choose("mils")


def test_a_word_of_a_machine_file_that_is_none_is_refused_with_the_file(refusal, tmp_path):
    (tmp_path / "m.toml").write_text(f'units = "furlong"\n{rig_toml()}')
    assert "m.toml: units = furlong: 'furlong' must be one of" in refusal(
        "modes", "--rotor", str(tmp_path / "m.toml")
    )


def test_show_lists_a_machine_in_us_units_and_the_next_command_in_its_own(command):
    text = command("show", "--units", "us")
    assert "zigulic2003: 8 nodes, 12.992 in, 12.4" in text
    assert "z [in]" in text
    assert "zigulic2003: 8 nodes, 330 mm, 5.6" in command("show")


def test_show_names_housings_as_bearings_do(command):
    text = command("show", "--rotor", str(EXAMPLES / "drop" / "compressor.toml"))
    (line, *_) = (line for line in text.splitlines() if "housing[1]" in line)
    assert " left, a mass on springs and dampers" in line


@pytest.mark.usefixtures("without_peaks")
def test_the_machine_file_may_say_the_units(command, tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(f'units = "rpm, mil, pp"\n{rig_toml()}')
    given = ("--rotor", str(file), "--speed", "30Hz", "--node", "5")
    mine, si = command("unbalance", *given), command("unbalance", *given, "--units", "si")
    assert "x [mil pp]" in mine
    assert "x [um 0-p]" in si
    numbers = [[float(word) for word in text.splitlines()[2].split()] for text in (mine, si)]
    assert numbers[0][2] == pytest.approx(60 * numbers[1][2], rel=1e-4)
    assert numbers[0][3] == pytest.approx(2 / 25.4 * numbers[1][3], rel=1e-3)


def test_the_check_by_api_617_balancing_and_compliance_are_in_the_units_chosen(command):
    """0.001 inch is 25.4 um, and a pound-force 4.4482216152605 N."""
    given = ("--speed", "100:300:9", "--node", "4", "--range", "100:200")
    assert _column(command("unbalance", *given, "--units", "us"), "mil") == pytest.approx(
        [um / 25.4 for um in _column(command("unbalance", *given), "um")], rel=1e-3
    )
    given = ("--force", "4", "--frequency", "50:400:9")
    mine = command("frequency-response", *given, "--units", "us")
    si = command("frequency-response", *given)
    assert _column(mine, "mil/lbf") == pytest.approx(
        [um / 25.4 * 4.4482216152605 for um in _column(si, "um/N")], rel=1e-3
    )


@pytest.fixture(scope="module")
def of_rig():
    """Answers of every kind that the rig has."""
    gains = {"kp": 100.0, "kd": 1.0, "force_per_current": 50.0, "amplifier_time": 1e-4}
    return [
        acceptance.critical_map(rig(), [1e6, 1e7, 1e9], count=2),
        stability_answers.level_1(rig(), 100.0, node=4, anticipated=1e5, stiffness=[0.0, 1e5]),
        stability_answers.level_2(rig(), 100.0, cross_couplings={4: 1e5}),
        acceptance.critical_peaks(rig(), 400.0, [4]),
        acceptance.unbalance_check(rig(), 100.0, 200.0, [4]),
        answers.modes(rig(), 100.0, count=2),
        answers.static(rig(), contacts="pinned"),
        frequency_response(rig(), np.linspace(10.0, 300.0, 9), 4, nodes=[4]),
        sensitivity(rig(), [10.0, 100.0], [ControlLoop("magnet", 2, 2, **gains)]),
    ]


def test_no_answer_mixes_si_units_into_those_that_were_chosen(of_rig):
    """Columns in rad/s stand beside those of the unit chosen; all else is in it."""
    si = re.compile(r"Hz|rev/min|\bN\b|N/m|N\.|\bum\b|µm|\bmm\b|g\.mm|MPa|\bkg\b")
    for result in (*of_rig, *_others()):
        with restored():
            choose("us")
            table, figure = result.table(), result.figure()
        texts = [table.title, *table.heads, *(str(cell) for row in table.rows for cell in row)]
        texts += [text.get_text() for text in figure.findobj(Text)]
        assert [text for text in texts if si.search(text)] == []


def _others():
    """Answers of the other kinds that have units."""
    oil, squeeze, rolling = (
        load_rotor(EXAMPLES / name / "rotor.toml")[1]
        for name in ("oil_film", "squeeze_film", "rolling_bearing")
    )
    yield bearing_answers.bearing(oil, [300.0, 400.0], bearing="journal_bearing[1]")
    yield bearing_answers.damper(squeeze, 250.0, bearing="squeeze_film_damper[1]")
    yield bearing_answers.rolling(rolling, bearing="left", load=np.array([100.0, 200.0]))
    planes = (CorrectionPlane(4, 1e-4 + 0j, 2e-4j),)
    vibrations = (Vibration(4, "x", 100.0, 1e-5, 0j, 1e-6),)
    residuals = (ResidualUnbalance(2, 3.0, 1e-4j, 1e-5j, 1e-5, 2.5),)
    numbers = {"influence": np.ones((1, 1)), "rank": 1, "touches": False, "settles": False}
    yield Balancing(planes, vibrations, residuals, service_speed=200.0, messages=(), **numbers)


def _column(text, head):
    """Numbers below a head of a table with two spaces between its columns."""
    lines = [re.split(r" {2,}", line.strip()) for line in text.splitlines()]
    at = next(i for i, line in enumerate(lines) if head in line)
    rows = itertools.takewhile(lambda line: len(line) == len(lines[at]), lines[at + 1 :])
    return [float(row[lines[at].index(head)]) for row in rows]


def test_pictures_are_in_the_units_that_were_chosen():
    with restored():
        choose("rpm,mil,pp")
        view = View(recorded().named("one"))
        above, below = bode(view).axes
        round_about = orbit(view).axes[0]
        response = answers.unbalance_response(rig(), np.linspace(10.0, 300.0, 20)).figure().axes
    assert current().speed_unit == "Hz"
    assert above.get_ylabel() == "Amplitude [mil pp]"
    assert below.get_xlabel() == "Rotational speed n [rpm]"
    assert round_about.get_xlabel() == "Horizontal displacement of disc 2 [mil]"
    # 1x of x is |80 exp(-0.6 i) + 20| um 0-p
    drawn = above.lines[0].get_ydata()
    assert np.nanmedian(drawn) == pytest.approx(abs(80 * np.exp(-0.6j) + 20) * 2 / 25.4, rel=1e-3)
    assert response[0].get_ylabel() == "Amplitude [mil pp]"
    assert response[0].get_title("left").startswith("zigulic2003: Steady response")
    assert response[0].get_xlim()[1] > 2000


def test_a_machine_s_own_units_are_shown_in_python_unless_others_are_chosen():
    """A file that says rpm and mil, in the pictures and tables of the Python interface."""
    text = 'units = "rpm, mil, pp"\n' + rig_toml()
    of_run = Result(recorded(toml=text))
    response = parse(text).unbalance_response([10.0, 20.0], contacts="pinned")
    assert response.figure().axes[0].get_ylabel() == "Amplitude [mil pp]"
    assert "[mil pp]" in response._repr_html_()
    assert of_run.plot("bode").axes[0].get_ylabel() == "Amplitude [mil pp]"
    assert "; speed: 2865 to 1719 rpm" in repr(of_run)
    assert "; speed: 300 to 180 rad/s" in repr(Result(recorded()))
    with restored():
        choose("Hz")
        assert response.figure().axes[0].get_ylabel() == "Amplitude [µm 0-p]"
        assert of_run.plot("bode").axes[0].get_ylabel() == "Amplitude [µm 0-p]"
    assert current() == display_of("", "")


def test_pictures_of_contacts_and_spectra_are_in_the_units_chosen_under_the_machine_s_name():
    """The run begins at 300 rad/s, 2865 rpm, and the contact presses with 5 N."""
    recording = recorded()
    with restored():
        choose("us")
        view = View(recording.named("one"))
        angles = run_folder.journal_angle(recording, "").axes[0]
        above = signal_plots.contact_force(view).axes[0]
        once = run_folder.spectra(recorded(rate=0.0), "disc[2]", "").axes[0]
        lines = signal_plots.spectrum(view).axes[0]
    heat = angles.collections[0].get_coordinates()
    assert heat[..., 0].max() == pytest.approx(300.0 * 30 / np.pi, rel=1e-2)
    assert above.get_ylabel() == "Normal force [lbf]"
    assert np.nanmax(above.lines[0].get_ydata()) == pytest.approx(5.0 / 4.4482216, rel=1e-6)
    assert once.get_xlabel() == "Frequency [cpm]"
    largest = max(once.lines[:2], key=lambda line: line.get_ydata().max())
    at = largest.get_xdata()[np.argmax(largest.get_ydata())]
    assert at == pytest.approx(300.0 * 30 / np.pi, rel=2e-2)
    assert {axes.get_title("left").split(":")[0] for axes in (above, lines)} == {"closed form"}
    # nothing is there beyond 1x
    assert lines.get_xlim()[1] < 3.5 * 3000


def test_mode_shapes_in_space_are_whole_and_in_the_units_chosen():
    """Of a mode that is normalized by its largest displacement in x and y together."""
    result = answers.modes(rig(), 100.0)
    with restored():
        choose("us")
        axes = mode_shapes_figure(result).axes
    for i, each in enumerate(axes):
        assert each.get_xlabel() == "z [in]"
        assert each.get_title().startswith(f"{i + 1}: ")
        assert " cpm, " in each.get_title()
        assert not any(line.get_clip_on() for line in each.lines)
        drawn = np.concatenate([np.concatenate(line.get_data_3d()[1:]) for line in each.lines])
        assert np.abs(drawn).max() <= each.get_ylim()[1] == each.get_zlim()[1]


def test_every_picture_of_a_machine_has_its_name_and_a_static_one_what_bears_it(of_rig):
    (at_rest,) = (each.figure().axes[0] for each in of_rig if isinstance(each, Static))
    pictures = [
        at_rest,
        *(each.figure().axes[0] for each in of_rig if not isinstance(each, Static)),
        answers.campbell(rig(), np.linspace(10.0, 300.0, 5)).figure().axes[0],
        mode_shapes_figure(answers.modes(rig(), 100.0)).axes[0],
    ]
    for axes in pictures:
        titles = axes.get_title("left"), axes.figure.get_suptitle()
        assert any(title.startswith("zigulic2003: ") for title in titles), titles
    named = [text.get_text() for text in at_rest.texts if text.get_text()]
    assert [text.partition(" ")[0] for text in named] == ["bearing[1]", "bearing[2]"]


def test_the_table_of_a_study_is_in_the_units_that_were_chosen(command, tmp_path):
    (tmp_path / "rig.toml").write_text(f'units = "rpm, mil"\n{rig_toml()}')
    (tmp_path / "study.toml").write_text(
        'machine = "rig.toml"\n[run]\nkind = "constant"\nspeed = 100.0\nsettle = 0.05\n'
        'turns = 2\n[vary]\n"bearing[1].clearance" = { values = [4e-5, 6e-5] }\n'
        '"disc[1].phase" = { values = ["0 deg"] }\n'
        '[keep]\npeak = { peak = "disc[1].r" }\n[limits]\npeak = 1.0\n'
    )
    given = ("study", str(tmp_path / "study.toml"), "--jobs", "1", "--analyse")
    mil, um = command(*given), command(*given, "--units", "si")
    assert "bearing[1].clearance [mil]" in mil
    assert "disc[1].phase [deg]" in mil  # as the file says it
    assert "peak > 39370.1 mil" in mil
    assert "peak > 1e+06 um" in um
    small, large = ([float(v) for v in re.findall(r"(\d+\.\d+) ok", text)] for text in (mil, um))
    assert small == pytest.approx([um / 25.4 for um in large], rel=1e-3)
    assert len(small) == 2


def test_json_stays_in_si(command):
    one, two = (json.loads(command("show", "--json", *more)) for more in ((), ("--units", "us")))
    assert one == two
