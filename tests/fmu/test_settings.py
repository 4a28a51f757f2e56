"""The solver's parameters give in the FMU what they give in Python: settings, or one sentence."""

import random

import pytest
from rotor_fmu.model import messages
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.message_templates import choice, fill_template
from rotor_fmu.model.settings import SettingsError
from rotor_fmu.model.simulation import StepFailure

from rotor_fmu.fmi.binding import build_simulation
from rotor_fmu.fmi.interface import interface
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.fmi.solver_parameters import settings_of, solver_parameters
from rotor_fmu.fmi.variables import start_values

from .skins import Discarded, Extracted, Native, Refused

DRAWS = 150
NUMBERS = (-2.0, -0.3, 0.0, 0.08, 0.1, 0.5, 1e-3, 1e-5, 0.9, 1.0, 7.0)


@pytest.fixture(scope="module")
def free_native(tmp_path_factory):
    folder = tmp_path_factory.mktemp("free")
    return build_native(folder, machine_of(is_free=True), platforms=["linux64"])


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


@pytest.mark.parametrize(
    ("is_free", "values"),
    [
        *((False, {"solver.preset": preset}) for preset in range(5)),
        (False, {"speed_continuation": 1}),
        (False, {"speed_rate": -50.0}),
        (False, {"solver.sensitivities": True}),
        (False, {"limit.displacement": 4e-4}),
        (False, {"limit.force": 30.0}),
        (False, {"limit.contact": True}),
        (True, {"w_start": 180.0}),
        (True, {"tau_impedance": 0.02}),
    ],
)
def test_a_run_is_what_its_parameters_stand_for(native_fmu, free_native, is_free, values):
    """In its numbers, bit for bit, and in where and why it ends early."""
    extracted = Extracted(free_native if is_free else native_fmu)
    table = interface(rig(), is_free)
    drive, first, change = ("tau_drive", 0.0, 0.01) if is_free else ("speed", 400.0, -1.5)
    start = start_values(table)
    simulation = build_simulation(rig(), table, start | {drive: first} | values, lambda _: None)
    _, fmu = in_the_fmu(extracted, {drive: first} | values)
    ends = []
    for i in range(5):
        value = first + i * change
        fmu.put({drive: value})
        try:
            fmu.step(0.04 * i, 0.04)
        except Discarded as error:
            ends.append(str(error))
        try:
            simulation.advance(0.04 * i + 0.04, value)
        except StepFailure as error:
            ends.append(str(error))
        if ends:
            break
    assert bool(ends) == any(name.startswith("limit.") for name in values)
    assert ends[:1] == ends[1:]
    for name in ("w", "tau", "solver.steps", "solver.h_last", "disc[3].x", "disc[1].dx_dfx"):
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
