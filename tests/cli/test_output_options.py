"""What commands tell: words, the same figures as JSON, or nothing."""

import json
import math
import re
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
import typer
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.simulation import Simulation

import rotor_fmu as rf
from rotor_fmu.cli import app
from rotor_fmu.fmi.interface import interface
from rotor_fmu.output_options import json_text, with_output_options
from rotor_fmu.runs import run_down
from rotor_fmu.runs.job import prepare
from rotor_fmu.screen import progress_of

from ..toml_text import table

ROOT = Path(__file__).parents[2]
SHORT = ("run-down", "--direct", "--preset", "robust", "--stop", "0.02", "--out", ".")
DIVERGING = (
    *("run-down", "--direct", "--preset", "paper", "--set", "solver.method=wbz"),
    *("--set", "solver.alpha_m=0.08", "--stop", "1", "--out", "."),
)
STUDY = (
    'name = "two"\nmachine = "rig"\n'
    + table("run", **{"kind": "run-down", "from": 200, "to": 199, "rate": 10})
    + table("set", **{"solver.tolerance": 1e-2})
    + table("vary", **{"bearing[1].mu": {"values": [0.05, 0.1]}})
    + table("keep", X={"peak": "disc[3].x_amp"})
)


@pytest.fixture
def output(process):
    """Standard output, standard error and status of a command."""

    def run(*arguments):
        done = process(*arguments)
        return done.stdout, done.stderr, done.returncode

    return run


def test_json_is_the_summary_and_nothing_else(output, tmp_path):
    words, _, status = output(*SHORT)
    assert status == 0
    out, _, status = output(*SHORT, "--json")
    figures = json.loads(out)
    assert status == 0
    assert figures.pop("out") == "."
    assert figures == json.loads((tmp_path / "summary.json").read_text())
    sentences = words.splitlines()
    assert len(sentences) == 3
    assert sentences[-1] == "Nothing makes the run doubtful; open report.html."


def test_the_keys_of_a_run_are_the_same_through_the_fmu_and_after_a_failure(output):
    keys = [
        list(json.loads(output(*arguments, "--json")[0]))
        for arguments in (SHORT, [x for x in SHORT if x != "--direct"], DIVERGING)
    ]
    assert keys[0] == keys[1] == keys[2]
    page = (ROOT / "docs" / "reference" / "results.md").read_text(encoding="utf-8")
    of_runs = page.partition("## `run-down`")[2].partition("\n## ")[0]
    for key in keys[0]:
        assert re.search(rf"\b{key}\b", of_runs), key


def test_quiet_prints_nothing_but_errors(output):
    # a warning and progress are none
    assert output(*SHORT, "--set", "solver.tolerance=1e-4", "--quiet") == ("", "", 0)
    out, err, status = output(*DIVERGING, "--quiet")
    assert (out, status) == ("", 1)
    assert len(err.splitlines()) == 1
    assert err.startswith("rotor-fmu: the run stopped before its end: ")
    assert output("run-down", "--stop", "-1", "--quiet")[1:] == (
        "rotor-fmu: --stop -1 s: must be > 0 and finite\n",
        2,
    )


def test_a_failed_run_gives_its_json_and_no_picture_of_an_earlier_one_stays(output, tmp_path):
    output(*SHORT)
    before = [*tmp_path.glob("*.png")]
    assert before
    for path in before:
        path.write_bytes(b"of an earlier run")
    out, _, status = output(*DIVERGING, "--json", "--quiet")
    assert status == 1
    assert json.loads(out)["status"].startswith("failed: ")
    assert b"of an earlier run" not in [path.read_bytes() for path in tmp_path.glob("*.png")]


def test_a_study_tells_its_counts_its_worst_runs_and_what_it_says(output, tmp_path):
    (tmp_path / "study.toml").write_text(STUDY)
    call = ("study", "study.toml", "--out", "rows", "--jobs", "1")
    out, err, status = output(*call, "--analyse", "--json", "--quiet")
    assert (err, status) == ("", 0)
    figures = json.loads(out)
    assert list(figures) == [
        *("name", "runs", "made_now", "counts", "worst_of", "worst", "analysis", "out")
    ]
    assert (figures["runs"], figures["made_now"], figures["counts"]) == (2, 2, {"ok": 2})
    assert {row["run"] for row in figures["worst"]} == {0, 1}
    assert figures["analysis"]["columns"]["X"]["count"] == 2
    assert output(*call, "--quiet") == ("", "", 0)
    selected = json.loads(output(*call, "--select", "1", "--json")[0])
    assert (selected["run"], selected["status"]) == (1, "ok")
    assert selected["values"] == {"bearing[1].mu": 0.1}


def commands():
    """Every command by name; those of a group as `group command`."""
    context = typer.Context(typer.main.get_command(app))
    for name in context.command.list_commands(context):
        _, command, _ = context.command.resolve_command(context, [name])
        yield from getattr(command, "commands", {name: command}).items()


# what they print is a text for another program: TOML, JSON, lines for a shell
TEXTS = {"example", "schema", "host-env"}


def test_every_command_with_figures_tells_by_the_same_options():
    options = {
        name: {option for parameter in command.params for option in parameter.opts}
        for name, command in commands()
    }
    assert len(options) > 15
    assert {name for name, of_it in options.items() if not {"--json", "--quiet"} <= of_it} == TEXTS


def test_the_variables_as_json_are_the_table(output):
    listed = json.loads(output("variables", "--free", "--json")[0])
    table = {v.name: v for v in interface(rig(), is_free=True)}
    assert listed.keys() == table.keys()
    assert {n: v["unit"] for n, v in listed.items()} == {n: v.unit for n, v in table.items()}


def test_what_a_command_prints_on_the_way_is_not_among_its_json(capsys):
    @with_output_options
    def counted(count: int) -> dict:
        typer.echo("in words")
        return {"count": count, "apart": math.inf}

    counted(count=2)
    assert capsys.readouterr().out == "in words\n"
    counted(count=2, as_json=True)
    assert json.loads(capsys.readouterr().out) == {"count": 2, "apart": None}
    assert json.loads(json_text({"a": [math.nan, (1.0, "x")]})) == {"a": [None, [1.0, "x"]]}


@pytest.mark.parametrize("is_fmu", [False, True])
def test_the_wall_time_leaves_out_what_the_first_step_compiles(tmp_path, monkeypatch, is_fmu):
    """On a clock that takes 100 s for a first step, and 1 s for the others."""
    import fmpy.fmi2

    clock = SimpleNamespace(now=0.0, took=100.0)
    owner, name = (fmpy.fmi2.FMU2Slave, "doStep") if is_fmu else (Simulation, "advance")
    step = getattr(owner, name)

    def slow(*arguments, **named):
        clock.now, clock.took = clock.now + clock.took, 1.0
        return step(*arguments, **named)

    monkeypatch.setattr(owner, name, slow)
    ticking = SimpleNamespace(**{**vars(time), "perf_counter": lambda: clock.now})
    monkeypatch.setattr(run_down, "time", ticking)
    job = prepare(None, "robust", ["speed=100"], None, 0.1, 0.01)
    fmu = rf.build_fmu(rf.load(), tmp_path) if is_fmu else None
    run = run_down.run_fmu(fmu, job) if fmu else run_down.run_direct(job)
    assert clock.now == 109.0
    assert run.wall_s == 9.0


def test_a_label_in_brackets_is_shown_as_it_is(capsys):
    with progress_of("a [/b] over [rpm]", 1.0, first=0.0) as update:
        update(1.0, lambda: "done", True)
    assert capsys.readouterr().err.endswith("a [/b] over [rpm]: done\n")
