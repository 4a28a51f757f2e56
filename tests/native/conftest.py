"""The native FMU, built once for this machine."""

from pathlib import Path

import pytest
from rotor_fmu.model.kernels.library import here

from rotor_fmu.files import write_text
from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.live.live_page import solver_page

from ..fmu.conftest import master  # noqa: F401, a fixture
from ..fmu.masters import COMPILER, NO_COMPILER, Master, compile_c_host

HERE = "linux64"


def pytest_collection_modifyitems(items):
    """All tests of this folder need the library."""
    for item in items:
        if Path(__file__).parent in item.path.parents:
            item.add_marker("native")


@pytest.fixture(scope="session")
def make(tmp_path_factory):
    """Builds a native FMU of this machine's platform."""
    if here() != HERE:
        pytest.skip(f"these tests load the library of {HERE}, and this platform is {here()}")

    def build(*machine, fmi=2, **options) -> Path:
        folder = tmp_path_factory.mktemp("native")
        return build_native(folder, machine_of(*machine, **options), fmi, platforms=[HERE])

    return build


@pytest.fixture(scope="session")
def fmu(make) -> Path:
    return make()


@pytest.fixture(scope="session")
def c_host(fmu, tmp_path_factory):
    """A plain C master, run without any environment."""
    if COMPILER is None:
        pytest.skip(NO_COMPILER)
    host = Master(fmu, compile_c_host(tmp_path_factory.mktemp("host")), is_alone=True)
    yield host
    host.close()


@pytest.fixture(scope="session")
def rig(tmp_path_factory):
    """The page on which the rig runs."""
    file = tmp_path_factory.mktemp("live") / "rig.html"
    write_text(solver_page(machine_of()), file)
    return file
