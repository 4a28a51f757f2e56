"""Responses that several files of this folder look at, each computed once."""

import math

import pytest
from rotor_fmu.model.periodic import starting_points

import rotor_fmu as rf

from .machines import FAINT_RUB, OMEGA, jeffcott, sagging


@pytest.fixture
def one_circle(monkeypatch):
    """A seed begins with one of its circles, which turns as the machine does."""
    monkeypatch.setattr(starting_points, "_RADII", (1.5,))
    monkeypatch.setattr(starting_points, "_PHASES", (-0.5 * math.pi,))


@pytest.fixture(scope="session")
def curve():
    """The rub of T1 over the speed, with its jumps."""
    return rf.response(jeffcott(), speed=(60.0, 240.0))


@pytest.fixture(scope="session")
def over_friction(curve):
    """The rub of T1 at one speed over the friction, past Hopf's point."""
    start = curve.at(1.4 * OMEGA)[0]
    over = ("contact[1].mu", 0.04, 0.25)
    return rf.response(jeffcott(), speed=1.4 * OMEGA, over=over, start=start, step=0.4)


@pytest.fixture(scope="session")
def isola():
    """An isolated branch of rub, found by a seed, beside the whirl that touches nothing."""
    return rf.response(FAINT_RUB, speed=(60.0, 240.0), seeds=(130.0,), step=0.8)


@pytest.fixture(scope="session")
def doubled():
    """A branch with period doublings, and the one of twice the period between them."""
    return rf.response(sagging(), speed=(240.0, 400.0), branches=True, harmonics=40, step=0.8)
