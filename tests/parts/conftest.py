"""FMUs of machines described in TOML, each built once."""

import pytest
from rotor_fmu.model.kernels.library import here

from rotor_fmu.fmi.packing import machine_files
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.fmi.packing.python_fmu import build

from .driven import Machine


@pytest.fixture(
    scope="session", params=["python", pytest.param("native", marks=pytest.mark.native)]
)
def machine_of(request, tmp_path_factory):
    """`machine_of(toml, is_free)`: its FMU, ready to be driven."""
    if request.param == "native" and here() != "linux64":
        pytest.skip(f"the native FMU is built for linux64 here, and this platform is {here()}")
    built = {}

    def machine(toml, is_free=False):
        if (toml, is_free) not in built:
            folder = tmp_path_factory.mktemp("machine")
            of = machine_files.machine_of(toml, is_free)
            if request.param == "native":
                fmu = build_native(folder, of, platforms=["linux64"])
            else:
                fmu = build(folder, of)
            built[toml, is_free] = Machine(fmu)
        return built[toml, is_free]

    yield machine
    for each in built.values():
        each.close()
