"""The linear critical speeds that stand beside the pictures of runs."""

import math
from html import unescape
from pathlib import Path

import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.report.criticals import criticals_of
from rotor_fmu.report.run_page import runs_page

from ..recordings import recorded


def test_the_linear_critical_speeds_of_the_rig_are_said_beside_its_run():
    """Paper A gives 29.4 and 32.5 Hz at rest, contacts closed."""
    given = recorded(speed=400.0, rate=-60.0, toml=rig_toml(), parameters={})
    found = criticals_of(given.named("rig"))
    assert found.hz == pytest.approx([29.4, 32.5], rel=0.02)
    assert found.sentence.startswith("Linear critical speeds with contacts pinned, dotted: ")
    assert "a journal that leaves its wall is held less" in found.sentence
    page = runs_page([given.named("rig")], [{}])
    assert found.sentence in unescape(page)
    stiffer = {"bearing[1].kx": 1e9, "bearing[1].ky": 1e9}
    changed = recorded(speed=400.0, rate=-60.0, toml=rig_toml(), parameters=stiffer)
    assert criticals_of(changed.named("rig")).hz[0] > found.hz[0]


def test_critical_speeds_of_a_shaft_that_turned_backward_stand_at_its_speeds():
    """Of one that was braked through rest they are those of both ways."""
    braked = recorded(speed=-400.0, rate=133.0, toml=rig_toml()).named("rig")
    assert criticals_of(braked).hz == pytest.approx([-32.5, -29.4, 29.4, 32.5], rel=0.02)


def test_a_page_of_two_machines_says_whose_picture_and_critical_speeds_it_shows():
    """Of two runs of one machine it shows one picture and no name."""
    softer, stiffer = rig_toml(), rig_toml().replace("kx = 5e5", "kx = 9e5")
    a, b = (recorded(speed=400.0, rate=-60.0, toml=toml) for toml in (softer, stiffer))
    for other, whose, pictures in ((b, "A: ", 1), (a, "", 0)):
        page = unescape(runs_page([a.named("A"), other.named("B")], [{}, {}]))
        assert f'<p class="about">{whose}{criticals_of(a).sentence}</p>' in page
        assert [page.count(f"<figcaption>{name}: The machine") for name in "AB"] == [pictures] * 2


def test_a_speed_at_which_two_whirls_are_critical_stands_once():
    """Of the Jeffcott rotor, whose disc has no moments of inertia: sqrt(1 - zeta^2) 100 rad/s."""
    jeffcott = Path(__file__).parents[2] / "examples" / "jeffcott_rub" / "jeffcott.toml"
    run = recorded(speed=200.0, rate=-25.0, toml=jeffcott.read_text(encoding="utf-8"))
    assert criticals_of(run).hz == pytest.approx([99.5 / (2 * math.pi)], rel=1e-3)


def test_a_run_without_its_machine_has_no_critical_speeds():
    assert criticals_of(recorded().named("one")).hz == ()
    assert criticals_of(recorded(rate=0.0, toml=rig_toml()).named("one")).hz == ()
