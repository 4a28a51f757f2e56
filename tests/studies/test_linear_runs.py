"""Studies of linear answers: each column is the closed form of a mass on springs, or what the
analysis itself answers for the machine with those numbers in its file."""

import math

import numpy as np
import pytest
from rotor_fmu.model.linear import campbell, modes, response_with_peaks
from rotor_fmu.model.machine.toml import parse_rotor

from rotor_fmu.errors import InputError
from rotor_fmu.machine_studies.machine_tables import read_study

from ..linear.api_617 import SHAFT
from ..parts.machines import bearings, rigid
from ..toml_text import table

K, C, MASS, U = 1e4, 20.0, 1.0, 1e-5
SPRINGS = rigid(MASS, 9.81, bearings(K, C) + f"[[unbalance]]\nnode = 2\namount = {U}\n")
KEEP = """
slower = { subsynchronous = "log_dec" }
at = { subsynchronous = "frequency" }
first = { mode = "log_dec" }
frequency = { mode = "frequency", number = 2 }
ninth = { mode = "frequency", number = 9 }
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
        **dict.fromkeys(("at", "frequency", "ninth", "critical", "third", "threshold"), "rad/s"),
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
    found = modes(rotor, 300.0, count=12)
    assert cells["ninth"] == found.damped[8]
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


def test_an_answer_beyond_a_table_is_doubtful(tmp_path):
    """At the speed itself, or in the range, whichever is asked for."""
    keys = {"node": 1, "speed": [10.0, 100.0], "kxx": [90.0, 99.0], "kyy": 90.0}
    bearing = table("[linear_bearing]", **keys, cxx=1.0, cyy=1.0)
    asked = {"critical": "at = { critical = 'speed' }", "mode": "at = { mode = 'frequency' }"}
    status = {
        name: study(tmp_path, SPRINGS + bearing, keep=keep).model.run({}).status
        for name, keep in asked.items()
    }
    assert status == {"critical": "doubtful: beyond-table", "mode": "ok"}


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
