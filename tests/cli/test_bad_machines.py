"""Machine files that are wrong: one plain line, no traceback, no hang, whatever is in them."""

import math
import re
from pathlib import Path

import pytest
from rotor_fmu.model.linear import modes
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.quantities import QuantityError
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import EquilibriumError, RotorWarning, Simulation

import rotor_fmu as rf
from rotor_fmu.fmi.description import Described
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.documents import documents
from rotor_fmu.linear.machine_warnings import machine_warnings
from rotor_fmu.machine_file.loading import machine_text

from ..mutations import one_line, outcomes
from ..parts.machines import shaft

EXAMPLES = Path(__file__).parents[2] / "examples"
BASES = (
    rig_toml(),
    (EXAMPLES / "magnetic_bearing" / "compressor.toml").read_text(encoding="utf-8"),
    (EXAMPLES / "jeffcott_rub" / "jeffcott.toml").read_text(encoding="utf-8"),
    machine_text("file", EXAMPLES / "from_ross" / "rubbing.toml"),
    """
gravity_angle = 0.1
[material.steel]
young = 2.1e11
density = 7800.0
[material.brass]
young = 1e11
density = 8400.0
poisson = 0.35
[shaft]
eta_v = 1e-5
rotating_damping = true
[[section]]
length = 0.1
outer_left = 0.02
outer_right = 0.03
bore = 0.01
elements = 2
[[section.layer]]
outer = 0.05
bore = 0.03
material = "brass"
[[section]]
length = 0.2
outer = 0.03
axial_force = 100.0
shear = "hutchinson"
[[housing]]
name = "left"
mass = 1.0
kx = 1e7
ky = 2e7
cx = 100.0
cy = 100.0
[[linear_bearing]]
node = 1
housing = "left"
kxx = [1e6, 2e6, 3e6]
kyy = 1e6
kxy = [1e4, 2e4, 3e4]
cxx = 100.0
cyy = [100.0, 200.0, 150.0]
speed = [0.0, 200.0, 500.0]
[[seal]]
node = 3
kxx = 1e5
kyy = 1e5
cxx = 50.0
cyy = 50.0
[[linear_bearing]]
z = 0.3
kxx = 1e6
kyy = 1e6
cxx = 100.0
cyy = 100.0
[[touchdown_bearing]]
node = 2
housing = "left"
journal_radius = 0.02
clearance = 1e-4
mu = 0.2
k = 1e8
exponent = 1.5
wear = 1e-5
race_inertia = 1e-4
race_drag = 0.01
[[point_mass]]
node = 3
mass = 2.0
[[unbalance]]
node = 3
amount = 1e-5
phase = 1.0
[[port]]
node = 2
name = "magnet"
[[sensor]]
node = 3
name = "probe"
[base]
[start]
x = 1e-5
vy = 0.01
""",
)


def used(text):
    """What becomes of a file: read, judged, described, started and run for some steps."""
    rotor = parse_rotor(text)
    machine_warnings(rotor)
    documents(Described(rotor, "Machine", needs_python=True), interface(rotor), fmi=2)
    try:
        modes(rotor, 100.0)
    except QuantityError as error:
        one_line(error)
    for preset in ("controlled", "robust"):
        simulation = Simulation(rotor, choose(preset), speed=100.0, warn=one_line)
        simulation.advance(2e-3, 100.0)


@pytest.fixture(scope="module")
def compiled():
    """What compiles takes longer than a file may."""
    for base in BASES[::4]:
        used(base)


@pytest.mark.parametrize("base", range(len(BASES)))
def test_what_is_mutated_is_sound(base):
    assert parse_rotor(BASES[base]).parts


@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("first", [0, pytest.param(20, marks=pytest.mark.slow)])
def test_twenty_mutated_machine_files_are_read_or_refused_in_one_line(first):
    result = outcomes(BASES, used, range(first, first + 20))
    assert 0 < sum(reason is None for reason in result) < 20


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("block", range(10))
def test_five_hundred_mutated_machine_files_are_read_or_refused_in_one_line(block):
    result = outcomes(BASES, used, range(100 + 50 * block, 150 + 50 * block))
    assert 0 < sum(reason is None for reason in result) < 50


@pytest.mark.parametrize("seed", [179, 583, 637])
def test_what_a_mutated_file_once_broke_is_refused(seed):
    """A housing that is a number; a length of 1e-300 m."""
    assert outcomes(BASES, used, [seed]) != [None]


# --- what is doubtful, and what is too much ---

HELD = (
    shaft(0.0, 0.1, 0.2)
    + """
[[body]]
node = 2
mass = 1.0
I_d = 0.001
I_p = 0.002
"""
)


def bearing(node, k=1e5, c=100.0, cross=0.0):
    return (
        f"[[linear_bearing]]\nnode = {node}\nkxx = {k}\nkyy = {k}\nkxy = {cross}\n"
        f"kyx = {-cross}\ncxx = {c}\ncyy = {c}\n"
    )


def said(text, **options):
    """What a simulation of a machine warns of as it begins."""
    messages = []
    Simulation(parse_rotor(text), choose("robust"), warn=messages.append, **options)
    return messages


@pytest.mark.parametrize("made", [{"c": -20.0}, {"cross": 5e4}], ids=["damping", "cross coupling"])
@pytest.mark.parametrize("speed", [0.0, 300.0])
def test_a_machine_unstable_at_rest_is_warned_of_with_the_mode_and_its_log_dec(made, speed):
    text = HELD + bearing(1, **made) + bearing(3, **made)
    result = modes(parse_rotor(text), 0.0)
    worst = result.log_dec.argmin()
    assert result.log_dec[worst] < 0
    (output,) = (m for m in said(text, speed=speed) if "at rest" in m)
    assert machine_warnings(parse_rotor(text)) == [output]
    hz, decrement = map(float, re.search(r"of (\S+) Hz .* decrement being (\S+);", output).groups())
    assert hz == pytest.approx(result.damped[worst] / (2 * math.pi), rel=1e-3)
    assert decrement == pytest.approx(result.log_dec[worst], rel=1e-2)


def test_a_machine_that_leaves_its_equilibrium_is_warned_of():
    text = HELD + bearing(1, k=-1e5) + bearing(3, k=-1e5)
    (output,) = (m for m in said(text) if "at rest" in m)
    assert "without oscillating" in output
    assert machine_warnings(parse_rotor(text)) == [output]


def test_a_machine_that_no_torque_can_drive_is_warned_of_when_its_fmu_is_built(tmp_path):
    held = shaft(0.0, 0.1, 0.2) + bearing(1) + bearing(3)
    text = held + "[[point_mass]]\nnode = 2\nmass = 1.0\n[[unbalance]]\nnode = 2\namount = 0.01\n"
    rotor = parse_rotor(text)
    with pytest.raises(EquilibriumError, match="a torque drives the rotor") as refused:
        Simulation(rotor, choose("robust"), speed=100.0, drive_torque=0.0)
    assert machine_warnings(rotor, is_free=True) == [str(refused.value)]
    assert machine_warnings(rotor) == []
    with pytest.warns(RotorWarning) as warned:
        rf.build_fmu(rf.parse(text), tmp_path, is_free=True)
    assert [str(warning.message) for warning in warned] == [str(refused.value)]


def test_a_stable_machine_is_not_doubted():
    for text in (rig_toml(), *BASES[1:4], HELD + bearing(1) + bearing(3)):
        assert machine_warnings(parse_rotor(text)) == []
        assert not [m for m in said(text, speed=100.0) if "at rest" in m]


def test_a_machine_that_nothing_holds_is_refused_unless_it_is_released_in_the_air():
    (output,) = machine_warnings(parse_rotor(HELD))
    assert "is not held" in output
    with pytest.raises(EquilibriumError, match="supported at 0 of its nodes"):
        said(HELD)
    released = f"{HELD}[start]\ny = 0.0\n"
    assert machine_warnings(parse_rotor(released)) == []
    assert said(released) == []


@pytest.mark.parametrize(
    ("shaft", "message"),
    [
        (
            "[[section]]\nlength = 1.0\nouter = 0.1\nelements = 1000000\n",
            "section[1].elements = 1000000: must be an integer from 1 to 1000",
        ),
        (
            2 * "[[section]]\nlength = 1.0\nouter = 0.1\nelements = 600\n",
            "section[2].elements = 600: a shaft has at most 1000 elements, and 600 lie before",
        ),
        (
            f"[shaft]\nnodes = {[1e-3 * i for i in range(5001)]}\ndiameters = {[0.02] * 5000}\n",
            "shaft.nodes: 5001 given, at most 1001",
        ),
    ],
)
def test_too_many_nodes_are_refused_with_the_limit(shaft, message):
    with pytest.raises(QuantityError, match=re.escape(message)):
        parse_rotor(f"[material]\nyoung = 2.1e11\ndensity = 7800.0\n{shaft}")


def table(**changed):
    given = {"node": "1", "kxx": "[1e6, 2e6, 3e6]", "kyy": "1e6", "cxx": "1.0", "cyy": "1.0"}
    given |= {"speed": "[0.0, 100.0, 200.0]"} | changed
    return "[[linear_bearing]]\n" + "".join(f"{k} = {v}\n" for k, v in given.items() if v)


@pytest.mark.parametrize(
    ("part", "message"),
    [
        (
            table(speed="[0.0, 200.0, 100.0]"),
            "linear_bearing[1].speed[3] = 100 rad/s: must be above",
        ),
        (
            table(speed="[0.0, 100.0, 100.0]"),
            "linear_bearing[1].speed[3] = 100 rad/s: must be above",
        ),
        (
            table(speed="[0.0, nan, 100.0]"),
            "linear_bearing[1].speed[2] = nan rad/s: must be a finite",
        ),
        (table(kxx="[1e6, nan, 1e6]"), "linear_bearing[1].kxx[2] = nan N/m: must be a finite"),
        (table(kxx="[1e6, 1e6]"), "linear_bearing[1].kxx: 2 given, 3 needed"),
        (table(kyy=""), "linear_bearing[1].kyy is missing"),
        (2 * "[[coupling]]\nnode = 1\ndiameter = 0.1\nwidth = 0.1\n", "coupling = [{"),
        ("[[port]]\nname = 'a'\n", "port[1].node is missing"),
        ("[[port]]\nnode = 4\n", "port[1].node = 4: must be an integer from 1 to 3"),
        ("[[port]]\nz = 0.4\n", "port[1].z = 0.4 m: must lie on the shaft, from 0 to 0.2 m"),
        (2 * "[[port]]\nnode = 1\nname = 'p'\n", "port[2].name = p: port[1] has this name already"),
    ],
)
def test_a_wrong_table_or_port_is_refused_by_name(part, message):
    with pytest.raises(QuantityError, match=re.escape(message)):
        parse_rotor(HELD + bearing(3) + part if "linear" not in part else HELD + part + bearing(3))


def test_a_refused_machine_leaves_nothing_half_written(tmp_path, input_error):
    (tmp_path / "bad.toml").write_text(HELD + bearing(1, k="nan"), encoding="utf-8")
    for command in ("build", "run-down", "modes", "show"):
        line = input_error(command, "--rotor", "bad.toml", "--out", "out")
        assert "linear_bearing[1].kxx = nan N/m" in line


def test_a_study_is_not_called_a_machine_of_unknown_keys(tmp_path, input_error):
    (tmp_path / "study.toml").write_text("machine = 'rig'\n[vary]\n'run.speed' = [1.0]\n")
    assert input_error("modes", "--rotor", "study.toml") == (
        "rotor-fmu: --rotor study.toml: is a study, not a machine: rotor-fmu study runs it"
    )


@pytest.mark.parametrize("name", ["''", "' '", "7"])
def test_a_machine_has_a_name_that_can_be_read(name):
    with pytest.raises(QuantityError, match=r"^name = .*: must be text, not empty"):
        parse_rotor(f"name = {name}\n{HELD}{bearing(1)}")


@pytest.mark.parametrize("command", ["build", "run-down", "modes"])
def test_units_of_a_file_that_are_none_are_refused_with_its_name(tmp_path, input_error, command):
    (tmp_path / "units.toml").write_text(f"units = 'rmp'\n{HELD}{bearing(1)}")
    line = input_error(command, "--rotor", "units.toml", "--out", "out")
    assert line.startswith("rotor-fmu: units.toml: units = rmp: 'rmp' must be one of si, us, Hz,")
    assert not (tmp_path / "out").exists()


def test_a_start_of_the_shaft_that_is_no_number_is_refused_by_its_own_name():
    section = "[[section]]\nlength = 0.1\nouter = 0.01\n"
    text = f"[material]\nyoung = 2e11\ndensity = 7800\n[shaft]\nstart = [1]\n{section}"
    with pytest.raises(QuantityError, match=r"^shaft\.start = \[1\]: must be a number"):
        parse_rotor(text)
