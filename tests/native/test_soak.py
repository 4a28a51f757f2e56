"""The FMU that needs no Python, used for long: the tests of the FMU in Python, on this one."""

from ..fmu.test_soak import test_instances_steps_and_states_leave_nothing_behind  # noqa: F401
