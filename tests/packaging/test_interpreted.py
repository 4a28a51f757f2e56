"""Without the compiler the same code gives the same numbers."""

import json
from pathlib import Path

import numpy as np
from rotor_fmu.model import simulation
from rotor_fmu.model.backend import Backend

import rotor_fmu

from ..processes import run_anew

STEPS = """
import json
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.parts import Bearing, Support
from rotor_fmu.model.settings import choose
from rotor_fmu.model.simulation import Simulation

supports = Support(2, 1e6, 9.0), Support(8, 2e6)
held = rig().with_parts(Bearing).with_parts(Support, *supports)
robust, adaptive = choose("robust"), choose("paper-adaptive", h_min=1e-4)
said, seen = [], []
radau = choose(method="radau5")
for rotor, settings in ((held, robust), (held, adaptive), (rig(), robust), (rig(), radau)):
    sim = Simulation(rotor, settings, speed=400.0, rate=-10.0, warn=said.append)
    for i in range(1, 3):
        sim.advance(0.004 * i, 400 - 10 * sim.time)
    seen.append(sim.observed.tolist())
print(json.dumps([said, seen]))
"""


def numbers_of(**environment):
    path = str(Path(rotor_fmu.__file__).parents[1])
    return json.loads(run_anew(STEPS, PYTHONPATH=path, **environment).stdout)


def test_the_interpreted_run_has_the_numbers_of_the_compiled_one():
    said, interpreted = numbers_of(NUMBA_DISABLE_JIT="1")
    silence, compiled = numbers_of()
    for mine, other in zip(interpreted, compiled, strict=True):
        np.testing.assert_array_equal(mine, other)
    assert silence == []
    assert [sentence.split(":")[0] for sentence in said] == ["numba is switched off"] * 4


def test_a_command_says_that_its_run_is_interpreted_and_why(process, monkeypatch):
    monkeypatch.setenv("ROTOR_FMU_KERNELS", "python")
    monkeypatch.setattr(simulation, "selected_backend", lambda: Backend.PYTHON)
    run = process("run-down", "--direct", "--stop", "0.001")
    assert run.returncode == 0, run.stderr
    assert "note: ROTOR_FMU_KERNELS = python: the solver runs interpreted" in run.stderr
