"""Studies of linear answers: each column is the closed form of a mass on springs, or what the
analysis itself answers for the machine with those numbers in its file."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import campbell, modes, response_with_peaks
from rotor_fmu.model.machine.toml import parse_rotor

import rotor_fmu as rf
from rotor_fmu.cli.studies import _select
from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study

from ..linear.api_617 import SHAFT
from ..parts.machines import bearings, rigid, shaft
from ..toml_text import table

K, C, MASS, U = 1e4, 20.0, 1.0, 1e-5
SPRINGS = rigid(MASS, 9.81, bearings(K, C) + f"[[unbalance]]\nnode = 2\namount = {U}\n")
KEEP = """
slower = { subsynchronous = "log_dec" }
at = { subsynchronous = "frequency" }
first = { mode = "log_dec" }
frequency = { mode = "frequency", number = 2 }
critical = { critical = "speed" }
damping = { critical = "log_dec" }
third = { critical = "speed", number = 3 }
threshold = { threshold = "speed" }
moved = { amplitude = "unbalance[1]" }
most = { peak = "point_mass[1]" }
load = { load = "linear_bearing[2]" }
"""


def study(folder, machine, *, keep=KEEP, vary="gravity", run="speed = 60\nto = 200\n"):
    (folder / "machine.toml").write_text(machine)
    file = folder / "study.toml"
    file.write_text(
        f"machine = 'machine.toml'\n[run]\nkind = 'linear'\n{run}"
        f"[keep]\n{keep}\n[vary]\n'{vary}' = {{ values = [0.1, 0.2] }}\n"
    )
    return read_study(file)


def test_a_mass_on_springs_has_its_closed_forms(tmp_path):
    model = study(tmp_path, SPRINGS).model
    cells = model.run({"gravity": 5.0}).cells
    decay, omega = C / (2 * MASS), math.sqrt(K / MASS)
    damped = math.sqrt(omega**2 - decay**2)
    log_dec = 2 * math.pi * decay / damped

    def orbit(speed):
        return U * speed**2 / abs(K - MASS * speed**2 + 1j * C * speed)

    assert cells["first"] == pytest.approx(log_dec, rel=1e-4)
    assert cells["frequency"] == pytest.approx(damped, rel=1e-5)
    assert cells["critical"] == pytest.approx(damped, rel=1e-5)
    assert cells["damping"] == pytest.approx(log_dec, rel=1e-4)
    assert cells["moved"] == pytest.approx(orbit(60.0), rel=1e-4)
    assert cells["most"] == pytest.approx(
        orbit(omega / math.sqrt(1 - 2 * (decay / omega) ** 2)), rel=1e-4
    )
    assert cells["load"] == pytest.approx(0.98 * 5.0 * MASS, rel=1e-5)
    assert math.isnan(cells["third"])
    assert math.isnan(cells["threshold"])
    assert {c.name: c.unit for c in model.columns} == {
        **dict.fromkeys(("slower", "first", "damping"), "1"),
        **dict.fromkeys(("at", "frequency", "critical", "third", "threshold"), "rad/s"),
        **dict.fromkeys(("moved", "most"), "m"),
        "load": "N",
    }


def test_a_machine_is_the_one_with_these_numbers_in_its_file(tmp_path):
    """Of a film's preload, which no FMU takes; the threshold is that of its whirl."""
    film = """
[[journal_bearing]]
node = 3
length = 0.02
journal_radius = 0.015
clearance = 4e-5
viscosity = 0.02
pads = [1.0, 3.1, 5.2]
arc = 1.9
preload = 0.1
[[journal_bearing]]
node = 5
length = 0.02
journal_radius = 0.015
clearance = 4e-5
viscosity = 0.02
"""
    text, keep = SHAFT + film, KEEP.replace("point_mass[1]", "disc[1]").replace("linear", "journal")
    keep = keep.replace("unbalance[1]", "disc[1]")
    run, name = "speed = 300\nto = 1500\n", "journal_bearing[1].preload"
    cells = study(tmp_path, text, keep=keep, vary=name, run=run).model.run({name: 0.4}).cells
    rotor = parse_rotor(text.replace("preload = 0.1", "preload = 0.4"))
    found = modes(rotor, 300.0)
    slowest = found.log_dec[found.damped < 300.0].argmin()
    assert (cells["slower"], cells["at"]) == (found.log_dec[slowest], found.damped[slowest])
    diagram = campbell(rotor, np.linspace(150.0, 1500.0, 16))
    assert cells["threshold"] == pytest.approx(diagram.threshold, rel=1e-9)
    peaks = [c.speed for c in diagram.critical if not c.is_critically_damped]
    assert cells["critical"] == pytest.approx(next(iter(peaks), math.nan), nan_ok=True)
    node = rotor.discs[0].node
    response = response_with_peaks(rotor, np.linspace(150.0, 1500.0, 16), nodes=[node])
    assert cells["most"] == pytest.approx(response.major[:, node - 1].max(), rel=1e-6)


def test_what_leaves_its_rest_without_a_vibration_has_no_decrement(tmp_path):
    model = study(tmp_path, SPRINGS, vary="linear_bearing[2].kxx").model
    assert model.run({"linear_bearing[2].kxx": -1e6}).cells["slower"] == -math.inf


@pytest.mark.parametrize(
    ("keep", "said"),
    [
        ("a = { subsynchronous = 'speed' }", "subsynchronous = 'speed': must be one of log_dec, f"),
        ("a = { critical = 'sped' }", "keep a: critical = 'sped': must be one of speed, log_dec"),
        ("a = { mode = 'log_dec', number = 0 }", "keep a: number = 0: must be an integer, 1 or"),
        ("a = { amplitude = 'unbalanc[1]' }", "keep a: unbalanc[1]: unknown name; did you mean un"),
        ("a = { load = 'unbalance[1]' }", "keep a: unbalance[1]: unknown name; "),
    ],
)
def test_an_answer_that_there_is_not_is_refused(keep, said, tmp_path):
    with pytest.raises(InputError) as refused:
        study(tmp_path, SPRINGS, keep=keep)
    assert said in str(refused.value)


def test_the_range_must_ascend(tmp_path):
    with pytest.raises(InputError, match=r"run.from = 300 rad/s: must be >= 0 and below run.to = "):
        study(tmp_path, SPRINGS, run="from = 300\nto = 200\n")


def test_a_page_offers_no_signals_of_linear_answers(tmp_path):
    """The command that it would name is refused."""
    of_answers = study(tmp_path, SPRINGS)
    assert not of_answers.about["can_be_selected"]
    with pytest.raises(InputError, match="--select: only of a machine's runs in time, and of "):
        _select(of_answers, "0", tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_as_many_modes_are_computed_as_are_asked_for(tmp_path):
    keep = "a = { mode = 'frequency', number = 10 }"
    cells = study(tmp_path, SHAFT, keep=keep).model.run({}).cells
    assert cells["a"] == modes(parse_rotor(SHAFT), 60.0, count=10).damped[9]


def test_a_body_beyond_its_node_moves_as_it_does_in_a_run(tmp_path):
    """It overhangs the shaft's end and tilts: where a run observes it the orbit is half again that
    of the node."""
    ends = "".join(table("[support]", node=n, stiffness=1e7, damping=500.0) for n in (1, 3))
    body = table("[body]", node=4, mass=5.0, I_d=0.02, I_p=0.03, offset=0.1)
    text = shaft(0.0, 0.3, 0.6, 0.8, diameter=0.03) + "eta_v = 2e-4\n" + ends + body
    text = "gravity = 0.0\n" + text + table("[unbalance]", node=4, offset=0.1, amount=1e-4)
    keep = "a = { amplitude = 'body[1]' }\nb = { peak = 'body[1]' }"
    cells = study(tmp_path, text, keep=keep, run="speed = 150\nto = 150\n").model.run({}).cells
    run = rf.simulate(rf.parse(text), speed=150.0, stop=3.0, tolerance=1e-5)
    moved = math.hypot(run["body[1].x"][-1], run["body[1].y"][-1])
    assert cells["a"] == cells["b"] == pytest.approx(moved, rel=1e-4)


def test_a_row_beyond_what_a_part_is_known_for_is_doubtful_as_a_run_is(tmp_path):
    """A disc of 0.3 m bursts at 10000 rad/s; what is of the range is of all of it."""
    disc = SPRINGS + table("[disc]", node=2, diameter=0.3, width=0.001)
    for run, keep, status in (
        ("speed = 60\nto = 200\n", KEEP, "ok"),
        ("speed = 10001\nto = 200\n", KEEP, "doubtful: burst-speed"),
        ("speed = 60\nto = 10001\n", "a = { peak = 'disc[1]' }", "doubtful: burst-speed"),
        ("speed = 60\nto = 10001\n", "a = { amplitude = 'disc[1]' }", "ok"),
    ):
        assert study(tmp_path, disc, keep=keep, run=run).model.run({}).status == status
