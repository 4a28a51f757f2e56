"""FMU state: taken, given back, carried to another process, refused where it does not belong."""

import fmpy
import pytest
from rotor_fmu.model.machine.toml import rig_toml

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.python_fmu import build

from ..processes import run_python
from .instance import Machine

STEP = 0.004
OTHER = rig_toml().replace("clearance = 50e-6", "clearance = 60e-6")


class Instance(Machine):
    """An instance that runs down, step by step."""

    def run(self, steps):
        """All real results of every step."""
        results = []
        for _ in range(steps):
            self.set(speed=400 - 10 * self.t)
            self.step(STEP)
            results.append(self.read().tolist())
        return results


@pytest.fixture
def instance(fmu):
    instance = Instance(fmu).start()
    yield instance
    instance.close()


@pytest.fixture
def other(tmp_path):
    """The FMU of another machine."""
    return build(tmp_path, machine_of(OTHER))


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


DAMAGED = {
    "truncated": lambda state: state[:-7],
    "corrupted": lambda state: state[:99] + bytes([state[99] ^ 1]) + state[100:],
    "empty": lambda state: bytes(1),
}


@pytest.mark.parametrize("damage", DAMAGED)
def test_a_damaged_state_is_refused_with_a_reason(instance, capfd, damage):
    state = instance.fmu.serializeFMUstate(instance.fmu.getFMUstate())
    assert "truncated or corrupted" in refusal(instance, DAMAGED[damage](state), capfd)


def test_a_state_of_another_build_is_refused_with_a_reason(instance, other, capfd):
    stranger = Instance(other).start()
    state = stranger.fmu.serializeFMUstate(stranger.fmu.getFMUstate())
    assert "another build" in refusal(instance, state, capfd)


def refusal(instance, state, capfd):
    """What the log says of a state that is refused."""
    with pytest.raises(fmpy.fmi1.FMICallException):
        instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(state))
    return capfd.readouterr().err
