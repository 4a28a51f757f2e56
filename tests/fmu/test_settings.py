"""The solver's parameters give in the FMU what they give in Python: settings, or one sentence."""

import random

import pytest
from rotor_fmu.model import messages
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.message_templates import choice, fill_template
from rotor_fmu.model.settings import SettingsError

from rotor_fmu.fmi.binding import build_simulation
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.solver_parameters import settings_of, solver_parameters

from .skins import Extracted, Native, Refused

DRAWS = 300
NUMBERS = (-2.0, -0.3, 0.0, 0.08, 0.1, 0.5, 1e-3, 1e-5, 0.9, 1.0, 7.0)


def drawn(draw, table):
    """Values of some of the solver's parameters, by name."""
    chosen = draw.sample(table, draw.choice([0, 1, 1, 2, 2, 3, 4]))
    return {
        v.name: draw.randint(v.low, v.high)
        if v.kind in ("Integer", "Enumeration")
        else draw.choice(NUMBERS)
        for v in chosen
    }


def in_python(start, values):
    """The refusal, "" where there is none, and the warnings of what has no effect."""
    said = []
    try:
        settings_of(start | values, warn=said.append)
    except SettingsError as error:
        return str(error), []
    return "", said


def in_the_fmu(extracted, values):
    """The same of an instance that is initialized."""
    fmu = Native(extracted).put(values)
    try:
        fmu.initialize()
    except Refused as refused:
        return str(refused), fmu
    return "", fmu


def test_random_parameters_are_settled_as_in_python_and_refused_in_the_same_words(native_fmu):
    draw, extracted = random.Random(4), Extracted(native_fmu)
    table = [v for v in solver_parameters() if v.name != "solver.reduction"]
    start = {v.name: v.start for v in solver_parameters()}
    good = refused = warned = 0
    for _ in range(DRAWS):
        values = drawn(draw, table)
        reason, said = in_python(start, values)
        sentence, fmu = in_the_fmu(extracted, values)
        assert sentence == reason, values
        assert [text for text in fmu.warnings if "has no effect" in text] == said, values
        good, refused, warned = good + (not reason), refused + bool(reason), warned + bool(said)
    assert min(good, refused, warned) > DRAWS / 20


@pytest.mark.parametrize("preset", range(5))
def test_a_run_has_the_settings_that_its_parameters_stand_for(native_fmu, preset):
    """Of its steps, bit for bit."""
    extracted = Extracted(native_fmu)
    table = interface(rig())
    values = {v.name: v.start for v in table if v.start is not None} | {"solver.preset": preset}
    simulation = build_simulation(rig(), table, values, lambda message: None)
    _, fmu = in_the_fmu(extracted, {"solver.preset": preset})
    for i in range(5):
        fmu.step(0.04 * i, 0.04)
        simulation.advance(0.04 * i + 0.04, 400.0)
    for name in ("solver.steps", "solver.newton", "solver.h_last", "disc[3].x"):
        value = fmu.get(extracted.kinds[name], [extracted.refs[name]])
        assert value == [simulation.read(name)], name


def test_every_sentence_has_its_places_and_none_too_many():
    """All are spelled with as many numbers as they have places, and leave no brace."""
    for text in messages.SENTENCES:
        places = choice(("here", "there"))
        spoken = text.replace("{where}", places).replace("{names}", places)
        shown = fill_template(spoken, [1.0] * text.count("{"))
        assert "{" not in shown
        assert "}" not in shown
