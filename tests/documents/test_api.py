"""The Python interface: what its pages say runs, and its numbers are those of the rest."""

import doctest
import importlib
import re
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.time_loop.recorder import recordable

import rotor_fmu as rf

from ..processes import run_anew

MODULES = (
    "api.linear_analyses",
    "api.machine",
    "api.simulate",
    "api.fmus",
    "api.recorded_signals",
    "api.peaks",
    "api.result",
    "errors",
)
PAGE = Path(__file__).parents[2] / "docs" / "reference" / "api.md"
RIG = rf.load()


@pytest.mark.parametrize("name", MODULES)
def test_the_examples_of_the_docstrings_run(name):
    module = importlib.import_module(f"rotor_fmu.{name}")
    outcome = doctest.testmod(module)
    assert outcome.attempted
    assert not outcome.failed


def test_every_public_name_is_documented_with_an_example_that_runs():
    """In its docstring, which the page of the names shows."""
    page = PAGE.read_text(encoding="utf-8")
    for name in rf.__all__:
        thing = getattr(rf, name)
        if name == "__version__":
            continue
        tests = doctest.DocTestFinder(recurse=False).find(thing, name)
        assert any(test.examples for test in tests), name
        assert re.search(rf"^\.\. auto\w+:: rotor_fmu\.{name}$", page, re.MULTILINE), name
    assert set(dir(rf)) == set(rf.__all__)
    with pytest.raises(AttributeError, match="no attribute 'simulat'"):
        _ = rf.simulat


def test_what_is_not_used_is_not_imported():
    script = "import sys, rotor_fmu; print(*{name.partition('.')[0] for name in sys.modules})"
    done = run_anew(script)
    assert done.returncode == 0, done.stderr
    heavy = {"numba", "numpy", "scipy", "matplotlib", "fmpy", "pandas", "xarray", "bokeh", "rich"}
    assert not heavy & set(done.stdout.split())


@pytest.fixture(scope="module")
def result():
    """A second in the rig's resonance, with a load."""
    return rf.simulate(
        RIG, speed=([0, 1], [190, 180]), loads={"disc[2].fy": ([0, 0.5], [0, 2])}, step=0.02
    )


def test_a_run_is_recorded_with_its_units(result):
    assert result.status == "ok"
    assert result.t[0] == 0.0
    assert result.t[-1] == pytest.approx(1.0, abs=1e-3)
    assert result["w"] == pytest.approx(190 - 10 * result.t, abs=1e-9)
    assert result["phi"] == pytest.approx(190 * result.t - 5 * result.t**2, abs=1e-7)
    assert set(result.units) == set(result.names) <= set(RIG.units)
    assert {str(entry.name) for entry in recordable(RIG.rotor)} == set(RIG.units)
    # a load of 2 N is held after the last time that was given
    assert result.points.columns["energy.external_work"][-1] != 0


def test_tables_hold_the_signals_and_their_units(result):
    frame, data = result.dataframe(), result.dataset()
    assert np.array_equal(frame.index, result.t)
    assert np.array_equal(data["t"], result.t)
    for name in result.names:
        assert np.array_equal(frame[name], result[name])
        assert np.array_equal(data[name], result[name])
        assert data[name].attrs["units"] == frame.attrs["units"][name] == RIG.units[name]


def test_orbit_spectrum_and_orders_are_those_of_the_part_named(result):
    z = result["disc[3].x"] + 1j * result["disc[3].y"]
    orbit = result.orbit("disc[3]", speed=185.0)
    assert orbit.speed == pytest.approx(185, abs=1)
    assert np.abs(orbit.z).max() <= np.abs(z).max() * 1.001
    assert np.abs(orbit.z - result.orbit("disc[1]", speed=185.0).z).max() > 1e-6
    track = result.orders("disc[3]", [1.0])
    spectrum = result.spectrum("disc[3]", 185.0)
    near = np.argmin(np.abs(spectrum.order - 1.0))
    at = np.argmin(np.abs(track.speed - 185.0))
    assert spectrum.amplitude[near] == pytest.approx(abs(track.forward[at, 0]), rel=0.05)


@pytest.mark.parametrize(
    ("ask", "expected"),
    [
        (lambda run: run.orbit(speed="190"), "speed = '190': must be a number"),
        (lambda run: run.spectrum(speed=[190]), r"speed = \[190\]: must be a number"),
        (lambda run: run.plot("orbit", speed="190"), "speed = '190': must be a number"),
        (lambda run: run.orders(orders=1.0), "orders = 1.0: must be a list of numbers"),
        (lambda run: run.orders(orders=["1x"]), r"orders = \['1x'\]: must be a list of numbers"),
    ],
)
def test_what_a_result_cannot_be_asked_is_refused_in_one_line(result, ask, expected):
    with pytest.raises(rf.InputError, match=f"^{expected}$"):
        ask(result)


def test_a_result_comes_back_from_its_folder(result, tmp_path):
    result.save(tmp_path)
    outcome = rf.read_run(tmp_path)
    assert outcome.machine.toml == RIG.toml
    assert outcome.units == result.units
    assert np.array_equal(outcome["disc[3].x"], result["disc[3].x"])
    assert np.array_equal(outcome.orbit().z, result.orbit().z)


def test_notebooks_are_shown_a_picture_and_the_facts(result):
    assert RIG._repr_png_().startswith(b"\x89PNG")
    shown = result._repr_html_()
    assert "zigulic2003" in shown
    assert "data:image/png;base64," in shown
    assert "190 to 180 rad/s" in repr(result)
    assert result.plot("orbit", speed=185.0).axes


def test_every_step_is_recorded_without_a_rate():
    run = rf.simulate(RIG, speed=185.0, stop=0.1, record=["disc[1].vx"], per_turn=None)
    assert len(run.t) == run.points.columns["solver.steps"][-1] + 1
    assert run.names == ("phi", "w", "disc[1].vx")


def test_a_run_beyond_the_machines_speeds_has_a_row_for_every_turn_too():
    run = rf.simulate(RIG, speed=-4000.0, stop=0.1)
    turns = np.abs(np.diff(run.points.columns["phi"])) / (2 * np.pi)
    assert 0.9 < turns.max() < 1.0 + 1e-9


def test_a_run_that_fails_keeps_what_came_before_and_says_why():
    wbz = {"solver.method": "wbz", "solver.alpha_m": 0.08}
    with pytest.warns(UserWarning, match="is unstable|diverged"):
        run = rf.simulate(RIG, speed=400.0, stop=1.0, preset="paper", parameters=wbz)
    assert run.status.startswith("failed")
    assert 0.05 < run.t[-1] < 0.2


def test_an_fmu_gives_the_numbers_of_the_run_without_it(tmp_path):
    options = {"speed": ([0, 0.1], [190, 189]), "step": 0.01, "preset": "robust"}
    fmu = rf.build_fmu(RIG, tmp_path)
    through, direct = rf.simulate_fmu(fmu, **options), rf.simulate(RIG, **options)
    assert through.status == "ok"
    assert np.array_equal(through.t, direct.points.t)
    for name in through.names:
        assert np.array_equal(through[name], direct.points.columns[name]), name
    assert through.machine.toml == RIG.toml


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """The rig's FMU in Python, and the native one."""
    kinds = ({}, {"is_native": True, "platforms": ["linux64"]})
    return [rf.build_fmu(RIG, tmp_path_factory.mktemp("fmu"), **kind) for kind in kinds]


BRIEF = {"speed": ([0, 0.1], [190, 189]), "step": 0.01, "preset": "robust"}


@pytest.fixture(scope="module")
def whole():
    """A run that no limit ends, at each of its steps."""
    return rf.simulate(RIG, **BRIEF, per_turn=None)


@pytest.mark.parametrize("name", ["limit.displacement", "limit.force", "limit.contact"])
def test_a_limit_ends_a_run_before_the_first_step_beyond_it_as_it_ends_the_fmus(fmus, whole, name):
    moved = np.max([np.hypot(whole[f"disc[{i}].x"], whole[f"disc[{i}].y"]) for i in (1, 2, 3)], 0)
    force = np.max(
        [np.hypot(whole[f"bearing[{i}].fn"], whole[f"bearing[{i}].ft"]) for i in (1, 2)], 0
    )
    closed = np.array([whole[f"bearing[{i}].fn"] > 0 for i in (1, 2)])
    changes = np.flatnonzero((closed[:, 1:] != closed[:, :-1]).any(axis=0))
    value, last = {
        "limit.displacement": (0.9 * moved.max(), np.argmax(moved > 0.9 * moved.max()) - 1),
        "limit.force": (0.9 * force.max(), np.argmax(force > 0.9 * force.max()) - 1),
        "limit.contact": ("true", changes[0] + 1),
    }[name]
    options = {**BRIEF, "parameters": {name: value}}
    with pytest.warns(UserWarning, match="passes limit|closed|opened"):
        direct = rf.simulate(RIG, **options, per_turn=None)
    assert direct.t[-1] == whole.t[last]
    assert direct.status.startswith(f"failed: t = {whole.t[last]:.9g} s: ")
    for fmu in fmus:
        with pytest.warns(UserWarning, match="passes limit|closed|opened"):
            through = rf.simulate_fmu(fmu, **options)
        assert through.status == direct.status
        assert through.t == pytest.approx(0.01 * np.arange(len(through.t)))
        assert through.t[-1] < direct.t[-1] < through.t[-1] + 0.01


def test_sensitivities_that_were_asked_for_are_those_of_the_fmu(fmus):
    options = {**BRIEF, "parameters": {"solver.sensitivities": "true"}}
    direct = rf.simulate(RIG, **options)
    through = rf.simulate_fmu(fmus[0], **options)
    for name in through.names:
        assert np.array_equal(through[name], direct.points.columns[name]), name
    assert direct.points.columns["disc[2].dx_dfx"][-1] > 0


def test_an_array_of_no_dimension_is_a_number():
    of_array = rf.simulate(RIG, speed=np.array(100.0), stop=np.array(0.05), step=np.array(0.01))
    plain = rf.simulate(RIG, speed=100.0, stop=0.05, step=0.01)
    assert np.array_equal(of_array["disc[3].x"], plain["disc[3].x"])


def test_a_signal_that_was_not_recorded_is_told_its_neighbour(result):
    with pytest.raises(KeyError, match=r"disc\[3\]\.xx.*did you mean disc\[3\]\.v?x"):
        result["disc[3].xx"]


@pytest.mark.parametrize(
    ("speed", "stop", "why"),
    [
        (([0, 1], [60, 55]), None, "the largest displacement is at an edge of the run"),
        (150.0, 2.5, "the speed is constant"),
        (([0, 3], [60, 50]), None, "the largest displacement is at an edge of the run"),
    ],
)
def test_peaks_that_are_none_say_why(speed, stop, why):
    peaks = rf.simulate(RIG, speed=speed, stop=stop, tolerance=1e-2).peaks
    assert peaks == ()
    assert peaks.why == why
    assert str(peaks) == f"no peaks: {why}"


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"kind": "energy", "place": "disc[2]"}, "place: changes no plot energy, only bode, "),
        ({"kind": "bode", "speed": 100.0}, "speed: changes no plot bode, only orbit, spectrum"),
        ({"kind": "orbit", "is_pp": True}, "is_pp: changes no plot orbit, only bode, polar, "),
        ({"kind": "orbit", "place": "disk[2]"}, r"place = disk\[2\]: the recording has no such "),
        ({"kind": "energy"}, "the run: its recording has no energy that was dissipated"),
        ({"kind": "contact-force"}, "the run: its recording has no contact"),
    ],
)
def test_a_picture_that_cannot_be_says_why(arguments, expected):
    run = rf.simulate(RIG, speed=185.0, stop=0.2, record=["disc[2].x", "disc[2].y"])
    with pytest.raises(rf.InputError, match=f"^{expected}"):
        run.plot(**arguments)


def test_peaks_of_a_run_read_from_its_folder_say_that_they_are_not_kept(result, tmp_path):
    result.save(tmp_path)
    assert "read from its folder" in str(rf.read_run(tmp_path).peaks)


def test_pictures_of_a_constant_speed_have_an_axis_of_speeds_that_can_be_read():
    """Not one that ends at rounding, 1e-11 beyond an offset."""
    run = rf.simulate(RIG, speed=185.0, stop=1.0)
    low, high = run.plot("bode").axes[1].get_xlim()
    speed = 185.0 / (2 * np.pi)
    assert (low, high) == pytest.approx((0.99 * speed, 1.01 * speed), rel=1e-6)
    bar = run.plot("poincare").axes[1]
    ends = sorted(bar.get_ylim())
    assert len([tick for tick in bar.get_yticks() if ends[0] <= tick <= ends[1]]) > 2
