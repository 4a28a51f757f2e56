"""`rotor-fmu bearing` of films over the load, its tables and pictures, and what is refused."""

import math
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.bearing_curves import bearing_curves
from rotor_fmu.model.linear import LinearError, campbell, static
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.linear_bearing import LinearBearing

from rotor_fmu.cli import app
from rotor_fmu.errors import InputError
from rotor_fmu.linear import answers, bearing_answers
from rotor_fmu.linear.bearing_columns import draw_lines
from rotor_fmu.plotting.figure_style import new_figure

from ..parts.films import film, heavy_shaft, in_films
from ..toml_text import table
from .bearing_machines import EXAMPLES, OIL, PNG, ROLLING, SQUEEZE, with_part

# --- coefficients for a linear bearing ---


@pytest.mark.usefixtures("drawn")
def test_a_damper_is_said_with_coefficients_that_a_linear_bearing_takes(command, tmp_path):
    table = tmp_path / "damper.toml"
    said = command(
        "bearing", "--rotor", str(SQUEEZE), "--speed", "250", "--load", "0", "--table", str(table)
    )
    assert "squeeze_film_damper[1]: rests at e/c = 0 under 0 N" in said
    assert (tmp_path / "out" / "bearing.png").read_bytes().startswith(PNG)
    text = SQUEEZE.read_text(encoding="utf-8").split("[[squeeze_film_damper]]")[0]
    linear = table.read_text()
    replaced = tmp_path / "replaced.toml"
    replaced.write_text(text + linear + linear.replace("z = 0.0", "z = 0.2"))
    roots = [answers.modes(path, 100.0) for path in (SQUEEZE, replaced)]
    np.testing.assert_allclose(roots[1].eigenvalues, roots[0].eigenvalues, rtol=1e-6)


def test_coefficients_of_a_bearing_that_is_placed_by_z_stand_where_it_does(command, tmp_path):
    """Its node is the third of the shaft as it is solved; the third of the file is elsewhere."""
    bare = heavy_shaft() + table("[linear_bearing]", z=0.03, kxx=1e7, kyy=1e7, cxx=0.0, cyy=0.0)
    placed, coefficients = tmp_path / "placed.toml", tmp_path / "coefficients.toml"
    placed.write_text(bare + film(1).replace("node = 1", "z = 0.17"))
    command("bearing", "--rotor", str(placed), "--speed", "300", "--table", str(coefficients))
    replaced = parse_rotor(bare + coefficients.read_text())
    nodes = [replaced.nodes[part.node - 1] for part in replaced.of_kind(LinearBearing)]
    assert nodes == pytest.approx([0.03, 0.17], rel=1e-12)


@pytest.mark.parametrize("tilting", [False, True])
def test_coefficients_of_pads_that_tilt_say_which_motion_they_are_for(tilting, command, tmp_path):
    """As a linear bearing they may call a machine stable that whirls in its pads."""
    shape = {"pads": [1.5708 * i for i in range(4)], "arc": 1.2, "preload": 0.3, "points": 16}
    films = "".join(film(node, tilting=tilting, **shape) for node in (1, 3))
    (tmp_path / "machine.toml").write_text(heavy_shaft() + films)
    coefficients = tmp_path / "coefficients.toml"
    given = ("--rotor", str(tmp_path / "machine.toml"), "--speed", "900")
    command("bearing", *given, "--table", str(coefficients))
    said = "# Pads follow at the frequency of rotation: right for unbalance, not for slower whirls."
    assert (said in coefficients.read_text()) == tilting


# --- oil films over the load ---


def test_a_film_over_its_load_is_that_of_each_load_and_whirls_below_its_threshold():
    """Where the mass that weighs the load is the critical one."""
    rotor = in_films()
    loads = np.linspace(50.0, 3000.0, 5)
    over = bearing_curves(rotor, [900.0], load=loads)
    for i, load in enumerate(loads):
        one = bearing_curves(rotor, [900.0], load=float(load))
        np.testing.assert_allclose(over.K[i], one.K[0], rtol=1e-9)
        assert over.eccentricity[i] == pytest.approx(one.eccentricity[0], rel=1e-9)
    assert over.threshold is None
    (threshold,) = over.turns
    at = bearing_curves(rotor, [900.0], load=threshold)
    assert at.critical_mass[0] == pytest.approx(threshold / 9.81, rel=1e-6)
    assert over.critical_mass[0] < loads[0] / 9.81
    with pytest.raises(LinearError, match="2 speeds and 5 loads: only one of them may vary"):
        bearing_curves(rotor, [900.0, 950.0], load=loads)


def test_a_mass_that_whirls_between_two_loads_is_said_to():
    """The threshold of a short film is least at 0.45 of the clearance: 2.54 sqrt(g / c), and 2.76
    where nothing bears."""
    speed = 2.65 * math.sqrt(9.81 / 1e-4)
    found = bearing_answers.bearing(in_films(), [speed], load=np.linspace(20.0, 2000.0, 40))
    low, high = found.turns
    for load in (low, high):
        at = bearing_curves(in_films(), [speed], load=load)
        assert at.critical_mass[0] == pytest.approx(load / 9.81, rel=1e-6)
    title = f"a mass that weighs its load whirls from {low:.6g} N to {high:.6g} N"
    assert found.table().title == f"journal_bearing[1]: {title}"
    lines = [line for line in found.figure().axes[2].lines if len(line.get_xdata()) == 2]
    assert [line.get_xdata()[0] for line in lines] == [low, high]
    light = bearing_answers.bearing(in_films(), [speed], load=np.array([low + 1.0, 2000.0]))
    assert light.table().title.endswith(f"its load whirls below {light.turns[0]:.6g} N")
    assert light.turns == pytest.approx([high], rel=1e-6)


def test_an_inclined_machine_whirls_from_the_speed_on_that_is_said():
    """Its bearings bear half of its weight and all of its mass: a stiff rotor on two alike whirls
    where the mass on each does."""
    rotor = replace(in_films(), inclination=math.radians(60.0))
    speeds = np.linspace(200.0, 1800.0, 9)
    level, found = (bearing_curves(of, speeds) for of in (in_films(), rotor))
    assert found.load[0, 1] == pytest.approx(0.5 * level.load[0, 1], rel=1e-6)
    assert found.mass == pytest.approx(level.mass, rel=1e-6)
    assert found.threshold == pytest.approx(campbell(rotor, speeds).threshold, rel=0.02)


def test_speeds_and_loads_in_any_order_have_the_same_threshold():
    speeds, loads = np.linspace(200.0, 1800.0, 5), np.linspace(50.0, 3000.0, 5)
    for back in (1, -1):
        over_speed = bearing_answers.bearing(in_films(), speeds[::back], load=200.0)
        assert " whirls above " in over_speed.table().title
        assert speeds[0] < over_speed.threshold < speeds[-1]
        over_load = bearing_answers.bearing(in_films(), [900.0], load=loads[::back])
        assert " whirls below " in over_load.table().title


def test_a_film_whose_journal_turns_backwards_whirls_as_its_mirror_image_does():
    ahead, back, both = (
        bearing_answers.bearing(in_films(), np.linspace(*ends), load=200.0)
        for ends in ((200.0, 1800.0, 5), (-1800.0, -200.0, 5), (-1800.0, 1800.0, 10))
    )
    assert both.threshold == pytest.approx(ahead.threshold, rel=1e-9)
    assert back.threshold == pytest.approx(-ahead.threshold, rel=1e-9)
    assert back.table().title == ahead.table().title
    assert " whirls above 1" in ahead.table().title
    place = ahead.table().heads.index("whirl [1]")
    shares = [[row[place] for row in of.table().rows] for of in (ahead, back)]
    np.testing.assert_allclose(shares[1][::-1], shares[0], rtol=1e-6)


def test_no_curve_leads_from_one_sense_of_rotation_to_the_other():
    rotor, speeds = in_films(), np.linspace(-1800.0, 1800.0, 10)
    ring = parse_rotor((EXAMPLES / "turbocharger" / "rotor.toml").read_text(encoding="utf-8"))
    for found in (
        bearing_answers.bearing(rotor, speeds, load=200.0),
        bearing_answers.floating_ring(ring, speeds, bearing="floating_ring_bearing[1]", load=1.0),
    ):
        lines = [line for axes in found.figure().axes for line in axes.lines]
        curves = [line for line in lines if len(line.get_xdata()) == 11]
        assert len(curves) >= 9
        for line in curves:
            gaps = [np.flatnonzero(np.isnan(of)).tolist() for of in line.get_data()]
            assert gaps == [[5], [5]]


def test_a_film_that_holds_no_mass_at_all_is_said_to_be_unstable_not_to_whirl():
    """Pads pivoted behind their middle: what leaves the equilibrium there has no frequency of
    whirl."""
    pads = {"pads": (0.21, 1.78, 3.35, 4.92), "arc": 1.09, "offset": 0.9, "tilting": True}
    pads |= {"pad_inertia": 1e-5}
    speeds, mass = [-400.0, -300.0], "journal_bearing[1]: a mass of 0.20387 kg on it"
    found = bearing_answers.bearing(in_films(**pads), speeds, load=2.0)
    assert not found.critical_mass.any()
    assert found.table().title.startswith(f"{mass} is unstable already above ")
    found = bearing_answers.bearing(in_films(**pads), [-300.0], load=[2.0, 3.0])
    assert found.table().title == "journal_bearing[1]: a mass that weighs its load is unstable"


def test_a_film_without_a_load_is_neither_judged_by_a_mass_nor_measured_by_its_load():
    """A vertical machine puts none on it: a mass of 0 kg whirls nowhere, and where the forces of
    the lobes cancel what is left of them is rounding."""
    lobes = in_films(pads=(0.5236, 2.618, 4.7124), arc=1.9, preload=0.5)
    found = bearing_answers.bearing(replace(lobes, inclination=math.pi / 2), [300.0])
    assert found.table().title == "journal_bearing[1]: it bears no load"
    assert np.isnan(found.plane_error).all()
    assert found.critical_mass[0] > 0.0


def test_a_journal_that_does_not_turn_lies_on_its_wall():
    found = bearing_curves(in_films(k=1e8), [0.0], load=200.0)
    assert found.y[0] == pytest.approx(-1e-4 + 1e-6 - 200.0 / 1e8, rel=1e-6)
    with pytest.raises(LinearError, match=r"at 0 rad/s: its load is 200 N, and its film carries 0"):
        bearing_curves(in_films(), [0.0], load=200.0)


# --- what is shown of pads and of the lubricant ---


def test_pads_that_tilt_are_drawn_where_they_stand_with_what_each_bears():
    machine = _with_film(pads=(0.7854, 2.3562, 3.927, 5.4978), arc=1.4, preload=0.3, tilting=True)
    found = bearing_answers.bearing(machine, [100.0, 300.0], load=200.0)
    assert found.tilts.shape == (2, 4, 2)
    pivots = np.array([0.7854, 2.3562, 3.927, 5.4978])
    # all pads together bear the load, each towards its pivot, but for the rounded angles
    borne = (found.pad_loads * np.exp(1j * pivots)).sum(axis=1)
    np.testing.assert_allclose(borne, -200j, atol=0.1)
    panels = found.figure().axes
    assert [axes.get_ylabel() for axes in panels[4:]] == ["Tilt [mrad]", "Load of a pad [N]"]
    for i, axes in enumerate(panels[4:]):
        values = (1e3 * found.tilts[:, :, 0] / 0.05, found.pad_loads)[i]
        for line, of_pad in zip(axes.lines, values.T, strict=True):
            np.testing.assert_array_equal(line.get_ydata(), of_pad)
    # a pad is where a journal would touch it: at its pivot it does not move as it tilts
    ends = [line.get_xydata() for line in panels[0].lines if len(line.get_xydata()) == 80]
    assert len(ends) == 8
    middles = [complex(*0.5 * (line[39] + line[40])) for line in ends]
    np.testing.assert_allclose(np.abs(middles), 1.0, atol=1e-3)
    assert len(bearing_answers.bearing(_with_film(), [100.0], load=200.0).figure().axes) == 4


@pytest.mark.parametrize("times", [1, 3])
def test_the_legend_of_coefficients_covers_no_line(times):
    """Of an elliptical bearing's stiffnesses, which lie all over the axes, or of as many lines as
    a bearing of twelve pads has."""
    over = np.linspace(50.0, 117.0, 9)
    ends = (4.5e7, 3.6e7), (1e7, 7.2e7), (-1.2e8, -1.2e8), (1.8e8, 2e8)
    figure, axes = new_figure(4.0, 3.4)
    lines = np.array([np.linspace(*of, 9) for of in ends] * times)
    draw_lines(axes, over, lines, [f"pad {n}" for n in range(len(lines))], "-")
    figure.draw_without_rendering()
    assert len({line.get_color() for line in axes.lines}) == len(lines)
    legend = axes.get_legend().get_window_extent()
    for line in axes.lines:
        path = axes.transData.transform_path(line.get_path())
        assert not path.intersects_bbox(legend, filled=False)


def test_viscosity_and_temperature_of_the_lubricant_are_shown():
    lists = {"viscosity": (0.04, 0.02, 0.01), "speed": (0.0, 200.0, 400.0)}
    over_speed = bearing_answers.bearing(_with_film(**lists), [0.0, 400.0][1:], load=200.0)
    assert over_speed.viscosity == pytest.approx([0.01])
    heat = {"temperature": (40.0, 60.0, 80.0), "static_load": 200.0}
    found = bearing_answers.bearing(_with_film(**lists, **heat), [200.0, 400.0], load=200.0)
    heads, rows = found.table().heads, found.table().rows
    assert heads[-2:] == ("viscosity [mPa.s]", "oil [degC]")
    for i, row in enumerate(rows):
        rise = found.power[i] / (860.0 * 2000.0 * found.flow[i])
        assert row[-1] == pytest.approx(40.0 + rise, abs=1e-3)
        assert 10.0 < row[-2] < 40.0
    constant = bearing_answers.bearing(_with_film(), [200.0, 400.0], load=200.0).table().heads
    assert constant[-1] == "off 2D [%]"


def _with_film(**more):
    given = {"journal_radius": 0.05, "length": 0.05, "clearance": 1e-4, "viscosity": 0.02}
    return with_part(JournalBearing(node=1, **{**given, **more}))


# --- refused ---


@pytest.mark.parametrize(
    ("file", "arguments", "expected"),
    [
        (OIL, [], "--speed: must be given, on which the film of journal_bearing[1] depends"),
        (
            ROLLING,
            ["--speed", "1:2", "--load", "1:2"],
            "--load 1:2: must be one where --speed 1:2 is a range",
        ),
        (ROLLING, ["--load", "0:2"], "--load 0: must be > 0"),
        (
            ROLLING,
            ["--load", "1:2kN", "--table", "a.toml"],
            "--load 1:2kN: must be one, for the speeds of --table",
        ),
        (ROLLING, ["--load", "heavy"], "--load heavy: must be a number, in N"),
        (SQUEEZE, [], "--speed: must be one above 0, of the orbits of squeeze_film_damper[1]"),
        (SQUEEZE, ["--speed", "3", "--load", "1:2"], "--load: must be one, under which"),
        (SQUEEZE, ["--speed", "3", "--load", "-1"], "--load -1: must be >= 0"),
        (SQUEEZE, ["--speed", "3", "--bearing", "a"], "--bearing a: must be one of squeeze_film"),
        (
            EXAMPLES / "drop" / "compressor.toml",
            ["--speed", "3"],
            "the machine has no [[journal_bearing]], [[squeeze_film_damper]], [[rolling_bearing]]",
        ),
    ],
)
def test_what_cannot_be_asked_is_refused(refusal, file, arguments, expected):
    assert expected in refusal("bearing", "--rotor", str(file), *arguments)


def test_a_table_is_not_written_over_the_machine_nor_where_something_else_cannot(tmp_path):
    machine, taken = tmp_path / "machine.toml", tmp_path / "taken"
    machine.write_text(OIL.read_text(encoding="utf-8"))
    taken.write_text("")
    before = sorted(tmp_path.iterdir())
    given = ["bearing", "--rotor", str(machine), "--speed", "300", "--quiet"]
    for target, out, expected in (
        (machine, tmp_path / "out", f"--table {machine}: is the machine's own file; give another"),
        (tmp_path, tmp_path / "out", f"--table {tmp_path}: is a folder; give the table's name"),
        (taken / "t.toml", tmp_path / "out", f"--table {taken}: cannot be written to: File exists"),
        (tmp_path / "t.toml", taken, f"--out {taken}: cannot be written to: File exists"),
    ):
        with pytest.raises(InputError) as refused:
            app([*given, "--table", str(target), "--out", str(out)], standalone_mode=False)
        assert str(refused.value).startswith(expected)
        assert sorted(tmp_path.iterdir()) == before
    assert machine.read_text() == OIL.read_text(encoding="utf-8")


@pytest.mark.parametrize("digits", [9, 6])
def test_a_bearing_of_a_vertical_machine_bears_no_load(digits):
    """Pads given to nine digits leave 1e-9 N of their forces, which other bearings bear, to six as
    much as weighs a milligram."""
    pads = (round((0.25 + 0.5 * i) * math.pi, digits) for i in range(4))
    films = film(1, tilting=True, pads=list(pads), arc=1.3, preload=0.3, pivot_stiffness=5e8)
    coefficients = {"kxx": 8e7, "kyy": 1.2e8, "kxy": 1.5e7, "kyx": -1.5e7, "cxx": 3e4, "cyy": 4e4}
    others = [
        table(f"[{kind}]", node=i, **coefficients)
        for kind, i in (("seal", 2), ("linear_bearing", 3))
    ]
    rotor = parse_rotor(heavy_shaft() + films + "".join(others))
    vertical = replace(rotor, inclination=math.pi / 2)
    found = bearing_answers.bearing(vertical, [200.0])
    assert found.table().title == "journal_bearing[1]: it bears no load"
    assert not found.load.any()
    at_rest = static(vertical, 200.0)
    assert not np.concatenate([at_rest.x, at_rest.y, at_rest.load_x, at_rest.load_y]).any()
