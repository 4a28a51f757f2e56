"""The check of clearances with contacts: ranges of a single speed, and runs that fail."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from rotor_fmu.model.linear import modes, static, unbalance_response
from rotor_fmu.model.machine.operating_speeds import Operation
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.message_templates import Message

from rotor_fmu.api.simulate import simulate
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.machine_report import rub_check as module
from rotor_fmu.machine_report.report_page import ReportOptions, machine_report
from rotor_fmu.machine_report.rub_check import rub_check
from rotor_fmu.machine_report.rub_shown import rub_figure, runs_table
from rotor_fmu.machine_report.unbalanced import with_unbalances

from ..known import EXAMPLES
from ..toml_text import table

_JEFFCOTT = """
gravity = 0.0
[material]
young = 2.1e11
density = 7800.0
[shaft]
nodes = [0.0, 0.3, 0.6]
diameters = [0.02, 0.02]
[[disc]]
node = 2
diameter = 0.2
width = 0.02
e = 1e-4
[[contact]]
node = 2
journal_radius = 0.01
clearance = 1e-5
mu = 0.02
"""
_BEARING = """
[[linear_bearing]]
node = {node}
kxx = 1e6
kyy = 1e6
kxy = {crossed}
kyx = -{crossed}
cxx = {c}
cyy = {c}
"""


def _machine(k, c, crossed):
    bearings = (_BEARING.format(node=node, c=c, crossed=crossed) for node in (1, 3))
    return parse_rotor(f"{_JEFFCOTT}k = {k}\n{''.join(bearings)}")


@pytest.mark.usefixtures("coarse_report")
@pytest.mark.parametrize("low", [300.0, pytest.param(299.0, marks=pytest.mark.slow)])
def test_a_rub_that_lasts_is_told_of_a_rated_speed_too(low):
    """An unbalance of 0.1 mm above the critical speed, in a ring of 10 um so soft that it changes
    nothing: the journal rubs all around."""
    check = rub_check(_machine(1e4, 300.0, 0.0), low, 300.0)
    for run in check.runs:
        assert run.contacts[0].share_in_range == 1.0
    assert "The rub lasts in the operating range (contact[1]), in both directions." in (
        check.conclusion
    )


@pytest.mark.usefixtures("coarse_report")
def test_a_rub_that_bounces_once_a_turn_lasts():
    """The shaft's orbit of 0.1 mm about its sag of 0.19 mm reaches a hard ring in every turn."""
    bearings = "".join(_BEARING.format(node=node, c=300.0, crossed=0.0) for node in (1, 3))
    hard = f"{_JEFFCOTT}k = 1e10\n{bearings}".replace("gravity = 0.0", "")
    check = rub_check(parse_rotor(hard.replace("1e-5", "2.6e-4")), 240.0, 300.0)
    for run in check.runs:
        assert run.contacts[0].share_in_range < 0.02
        assert run.contacts[0].turns_in_range > 0.95
    assert "The rub lasts in the operating range (contact[1]), in both" in check.conclusion


@pytest.mark.usefixtures("coarse_report")
def test_the_force_of_a_hard_contact_is_the_largest_of_all_steps(monkeypatch):
    """Bounces last less than a 64th of a turn, at which runs are recorded unless told otherwise."""
    runs = []

    def seen(*arguments, **options):
        whole = simulate(*arguments, **options | {"per_turn": None})
        _, begin, reached, _, end = options["speed"][0]
        up = (whole.t >= begin) & (whole.t <= reached)
        runs.extend(((whole, up), (whole, (whole.t >= reached) & (whole.t <= end))))
        return simulate(*arguments, **options)

    monkeypatch.setattr(module, "simulate", seen)
    hard = f"{_JEFFCOTT}k = 1e9\n".replace("gravity = 0.0", "").replace("1e-5", "2e-4")
    bearings = "".join(_BEARING.format(node=node, c=300.0, crossed=0.0) for node in (1, 3))
    check = rub_check(parse_rotor(hard + bearings), 299.0, 300.0)
    for run, (whole, during) in zip(check.runs, runs, strict=True):
        touched = during & (whole["contact[1].contact"] > 0.5)
        assert run.contacts[0].first == whole.speed[touched][0]
        assert run.contacts[0].last == whole.speed[touched][-1]
        assert run.contacts[0].force == whole["contact[1].fn"][during].max()


@pytest.mark.usefixtures("coarse_report")
def test_the_run_down_of_a_machine_with_little_damping_begins_where_the_run_up_ends():
    """Below its critical speed, with a log dec of 0.02. A start at the highest speed doubled the
    motion there, and 60 turns of it damped hardly any of that."""
    machine = _machine(100.0, 160.0, 0.0)
    assert modes(machine, 140.0, count=1).log_dec[0] == pytest.approx(0.02, rel=0.05)
    check = rub_check(machine, 130.0, 140.0)
    for run in check.runs:
        seen = (run.speed >= check.low) & (run.speed <= check.high)
        linear = np.interp(run.speed[seen], check.speed, check.linear)
        assert run.amplitude[seen] == pytest.approx(linear, rel=0.17)


def test_a_response_that_closes_no_contact_says_nothing_of_other_clearances():
    """Those given for seals beside it may be closed."""
    rotor = _machine(1e4, 300.0, 0.0)
    parts = tuple(part for part in rotor.parts if not hasattr(part, "mu"))
    conclusion = rub_check(replace(rotor, parts=parts), 299.0, 300.0).conclusion
    assert conclusion == "The machine has no contact to run with."
    conclusion = rub_check(_machine(1e4, 300.0, 0.0), 299.0, 300.0, [(2, 1e-9, 0.0)]).conclusion
    assert conclusion == "The linear response closes no contact; no run with contacts was needed."


def test_the_figure_shows_a_sensor_rather_than_the_bearing_at_its_node():
    """As the page of a run does, of whose places the last of those that move as much counts."""
    bearings = "".join(_BEARING.format(node=node, c=1.0, crossed=0.0) for node in (1, 2, 3))
    at_the_disc = f"{bearings}[[sensor]]\nnode = 2\nname = 'probe'"
    rotor = parse_rotor(f"{_JEFFCOTT}k = 1e4\n{at_the_disc}".replace("1e-5", "1.0"))
    found = rub_check(rotor, 10.0, 10.0)
    assert found.place == "probe"
    assert rub_figure(found).axes[0].get_ylabel() == "Amplitude of probe 0-p [µm]"


@pytest.mark.parametrize(("trip", "top"), [(None, 12.5), (11.0, 11.0), (17.0, 17.0)])
def test_what_is_looked_at_reaches_the_trip_speed(trip, top):
    """Faster the machine never turns: a whirl that begins there says nothing of it."""
    rotor = _machine(1e4, 300.0, 0.0)
    checked = rub_check(replace(rotor, operation=Operation(trip_speed=trip)), 10.0, 10.0)
    assert checked.speed[-1] == pytest.approx(top)


def test_a_run_that_fails_before_it_has_settled_is_told_as_failed():
    """Cross coupling throws the rotor out of its bearings within a few turns."""
    check = rub_check(_machine(100.0, 10.0, 2e5), 300.0, 300.0)
    for run in check.runs:
        assert run.status.startswith("failed: t = ")
        assert math.isnan(run.contacts[0].share)
        assert len(run.amplitude) == 0
    assert check.conclusion.startswith("The run-up with contacts failed: t = ")
    assert "the run diverged" in check.conclusion
    assert "failed" in runs_table(check).html()
    assert rub_figure(check).axes


def _on_films(example, viscosity):
    """An example, the oil of whose films may be another."""
    rotor = load_rotor(EXAMPLES / example / "rotor.toml")[1]
    parts = (replace(p, viscosity=viscosity) if hasattr(p, "viscosity") else p for p in rotor.parts)
    return replace(rotor, parts=tuple(parts))


@pytest.mark.usefixtures("coarse_report")
@pytest.mark.parametrize(("viscosity", "touches"), [(0.004, False), (1e-5, True)])
def test_films_that_the_response_closes_are_run_too(viscosity, touches):
    """Oil, in which the rings of the dampers stay off their walls, and hardly any."""
    check = rub_check(_on_films("squeeze_film", viscosity), 250.0, 260.0)
    names = ["squeeze_film_damper[1]", "squeeze_film_damper[2]"]
    assert [c.name for c in check.closings] == names
    for run in check.runs:
        assert [c.name for c in run.contacts] == names
        assert all((c.share > 0.0) == touches for c in run.contacts)
    assert ("oil films bear more" in check.conclusion) != touches
    assert check.conclusion.startswith("Surfaces touch through oil films, ") == touches


@pytest.mark.usefixtures("coarse_report")
@pytest.mark.parametrize(
    ("ring", "high", "said"),
    [
        ("", 640.0, "um 0-p, and touches nothing."),
        (1e-4, 800.0, "The rub lasts in the operating range (ring), "),
    ],
)
def test_a_machine_past_its_threshold_is_run_though_its_response_closes_nothing(ring, high, said):
    """Its films whip, and keep its whirl within bounds that a ring about the shaft may not have."""
    text = (EXAMPLES / "oil_film" / "rotor.toml").read_text(encoding="utf-8")
    if ring:
        text += table(
            "[contact]", name="ring", node=2, journal_radius=0.02, clearance=ring, mu=0.1, k=1e6
        )
    rotor = parse_rotor(text)
    assert not rub_check(rotor, high - 40.0, high, scale=0.1).runs
    check = rub_check(rotor, high - 40.0, high, scale=0.1, is_stable=False)
    assert not check.closings
    assert said in check.conclusion
    assert rub_figure(check).axes


@pytest.mark.parametrize(("is_stable", "code"), [(False, ""), (True, "unstable")])
def test_a_machine_that_whirls_is_not_said_to_pass_a_resonance(is_stable, code):
    """Its threshold is in the operating range, or between that and its trip speed."""
    messages = [Message("unstable: with all contacts open it whirls", code)] if code else []
    films = module.ContactRun("film", math.nan, math.nan, 0.0, 0.0, 0.0, 0.0)
    runs = (module.RubRun("run-up", "ok", messages, np.ones(1), np.array([1.4e-3]), (films,)),)
    closings = (module.Closing("film", 2e-4, 1.8e-4, 6e-5, 88.0, 128.0),)
    shown = ("disc[1]", np.ones(1), np.ones(1))
    check = module.RubCheck(100.0, 110.0, is_stable, True, 1.0, closings, *shown, runs)
    said = "In the runs with contacts the machine whirls by up to 1400 um 0-p, and touches "
    assert check.conclusion == f"{said}nothing."


@pytest.mark.parametrize(("turns", "said"), [(0.0, "not in the"), (0.01, "not for long in the")])
def test_a_rub_beside_the_operating_range_is_told_as_such(turns, said):
    tips = module.ContactRun("tips", 180.0, 200.0, 0.0, 0.01, turns, 140.0)
    runs = tuple(
        module.RubRun(direction, "ok", [], np.ones(1), np.ones(1), (tips,))
        for direction in ("run-up", "run-down")
    )
    closings = (module.Closing("tips", 4e-5, 0.0, 5e-5, 185.0, 197.0),)
    shown = ("wheel", np.ones(1), np.ones(1))
    check = module.RubCheck(300.0, 375.0, True, True, 1.0, closings, *shown, runs)
    assert check.conclusion.startswith(f"The machine rubs, but {said} operating range. ")
    through = f"Surfaces touch through oil films, but {said} operating range (tips). "
    assert replace(check, films=("tips",)).conclusion.startswith(through)


def test_a_machine_that_whirls_without_contacts_is_told_that_a_run_says_by_how_much():
    rotor = load_rotor(EXAMPLES / "turbocharger" / "rotor.toml")[1]
    said = rub_check(rotor, 4e3, 9e3, is_stable=False).conclusion
    assert said.startswith("The machine has no contact to run with; ")
    assert said.endswith("says by how much it whirls.")
    assert rub_check(rotor, 4e3, 9e3).conclusion == "The machine has no contact to run with."


def _farthest(response, rest, node):
    """The largest distance of a node from the middle in a turn, at the first of the speeds."""
    turn = np.exp(2j * np.pi * np.arange(100_000) / 100_000)
    x = rest.x[node] + (response.x[0, node] * turn).real
    y = rest.y[node] + (response.y[0, node] * turn).real
    return np.hypot(x, y).max()


@pytest.mark.usefixtures("coarse_report", "without_runs")
def test_a_rotor_that_vibrates_across_its_sag_takes_less_than_both_together():
    """It lies deep in a ring, and its resonance in x is far below the one in y."""
    bearings = "".join(_BEARING.format(node=n, c=300.0, crossed=0.0) for n in (1, 3))
    text = f"{_JEFFCOTT}k = 1e4\n{bearings.replace('kxx = 1e6', 'kxx = 1e5')}"
    rotor = parse_rotor(text.replace("gravity = 0.0", "").replace("1e-5", "3e-4"))
    (closing,) = rub_check(rotor, 110.0, 120.0).closings
    response = unbalance_response(rotor, [closing.begin])
    assert _farthest(response, static(rotor), 1) == pytest.approx(closing.clearance, rel=1e-6)
    assert closing.sag + response.major[0, 1] > 1.3 * closing.clearance


@pytest.mark.usefixtures("coarse_report", "without_runs")
def test_a_contact_in_which_the_shaft_lies_is_closed_at_all_speeds():
    """It sags by 0.16 mm into a ring of 10 um."""
    rotor = _machine(1e4, 300.0, 0.0)
    check = rub_check(replace(rotor, gravity=9.81), 299.0, 300.0)
    (closing,) = check.closings
    assert (closing.begin, closing.end) == pytest.approx((37.5, 375.0))
    assert closing.sag > closing.clearance
    assert not check.conclusion.startswith("The linear response closes no contact")
    labels = [line.get_label() for line in rub_figure(check).axes[0].lines]
    assert "clearance 10 µm of contact[1]" in labels  # the picture's motion is that of a disc


@pytest.mark.usefixtures("coarse_report", "without_runs")
def test_a_film_closes_where_its_journal_reaches_its_wall_from_where_it_rests_at_that_speed():
    rotor = with_unbalances(_on_films("oil_film", 0.005), None, 30.0)
    for closing in rub_check(rotor, 400.0, 450.0).closings:
        response, rest = unbalance_response(rotor, [closing.begin]), static(rotor, closing.begin)
        node = next(part.node for name, part in rotor.named_parts() if name == closing.name) - 1
        assert _farthest(response, rest, node) == pytest.approx(closing.clearance, rel=1e-6)
        assert 0.1 * closing.clearance < closing.sag < closing.clearance
        assert closing.begin < closing.end == pytest.approx(1.25 * 450.0)


@pytest.mark.usefixtures("conclusions_alone", "without_runs")
@pytest.mark.parametrize(("e", "said"), [(1.0, 0), (0.01, 1)])
def test_a_report_that_names_films_does_not_say_that_no_clearance_was_checked(e, said):
    rotor = with_unbalances(_on_films("squeeze_film", 0.004), None, e)
    texts = [c.text for c in machine_report(rotor, ReportOptions(250.0, 260.0)).conclusions]
    assert sum(text.startswith("No clearance was checked") for text in texts) == said
    assert sum("of the clearance of oil films" in text for text in texts) == 1 - said


@pytest.mark.usefixtures("conclusions_alone", "without_runs")
def test_a_report_of_films_that_close_does_not_say_that_no_clearance_was_checked():
    """A journal that lies deep in its film closes it by a motion of less than half of it."""
    rotor = with_unbalances(_on_films("oil_film", 0.002), None, 1.5)
    report = machine_report(rotor, ReportOptions(250.0, 260.0))
    assert report.numbers["contact"]["closings"]
    texts = " ".join(c.text for c in report.conclusions)
    assert "of the clearance of oil films" not in texts
    assert "No clearance was checked" not in texts


@pytest.mark.usefixtures("coarse_report")
def test_of_a_machine_without_a_part_that_is_seen_to_move_its_contact_is_shown():
    """A bare shaft with an unbalance, on supports: its picture was empty."""
    bare = re.sub(r"(?s)\[\[disc\]\].*?(?=\[\[contact)", "", _JEFFCOTT)
    bare += "k = 1e7\n[[unbalance]]\nnode = 2\namount = 1e-4\n"
    held = (f"[[support]]\nnode = {n}\nstiffness = 1e6\ndamping = 200.0\n" for n in (1, 3))
    rotor = parse_rotor(bare + "".join(held))
    found = rub_check(rotor, 300.0, 310.0)
    assert found.place == "contact[1]"
    whirl = unbalance_response(rotor, [found.speed[-1]])
    assert found.linear[-1] == pytest.approx(abs(whirl.x[0, 1]), rel=1e-6)
    assert all(run.amplitude.max() > 0.9e-5 for run in found.runs)


@pytest.mark.usefixtures("coarse_report")
def test_of_contacts_that_carry_the_machine_the_motion_is_said_and_no_rub():
    """A shaft that lies in dry bearings touches them always, whatever it does there."""
    lying = re.sub(r"(?s)gravity = 0.0|\[\[contact\]\].*", "", _JEFFCOTT)
    contact = _JEFFCOTT.partition("[[contact]]")[2].replace("node = 2", "node = {node}")
    lying += "".join(f"[[contact]]{contact}k = 1e7\n".format(node=node) for node in (1, 3))
    found = rub_check(parse_rotor(lying), 300.0, 310.0)
    most = 1e6 * max(run.amplitude.max() for run in found.runs)
    said = f"disc[1] whirls by up to {float(f'{most:.3g}'):g} um 0-p, in the linear response, which"
    assert said in found.conclusion
    assert "as closed, by more than 1000 times that" in found.conclusion  # nothing damps it
    assert "rub" not in found.conclusion
    assert "contacts that carry" in rub_figure(found).axes[0].get_title(loc="left")
