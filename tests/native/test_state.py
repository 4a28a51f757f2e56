"""State of the native FMU: the tests of the FMU in Python, on this one."""

import fmpy
import pytest
from rotor_fmu.model.machine.toml import rig_toml

from ..fmu.test_state import (  # noqa: F401
    Instance,
    instance,
    test_a_rejected_step_can_be_repeated_with_smaller_ones,
    test_a_reset_restores_the_start,
    test_a_state_carries_parameters_into_a_fresh_instance,
    test_a_state_serialized_in_another_process_goes_on_bit_for_bit,
    test_it_says_that_it_can,
    test_the_same_steps_from_the_same_state_give_the_same_bits,
)


@pytest.mark.parametrize("damage", ["truncated", "corrupted", "empty", "another build"])
def test_what_is_no_state_of_this_fmu_is_refused_with_a_reason(instance, make, capfd, damage):  # noqa: F811
    state = bytearray(instance.fmu.serializeFMUstate(instance.fmu.getFMUstate()))
    if damage == "truncated":
        state = state[:-7]
    elif damage == "corrupted":
        state[len(state) // 2] ^= 1
    elif damage == "empty":
        state = bytearray(1)
    else:
        other = make(rotor_toml=rig_toml().replace("clearance = 50e-6", "clearance = 60e-6"))
        stranger = Instance(other).start()
        state = bytearray(stranger.fmu.serializeFMUstate(stranger.fmu.getFMUstate()))
    with pytest.raises(fmpy.fmi1.FMICallException):
        instance.fmu.deSerializeFMUstate(bytes(state))
    reason = "another build" if damage == "another build" else "truncated or corrupted"
    assert reason in capfd.readouterr().err
    instance.fmu.freeInstance()
