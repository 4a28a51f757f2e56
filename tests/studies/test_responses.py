"""Studies whose runs are periodic responses, and diagrams with these under their sections."""

import json
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from rotor_fmu import studies
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.machine_studies.diagram import _points, _response, diagrams
from rotor_fmu.machine_studies.machine_runs import MachineRuns
from rotor_fmu.machine_studies.machine_tables import read_study
from rotor_fmu.machine_studies.run_excitation import Excitation
from rotor_fmu.machine_studies.run_kinds import CONSTANT
from rotor_fmu.periodic import request
from rotor_fmu.studies.runner import run_study
from rotor_fmu.studies.store import open_dataset

from ..periodic.machines import OMEGA, ZETA, E, rub
from .functions import here, quiet

EXAMPLES = Path(__file__).parents[2] / "examples"
JEFFCOTT = "jeffcott_rub/jeffcott.toml"
RUN = "kind = 'response'\nfrom = 110\nto = 240"
SHORT = "kind = 'response'\nfrom = 180\nto = 240"
KEEP = """
fold = { bifurcation = "fold" }
end = { bifurcation = "grazing", which = "highest" }
doubled = { bifurcation = "period doubling" }
peak = { peak = "disc.r_amp" }
here = { value = "disc.r_amp", at = 140 }
curve = { amplitude = "disc.r_amp", bins = { from = 110, to = 240, count = 65 } }
speed = { curve = "parameter" }
r = { curve = "disc.r_amp" }
stable = { curve = "stable" }
"""


def unseen(length, shown):
    """No progress."""
    return nullcontext(lambda label, point: None)


def read(folder, run=RUN, keep=KEEP, vary='"contact[1].mu" = { values = [0.02, 0.05] }', more=""):
    path = folder / "study.toml"
    path.write_text(f"machine = '{JEFFCOTT}'\n{more}[run]\n{run}\n[vary]\n{vary}\n[keep]\n{keep}\n")
    return read_study(path)


@pytest.fixture(scope="module")
def data(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    run_study(read(folder, f"{RUN}\nlength = 0.2"), folder / "out", here, quiet)
    return studies.open(folder / "out")


def test_a_range_of_negative_speeds_is_a_run_too(tmp_path):
    """Of a machine that is alike in both senses, which touches nothing at half its natural
    frequency."""
    run = "kind = 'response'\nfrom = -52\nto = -48"
    keep = 'here = { value = "disc.r_amp", at = -50 }'
    study = read(tmp_path, run, keep, '"contact[1].mu" = { values = [0.02] }')
    run_study(study, tmp_path / "out", here, quiet)
    row = studies.open(tmp_path / "out").isel(run=0)
    assert row.status == "ok"
    omega = 50 / OMEGA
    radius = 1e-3 * E * omega**2 / abs(1 - omega**2 + 2j * ZETA * omega)
    assert float(row.here) == pytest.approx(radius, rel=1e-5)


@pytest.mark.parametrize(("i", "mu"), [(0, 0.02), (1, 0.05)])
def test_a_run_is_a_response_with_the_folds_and_radii_of_the_closed_form(data, i, mu):
    row = data.isel(run=i)
    assert row.status == "ok"
    fold = float(row.fold) / OMEGA
    assert rub(fold * (1 - 1e-5), mu) > 1
    with pytest.raises(ValueError, match="domain"):
        rub(fold * (1 + 1e-5), mu)
    assert float(row.here) == pytest.approx(1e-3 * rub(1.4, mu), rel=1e-6)
    assert np.isnan(float(row.doubled))
    assert float(row.end) / OMEGA == pytest.approx(1.385, rel=1e-3)
    # the largest of the rub before its end, at which the motion is still stable
    speeds = np.linspace(1.0, fold * (1 - 1e-6), 4000)
    largest = max(rub(s, mu) for s in speeds)
    assert float(row.peak) == pytest.approx(1e-3 * largest, rel=1e-3)


def test_a_curve_over_bins_is_the_largest_stable_motion_in_each(data):
    row = data.isel(run=1)
    middles = row["curve parameter"].values
    for speed, r in zip(middles, row.curve.values, strict=True):
        if 112 < speed < 190:
            near = max(rub((speed + d) / OMEGA) for d in (-1, 0, 1))
            assert r == pytest.approx(1e-3 * near, rel=2e-3)
        if speed > 204:
            assert r < 1e-3


def test_the_whole_curve_is_there_with_its_unstable_points(data):
    row = data.isel(run=1)
    known = np.isfinite(row.r.values)
    speed, r, stable = (row[n].values[known] for n in ("speed", "r", "stable"))
    assert {0.0, 1.0} == set(stable)
    unstable = (stable == 0) & (speed > 140) & (speed < 202)
    for s, value in zip(speed[unstable], r[unstable], strict=True):
        assert value == pytest.approx(1e-3 * rub(s / OMEGA, sign=-1), rel=1e-6)


def test_another_parameter_is_gone_over_at_one_speed(tmp_path):
    study = read(
        tmp_path,
        "kind = 'response'\nover = 'contact[1].mu'\nfrom = 0.0\nto = 0.1\nspeed = 140",
        'mu = { curve = "parameter" }\nr = { curve = "disc.r_amp" }\n'
        'here = { value = "disc.r_amp", at = 0.05 }',
        '"run.speed" = { values = [140] }',
    )
    run_study(study, tmp_path / "out", here, quiet)
    row = studies.open(tmp_path / "out").isel(run=0)
    assert study.model.columns[0].unit == "1"
    assert study.model.columns[2].text == "largest of the stable motions at 0.05, of disc.r_amp"
    assert row.mu.values.min() == 0.0
    assert row.mu.values.max() == 0.1


def test_a_run_of_what_no_machine_can_be_is_a_failed_row(tmp_path):
    study = read(
        tmp_path,
        SHORT,
        keep='fold = { bifurcation = "fold" }',
        vary='"run.harmonics" = { values = [3, 900] }',
    )
    run_study(study, tmp_path / "out", here, quiet)
    status = studies.open(tmp_path / "out").status.values.astype(str)
    assert status[0] == "ok"
    assert status[1].startswith("failed: harmonics = 900")


def test_the_text_of_a_value_has_the_speed_with_its_unit(tmp_path):
    study = read(tmp_path, keep='here = { value = "disc.r_amp", at = "2000 rpm" }')
    expected = "largest of the stable motions at 209.44 rad/s, of disc.r_amp"
    assert study.model.columns[0].text == expected


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"run": "kind = 'response'\nfrom = 60"}, "run response: needs to"),
        ({"run": "kind = 'response'\nfrom = 60\nto = 50"}, "must be below run.to"),
        ({"run": "kind = 'response'\nfrom = -9\nto = 50"}, "run.from = -9 rad/s: must be > 0"),
        ({"run": RUN + "\nspeed = 100"}, "speed is given with over, and only then"),
        ({"run": RUN + "\nover = 'contact[1].nu'\nspeed = 9"}, "did you mean contact"),
        ({"keep": "a = { bifurcation = 'folds' }"}, "must be one of fold,"),
        ({"keep": "a = { bifurcation = 'fold', which = 'any' }"}, "must be one of lowest, highest"),
        (
            {"keep": "a = { peak = 'disc.r' }"},
            "disc.r: unknown name; did you mean disc.x, disc.y, disc.r_amp",
        ),
        ({"keep": "a = { peak = 'disc.x_2x' }"}, "disc.x_2x: unknown name; did you mean disc.x"),
        (
            {"keep": "a = { value = 'disc.x', at = 500 }"},
            "at = 500: must be from 110 to 240 rad/s$",
        ),
        ({"keep": "a = { peak = 'stable' }"}, "stable: only of a curve"),
        ({"keep": "a = { poincare = 'disc.x' }"}, "poincare: unknown name"),
        ({"more": "verify = true\n"}, "verify: not of runs of the kind response"),
        ({"more": "[set]\n'solver.tolerance' = 1e-3\n"}, "solver.tolerance: unknown name"),
    ],
)
def test_what_cannot_be_is_one_line(tmp_path, options, words):
    with pytest.raises(InputError, match=words.replace("[", r"\[")):
        read(tmp_path, **options)


def test_sections_of_both_ways_lie_on_the_stable_motions(tmp_path):
    study = read(
        tmp_path,
        "kind = 'steps'\nfrom = 130\nto = 220\ncount = 3\nback = 1\nsettle = 1\nturns = 4",
        'x = { poincare = "disc.x" }\ny = { poincare = "disc.y" }',
        '"contact[1].mu" = { values = [0.05] }',
        '[set]\n"solver.tolerance" = 1e-4\n',
    )
    run_study(study, tmp_path / "out", here, quiet)
    said = []
    data, seen = open_dataset(tmp_path / "out"), []

    def stop(label, point):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        diagrams(study, data, quiet, lambda *_: nullcontext(stop))
    drawn = diagrams(study, data, said.append, lambda *_: nullcontext(lambda *_: seen.append(1)))
    assert len(seen) > 10
    assert sorted(drawn) == ["x", "y"]
    assert said == ["periodic motions between 20.69 and 35.014 Hz"]
    for figure in drawn.values():
        (axes,) = figure.axes
        lines = [line.get_xydata() for line in axes.lines if len(line.get_xydata())]
        full = [line.get_xydata() for line in axes.lines if line.get_linestyle() == "-"]
        curve = np.concatenate([f for f in full if len(f) > 1])
        points = np.concatenate([d for d in lines if len(d) in (8, 12)])
        assert len(points) == 5 * 4
        span = np.ptp(curve, axis=0)
        for point in points[np.abs(points[:, 0] - 138.5) > 5]:
            # on the polygon through the curve's points
            a, b = curve[:-1] / span, curve[1:] / span
            along = np.clip(((point / span - a) * (b - a)).sum(1) / ((b - a) ** 2).sum(1), 0, 1)
            gap = np.abs(a + along[:, None] * (b - a) - point / span).sum(1).min()
            assert gap < 5e-3
        titles = [text.get_text() for text in axes.get_legend().get_texts()]
        assert titles == ["rising", "falling", "periodic, stable", "periodic, unstable"]


def the_diagram(folder, run, frictions):
    """The axes of a study's diagram of a rotor that rubs with these coefficients of friction."""
    vary = f'"contact[1].mu" = {{ values = {frictions} }}'
    study = read(folder, run, 'x = { poincare = "disc.x" }', vary)
    run_study(study, folder / "out", here, quiet)
    (axes,) = diagrams(study, open_dataset(folder / "out"), quiet, unseen)["x"].axes
    return axes


def test_a_diagram_names_no_unstable_motions_where_none_are(tmp_path):
    """Far below the speeds at which the rotor rubs."""
    run = "kind = 'steps'\nfrom = 40\nto = 50\ncount = 2\nsettle = 0.1\nturns = 1"
    axes = the_diagram(tmp_path, run, [0.05])
    titles = [text.get_text() for text in axes.get_legend().get_texts()]
    assert titles == ["once a turn", "periodic, stable"]


@pytest.mark.parametrize(
    ("speeds", "expected"),
    [
        ([60.0, 60.4, 60.9, 60.5], [False, False, False, True]),
        ([60.9, 60.5], [True, True]),  # the first as the second
        ([60.0], [False]),
    ],
)
def test_speeds_of_a_diagram_fall_where_each_is_below_the_one_before(speeds, expected):
    how = SimpleNamespace(changed=lambda _: SimpleNamespace(speeds=np.array(speeds)))
    values = np.arange(2.0 * len(speeds))[None]
    over, section, falls = _points(values, None, SimpleNamespace(how=how), {"run.turns": 3.0})
    assert over.tolist() == np.repeat(speeds, 2).tolist()
    assert section.tolist() == values[0].tolist()
    assert falls.tolist() == np.repeat(expected, 2).tolist()


def test_motions_under_a_section_over_a_quantity_are_those_over_its_range_at_the_speed(monkeypatch):
    """With what else the runs have; an axis that sets two quantities, or the solver, has none."""

    def made_of(asked, report_point):
        return SimpleNamespace(asked=asked, is_stopped=False)

    monkeypatch.setattr(request, "compute_response", made_of)
    text = (EXAMPLES / JEFFCOTT).read_text(encoding="utf-8")
    runs = MachineRuns(text, {}, Excitation(CONSTANT, {"speed": 140.0}), ())

    def asked(*targets, settings):
        axis, said = SimpleNamespace(name="mu", targets=targets, unit="1"), []
        made = _response(runs, axis, settings, np.array([0.1, 0.02, 0.06]), said.append, unseen)
        return made and made.asked, said[-1]

    (rotor, task), said = asked("contact[1].mu", settings={"contact[1].clearance": 2e-3})
    assert rotor.parameters()["contact[1].clearance"].value == 2e-3
    assert (task.name, task.low, task.high, task.speed) == ("contact[1].mu", 0.02, 0.1, 140.0)
    assert said == "periodic motions over mu from 0.02 to 0.1 at 22.282 Hz"
    assert asked("contact[1].mu", settings={"run.speed": 150.0})[0].task.speed == 150.0
    for targets in (("contact[1].mu", "contact[1].k"), ("solver.tolerance",)):
        none, said = asked(*targets, settings={})
        assert none is None
        assert said.startswith("without periodic motions: mu: sets more than one quantity")


def test_a_diagram_of_falling_speeds_is_drawn_whatever_its_column_is_called(tmp_path, process):
    study = read(
        tmp_path,
        "kind = 'steps'\nfrom = -120\nto = -130\ncount = 2\nsettle = 0.1\nturns = 1",
        '"x/y" = { poincare = "disc.x" }\nforce = { poincare = "contact[1].fn" }',
        '"contact[1].mu" = { values = [0.05] }',
    )
    path, out = str(tmp_path / "study.toml"), tmp_path / "out"
    run_study(study, out, here, quiet)
    done = process("study", path, "--out", str(out), "--diagram")
    assert done.returncode == 0, done.stderr
    assert (out / "diagram_x_y.png").exists()
    data = open_dataset(out)
    drawn = diagrams(study, data, lambda said: None, unseen)
    (axes,) = drawn["x/y"].axes
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [
        *("falling", "periodic, stable")
    ]
    for name, factor, label in (
        ("x/y", 1e6, "disc.x at the mark [µm]"),
        ("force", 1.0, "contact[1].fn at the mark [N]"),
    ):
        (axes,) = drawn[name].axes
        assert axes.get_ylabel() == label
        (line,) = [line for line in axes.lines if line.get_label() == "falling"]
        np.testing.assert_allclose(line.get_ydata(), factor * data[name].values[0])


def test_a_diagram_marks_where_a_run_failed(tmp_path):
    """A backward whirl grows without bounds at the higher of two coefficients of friction."""
    run = "kind = 'constant'\nspeed = 160\nsettle = 2\nturns = 1"
    axes = the_diagram(tmp_path, run, [0.02, 0.3])
    (line,) = [line for line in axes.lines if line.get_label() == "failed runs"]
    assert line.get_xdata().tolist() == [0.3]


def test_a_study_whose_runs_all_failed_has_no_diagram(tmp_path):
    study = read(
        tmp_path,
        "kind = 'constant'\nspeed = 100",
        'x = { poincare = "disc.x" }',
        '"contact[1].mu" = { distribution = "normal", mean = -2, std = 0.1 }\n'
        "[design]\nkind = 'random'\nsize = 2",
    )
    run_study(study, tmp_path / "out", here, quiet)
    with pytest.raises(RunFailed, match="--diagram: every run failed"):
        diagrams(study, open_dataset(tmp_path / "out"), print, unseen)


def test_a_study_without_sections_has_no_diagram(tmp_path):
    with pytest.raises(InputError, match="keeps no poincare"):
        diagrams(read(tmp_path), None, print, unseen)


def test_a_run_selected_is_written_with_picture_and_page(process, tmp_path):
    read(tmp_path, SHORT, 'fold = { bifurcation = "fold" }')
    path = str(tmp_path / "study.toml")
    done = process("study", path, "--out", str(tmp_path / "out"), "--select", "1")
    assert done.returncode == 0, done.stderr
    (folder,) = (tmp_path / "out" / "runs").iterdir()
    about = json.loads((folder / "response.json").read_text())
    assert about["run"] == 1
    assert about["values"] == {"contact[1].mu": 0.05}
    assert {f.name for f in folder.iterdir()} >= {"response.png", "response.html"}
