"""What the benchmark says of its measurements, and that it can be stopped and go on."""

import json
import sys
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from rotor_fmu.model.settings import choose
from rotor_fmu.model.structure.assembly import assemble

from benchmarks import compare, growth, race
from benchmarks.peers import cvode, exudyn_peer, ida, project, ross_peer, scipy_peer
from benchmarks.problem import Diverged, Method, Missing, beginning, orbit, peaks
from benchmarks.report import PAGES, filled_pages, write_report
from benchmarks.store import Store
from papers.dense_machine import rest

from ..machines import disc_dofs
from ..validation.windows import rig


def test_work_at_equal_error_lies_on_the_line_between_two_runs():
    runs = [{"orbit_max": e, "cpu": c} for e, c in ((1e-4, 1.0), (1e-6, 100.0), (1e-5, 300.0))]
    front = compare.front(runs)
    assert front == [(1e-4, 1.0), (1e-6, 100.0)]  # the third is beaten in both
    assert compare.work_at(1e-5, front) == pytest.approx(10.0)
    assert compare.work_at(1e-3, front) == 1.0
    assert compare.work_at(1e-7, front) is None


def test_peaks_between_two_samples_are_found():
    t = np.arange(0.0, 4.0, 1e-3)
    disc = 3e-4 * np.cos(2 * np.pi * 31.4 * t) + 1j * (1e-4 * np.sin(60 * t) - 2e-4)
    x, y = peaks(t, disc)
    assert x == pytest.approx(3e-4, rel=2e-4)
    assert y == pytest.approx(1e-4, rel=2e-4)


def test_an_orbit_that_leaves_the_machine_has_diverged():
    problem = beginning()
    t = np.linspace(0.0, problem.stop, 201)
    with pytest.raises(Diverged, match=r"t = 0\.101 s"):
        orbit(problem, t, np.where(t > 0.1, 1.0, 0.0) + 0j, 200)
    with pytest.raises(Diverged, match=r"ended at t = 0\.1 s"):
        orbit(problem, t[:101], np.zeros(101, dtype=complex), 100)


@pytest.mark.parametrize("elements", [14, 50])
def test_a_finer_rig_weighs_the_same_and_sags_the_same(elements):
    coarse = rig()
    fine = growth.refined(coarse, elements)
    assert len(fine.sections) == elements
    assert {float(f"{z:.12g}") for z in coarse.nodes} <= {float(f"{z:.12g}") for z in fine.nodes}
    before, after = (assemble(rotor) for rotor in (coarse, fine))
    assert after.static_load[::2].sum() == pytest.approx(before.static_load[::2].sum(), rel=1e-9)
    sags = [rest(rotor)[disc_dofs(rotor)].imag for rotor in (coarse, fine)]
    assert sags[1] == pytest.approx(sags[0], rel=1e-3)


def test_more_bearings_stand_between_the_first_and_the_last():
    rotor = growth.with_bearings(growth.refined(rig(), 28), 6)
    nodes = [bearing.node for bearing in rotor.bearings]
    assert len(nodes) == 6
    assert nodes == sorted(set(nodes))
    rest(rotor)


@pytest.mark.slow
def test_this_project_and_cvode_find_the_same_beginning_of_the_run_down():
    problem = replace(beginning(), stop=0.06)
    truth = cvode.reference(problem)
    result = project.solve(choose("moderate", h=5e-5), problem)
    assert np.abs(result.disc - truth.disc).max() < 1e-7
    assert np.abs(truth.disc - truth.disc[0]).max() > 5e-5


@pytest.mark.parametrize(("peer", "module"), [(exudyn_peer, "exudyn"), (ross_peer, "ross.utils")])
def test_a_program_that_is_not_installed_leaves_a_line(peer, module, monkeypatch):
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(Missing, match=f"{peer.PROGRAM}: .*pip install"):
        peer.methods()


def never_called(problem):
    raise AssertionError("measured again")


@pytest.mark.slow
def test_a_stopped_race_goes_on_where_it_was(tmp_path, monkeypatch):
    calls = []

    def solve(problem):
        calls.append(problem.stop)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return project.solve(choose("paper"), problem)

    def given_up(problem):
        raise Diverged("diverged at t = 0.01 s")

    short = replace(beginning(), stop=0.02, sample=0.01)
    chosen = [Method("this project", "paper", solve), Method("ROSS", "never", given_up)]
    monkeypatch.setattr(race, "methods", lambda: (chosen, ["Exudyn: not installed"]))
    monkeypatch.setattr(race, "beginning", lambda: short)
    monkeypatch.setattr(race, "run_down", lambda: replace(short, name="run-down"))
    silent = lambda what, share: None  # noqa: E731
    with pytest.raises(KeyboardInterrupt):
        race.race(Store(tmp_path, "full", 2), 2, False, silent)
    retained = Store(tmp_path, "full", 2)
    assert retained.is_resumed
    assert len(retained.section("beginning")["this project, paper"]["cpu_s"]) == 2
    race.race(retained, 2, False, silent)
    for problem in ("beginning", "run-down"):
        rows = retained.section(problem)
        assert len(rows["this project, paper"]["cpu_s"]) == 2
        assert rows["ROSS, never"]["failed"] == "diverged at t = 0.01 s"
    done = [replace(method, solve=never_called) for method in chosen]
    monkeypatch.setattr(race, "methods", lambda: (done, []))
    race.race(Store(tmp_path, "full", 2), 2, False, silent)
    assert not Store(tmp_path, "quick", 1).is_resumed
    written = write_report(retained, tmp_path)
    assert {path.name for path in written} >= {"table.md", "results.json", "work_precision.png"}
    assert "diverged at t = 0.01 s" in (tmp_path / "table.md").read_text(encoding="utf-8")


def test_the_tables_of_the_page_are_those_of_the_newest_results():
    results = sorted(
        (PAGES[0].parents[2] / "benchmarks" / "results").glob("????-??-??/results.json")
    )
    assert json.loads(results[-1].read_text(encoding="utf-8"))["about"]["kind"] == "full"
    pages = [page.read_text(encoding="utf-8") for page in PAGES]
    assert filled_pages(Store.read(results[-1].parent), pages) == pages


@pytest.fixture(scope="module")
def short():
    """The first steps of the run-down, and CVODE's results of them."""
    problem = replace(beginning(), stop=0.03, sample=0.005)
    return problem, cvode.reference(problem)


@pytest.mark.slow
@pytest.mark.parametrize(
    "solve",
    [
        partial(cvode.solve, 2, 1e-7, modes=cvode.MODES),
        partial(ida.solve, 1e-6),
        partial(ida.solve, 1e-7, modes=cvode.MODES),
        partial(scipy_peer.solve, "Radau", 1e-5, modes=cvode.MODES),
    ],
    ids=["CVODE on modes", "IDA", "IDA on modes", "Radau on modes"],
)
def test_peers_on_component_modes_and_ida_find_the_same_beginning(solve, short):
    problem, truth = short
    assert np.abs(solve(problem).disc - truth.disc).max() < 1e-7
    assert np.abs(truth.disc - truth.disc[0]).max() > 1e-5
