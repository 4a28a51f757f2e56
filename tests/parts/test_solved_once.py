"""A film's pressure, which the rates, the powers and the outputs of one instant share."""

import math

import numpy as np
import pytest
from rotor_fmu.model.film.bearing_film import PAD
from rotor_fmu.model.film.solved_zone import SOLVED
from rotor_fmu.model.film.zone_pressure import VECTORS
from rotor_fmu.model.kernels.kernel import interpreted
from rotor_fmu.model.parts.floating_ring_bearing import FloatingRingBearing
from rotor_fmu.model.parts.journal_bearing import JournalBearing
from rotor_fmu.model.parts.law_probe import LawProbe
from rotor_fmu.model.parts.squeeze_film_damper import SqueezeFilmDamper

from .films import OF_A_FILM
from .rings import RING

_SPEED, _POINTS = 300.0, 8.0
_PADS = {"pads": (0.8, 2.4, 3.9, 5.5), "arc": 1.3, "preload": 0.3}
_FILM = {"node": 1, **OF_A_FILM, "points": _POINTS}
PARTS = {
    "circle": JournalBearing(**_FILM, length=0.04),
    "pads": JournalBearing(**_FILM, length=0.04, **_PADS),
    "tilting": JournalBearing(**_FILM, length=0.04, **_PADS, tilting=True, pad_inertia=1e-5),
    "full": JournalBearing(**_FILM, length=0.04, rupture="guembel", supply_pressure=1e5),
    "damper": SqueezeFilmDamper(**_FILM, length=0.04),
    "rings": FloatingRingBearing(node=1, **{**RING, "short": False, "points": _POINTS}),
}


def _asked(probe, d, v, states):
    """Force, rates, powers and outputs at an instant."""
    law, moving = probe._law, probe._moving(d, v)
    given = (probe._record, probe._tables, moving, states)
    rates, losses, outputs = np.zeros(len(states)), np.zeros(3), np.zeros(len(probe._outputs))
    interpreted(law.rates)(*given, rates)
    torque = interpreted(law.dissipate)(*given, losses)
    interpreted(law.observe)(*given, outputs)
    return [interpreted(law.force)(*given), torque, *rates, *losses, *outputs]


@pytest.mark.parametrize("name", PARTS)
def test_an_instant_does_not_depend_on_what_was_asked_before(name):
    """At the same place, and at one that differs in the velocity or in the speed alone, bit for bit
    as asked first."""
    part = PARTS[name]
    c, used = part.clearance, LawProbe(part, _SPEED, name)
    states = used._states.copy()
    if name == "tilting":
        states[:] = 0.01 * c * np.arange(len(states))
    if name == "rings":
        states[:] = 0.2 * c, -0.3 * c, 2e-3, 1e-3, 0.3 * _SPEED
    rounds = [(0.4 * c, 0j, _SPEED), (0.4 * c, 30j * c, _SPEED), (0.4 * c, 30j * c, -_SPEED)]
    rounds += [(complex(0.2 * c, -0.5 * c), 30j * c, _SPEED), rounds[1], rounds[1]]
    for d, v, speed in rounds:
        used.speed = used._sliding = speed
        fresh = LawProbe(part, speed, name)
        assert _asked(used, d, v, states) == _asked(fresh, d, v, states)


def test_a_film_is_solved_once_for_all_that_is_asked_of_an_instant():
    """What the outputs say is the load that the powers left behind."""
    probe = LawProbe(PARTS["circle"], _SPEED, "")
    before = _asked(probe, 2e-5, 0j, probe._states)
    at = 1 + len(PAD) + VECTORS * (int(_POINTS) + 1)
    probe._tables[at + SOLVED.load_x] *= 2.0
    after = _asked(probe, 2e-5, 0j, probe._states)
    fx = next(i for i, output in enumerate(probe._outputs) if output.name == "fx")
    place = len(before) - len(probe._outputs) + fx
    assert math.isclose(after[place], 2.0 * before[place])
    assert after[place + 1] == before[place + 1]
