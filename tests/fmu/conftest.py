"""The FMU that these tests drive, built once, and the masters that drive it."""

from pathlib import Path

import pytest
from rotor_fmu.model.settings import PRESETS

from rotor_fmu.fmi.packing.machine_files import machine_of
from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.fmi.packing.python_fmu import build

from .masters import NO_C_HOST, Master, compile_c_host
from .rig_host import Host
from .skins import SKINS, Extracted


@pytest.fixture(scope="session")
def fmu(request, tmp_path_factory) -> Path:
    """Built once for all workers where there are several (tests/conftest.py)."""
    shared = getattr(request.config, "workerinput", {}).get("fmu")
    return Path(shared) if shared else build(tmp_path_factory.mktemp("fmu"), machine_of())


@pytest.fixture(scope="session")
def free_fmu(tmp_path_factory) -> Path:
    """The FMU that a torque drives."""
    return build(tmp_path_factory.mktemp("free"), machine_of(is_free=True))


@pytest.fixture(scope="session")
def c_host(fmu, tmp_path_factory):
    """A plain C master."""
    if NO_C_HOST:
        pytest.skip(NO_C_HOST)
    master = Master(fmu, compile_c_host(tmp_path_factory.mktemp("host")))
    yield master
    master.close()


@pytest.fixture(scope="session", params=["FMPy", "C"])
def master(request, fmu):
    """FMPy and the C master in turn."""
    if request.param == "C":
        yield request.getfixturevalue("c_host")
        return
    master = Master(fmu)
    yield master
    master.close()


@pytest.fixture(scope="session")
def native_fmu(tmp_path_factory) -> Path:
    """The FMU that needs no Python, of this machine's platform."""
    return build_native(tmp_path_factory.mktemp("native"), machine_of(), platforms=["linux64"])


@pytest.fixture(scope="session")
def extracted(fmu, native_fmu):
    """Both FMUs in folders, by the names of their skins."""
    return {"python": Extracted(fmu), "native": Extracted(native_fmu)}


@pytest.fixture(scope="module", params=SKINS)
def skin(request, extracted):
    """One of the skins, and the FMU that it stands for."""
    return SKINS[request.param], extracted[request.param]


@pytest.fixture
def new(skin):
    """Makes hosts with an instance each, of a preset."""

    def make(preset=None):
        host = Host(skin[0](skin[1]))
        return host if preset is None else host.set("solver.preset", list(PRESETS).index(preset))

    return make


@pytest.fixture
def started(new):
    return new().start()
