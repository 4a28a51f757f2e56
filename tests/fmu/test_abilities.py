"""What a description says that the FMU can do, and of the experiment that it proposes."""

from xml.etree.ElementTree import Element

import pytest
from rotor_fmu.model.machine.toml import rig
from rotor_fmu.model.settings import Settings

from rotor_fmu.fmi.description import Described, description
from rotor_fmu.fmi.interface import interface


def described(fmi, *, needs_python=False) -> Element:
    of = Described(rig(), "rotor", needs_python=needs_python)
    return description(of, interface(rig()), fmi)


@pytest.mark.parametrize(("fmi", "needs_python"), [(2, True), (2, False), (3, False)])
def test_an_fmu_declares_what_a_host_may_do_with_it(fmi, needs_python):
    """As the tests of its calls have it: states, as bytes too, steps of any length, many instances
    in a process. An FMU in Python needs the Python of its host."""
    root = described(fmi, needs_python=needs_python)
    simulated = root.find("CoSimulation")
    state = "State" if fmi == 3 else "state"
    for name in (
        "canHandleVariableCommunicationStepSize",
        f"canGetAndSetFMU{state}",
        f"canSerializeFMU{state}",
    ):
        assert simulated.get(name) == "true", name
    assert simulated.get("canBeInstantiatedOnlyOncePerProcess") == "false"
    assert simulated.get("needsExecutionTool") == str(needs_python).lower()
    # which asks for a setting before the initialization, or for what is not there
    for name in ("Derivative", "Derivatives"):
        assert simulated.get(f"providesDirectional{name}") is None
    assert simulated.get("canRunAsynchronuously") is None
    assert simulated.get("canReturnEarlyAfterIntermediateUpdate") is None
    experiment = root.find("DefaultExperiment")
    assert float(experiment.get("tolerance")) == Settings.tolerance
    assert float(experiment.get("startTime")) == 0.0
