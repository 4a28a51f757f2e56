"""A machine whose rub bows the shaft, in both FMUs: bit for bit, its state included."""

import math
from importlib.resources import files

import pytest
from rotor_fmu.model.settings import METHODS, choose
from rotor_fmu.model.simulation import Simulation

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build
from rotor_fmu.machine_file.loading import load_rotor

from ..fmu.instance import Machine, observed

NEWKIRK = files("rotor_fmu.examples") / "newkirk" / "rotor.toml"
SPEED, H = 130.0, 0.02


@pytest.fixture(params=["native", "python"])
def archive(request, make, tmp_path):
    """The FMU of the example, that needs no Python and that in Python."""
    toml, _ = load_rotor(NEWKIRK)
    return make(toml=toml) if request.param == "native" else build(tmp_path, machine_of(toml))


@pytest.mark.parametrize("method", ["chung-hulbert", "radau5"])
def test_it_bows_as_the_simulation_and_a_state_takes_the_bow_along(archive, method):
    choices = {} if method != "radau5" else {"solver.method": 1 + list(METHODS).index(method)}
    settings = choose(method=method) if choices else choose()
    machine = Machine(archive).start(choices, speed=SPEED)
    simulation = Simulation(load_rotor(NEWKIRK)[1], settings, speed=SPEED)

    def run(machine, steps, first):
        rows = []
        for i in range(first, first + steps):
            machine.set(speed=SPEED + 0.1 * i)
            machine.step(H)
            rows.append((machine.t, machine.read()))
        return rows

    first = run(machine, 5, 0)
    state = machine.fmu.serializeFMUstate(machine.fmu.getFMUstate())
    then = run(machine, 5, 5)
    for i, (t, seen) in enumerate([*first, *then]):
        simulation.advance(t, SPEED + 0.1 * i)
        assert (seen == observed(simulation, machine.computed)).all()
    assert simulation.read("ring.bow") > 0.0
    other = Machine(archive).start(choices, speed=SPEED)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(state))
    other.t = first[-1][0]
    for (_, seen), (_, again) in zip(then, run(other, 5, 5), strict=True):
        assert (seen == again).all()
    # the parameters of the bow may change during a run
    other.set(**{"ring.bow_decay": 50.0, "ring.bow_per_heat": 0.0})
    before = other.read(["ring.bow"])[0]
    other.step(H)
    assert other.read(["ring.bow"])[0] == pytest.approx(before * math.exp(-1.0), rel=1e-2)
