"""The FMU that these tests drive, built once, and the masters that drive it."""

from pathlib import Path

import pytest

from rotor_fmu.fmi.packing.native_fmu import build_native
from rotor_fmu.fmi.packing.python_fmu import build

from .masters import NO_C_HOST, Master, compile_c_host


@pytest.fixture(scope="session")
def fmu(request, tmp_path_factory) -> Path:
    """Built once for all workers where there are several (tests/conftest.py)."""
    shared = getattr(request.config, "workerinput", {}).get("fmu")
    return Path(shared) if shared else build(tmp_path_factory.mktemp("fmu"))


@pytest.fixture(scope="session")
def free_fmu(tmp_path_factory) -> Path:
    """The FMU that a torque drives."""
    return build(tmp_path_factory.mktemp("free"), is_free=True)


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
    return build_native(tmp_path_factory.mktemp("native"), platforms=["linux64"])
