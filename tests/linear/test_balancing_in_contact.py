"""Balancing of a machine that rubs, which has no influence coefficients: it is said before the runs
and while they last, since a machine that rubs takes many steps."""

import numpy as np
import pytest
from rotor_fmu.model.linear import static
from rotor_fmu.model.machine.toml import parse_rotor, rig

from rotor_fmu.balancing.trial_runs import balance
from tests.linear.api_617 import SHAFT, support

pytestmark = pytest.mark.usefixtures("few_turns")


@pytest.fixture
def few_turns(monkeypatch):
    monkeypatch.setattr("rotor_fmu.balancing.trial_runs._MOST_TURNS", 20)
    monkeypatch.setattr("rotor_fmu.balancing.trial_runs._LEAST_TURNS", 10)


def test_a_contact_that_closes_is_said_also_while_the_runs_last():
    seen = []

    def report(done, what):
        return lambda share, steps: seen.append((done + share, steps()))

    assert balance(rig(), [150.0], [5], report=report).touches
    shares, limits = zip(*seen, strict=True)
    assert (np.diff(shares) > 0).all()
    assert shares[-1] == pytest.approx(3.0)
    assert any("by the tolerance while bearing[" in said for said in limits)


@pytest.mark.parametrize(("share", "lies"), [(0.9, True), (1.1, False)])
def test_the_command_says_first_that_the_shaft_lies_in_a_contact(tmp_path, command, share, lies):
    held = SHAFT + support(1, 1e7) + support(7, 1e7) + "[[unbalance]]\nnode = 4\namount = 1e-6\n"
    sag = -static(parse_rotor(held), 150.0).y[3]
    file = tmp_path / "rotor.toml"
    wall = "[[contact]]\nnode = 4\njournal_radius = 0.015\nk = 1e6\nmu = 0.0\n"
    file.write_text(f"{held}{wall}clearance = {share * sag}\n")
    said = command("balance", "--rotor", str(file), "--speed", "150", "--plane", "4")
    assert said.startswith("the shaft at rest lies in contacts: contact[1] with a sag") == lies
