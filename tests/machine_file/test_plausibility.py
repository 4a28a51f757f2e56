"""Values that nobody means are asked about; those of the examples are not."""

import warnings
from pathlib import Path

import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.simulation import RotorWarning

import rotor_fmu as rf
from rotor_fmu.machine_file.loading import machine_text
from rotor_fmu.machine_file.plausibility import implausible_values
from rotor_fmu.machine_studies.machine_tables import read_study

ROOT = Path(__file__).parents[2]
GOOD = [
    *(ROOT / "examples").glob("*/*.toml"),
    *(ROOT / "tests" / "reference").glob("ross*/*.toml"),
]
MACHINES = [path for path in GOOD if "[material" in path.read_text()]


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_a_machine_that_is_meant_is_not_asked_about(path):
    assert implausible_values(parse_rotor(machine_text("--rotor", path))) == []


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        (
            "young = 2.1e11",
            "young = 210.0",
            "material.young = 210 Pa: is that what is meant; 210 GPa?",
        ),
        (
            "density = 7800.0",
            "density = 7.8",
            "density = 7.8 kg/m3: is that what is meant; 7.8 g/cm3?",
        ),
        ("density = 7800.0", "density = 0.283", "0.283 lb/in3?"),
        (
            "diameter = 0.12",
            "diameter = 120.0",
            "disc[1].diameter = 120 m: is that what is meant; 120 mm?",
        ),
        (
            "clearance = 50e-6",
            "clearance = 50.0",
            "clearance = 50 m: is that what is meant; 50 mm?",
        ),
        (
            "clearance = 50e-6",
            "clearance = 0.04",
            "is larger than the journal, whose radius is 0.0075 m",
        ),
        ("e = 80e-6", "e = 0.08", "disc[1].e = 0.08 m: is that what is meant; 0.08 mm?"),
        (
            "e = 80e-6",
            "e = 80e-6\nphase = 90.0",
            "disc[1].phase = 90 rad: is that what is meant; 90 deg?",
        ),
        (
            "diameter = 0.12\nwidth = 0.02",
            "diameter = 19.0\nwidth = 19.0",
            "has a mass of 4.202e+04 t",
        ),
        (
            "rated_speed = 400.0",
            "rated_speed = 30e3",
            "rated_speed = 30000 rad/s: moves the rim of the largest disc at 1800 m/s; 30000 rpm?",
        ),
        (
            "rated_speed = 400.0",
            "trip_speed = 30e4",
            "operation.trip_speed = 300000 rad/s: moves the rim of the largest disc at 1.8e+04 m/s",
        ),
        ("mu = ", "mu = 5.0 # ", "bearing[1].mu = 5: is that what is meant; 5 percent?"),
        (
            "[operation]",
            "[[seal]]\nnode = 3\nadded_mass = 2e4\nkxx = 1e6\nkyy = 1e6\ncxx = 1e3\ncyy = 1e3\n"
            "[operation]",
            "seal[1].added_mass = 20000 kg: is that what is meant; 20000 g?",
        ),
        (
            "[operation]",
            "[[body]]\nnode = 3\nmass = 1.0\nI_d = 0.001\nI_p = 0.0021\n[operation]",
            "body[1].I_p = 0.0021 kg.m2: no body has more than twice its I_d, which is 0.001 kg.m2",
        ),
    ],
)
def test_what_was_probably_meant_is_said(old, new, expected):
    toml = rig_toml()
    assert old in toml
    warnings = implausible_values(parse_rotor(toml.replace(old, new)))
    assert any(expected in warning for warning in warnings)


@pytest.mark.parametrize("given", ["20.0", "[30.0, 20.0]\nspeed = [100.0, 200.0]"])
def test_a_viscosity_in_millipascal_seconds_is_asked_about(given):
    toml = (ROOT / "examples" / "oil_film" / "rotor.toml").read_text()
    shown = given.strip("[").split(".")[0]
    warnings = implausible_values(
        parse_rotor(toml.replace("viscosity = 0.02", f"viscosity = {given}"))
    )
    assert len(warnings) == 2
    for warning in warnings:
        assert f".viscosity = {shown} Pa.s: is that what is meant; {shown} mPa.s?" in warning


LYING = {"stiffness = 312500.0": "stiffness = 0.0", "short = true": "roughness = 3e-7"}


def on_its_wall(**others):
    """The machine of the example on squeeze film dampers, heavy, its rings lying on their walls."""
    toml = (ROOT / "examples" / "squeeze_film" / "rotor.toml").read_text()
    for old, new in (LYING | {"gravity = 0.0": "gravity = 9.81"} | others).items():
        assert old in toml
        toml = toml.replace(old, new)
    return toml


def test_a_ring_that_lies_in_a_film_of_wide_elements_is_named_and_what_it_needs_is_enough():
    """With the usual 48 the run takes 183 000 steps, and is doubtful."""
    sentence, other = implausible_values(parse_rotor(on_its_wall()))
    assert sentence.startswith("squeeze_film_damper[1].points = 48: no spring holds the ring")
    assert other.replace("[2]", "[1]") == sentence
    needed = int(sentence.rsplit(maxsplit=1)[1])
    assert needed == 173
    points = {"mu = 0.1": f"mu = 0.1\npoints = {needed}"}
    assert implausible_values(parse_rotor(on_its_wall(**points))) == []
    run = rf.simulate(rf.parse(on_its_wall(**points)), speed=20.0, stop=0.1)
    assert run.status == "ok"
    assert run.points.columns["solver.steps"][-1] < 20_000


@pytest.mark.parametrize(
    "held",
    [
        {"stiffness = 312500.0": "stiffness = 1.0"},
        {"short = true": "short = true\nroughness = 3e-7"},
        {"short = true": "sealed = true\nroughness = 3e-7"},
        {"k = 1e8": "k = 0.0"},
        {"# A stiff": "support = [{node = 1, stiffness = 1e5}, {node = 3, stiffness = 1e5}]\n#"},
    ],
)
def test_a_ring_that_does_not_lie_in_such_a_film_is_not_named(held):
    assert implausible_values(parse_rotor(on_its_wall(**held))) == []


def test_more_elements_than_may_be_are_not_asked_for():
    smooth = parse_rotor(on_its_wall(**{"short = true": "roughness = 3e-9"}))
    assert [each[-4:] for each in implausible_values(smooth)] == ["1024"] * 2


def test_a_command_says_it_and_goes_on_and_python_warns(tmp_path, process):
    file = tmp_path / "rig.toml"
    file.write_text(rig_toml().replace("density = 7800.0", "density = 7.8"))
    said = process("show", "--rotor", str(file))
    assert f"rotor-fmu: warning: {file}: material.density = 7.8 kg/m3: is that" in said.stderr
    assert "disc[1]" in said.stdout
    with pytest.warns(RotorWarning, match=r"7\.8 g/cm3\?"):
        rf.load(file)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rf.load()


MEANT = {
    "4:50": "4:-50g.mm",
    "4:20": "4:20mm",
    "50": "50g.mm",
    "disc[1].phase=90": "disc[1].phase=90deg",
}
RAMP = ("--direct", "--from", "100", "--to", "99", "--rate", "100")


@pytest.mark.usefixtures("without_peaks")
@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (
            ["unbalance", "--speed", "100", "--unbalance", "4:50"],
            "--unbalance 4:50: amount = 50 kg.m: is that what is meant; 50 g.mm?",
        ),
        (
            ["unbalance", "--speed", "100", "--range", "90:100", "--clearance", "4:20"],
            "--clearance 4:20: clearance = 20 m: is that what is meant; 20 mm?",
        ),
        (
            ["balance", "--speed", "100", "--plane", "99", "--trial", "50"],
            "--trial 50: amount = 50 kg.m: is that what is meant; 50 g.mm?",
        ),
        (
            ["run-down", *RAMP, "--set", "disc[1].phase=90"],
            "--set disc[1].phase = 90 rad: is that what is meant; 90 deg?",
        ),
        pytest.param(
            ["response", "--speed", "5:6", "--step", "3", "--set", "disc[1].phase=90"],
            "--set disc[1].phase = 90 rad: is that what is meant; 90 deg?",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_an_option_is_asked_about_by_the_rule_of_the_file(process, tmp_path, arguments, expected):
    said = process(*arguments, "--out", str(tmp_path)).stderr
    assert f"rotor-fmu: warning: {expected}" in said
    arguments = [MEANT.get(text, text) for text in arguments]
    assert "warning" not in process(*arguments, "--out", str(tmp_path)).stderr


def test_arguments_in_python_are_asked_about():
    """At the line that gave them."""
    jeffcott = rf.load(ROOT / "examples" / "jeffcott_rub" / "jeffcott.toml")
    name = "unbalance[1].phase"
    with warnings.catch_warnings(record=True) as seen:
        warnings.simplefilter("always")
        rf.simulate(jeffcott, speed=10.0, stop=0.01, parameters={name: 90.0})
        rf.response(jeffcott, speed=(10.0, 11.0), parameters={name: 90.0}, step=3.0)
        rf.response(jeffcott, speed=10.0, over=(name, 90.0, 90.1), step=3.0)
        rf.simulate(jeffcott, speed=10.0, stop=0.01, parameters={name: "90 deg"})
    assert [(str(each.message), each.filename) for each in seen] == [
        (f"{where} {name} = {value} rad: is that what is meant; {value} deg?", __file__)
        for where, value in (
            ("parameters:", 90),
            ("parameters:", 90),
            ("over:", 90),
            ("over:", 90.1),
        )
    ]


STUDY = """
machine = "rig"
[run]
kind = "constant"
speed = 100.0
turns = 2
[set]
"disc[1].phase" = {phase}
[vary."disc[2].phase"]
values = [{other}, 0.0]
[keep]
touching = {{ contact = "bearing[2]" }}
"""


def test_values_of_a_study_are_asked_about(tmp_path, capsys):
    file = tmp_path / "study.toml"
    for phase, other in (("1.0", "1.5"), ('"90 deg"', '"90 deg"')):
        file.write_text(STUDY.format(phase=phase, other=other))
        read_study(file)
        assert not capsys.readouterr().err
    file.write_text(STUDY.format(phase="90.0", other="80.0"))
    read_study(file)
    assert capsys.readouterr().err.splitlines() == [
        f"rotor-fmu: warning: {where} = {value} rad: is that what is meant; {value} deg?"
        for where, value in (("set disc[1].phase", 90), ("vary disc[2].phase: disc[2].phase", 80))
    ]


def test_a_run_at_a_speed_that_bursts_a_disc_is_doubtful():
    """As where a speed in rpm is given in rad/s, in either sense; below it is not."""
    highest = 1500.0 / 0.06  # of the rig's discs
    assert rf.simulate(rf.load(), speed=0.99 * highest, stop=1e-4).status == "ok"
    for speed in (1.01 * highest, -1.01 * highest):
        with pytest.warns(RotorWarning, match=r"above 2\.5e\+04 rad/s, .* meant in rpm"):
            run = rf.simulate(rf.load(), speed=speed, stop=1e-4)
        assert run.status.startswith("doubtful: burst-speed")
