"""The library made ahead, numba and plain Python carry out the same kernels to the same numbers."""

import json
from pathlib import Path

import numpy as np
import pytest
from rotor_fmu.model.kernels import library

import rotor_fmu

from ..processes import run_anew

ROOT = Path(rotor_fmu.__file__).parents[1]
MISSING = "no library was made of these kernels (rotor-fmu library --platform here)"
has_platform = pytest.mark.skipif(
    library.here() is None, reason="no library can be made for this processor and system"
)

# Every example machine and the rig with contact: everything that can be read and recorded, and the
# state. "both" presets of each machine; else, in a third of the time, they take turns, all but the
# rig.
STEPS = """
import hashlib, json, sys
from pathlib import Path
from rotor_fmu.model.backend import selected_backend
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.machine_file.loading import load_rotor
from rotor_fmu.model.settings import choose
from rotor_fmu.model.time_loop.recorder import Record, recordable
from rotor_fmu.model.simulation import Simulation

files = [f for f in sorted(Path(sys.argv[1]).rglob("*.toml")) if f.parent.name != "studies"]
rotors = {"rig": rig()} | {f"{f.parent.name}/{f.stem}": load_rotor(f)[1] for f in files}
seen = {}
presets = ("robust", "controlled")
for turn, (name, rotor) in enumerate(rotors.items()):
    every = name == "rig" or sys.argv[2] == "both"
    for preset in presets if every else (presets[turn % 2],):
        # every step, on a tape that is full at times
        tape = Record([str(entry.name) for entry in recordable(rotor)], 0.0, 4)
        sim = Simulation(
            rotor, choose(preset), speed=300.0, rate=-10.0, record=tape, warn=lambda message: None
        )
        for i in range(1, 4):
            sim.advance((2e-3 if sys.argv[2] == "both" else 8e-4) * i, 300.0 - 10.0 * sim.time)
        snapshot = sim.snapshot()
        sim.restore(snapshot)
        digest = hashlib.sha256(snapshot.tobytes()).hexdigest()
        read = [*sim.observed.tolist(), *sim.drain().ravel().tolist()]
        seen[f"{name} {preset}"] = [digest, read]
print(json.dumps([selected_backend().value, "numba" in sys.modules, seen]))
"""

# The same of their nonlinear laws at rest and along a motion, and of two steps through a period.
ANALYSES = """
import json, sys
from pathlib import Path
import numpy as np
from rotor_fmu.model import backend
from rotor_fmu.model.linear import LinearMachine
from rotor_fmu.model.periodic import entry_points
from rotor_fmu.model.periodic.linear_structure import CondensedMachine
from rotor_fmu.machine_file.loading import load_rotor

random = np.random.default_rng(3)
seen = {}
for file in sorted(Path(sys.argv[1]).rglob("*.toml")):
    if file.parent.name == "studies":
        continue
    rotor = load_rotor(file)[1]
    machine = CondensedMachine(rotor)
    laws, b = machine.laws, machine.b
    if laws.count == 0:
        continue
    size = np.repeat(laws.length, 2)
    d = 0.4 * size * random.standard_normal((2, 2 * laws.count))
    v = 300.0 * d[:, ::-1]
    own = np.tile(laws.starts, (2, 1))
    at = laws.tangents(d, v, own, np.full(laws.states, 1e-6), 200.0)
    rest = LinearMachine(rotor).at(500.0).laws
    read = [rest.force.real, rest.force.imag, rest.by_d, rest.by_v, *at, laws.gaps(1.5 * d)]
    if laws.states == 0:
        block, data = laws.block_of_steps(steps=2, lengths=1, modes=4, b=b)
        for array in (*data.propagators[1:6], *data.period[:4], data.period.state):
            array[...] = 0.01 * random.standard_normal(array.shape)
        data.propagators.output_by_state[...] *= laws.length.max()
        data.propagators.output_by_force[...] *= 1e-8
        data.work.columns[...] = np.arange(3 * b)
        backend.bound(entry_points.step_through, block)(200.0)
        read += [*data.period, *data.work]
    seen[file.name] = [number.hex() for array in read for number in np.ravel(array).astype(float)]
print(json.dumps([backend.selected_backend().value, "numba" in sys.modules, seen]))
"""


def run(script, *arguments, **environment):
    done = run_anew(script, *arguments, PYTHONPATH=str(ROOT), **environment)
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


def numbers(kernels, script=STEPS, presets="both"):
    printed = run(script, ROOT / "examples", presets, ROTOR_FMU_KERNELS=kernels)
    used, has_numba, seen = json.loads(printed)
    assert used == kernels
    assert has_numba == (kernels == "numba")
    assert len(seen) >= 6
    return seen


@has_platform
@pytest.mark.parametrize(
    ("other", "presets"),
    [("python", "turns"), ("numba", "both")],
)
@pytest.mark.slow  # a few runs of the rig are compared in test_interpreted
def test_the_library_has_the_numbers_bit_for_bit(other, presets):
    """Of every example machine; numba is asked where its minute of compiling is spent anyway."""
    assert library.loaded() is not None, MISSING
    mine, theirs = (numbers(kernels, presets=presets) for kernels in ("library", other))
    for name, (digest, observed) in mine.items():
        np.testing.assert_array_equal(observed, theirs[name][1], name)
        assert digest == theirs[name][0], name


@has_platform
@pytest.mark.parametrize("other", ["python", pytest.param("numba", marks=pytest.mark.slow)])
def test_so_has_the_library_those_of_analyses(other):
    assert numbers("library", ANALYSES) == numbers(other, ANALYSES)
