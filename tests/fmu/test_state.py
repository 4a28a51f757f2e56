"""FMU state: taken, given back, carried to another process, refused where it does not belong."""

import fmpy
import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.fmi.packing.python_fmu import build

from ..processes import run_python

STEP = 0.004


class Instance:
    """An instance of the FMU at work."""

    def __init__(self, fmu):
        self.folder = fmpy.extract(str(fmu))
        self.description = fmpy.read_model_description(self.folder)
        self.refs = {v.name: v.valueReference for v in self.description.modelVariables}
        self.reals = [
            v.valueReference
            for v in self.description.modelVariables
            if v.type == "Real" and v.causality in ("output", "local")
        ]
        self.fmu = fmpy.instantiate_fmu(self.folder, self.description, "CoSimulation")
        self.t = 0.0

    def start(self, **parameters):
        self.fmu.setupExperiment(startTime=0.0)
        self.fmu.enterInitializationMode()
        for name, value in parameters.items():
            self.fmu.setReal([self.refs[name]], [value])
        self.fmu.exitInitializationMode()
        return self

    def run(self, steps):
        """All real results of every step."""
        results = []
        for _ in range(steps):
            self.fmu.setReal([self.refs["speed"]], [400 - 10 * self.t])
            self.fmu.doStep(self.t, STEP)
            self.t += STEP
            results.append(self.fmu.getReal(self.reals))
        return results


@pytest.fixture
def instance(fmu):
    return Instance(fmu).start()


def test_it_says_that_it_can(fmu):
    description = fmpy.read_model_description(str(fmu))
    assert description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canSerializeFMUstate


def test_the_same_steps_from_the_same_state_give_the_same_bits(instance):
    instance.run(20)
    state, t = instance.fmu.getFMUstate(), instance.t
    first = instance.run(30)
    instance.fmu.setFMUstate(state)
    instance.t = t
    assert instance.run(30) == first


def test_a_rejected_step_can_be_repeated_with_smaller_ones(instance):
    instance.run(20)
    state, t = instance.fmu.getFMUstate(), instance.t
    instance.fmu.doStep(t, 0.1)
    instance.fmu.setFMUstate(state)
    instance.fmu.doStep(t, STEP / 2)
    instance.fmu.doStep(t + STEP / 2, STEP / 2)
    assert instance.fmu.getReal([instance.refs["phi"]])[0] > 0


def test_a_state_carries_parameters_into_a_fresh_instance(fmu):
    changed = Instance(fmu).start(**{"bearing[1].clearance": 60e-6})
    changed.run(10)
    state = changed.fmu.serializeFMUstate(changed.fmu.getFMUstate())
    other = Instance(fmu).start()
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(state))
    other.t = changed.t
    assert other.run(10) == changed.run(10)


def test_a_state_serialized_in_another_process_goes_on_bit_for_bit(instance, fmu, tmp_path):
    instance.run(20)
    (tmp_path / "state").write_bytes(instance.fmu.serializeFMUstate(instance.fmu.getFMUstate()))
    script = (
        "import sys; sys.path.insert(0, sys.argv[3])\n"
        "from tests.fmu.test_state import Instance\n"
        "i = Instance(sys.argv[1]).start()\n"
        "i.fmu.setFMUstate(i.fmu.deSerializeFMUstate(open(sys.argv[2], 'rb').read()))\n"
        "i.t = float(sys.argv[4])\n"
        "print([x.hex() for x in i.run(10)[-1]])\n"
    )
    root = str(__file__).rsplit("tests", 1)[0]
    done = run_python(script, fmu, tmp_path / "state", root, repr(instance.t))
    assert done.returncode == 0, done.stderr
    here = [value.hex() for value in instance.run(10)[-1]]
    assert done.stdout.strip() == str(here)


def test_a_reset_restores_the_start(instance):
    first = instance.run(10)
    instance.fmu.reset()
    instance.t = 0.0
    instance.start()
    assert instance.run(10) == first


@pytest.mark.parametrize("damage", ["truncated", "corrupted", "empty", "another build"])
def test_what_is_no_state_of_this_fmu_is_refused_with_a_reason(
    instance, fmu, tmp_path, capfd, damage
):
    state = bytearray(instance.fmu.serializeFMUstate(instance.fmu.getFMUstate()))
    if damage == "truncated":
        state = state[:-7]
    elif damage == "corrupted":
        state[len(state) // 2] ^= 1
    elif damage == "empty":
        state = bytearray(1)
    else:
        other = build(tmp_path, rig_toml().replace("clearance = 50e-6", "clearance = 60e-6"))
        stranger = Instance(other).start()
        state = bytearray(stranger.fmu.serializeFMUstate(stranger.fmu.getFMUstate()))
    with pytest.raises(fmpy.fmi1.FMICallException):
        instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(bytes(state)))
    reason = "another build" if damage == "another build" else "truncated or corrupted"
    assert reason in capfd.readouterr().err
    instance.fmu.freeInstance()
