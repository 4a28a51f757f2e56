"""A warning about a run is declared once: field, start and code in the library follow."""

import math

import numpy as np
import pytest
from rotor_fmu.model import message_templates, messages
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation
from rotor_fmu.model.warnings import RUN_WARNINGS

from rotor_fmu.library import entry_points

from ..processes import run_anew

# In a process of its own, with one more declaration before anything is made of them.
DECLARED = """
from rotor_fmu.model import warnings
added = warnings.RunWarning("far_at", "far", "far from the axis since t = {.4g} s")
warnings.RUN_WARNINGS += (added,)

from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

messages = []
sim = Simulation(rig(), settings=choose("robust"), warn=messages.append, speed=100.0)
sim.advance(0.001, 100.0)
assert not [m for m in messages if "far" in m]
sim._run.memory.record[0].far_at = 0.5
sim.advance(0.002, 100.0)
(message,) = [m for m in messages if "far" in m]
assert message.code == "far"
print(message)
"""


def last(sim, arguments):
    """Code of the library about the warning that began last."""
    return entry_points._last_run_warning(sim._run.memory.record[0], arguments)


@pytest.fixture
def sim():
    return Simulation(rig(), settings=choose("robust"), speed=100.0)


def test_no_warning_holds_at_the_start(sim):
    record = sim._run.memory.record[0]
    assert all(math.isnan(record[warning.since]) for warning in RUN_WARNINGS)
    assert last(sim, np.zeros(message_templates.MOST_ARGUMENTS)) == messages.GOOD


@pytest.mark.parametrize("warning", RUN_WARNINGS, ids=lambda warning: warning.since)
def test_the_library_returns_the_code_of_the_warning_that_holds(sim, warning):
    arguments = np.zeros(message_templates.MOST_ARGUMENTS)
    sim._run.memory.record[0][warning.since] = 0.25
    code = -last(sim, arguments)
    assert messages.CODES[code] == warning.code
    assert message_templates.fill_template(
        messages.SENTENCES[code], arguments
    ) == message_templates.fill_template(warning.words, [0.25])


def test_of_several_warnings_the_library_returns_the_one_that_began_last(sim):
    for time, warning in zip((3.0, 5.0, 4.0), RUN_WARNINGS, strict=False):
        sim._run.memory.record[0][warning.since] = time
    arguments = np.zeros(message_templates.MOST_ARGUMENTS)
    code = -last(sim, arguments)
    assert messages.CODES[code] == RUN_WARNINGS[1].code
    assert arguments[0] == 5.0


def test_a_warning_that_is_declared_has_its_field_and_is_shown():
    done = run_anew(DECLARED, ROTOR_FMU_KERNELS="python")
    assert done.stdout == "far from the axis since t = 0.5 s\n", done.stderr
