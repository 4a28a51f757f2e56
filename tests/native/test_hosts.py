"""Hosts beside FMPy that need nothing but the FMU: bit for bit the same numbers. Each in a process
of its own."""

import pytest

from ..fmu.instance import Machine
from ..fmu.test_hosts import needs
from ..processes import run_anew

H, STEPS = 0.004, 50
READ = ("phi", "tau", "disc[3].x", "disc[3].y")
ECOS = """
import ctypes, sys
from importlib.metadata import files
# its library asks for one that the system may lack and the package index has
tbb = next(f for f in files("tbb") if f.name == "libtbb.so.12")
ctypes.CDLL(str(tbb.locate()), ctypes.RTLD_GLOBAL)
from ecospy import EcosSimulation, EcosSimulationStructure
fmu, h, steps, names = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
with EcosSimulationStructure() as structure:
    structure.add_model("rotor", fmu)
    structure.add_parameter_set("initialValues", {"rotor::bearing[1].mu": 0.1})
    with EcosSimulation(structure=structure, step_size=h) as simulation:
        simulation.init(parameter_set="initialValues")
        for i in range(steps):
            simulation.set_real("rotor::speed", 400.0 - 0.04 * i)
            simulation.step()
        print(*(simulation.get_real(f"rotor::{name}").hex() for name in names))
        simulation.terminate()
"""
FMULOADER = """
import sys
import fmpy
from fmuloader.fmi3 import Fmi3Slave
fmu, h, steps, names = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
described = fmpy.read_model_description(fmu)
at = {v.name: v.valueReference for v in described.modelVariables}
name = described.coSimulation.modelIdentifier
slave = Fmi3Slave(fmu, model_identifier=name)
slave.instantiate_co_simulation("rotor", instantiation_token=described.guid)
put, get = slave.set_float64, slave.get_float64
put([at["bearing[1].mu"]], [0.1])
slave.enter_initialization_mode()
slave.exit_initialization_mode()
t = 0.0
for i in range(steps):
    put([at["speed"]], [400.0 - 0.04 * i])
    slave.do_step(t, h)
    t += h
print(*(value.hex() for value in get([at[name] for name in names])))
slave.terminate()
slave.free_instance()
"""
HOSTS = {"ecospy": ECOS, "fmuloader": FMULOADER}


@pytest.fixture(scope="module")
def versions(make):
    """An FMU of each version of FMI, and what FMPy computes with it."""
    return {fmi: (fmu, _by_fmpy(fmu)) for fmi in (2, 3) for fmu in (make(fmi=fmi),)}


def _by_fmpy(fmu):
    machine = Machine(fmu).start(**{"bearing[1].mu": 0.1})
    for i in range(STEPS):
        machine.set(speed=400.0 - 0.04 * i)
        machine.step(H)
    expected = [value.hex() for value in machine.read(READ).tolist()]
    machine.close()
    return expected


# fmuloader wants functions for model exchange of every FMU of FMI 2.0
@pytest.mark.parametrize(
    ("host", "fmi"),
    [
        pytest.param("ecospy", 2, marks=needs("ecospy", "pip install ecospy tbb")),
        pytest.param("ecospy", 3, marks=needs("ecospy", "pip install ecospy tbb")),
        pytest.param("fmuloader", 3, marks=needs("fmuloader", "pip install 'fmuloader>=0.1.2rc0'")),
    ],
)
def test_another_host_computes_the_same_bits(versions, host, fmi):
    fmu, expected = versions[fmi]
    done = run_anew(HOSTS[host], fmu, H, STEPS, *READ)
    assert done.returncode == 0, done.stderr[-2000:]
    assert done.stdout.split()[-len(READ) :] == expected
