"""A machine without a rest, or thrown beyond what it reaches: the FMU refuses it at its start with
the simulation's sentence."""

import fmpy
import pytest
from rotor_fmu.model.machine.toml import parse_rotor, rig_toml
from rotor_fmu.model.simulation import EquilibriumError, Simulation

from ..fmu.instance import Machine
from ..physics.test_equilibrium import TOO_STIFF

MACHINES = {
    "beyond": (f"{rig_toml()}[start]\ny = -0.05\n", "[start]: node 1 lies 0.05 m from the axis"),
    "hump": (
        rig_toml().replace("[[bearing]]", "[[bearing]]\nwear = 0.3\nwear_angle = 1.5707963"),
        "a journal rests on the ridge of its worn bore",
    ),
    "stiff": (TOO_STIFF, "rounding hides that of its supports, 2e+06 N/m"),
}


@pytest.mark.parametrize("name", MACHINES)
def test_a_start_without_a_rest_is_refused_as_the_simulation_refuses_it(make, capfd, name):
    toml, reason = MACHINES[name]
    with pytest.raises(EquilibriumError) as refused:
        Simulation(parse_rotor(toml))
    assert reason in str(refused.value)
    machine = Machine(make(toml=toml))
    capfd.readouterr()
    with pytest.raises(fmpy.fmi1.FMICallException):
        machine.start()
    assert f": {refused.value}\n" in capfd.readouterr().err
