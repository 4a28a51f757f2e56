"""The one line by which a study is refused that cannot be."""

import re

import pytest

from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study

from .test_reading import HELD, STUDY, VALUES, read


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        *(
            ("[run]", f"name = {name}\n[run]", f"name = {said}: must be text, not empty, without")
            for name, said in (("3", "3"), ("[]", "[]"), ('""', "''"), ('"a\\nb"', r"'a\nb'"))
        ),
        ("[keep]", "[kep]", "kep: unknown name; did you mean keep"),
        ('"run-down"', '"rundown"', "run kind = 'rundown': must be one of run-down, run-up"),
        ("rate = 40", "rat = 40", "run run-down: rat: unknown name; did you mean rate"),
        ("rate = 40", "rate = -40", "run.rate = -40 rad/s2: must be > 0 and finite"),
        ("rate = 40", 'rate = "fast"', "run.rate = fast: must be a number, in rad/s2"),
        ("[run]", 'machine = "no.toml"\n[run]', "machine = no.toml: cannot be read"),
        ("[run]", "module = 3\n[run]", "module = 3: must be the name of a Python module"),
        ("[run]", 'module = "no.such"\n[run]', "module = 'no.such': cannot be imported: No module"),
        ("[run]", 'module = "math"\n[run]', "module = 'math': has no function read_subject"),
        (
            '"run-down"',
            '"drive-train"',
            "run kind = 'drive-train': must be one of run-down, run-up",
        ),
        ("solver.tol", "solver.tal", "set solver.talerance: unknown name; did you mean solver.tol"),
        (
            "solver.tolerance",
            "solver.mode",
            "set solver.mode: unknown name; did you mean solver.ad",
        ),
        ("= 1e-2", "= 2", "set solver.tolerance = 2: must be a finite number from 0 to 1"),
        ("disc[2].e", "disc[4].e", "vary disc[4].e: unknown name; did you mean disc[1].e"),
        (
            "[*].clearance",
            "[*].clearence",
            "no variable matches this pattern; did you mean bearing[1].clearance",
        ),
        ("disc[2].e", "bearing[1].clearance", "is varied by clearance too"),
        ("disc[2].e", "solver.tolerance", "solver.tolerance is also fixed in [set]"),
        ("disc[2].e", "run.rat", "vary run.rat: unknown name; did you mean run.rate"),
        ("40e-6", "-40e-6", "vary clearance = -4e-05: must be a finite number >= 0 m"),
        (", values = [40e-6, 60e-6]", "", "one of values = [...], grid = { from, to, count }, dis"),
        ("from = 10e-6, ", "", "disc[2].e: grid without from: must be { from, to, count }, and"),
        ("count = 3", "count = 3, step = 1", "disc[2].e: grid with step: must be { from, to, "),
        ("count = 3", "count = 0", "grid count = 0: must be an integer from 1 to 10000000"),
        ("count = 3", "count = 1000000000000", "must be an integer from 1 to 10000000"),
        ("disc[3].x_amp", "disc[3].x_map", "keep X: disc[3].x_map: unknown name; did you mean"),
        ("peak", "peek", "keep X: peek: unknown name; did you mean peak"),
        ("X = 400e-6", "Z = 400e-6", "limits Z: unknown name; known: X"),
        ("X = 400e-6", "X = { most = 1 }", "limits X = {'most': 1}: must be a number, or { least"),
        (
            "[limits]\nX",
            'c = { amplitude = "disc[3].x_amp", bins = { from = 0, to = 9, count = 3 } }\n'
            "[limits]\nc",
            "limits c: is a list in each run; a limit is of a number",
        ),
        ('kind = "run-down"', "", "run kind: must be one of run-down, run-up"),
        ("X = {", "clearance = {", "keep clearance: is the name of something else in the rows"),
        ("clearance = {", "run = {", "vary run: is the name of something else in the rows"),
        ('"bearing[*].clearance"', "[]", "vary clearance: names = []: must be names"),
        (VALUES, f"values = [1{'0' * 400}]", "0: must be a finite number"),
        (VALUES, 'distribution = ["normal"]', "distribution = ['normal']: must be one of uniform"),
        ('"run-down"', '["run-down"]', "run kind = ['run-down']: must be one of run-down, run-up"),
        ("[vary]", '"limit.contact" = 2\n[vary]', "set limit.contact = 2: must be true or false"),
        (VALUES, "values = [true]", "vary clearance = True: must be a finite number"),
        ("[vary]", '"solver.newton_limit" = 9.5\n[vary]', "newton_limit = 9.5: must be an integer"),
        (
            "[keep]",
            '"solver.alpha_f" = { values = [0.1, 0.2] }\n[keep]',
            "solver.alpha_f = 0.1: not a parameter of chung-hulbert; set solver.method too",
        ),
        ("[limits]", "[design]\nlevels = 3\n[limits]", "design levels = 3: must be even"),
        (
            "[limits]",
            "[design]\nsize = 20\n[limits]",
            "design size = 20: a grid has none; kind must",
        ),
        (
            'peak = "disc[3].x_amp"',
            'amplitude = "w", bins = { from = 0, to = 1, count = 1000000000000 }',
            "bins count = 1000000000000: must be an integer from 1 to 10000000",
        ),
        ('peak = "disc[3].x_amp"', 'contact = "disc[3]"', "disc[3]: unknown name; known: be"),
        (
            VALUES,
            'distribution = "normal", mean = 5e-5',
            "vary clearance: a normal distribution needs mean, std; no std",
        ),
        (
            VALUES,
            'distribution = "gauss", mean = 5e-5',
            "distribution = 'gauss': must be one of uniform, log-uniform, normal",
        ),
        (
            VALUES,
            'distribution = "uniform", low = 2, high = 1',
            "vary clearance: low = 2: must be below high = 1",
        ),
        (
            VALUES,
            'distribution = "uniform", low = 4e-5, high = 6e-5',
            "vary clearance: is distributed; [design] must name one of random",
        ),
        ("[limits]", '[design]\nkind = "sobol"\n[limits]', "design sobol: needs size"),
        ("[limits]", "[limits", "is not valid TOML"),
        (VALUES, f"values = {'[' * 5000}", "is not valid TOML"),
        (VALUES, f"values = [{'9' * 5000}]", "is not valid TOML"),
        ('peak = "disc[3].x_amp"', 'poincare = "disc[3].x"', "at constant speed in whole turns"),
        ('peak = "disc[3].x_amp"', 'value = "disc[3].x_amp"', "keep X: value needs speed"),
    ],
)
def test_a_study_misread_is_refused_in_one_line_and_writes_nothing(
    tmp_path, input_error, old, new, expected
):
    assert old in STUDY
    (tmp_path / "study.toml").write_text(STUDY.replace(old, new, 1))
    line = input_error("study", "study.toml", "--out", "out")
    assert line.startswith("rotor-fmu: study.toml: ")
    assert expected in line


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("rate = 40", "rate = 40\nfile = 5", "run run-down: file: only of signals, which need it"),
        ("rate = 40", "rate = 40\nkick = 5", "run kick: must be { port, force, rate, duration }"),
        (
            "rate = 40",
            'rate = 40\nkick = { port = "disc[1]", force = 1, rate = 1, duration = 0 }',
            "run kick duration = 0 s: must be > 0",
        ),
        ("rate = 40", "rate = 40\nover = 5", "run run-down: over = 5: the name of a quantity"),
        ("[run]", "machine = 5\n[run]", "machine = 5: must be the name of a file"),
        (
            "[vary]",
            '"solver.method" = "x"\n[vary]',
            "set solver.method = x: must be one of 0 as the",
        ),
        ("[vary]", "[vary]\nq = 5", "vary q = 5: must be a table with values, grid or"),
        ('"bearing[*].clearance"', "5", "vary clearance: names = 5: must be names"),
        (VALUES, "values = 5", "vary clearance: values = 5: must be a list of numbers"),
        (VALUES, f"{VALUES}, low = 1", "vary clearance: low is unknown beside values"),
        (VALUES, "grid = 5", "vary clearance: grid = 5: must be { from, to, "),
        ("count = 3", 'count = 3, spacing = "x"', "grid spacing = 'x': must be one of linear, log"),
        (
            "from = 10e-6, to",
            'spacing = "log", from = 0, to',
            "grid from 0 to 9e-05: must be > 0 with spacing log",
        ),
        (
            VALUES,
            'distribution = "uniform", low = 1, high = 2, mean = 3',
            "vary clearance: a uniform distribution has no mean",
        ),
        (
            VALUES,
            'distribution = "log-uniform", low = 0, high = 2',
            "vary clearance: low = 0: must be > 0",
        ),
        (VALUES, 'distribution = "normal", mean = 1, std = 0', "vary clearance: std = 0: must be"),
        ("[limits]", '[design]\nkind = "random"\nsize = 3\n[limits]', "is distributed"),
        ('X = { peak = "disc[3].x_amp" }', "", "[keep] is empty: at least one result must be kept"),
        ('{ peak = "disc[3].x_amp" }', "5", "keep X = 5: must be a table such as { peak ="),
        ('{ peak = "disc[3].x_amp" }', "{}", "keep X: must have one of poincare, order"),
        ('"disc[3].x_amp"', "5", "keep X: of = 5: must be the name of an output"),
        ("peak =", "bins = 5, amplitude =", "keep X: bins must be { from, to, count }"),
        (
            "peak =",
            "bins = { from = 5, to = 1, count = 3 }, amplitude =",
            "keep X: bins from = 5: must be below to = 1",
        ),
    ],
)
def test_what_no_study_can_be_is_refused_by_its_value(tmp_path, old, new, expected):
    assert old in STUDY
    with pytest.raises(InputError, match=re.escape(expected)):
        read(tmp_path, STUDY.replace(old, new, 1))


@pytest.mark.parametrize(
    ("numbers", "varied", "expected"),
    [
        ("measure = 0.5\nturns = 8", "run.speed", "run.turns = 8: has no effect with run.measure"),
        ("measure = 0.5\nper_turn = 8", "run.speed", "run.per_turn = 8: has no effect with"),
        ("step = 0.01", "run.speed", "run.step = 0.01: has no effect without run.measure"),
        ("", "run.step", "vary run.step: has no effect without run.measure"),
    ],
)
def test_what_a_held_speed_takes_no_notice_of_is_refused(tmp_path, numbers, varied, expected):
    study = f'''name = "held"
[run]
kind = "constant"
speed = 10
{numbers}
[vary]
"{varied}" = {{ values = [1, 2] }}
[keep]
q = {{ rms = "w" }}
'''
    with pytest.raises(InputError, match=re.escape(expected)):
        read(tmp_path, study)


def test_what_a_study_needs_beside_its_run_is_asked_for(tmp_path):
    with pytest.raises(InputError, match=r"vary run.turns: changes the number of results"):
        read(tmp_path, HELD.replace("run.speed", "run.turns") + '[keep]\nq = { rms = "w" }\n')
    with pytest.raises(InputError, match=r"\[vary\] is empty"):
        read(tmp_path, STUDY.split("[vary]")[0])
    with pytest.raises(InputError, match=r"--quick: the study has no table \[quick\]"):
        read_study(tmp_path / "study.toml", is_quick=True)
    (tmp_path / "signals.csv").write_text("time,disc[2].fx\n0,1\n1,2\n")
    signals = STUDY.replace('"run-down"\nfrom = 220\nrate = 40', '"signals"\nstop = 1')
    with pytest.raises(InputError, match=r"run signals: file: only of signals, which need it"):
        read(tmp_path, signals)
    with pytest.raises(InputError, match=r"run signals: signals.csv: has no column speed"):
        read(tmp_path, signals.replace("stop = 1", 'stop = 1\nfile = "signals.csv"'))


@pytest.mark.parametrize(
    ("keep", "expected"),
    [
        ('{ order = 0.3, of = "disc[3].x" }', "order = 0.3: must make whole periods in run.turns"),
        ('{ order = 0, of = "disc[3].x" }', "order = 0: must be > 0 and below half of run.per_t"),
        ('{ order = -1, of = "disc[3].x" }', "order = -1: must be > 0 and below half of run.per_t"),
        ('{ order = 16, of = "disc[3].x" }', "order = 16: must be > 0 and below half of run.per_"),
        ('{ spectrum = "disc[3]", orders = 16 }', "orders = 16: must be > 0 and below half of"),
        ('{ peak = "disc[3].x", after = -1 }', "after = -1 s: must be >= 0"),
        (
            '{ amplitude = "disc[3].x" , bins = { from = 1, to = 2, count = 1 } }',
            "varies continuously",
        ),
        ('{ spectrum = "disc[9]", orders = 2 }', "disc[9]: unknown name; did you mean disc[1]"),
    ],
)
def test_keeps_of_constant_speeds_that_cannot_be_are_refused(tmp_path, keep, expected):
    with pytest.raises(InputError, match=expected.replace("[", r"\[")):
        read(tmp_path, f"{HELD}[keep]\nq = {keep}\n")


def test_a_spectrum_of_several_held_speeds_is_refused_by_the_kind_that_it_needs(tmp_path):
    run = 'machine = "rig"\n[run]\nkind = "steps"\nfrom = 100\nto = 200\ncount = 2\n'
    run += '[vary]\n"bearing[1].mu" = { values = [0, 0.1] }\n'
    keep = '[keep]\nq = { spectrum = "disc[3]", orders = 2 }\n'
    expected = "keep q: spectrum needs runs at constant speed in whole turns, of the kind constant$"
    with pytest.raises(InputError, match=expected):
        read(tmp_path, run + keep)
