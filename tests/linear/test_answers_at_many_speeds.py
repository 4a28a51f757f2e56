"""Answers at many speeds: each place of rest is looked for once, by a matrix factorized once."""

from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module

import numpy as np
import pytest
from rotor_fmu.model.linear import first_forward, level_1, level_2, linear_machine, modes, static
from rotor_fmu.model.linear.linear_machine import LinearMachine
from rotor_fmu.model.linear.unbalance_check import (
    close_speeds,
    highest_of_interest,
    unbalance_check,
)
from rotor_fmu.model.linear.unbalance_peaks import response_with_peaks
from rotor_fmu.model.machine.toml import parse_rotor
from rotor_fmu.model.structure.strain_solver import StrainedMatrices

FILM = (
    "[[journal_bearing]]\njournal_radius = 0.025\nlength = 0.02\nclearance = 5e-5\n"
    "viscosity = 0.02\npoints = 16\n"
)
PADS = "tilting = true\npads = [-1.5708, 0.5236, 2.618]\narc = 1.5\npreload = {}\n"
KINDS = {"circles": "", "pads": PADS.format(0.3), "pads without preload": PADS.format(0.0)}


def on_films(kind):
    """A shaft with a disc, an unbalance and two films of a kind."""
    film = FILM + KINDS[kind]
    return parse_rotor(f"""
[material]
young = 2.1e11
density = 7800.0
[[section]]
length = 0.6
elements = 6
outer = 0.05
[[body]]
node = 3
mass = 8.0
I_d = 0.02
I_p = 0.04
e = 1e-6
{film}node = 1
{film}node = 7
""")


def factorizations(monkeypatch):
    """A list that grows by one with each matrix that is factorized."""
    made, factorized = [], StrainedMatrices.factorized

    def counted(self, *given, **options):
        made.append(self)
        return factorized(self, *given, **options)

    monkeypatch.setattr(StrainedMatrices, "factorized", counted)
    return made


@pytest.mark.parametrize("kind", KINDS)
def test_a_machine_rests_where_it_does_by_matrices_that_are_factorized_at_each_step(
    kind, monkeypatch
):
    machine = LinearMachine(on_films(kind))
    found = [machine.loaded(speed) for speed in (100.0, 700.0)]
    monkeypatch.setattr(linear_machine, "_MOST", -1.0)
    for one in found:
        anew = machine.loaded(one.speed)
        np.testing.assert_allclose(one.rest, anew.rest, atol=1e-11 * np.abs(anew.rest).max())
        np.testing.assert_allclose(one.pull, anew.pull, atol=1e-10 * np.abs(anew.pull).max())
        weight = np.abs(machine.static_load.sum())
        assert abs(one.laws.force.sum().imag) == pytest.approx(weight, rel=1e-9)


def test_a_place_of_rest_takes_one_factorization(monkeypatch):
    machine = LinearMachine(on_films("circles"))
    made = factorizations(monkeypatch)
    machine.loaded(300.0)
    assert len(made) == 1


def test_a_response_and_its_check_look_for_a_place_of_rest_once_at_each_speed(monkeypatch):
    monkeypatch.setattr(import_module("rotor_fmu.model.linear.unbalance_check"), "SPEEDS", 13)
    asked, at = Counter(), LinearMachine.at
    # another machine than the other tests', which share theirs
    rotor, low, high = on_films("circles").with_values({"body[1].e": 2e-6}), 300.0, 400.0
    top = highest_of_interest(rotor, high)
    speeds = close_speeds(rotor, top)

    def counted(self, speed):
        asked[speed] += 1
        return at(self, speed)

    monkeypatch.setattr(LinearMachine, "at", counted)
    response_with_peaks(rotor, speeds, nodes=[3])
    unbalance_check(rotor, low, high, [3])
    assert {asked[speed] for speed in speeds.tolist()} == {1}


def test_the_analyses_of_a_rotor_share_its_machine_within_a_thread(monkeypatch):
    """As those of a report; both levels of stability their mode too."""
    made, modes_of_levels, start = [], [], LinearMachine.__init__
    monkeypatch.setattr(
        LinearMachine, "__init__", lambda self, *of: made.append(self) or start(self, *of)
    )
    search = first_forward.FirstForward._threshold
    monkeypatch.setattr(
        *(first_forward.FirstForward, "_threshold"),
        lambda self, expected: modes_of_levels.append(self) or search(self, expected),
    )
    rotor = on_films("circles")
    first = modes(rotor, 300.0)
    static(rotor, 300.0)
    assert len(made) == 1
    level_1(rotor, 300.0, node=3, anticipated=1e3, stiffness=[0.0])
    level_2(rotor, 300.0, cross_couplings={3: 1e3})
    assert len(modes_of_levels) == 1
    made.clear()
    with ThreadPoolExecutor() as another:
        assert another.submit(modes, rotor, 300.0).result().damped == pytest.approx(first.damped)
    assert len(made) == 1
