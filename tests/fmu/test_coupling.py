"""A partner of the user's own, coupled with the rotor by what its source says."""

import re
import shutil
import tempfile
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from rotor_fmu.examples import example_folder
from rotor_fmu.model.message_templates import Message

from rotor_fmu.cosimulation.coupling import Coupling
from rotor_fmu.cosimulation.member import Member
from rotor_fmu.errors import InputError, RunFailed
from rotor_fmu.fmi.variables import are_alike

from ..processes import run_python

SOURCE = """
from pythonfmu import DefaultExperiment
try:
    from rotor_fmu_slave import BEGUN, TableSlave, hold
except ImportError:
    from rotor_fmu.cosimulation.partner_slave import BEGUN, TableSlave, hold
hold(globals())
VARIABLES = (
    ("tau", "input", "N.m", 0.0, None, "torque on the rotor"),
    ("w_start", "parameter", "rad/s", 100.0, 0.0, "speed at the start"),
    ("rate", "parameter", "rad/s2", 50.0, None, "rate of the speed"),
    ("w", "output", "rad/s", None, None, "speed"),
    ("work", "output", "J", None, None, "work"),
    BEGUN,
)
CONNECTIONS = (("partner.w", "rotor.speed"), ("rotor.tau", "partner.tau"))
INITIAL = (("partner.w_start", "rotor.speed"), ("rotor.tau", "partner.tau"))
class SteadyMotor(TableSlave):
    VARIABLES = VARIABLES
    description = "A motor whose speed rises at a rate"
    default_experiment = DefaultExperiment(start_time=0.0, stop_time=1.0, step_size=0.001)
    def begin(self):
        self.w = self.w_start
    def step(self, t, h):
        self.work += self.tau * self.w * h
        self.w += self.rate * h
"""


@pytest.fixture(scope="module")
def coupling(tmp_path_factory):
    source = tmp_path_factory.mktemp("partner") / "steady_motor.py"
    source.write_text(SOURCE)
    return Coupling(source)


def changed(folder, right, wrong):
    """The file of the source with one of its texts replaced."""
    assert SOURCE.count(right) == 1
    source = folder / "steady_motor.py"
    source.write_text(SOURCE.replace(right, wrong))
    return source


def coupled(coupling, fmu, folder, **parameters):
    partner = coupling.build(folder)
    assert partner.name == "SteadyMotor.fmu"
    recorded = {"partner": ["work"], "rotor": ["w", "energy.drive_work"]}
    fmus = {"partner": partner, "rotor": fmu}
    return coupling.run(fmus, 0.2, 1e-3, {"partner": parameters}, recorded)


def test_the_script_of_the_how_to_is_a_flywheel_that_its_load_brakes(fmu, tmp_path):
    page = Path(__file__).parents[2] / "docs" / "how_to" / "couple_an_fmu.md"
    (text,) = re.findall(r"^```python\n(# flywheel\.py.*?)^```", page.read_text(), re.M | re.S)
    source = tmp_path / "flywheel.py"
    source.write_text(text)
    coupling = Coupling(source)
    partner = coupling.build(tmp_path)
    assert partner.name == "Flywheel.fmu"
    fmus = {"partner": partner, "rotor": fmu}
    run = coupling.run(fmus, 0.05, 1e-3, {"partner": {"J": 0.2}})
    assert run["partner"]["w"][0] == 100.0
    impulse = np.cumsum(run["rotor"]["tau_load"][:-1]) * 1e-3
    assert np.abs(impulse).max() > 0
    np.testing.assert_allclose(0.2 * (run["partner"]["w"][1:] - 100.0), -impulse, rtol=1e-6)


def test_each_fmu_gets_what_the_other_gave_at_the_last_communication_point(coupling, fmu, tmp_path):
    run = coupled(coupling, fmu, tmp_path, rate=20.0)
    np.testing.assert_allclose(run.t, np.arange(201) * 1e-3)
    np.testing.assert_allclose(run["partner"]["w"], 100.0 + 20.0 * run.t)
    # the rotor continues the speed linearly from the last two values, the first being held
    np.testing.assert_allclose(run["rotor"]["w"][2:], run["partner"]["w"][1:-1] + 0.02)
    paid = np.cumsum(run["rotor"]["tau"][:-1] * run["partner"]["w"][:-1]) * 1e-3
    np.testing.assert_allclose(run["partner"]["work"][1:], paid)
    # that the rotor took, but for the torque that is held over a step
    taken = run["rotor"]["energy.drive_work"][-1]
    assert paid[-1] == pytest.approx(taken, rel=0.05)


def test_the_initial_values_are_exchanged_before_the_first_step(coupling, fmu, tmp_path):
    run = coupled(coupling, fmu, tmp_path, w_start=150.0, rate=0.0)
    assert run["rotor"]["w"][0] == 150.0
    assert run["rotor"]["w"][-1] == 150.0


def test_what_the_partner_refuses_ends_the_run_with_its_sentence(coupling, fmu, tmp_path):
    with pytest.raises(RunFailed, match="w_start = -1 rad/s: must be >= 0"):
        coupled(coupling, fmu, tmp_path, w_start=-1.0)


def test_an_fmu_without_a_library_for_this_platform_says_so_and_leaves_no_folder(
    fmu, tmp_path, monkeypatch
):
    damaged = tmp_path / "Damaged.fmu"
    with zipfile.ZipFile(fmu) as whole, zipfile.ZipFile(damaged, "w") as archive:
        for entry in whole.infolist():
            if not entry.filename.startswith("binaries/"):
                archive.writestr(entry, whole.read(entry))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    with pytest.raises(RunFailed, match=r"Damaged\.fmu: Cannot find shared library"):
        Member(damaged, {}, []).__enter__()
    assert list(tmp_path.iterdir()) == [damaged]


def test_a_call_that_fails_without_a_message_is_not_laid_to_an_earlier_one(fmu, monkeypatch):
    def fails(*arguments):
        raise fmpy.fmi1.FMICallException("fmi2DoStep", 3)

    with Member(fmu, {}, [Message("a warning of the other FMU", "")]) as member:
        member.begin()
        monkeypatch.setattr(member._fmu, "doStep", fails)
        with pytest.raises(RunFailed, match="fmi2DoStep failed with status 3"):
            member.step(0.0, 1e-3)


@pytest.mark.parametrize(
    ("table", "right", "wrong"),
    [
        ("CONNECTIONS", '("rotor.tau", "partner.tau"))\nI', '("rotr.tau", "partner.tau"))\nI'),
        *(
            pytest.param(*each, marks=pytest.mark.slow)
            for each in (
                ("CONNECTIONS", '"partner.w", "rotor.speed"', '"partner.w", "speed"'),
                ("INITIAL", '"partner.w_start"', '"w_start"'),
            )
        ),
        ("INITIAL", '"partner.w_start"', '"rotor.w"'),
    ],
)
def test_a_pair_that_does_not_connect_both_is_refused(fmu, tmp_path, table, right, wrong):
    """It would be left out without a word, and the run be that of another coupling."""
    source = changed(tmp_path, right, wrong)
    with pytest.raises(InputError, match=rf"steady_motor\.py: {table}: .* FMU\.VARIABLE"):
        coupled(Coupling(source), fmu, tmp_path)


@pytest.mark.parametrize(
    ("right", "wrong", "expected"),
    [
        (
            'INITIAL = (("partner.w_start", ',
            'INITIAL = (("partner.rate", ',
            r"INITIAL: partner\.rate \[rad/s2\], rotor\.speed \[rad/s\]: must have the same unit$",
        ),
        (
            '"output", "rad/s"',
            '"output", "Hz"',
            r"CONNECTIONS: partner\.w \[Hz\], rotor\.speed \[rad/s\]: must have the same unit$",
        ),
        (
            "CONNECTIONS = (",
            'CONNECTIONS = (("partner.w", "rotor.speed"), ',
            r"CONNECTIONS: rotor\.speed: has 2 outputs; must have one$",
        ),
    ],
)
def test_a_connection_of_other_units_or_of_two_outputs_is_refused(
    fmu, tmp_path, right, wrong, expected
):
    """It would run, and its numbers be of another machine."""
    source = changed(tmp_path, right, wrong)
    with pytest.raises(InputError, match=rf"^steady_motor\.py: {expected}"):
        coupled(Coupling(source), fmu, tmp_path)


@pytest.mark.parametrize(
    ("one", "other", "expected"),
    [
        ("N.m", "J", True),
        ("Hz", "rad/s", False),
        ("degC", "degC", True),
        ("degC", "K", False),
        ("W/(m2.K)", "kg/(s3.K)", True),
        ("N/m^1.5", "N/m^1.5", True),
        ("N/m^1.5", "N/m^2.5", False),
    ],
)
def test_units_are_alike_by_what_they_are_made_of(one, other, expected):
    assert are_alike(one, other) == expected


def test_a_parameter_that_is_no_number_is_refused_by_its_name(coupling, fmu, tmp_path):
    with pytest.raises(InputError, match=r"\.fmu: rate = 'x': must be a number$"):
        coupled(coupling, fmu, tmp_path, rate="x")


@pytest.mark.parametrize(
    ("right", "wrong", "expected"),
    [
        ('"J"', '"lbf"', "VARIABLES: work: the unit 'lbf' is unknown; must be SI units such as"),
        ('"rad/s2"', '"rad/s/s"', "VARIABLES: rate: the unit 'rad/s/s' is unknown"),
        ('"input"', '"inputt"', "VARIABLES: tau: 'inputt': must be one of input, output, param"),
        ("CONNECTIONS", "CONNECTION", "has no table CONNECTIONS"),
        ("    BEGUN,\n", "", "VARIABLES: has no BEGUN"),
        ("    BEGUN,", '    ("begun", "output", "1", None, None, ""),', "VARIABLES: has no BEGUN$"),
        ("VARIABLES = (\n", "VARIABLES = (BEGUN,\n", "VARIABLES: begun: is listed 2 times$"),
        ('("work"', '("to do"', "VARIABLES: to do: must be the name of an attribute of the slave$"),
        (
            '("work"',
            '("guid"',
            "SteadyMotor: VARIABLES: guid: is an attribute of the slave already$",
        ),
        ("50.0", "'50'", "VARIABLES: rate: start = '50': must be a number$"),
        ("50.0", "1e999", "VARIABLES: rate: start = inf: must be a finite number$"),
        (
            "100.0, 0.0",
            "100.0, -1e999",
            "VARIABLES: w_start: minimum = -inf: must be a finite numb",
        ),
        (
            "100.0, 0.0",
            "100.0, 101",
            "VARIABLES: w_start: start = 100: must be >= its minimum, 101$",
        ),
        ("100.0, 0.0", "None, 1.5", "VARIABLES: w_start: start = 0: must be >= its minimum, 1.5$"),
        ('"work")', "3)", "VARIABLES: work: 'J', 3: unit and description must be texts$"),
        ('"J"', "None", "VARIABLES: work: None, 'work': unit and description must be texts$"),
        (
            "hold(globals())",
            "class B(TableSlave): pass",
            "B, SteadyMotor: must have one subclass of",
        ),
        (
            '"partner.tau"))\nI',
            '"partner.work"))\nI',
            r"CONNECTIONS: partner\.work: is of causality output; must be input$",
        ),
        (
            '"rotor.tau", "partner.tau"))\nI',
            '"rotor.w", "partner.w_start"))\nI',
            r"CONNECTIONS: partner\.w_start: is of causality parameter; must be input$",
        ),
        (
            '"partner.w_start", "rotor.speed")',
            '"partner.w_start", "rotor.w")',
            r"INITIAL: rotor\.w: is of causality local; must be input or parameter$",
        ),
        (
            "    VARIABLES = VARIABLES\n",
            "",
            "SteadyMotor: must have the line VARIABLES = VARIABLES$",
        ),
        ("def step", "def steps", "SteadyMotor: has no step$"),
        ("SteadyMotor(TableSlave)", "SteadyMotor", "none: must have one subclass of TableSlave$"),
    ],
)
def test_a_table_that_no_fmu_can_have_is_refused(fmu, tmp_path, right, wrong, expected):
    source = tmp_path / "steady_motor.py"
    source.write_text(SOURCE.replace(right, wrong))
    with pytest.raises(InputError, match=rf"steady_motor\.py: {expected}"):
        coupled(Coupling(source), fmu, tmp_path)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (None, r"partner\.py: cannot be read: No such file"),
        ("VARIABLES = (", r"^partner\.py: cannot be run: SyntaxError: "),
        ("1 / 0", r"^partner\.py: cannot be run: ZeroDivisionError: division by zero$"),
        ("raise SystemExit(3)", r"^partner\.py: cannot be run: SystemExit: 3$"),
        ("VARIABLES = [(1, 2)]", r"VARIABLES: \(1, 2\): each must be \(name, causality, "),
        ("VARIABLES = 3", r"^partner\.py: VARIABLES: 3: each must be \(name, causality, "),
    ],
)
def test_a_script_that_is_none_is_refused_in_one_line(tmp_path, text, expected):
    source = tmp_path / "partner.py"
    if text is not None:
        source.write_text(text)
    with pytest.raises(InputError, match=expected) as refused:
        Coupling(source).build(tmp_path)
    assert "\n" not in str(refused.value)


def test_pairs_that_are_none_are_refused(fmu, tmp_path):
    source = tmp_path / "steady_motor.py"
    source.write_text(f"{SOURCE}\nINITIAL = [('partner.w_start',)]\n")
    with pytest.raises(
        InputError, match=r"INITIAL: \('partner\.w_start',\): each must be \(output"
    ):
        coupled(Coupling(source), fmu, tmp_path)


@pytest.mark.parametrize(
    ("files", "expected"),
    [
        (None, r"other\.fmu: is not an FMU that can be read: No such file or directory$"),
        ({"a": "b"}, r"other\.fmu: is not an FMU that can be read: .*modelDescription"),
        ({"modelDescription.xml": "<a"}, r"other\.fmu: is not an FMU that can be read: "),
    ],
)
def test_a_file_that_is_no_fmu_is_refused_in_one_line(
    coupling, tmp_path, monkeypatch, files, expected
):
    other, extracted = tmp_path / "other.fmu", tmp_path / "extracted"
    extracted.mkdir()
    if files is not None:
        with zipfile.ZipFile(other, "w") as archive:
            for name, text in files.items():
                archive.writestr(name, text)
    partner = coupling.build(tmp_path)
    monkeypatch.setattr(tempfile, "tempdir", str(extracted))
    with pytest.raises(InputError, match=expected) as refused:
        coupling.run({"partner": partner, "rotor": other}, 0.1, 1e-3)
    assert "\n" not in str(refused.value)
    assert not list(extracted.iterdir())


def test_an_initial_value_of_a_name_that_the_fmu_lacks_is_refused(fmu, tmp_path):
    source = tmp_path / "steady_motor.py"
    source.write_text(SOURCE.replace('"partner.w_start"', '"partner.w_begin"'))
    with pytest.raises(InputError, match=r"SteadyMotor\.fmu: w_begin: unknown name"):
        coupled(Coupling(source), fmu, tmp_path)


@pytest.mark.parametrize(
    ("example", "script"),
    [
        pytest.param("drive_train", "run_up.py", marks=pytest.mark.slow),
        ("magnetic_bearing", "lift_and_drop.py"),
    ],
)
def test_the_script_of_a_copied_example_runs_from_anywhere(tmp_path, example, script):
    """As `rotor-fmu example NAME --out DIR` copies it."""
    shutil.copytree(example_folder(example), tmp_path / example)
    done = run_python(tmp_path / example / script, "--help", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "--step" in done.stdout
